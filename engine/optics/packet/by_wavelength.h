// engine/optics/packet/by_wavelength.h — what tables by wavelength have for the lanes of a packet.
#pragma once
#include <array>
#include <bit>
#include <cstdint>

namespace lensproof::optics {

/// Of each lane's own wavelength, or of the first for all. Rows are structs of four numbers.
template <class Numbers, bool per_lane>
struct ByWavelength {
    using Scalar = typename Numbers::Number;

    const std::uint16_t* wavelength = nullptr;  // not looked at where all have the first

    [[nodiscard]] Numbers number(const Scalar* table) const {
        if constexpr (per_lane) {
            return Numbers::gather(table, wavelength);
        } else {
            return Numbers(*table);
        }
    }

    template <class Row>
    [[nodiscard]] std::array<Numbers, 4> row(const Row* rows) const {
        if constexpr (per_lane) {
            return Numbers::gather_rows(rows, wavelength);
        } else {
            const auto numbers = std::bit_cast<std::array<Scalar, 4>>(*rows);
            return {Numbers(numbers[0]), Numbers(numbers[1]), Numbers(numbers[2]), Numbers(numbers[3])};
        }
    }
};

}  // namespace lensproof::optics
