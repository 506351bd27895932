// experiments/cli/trace_command.cpp — `lensproof trace LENS --rays FILE`: every intersection of given rays.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <ostream>

#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/float_error.h"
#include "engine/optics/lens.h"
#include "experiments/cli/command.h"
#include "experiments/cli/device_option.h"
#include "experiments/cli/ghost_options.h"
#include "experiments/cli/terminal.h"
#include "experiments/cli/trace_rays.h"

namespace lensproof::cli {

namespace {

struct TraceOptions {
    CommonOptions common;
    std::string lens;
    std::string zoom;
    std::string rays_file;
    std::string output_file;
    std::string precision = "double";
    std::vector<std::string> indices;
    std::vector<std::string> glass_catalogues;
    std::vector<std::string> coatings;
    bool reverse = false;
    bool no_clip = false;
    bool polarised = false;
    std::vector<std::string> sequence;
    MirrorOptions mirrors;
    std::string device = "cpu";
};

/// Everything that can be wrong with the rays is found before the first is written.
void check_rays(const optics::Lens& lens, const GivenRays& rays) {
    LensAtWavelengths<double> lenses(lens);
    rays.for_each_row([&](const CsvRow& row) {
        const GivenRay given = read_ray(row);
        try {
            lenses.at(given.wavelength_nm);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}: {}", row.where("wavelength_nm"), error.what()));
        }
    });
}

/// In the precision asked for.
template <class Visit>
void trace_rows(const optics::Lens& lens, const GivenRays& rays, const TraceOptions& options, const TraceTask& task,
                const Visit& visit) {
    if (options.precision == "float") {
        trace_all<float>(lens, rays, task, visit);
    } else if (options.precision == "extended") {
        trace_all<long double>(lens, rays, task, visit);
    } else {
        trace_all<double>(lens, rays, task, visit);
    }
}

/// The error of --precision float, measured: the same rays in double too.
struct MeasuredError {
    optics::FloatError error;
    bool reverse = false;
    double system_length_mm = 0.0;

    [[nodiscard]] double bound_um() const { return optics::float_error_bound_um(system_length_mm); }
};

MeasuredError measure_float(const optics::Lens& lens, const GivenRays& rays, const optics::RayCourse<double>& course) {
    MeasuredError measured{.reverse = course.direction == optics::Direction::reverse,
                           .system_length_mm = std::abs(lens.image_z - lens.surfaces.front().vertex_z)};
    LensAtWavelengths<float> in_float(lens);
    LensAtWavelengths<double> in_double(lens);
    rays.for_each([&](const GivenRay& given) {
        const optics::TraceLens<float>& narrow = in_float.at(given.wavelength_nm);
        const optics::TraceLens<double>& wide = in_double.at(given.wavelength_nm);
        measured.error.add(
            course.reflections.empty()
                ? optics::trace_in_float(narrow, wide, given.ray, course.direction, course.rims)
                : optics::trace_ghost_in_float(narrow, wide, course.reflections, given.ray, course.rims));
    });
    return measured;
}

void print_error(const MeasuredError& measured) {
    const optics::FloatError& error = measured.error;
    const auto text = [](const optics::Distances& distances, const char* where) {
        return distances.points == 0 ? fmt::format("no point {}", where)
                                     : fmt::format("at most {:.3g} µm {} ({:.3g} µm rms)", distances.largest_um, where,
                                                   distances.rms_um());
    };
    print_message("lensproof: float against double: {}, {}; {} of {} rays end otherwise; allowed: {:.3g} µm\n",
                  text(error.at_end, measured.reverse ? "on the first surface" : "on the image plane"),
                  text(error.anywhere, "anywhere"), error.other_fates, error.rays, measured.bound_um());
}

Json error_json(const MeasuredError& measured) {
    const auto json = [](const optics::Distances& distances) -> Json {
        if (distances.points == 0) {
            return nullptr;
        }
        return {{"points", distances.points}, {"largest_um", distances.largest_um}, {"rms_um", distances.rms_um()}};
    };
    const optics::FloatError& error = measured.error;
    return {{"rays", error.rays},
            {"other_statuses", error.other_fates},
            {measured.reverse ? "first_surface" : "image_plane", json(error.at_end)},
            {"all_points", json(error.anywhere)},
            {"system_length_mm", measured.system_length_mm},
            {"bound_um", measured.bound_um()}};
}

int run_trace(const TraceOptions& options) {
    if (!options.output_file.empty()) {
        check_output_name(options.output_file);
    }
    check_json_name(options.common);
    const optics::Lens lens =
        formats::load_lens(options.lens, {.indices = parse_indices(options.indices),
                                          .zoom = options.zoom,
                                          .coatings = options.coatings,
                                          .glasses = read_glass_catalogues(options.glass_catalogues)});
    print_findings(options.common, lens);
    if (!options.sequence.empty() || options.polarised) {
        optics::require_no_thin_elements(lens, options.polarised ? "polarised light" : "a ghost");
    }
    const std::shared_ptr<device::SharedDevice> device = shared_device(options.device, OnRefusal::end);
    TraceTask task{.along = {.direction = options.reverse ? optics::Direction::reverse : optics::Direction::forward,
                             .rims = options.no_clip ? optics::Rims::follow : optics::Rims::clip},
                   .polarised = options.polarised,
                   .device = device.get()};
    if (!options.sequence.empty()) {
        task.along.reflections = parse_sequence(options.sequence, lens, options.mirrors);
        task.along.mirrors = stray_mirrors(options.mirrors);
    }
    if (device && options.precision == "extended") {
        device->refuse("no GPU has extended precision");
    }
    const GivenRays rays(options.rays_file);
    check_rays(lens, rays);
    const auto csv_to = [&](const auto& put) {
        put(kTraceHeader + std::string(options.polarised ? kPolarisedHeader : "") + "\n");
        trace_rows(lens, rays, options, task, [&](const auto& row) { put(csv_of(row)); });
    };
    if (!options.output_file.empty()) {
        write_stream(options.output_file,
                     [&](std::ostream& out) { csv_to([&](const std::string& line) { out << line; }); });
    } else if (prints_text(options.common)) {
        csv_to(show);  // rays' names are a file's
    }
    Json result{{"lens", lens.id}, {"findings", findings_json(lens.findings)}, {"rows", Json::list()}};
    if (options.precision == "float") {
        const MeasuredError measured = measure_float(lens, rays, task.along);
        if (!options.common.quiet) {
            print_error(measured);
        }
        result["float_error"] = error_json(measured);
    }
    write_json_result(options.common, result, "rows", [&](const auto& visit) {
        trace_rows(lens, rays, options, task, [&](const auto& row) { visit(json_of(row)); });
    });
    return kDone;
}

}  // namespace

