// experiments/cli/list_commands.cpp — `lensproof lenses` and `lensproof glasses`: what ships.
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

int list_glasses(const CommonOptions& options) {
    nlohmann::ordered_json glasses = nlohmann::ordered_json::array();
    for (const Glass& glass : shipped_glasses()) {
        const double n_d = refractive_index(glass.formula, kLineD);
        const double V_d = abbe_number(glass.formula);
        glasses.push_back({{"glass", glass.name},
                           {"catalogue", glass.catalogue},
                           {"n_d", n_d},
                           {"V_d", V_d},
                           {"min_wavelength_nm", glass.min_wavelength_nm},
                           {"max_wavelength_nm", glass.max_wavelength_nm},
                           {"source", glass.source}});
        if (prints_text(options)) {
            fmt::print("{:8} {:8} n_d {:.5f}  V_d {:5.2f}  {:.0f} to {:.0f} nm  {}\n", glass.name, glass.catalogue, n_d,
                       V_d, glass.min_wavelength_nm, glass.max_wavelength_nm, glass.source);
        }
    }
    write_json_result(options, {{"glasses", glasses}});
    return kDone;
}

void add_list_command(CLI::App& app, int& status, const char* name, const char* description,
                      int (*list)(const CommonOptions&)) {
    const auto options = std::make_shared<CommonOptions>();
    CLI::App* command = app.add_subcommand(name, description);
    command->footer(fmt::format("Example: lensproof {} --json -", name));
    add_common_options(*command, *options);
    command->callback([options, list, &status] {
        check_json_name(*options);
        status = list(*options);
    });
}

}  // namespace

void add_lenses_command(CLI::App& app, int& status) {
    add_list_command(app, status, "lenses", "List the lenses that ship, with their sources", list_lenses);
}

void add_glasses_command(CLI::App& app, int& status) {
    add_list_command(app, status, "glasses", "List the glasses that ship, with their sources", list_glasses);
}

}  // namespace lensproof
