// experiments/cli/list_commands.cpp — `lensproof lenses`: the lenses that ship.
#include <fmt/format.h>

#include <memory>

#include "engine/io/prescription_file.h"
#include "engine/optics/lens.h"
#include "engine/optics/paraxial.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/cli/command.h"

namespace lensproof {

namespace {

int list_lenses(const CommonOptions& options) {
    nlohmann::ordered_json lenses = nlohmann::ordered_json::array();
    for (const std::string& name : shipped_lens_names()) {
        const Lens lens = load_lens(name);
        const ParaxialData data = paraxial_data(at_wavelength<double>(lens, kLineD));
        lenses.push_back({{"lens", name},
                          {"name", lens.name},
                          {"efl_mm", data.efl},
                          {"bfl_mm", data.bfl},
                          {"f_number", data.f_number},
                          {"projection", projection_name(lens.projection)},
                          {"source", lens.source}});
        if (prints_text(options)) {
            fmt::print("{:16} efl {:7.2f} mm  f/{:<5.2f} {:12} {}\n{:17}{}\n", name, data.efl, data.f_number,
                       projection_name(lens.projection), lens.name, "", lens.source);
        }
    }
    write_json_result(options, {{"lenses", lenses}});
    return kDone;
}

}  // namespace

void add_lenses_command(CLI::App& app, int& status) {
    const auto options = std::make_shared<CommonOptions>();
    CLI::App* command = app.add_subcommand("lenses", "List the lenses that ship, with their sources");
    command->footer("Example: lensproof lenses --json -");
    add_common_options(*command, *options);
    command->callback([options, &status] {
        check_json_name(*options);
        status = list_lenses(*options);
    });
}

}  // namespace lensproof
