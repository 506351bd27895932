#include "experiments/cli/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <string_view>

#include "engine/base/input_error.h"

namespace lensproof::cli {

namespace {

/// Takes a whole number from 1 to kMostShards from the front of the text.
std::optional<int> take_number(std::string_view& text) {
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || number < 1 || number > kMostShards) {
        return std::nullopt;
    }
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

bool take(std::string_view& text, char wanted) {
    const bool is_there = text.starts_with(wanted);
    text.remove_prefix(is_there ? 1 : 0);
    return is_there;
}

}  // namespace

std::uint32_t most_shards(std::uint32_t samples) {
    return (samples + render::kSamplesPerBlock - 1) / render::kSamplesPerBlock;
}

render::SampleRange Shard::part_of(std::uint32_t samples) const {
    const std::uint64_t blocks = most_shards(samples);
    const auto end_of = [&](int shards) {
        const std::uint64_t before = blocks * static_cast<unsigned>(shards) / static_cast<unsigned>(count);
        return static_cast<std::uint32_t>(std::min<std::uint64_t>(samples, before * render::kSamplesPerBlock));
    };
    return {.first = end_of(index - 1), .end = end_of(index)};
}

std::optional<ShardSet> parse_shard_set(const std::string& text) {
    std::string_view rest = text;
    ShardSet set;
    do {
        const std::optional<int> first = take_number(rest);
        const std::optional<int> last = first && take(rest, '-') ? take_number(rest) : first;
        if (!last || *last < *first || (!set.indices.empty() && *first <= set.indices.back())) {
            return std::nullopt;
        }
        const std::size_t before = set.indices.size();
        set.indices.resize(before + static_cast<std::size_t>(*last - *first + 1));
        std::iota(set.indices.begin() + static_cast<std::ptrdiff_t>(before), set.indices.end(), *first);
    } while (take(rest, ','));
    const std::optional<int> count = take(rest, '/') ? take_number(rest) : std::nullopt;
    if (!count || !rest.empty() || set.indices.back() > *count) {
        return std::nullopt;
    }
    set.count = *count;
    return set;
}

Shard read_shard(const std::string& text) {
    if (text.empty()) {
        return {};
    }
    const std::optional<ShardSet> set = parse_shard_set(text);
    if (!set || set->indices.size() != 1 || text.find('-') != std::string::npos) {
        throw InputError(
            fmt::format("--shard is \"{}\", expected i/n, such as 2/5, with 1 ≤ i ≤ n ≤ {}", text, kMostShards));
    }
    return {.index = set->indices[0], .count = set->count};
}

std::vector<int> ShardSet::missing() const {
    std::vector<int> all(static_cast<std::size_t>(count));
    std::iota(all.begin(), all.end(), 1);
    std::vector<int> absent;
    std::ranges::set_difference(all, indices, std::back_inserter(absent));
    return absent;
}

std::string shard_list(const std::vector<int>& indices, const char* separator) {
    std::string text;
    for (std::size_t i = 0; i < indices.size();) {
        std::size_t end = i + 1;
        while (end < indices.size() && indices[end] == indices[end - 1] + 1) {
            ++end;
        }
        text += text.empty() ? "" : separator;
        text += end - i > 1 ? fmt::format("{}-{}", indices[i], indices[end - 1]) : fmt::format("{}", indices[i]);
        i = end;
    }
    return text;
}

std::string shard_set_text(const ShardSet& set) {
    return fmt::format("{}/{}", shard_list(set.indices, ","), set.count);
}

}  // namespace lensproof::cli
