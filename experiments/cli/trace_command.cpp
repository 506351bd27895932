// experiments/cli/trace_command.cpp — `lensproof trace LENS --rays FILE`: every intersection of given rays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <type_traits>

#include "engine/base/csv.h"
#include "engine/base/input_error.h"
#include "engine/base/json.h"
#include "engine/base/write_file.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/optics/device/device_trace.h"
#include "engine/optics/float_error.h"
#include "engine/optics/lens.h"
#include "engine/optics/ray_way.h"
#include "experiments/cli/command.h"
#include "experiments/cli/device_option.h"
#include "experiments/cli/ghost_options.h"
#include "experiments/cli/terminal.h"
#include "experiments/cli/trace_rows.h"

namespace lensproof::cli {

namespace {

struct GivenRay {
    std::string id;
    Ray<double> ray;
    double wavelength_nm = 0.0;
};

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

/// How rays are traced.
struct Way {
    optics::RayWay<double> along;
    bool polarised = false;                  // rows say what becomes of polarised light too
    device::SharedDevice* device = nullptr;  // that traces, or null
};

// Far beyond any scene, far below what would overflow when squared, in a float too.
constexpr Bounds kCoordinate{.min = -1e15, .max = 1e15};

GivenRay read_ray(const CsvRow& row) {
    const auto vector = [&](const char* x, const char* y, const char* z) {
        return Vec3d{row.number(x, kCoordinate), row.number(y, kCoordinate), row.number(z, kCoordinate)};
    };
    const Vec3d stated = vector("dx", "dy", "dz");
    // Scaled first: the square of a tiny number is 0.
    const double largest = std::max({std::abs(stated.x), std::abs(stated.y), std::abs(stated.z)});
    if (!(largest > 0.0)) {
        throw InputError(fmt::format("{} has length 0, expected a direction", row.where("the direction")));
    }
    // By a power of two, which is exact; `trace_one` makes it a unit vector in its own precision.
    const int exponent = std::ilogb(largest);
    const auto scaled = [&](double component) { return std::ldexp(component, -exponent); };
    return {.id = row.text("id"),
            .ray = {vector("x_mm", "y_mm", "z_mm"), {scaled(stated.x), scaled(stated.y), scaled(stated.z)}},
            .wavelength_nm = row.number("wavelength_nm", kPositive)};
}

/// Rays of a table, read anew each time that they are asked for.
class GivenRays {
  public:
    explicit GivenRays(const std::string& file) : table_(CsvTable::read(file)) {
        table_.expect_columns({"id", "x_mm", "y_mm", "z_mm", "dx", "dy", "dz", "wavelength_nm"});
        if (!CsvTable(table_).next()) {
            throw InputError(fmt::format("{}: holds no ray", file));
        }
    }

    template <class Visit>
    void for_each(const Visit& visit) const {
        for_each_row([&](const CsvRow& row) { visit(read_ray(row)); });
    }

    template <class Visit>
    void for_each_row(const Visit& visit) const {
        CsvTable table = table_;
        while (const std::optional<CsvRow> row = table.next()) {
            visit(*row);
        }
    }

  private:
    CsvTable table_;
};

/// The lens at the wavelengths of rays, which come by few; of many the last ones are kept.
template <class T>
class LensAtWavelengths {
  public:
    explicit LensAtWavelengths(const optics::Lens& lens) : lens_(&lens) {}

    static constexpr std::size_t kMost = 64;

    const optics::TraceLens<T>& at(double wavelength_nm) {
        if (!kept_.contains(wavelength_nm)) {
            if (kept_.size() == kMost) {
                kept_.clear();
            }
            kept_.emplace(wavelength_nm, optics::at_wavelength<T>(*lens_, wavelength_nm));
        }
        return kept_.at(wavelength_nm);
    }

