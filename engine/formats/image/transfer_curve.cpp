#include "engine/formats/image/transfer_curve.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "engine/formats/image/srgb.h"

namespace lensproof::formats {

std::optional<TransferCurve> parse_transfer_curve(const std::string& text) {
    if (text == "srgb") {
        return TransferCurve{.kind = TransferKind::srgb};
    }
    if (text == "rec709") {
        return TransferCurve{.kind = TransferKind::rec709};
    }
    if (text == "linear") {
        return TransferCurve{.kind = TransferKind::linear};
    }
    const std::string prefix = "gamma:";
    double gamma = 0.0;
    const char* const end = text.data() + text.size();
    if (text.rfind(prefix, 0) != 0) {
        return std::nullopt;
    }
    const auto [rest, error] = std::from_chars(text.data() + prefix.size(), end, gamma);
    if (error != std::errc() || rest != end || !(gamma >= 0.1 && gamma <= 10.0)) {
        return std::nullopt;
    }
    return TransferCurve{.kind = TransferKind::gamma, .gamma = gamma};
}

std::string to_text(const TransferCurve& curve) {
    switch (curve.kind) {
        case TransferKind::srgb:
            return "srgb";
        case TransferKind::rec709:
            return "rec709";
        case TransferKind::linear:
            return "linear";
        case TransferKind::gamma:
            break;
    }
    return fmt::format("gamma:{:g}", curve.gamma);
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
