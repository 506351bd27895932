#include "engine/base/text_encoding.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <stdexcept>

namespace lensproof {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF"sv;
constexpr std::string_view kLittleEndianMark = "\xFF\xFE"sv;
constexpr std::string_view kBigEndianMark = "\xFE\xFF"sv;

struct Closer {
    void operator()(iconv_t converter) const { iconv_close(converter); }
};
using Converter = std::unique_ptr<std::remove_pointer_t<iconv_t>, Closer>;

/// Every unit of `bytes` that cannot be converted becomes '?'; `unit` is its size in bytes. `failures` counts them.
std::string converted(std::string_view bytes, const char* to, const char* from, std::size_t unit, int& failures) {
    const iconv_t opened = iconv_open(to, from);
    // iconv's manual: (iconv_t) -1 says that it failed.
    if (reinterpret_cast<std::intptr_t>(opened) == -1) {
        throw std::runtime_error("the system's iconv cannot convert " + std::string(from) + " to " + to);
    }
    const Converter converter(opened);
    std::string text;
    std::array<char, 4096> buffer{};
    std::string source(bytes);
    char* in = source.data();
    std::size_t left = source.size();
    const std::string question = std::string_view(to) == "UTF-16LE" ? std::string("?\0", 2) : "?";
    while (left > 0) {
        char* out = buffer.data();
        std::size_t room = buffer.size();
        const std::size_t result = iconv(converter.get(), &in, &left, &out, &room);
        const int reason = errno;
        text.append(buffer.data(), static_cast<std::size_t>(out - buffer.data()));
        if (result == static_cast<std::size_t>(-1) && reason != E2BIG) {
            ++failures;
            text += question;
            const std::size_t skipped = std::min(unit, left);
            in += skipped;
            left -= skipped;
        }
    }
    return text;
}

/// Where the zeros of ASCII letters stand in the first bytes: at odd places for little endian, at even ones for big.
const char* utf16_by_zeros(std::string_view bytes) {
    const std::string_view start = bytes.substr(0, 1024);
    std::array<std::size_t, 2> zeros{};
    for (std::size_t i = 0; i < start.size(); ++i) {
        zeros[i % 2] += start[i] == '\0' ? 1 : 0;
    }
    const std::size_t most = start.size() / 4;  // half of the letters
    if (start.size() >= 4 && zeros[1] > most && zeros[0] <= most / 4) {
        return "UTF-16LE";
    }
    return start.size() >= 4 && zeros[0] > most && zeros[1] <= most / 4 ? "UTF-16BE" : nullptr;
}

}  // namespace

std::string to_utf8(std::string_view bytes) {
    int failures = 0;
    if (bytes.starts_with(kUtf8Mark)) {
        return converted(bytes.substr(kUtf8Mark.size()), "UTF-8", "UTF-8", 1, failures);
    }
    if (bytes.starts_with(kLittleEndianMark)) {
        return converted(bytes.substr(kLittleEndianMark.size()), "UTF-8", "UTF-16LE", 2, failures);
    }
    if (bytes.starts_with(kBigEndianMark)) {
        return converted(bytes.substr(kBigEndianMark.size()), "UTF-8", "UTF-16BE", 2, failures);
    }
    if (const char* utf16 = utf16_by_zeros(bytes)) {
        return converted(bytes, "UTF-8", utf16, 2, failures);
    }
    std::string text = converted(bytes, "UTF-8", "UTF-8", 1, failures);
    return failures == 0 ? text : converted(bytes, "UTF-8", "WINDOWS-1252", 1, failures);
}

std::string to_utf16(std::string_view utf8) {
    int failures = 0;
    return std::string(kLittleEndianMark) + converted(utf8, "UTF-16LE", "UTF-8", 1, failures);
}

}  // namespace lensproof
