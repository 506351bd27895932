#include "engine/analysis/psf.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <opencv2/core.hpp>

#include "engine/base/input_error.h"

namespace lensproof::analysis {

namespace {

constexpr double kMicrometre = 1e-3;  // mm

double wavelength_mm(double wavelength_nm) {
    return 1e-6 * wavelength_nm;
}

/// The maximum of `value` near `start` by compass search: by steps along the axes, halved where none is better by what
/// could matter. Near a maximum an error e of the place costs e² of the value.
Vec2d climb(const std::function<double(Vec2d)>& value, Vec2d start, double step) {
    constexpr int kHalvings = 12;
    constexpr int kMoves = 64;            // a ring of equal maxima could be followed for long
    constexpr double kGain = 1.0 + 1e-9;  // far beyond the sampling's own error
    double best = value(start);
    int moves = 0;
    for (int halving = 0; halving < kHalvings && moves < kMoves;) {
        Vec2d better = start;
        for (const Vec2d move : {Vec2d{step, 0.0}, Vec2d{-step, 0.0}, Vec2d{0.0, step}, Vec2d{0.0, -step}}) {
            const Vec2d there = start + move;
            if (const double here = value(there); here > best * kGain) {
                best = here;
                better = there;
            }
        }
        if (better == start) {
            step *= 0.5;
            ++halving;
        } else {
            ++moves;
        }
        start = better;
    }
    return start;
}

/// Sets the peak between pixels, from the largest pixel on.
void find_peak(Psf& psf, const std::function<double(Vec2d)>& irradiance_at) {
    const auto largest = std::ranges::max_element(psf.irradiance) - psf.irradiance.begin();
    const Vec2d pixel{psf.position_um(static_cast<int>(largest % psf.size)),
                      psf.position_um(static_cast<int>(largest / psf.size))};
    psf.peak_um = climb(irradiance_at, pixel, 0.5 * psf.pixel_um);
    psf.strehl = irradiance_at(psf.peak_um) / psf.perfect_peak;
}

/// |∫ A exp(i k V) dL dM|² becomes irradiance in 1/µm² by this factor, over the cells' or nodes' own.
double irradiance_scale(double weight, double energy, double wavelength_nm) {
    const double wavelength = wavelength_mm(wavelength_nm);
    return weight / (wavelength * wavelength * energy) * kMicrometre * kMicrometre;
}

double scale_of(const SampledPupil& pupil) {
    const double cell = pupil.spacing * pupil.spacing;
    return irradiance_scale(pupil.weight, pupil.energy, pupil.wavelength_nm) * cell * cell;
}

/// The irradiance at any point, by the sum over the cells.
double irradiance_at(const SampledPupil& pupil, const std::vector<std::complex<double>>& function, Vec2d point_um) {
    const double turn = 2.0 * std::numbers::pi / wavelength_mm(pupil.wavelength_nm) * pupil.spacing * kMicrometre;
    std::complex<double> sum = 0.0;
    for (int row = 0; row < pupil.size; ++row) {
        std::complex<double> line = 0.0;
        const std::complex<double> step = std::polar(1.0, turn * point_um.x);
        std::complex<double> phase = 1.0;
        for (int column = 0; column < pupil.size; ++column) {
            line += function[pupil.cell(row, column)] * phase;
            phase *= step;
        }
        sum += line * std::polar(1.0, turn * point_um.y * row);
    }
    return scale_of(pupil) * std::norm(sum);
}

/// Adds one wavelength's irradiance to the picture.
void add_transform(Psf& psf, const SampledPupil& pupil, const std::vector<std::complex<double>>& function) {
    const int size = psf.size;
    cv::Mat grid = cv::Mat::zeros(size, size, CV_64FC2);
    const int before = size / 2 - pupil.size / 2;
    for (int row = 0; row < pupil.size; ++row) {
        for (int column = 0; column < pupil.size; ++column) {
            // The checkerboard's signs move the zero of positions to the middle of the picture.
            const double sign = (row + column) % 2 == 0 ? 1.0 : -1.0;
            const std::complex<double> value = sign * function[pupil.cell(row, column)];
            grid.at<cv::Vec2d>(before + row, before + column) = {value.real(), value.imag()};
        }
    }
    cv::dft(grid, grid, cv::DFT_INVERSE);  // the positive exponent, unscaled
    const double scale = scale_of(pupil);
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
            const auto& value = grid.at<cv::Vec2d>(row, column);
            psf.irradiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                           static_cast<std::size_t>(column)] += scale * (value[0] * value[0] + value[1] * value[1]);
        }
    }
}

