// tests/fuzz/use_reader.h — bytes that nobody wrote, through a reader.
#pragma once
#include <optional>

#include "engine/base/input_error.h"
#include "tests/fuzz/file_readers.h"
#include "tests/fuzz/use_what_was_read.h"

namespace lensproof {

/// Uses what `read()` makes of them. It may refuse them by an InputError, and nothing else.
template <class Read>
void use_reader(const Read& read) {
    std::optional<decltype(read())> what;
    try {
        what.emplace(read());
    } catch (const InputError&) {
        return;  // named and refused
    }
    use(*what);
}

}  // namespace lensproof
