// experiments/cli/compare_page.h — two pictures and what was found of them as a page to look at.
#pragma once
#include <string>

#include "calibration/comparison/picture_comparison.h"
#include "experiments/cli/compare_pictures.h"
#include "experiments/cli/compare_places.h"

namespace lensproof::cli {

struct PageSubject {
    const std::string& file;
    const formats::Image& image;
    bool is_high_range = false;
};

/// The page (experiments/draw/report/report.h): `a` and `b` over it laid over each other, with their maps, numbers,
/// limits, radial curves, and what was found at places of both. `found` has maps.
std::string comparison_page(const PageSubject& a, const std::string& b, const calibration::PictureComparison& found,
                            const ComparedPlaces& places, const PictureOptions& options);

}  // namespace lensproof::cli
