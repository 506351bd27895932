// tests/complaint.h — what an input is refused with.
#pragma once
#include <string>

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

}  // namespace lensproof
