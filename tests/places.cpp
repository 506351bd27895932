#include "tests/places.h"

namespace lensproof {

std::filesystem::path program_file() {
    return LENSPROOF_PROGRAM;
}

std::filesystem::path failing_calls_library() {
    return LENSPROOF_FAILING_CALLS;
}

std::filesystem::path shared_data() {
    return std::filesystem::path(LENSPROOF_SOURCE_DIR) / ".." / "shared";
}

std::filesystem::path reference_numbers_folder() {
    return std::filesystem::path(LENSPROOF_SOURCE_DIR) / "tests/validation/reference_numbers";
}

}  // namespace lensproof
