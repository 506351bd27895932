#include "calibration/statistics/estimates_json.h"

#include <algorithm>
#include <cmath>

namespace lensproof::calibration {

void estimates(JsonArchive& json, std::vector<std::string>& names, std::vector<double>& values,
               const std::vector<double>& covariance) {
    json.group("parameters", [&](JsonArchive& list) {
        if (list.reading()) {
            names = list.keys();
            values.resize(names.size());
        }
        const std::size_t count = values.size();
        for (std::size_t i = 0; i < count; ++i) {
            list.group(names[i], [&](JsonArchive& one) {
                one.field("value", values[i]);
                if (!one.reading()) {
                    one.derived("standard_error", std::sqrt(std::max(covariance[i * (count + 1)], 0.0)));
                }
            });
        }
    });
}

}  // namespace lensproof::calibration