  private:
    const optics::Lens* lens_;
    std::map<double, optics::TraceLens<T>> kept_;
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

/// Along which light travels that the tracer's direction stands for: against it where the index is negative, behind an
/// odd number of mirrors.
template <class T>
Vec3<T> travelling(const Vec3<T>& direction, const T& index) {
    return index < T(0) ? T(-1) * direction : direction;
}

template <class T>
optics::RayWay<T> way_in(const optics::RayWay<double>& way) {
    return {.direction = way.direction,
            .rims = way.rims,
            .reflections = way.reflections,
            .mirrors = {static_cast<T>(way.mirrors.sensor), static_cast<T>(way.mirrors.blades)}};
}

template <class T>
Ray<T> ray_in(const optics::TraceLens<T>& lens, const GivenRay& given, optics::Direction direction) {
    const auto cast = [](const Vec3d& v) {
        return Vec3<T>{static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
    };
    // Normalised in the working precision: a double's unit vector is not one to long double's last digits.
    const Vec3<T> stated = normalized(cast(given.ray.direction));
    return {cast(given.ray.origin),
            direction == optics::Direction::forward ? stated : travelling(stated, lens.surfaces.back().index_after)};
}

/// Tells `visit` a row a surface of one ray: called with what befalls it, in order, and then with its end.
template <class T, class Visit>
class RayRows {
  public:
    /// All outlive it.
    RayRows(const optics::TraceLens<T>& lens, const GivenRay& given, const Ray<T>& ray, const Way& way,
            const Visit& visit)
        : lens_(lens), given_(given), way_(way), visit_(visit) {
        if (way.polarised) {
            polarised_.emplace(lens, way.along.reflections, ray.direction, way.along.direction, way.along.rims);
        }
    }

    void operator()(const optics::SurfaceEvent<T>& event) {
        if (polarised_) {
            (*polarised_)(event);
        }
        const bool is_sensor = event.surface == static_cast<int>(lens_.surfaces.size());
        T index = index_at_sensor();
        if (!is_sensor) {
            const optics::TraceSurface<T>& surface = lens_.surfaces[static_cast<std::size_t>(event.surface)];
            const bool is_behind = (event.ray.direction.z > T(0)) == (event.status != optics::RayStatus::missed);
            index = is_behind ? surface.index_after : surface.index_before;
        }
        tell({given_.id, is_sensor ? kSensorName : std::to_string(event.surface + 1),
              Ray<T>{event.ray.origin, travelling(event.ray.direction, index)}, event.optical_path, event.transmittance,
              event.status});
    }

    void end(const optics::TracedRay<T>& traced) {
        const bool has_ended = !optics::gets_through(traced.status) ||
                               (way_.along.rims == optics::Rims::clip && traced.status != optics::RayStatus::ok);
        if (has_ended || way_.along.direction == optics::Direction::reverse) {
            return;
        }
        if (traced.ray.direction.z > T(0)) {
            const optics::PlanePoint<T> image = optics::meet_plane(traced.ray, lens_.image_z);
            tell({given_.id, kSensorName, Ray<T>{image.point, travelling(traced.ray.direction, index_at_sensor())},
                  traced.optical_path + index_at_sensor() * image.distance, traced.transmittance,
                  optics::RayStatus::ok});
        } else {
            tell({given_.id, kSensorName, traced.ray, traced.optical_path, traced.transmittance,
                  optics::RayStatus::missed});
        }
    }

  private:
    [[nodiscard]] const T& index_at_sensor() const { return lens_.surfaces.back().index_after; }

    void tell(TraceRow<T> row) const {
        if (polarised_) {
            row.polarised = polarised_->light(row.transmittance);
        }
        visit_(row);
    }

    const optics::TraceLens<T>& lens_;
    const GivenRay& given_;
    const Way& way_;
    const Visit& visit_;
    std::optional<optics::PolarisedEvents<T>> polarised_;
};

/// Rays through the lens, in their order.
template <class T, class Visit>
class RayTracing {
  public:
    /// All outlive it.
    RayTracing(const optics::Lens& lens, const Way& way, const Visit& visit)
        : lenses_(lens), way_(way), along_(way_in<T>(way.along)), visit_(visit) {}

    void trace(const GivenRay& given) {
        const optics::TraceLens<T>& lens = lenses_.at(given.wavelength_nm);
        const Ray<T> ray = ray_in(lens, given, along_.direction);
        RayRows<T, Visit> rows(lens, given, ray, way_, visit_);
        rows.end(optics::trace_along(lens, along_, ray, [&](const optics::SurfaceEvent<T>& event) { rows(event); }));
    }

  private:
    LensAtWavelengths<T> lenses_;
    const Way& way_;
    optics::RayWay<T> along_;
    const Visit& visit_;
};

/// The same by the way's device, a chunk of rays at a time.
template <class T, class Visit>
class DeviceTracing {
  public:
    DeviceTracing(const optics::Lens& lens, const Way& way, const Visit& visit)
        : lens_(lens), way_(way), along_(way_in<T>(way.along)), visit_(visit), on_failure_(lens, way, visit) {}

    void trace(const GivenRay& given) {
        constexpr std::size_t kMostRays = 16384;  // whose events are some ten megabytes
        const bool is_new = std::ranges::find(wavelengths_nm_, given.wavelength_nm) == wavelengths_nm_.end();
        if (rays_.size() == kMostRays || (is_new && wavelengths_nm_.size() == LensAtWavelengths<T>::kMost)) {
            finish();
        }
        const auto known = std::ranges::find(wavelengths_nm_, given.wavelength_nm);
        wavelengths_.push_back(static_cast<std::uint16_t>(known - wavelengths_nm_.begin()));
        if (known == wavelengths_nm_.end()) {
            wavelengths_nm_.push_back(given.wavelength_nm);
        }
        rays_.push_back(given);
    }

    /// To be called at the end.
    void finish() {
        const auto found = way_.device->has_failed() ? std::nullopt : events();
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            if (!found) {
                on_failure_.trace(rays_[i]);
                continue;
            }
            const optics::TraceLens<T>& lens = at_->at(wavelengths_[i]);
            RayRows<T, Visit> rows(lens, rays_[i], ray_in(lens, rays_[i], along_.direction), way_, visit_);
            std::ranges::for_each(found->events(i), std::ref(rows));
            rows.end(found->end(i));
        }
        rays_.clear();
        wavelengths_.clear();
        if (wavelengths_nm_.size() == LensAtWavelengths<T>::kMost) {
            wavelengths_nm_.clear();
            at_.reset();
        }
    }

  private:
    /// None where the device failed.
    std::optional<optics::DeviceEvents<T>> events() {
        try {
            if (!at_ || at_->wavelengths() != static_cast<int>(wavelengths_nm_.size())) {
                at_.emplace(optics::at_wavelengths<T>(lens_, wavelengths_nm_));
                there_.emplace(way_.device->device(), *at_);
            }
            std::vector<Ray<T>> rays;
            for (std::size_t i = 0; i < rays_.size(); ++i) {
                rays.push_back(ray_in(at_->at(wavelengths_[i]), rays_[i], along_.direction));
            }
            return optics::DeviceEvents<T>(way_.device->device(), *there_, rays, wavelengths_, along_);
        } catch (const device::Error& error) {
            way_.device->fail(error.what());
            return std::nullopt;
        }
    }

    const optics::Lens& lens_;
    const Way& way_;
    optics::RayWay<T> along_;
    const Visit& visit_;
    RayTracing<T, Visit> on_failure_;
    std::vector<GivenRay> rays_;
    std::vector<std::uint16_t> wavelengths_;  // a ray each
    std::vector<double> wavelengths_nm_;
    std::optional<optics::SpectralLens<T>> at_;
    std::optional<optics::DeviceLens<T>> there_;
};

template <class T, class Visit>
void trace_all(const optics::Lens& lens, const GivenRays& rays, const Way& way, const Visit& visit) {
    if constexpr (!std::is_same_v<T, long double>) {  // which no device has
        if (way.device != nullptr) {
            DeviceTracing<T, Visit> tracing(lens, way, visit);
            rays.for_each([&](const GivenRay& given) { tracing.trace(given); });
            tracing.finish();
            return;
        }
    }
    RayTracing<T, Visit> tracing(lens, way, visit);
    rays.for_each([&](const GivenRay& given) { tracing.trace(given); });
}

/// In the precision asked for.
template <class Visit>
void trace_rows(const optics::Lens& lens, const GivenRays& rays, const TraceOptions& options, const Way& way,
                const Visit& visit) {
    if (options.precision == "float") {
        trace_all<float>(lens, rays, way, visit);
    } else if (options.precision == "extended") {
        trace_all<long double>(lens, rays, way, visit);
    } else {
        trace_all<double>(lens, rays, way, visit);
    }
}

/// The error of --precision float, measured: the same rays in double too.
struct MeasuredError {
    optics::FloatError error;
    bool reverse = false;
    double system_length_mm = 0.0;

