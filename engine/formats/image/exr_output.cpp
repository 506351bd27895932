#include "engine/formats/image/exr_output.h"

#include <OpenEXR/ImfMultiPartInputFile.h>
#include <fmt/format.h>

#include <cerrno>
#include <exception>
#include <stdexcept>
#include <string>
#include <system_error>

#include "engine/base/write_file.h"

namespace lensproof::formats {

namespace {

/// Whether every part has the places of all its pieces, which are written last. The libraries close a file without
/// looking whether what was in their buffers could be written.
bool is_complete(const std::filesystem::path& file) {
    constexpr bool kReconstruct = false;
    const Imf::MultiPartInputFile input(file.c_str(), 1, kReconstruct);
    for (int part = 0; part < input.parts(); ++part) {
        if (!input.partComplete(part)) {
            return false;
        }
    }
    return true;
}

/// A library's message, which names the temporary file that it was given.
std::runtime_error failure(const std::filesystem::path& file, const std::filesystem::path& temporary, std::string why) {
    if (const std::size_t at = why.find(temporary.native()); at != std::string::npos) {
        why.replace(at, temporary.native().size(), file.native());
    }
    return std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), why));
}

}  // namespace

void write_exr_file(const std::filesystem::path& file,
                    const std::function<bool(OIIO::ImageOutput& output, const std::string& name)>& write) {
    write_whole(file, [&](const std::filesystem::path& temporary) {
        const auto output = OIIO::ImageOutput::create("openexr");
        if (!output || !write(*output, temporary.string())) {
            throw failure(file, temporary, output ? output->geterror() : OIIO::geterror());
        }
        try {
            if (!std::filesystem::is_regular_file(temporary) || is_complete(temporary)) {
                return;
            }
        } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): not even a header
        }
        throw std::system_error(ENOSPC, std::generic_category(), file.string() + " cannot be written");
    });
}

}  // namespace lensproof::formats
