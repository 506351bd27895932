#include <cstdint>
#include <utility>

#include "engine/base/bytes.h"
#include "engine/optics/lens_bytes.h"
#include "engine/render/camera/lens_profile.h"
#include "engine/spectral/wavelengths.h"
#include "profile_digest.h"

namespace lensproof::render {

namespace {

/// Everything that a profile follows from.
std::string key_of(const optics::Lens& lens, const std::vector<double>& wavelengths_nm, double film_radius_mm) {
    std::string key(kProfileDigest);
    append_bytes(key, film_radius_mm, lens.is_rotationally_symmetric, wavelengths_nm.size());
    optics::append_lens_bytes(key, optics::at_wavelength<double>(lens, spectral::kLineD));
    for (const double nm : wavelengths_nm) {
        append_bytes(key, nm);
        optics::append_lens_bytes(key, optics::at_wavelength<double>(lens, nm));
    }
    return key;
}

}  // namespace

std::string LensProfile::serialized() const {
    std::string bytes;
    append_bytes(bytes, front_z, static_cast<std::uint32_t>(at.size()));
    pupil_z.append_to(bytes);
    for (const RadialProfile& profile : at) {
        append_bytes(bytes, profile.transmittance);
        profile.field_angle.curve().append_to(bytes);
        profile.illumination.append_to(bytes);
    }
    return bytes;
}

std::optional<LensProfile> LensProfile::deserialized(std::string_view bytes) {
    const auto front_z = take_bytes<double>(bytes);
    const auto count = take_bytes<std::uint32_t>(bytes);
    auto pupil_z = RadialCurve::taken_from(bytes);
    if (!front_z || !count || !pupil_z) {
        return std::nullopt;
    }
    LensProfile found{.at = {}, .pupil_z = *std::move(pupil_z), .front_z = *front_z};
    for (std::uint32_t i = 0; i < *count; ++i) {
        const auto transmittance = take_bytes<double>(bytes);
        auto field_angle = RadialCurve::taken_from(bytes);
        auto illumination = RadialCurve::taken_from(bytes);
        if (!transmittance || !field_angle || !illumination) {
            return std::nullopt;
        }
        found.at.push_back({.field_angle = RisingCurve(*std::move(field_angle)),
                            .illumination = *std::move(illumination),
                            .transmittance = *transmittance});
    }
    return bytes.empty() ? std::optional(std::move(found)) : std::nullopt;
}

LensProfile kept_profile(const Cache& cache, const optics::Lens& lens, const std::vector<double>& wavelengths_nm,
                         double film_radius_mm) {
    return kept<LensProfile>(cache, "profile", key_of(lens, wavelengths_nm, film_radius_mm),
                             [&] { return traced_profile(lens, wavelengths_nm, film_radius_mm); });
}

}  // namespace lensproof::render
