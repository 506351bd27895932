// tests/places.h — where tests find what lies outside of their own files.
#pragma once
#include <filesystem>

namespace lensproof {

/// The program `lensproof`.
std::filesystem::path program_file();

/// What makes calls of a program fail where it is loaded before (tests/failing_calls.cpp); empty where it cannot be.
std::filesystem::path failing_calls_library();

/// Reference data beside the checkout, which may be missing: what needs them says that it skips.
std::filesystem::path shared_data();

/// tests/validation/reference_numbers.
std::filesystem::path reference_numbers_folder();

}  // namespace lensproof
