// engine/base/json_archive.h — a type's JSON described once, for writing and for reading.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/json_node.h"

namespace lensproof {

/// A value of a JSON file on its way out of a C++ value, or into one. A type says what its members are called by
///     void fields(JsonArchive& json, Point& p) { json.field("x_px", p.x_px).optional("sigma_px", p.sigma_px); }
/// beside it; it can then be written and read by itself, in vectors, in maps by a text, and in an optional (null where
/// there is nothing). Keys are written in the order of the calls, and those that nothing asks for are not read. What is
/// read and is not as described is an InputError as JsonNode's. What is written is not changed.
///
/// `context`: what `fields` needs to know besides, as further arguments.
class JsonArchive {
  public:
    explicit JsonArchive(Json& written) : written_(&written) {}
    explicit JsonArchive(JsonNode read) : node_(std::move(read)) {}

    [[nodiscard]] bool reading() const { return node_.has_value(); }
    /// Whether the file that is read has nothing, or null, there.
    [[nodiscard]] bool lacks(std::string_view key) const { return node_ && !node_->has(std::string(key)); }
    /// Of the object that is read.
    [[nodiscard]] std::vector<std::string> keys() const { return node_->keys(); }

    /// Always there.
    template <class T, class... Context>
    JsonArchive& field(std::string_view key, T& value, const Context&... context) {
        at(key).value(value, context...);
        return *this;
    }
    /// Always written; files from before it was added lack it, and leave `value` as it is.
    template <class T, class... Context>
    JsonArchive& added(std::string_view key, T& value, const Context&... context) {
        return lacks(key) ? *this : field(key, value, context...);
    }
    /// Written where the optional, text, list or map holds something, and read where it is there.
    template <class T, class... Context>
    JsonArchive& optional(std::string_view key, T& value, const Context&... context) {
        return lacks(key) || (!reading() && is_nothing(value)) ? *this : field(key, value, context...);
    }
    /// Whether there is a value, made where the file has that key: for what is spread over several keys.
    template <class T>
    bool present(std::string_view key, std::optional<T>& value) {
        if (reading() && !lacks(key)) {
            value.emplace();
        }
        return value.has_value();
    }
    /// Always there and always the same.
    template <class T>
    JsonArchive& constant(std::string_view key, const T& expected, std::string_view in_words) {
        T value = expected;
        field(key, value);
        return expect(key, value == expected, in_words);
    }
    /// One of the names, as its place among them.
    template <class T>
    JsonArchive& one_of(std::string_view key, T& value, const std::vector<std::string>& names,
                        std::string_view in_words) {
        value = static_cast<T>(place_among(key, static_cast<std::size_t>(value), names, in_words));
        return *this;
    }
    /// A list of `count` numbers.
    JsonArchive& numbers(std::string_view key, std::vector<double>& values, std::size_t count);
    /// A matrix of `count` rows as a list of lists; `values` has it row by row, `stride` (at least `count`) apart.
    JsonArchive& rows(std::string_view key, std::vector<double>& values, std::size_t count, std::size_t stride,
                      std::string_view in_words);
    /// An object of its own, of which `members(archive)` says what is in it.
    template <class Members>
    JsonArchive& group(std::string_view key, const Members& members) {
        JsonArchive inner = at(key);
        inner.begin_object();
        members(inner);
        return *this;
    }
    /// The same, written where there is something.
    template <class Members>
    JsonArchive& optional_group(std::string_view key, bool something, const Members& members) {
        return lacks(key) || (!reading() && !something) ? *this : group(key, members);
    }

    /// A number that may be infinite or none.
    JsonArchive& any_number(std::string_view key, double& number);
    /// Bytes, and floats as this machine's bytes, as one text: pictures.
    JsonArchive& packed(std::string_view key, std::string& bytes);
    JsonArchive& packed(std::string_view key, std::vector<float>& numbers);

    /// Written for other programs, and not read.
    JsonArchive& derived(std::string_view key, Json value);
    /// Throws where what was read is not so: the key's value is not what was expected.
    JsonArchive& expect(std::string_view key, bool is_so, std::string_view in_words);

    // A value by itself.
    void value(double& number);  // finite
    void value(int& count);
    void value(bool& truth);
    void value(std::string& text);
    void value(Vec2d& pair);
    void value(Vec3d& triple);
    void value(std::vector<bool>& truths);

    template <std::size_t n>
    void value(std::array<double, n>& values) {
        std::vector<double> list(values.begin(), values.end());
        value_of(list, n);
        std::copy(list.begin(), list.end(), values.begin());
    }
    template <class T, class... Context>
    void value(std::optional<T>& optional, const Context&... context) {
        if (reading()) {
            optional = node_->value().is_null() ? std::nullopt : std::optional(T{});
        }
        if (optional) {
            value(*optional, context...);
        }
    }
    template <class T, class... Context>
    void value(std::vector<T>& values, const Context&... context) {
        if (reading()) {
            values.clear();
            for (JsonNode& element : node_->elements()) {
                JsonArchive(std::move(element)).value(values.emplace_back(), context...);
            }
            return;
        }
        *written_ = Json::list();
        for (T& one : values) {
            Json element;
            JsonArchive(element).value(one, context...);
            written_->push_back(std::move(element));
        }
    }
    template <class T, class... Context>
    void value(std::map<std::string, T>& values, const Context&... context) {
        begin_object();
        if (reading()) {
            for (const std::string& key : keys()) {
                field(key, values[key], context...);
            }
            return;
        }
        for (auto& [key, one] : values) {
            field(key, one, context...);
        }
    }
    template <class T, class... Context>
    void value(T& structure, const Context&... context) {
        begin_object();
        fields(*this, structure, context...);
    }

  private:
    JsonArchive at(std::string_view key);
    void begin_object();
    void value_of(std::vector<double>& values, std::size_t count);
    std::size_t place_among(std::string_view key, std::size_t place, const std::vector<std::string>& names,
                            std::string_view in_words);
    template <class T>
    static bool is_nothing(const T& value) {
        if constexpr (requires { value.has_value(); }) {
            return !value.has_value();
        } else {
            return value.empty();
        }
    }

    Json* written_ = nullptr;
    std::optional<JsonNode> node_;  // what is read
};

/// `value` as JSON.
template <class T>
Json to_json(T value) {
    Json json;
    JsonArchive(json).value(value);
    return json;
}

/// What `to_json` wrote of a T.
template <class T>
T from_json(const JsonNode& node) {
    T value{};
    JsonArchive(node).value(value);
    return value;
}

}  // namespace lensproof
