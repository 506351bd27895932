#include "engine/scene/chart/aruco.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>

#include "engine/base/csv.h"
#include "engine/base/data_root.h"
#include "engine/base/input_error.h"

namespace lensproof::scene {

namespace {

constexpr int kSides[] = {4, 5, 6};
constexpr int kSizes[] = {50, 100, 250};

std::string name_of(int cells, int size) {
    return fmt::format("DICT_{0}X{0}_{1}", cells, size);
}

/// The first `size` markers of `cells` × `cells` cells.
std::vector<std::uint64_t> read_markers(int cells, int size) {
    CsvTable table = CsvTable::read(data_root() / "engine/scene/data/aruco.csv");
    std::vector<std::uint64_t> markers;
    while (const auto row = table.next()) {
        if (row->number("cells") != cells || row->number("id") >= size) {
            continue;
        }
        const std::string text = row->text("bits");
        std::uint64_t bits = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bits, 16);
        if (error != std::errc() || end != text.data() + text.size() || bits >> (cells * cells) != 0) {
            row->fail("bits", fmt::format("a hexadecimal number of {} bits", cells * cells));
        }
        markers.push_back(bits);
    }
    return markers;
}

}  // namespace

std::vector<std::string> known_aruco_dictionaries() {
    std::vector<std::string> names;
    for (const int cells : kSides) {
        for (const int size : kSizes) {
            names.push_back(name_of(cells, size));
        }
    }
    return names;
}

ArucoDictionary aruco_dictionary(const std::string& name) {
    for (const int cells : kSides) {
        for (const int size : kSizes) {
            if (name == name_of(cells, size)) {
                return {.name = name, .cells = cells, .markers = read_markers(cells, size)};
            }
        }
    }
    throw InputError(fmt::format("the ArUco dictionary '{}' is not known: expected one of {}", name,
                                 fmt::join(known_aruco_dictionaries(), ", ")));
}

}  // namespace lensproof::scene
