// engine/formats/image/full_frame.h — the sensor that equivalent focal lengths and crop factors refer to.
#pragma once

namespace lensproof::formats {

inline constexpr double kFullFrameDiagonal_mm = 43.266615305567875;  // of 36 × 24 mm

}  // namespace lensproof::formats
