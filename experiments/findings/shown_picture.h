// experiments/findings/shown_picture.h — a picture as a report shows it.
#pragma once
#include <string>

#include "engine/formats/image/image.h"
#include "experiments/findings/findings.h"

namespace lensproof::findings {

inline constexpr int kShownWidth = 480;  // px: a report holds many pictures

/// A copy as PNG, or as JPEG where its name ends so, smaller where it is wider than that by a factor or more: by a
/// whole number.
Picture shown_picture(const std::string& name, const std::string& caption, const formats::Image& image,
                      int widest = kShownWidth);

/// A drawing (SVG), as large as it says.
Picture drawn_picture(const std::string& name, const std::string& caption, std::string svg);

inline constexpr int kLaidWidth = 960;  // px, of pictures to be laid over each other

/// A copy as JPEG, smaller in the same way.
std::string laid_picture(const formats::Image& image);

}  // namespace lensproof::findings
