// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/shard.h"

#include <charconv>
#include <cstdint>
#include <string_view>

#include "core/base/outcome.h"

namespace glint {
namespace {

/// Digits alone: no sign, no blank, nothing behind them.
bool wholeNumber(std::string_view text, int& value) {
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return !text.empty() && text.front() != '-' && error == std::errc() && stop == end;
}

}  // namespace

std::string Shard::text() const { return std::to_string(index) + "/" + std::to_string(of); }

Shard parseShard(const std::string& text, const std::string& flag) {
  Shard shard;
  const std::size_t slash = text.find('/');
  const std::string_view all = text;
  if (slash == std::string::npos || !wholeNumber(all.substr(0, slash), shard.index) ||
      !wholeNumber(all.substr(slash + 1), shard.of))
    throw InputError("", flag + " " + text, "expected i/n, such as 2/8 for the second of eight shards");
  if (shard.of < 1 || shard.of > kMostShards)
    throw InputError("", flag + " " + text, "the number of shards must be between 1 and " + std::to_string(kMostShards));
  if (shard.index < 1 || shard.index > shard.of)
    throw InputError("", flag + " " + text, "shards are numbered from 1 to " + std::to_string(shard.of));
  return shard;
}

std::pair<int, int> rangeOf(const Shard& shard, int count) {
  require(1 <= shard.index && shard.index <= shard.of && count >= 0, "rangeOf: no such shard");
  const auto before = [&](int shards) { return static_cast<int>(std::int64_t{count} * shards / shard.of); };
  return {before(shard.index - 1), before(shard.index)};
}

}  // namespace glint
