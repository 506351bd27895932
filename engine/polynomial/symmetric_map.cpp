#include "engine/polynomial/symmetric_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "engine/base/bytes.h"

namespace lensproof::polynomial {

namespace {

template <class Number>
bool take_all(std::string_view& bytes, std::vector<Number>& numbers) {
    const auto count = take_bytes<std::uint32_t>(bytes);
    if (!count || bytes.size() < *count * sizeof(Number)) {
        return false;
    }
    numbers.resize(*count);
    for (Number& number : numbers) {
        number = take_bytes<Number>(bytes).value_or(Number{});
    }
    return true;
}

template <class Number>
void append_all(std::string& bytes, const std::vector<Number>& numbers) {
    append_bytes(bytes, static_cast<std::uint32_t>(numbers.size()));
    for (const Number number : numbers) {
        append_bytes(bytes, number);
    }
}

}  // namespace

SymmetricMap::SymmetricMap(int vectors, const std::vector<std::vector<Term>>& sums)
    : vectors_(vectors), monomials_(1), exponents_(1), first_term_{0} {
    for (const std::vector<Term>& sum : sums) {
        for (const Term& term : sum) {
            term_monomial_.push_back(index_of(term.exponents));
            coefficients_.push_back(term.coefficient);
        }
        first_term_.push_back(static_cast<std::int32_t>(coefficients_.size()));
    }
}

/// Of the monomial, which is made where there is none: out of one that is there, if any is a factor short of it.
std::uint16_t SymmetricMap::index_of(const Exponents& exponents) {
    const auto found = std::ranges::find(exponents_, exponents);
    if (found != exponents_.end()) {
        return static_cast<std::uint16_t>(found - exponents_.begin());
    }
    std::optional<Exponents> parent;
    std::size_t factor = 0;
    for (std::size_t i = 0; i < exponents.size(); ++i) {
        if (exponents[i] > 0) {
            Exponents shorter = exponents;
            --shorter[i];
            if (!parent || std::ranges::find(exponents_, shorter) != exponents_.end()) {
                parent = shorter;
                factor = i;
            }
        }
    }
    const std::uint16_t from = index_of(parent.value());
    if (monomials_.size() == kMostMonomials) {
        throw std::length_error("a polynomial of more monomials than its evaluation has room for");
    }
    monomials_.push_back({.parent = from, .factor = static_cast<Invariant>(factor)});
    exponents_.push_back(exponents);
    return static_cast<std::uint16_t>(monomials_.size() - 1);
}

int SymmetricMap::degree() const {
    int most = 0;
    for (int i = 0; i < first_term_[2 * static_cast<std::size_t>(vectors_)]; ++i) {
        const Exponents& of = exponents_[term_monomial_[static_cast<std::size_t>(i)]];
        most = std::max(most, 2 * (of[0] + of[1] + of[2]) + 1);
    }
    return most;
}

void SymmetricMap::find_products(const SymmetricPoint& at, Products& products) const {
    const std::array<double, kInvariants> invariants = at.invariants();
    products[0] = 1.0;
    for (std::size_t i = 1; i < monomials_.size(); ++i) {
        products[i] = products[monomials_[i].parent] * invariants[static_cast<std::size_t>(monomials_[i].factor)];
    }
}

double SymmetricMap::sum(int which, const Products& products) const {
    double sum = 0.0;
    const auto end = static_cast<std::size_t>(first_term_[static_cast<std::size_t>(which) + 1]);
    for (auto i = static_cast<std::size_t>(first_term_[static_cast<std::size_t>(which)]); i < end; ++i) {
        sum += coefficients_[i] * products[term_monomial_[i]];
    }
    return sum;
}

Vec2d SymmetricMap::vector(int which, const SymmetricPoint& at) const {
    Products products;
    find_products(at, products);
    return sum(2 * which, products) * at.x + sum(2 * which + 1, products) * at.q;
}

double SymmetricMap::scalar(int which, const SymmetricPoint& at) const {
    Products products;
    find_products(at, products);
    return sum(2 * vectors_ + which, products);
}

std::array<VectorSlopes, 2> SymmetricMap::slopes(const SymmetricPoint& at) const {
    Products products;
    find_products(at, products);
    // By each of the first three invariants; t stays.
    std::array<Products, 3> by;
    const std::array<double, kInvariants> invariants = at.invariants();
    for (std::size_t v = 0; v < by.size(); ++v) {
        by[v][0] = 0.0;
        for (std::size_t i = 1; i < monomials_.size(); ++i) {
            const auto factor = static_cast<std::size_t>(monomials_[i].factor);
            by[v][i] =
                by[v][monomials_[i].parent] * invariants[factor] + (factor == v ? products[monomials_[i].parent] : 0.0);
        }
    }
    std::array<VectorSlopes, 2> found;
    for (int which = 0; which < 2; ++which) {
        const double a = sum(2 * which, products);
        const double b = sum(2 * which + 1, products);
        // ∂A/∂x = 4 A_xx x + A_xq q, ∂A/∂q = 4 A_qq q + A_xq x; and B's.
        const auto by_x = [&](int of) { return 4.0 * sum(of, by[0]) * at.x + sum(of, by[2]) * at.q; };
        const auto by_q = [&](int of) { return 4.0 * sum(of, by[1]) * at.q + sum(of, by[2]) * at.x; };
        const Vec2d a_x = by_x(2 * which);
        const Vec2d b_x = by_x(2 * which + 1);
        const Vec2d a_q = by_q(2 * which);
        const Vec2d b_q = by_q(2 * which + 1);
        found[static_cast<std::size_t>(which)] = {
            .value = a * at.x + b * at.q,
            .by_x = {a_x.x * at.x + b_x.x * at.q + Vec2d{a, 0.0}, a_x.y * at.x + b_x.y * at.q + Vec2d{0.0, a}},
            .by_q = {a_q.x * at.x + b_q.x * at.q + Vec2d{b, 0.0}, a_q.y * at.x + b_q.y * at.q + Vec2d{0.0, b}}};
    }
    return found;
}

void SymmetricMap::append_to(std::string& bytes) const {
    append_bytes(bytes, vectors_, static_cast<std::uint32_t>(monomials_.size()));
    for (std::size_t i = 0; i < monomials_.size(); ++i) {
        append_bytes(bytes, monomials_[i].parent, monomials_[i].factor);
    }
    append_all(bytes, first_term_);
    append_all(bytes, term_monomial_);
    append_all(bytes, coefficients_);
}

std::optional<SymmetricMap> SymmetricMap::taken_from(std::string_view& bytes) {
    SymmetricMap map;
    map.vectors_ = take_bytes<int>(bytes).value_or(-1);
    const std::uint32_t count = take_bytes<std::uint32_t>(bytes).value_or(0);
    if (map.vectors_ < 0 || count == 0 || count > kMostMonomials) {
        return std::nullopt;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint16_t parent = take_bytes<std::uint16_t>(bytes).value_or(0);
        const std::uint8_t factor = take_bytes<std::uint8_t>(bytes).value_or(0);
        if (factor >= kInvariants || (i > 0 && parent >= i)) {
            return std::nullopt;
        }
        map.monomials_.push_back({.parent = parent, .factor = static_cast<Invariant>(factor)});
        map.exponents_.push_back(i > 0 ? map.exponents_[parent] : Exponents{});
        map.exponents_.back()[factor] = static_cast<std::uint8_t>(map.exponents_.back()[factor] + (i > 0 ? 1 : 0));
    }
    if (!take_all(bytes, map.first_term_) || !take_all(bytes, map.term_monomial_) ||
        !take_all(bytes, map.coefficients_) || !map.is_sound()) {
        return std::nullopt;
    }
    return map;
}

bool SymmetricMap::is_sound() const {
    return term_monomial_.size() == coefficients_.size() &&
           first_term_.size() > 2 * static_cast<std::size_t>(vectors_) && first_term_.front() == 0 &&
           first_term_.back() == static_cast<std::int32_t>(coefficients_.size()) &&
           std::ranges::is_sorted(first_term_) &&
           std::ranges::all_of(term_monomial_, [&](std::uint16_t at) { return at < monomials_.size(); }) &&
           std::ranges::all_of(coefficients_, [](double number) { return std::isfinite(number); });
}

}  // namespace lensproof::polynomial
