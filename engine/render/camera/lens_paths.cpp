#include "engine/render/camera/lens_paths.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace lensproof::render {

namespace {

void draw_one_pupil_point(const pupil::PupilSlices& pupil, PathStarts& starts, std::size_t i) {
    const pupil::PupilDraw<double> draw =
        pupil.sample({starts.film_x[i], starts.film_y[i]}, starts.wavelength[i], starts.pupil_u[i], starts.pupil_v[i]);
    starts.pupil_x[i] = draw.point.x;
    starts.pupil_y[i] = draw.point.y;
    starts.pupil_area[i] = draw.area;
}

/// Which paths of a chunk left the lens, in their order.
struct Survivors {
    std::array<std::uint16_t, kPathChunk> path;
    int count = 0;

    /// Writes what a column has of them to `to`, one after the other.
    template <class From, class To>
    void copy(const From* column, To* to) const {
        for (int k = 0; k < count; ++k) {
            to[k] = column[path[static_cast<std::size_t>(k)]];
        }
    }
};

Survivors find_survivors(const PathStarts& starts, const optics::RayBatch<double>& rays) {
    Survivors survivors;
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays.size); ++i) {
        survivors.path[static_cast<std::size_t>(survivors.count)] = static_cast<std::uint16_t>(i);
        survivors.count += rays.status[i] == optics::RayStatus::ok && starts.pupil_area[i] > 0.0 ? 1 : 0;
    }
    return survivors;
}

}  // namespace

LensPaths::LensPaths(FilmSampling film, const optics::SpectralLens<double>& lens, const pupil::PupilSlices& pupil,
                     std::optional<optics::SimdLevel> level)
    : samples_(std::move(film), lens.wavelengths(), level),
      lens_(&lens),
      pupil_(&pupil),
      kernels_(&path_kernels(level)),
      tracing_{.carry = optics::Carry::transmittance, .level = level},
      rays_(kPathChunk) {}

bool LensPaths::fill(CameraPathBuffer& buffer) {
    return samples_.fill(buffer, [&](PathStarts& starts) {
        const int lit = draw_pupil_points(starts);
        started_ += lit;
        if (lit == 0) {  // the film gets no light, and nothing is traced
            return;
        }
        kernels_->aim_rays(lens_->at(0).image_z, pupil_->map().plane_z(), starts, rays_);
        std::transform(starts.etendue.begin(), starts.etendue.begin() + starts.size, starts.filter_weight.begin(),
                       starts.etendue.begin(), std::multiplies<>());
        optics::trace_batch<optics::Direction::reverse>(*lens_, rays_, tracing_);
        move_survivors(starts, buffer);
    });
}

int LensPaths::draw_pupil_points(PathStarts& starts) const {
    const pupil::PupilSliceTables* tables = pupil_->tables();
    if (tables != nullptr) {
        kernels_->draw_pupil_points(*tables, starts);
    }
    int lit = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(starts.size); ++i) {
        if (tables == nullptr || starts.pupil_area[i] < 0.0) {
            draw_one_pupil_point(*pupil_, starts, i);
        }
        lit += starts.pupil_area[i] > 0.0 ? 1 : 0;
    }
    return lit;
}

void LensPaths::move_survivors(const PathStarts& starts, CameraPathBuffer& buffer) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(rays_.size); ++i) {
        rays_.transmittance[i] *= starts.etendue[i];
    }
    const Survivors survivors = find_survivors(starts, rays_);
    const auto append = [&](const auto& from, auto& to) { survivors.copy(from.data(), to.data() + buffer.size); };
    append(starts.pixel, buffer.pixel);
    append(starts.sample, buffer.sample);
    append(starts.wavelength, buffer.wavelength);
    append(starts.film_x, buffer.film_x);
    append(starts.film_y, buffer.film_y);
    append(rays_.transmittance, buffer.weight);
    append(rays_.origin.x, buffer.origin.x);
    append(rays_.origin.y, buffer.origin.y);
    append(rays_.origin.z, buffer.origin.z);
    append(rays_.direction.x, buffer.direction.x);
    append(rays_.direction.y, buffer.direction.y);
    append(rays_.direction.z, buffer.direction.z);
    buffer.size += survivors.count;
}

}  // namespace lensproof::render
