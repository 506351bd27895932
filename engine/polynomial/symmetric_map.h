// engine/polynomial/symmetric_map.h — sparse polynomials of what a round lens makes of a ray.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/vec.h"

namespace lensproof::polynomial {

/// What is the same for a ray and for that ray turned about the axis or mirrored: of two vectors x and q across the
/// axis, each of length 1 at most, and the wavelength's t from −1 to 1. All lie within [−1, 1], about 0.
enum class Invariant : std::uint8_t { xx, qq, xq, t };  // 2 x·x − 1, 2 q·q − 1, x·q, t
inline constexpr int kInvariants = 4;
using Exponents = std::array<std::uint8_t, kInvariants>;

/// x and q scaled to 1, and t.
struct SymmetricPoint {
    Vec2d x;
    Vec2d q;
    double t = 0.0;

    [[nodiscard]] std::array<double, kInvariants> invariants() const {
        return {2.0 * dot(x, x) - 1.0, 2.0 * dot(q, q) - 1.0, dot(x, q), t};
    }
};

/// A vector that the map yields and its derivatives: columns of ∂v/∂x and of ∂v/∂q.
struct VectorSlopes {
    Vec2d value;
    std::array<Vec2d, 2> by_x;
    std::array<Vec2d, 2> by_q;
};

/// Vectors v = A x + B q and scalars S, each A, B and S a sparse polynomial in the invariants. Every smooth map of
/// (x, q) that commutes with turns and mirrors has this form (Hullin et al. 2012 leave out the same terms by hand).
class SymmetricMap {
  public:
    /// A product of invariants: that of `parent`, which stands before it, times one more. The first is 1, its own
    /// parent.
    struct Monomial {
        std::uint16_t parent = 0;
        Invariant factor = Invariant::xx;
    };
    struct Term {
        Exponents exponents;
        double coefficient;
    };
    static constexpr std::size_t kMostMonomials = 512;

    /// The sums of terms in the order A, B of each vector, then each scalar. Throws std::length_error for more
    /// monomials than that.
    SymmetricMap(int vectors, const std::vector<std::vector<Term>>& sums);

    [[nodiscard]] int vectors() const { return vectors_; }
    [[nodiscard]] int scalars() const { return static_cast<int>(first_term_.size()) - 1 - 2 * vectors_; }
    [[nodiscard]] const std::vector<Monomial>& monomials() const { return monomials_; }
    /// Of all sums, one after the other: [first_term[i], first_term[i + 1]) are sum i's.
    [[nodiscard]] const std::vector<std::int32_t>& first_term() const { return first_term_; }
    [[nodiscard]] const std::vector<std::uint16_t>& term_monomial() const { return term_monomial_; }
    [[nodiscard]] const std::vector<double>& coefficients() const { return coefficients_; }
    [[nodiscard]] int terms() const { return static_cast<int>(coefficients_.size()); }
    /// The largest degree of a vector's term in x and q together.
    [[nodiscard]] int degree() const;

    [[nodiscard]] Vec2d vector(int which, const SymmetricPoint& at) const;
    [[nodiscard]] double scalar(int which, const SymmetricPoint& at) const;

    /// Vectors 0 and 1, with their derivatives.
    [[nodiscard]] std::array<VectorSlopes, 2> slopes(const SymmetricPoint& at) const;

    void append_to(std::string& bytes) const;
    /// Takes a map from the front of the bytes; nothing where they are not those of one.
    static std::optional<SymmetricMap> taken_from(std::string_view& bytes);

  private:
    using Products = std::array<double, kMostMonomials>;
    SymmetricMap() = default;
    std::uint16_t index_of(const Exponents& exponents);
    void find_products(const SymmetricPoint& at, Products& products) const;
    [[nodiscard]] double sum(int which, const Products& products) const;
    [[nodiscard]] bool is_sound() const;

    int vectors_ = 0;
    std::vector<Monomial> monomials_;
    std::vector<Exponents> exponents_;  // of each monomial
    std::vector<std::int32_t> first_term_;
    std::vector<std::uint16_t> term_monomial_;
    std::vector<double> coefficients_;
};

}  // namespace lensproof::polynomial
