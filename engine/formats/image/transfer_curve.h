// engine/formats/image/transfer_curve.h — how a picture's numbers became of light.
#pragma once
#include <optional>
#include <string>

namespace lensproof::formats {

enum class TransferKind { srgb, rec709, linear, gamma };

/// The curve from light to the stored value, full scale 1 on both sides.
struct TransferCurve {
    TransferKind kind = TransferKind::srgb;
    double gamma = 2.2;  // of `gamma`: value = light^(1/γ)

    friend bool operator==(const TransferCurve&, const TransferCurve&) = default;
};

/// "srgb" (IEC 61966-2-1), "rec709" (ITU-R BT.709-6), "linear", "gamma:2.2" (0.1 to 10).
std::optional<TransferCurve> parse_transfer_curve(const std::string& text);
std::string to_text(const TransferCurve& curve);

/// The light that a stored value stands for. Values below 0 stay as they are.
float to_linear(const TransferCurve& curve, float value);

}  // namespace lensproof::formats
