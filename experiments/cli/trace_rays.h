// experiments/cli/trace_rays.h — from given rays to the rows that `lensproof trace` writes, in any precision.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/optics/device/device_trace.h"
#include "engine/optics/lens.h"
#include "engine/optics/ray_course.h"
#include "experiments/cli/ghost_options.h"
#include "experiments/cli/given_rays.h"
#include "experiments/cli/trace_rows.h"

namespace lensproof::cli {

/// How rays are traced.
struct TraceTask {
    optics::RayCourse<double> along;
    bool polarised = false;                  // rows say what becomes of polarised light too
    device::SharedDevice* device = nullptr;  // that traces, or null
};

/// The lens at the wavelengths of rays, which come by few; of many the last ones are kept.
template <class T>
class LensAtWavelengths {
  public:
    explicit LensAtWavelengths(const optics::Lens& lens) : lens_(&lens) {}

    const optics::TraceLens<T>& at(double wavelength_nm) {
        constexpr std::size_t kKept = 64;
        if (!kept_.contains(wavelength_nm)) {
            if (kept_.size() == kKept) {
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

/// Along which light travels that the tracer's direction stands for: against it where the index is negative, behind an
/// odd number of mirrors.
template <class T>
Vec3<T> travelling(const Vec3<T>& direction, const T& index) {
    return index < T(0) ? T(-1) * direction : direction;
}

template <class T>
optics::RayCourse<T> course_in(const optics::RayCourse<double>& course) {
    return {.direction = course.direction,
            .rims = course.rims,
            .reflections = course.reflections,
            .mirrors = {static_cast<T>(course.mirrors.sensor), static_cast<T>(course.mirrors.blades)}};
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
    RayRows(const optics::TraceLens<T>& lens, const GivenRay& given, const Ray<T>& ray, const TraceTask& task,
            const Visit& visit)
        : lens_(lens), given_(given), task_(task), visit_(visit) {
        if (task.polarised) {
            polarised_.emplace(lens, task.along.reflections, ray.direction, task.along.direction, task.along.rims);
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
                               (task_.along.rims == optics::Rims::clip && traced.status != optics::RayStatus::ok);
        if (has_ended || task_.along.direction == optics::Direction::reverse) {
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
    const TraceTask& task_;
    const Visit& visit_;
    std::optional<optics::PolarisedEvents<T>> polarised_;
};

/// Rays through the lens, in their order.
template <class T, class Visit>
class RayTracing {
  public:
    /// All outlive it.
    RayTracing(const optics::Lens& lens, const TraceTask& task, const Visit& visit)
        : lenses_(lens), task_(task), along_(course_in<T>(task.along)), visit_(visit) {}

    void trace(const GivenRay& given) {
        const optics::TraceLens<T>& lens = lenses_.at(given.wavelength_nm);
        const Ray<T> ray = ray_in(lens, given, along_.direction);
        RayRows<T, Visit> rows(lens, given, ray, task_, visit_);
        rows.end(optics::trace_along(lens, along_, ray, rows));
    }

  private:
    LensAtWavelengths<T> lenses_;
    const TraceTask& task_;
    optics::RayCourse<T> along_;
    const Visit& visit_;
};

/// The same by the task's device, a chunk of rays at a time; what it fails at, as above.
template <class T, class Visit>
class DeviceTracing {
  public:
    DeviceTracing(const optics::Lens& lens, const TraceTask& task, const Visit& visit)
        : lens_(lens), task_(task), along_(course_in<T>(task.along)), visit_(visit), on_failure_(lens, task, visit) {}

    void trace(const GivenRay& given) {
        constexpr std::size_t kMostRays = 16384;  // whose events are some ten megabytes
        const auto [known, is_new] =
            which_.emplace(given.wavelength_nm, static_cast<std::uint16_t>(wavelengths_nm_.size()));
        if (is_new) {
            wavelengths_nm_.push_back(given.wavelength_nm);
        }
        wavelengths_.push_back(known->second);
        rays_.push_back(given);
        if (rays_.size() == kMostRays) {
            finish();
        }
    }

    /// To be called at the end.
    void finish() {
        if (rays_.empty() || task_.device->has_failed() || !finish_on_device()) {
            std::ranges::for_each(rays_, [&](const GivenRay& given) { on_failure_.trace(given); });
        }
        rays_.clear();
        wavelengths_.clear();
        wavelengths_nm_.clear();
        which_.clear();
    }

  private:
    /// False, and nothing told, where it fails.
    bool finish_on_device() {
        const auto at = optics::at_wavelengths<T>(lens_, wavelengths_nm_);
        std::vector<Ray<T>> rays;
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            rays.push_back(ray_in(at.at(wavelengths_[i]), rays_[i], along_.direction));
        }
        std::optional<optics::DeviceEvents<T>> found;
        try {
            const device::Device& device = task_.device->device();
            found.emplace(device, optics::DeviceLens<T>(device, at), rays, wavelengths_, along_);
        } catch (const device::Error& error) {
            task_.device->fail(error.what());
            return false;
        }
        for (std::size_t i = 0; i < rays.size(); ++i) {
            RayRows<T, Visit> rows(at.at(wavelengths_[i]), rays_[i], rays[i], task_, visit_);
            std::ranges::for_each(found->events(i), std::ref(rows));
            rows.end(found->end(i));
        }
        return true;
    }

    const optics::Lens& lens_;
    const TraceTask& task_;
    optics::RayCourse<T> along_;
    const Visit& visit_;
    RayTracing<T, Visit> on_failure_;
    std::vector<GivenRay> rays_;
    std::vector<std::uint16_t> wavelengths_;  // a ray each
    std::vector<double> wavelengths_nm_;
    std::map<double, std::uint16_t> which_;  // of these
};

/// Tells `visit` the rows of all rays, in their order.
template <class T, class Visit>
void trace_all(const optics::Lens& lens, const GivenRays& rays, const TraceTask& task, const Visit& visit) {
    if constexpr (!std::is_same_v<T, long double>) {  // which no device has
        if (task.device != nullptr) {
            DeviceTracing<T, Visit> tracing(lens, task, visit);
            rays.for_each([&](const GivenRay& given) { tracing.trace(given); });
            tracing.finish();
            return;
        }
    }
    RayTracing<T, Visit> tracing(lens, task, visit);
    rays.for_each([&](const GivenRay& given) { tracing.trace(given); });
}

}  // namespace lensproof::cli
