// calibration/detection/blob_lattice.h — spots in a picture that stand in rows and columns.
#pragma once
#include <opencv2/core.hpp>
#include <vector>

namespace lensproof::calibration {

inline constexpr std::size_t kFewestSpots = 9;  // that make a lattice

/// A spot of a lattice: in which column and row it stands, from 0, and its middle, px.
struct LatticeSpot {
    int column = 0;
    int row = 0;
    cv::Point2f middle;
};

/// The largest lattice of dark spots on bright ground, or of bright ones on dark, in a CV_8U picture. Rows run to the
/// right as far as possible, columns down; never mirrored. Empty where no nine spots stand together.
///
/// Spots are what adaptive thresholds leave, whole within the frame and about as compact as an ellipse or a square.
/// The lattice grows from spot to spot by the steps around each, so that neither perspective nor a fisheye matters, and
/// gaps, strangers among the spots and a frame that cuts the lattice do no harm.
///
/// `is_fine`: spots may be small against what lies between them, so that thresholds adapt to small surroundings too;
/// those would break cells with thin walls into pieces. Spots that are not fine are cells: with a wall on every side.
std::vector<LatticeSpot> find_blob_lattice(const cv::Mat& picture, bool dark, bool is_fine);

}  // namespace lensproof::calibration
