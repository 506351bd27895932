// Runs a fuzz target on every file of a folder: what libFuzzer does with a corpus, for builds without it.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>

#include "engine/base/file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: %s FOLDER\n", argv[0]);
        return 2;
    }
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
        std::printf("%s\n", entry.path().filename().c_str());
        std::fflush(stdout);  // the last name printed is the one that crashed
        const std::string bytes = lensproof::read_file(entry.path());
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        ++files;
    }
    std::printf("%d files\n", files);
    return files > 0 ? 0 : 1;
}
