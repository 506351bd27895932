#include "engine/base/json_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "engine/base/infinity.h"
#include "engine/base/markup.h"

namespace lensproof {

JsonArchive JsonArchive::at(std::string_view key) {
    return reading() ? JsonArchive(node_->at(std::string(key))) : JsonArchive((*written_)[key]);
}

void JsonArchive::begin_object() {
    if (!reading()) {
        *written_ = Json::object();
    }
}

JsonArchive& JsonArchive::derived(std::string_view key, Json value) {
    if (!reading()) {
        (*written_)[key] = std::move(value);
    }
    return *this;
}

JsonArchive& JsonArchive::expect(std::string_view key, bool is_so, std::string_view in_words) {
    if (reading() && !is_so) {
        throw node_->at(std::string(key)).error(in_words);
    }
    return *this;
}

std::size_t JsonArchive::place_among(std::string_view key, std::size_t place, const std::vector<std::string>& names,
                                     std::string_view in_words) {
    std::string name = reading() ? "" : names[place];
    field(key, name);
    const auto found = std::ranges::find(names, name);
    expect(key, found != names.end(), in_words);
    return static_cast<std::size_t>(found - names.begin());
}

JsonArchive& JsonArchive::numbers(std::string_view key, std::vector<double>& values, std::size_t count) {
    at(key).value_of(values, count);
    return *this;
}

JsonArchive& JsonArchive::any_number(std::string_view key, double& number) {
    constexpr std::array<double, 3> kOthers = {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()};
    const std::vector<std::string> names = {"inf", "-inf", "nan"};
    const bool is_named = reading() ? node_->at(std::string(key)).value().is_text() : !std::isfinite(number);
    if (!is_named) {
        return field(key, number);
    }
    const std::size_t place = std::isnan(number) ? 2 : number > 0.0 ? 0 : 1;
    number = kOthers.at(place_among(key, place, names, "a number, inf, -inf or nan"));
    return *this;
}

JsonArchive& JsonArchive::packed(std::string_view key, std::string& bytes) {
    std::string text = reading() ? "" : base64(bytes);
    field(key, text);
    if (reading()) {
        std::optional<std::string> read = from_base64(text);
        expect(key, read.has_value(), "bytes in base64");
        bytes = *std::move(read);
    }
    return *this;
}

JsonArchive& JsonArchive::packed(std::string_view key, std::vector<float>& numbers) {
    std::string bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
    packed(key, bytes);
    expect(key, bytes.size() % sizeof(float) == 0, "floats of 4 bytes in base64");
    numbers.resize(bytes.size() / sizeof(float));
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return *this;
}

JsonArchive& JsonArchive::rows(std::string_view key, std::vector<double>& values, std::size_t count, std::size_t stride,
                               std::string_view in_words) {
    if (!reading()) {
        Json& list = (*written_)[key] = Json::list();
        for (std::size_t i = 0; i < count; ++i) {
            const auto row = values.begin() + static_cast<std::ptrdiff_t>(i * stride);
            list.push_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(count)));
        }
        return *this;
    }
    const std::vector<JsonNode> elements = node_->at(std::string(key)).elements();
    expect(key, elements.size() == count, in_words);
    std::vector<std::vector<double>> read;  // all of it before the matrix is made: `count` is the file's own word
    std::ranges::transform(elements, std::back_inserter(read), [&](const JsonNode& row) { return row.numbers(count); });
    values.assign(stride * stride, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        std::ranges::copy(read[i], values.begin() + static_cast<std::ptrdiff_t>(i * stride));
    }
    return *this;
}

void JsonArchive::value(double& number) {
    reading() ? void(number = node_->number()) : void(*written_ = number);
}
void JsonArchive::value(int& count) {
    reading() ? void(count = node_->count()) : void(*written_ = count);
}
void JsonArchive::value(bool& truth) {
    reading() ? void(truth = node_->truth()) : void(*written_ = truth);
}
void JsonArchive::value(std::string& text) {
    reading() ? void(text = node_->text()) : void(*written_ = text);
}
void JsonArchive::value(Vec2d& pair) {
    reading() ? void(pair = node_->pair()) : void(*written_ = Json::list({pair.x, pair.y}));
}
void JsonArchive::value(Vec3d& triple) {
    reading() ? void(triple = node_->triple()) : void(*written_ = Json::list({triple.x, triple.y, triple.z}));
}

void JsonArchive::value(std::vector<bool>& truths) {
    if (!reading()) {
        *written_ = truths;
        return;
    }
    truths.clear();
    for (const JsonNode& element : node_->elements()) {
        truths.push_back(element.truth());
    }
}

void JsonArchive::value_of(std::vector<double>& values, std::size_t count) {
    if (reading()) {
        values = node_->numbers(count);
    } else {
        *written_ = values;
    }
}

}  // namespace lensproof