    [[nodiscard]] double bound_um() const { return optics::float_error_bound_um(system_length_mm); }
};

MeasuredError measure_float(const optics::Lens& lens, const GivenRays& rays, const optics::RayWay<double>& way) {
    MeasuredError measured{.reverse = way.direction == optics::Direction::reverse,
                           .system_length_mm = std::abs(lens.image_z - lens.surfaces.front().vertex_z)};
    LensAtWavelengths<float> in_float(lens);
    LensAtWavelengths<double> in_double(lens);
    rays.for_each([&](const GivenRay& given) {
        const optics::TraceLens<float>& narrow = in_float.at(given.wavelength_nm);
        const optics::TraceLens<double>& wide = in_double.at(given.wavelength_nm);
        measured.error.add(way.reflections.empty()
                               ? optics::trace_in_float(narrow, wide, given.ray, way.direction, way.rims)
                               : optics::trace_ghost_in_float(narrow, wide, way.reflections, given.ray, way.rims));
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
    Way way{.along = {.direction = options.reverse ? optics::Direction::reverse : optics::Direction::forward,
                      .rims = options.no_clip ? optics::Rims::follow : optics::Rims::clip},
            .polarised = options.polarised,
            .device = device.get()};
    if (!options.sequence.empty()) {
        way.along.reflections = parse_sequence(options.sequence, lens, options.mirrors);
        way.along.mirrors = stray_mirrors(options.mirrors);
    }
    if (device && options.precision == "extended") {
        device->refuse("no GPU has extended precision");
    }
    const GivenRays rays(options.rays_file);
    check_rays(lens, rays);
    const auto csv_to = [&](const auto& put) {
        put(kTraceHeader + std::string(options.polarised ? kPolarisedHeader : "") + "\n");
        trace_rows(lens, rays, options, way, [&](const auto& row) { put(csv_of(row)); });
    };
    if (!options.output_file.empty()) {
        write_stream(options.output_file,
                     [&](std::ostream& out) { csv_to([&](const std::string& line) { out << line; }); });
    } else if (prints_text(options.common)) {
        csv_to(show);  // rays' names are a file's
    }
    Json result{{"lens", lens.id}, {"findings", findings_json(lens.findings)}, {"rows", Json::list()}};
    if (options.precision == "float") {
        const MeasuredError measured = measure_float(lens, rays, way.along);
        if (!options.common.quiet) {
            print_error(measured);
        }
        result["float_error"] = error_json(measured);
    }
    write_json_result(options.common, result, "rows", [&](const auto& visit) {
        trace_rows(lens, rays, options, way, [&](const auto& row) { visit(json_of(row)); });
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
