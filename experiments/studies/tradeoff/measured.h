// experiments/studies/tradeoff/measured.h — a number with one standard error.
#pragma once
#include "engine/base/json_archive.h"

namespace lensproof::studies {

struct Measured {
    double value = 0.0;
    double standard_error = 0.0;
};
inline void fields(JsonArchive& json, Measured& measured) {
    json.field("value", measured.value).field("standard_error", measured.standard_error);
}

/// With two standard errors more, and with two less.
inline double at_most(const Measured& measured) {
    return measured.value + 2.0 * measured.standard_error;
}
inline double at_least(const Measured& measured) {
    return measured.value - 2.0 * measured.standard_error;
}

/// The root of a square that was estimated, which noise may have made negative.
Measured root(const Measured& square);

}  // namespace lensproof::studies
