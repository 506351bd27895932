// tests/fuzz/replayed_readers.h — what the saved corpus is replayed on where there is no libFuzzer.
#pragma once
#include <map>
#include <string>

namespace lensproof {

/// What CMakeLists.txt lists, each a function of bytes.
const std::map<std::string, void (*)(const std::string&)>& replayed_readers();

}  // namespace lensproof
