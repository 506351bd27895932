// tests/complaint.h — what an input is refused with, and whether that says what it has to.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "engine/base/input_error.h"

namespace lensproof {

/// The message of the InputError that use() throws; empty where it throws none.
template <class Use>
std::string complaint_about(const Use& use) {
    try {
        use();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// Whether the text holds `words`. A test that expects it shows both where they are not as expected.
inline testing::AssertionResult says(const std::string& text, std::string_view words) {
    const bool holds = text.find(words) != std::string::npos;
    return testing::AssertionResult(holds) << '"' << words << (holds ? "\" in: " : "\" is not in: ") << text;
}

}  // namespace lensproof
