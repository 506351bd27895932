#include "calibration/measure/measure_bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/detection/detect.h"
#include "calibration/detection/loose_discs.h"
#include "calibration/detection/refine.h"
#include "calibration/detection/working_copy.h"
#include "engine/base/input_error.h"
#include "engine/spectral/spectral_exr.h"

namespace lensproof::calibration {
namespace {

constexpr double kColoursApart_px = 0.05;    // two ways of finding the same discs differ by 0.04 px
constexpr std::size_t kFewestBandPairs = 5;  // whose scatter tells a standard error

// "450" or "450.5": as few digits as tell a hundredth of a nanometre.
std::string in_nm(double wavelength_nm) {
    std::string text = std::to_string(std::round(wavelength_nm * 100.0) / 100.0);
    text.erase(text.find_last_not_of('0') + 1);
    return (text.back() == '.' ? text.substr(0, text.size() - 1) : text) + "nm";
}

// Finds the points of the reference picture again in another one: none where a point is not there.
using Locator = std::function<std::vector<std::optional<Vec2d>>(const formats::Image&)>;

struct ReferencePoints {
    std::vector<Vec2d> image_px;
    Locator locate;
};

ReferencePoints chart_points(const formats::Image& image, const std::string& name, const scene::Chart& chart) {
    const Detection detection = detect(image, chart);
    if (!detection.found()) {
        throw InputError(name + ": no " + scene::kind_name(chart) + " found: " + detection.reason);
    }
    const ChartPoints points = refine(image, reference_channel(image), detection.points, chart);
    return {
        points.image_px, [points, chart](const formats::Image& other) {
            const ChartPoints found = refine(other, reference_channel(other), points, chart);
            std::vector<std::optional<Vec2d>> places;
            for (std::size_t i = 0; i < found.found.size(); ++i) {
                places.push_back(points.found[i] && found.found[i] ? std::optional(found.image_px[i]) : std::nullopt);
            }
            return places;
        }};
}

ReferencePoints disc_points(const formats::Image& image) {
    const std::vector<LooseDisc> discs = find_loose_discs(image, reference_channel(image));
    ReferencePoints points{.image_px = {}, .locate = [discs](const formats::Image& other) {
                               std::vector<std::optional<Vec2d>> places;
                               places.reserve(discs.size());
                               for (const LooseDisc& disc : discs) {
                                   places.push_back(locate_disc(other, reference_channel(other), disc));
                               }
                               return places;
                           }};
    points.image_px.reserve(discs.size());
    for (const LooseDisc& disc : discs) {
        points.image_px.push_back(disc.centre_px);
    }
    return points;
}

// Means of the shift along the radius and at right angles to it (clockwise), each with its standard error.
FittedTerms mean_shift(const std::vector<ChromaticPair>& pairs, const Vec2d& centre) {
    std::vector<double> along[2];
    for (const ChromaticPair& pair : pairs) {
        const Vec2d q{pair.green_px.x - centre.x, pair.green_px.y - centre.y};
        const Vec2d d{pair.channel_px.x - pair.green_px.x, pair.channel_px.y - pair.green_px.y};
        const double radius = std::hypot(q.x, q.y);
        if (radius > 0.0) {
            along[0].push_back((d.x * q.x + d.y * q.y) / radius);
            along[1].push_back((d.y * q.x - d.x * q.y) / radius);
        }
    }
    FittedTerms terms{.names = {"mean_radial_px", "mean_tangential_px"}, .values = {}, .covariance = {0, 0, 0, 0}};
    for (std::size_t k = 0; k < 2; ++k) {
        const auto count = static_cast<double>(along[k].size());
        double mean = 0.0;
        for (const double value : along[k]) {
            mean += value / count;
        }
        for (const double value : along[k]) {
            terms.covariance[3 * k] += (value - mean) * (value - mean) / (count * (count - 1.0));
        }
        terms.values.push_back(mean);
    }
    return terms;
}

// By how much two sets of the same points lie apart in the mean, along the radius or across: the larger of the two, and
// its standard error.
struct Apart {
    double mean_px = 0.0;
    double standard_error_px = 0.0;

    [[nodiscard]] bool matters() const { return mean_px > kColoursApart_px && mean_px > 3.0 * standard_error_px; }
};

// None where too few are in both.
std::optional<Apart> apart(const std::vector<std::optional<Vec2d>>& a, const std::vector<std::optional<Vec2d>>& b,
                           const Vec2d& centre) {
    std::vector<ChromaticPair> pairs;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i] && b[i]) {
            pairs.push_back({*a[i], *b[i]});
        }
    }
    if (pairs.size() < kFewestBandPairs) {
        return std::nullopt;
    }
    const FittedTerms terms = mean_shift(pairs, centre);
    const std::size_t k = std::abs(terms.values[1]) > std::abs(terms.values[0]) ? 1 : 0;
    return Apart{std::abs(terms.values[k]), std::sqrt(terms.covariance[3 * k])};
}

std::string colour_name(char colour) {
    return colour == 'r' ? "red" : colour == 'g' ? "green" : "blue";
}

