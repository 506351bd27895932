// engine/render/camera/packet/path_kernel.h — the loops that camera paths start with and are weighed in, for compilers
// to vectorise.
//
// Only a file for each level includes this (.ci/rooms.cmake), compiled for its own instructions, so what it
// defines must not be shared with code for other machines: everything here is a template over the packs' Abi, and
// inlined.
#pragma once
#include <algorithm>
#include <numeric>

#include "engine/base/pack.h"
#include "engine/base/twin.h"
#include "engine/render/camera/packet/aim.h"
#include "engine/render/camera/packet/meet_film.h"
#include "engine/render/camera/packet/path_kernels.h"
#include "engine/render/camera/packet/shared_weights.h"
#include "engine/render/sampling/sampler.h"

namespace lensproof::render {

/// The next samples of one pixel.
template <class Abi>
void draw_in_pixel(Sensor sensor, std::uint64_t seed, const PathCursor& cursor, int first, int count,
                   PathStarts& starts) {
    const std::uint32_t first_sample = cursor.first_sample + cursor.sample;
    double* film_x = starts.film_x.data() + first;
    double* film_y = starts.film_y.data() + first;
    PixelSampler(seed, cursor.pixel)
        .points(first_sample, static_cast<std::uint32_t>(count),
                {film_x, film_y, starts.pupil_u.data() + first, starts.pupil_v.data() + first,
                 starts.wavelength_number.data() + first});
    const auto width = static_cast<std::uint32_t>(sensor.width);
    const std::uint32_t row = cursor.pixel / width;
    const std::uint32_t column = cursor.pixel - row * width;
    const double u = static_cast<double>(column) - 0.5;
    const double v = static_cast<double>(row) - 0.5;
    for (int i = 0; i < count; ++i) {
        film_x[i] = sensor.position(u + film_x[i], 0.0).x;
    }
    for (int i = 0; i < count; ++i) {
        film_y[i] = sensor.position(0.0, v + film_y[i]).y;
    }
    std::fill_n(starts.pixel.data() + first, count, cursor.pixel);
    std::iota(starts.sample.data() + first, starts.sample.data() + first + count, first_sample);
}

template <class Abi>
[[gnu::flatten]] void draw_samples(const PathSampling& sampling, int count, PathCursor& cursor, PathStarts& starts) {
    starts.size = count;
    for (int done = 0; done < count;) {
        const auto left_in_pixel =
            static_cast<int>(std::min(cursor.samples - cursor.sample, std::uint32_t{kPathChunk}));
        const int run = std::min(count - done, left_in_pixel);
        draw_in_pixel<Abi>(sampling.sensor, sampling.seed, cursor, done, run, starts);
        done += run;
        cursor.sample += static_cast<std::uint32_t>(run);
        if (cursor.sample == cursor.samples) {
            cursor.sample = 0;
            if (++cursor.pixel == cursor.row_end) {
                cursor.pixel += cursor.beside_row;
                cursor.row_end += cursor.row_pixels + cursor.beside_row;
            }
        }
    }
    for (int i = 0; i < count; ++i) {
        starts.wavelength[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(
            static_cast<int>(starts.wavelength_number[static_cast<std::size_t>(i)] * sampling.wavelengths));
    }
}

template <class Abi>
[[gnu::flatten]] void draw_pupil_points(const pupil::PupilSliceTables& slices, PathStarts& starts) {
    using Numbers = Twin<Twin<Pack<double, Abi>>>;
    const Numbers defensive_fraction(slices.defensive_fraction);
    for (int i = 0; i < starts.size; i += Numbers::kLanes) {
        const pupil::PupilSlice<Numbers> slice(
            slices, Numbers::load(starts.wavelength.data() + i),
            {Numbers::load(starts.film_x.data() + i), Numbers::load(starts.film_y.data() + i)});
        const Numbers u = Numbers::load(starts.pupil_u.data() + i);
        const pupil::PupilDraw<Numbers> draw = slice.sample(u, Numbers::load(starts.pupil_v.data() + i));
        draw.point.x.store(starts.pupil_x.data() + i);
        draw.point.y.store(starts.pupil_y.data() + i);
        select(u < defensive_fraction, Numbers(-1.0), draw.area).store(starts.pupil_area.data() + i);
    }
}

template <class Abi>
[[gnu::flatten]] void aim_rays(double film_z, double pupil_z, PathStarts& starts, optics::RayBatch<double>& rays) {
    using Numbers = Pack<double, Abi>;
    const Numbers z(film_z);
    const Numbers to_pupil_z(pupil_z - film_z);
    for (int i = 0; i < starts.size; i += Numbers::kLanes) {
        const Numbers x = Numbers::load(starts.film_x.data() + i);
        const Numbers y = Numbers::load(starts.film_y.data() + i);
        const auto [direction, etendue] =
            aim<Numbers>({x, y}, {Numbers::load(starts.pupil_x.data() + i), Numbers::load(starts.pupil_y.data() + i)},
                         to_pupil_z, Numbers::load(starts.pupil_area.data() + i));
        etendue.store(starts.etendue.data() + i);
        rays.store(i, Ray<Numbers>{{x, y, z}, direction});
    }
    std::copy_n(starts.wavelength.data(), starts.size, rays.wavelength.data());
    rays.size = starts.size;
}

template <class Abi>
[[gnu::flatten]] void leave_ideal_camera(const IdealOpticsColumns& optics, PathStarts& starts,
                                         optics::RayBatch<double>& rays) {
    using Numbers = Pack<double, Abi>;
    for (int i = 0; i < starts.size; i += Numbers::kLanes) {
        const auto of = [&](const std::vector<double>& column) {
            return Numbers::gather(column.data(), starts.wavelength.data() + i);
        };
        const auto [ray, weight] = ideal_path<Numbers>(
            {of(optics.to_pupil_z), of(optics.pupil_radius), of(optics.pupil_area), of(optics.object_z), of(optics.h_h),
             of(optics.h_s), of(optics.s_h), of(optics.s_s), of(optics.transmittance)},
            {Numbers::load(starts.film_x.data() + i), Numbers::load(starts.film_y.data() + i)},
            Numbers::load(starts.pupil_u.data() + i), Numbers::load(starts.pupil_v.data() + i));
        (weight * Numbers::load(starts.filter_weight.data() + i)).store(starts.weight.data() + i);
        rays.store(i, ray);
    }
    rays.size = starts.size;
}

template <class Abi>
[[gnu::flatten]] void leave_profile_camera(const ProfileTables& tables, PathStarts& starts,
                                           optics::RayBatch<double>& rays) {
    using Numbers = Twin<Twin<Pack<double, Abi>>>;
    for (int i = 0; i < starts.size; i += Numbers::kLanes) {
        const ProfilePaths<Numbers> paths(
            tables, {Numbers::load(starts.film_x.data() + i), Numbers::load(starts.film_y.data() + i)},
            Numbers::load(starts.wavelength.data() + i));
        const auto [ray, illumination, etendue] =
            paths.draw(Numbers::load(starts.pupil_u.data() + i), Numbers::load(starts.pupil_v.data() + i));
        illumination.store(starts.weight.data() + i);
        etendue.store(starts.etendue.data() + i);
        rays.store(i, ray);
    }
    rays.size = starts.size;
}

template <class Abi>
[[gnu::flatten]] void meet_profile_film(const ProfileTables& tables, const ProfilePathColumns& columns,
                                        SharedPaths& shared) {
    using Numbers = Twin<Pack<double, Abi>>;
    static_assert(Numbers::kLanes <= optics::kMostLanes);  // buffers end there
    const auto vector = [](const Vec3<const double*>& of, int i) {
        return Vec3<Numbers>{Numbers::load(of.x + i), Numbers::load(of.y + i), Numbers::load(of.z + i)};
    };
    for (int i = 0; i < shared.size; i += Numbers::kLanes) {
        const ProfilePaths<Numbers> paths(tables,
                                          {Numbers::load(columns.film.x + i), Numbers::load(columns.film.y + i)},
                                          Numbers::load(shared.hero_wavelengths.data() + i));
        const Vec2<Numbers> q = paths.offset({vector(columns.ray.origin, i), vector(columns.ray.direction, i)});
        const Numbers g = profile_per_etendue(tables, paths.chief(), q);
        for (std::size_t m = 0; m < shared.others.size(); ++m) {
            const auto arrival = paths.arrival(Numbers::load(shared.other_wavelengths[m].data() + i), q, g);
            FilmMeetings& meetings = shared.others[m];
            arrival.film.x.store(meetings.film_x.data() + i);
            arrival.film.y.store(meetings.film_y.data() + i);
            arrival.transmittance.store(meetings.transmittance.data() + i);
            arrival.per_etendue.store(meetings.per_etendue.data() + i);  // all of the pdf
            Numbers(1.0).store(meetings.pupil_pdf.data() + i);
        }
    }
}

template <class Abi, class T>
[[gnu::flatten]] void cross_film_with(double film_z, double pupil_z, const optics::RayBatch<T>& behind,
                                      FilmMeetings& meetings) {
    using Numbers = Pack<double, Abi>;
    const auto vectors = [](const typename optics::RayBatch<T>::Vectors& of, int i) {
        return Vec3<Numbers>{Numbers::load(of.x.data() + i), Numbers::load(of.y.data() + i),
                             Numbers::load(of.z.data() + i)};
    };
    for (int i = 0; i < behind.size; i += Numbers::kLanes) {
        const FilmCrossing<Numbers> at = cross_film<Numbers>({vectors(behind.origin, i), vectors(behind.direction, i)},
                                                             Numbers(film_z), Numbers(pupil_z));
        at.film.x.store(meetings.film_x.data() + i);
        at.film.y.store(meetings.film_y.data() + i);
        at.pupil.x.store(meetings.pupil_x.data() + i);
        at.pupil.y.store(meetings.pupil_y.data() + i);
        at.per_etendue.store(meetings.per_etendue.data() + i);
    }
}

template <class Abi>
[[gnu::flatten]] void weigh_pupil_points(const pupil::PupilSliceTables& slices, const std::uint16_t* wavelength,
                                         int count, FilmMeetings& meetings) {
    using Numbers = Twin<Twin<Pack<double, Abi>>>;
    for (int i = 0; i < count; i += Numbers::kLanes) {
        const pupil::PupilSlice<Numbers> slice(
            slices, Numbers::load(wavelength + i),
            {Numbers::load(meetings.film_x.data() + i), Numbers::load(meetings.film_y.data() + i)});
        slice.pdf({Numbers::load(meetings.pupil_x.data() + i), Numbers::load(meetings.pupil_y.data() + i)})
            .store(meetings.pupil_pdf.data() + i);
    }
}

/// Those of the m-th of the others, from the i-th path on, beside heroes of `hero_pdf`.
template <class Numbers>
FilmArrival<Numbers> arrivals(const Sensor& sensor, const SharedPaths& paths, std::size_t m, int i,
                              const Numbers& hero_pdf) {
    const FilmMeetings& meetings = paths.others[m];
    const Numbers transmittance = Numbers::load(meetings.transmittance.data() + i);
    const auto arrives = transmittance >= Numbers(0.0);
    const Numbers pdf =
        paths.has_pdfs ? Numbers::load(meetings.pupil_pdf.data() + i) * Numbers::load(meetings.per_etendue.data() + i)
                       : hero_pdf;
    return {.at_px = sensor.pixel<Numbers>(
                {Numbers::load(meetings.film_x.data() + i), Numbers::load(meetings.film_y.data() + i)}),
            .transmittance = select(arrives, transmittance, Numbers(0.0)),
            .pdf = select(arrives, pdf, Numbers(0.0))};
}

template <class Abi>
[[gnu::flatten]] int find_at_borders(const Sensor& sensor, double within_mm, const SharedPaths& paths,
                                     OtherRays& found) {
    using Numbers = Pack<double, Abi>;
    const Numbers half(0.5 * sensor.pixel_pitch_mm);
    int count = 0;
    for (int i = 0; i < paths.size; i += Numbers::kLanes) {
        const Vec2<Numbers> centre = sensor.position<Numbers>(
            {Numbers::load(paths.centre_x.data() + i), Numbers::load(paths.centre_y.data() + i)});
        for (std::size_t m = 0; m < paths.others.size(); ++m) {
            const FilmMeetings& meetings = paths.others[m];
            const Numbers x = abs(Numbers::load(meetings.film_x.data() + i) - centre.x);
            const Numbers y = abs(Numbers::load(meetings.film_y.data() + i) - centre.y);
            const auto is_near = abs(select(x > y, x, y) - half) < Numbers(within_mm) &&
                                 Numbers::load(meetings.transmittance.data() + i) >= Numbers(0.0);
            for (int lane = 0; any(is_near) && lane < std::min(Numbers::kLanes, paths.size - i); ++lane) {
                found[static_cast<std::size_t>(count)] = {static_cast<std::uint16_t>(i + lane),
                                                          static_cast<std::uint16_t>(m)};
                count += is_near[lane] ? 1 : 0;
            }
        }
    }
    return count;
}

template <class Abi>
[[gnu::flatten]] void trace_shared(const Sensor& sensor, SharedPaths& paths) {
    using Numbers = Pack<double, Abi>;
    for (int i = 0; i < paths.size; i += Numbers::kLanes) {
        const Numbers hero_pdf = Numbers(1.0) / Numbers::load(paths.hero_etendue.data() + i);
        const FilmArrival<Numbers> hero{
            .at_px = {}, .transmittance = Numbers::load(paths.hero_weight.data() + i) * hero_pdf, .pdf = hero_pdf};
        const auto shared = shared_weights<Numbers, spectral::kWavelengthsPerPath>(
            {hero, arrivals(sensor, paths, 0, i, hero_pdf), arrivals(sensor, paths, 1, i, hero_pdf),
             arrivals(sensor, paths, 2, i, hero_pdf)},
            {Numbers::load(paths.centre_x.data() + i), Numbers::load(paths.centre_y.data() + i)});
        for (std::size_t m = 0; m < shared.weight.size(); ++m) {
            shared.weight[m].store(paths.weight[m].data() + i);
        }
        shared.shared_pdf.store(paths.shared_pdf.data() + i);
        shared.hero_pdf.store(paths.hero_pdf.data() + i);
    }
}

template <>
PathKernels path_kernels_at<SimdLevel::LENSPROOF_LEVEL>() {
    using Abi = AbiOf<SimdLevel::LENSPROOF_LEVEL, double>;
    return {.draw_samples = draw_samples<Abi>,
            .draw_pupil_points = draw_pupil_points<Abi>,
            .aim_rays = aim_rays<Abi>,
            .leave_ideal_camera = leave_ideal_camera<Abi>,
            .leave_profile_camera = leave_profile_camera<Abi>,
            .meet_profile_film = meet_profile_film<Abi>,
            .cross_film = cross_film_with<Abi, double>,
            .cross_film_in_float = cross_film_with<Abi, float>,
            .weigh_pupil_points = weigh_pupil_points<Abi>,
            .find_at_borders = find_at_borders<Abi>,
            .trace_shared = trace_shared<Abi>};
}

}  // namespace lensproof::render
