#include "engine/render/camera/shared_rays.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <type_traits>

#include "engine/optics/float_error.h"
#include "engine/render/camera/packet/meet_film.h"

namespace lensproof::render {

template <class T>
void meet_film(double film_z, double pupil_z, const PathKernels& kernels, const optics::RayBatch<T>& behind,
               FilmMeetings& meetings) {
    if constexpr (std::is_same_v<T, double>) {
        kernels.cross_film(film_z, pupil_z, behind, meetings);
    } else {
        kernels.cross_film_in_float(film_z, pupil_z, behind, meetings);
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(behind.size); ++i) {
        const bool arrives = behind.status[i] == optics::RayStatus::ok;
        meetings.transmittance[i] = arrives ? static_cast<double>(behind.transmittance[i]) : -1.0;
    }
}

template void meet_film(double film_z, double pupil_z, const PathKernels& kernels,
                        const optics::RayBatch<float>& behind, FilmMeetings& meetings);
template void meet_film(double film_z, double pupil_z, const PathKernels& kernels,
                        const optics::RayBatch<double>& behind, FilmMeetings& meetings);

void find_pupil_pdfs(const pupil::PupilSlices& pupil, std::span<const std::uint16_t> wavelengths,
                     const PathKernels& kernels, FilmMeetings& meetings) {
    if (const pupil::PupilSliceTables* tables = pupil.tables()) {
        kernels.weigh_pupil_points(*tables, wavelengths.data(), static_cast<int>(wavelengths.size()), meetings);
        return;
    }
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
        meetings.pupil_pdf[i] = meetings.transmittance[i] >= 0.0
                                    ? pupil.pdf({meetings.film_x[i], meetings.film_y[i]}, wavelengths[i],
                                                {meetings.pupil_x[i], meetings.pupil_y[i]})
                                    : 0.0;
    }
}

template <class T>
BasicSharedRays<T>::BasicSharedRays(const spectral::SpectralGrid& grid, const optics::SpectralLens<T>& lens,
                                    const pupil::PupilSlices& pupil, const Sensor& sensor, bool is_box, PathCarry carry,
                                    std::optional<SimdLevel> level, const optics::SpectralLens<double>* at_borders)
    : weigher_(grid, sensor, is_box, carry == PathCarry::wavelengths_and_pdfs, path_kernels(level)),
      lens_(&lens),
      pupil_(&pupil),
      sensor_(sensor),
      kernels_(&path_kernels(level)),
      tracing_{.carry = optics::Carry::transmittance, .level = level},
      turned_(kSharedChunk),
      rays_(kSharedChunk) {
    if (at_borders != nullptr) {
        const optics::TraceLens<double>& judge = at_borders->at(0);
        const double length_mm = std::abs(judge.image_z - judge.surfaces.front().vertex_z);
        judge_.emplace(Judge{.lens = at_borders,
                             .within_mm = 1e-3 * optics::float_error_bound_um(length_mm),
                             .rays = optics::RayBatch<double>(kSharedChunk),
                             .meetings = {}});
    }
}

template <class T>
void BasicSharedRays<T>::weigh(CameraPathBuffer& paths) {
    weigher_.weigh(paths, [&](std::size_t first, SharedPaths& chunk) {
        trace(paths, first, chunk);
        if (judge_) {
            trace_again_at_borders(paths, first, chunk);
        }
    });
}

namespace {

/// A column of paths from `first` on, each `changed`.
template <class From, class To, class Change>
void copy_changed(const From& column, std::size_t first, int count, To& to, const Change& changed) {
    std::transform(column.data() + first, column.data() + first + count, to.data(),
                   [&](double number) { return static_cast<typename To::value_type>(changed(number)); });
}

template <class T>
void copy_rays(const optics::RayBatch<T>& from, optics::RayBatch<T>& to) {
    const auto copy = [&](const auto& of, auto& column) { std::copy_n(of.begin(), from.size, column.begin()); };
    copy(from.origin.x, to.origin.x);
    copy(from.origin.y, to.origin.y);
    copy(from.origin.z, to.origin.z);
    copy(from.direction.x, to.direction.x);
    copy(from.direction.y, to.direction.y);
    copy(from.direction.z, to.direction.z);
    to.size = from.size;
}

}  // namespace

/// From outside forward through the lens.
template <class T>
void BasicSharedRays<T>::trace(const CameraPathBuffer& paths, std::size_t first, SharedPaths& chunk) {
    const auto turn = [&](const auto& column, auto& to, const auto& changed) {
        copy_changed(column, first, chunk.size, to, changed);
    };
    turn(paths.origin.x, turned_.origin.x, std::identity());
    turn(paths.origin.y, turned_.origin.y, std::identity());
    turn(paths.origin.z, turned_.origin.z, std::identity());
    turn(paths.direction.x, turned_.direction.x, std::negate<>());
    turn(paths.direction.y, turned_.direction.y, std::negate<>());
    turn(paths.direction.z, turned_.direction.z, std::negate<>());
    turned_.size = chunk.size;
    for (std::size_t m = 0; m < chunk.others.size(); ++m) {
        copy_rays(turned_, rays_);
        std::copy_n(chunk.other_wavelengths[m].begin(), chunk.size, rays_.wavelength.begin());
        optics::trace_batch<optics::Direction::forward>(*lens_, rays_, tracing_);
        FilmMeetings& meetings = chunk.others[m];
        meet_film(lens_->at(0).image_z, pupil_->map().plane_z(), *kernels_, rays_, meetings);
        if (chunk.has_pdfs) {
            find_pupil_pdfs(*pupil_, std::span(rays_.wavelength).first(static_cast<std::size_t>(rays_.size)), *kernels_,
                            meetings);
        }
    }
}

template <class T>
void BasicSharedRays<T>::trace_again_at_borders(const CameraPathBuffer& paths, std::size_t first, SharedPaths& chunk) {
    auto& [lens, within_mm, rays, meetings] = *judge_;
    OtherRays found;
    const int count = kernels_->find_at_borders(sensor_, within_mm, chunk, found);
    for (int done = 0; done < count; done += rays.size) {
        rays.size = std::min(kSharedChunk, count - done);
        const std::span now(found.data() + done, static_cast<std::size_t>(rays.size));
        for (std::size_t k = 0; k < now.size(); ++k) {
            const Ray<double> out = paths.ray(first + now[k].path);
            rays.set(static_cast<int>(k), {out.origin, -1.0 * out.direction});
            rays.wavelength[k] = chunk.other_wavelengths[now[k].other][now[k].path];
        }
        optics::trace_batch<optics::Direction::forward>(*lens, rays, tracing_);
        meet_film(lens->at(0).image_z, pupil_->map().plane_z(), *kernels_, rays, meetings);
        for (std::size_t k = 0; k < now.size(); ++k) {
            FilmMeetings& to = chunk.others[now[k].other];
            to.film_x[now[k].path] = meetings.film_x[k];
            to.film_y[now[k].path] = meetings.film_y[k];
            to.transmittance[now[k].path] = meetings.transmittance[k];
        }
    }
}

template class BasicSharedRays<float>;
template class BasicSharedRays<double>;

}  // namespace lensproof::render
