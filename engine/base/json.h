// engine/base/json.h — JSON as a value: what is written, and what was read.
//
// The library's header costs each file that includes it some seconds; it is kept to json.cpp.
#pragma once
#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace lensproof {

/// null, true or false, a number, a text, a list, or an object, whose members stay in the order in which they were set.
/// A number that is not finite is null, since JSON has no other.
class Json {
  public:
    using value_type = Json;  // of a list, as the standard library wants it
    using List = std::vector<Json>;
    using Members = std::vector<std::pair<std::string, Json>>;

    Json();  // null
    Json(std::nullptr_t);
    Json(bool truth);
    Json(double number);
    template <std::floating_point T>
    Json(T number) : Json(static_cast<double>(number)) {}
    template <std::integral T>
    Json(T whole) {
        if (whole < T{0}) {
            value_ = static_cast<std::int64_t>(whole);
        } else {
            value_ = static_cast<std::uint64_t>(whole);
        }
    }
    Json(std::string text);
    Json(std::string_view text);
    Json(const char* text);
    /// Null where there is nothing.
    template <class T>
    Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}
    template <class T>
    Json(const std::vector<T>& values) : value_(List(values.begin(), values.end())) {}
    template <class T, std::size_t n>
    Json(const std::array<T, n>& values) : value_(List(values.begin(), values.end())) {}
    template <class T>
    Json(const std::map<std::string, T>& values) : value_(Members(values.begin(), values.end())) {}
    explicit Json(Members members) : value_(std::move(members)) {}
    explicit Json(List values) : value_(std::move(values)) {}
    /// An object where each is a list of a text and another value: {{"key", 1}, {"other", "text"}}; else a list.
    Json(std::initializer_list<Json> values);

    Json(const Json&);
    Json(Json&&) noexcept;
    Json& operator=(const Json&);
    Json& operator=(Json&&) noexcept;
    ~Json();

    /// A list, also of pairs that begin with a text.
    static Json list(std::initializer_list<Json> values = {});
    static Json object();

    /// Throws InputError `name: not JSON …` for a text that is none, or that nests more than 64 deep.
    static Json parse(std::string_view text, const std::string& name);

    /// With `indent` blanks a level, or in one line. What is no UTF-8 becomes U+FFFD. Numbers have as many digits as
    /// bring their bits back.
    [[nodiscard]] std::string dump(int indent = -1) const;

    [[nodiscard]] bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
    [[nodiscard]] bool is_truth() const { return std::holds_alternative<bool>(value_); }
    [[nodiscard]] bool is_number() const;
    [[nodiscard]] bool is_whole() const;
    [[nodiscard]] bool is_text() const { return std::holds_alternative<std::string>(value_); }
    [[nodiscard]] bool is_list() const { return std::holds_alternative<List>(value_); }
    [[nodiscard]] bool is_object() const { return std::holds_alternative<Members>(value_); }

    /// What it is; of another kind of value std::bad_variant_access.
    [[nodiscard]] bool truth() const { return std::get<bool>(value_); }
    [[nodiscard]] double number() const;
    [[nodiscard]] const std::string& text() const { return std::get<std::string>(value_); }
    /// Of a list, of an object; else none.
    [[nodiscard]] const List& elements() const&;
    [[nodiscard]] const Members& members() const&;
    const List& elements() && = delete;
    const Members& members() && = delete;

    /// Of a list or an object; else 0.
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool empty() const { return size() == 0; }

    /// The member of an object; null where it has none, or where this is no object.
    const Json& operator[](std::string_view key) const;
    /// The same, made where it is missing; what was null becomes an object.
    Json& operator[](std::string_view key);
    [[nodiscard]] bool contains(std::string_view key) const;

    template <std::integral T>
    const Json& operator[](T i) const {
        return elements()[static_cast<std::size_t>(i)];
    }
    template <std::integral T>
    Json& operator[](T i) {
        return std::get<List>(value_)[static_cast<std::size_t>(i)];
    }
    /// To a list; what was null becomes one.
    void push_back(Json value);
    /// Of the elements.
    [[nodiscard]] List::const_iterator begin() const { return elements().begin(); }
    [[nodiscard]] List::const_iterator end() const { return elements().end(); }

    friend bool operator==(const Json& a, const Json& b);

  private:
    void append_to(std::string& text, int indent, int depth) const;

    // Whole numbers are signed where they are negative.
    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List, Members> value_;
};

}  // namespace lensproof
