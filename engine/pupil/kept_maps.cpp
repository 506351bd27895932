#include "engine/pupil/kept_maps.h"

#include <optional>
#include <string>
#include <string_view>

#include "engine/base/bytes.h"
#include "engine/optics/lens_bytes.h"
#include "source_digest.h"

namespace lensproof::pupil {

namespace {

/// Everything that a map follows from. `extent`: the sensor's radius, or the sources' distance.
std::string key_of(const std::vector<optics::TraceLens<double>>& band, bool is_symmetric, double extent,
                   const PupilMapSettings& settings) {
    std::string key(kSourceDigest);
    append_bytes(key, is_symmetric, extent, settings.defensive_fraction, settings.most_excess, band.size());
    for (optics::TraceLens<double> lens : band) {
        open_stop(lens);
        optics::append_lens_bytes(key, lens);
    }
    return key;
}

}  // namespace

PupilMap kept_pupil_map(const Cache& cache, const std::vector<optics::TraceLens<double>>& band, bool by_radius,
                        double sensor_radius_mm, const PupilMapSettings& settings) {
    return kept<PupilMap>(cache, "pupil", key_of(band, by_radius, sensor_radius_mm, settings),
                          [&] { return PupilMap(band, by_radius, sensor_radius_mm, settings); });
}

EntranceMap kept_entrance_map(const Cache& cache, const std::vector<optics::TraceLens<double>>& band, bool by_angle,
                              double distance_mm, const PupilMapSettings& settings) {
    return kept<EntranceMap>(cache, "entrance", key_of(band, by_angle, distance_mm, settings),
                             [&] { return EntranceMap(band, by_angle, distance_mm, settings); });
}

}  // namespace lensproof::pupil
