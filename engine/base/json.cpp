#include "engine/base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/base/input_error.h"
#include "engine/base/overloaded.h"
#include "engine/base/visible.h"

namespace lensproof {

namespace {

using Library = nlohmann::ordered_json;

constexpr std::size_t kDeepest = 64;

/// Builds a value from what the library's parser finds.
class Builder {
  public:
    explicit Builder(const std::string& name) : name_(name) {}

    bool null() { return put({}); }
    bool boolean(bool truth) { return put(truth); }
    bool number_integer(std::int64_t whole) { return put(whole); }
    bool number_unsigned(std::uint64_t whole) { return put(whole); }
    bool number_float(double number, const std::string& /*text*/) { return put(number); }
    bool string(std::string& text) { return put(std::move(text)); }
    bool binary(Library::binary_t& /*bytes*/) { return false; }
    bool start_object(std::size_t /*size*/) { return open(true); }
    bool start_array(std::size_t /*size*/) { return open(false); }
    bool key(std::string& key) {
        open_.back().key = std::move(key);
        return true;
    }
    bool end_object() { return close(); }
    bool end_array() { return close(); }
    bool parse_error(std::size_t byte, const std::string& /*token*/, const Library::exception& error) {
        const bool is_too_large = dynamic_cast<const Library::out_of_range*>(&error) != nullptr;
        throw InputError(fmt::format("{}: {} at byte {}", name_,
                                     is_too_large ? "holds a number that cannot be read" : "not JSON", byte));
    }

    Json take() { return std::move(root_); }

  private:
    /// A list or an object that is not yet whole.
    struct Open {
        bool is_object = false;
        Json::List values;
        Json::Members members;
        std::map<std::string, std::size_t> places;  // of the members, by key
        std::string key;                            // of the next one
    };

    bool put(Json value) {
        if (open_.empty()) {
            root_ = std::move(value);
        } else if (Open& in = open_.back(); !in.is_object) {
            in.values.push_back(std::move(value));
        } else if (const auto [place, is_new] = in.places.emplace(in.key, in.members.size()); is_new) {
            in.members.emplace_back(in.key, std::move(value));
        } else {
            in.members[place->second].second = std::move(value);  // the last of the same key counts
        }
        return true;
    }
    bool open(bool is_object) {
        if (open_.size() == kDeepest) {
            throw InputError(fmt::format("{}: more than {} brackets inside one another", name_, kDeepest));
        }
        open_.push_back({.is_object = is_object});
        return true;
    }
    bool close() {
        Open whole = std::move(open_.back());
        open_.pop_back();
        return put(whole.is_object ? Json(std::move(whole.members)) : Json(std::move(whole.values)));
    }

    const std::string& name_;
    Json root_;
    std::vector<Open> open_;
};

}  // namespace

Json::Json() = default;
Json::Json(std::nullptr_t) {}
Json::Json(bool truth) : value_(truth) {}
Json::Json(double number) {
    if (std::isfinite(number)) {
        value_ = number;
    }
}
Json::Json(std::string text) : value_(std::move(text)) {}
Json::Json(std::string_view text) : value_(std::string(text)) {}
Json::Json(const char* text) : value_(std::string(text)) {}
Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json::Json(std::initializer_list<Json> values) {
    const auto is_member = [](const Json& value) { return value.is_list() && value.size() == 2 && value[0].is_text(); };
    if (!std::ranges::all_of(values, is_member)) {
        value_ = List(values);
        return;
    }
    value_ = Members();
    for (const Json& member : values) {
        (*this)[member[0].text()] = member[1];
    }
}

Json Json::list(std::initializer_list<Json> values) {
    return Json(List(values));
}

Json Json::object() {
    return Json(Members());
}

Json Json::parse(std::string_view text, const std::string& name) {
    Builder builder(name);
    Library::sax_parse(text, &builder);
    return builder.take();
}

std::string Json::dump(int indent) const {
    std::string text;
    append_to(text, indent, 0);
    return text;
}

void Json::append_to(std::string& text, int indent, int depth) const {
    const auto new_line = [&](int level) {
        if (indent >= 0) {
            text += '\n';
            text.append(static_cast<std::size_t>(level) * indent, ' ');
        }
    };
    const auto append_all = [&](const auto& parts, char begin, char end, const auto& append_part) {
        text += begin;
        for (const auto& part : parts) {
            text += &part == &parts.front() ? "" : ",";
            new_line(depth + 1);
            append_part(part);
        }
        if (!parts.empty()) {
            new_line(depth);
        }
        text += end;
    };
    const auto scalar = [](const auto& value) {
        return visible(Library(value).dump(-1, ' ', false, Library::error_handler_t::replace));
    };
    std::visit(Overloaded{[&](std::monostate) { text += "null"; },
                          [&](const List& values) {
                              append_all(values, '[', ']',
                                         [&](const Json& value) { value.append_to(text, indent, depth + 1); });
                          },
                          [&](const Members& members) {
                              append_all(members, '{', '}', [&](const auto& member) {
                                  text += scalar(member.first) + (indent >= 0 ? ": " : ":");
                                  member.second.append_to(text, indent, depth + 1);
                              });
                          },
                          [&](const auto& value) { text += scalar(value); }},
               value_);
}

bool Json::is_whole() const {
    return std::holds_alternative<std::int64_t>(value_) || std::holds_alternative<std::uint64_t>(value_);
}

bool Json::is_number() const {
    return is_whole() || std::holds_alternative<double>(value_);
}

double Json::number() const {
    if (const auto* whole = std::get_if<std::int64_t>(&value_)) {
        return static_cast<double>(*whole);
    }
    if (const auto* whole = std::get_if<std::uint64_t>(&value_)) {
        return static_cast<double>(*whole);
    }
    return std::get<double>(value_);
}

const Json::List& Json::elements() const& {
    static const List kNone;
    const auto* values = std::get_if<List>(&value_);
    return values != nullptr ? *values : kNone;
}

const Json::Members& Json::members() const& {
    static const Members kNone;
    const auto* members = std::get_if<Members>(&value_);
    return members != nullptr ? *members : kNone;
}

std::size_t Json::size() const {
    return elements().size() + members().size();
}

const Json& Json::operator[](std::string_view key) const {
    static const Json kNothing;
    const auto member = std::ranges::find(members(), key, &Members::value_type::first);
    return member != members().end() ? member->second : kNothing;
}

Json& Json::operator[](std::string_view key) {
    if (is_null()) {
        value_ = Members();
    }
    auto& members = std::get<Members>(value_);
    const auto member = std::ranges::find(members, key, &Members::value_type::first);
    return member != members.end() ? member->second : members.emplace_back(std::string(key), Json()).second;
}

bool Json::contains(std::string_view key) const {
    return std::ranges::find(members(), key, &Members::value_type::first) != members().end();
}

void Json::push_back(Json value) {
    if (is_null()) {
        value_ = List();
    }
    std::get<List>(value_).push_back(std::move(value));
}

bool operator==(const Json& a, const Json& b) {
    return a.value_ == b.value_;
}

}  // namespace lensproof