void add_trace_command(Program& program) {
    const auto options = std::make_shared<TraceOptions>();
    Command command = program.add_command("trace", "Trace given rays and write every intersection");
    command.footer(
        "Example: lensproof trace tessar --rays rays.csv -o traced.csv\n"
        "rays.csv has the header id,x_mm,y_mm,z_mm,dx,dy,dz,wavelength_nm\n"
        "Along a ghost: lensproof trace tessar --rays rays.csv --sequence 2,1");
    command.add_option("LENS", options->lens, "A prescription file, or the name of a lens that ships").required();
    command.add_option("--rays", options->rays_file, "CSV of rays").required().type_name("FILE");
    command.add_option("-o,--output", options->output_file, "CSV to write (default: standard output)")
        .type_name("FILE");
    command.add_option("--precision", options->precision, "float (and its error is measured), double or extended")
        .check(one_of({"float", "double", "extended"}))
        .shows_default();
    add_index_option(command, options->indices);
    command.add_option("--zoom", options->zoom, "Position of a zoom lens, by name or number (default: the first)")
        .type_name("POSITION");
    add_coating_option(command, options->coatings);
    add_glass_catalogue_option(command, options->glass_catalogues);
    const Option reverse = command.add_flag("--reverse", options->reverse, "Rays run from the sensor outwards");
    command.add_flag("--no-clip", options->no_clip, "Follow rays beyond the rims; the first rim passed is still named");
    command
        .add_option("--sequence", options->sequence,
                    "Follow the rays along a ghost: the surfaces that reflect, in that order (image: the sensor; the "
                    "stop's number: its blades)")
        .separated_by(',')
        .excludes(reverse)
        .type_name("I,J,…");
    command.add_flag("--polarised", options->polarised,
                     "Carry the light's polarisation along each ray: what arrives of unpolarised light, and of light "
                     "polarised across and in the plane of ray and axis");
    add_mirror_options(command, options->mirrors);
    add_device_option(command, options->device);
    add_common_options(command, options->common);
    command.runs([options] { return run_trace(*options); });
}

}  // namespace lensproof::cli
