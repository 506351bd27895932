// tests/places.h — where tests find what lies outside of their own files.
#pragma once
#include <filesystem>

namespace lensproof {

/// The program `lensproof`.
std::filesystem::path program_file();

/// Reference data beside the checkout, which may be missing: what needs them says that it skips.
std::filesystem::path shared_data();

/// tests/validation/reference_numbers.
std::filesystem::path reference_numbers_folder();

}  // namespace lensproof
