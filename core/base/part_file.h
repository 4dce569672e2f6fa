// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core: the envelope of what `--shard i/n` writes, whatever it holds.

#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/base/shard.h"

namespace glint {

/// A part that was read and is what was written: its digest matches.
struct PartFile {
  std::string file;  ///< as the user named it
  std::string kind;  ///< its first key: "glint_evaluation", ...
  Shard shard;
  std::string program;  ///< that wrote it, with its version
  JsonNode checked;     ///< the document, with the key `shard`
};

/// The text of a part: the JSON document, which has an object `shard`, with `index`, `of`, `program` and the digest of everything in that object.
std::string partText(const std::string& document, const Shard& shard, const std::string& program);

/// InputError: no JSON, not written by `--shard`, damaged, beyond the limits of JSON files.
PartFile readPart(const std::string& file);

/// All parts of one work, in order. InputError, which names the file: as readPart(), of another kind, version or number of shards than the
/// first, the same part twice, or a part that is missing.
std::vector<PartFile> readParts(const std::vector<std::string>& files);

/// Refuses two parts whose values of a key should be the same. For objects the first key inside that differs is named.
/// @param key  of the document, or "shard.KEY"
/// @throw InputError (the second file, the key)
void requireSame(const PartFile& first, const PartFile& second, const std::string& key);

}  // namespace glint
