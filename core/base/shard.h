// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

namespace glint {

/// One of several equal parts of a work, which other processes or machines do beside it.
/// Invariant: 1 <= index <= of <= kMostShards.
struct Shard {
  int index = 1, of = 1;
  friend bool operator==(const Shard&, const Shard&) = default;
  /// "2/8"
  std::string text() const;
};
inline constexpr int kMostShards = 10000;  ///< beyond, a shard costs more to start than it computes; bounds what a part may claim

/// "2/8": the second of eight. InputError (place `flag` and the text) for anything else.
Shard parseShard(const std::string& text, const std::string& flag);

/// [first, end) of `count` things in a row: the ranges of all shards follow one another and cover everything once. Empty where there are
/// fewer things than shards.
std::pair<int, int> rangeOf(const Shard& shard, int count);

/// What a file that `--shard` wrote is a part of: its first key ("glint_evaluation", ...). InputError: no part, or damaged.
std::string kindOfPart(const std::string& file);

}  // namespace glint