Psf empty_psf(int size, double pixel_um) {
    const auto side = static_cast<std::size_t>(size);
    return {.size = size, .pixel_um = pixel_um, .irradiance = std::vector<double>(side * side, 0.0)};
}

/// A wavelet's source on the reference sphere.
struct Wavelet {
    Vec3d towards;
    double path;
    double amplitude;  // √(d area · d cosines) of its node, mm
};

struct WaveletPart {
    double wavelength_nm;
    double weight;
    double index;  // of the medium that the sensor stands in
    double energy = 0.0;
    std::vector<Wavelet> wavelets{};
};

WaveletPart wavelets_of(const PolychromaticField& field, const PolychromaticField::Part& part,
                        const HuygensPsfSettings& settings) {
    WaveletPart found{
        .wavelength_nm = part.wavelength_nm, .weight = part.weight, .index = part.lens.surfaces.back().index_after};
    const auto meet = [&](Vec2d offset) {
        return meet_sphere(part.lens, field.sphere, optics::trace_past_rims(part.lens, field.bundle.ray(offset)));
    };
    const double step = 1e-4 * std::sqrt(part.outline.area);
    const double mean_path = meet(part.outline.centre).value_or(SphereMeeting{}).optical_path;
    for (const optics::RegionNode& node : polar_nodes(part, field.bundle, settings.azimuths, settings.rings)) {
        const auto here = meet(node.point);
        const auto right = meet(node.point + Vec2d{step, 0.0});
        const auto left = meet(node.point - Vec2d{step, 0.0});
        const auto up = meet(node.point + Vec2d{0.0, step});
        const auto down = meet(node.point - Vec2d{0.0, step});
        if (!here || !right || !left || !up || !down) {
            continue;
        }
        const Vec3d by_x = right->towards - left->towards;
        const Vec3d by_y = up->towards - down->towards;
        const double cosines = std::abs(by_x.x * by_y.y - by_x.y * by_y.x) / (4.0 * step * step);
        found.wavelets.push_back({here->towards, here->optical_path - mean_path, node.weight * std::sqrt(cosines)});
        found.energy += node.weight;
    }
    return found;
}

/// The irradiance at a point, 1/µm².
double irradiance_at(const WaveletPart& part, double curvature, Vec2d point_um) {
    const Vec2d point = kMicrometre * point_um;
    const double wavenumber = 2.0 * std::numbers::pi / wavelength_mm(part.wavelength_nm);
    const double c_by_index = curvature / part.index;
    const double c_square = part.index * curvature * dot(point, point);
    std::complex<double> sum = 0.0;
    for (const Wavelet& wavelet : part.wavelets) {
        const double along = wavelet.towards.x * point.x + wavelet.towards.y * point.y;
        const double distance = std::sqrt(1.0 + c_by_index * (2.0 * along + c_square));  // over the radius
        const double longer = (2.0 * along + c_square) / (1.0 + distance);
        sum += std::polar(wavelet.amplitude / distance, wavenumber * (wavelet.path + longer));
    }
    return irradiance_scale(part.weight, part.energy, part.wavelength_nm) * std::norm(sum);
}

/// Whether no two neighbouring nodes differ by more than half a wave anywhere in the picture: a node's spacing in
/// direction, times the distance from its ray's point in the picture to the farthest corner.
bool are_close(const WaveletPart& part, double reach_mm, const HuygensPsfSettings& settings) {
    double width = 0.0;
    for (const Wavelet& wavelet : part.wavelets) {
        const Vec3d apart = wavelet.towards - part.wavelets.front().towards;
        width = std::max(width, std::hypot(apart.x, apart.y));
    }
    // Gauss-Legendre nodes are at most π/2 times as far apart as even ones.
    const double spread = 0.5 * std::numbers::pi * 0.5 * width;
    const double radial = spread / settings.rings;
    const double azimuthal = spread * 2.0 * std::numbers::pi / settings.azimuths;
    return reach_mm * std::max(radial, azimuthal) <= 0.5 * wavelength_mm(part.wavelength_nm);
}

}  // namespace

