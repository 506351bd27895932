#include "engine/formats/image/raw_fault.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <set>
#include <string_view>
#include <vector>

namespace lensproof::formats {

namespace {

constexpr std::string_view kMaker = "hasselblad";
constexpr std::size_t kMostLetters = 48;  // LibRaw has room for 63, and appends two endings like "-100fA"
constexpr std::size_t kLettersRead = 63;

constexpr std::uint32_t kMakerTag = 0x010F;
constexpr std::uint32_t kModelTag = 0x0110;
constexpr std::uint32_t kUniqueModelTag = 0xC614;
constexpr std::uint32_t kDirectoryTags[] = {0x014A, 0x8769};  // SubIFDs, and Exif's

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char letter) { return std::tolower(letter); });
    return text;
}

/// The texts of a TIFF's makers and cameras, as LibRaw reads them.
class TiffNames {
  public:
    explicit TiffNames(std::ifstream& stream) : stream_(&stream) {
        is_reversed_ = bytes(0, 2) == "MM";
        wait_for(number(4, 4));
        while (!waiting_.empty()) {
            const std::uint32_t at = waiting_.back();
            waiting_.pop_back();
            read_directory(at);
        }
    }

    [[nodiscard]] bool is_of(std::string_view maker) const {
        return std::ranges::any_of(makers_,
                                   [&](const std::string& name) { return name.find(maker) != std::string::npos; });
    }
    [[nodiscard]] std::size_t longest_model() const { return longest_model_; }

  private:
    std::string bytes(std::uint32_t at, std::size_t count) {
        std::string found(count, '\0');
        stream_->clear();
        stream_->seekg(at);
        stream_->read(found.data(), static_cast<std::streamsize>(count));
        found.resize(static_cast<std::size_t>(stream_->gcount()));
        return found;
    }

    /// Of two or four bytes; 0 beyond the file's end.
    std::uint32_t number(std::uint32_t at, std::size_t count) {
        std::string found = bytes(at, count);
        if (!is_reversed_) {
            std::ranges::reverse(found);
        }
        std::uint32_t value = 0;
        for (const char byte : found) {
            value = value << 8 | static_cast<unsigned char>(byte);
        }
        return value;
    }

    std::string text(std::uint32_t at) {
        const std::string found = bytes(at, kLettersRead);
        return lower(found.substr(0, found.find_first_of(std::string_view("\0\n", 2))));
    }

    void wait_for(std::uint32_t directory) {
        constexpr std::size_t kMostDirectories = 1000;
        if (directory != 0 && known_.size() < kMostDirectories && known_.insert(directory).second) {
            waiting_.push_back(directory);
        }
    }

    void read_directory(std::uint32_t at) {
        constexpr std::uint32_t kMostEntries = 512;  // LibRaw's
        const std::uint32_t entries = number(at, 2);
        if (entries > kMostEntries) {
            return;
        }
        for (std::uint32_t i = 0; i < entries; ++i) {
            read_entry(at + 2 + 12 * i);
        }
        wait_for(number(at + 2 + 12 * entries, 4));
    }

    void read_entry(std::uint32_t at) {
        constexpr std::string_view kBytesOfType = "\1\1\1\2\4\10\1\1\2\4\10\4\10\4";  // as LibRaw has them
        const std::uint32_t tag = number(at, 2);
        const std::uint32_t type = number(at + 2, 2);
        const std::uint32_t count = number(at + 4, 4);
        const std::uint32_t value = number(at + 8, 4);
        const std::uint64_t size = std::uint64_t{count} * kBytesOfType[type < kBytesOfType.size() ? type : 0];
        const std::uint32_t place = size > 4 ? value : at + 8;
        if (tag == kMakerTag) {
            makers_.push_back(text(place));
        } else if (tag == kModelTag || tag == kUniqueModelTag) {
            longest_model_ = std::max(longest_model_, text(place).size());
        } else if (std::ranges::find(kDirectoryTags, tag) != std::ranges::end(kDirectoryTags)) {
            constexpr std::uint32_t kMostBelow = 64;
            for (std::uint32_t i = 0; i < std::min(count, kMostBelow); ++i) {
                wait_for(number(place + 4 * i, 4));
            }
        }
    }

    std::ifstream* stream_;
    bool is_reversed_ = false;
    std::set<std::uint32_t> known_;
    std::vector<std::uint32_t> waiting_;
    std::vector<std::string> makers_;
    std::size_t longest_model_ = 0;
};

bool has_maker(std::ifstream& stream) {
    constexpr std::size_t kBlock = 1 << 20;
    std::string text;
    for (stream.seekg(0); stream;) {
        const std::size_t kept = std::min(text.size(), kMaker.size() - 1);
        text.erase(0, text.size() - kept);
        text.resize(kept + kBlock);
        stream.read(text.data() + kept, kBlock);
        text.resize(kept + static_cast<std::size_t>(stream.gcount()));
        if (lower(text).find(kMaker) != std::string::npos) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::string raw_fault(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string head(4, '\0');
    stream.read(head.data(), 4);
    using namespace std::string_view_literals;
    if (head != "II*\0"sv && head != "MM\0*"sv) {
        return has_maker(stream) ? "Hasselblad's raw files are TIFF, and this is none" : "";
    }
    const TiffNames names(stream);
    return names.is_of(kMaker) && names.longest_model() > kMostLetters
               ? fmt::format("its camera's name has {} letters or more, expected at most {} of a Hasselblad",
                             names.longest_model(), kMostLetters)
               : "";
}

}  // namespace lensproof::formats
