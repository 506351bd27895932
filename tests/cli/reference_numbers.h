// tests/cli/reference_numbers.h — the numbers of tests/validation/reference_numbers, computed with 50 digits.
#pragma once
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/trace_table.h"
#include "tests/places.h"

namespace lensproof {

/// The lenses that there are numbers for.
inline constexpr const char* kNumberedLenses[] = {
    "tessar", "petzval", "double-gauss-lowenthal", "triplet-cooke", "fisheye-220", "muller-fisheye", "conic-aspheres"};

inline nlohmann::json reference_numbers(const std::string& lens) {
    std::ifstream stream(reference_numbers_folder() / (lens + ".json"));
    return nlohmann::json::parse(stream);
}

/// As the command line takes it: a lens of lenses/, or one that lies beside the numbers.
inline std::string numbered_lens(const std::string& lens) {
    const std::string own = (reference_numbers_folder() / (lens + ".toml")).string();
    return std::filesystem::exists(own) ? own : lens;
}

/// A test's name for a lens.
inline std::string test_name(std::string lens) {
    std::erase(lens, '-');
    return lens;
}

}  // namespace lensproof
