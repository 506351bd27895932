// calibration/export/lensfun.h — a profile as an entry of lensfun's database.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "calibration/export/ideal_projection.h"
#include "calibration/profile/profile.h"

namespace lensproof::calibration {

struct LensfunOptions {
    double crop_factor = 1.0;          // diagonal of 36 × 24 mm over the sensor's
    double focal_length_mm = 50.0;     // nominal: what the camera notes in its pictures
    std::optional<double> f_number;    // without it vignetting is left out: lensfun keeps it by aperture
    double focus_distance_m = 1000.0;  // lensfun's word for infinity
    std::string maker = "unknown";
    std::string model = "unknown";
    std::string mount = "Generic";
    /// The projection that distortion is a departure from. Not set: rectilinear for fields up to
    /// 52° from the axis, else the one that the lens departs least from.
    std::optional<optics::Projection> type;
};

struct LensfunExport {
    std::string xml;
    optics::Projection type = optics::Projection::rectilinear;
    std::string distortion_model;            // poly3, poly5 or ptlens
    double corrected_focal_length_px = 0.0;  // f of the ideal projection that lensfun's correction leads to
    double largest_difference_px = 0.0;      // of distortion, over the covered frame
    std::vector<std::string> notes;          // what was approximated or left out, with the size of the difference
};

/// lensfun's normalisations (0.3.3; the tests ask the library itself), with w × h pixels and D = √((w−1)² + (h−1)²):
/// - distortion and chromatic shift (TCA): radius 1 at D/2 / √(a² + 1) px, a the aspect ratio that the file states
/// (which
///   is nearly half the shorter side),
/// - vignetting: radius 1 at D/2,
/// - the centre: its offset from the middle of the picture in units of (min(w, h) − 1) / 2.
///
/// Distortion is that of poly3, poly5 and ptlens which differs least from the profile's mapping over the covered frame
/// (least squares in the radius); tangential terms have no place in lensfun, so they are part of the difference. TCA is
/// linear where that differs by less than 0.01 px, else poly3, fitted to the curves chromatic_shift_R/B_px. Vignetting
/// is `pa`, fitted to green's curve (else the only or first channel's).
///
/// Throws InputError for a profile without geometry, and where no polynomial follows the mapping without folding back.
LensfunExport lensfun_export(const Profile& profile, const LensfunOptions& options);

}  // namespace lensproof::calibration
