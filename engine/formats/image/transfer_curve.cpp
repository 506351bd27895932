#include "engine/formats/image/transfer_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "engine/base/text.h"
#include "engine/formats/image/srgb.h"

namespace lensproof::formats {

namespace {

constexpr std::array kCurveNames = {"srgb", "rec709", "linear"};  // in TransferKind's order; "gamma:2.2" is its last
constexpr std::string_view kGamma = "gamma:";

}  // namespace

std::optional<TransferCurve> parse_transfer_curve(const std::string& text) {
    const auto* const named = std::ranges::find(kCurveNames, text);
    if (named != kCurveNames.end()) {
        return TransferCurve{.kind = static_cast<TransferKind>(named - kCurveNames.begin())};
    }
    const bool is_gamma = text.starts_with(kGamma);
    const double gamma = is_gamma ? parse_exact<double>(text.substr(kGamma.size())).value_or(0.0) : 0.0;
    return gamma >= 0.1 && gamma <= 10.0 ? std::optional(TransferCurve{.kind = TransferKind::gamma, .gamma = gamma})
                                         : std::nullopt;
}

std::string to_text(const TransferCurve& curve) {
    return curve.kind == TransferKind::gamma ? fmt::format("{}{:g}", kGamma, curve.gamma)
                                             : kCurveNames[static_cast<std::size_t>(curve.kind)];
}

float to_linear(const TransferCurve& curve, float value) {
    if (!(value > 0.0F)) {
        return value;
    }
    switch (curve.kind) {
        case TransferKind::srgb:
            return srgb_to_linear(value);
        case TransferKind::rec709:
            return value < 0.081F ? value / 4.5F : std::pow((value + 0.099F) / 1.099F, 1.0F / 0.45F);
        case TransferKind::linear:
            return value;
        case TransferKind::gamma:
            break;
    }
    return std::pow(value, static_cast<float>(curve.gamma));
}

}  // namespace lensproof::formats
