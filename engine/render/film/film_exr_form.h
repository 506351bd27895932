// engine/render/film/film_exr_form.h — how a film's file is laid out: names of its parts, and its digest.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/hash.h"
#include "engine/spectral/spectral_exr.h"

namespace lensproof::render {

inline constexpr int kRowsAtOnce = 64;
inline constexpr std::size_t kMostPasses = 16;
inline constexpr const char* kIdentityPrefix = "lensproof:identity:";
inline constexpr const char* kLightPaths = "lensproof:lightPaths";
inline constexpr const char* kLeftOut = "lensproof:leftOut";
inline constexpr const char* kDigest = "lensproof:digest";
inline constexpr const char* kPasses = "lensproof:passes";

inline const std::vector<std::string> kRgb = {"R", "G", "B"};
inline const std::vector<std::string> kVariance = {"variance.R", "variance.G", "variance.B"};
inline const std::vector<std::string> kCounts = {"blocks", "samples"};  // in the order that files keep
inline const std::vector<std::string> kFeatures = {"Z",        "albedo.R", "albedo.G", "albedo.B",
                                                   "normal.X", "normal.Y", "normal.Z", "coverage"};

inline std::vector<std::string> joined(std::vector<std::string> names, const std::vector<std::string>& more) {
    names.insert(names.end(), more.begin(), more.end());
    return names;
}

inline std::vector<std::string> spectral_names(const std::vector<double>& layer_nm) {
    std::vector<std::string> names;
    std::ranges::transform(layer_nm, std::back_inserter(names), spectral::spectral_channel_name);
    return names;
}

/// What a part's name begins with.
inline std::string prefix_of(const std::string& pass) {
    return pass.empty() ? "" : pass + ".";
}

/// An attribute of a pass's film.
inline std::string attribute_of(const char* name, const std::string& pass) {
    return pass.empty() ? name : fmt::format("{}:{}", name, pass);
}

/// A digest of pixels, row by row of each part: however many rows are read or written at once.
class PixelDigest {
  public:
    template <class Number>
    void add(const std::string& part, const std::vector<Number>& values, int rows) {
        const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
        const std::size_t row = bytes.size() / static_cast<std::size_t>(rows);
        for (std::size_t at = 0; at < bytes.size(); at += row) {
            std::uint64_t& digest = parts_[part];
            digest = hash_of(bytes.substr(at, row), digest);
        }
    }

    [[nodiscard]] std::string text() const {
        std::string all;
        for (const auto& [part, digest] : parts_) {
            all += fmt::format("{} {:016x}\n", part, digest);
        }
        return hash_text(all);
    }

  private:
    std::map<std::string, std::uint64_t> parts_;
};

}  // namespace lensproof::render
