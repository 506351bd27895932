#include "experiments/studies/cameras/reference_curves.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "calibration/photographed/dng_corrections.h"
#include "calibration/photographed/lensfun_database.h"
#include "engine/base/file.h"
#include "engine/base/infinity.h"
#include "engine/base/input_error.h"
#include "engine/formats/image/full_frame.h"
#include "engine/formats/prescription/load_lens.h"
#include "engine/formats/prescription/prescription_file.h"
#include "engine/optics/paraxial.h"
#include "engine/render/camera/camera.h"
#include "engine/spectral/wavelengths.h"
#include "experiments/studies/cameras/lens_profile.h"

namespace lensproof::studies {

namespace {

using calibration::kQuantities;
using calibration::PhotographedLens;

constexpr std::array<std::string_view, 4> kKinds = {"profile:", "lens:", "lensfun:", "dng:"};

/// Of the four kinds the text's; empty where it is none.
std::string_view kind_of(const std::string& text) {
    const auto kind = std::ranges::find_if(kKinds, [&](std::string_view one) { return text.starts_with(one); });
    return kind == kKinds.end() || text.size() == kind->size() ? std::string_view() : *kind;
}

double half_diagonal_mm(const ReferenceSource& source, const calibration::Profile& camera) {
    if (!camera.pixel_pitch_um) {
        throw InputError(
            fmt::format("{}: the pixel pitch of {} is not known, which its curves need", source.stated, camera.name));
    }
    return 0.5e-3 * *camera.pixel_pitch_um * std::hypot(camera.width_px, camera.height_px);
}

/// Its vignetting at the f-number, or where that is not known at the only one.
const calibration::MeasuredVignetting* vignetting_at(const PhotographedLens& lens, double f_number) {
    if (f_number == 0.0) {
        return lens.vignetting.size() == 1 ? &lens.vignetting.front() : nullptr;
    }
    constexpr double kClose = 1.0 / 6.0;  // of a stop
    const auto near = std::ranges::find_if(lens.vignetting, [&](const calibration::MeasuredVignetting& one) {
        return 2.0 * std::abs(std::log2(one.f_number / f_number)) <= kClose;
    });
    return near == lens.vignetting.end() ? nullptr : &*near;
}

/// Along the ideal radius, so that no polynomial has to be inverted.
void add_photographed(const PhotographedLens& lens, double half_diagonal, double pitch_mm, double f_number,
                      calibration::Profile& profile) {
    const bool is_perspective = lens.projection == optics::Projection::rectilinear;
    const std::string distortion =
        is_perspective ? kQuantities.distortion.key() : kQuantities.equidistant_distortion.key();
    const calibration::MeasuredVignetting* vignetting = vignetting_at(lens, f_number);
    for (const double x : calibration::standard_image_heights()) {
        const double radius = x * half_diagonal;
        const std::optional<double> ideal = calibration::ideal_radius(lens, radius);
        if (!ideal || radius > 1.001 * lens.half_diagonal_mm()) {
            break;  // what the entry's pictures did not reach
        }
        // An equidistant fisheye's ideal radius is F θ, a rectilinear lens's F tan θ; of others F is in no common unit.
        const bool has_distortion =
            !lens.distortion_model.empty() && (is_perspective || lens.projection == optics::Projection::equidistant);
        if (has_distortion) {
            calibration::append_exact(
                profile.curves[distortion], x,
                x > 0.0 ? 100.0 * (radius / (calibration::photographed_slope(lens, 0.0) * *ideal) - 1.0) : 0.0);
        }
        if (lens.lateral_colour) {
            calibration::append_exact(profile.curves[kQuantities.chromatic_shift.key("R")], x,
                                      calibration::channel_shift(lens, lens.lateral_colour->red, radius) / pitch_mm);
            calibration::append_exact(profile.curves[kQuantities.chromatic_shift.key("B")], x,
                                      calibration::channel_shift(lens, lens.lateral_colour->blue, radius) / pitch_mm);
        }
        if (vignetting != nullptr) {
            const double light = vignetting->brightness(radius / lens.half_diagonal_mm());
            calibration::append_exact(profile.curves[kQuantities.vignetting.key("G")], x, light);
            calibration::append_exact(profile.curves[kQuantities.vignetting_ev.key("G")], x, std::log2(light));
        }
    }
}

calibration::Profile traced(const ReferenceSource& source, const calibration::Profile& camera, double f_number) {
    render::CameraSettings settings = camera_like(camera, source.file.string());
    const optics::Lens lens = formats::load_lens(settings.lens);
    settings.f_number = f_number > 0.0
                            ? f_number
                            : optics::paraxial_data(optics::at_wavelength<double>(lens, spectral::kLineD)).f_number;
    settings.focus_distance_mm = kInfinity;
    return lens_profile({settings, {}, render::PixelFilter{}, Cache::standard()});
}

}  // namespace

std::string ReferenceSource::label() const {
    const std::string_view kind = kind_of(stated);
    const std::string name = file.empty() ? stated.substr(kind.size()) : file.stem().string();
    return fmt::format("{} {}", kind, name);
}

bool is_reference(const std::string& text) {
    return !kind_of(text).empty();
}

ReferenceSource read_reference(const TomlTable& table, const std::string& key, const std::string& text) {
    const std::string_view kind = kind_of(text);
    if (kind.empty()) {
        table.fail(key, fmt::format("names \"{}\", expected profile:FILE, lens:NAME, lensfun:MODEL or dng:FILE", text));
    }
    ReferenceSource source{.stated = text};
    const std::string name = text.substr(kind.size());
    if (kind == "profile:" || kind == "dng:") {
        source.file = referred_file(table.file(), name);
    } else if (kind == "lens:") {
        const std::filesystem::path beside = referred_file(table.file(), name);
        try {
            source.file = is_there(beside) ? beside : formats::find_lens_file(name);
        } catch (const InputError& error) {
            table.fail(key, error.what());
        }
    }
    if (!source.file.empty() && !is_there(source.file)) {
        table.fail(key, fmt::format("names \"{}\": {} is not there", text, source.file.string()));
    }
    return source;
}

std::vector<ReferenceSource> read_references(TomlTable& table) {
    std::vector<ReferenceSource> sources;
    if (table.has("references")) {
        for (const std::string& text : table.texts("references")) {
            sources.push_back(read_reference(table, "references", text));
        }
    }
    return sources;
}

std::vector<std::filesystem::path> files_of(const std::vector<ReferenceSource>& sources) {
    std::vector<std::filesystem::path> files;
    for (const ReferenceSource& source : sources) {
        if (!source.file.empty()) {
            files.push_back(source.file);
        }
    }
    return files;
}

void add_references(const std::vector<ReferenceSource>& sources, MeasuredCamera& camera, double f_number) {
    for (const ReferenceSource& source : sources) {
        camera.references.push_back(reference_curves(source, camera.profile, f_number));
    }
}

calibration::Profile reference_curves(const ReferenceSource& source, const calibration::Profile& camera,
                                      double f_number) {
    const std::string_view kind = kind_of(source.stated);
    calibration::Profile profile;
    if (kind == "profile:") {
        profile = calibration::read_profile(source.file);
    } else if (kind == "lens:") {
        profile = traced(source, camera, f_number);
    } else {
        const double half_diagonal = half_diagonal_mm(source, camera);
        const double pitch_mm = 1e-3 * *camera.pixel_pitch_um;
        const double focal_mm = camera.geometry ? pitch_mm * calibration::focal_length_px(camera.geometry->model) : 0.0;
        const PhotographedLens lens =
            kind == "dng:" ? calibration::read_dng_corrections(source.file)
                           : calibration::LensfunDatabase::of_system().find(
                                 {.model = source.stated.substr(kind.size()),
                                  .sensor_crop_factor = 0.5 * formats::kFullFrameDiagonal_mm / half_diagonal,
                                  .focal_length_mm = focal_mm});
        add_photographed(lens, half_diagonal, pitch_mm, f_number, profile);
    }
    profile.name = source.label();
    return profile;
}

}  // namespace lensproof::studies
