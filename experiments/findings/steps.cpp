#include "experiments/findings/steps.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "engine/base/hash.h"

namespace lensproof::findings {

namespace {

/// Of a file of any size; what cannot be read is as good as empty.
std::string hash_of_file(const std::filesystem::path& file) {
    std::error_code error;  // a pipe would wait for ever
    std::ifstream stream;
    if (std::filesystem::is_regular_file(file, error)) {
        stream.open(file, std::ios::binary);
    }
    std::string chunk(std::size_t{1} << 20U, '\0');
    std::uint64_t hash = 0;
    while (stream.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), stream.gcount() > 0) {
        hash = hash_of(std::string_view(chunk).substr(0, static_cast<std::size_t>(stream.gcount())), hash);
    }
    return fmt::format("{:016x}", hash);
}

}  // namespace

std::string Steps::key_of(const StepInput& input) const {
    Json files = Json::list();
    for (const std::filesystem::path& file : input.files) {
        files.push_back(hash_of_file(file));
    }
    return Json{{"program", program_}, {"settings", input.settings}, {"files", std::move(files)}}.dump();
}

}  // namespace lensproof::findings
