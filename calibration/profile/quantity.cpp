#include "calibration/profile/quantity.h"

#include <array>
#include <bit>

namespace lensproof::calibration {
namespace {
constexpr std::string_view kPlace = "{}";

// The table line by line.
auto all() {
    return std::bit_cast<std::array<Quantity, sizeof(Quantities) / sizeof(Quantity)>>(kQuantities);
}

}  // namespace

std::string ChannelText::operator()(std::string_view channel) const {
    std::string text(pattern);
    const std::size_t place = text.find(kPlace);
    return place == std::string::npos ? text : text.replace(place, kPlace.size(), channel);
}

std::optional<std::string> ChannelText::channel_in(std::string_view text) const {
    const std::size_t place = pattern.find(kPlace);
    if (place == std::string_view::npos) {
        return text == pattern ? std::optional<std::string>("") : std::nullopt;
    }
    const std::string_view after = pattern.substr(place + kPlace.size());
    if (text.size() <= place + after.size() || !text.starts_with(pattern.substr(0, place)) || !text.ends_with(after)) {
        return std::nullopt;
    }
    return std::string(text.substr(place, text.size() - place - after.size()));
}

std::optional<ChannelQuantity> quantity_of(std::string_view key) {
    std::optional<ChannelQuantity> found;
    for (const Quantity& quantity : all()) {
        // "chromatic_shift_tangential_R_px" is not the radial shift of a channel "tangential_R".
        const auto channel = quantity.key.channel_in(key);
        if (channel && (!found || channel->size() < found->channel.size())) {
            found = {quantity, *channel};
        }
    }
    return found;
}

std::vector<std::string> compared_curves() {
    std::vector<std::string> keys;
    for (const Quantity& quantity : all()) {
        if (!quantity.key.has_channel()) {
            keys.push_back(quantity.key());
        }
        for (const char channel : quantity.channels) {
            keys.push_back(quantity.key({&channel, 1}));
        }
    }
    return keys;
}

}  // namespace lensproof::calibration
