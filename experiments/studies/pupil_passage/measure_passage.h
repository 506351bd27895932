// experiments/studies/pupil_passage/measure_passage.h — how many camera paths leave a lens, with and without pupil
// sampling.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/json_archive.h"
#include "engine/optics/lens.h"

namespace lensproof::studies {

/// A lens whose camera paths are counted.
struct PassageSetting {
    std::string lens;
    double f_number = 0.0;
    struct Published {
        double whole_element_percent = 0.0;
        double pupil_percent = 0.0;
    };
    std::optional<Published> published;
};

inline constexpr int kPassageRings = 8;  // of the image circle, of equal width

/// A path in the section x = 0, from the sensor to where it left the front or was stopped; lens space, mm.
struct DrawnPath {
    std::vector<Vec2d> points;  // (z, y)
    bool passes = false;
};

/// One technique of choosing paths' first points.
struct PassageOf {
    std::array<double, kPassageRings> rings{};  // fractions that pass
    double mean = 0.0;                          // over the image circle's area
    double error = 0.0;                         // standard, from independent scrambles of the sequence
    std::vector<DrawnPath> drawn;               // from a few heights, evenly over what is drawn from there
};

/// Both, of a lens.
struct PassageCounts {
    double circle_mm = 0.0;  // radius: where the last light of the band ends, or what is stated, if that is smaller
    PassageOf whole_element;
    PassageOf pupil;
};

void fields(JsonArchive& json, PassageCounts& counts);

struct Passage : PassageCounts {
    PassageSetting setting;
    optics::Lens lens;
};

/// The lens as it is set. Throws InputError for one that cannot be loaded or set so.
optics::Lens passage_lens(const PassageSetting& setting);

/// Traces paths of wavelengths from 400 to 700 nm.
PassageCounts count_passage(const optics::Lens& lens, std::uint64_t seed);

/// Both together.
Passage measure_passage(const PassageSetting& setting, std::uint64_t seed);

}  // namespace lensproof::studies
