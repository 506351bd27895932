// engine/base/kinds.h — values of several kinds, each in a type of its own, by the names that files have for them.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace lensproof {

/// What files call a kind, the first name first; its type has them as `kNames`.
template <std::size_t N = 1>
using KindNames = std::array<std::string_view, N>;

/// Calls `visit` with a value of each kind of a variant, made by default, in the variant's order.
template <class Variant, class Visit>
void for_each_kind(const Visit& visit) {
    [&]<class... Kinds>(std::type_identity<std::variant<Kinds...>>) {
        (visit(Kinds()), ...);
    }(std::type_identity<Variant>());
}

/// All kinds' names, in the variant's order.
template <class Variant>
std::vector<std::string> kind_names() {
    std::vector<std::string> names;
    for_each_kind<Variant>(
        [&](const auto& kind) { names.insert(names.end(), kind.kNames.begin(), kind.kNames.end()); });
    return names;
}

/// A value of the kind that is called `name`, one of `kind_names`, made by default and given to `fill`.
template <class Variant, class Fill>
Variant of_kind(std::string_view name, const Fill& fill) {
    std::optional<Variant> found;
    for_each_kind<Variant>([&](auto kind) {
        if (std::ranges::find(kind.kNames, name) != kind.kNames.end()) {
            fill(kind);
            found = std::move(kind);
        }
    });
    return std::move(found).value();
}

}  // namespace lensproof
