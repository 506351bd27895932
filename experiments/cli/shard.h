// experiments/cli/shard.h — which part of a render's samples one of several machines takes.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/render/progressive.h"

namespace lensproof::cli {

/// Shard `index` of `count`, counted from 1.
struct Shard {
    int index = 1;
    int count = 1;

    /// Its part of `samples` a pixel, in whole blocks, so that the variances add up to the whole's: together the shards
    /// have each sample once, next to each other, so that each shard's points are as well spread as a render's of its
    /// own. Some are left none where there are more shards than blocks (`most_shards`).
    [[nodiscard]] render::SampleRange part_of(std::uint32_t samples) const;
};

inline constexpr int kMostShards = 10000;

/// What --shard was given, "2/5"; 1/1 where that is nothing. Throws InputError where it is not i/n with 1 ≤ i ≤ n ≤
/// kMostShards.
Shard read_shard(const std::string& text);

/// As many as `samples` have blocks.
std::uint32_t most_shards(std::uint32_t samples);

/// What a picture's file says of the shards in it: "2/5", or after a merge of some "1-3,5/8", or of all "1-8/8".
struct ShardSet {
    std::vector<int> indices;  // ascending
    int count = 1;

    [[nodiscard]] bool is_whole() const { return indices.size() == static_cast<std::size_t>(count); }
    [[nodiscard]] std::vector<int> missing() const;
};
std::optional<ShardSet> parse_shard_set(const std::string& text);
std::string shard_set_text(const ShardSet& set);

/// "1-3, 5" for messages.
std::string shard_list(const std::vector<int>& indices, const char* separator);

}  // namespace lensproof::cli