Psf fft_psf(const PolychromaticField& field, const FftPsfSettings& settings) {
    const int size = settings.size;
    if (size < 8 || size > 8192 || !std::has_single_bit(static_cast<unsigned>(size))) {
        throw InputError(fmt::format("a PSF of {} pixels a side: expected a power of two from 8 to 8192", size));
    }
    double finest = 0.0;  // µm
    for (const PolychromaticField::Part& part : field.parts) {
        const double nyquist =
            wavelength_mm(part.wavelength_nm) / (2.0 * cosine_box(field, part).width()) / kMicrometre;
        finest = finest > 0.0 ? std::min(finest, nyquist) : nyquist;
    }
    Psf psf = empty_psf(size, settings.pixel_um > 0.0 ? settings.pixel_um : finest);
    std::vector<SampledPupil> pupils;
    std::vector<std::vector<std::complex<double>>> functions;
    for (const PolychromaticField::Part& part : field.parts) {
        const double spacing = wavelength_mm(part.wavelength_nm) / (size * psf.pixel_um * kMicrometre);
        if (pupil_cells(cosine_box(field, part).width(), spacing) > size) {
            throw InputError(fmt::format(
                "pixels of {} µm are too coarse for this PSF: expected less than about {:.3g} µm at {} a side",
                psf.pixel_um, 1.9 * finest, size));
        }
        const SampledPupil& pupil = pupils.emplace_back(sample_pupil(field, part, spacing));
        functions.push_back(pupil_function(pupil));
        psf.largest_aberration_um = std::max(psf.largest_aberration_um, pupil.largest_aberration / kMicrometre);
        if (pupil.status != PupilStatus::ok) {
            psf.status = pupil.status;
        } else if (pupils.size() == 1) {
            psf.status = PupilStatus::ok;
        }
        if (!(pupil.energy > 0.0)) {
            return psf;
        }
        add_transform(psf, pupil, functions.back());
        psf.perfect_peak += irradiance_at(pupil, pupil_function(pupil, true), {});
    }
    if (pupils.empty()) {
        return psf;
    }
    // Rays between the samples may land a little farther.
    const double window = 1.05 * 2.0 * psf.largest_aberration_um / psf.pixel_um;
    psf.needed_size = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::clamp(std::ceil(window), 8.0, 1e9))));
    find_peak(psf, [&](Vec2d point_um) {
        double sum = 0.0;
        for (std::size_t i = 0; i < pupils.size(); ++i) {
            sum += irradiance_at(pupils[i], functions[i], point_um);
        }
        return sum;
    });
    return psf;
}

Psf huygens_psf(const PolychromaticField& field, const HuygensPsfSettings& settings) {
    if (settings.size < 1 || settings.azimuths < 3 || settings.rings < 1 || !(settings.pixel_um > 0.0)) {
        throw InputError("a Huygens PSF needs pixels of positive width, 3 azimuths and a ring");
    }
    Psf psf = empty_psf(settings.size, settings.pixel_um);
    std::vector<WaveletPart> parts;
    const double corner = std::numbers::sqrt2 * 0.5 * settings.size * settings.pixel_um * kMicrometre;
    bool is_seen = true;
    for (const PolychromaticField::Part& part : field.parts) {
        const WaveletPart& wavelets = parts.emplace_back(wavelets_of(field, part, settings));
        double amplitude = 0.0;
        for (const Wavelet& wavelet : wavelets.wavelets) {
            amplitude += wavelet.amplitude;
        }
        double aberration = 0.0;
        for (const optics::OutlinePoint& point : part.outline.points) {
            const Vec2d lands = image_ray(part, field, part.outline.at(point, 1.0)).value_or(ImageRay{}).aberration;
            aberration = std::max(aberration, length(lands));
        }
        psf.largest_aberration_um = std::max(psf.largest_aberration_um, aberration / kMicrometre);
        is_seen = is_seen && !wavelets.wavelets.empty() && are_close(wavelets, corner + aberration, settings);
        psf.perfect_peak +=
            irradiance_scale(wavelets.weight, wavelets.energy, wavelets.wavelength_nm) * amplitude * amplitude;
    }
    if (parts.empty()) {
        return psf;
    }
    const auto irradiance = [&](Vec2d point_um) {
        double sum = 0.0;
        for (const WaveletPart& part : parts) {
            sum += irradiance_at(part, field.sphere.curvature, point_um);
        }
        return sum;
    };
    for (int row = 0; row < settings.size; ++row) {
        for (int column = 0; column < settings.size; ++column) {
            psf.irradiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(settings.size) +
                           static_cast<std::size_t>(column)] =
                irradiance({psf.position_um(column), psf.position_um(row)});
        }
    }
    psf.status = is_seen ? PupilStatus::ok : PupilStatus::aliased;
    find_peak(psf, irradiance);
    return psf;
}

}  // namespace lensproof::analysis