// The picture to measure by: all colours mixed where they agree, else the strongest alone, which the profile then says.
const formats::Image& trusted(const BandPlanes& planes, const std::string& name, const Locator& locate,
                              const Vec2d& centre, Profile& profile) {
    for (std::size_t i = 1; i < planes.colours.size(); ++i) {
        const MosaicColour& strongest = planes.colours.front();
        const MosaicColour& other = planes.colours[i];
        const auto by = apart(locate(strongest.plane), locate(other.plane), centre);
        if (!by) {
            profile.warnings.push_back(fmt::format(
                "{}: fewer than {} points are seen by {} and by {} pixels, which are mixed without knowing that they "
                "agree about places",
                name, kFewestBandPairs, colour_name(strongest.colour), colour_name(other.colour)));
        } else if (by->matters()) {
            profile.warnings.push_back(fmt::format(
                "{}: measured by the {} pixels alone, the strongest: the {} ones are {:.2f} ± {:.2f} px off "
                "in the mean, so that they see other light",
                name, colour_name(strongest.colour), colour_name(other.colour), by->mean_px, by->standard_error_px));
            return strongest.plane;
        }
    }
    return planes.image;
}

const BandPicture& reference_of(const BandInput& input) {
    if (input.bands.size() < 2) {
        throw InputError("bands: " + std::to_string(input.bands.size()) + " pictures, expected at least two");
    }
    const BandPicture* reference = nullptr;
    for (const BandPicture& band : input.bands) {
        for (const BandPicture& other : input.bands) {
            if (&band != &other && band.wavelength_nm == other.wavelength_nm) {
                throw InputError("bands: " + band.name + " and " + other.name + " are both at " +
                                 in_nm(band.wavelength_nm) + ", expected one picture a band");
            }
        }
        reference = band.wavelength_nm == input.reference_wavelength_nm ? &band : reference;
    }
    if (reference == nullptr) {
        throw InputError("bands: the reference band is at " + in_nm(input.reference_wavelength_nm) +
                         ", expected one of the pictures' wavelengths");
    }
    return *reference;
}

}  // namespace

std::string channel_label(const std::string& channel) {
    const auto spectral = spectral::parse_spectral_channel(channel);
    return spectral ? in_nm(spectral->wavelength_nm) : channel;
}

void add_chromatic_shift(Profile& profile, const std::string& label, const std::vector<ChromaticPair>& pairs,
                         const Vec2d& centre_px) {
    ChromaticShift shift = fit_chromatic_shift(pairs, centre_px, half_diagonal_px(profile));
    const auto& [c1, c3, c5] = shift.radial_px;
    const auto& [s1, s3] = shift.tangential_px;
    profile.terms[kShiftTerms(label)] = {
        .names = {"c1_px", "c3_px", "c5_px", "s1_px", "s3_px", "translation_x_px", "translation_y_px"},
        .values = {c1, c3, c5, s1, s3, shift.translation_px.x, shift.translation_px.y},
        .covariance = {shift.covariance.begin(), shift.covariance.end()}};
    profile.curves[kQuantities.chromatic_shift.key(label)] = std::move(shift.radial);
    profile.curves[kQuantities.tangential_shift.key(label)] = std::move(shift.tangential);
}

Profile measure_bands(const BandInput& input) {
    const BandPicture& reference = reference_of(input);
    const BandPlanes planes = reference.load();
    Profile profile;
    profile.name = input.name;
    profile.source = input.source;
    profile.source.images.clear();
    profile.width_px = planes.image.width;
    profile.height_px = planes.image.height;
    profile.pixel_pitch_um = input.pixel_pitch_um;
    profile.not_measured[part::kGeometry] = "the pictures are bands of one view";
    const Vec2d centre =
        input.centre_px.value_or(Vec2d{0.5 * (planes.image.width - 1), 0.5 * (planes.image.height - 1)});
    const auto points_of = [&](const formats::Image& image) {
        return input.chart ? chart_points(image, reference.name, *input.chart) : disc_points(image);
    };
    ReferencePoints points = points_of(planes.image);
    const formats::Image& image = trusted(planes, reference.name, points.locate, centre, profile);
    if (&image != &planes.image) {
        points = points_of(image);
    }
    for (const BandPicture& band : input.bands) {
        profile.source.images.push_back(band.name);
        if (&band == &reference) {
            continue;
        }
        const BandPlanes other_planes = band.load();
        const formats::Image& other = other_planes.image;
        if (other.width != image.width || other.height != image.height) {
            throw InputError(band.name + ": the picture is " + std::to_string(other.width) + " × " +
                             std::to_string(other.height) + " pixels: expected " + std::to_string(image.width) + " × " +
                             std::to_string(image.height) + " like " + reference.name);
        }
        const auto places = points.locate(trusted(other_planes, band.name, points.locate, centre, profile));
        std::vector<ChromaticPair> pairs;
        for (std::size_t i = 0; i < places.size(); ++i) {
            if (places[i]) {
                pairs.push_back({points.image_px[i], *places[i]});
            }
        }
        try {
            add_chromatic_shift(profile, in_nm(band.wavelength_nm), pairs, centre);
            profile.terms[kMeanShiftTerms(in_nm(band.wavelength_nm))] = mean_shift(pairs, centre);
        } catch (const InputError& e) {
            throw InputError(band.name + ": " + e.what());
        }
    }
    return profile;
}

}  // namespace lensproof::calibration
