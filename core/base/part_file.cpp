// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/part_file.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/base/number_list.h"
#include "core/base/outcome.h"
#include "core/base/sha256.h"

namespace glint {
namespace {

using json_dom::Json;

/// Of everything but the digest itself.
std::string digestOfPart(Json document) {
  document.at("shard").erase("sha256");
  Sha256 hash;
  hash.add(document.dump(-1, ' ', false, Json::error_handler_t::replace));
  return hash.hex();
}

constexpr std::size_t kMostShown = 60;  // characters of a value in a message

std::string shown(const Json* value) {
  if (!value) return "nothing";
  const std::string text = value->dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() > kMostShown ? text.substr(0, kMostShown) + "..." : text;
}

std::optional<Json> valueOf(const PartFile& part, const std::string& key) {
  constexpr std::string_view kInside = "shard.";
  const bool inside = key.rfind(kInside, 0) == 0;
  const std::optional<JsonNode> value =
      inside ? part.checked.at("shard").find(key.substr(kInside.size())) : part.checked.find(key);
  return value ? std::optional(json_dom::parse(value->dump(), part.file)) : std::nullopt;
}

}  // namespace

std::string partText(const std::string& text, const Shard& shard, const std::string& program) {
  Json document = json_dom::parse(text, "part");
  Json& about = document["shard"];
  about["index"] = shard.index;
  about["of"] = shard.of;
  about["program"] = program;
  const std::string digest = digestOfPart(document);
  about["sha256"] = digest;
  return document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

PartFile readPart(const std::string& file) {
  const std::string text = readFile(file, Limit::JsonMegabytes);
  const JsonNode checked = JsonNode::parse(text, file);
  if (!checked.isObject() || checked.keys().empty() || !checked.has("shard"))
    throw InputError(file, "",
                     "is no part of a work: it has no key \"shard\", which evaluate, synth and tradeoff write with --shard i/n");
  const JsonNode about = checked.at("shard");
  PartFile part{file, checked.keys().front(), {}, about.at("program").text(), checked};
  part.shard = {about.at("index").integer(), about.at("of").integer()};
  if (part.shard.of < 1 || part.shard.of > kMostShards)
    about.at("of").fail("must be between 1 and " + std::to_string(kMostShards));
  if (part.shard.index < 1 || part.shard.index > part.shard.of)
    about.at("index").fail("must be between 1 and " + std::to_string(part.shard.of));
  if (about.at("sha256").text() != digestOfPart(json_dom::parse(text, file)))
    throw InputError(file, "shard.sha256", "does not match the content: the part is damaged or was changed; make it again");
  return part;
}

std::string kindOfPart(const std::string& file) { return readPart(file).kind; }

std::vector<PartFile> readParts(const std::vector<std::string>& files) {
  require(!files.empty(), "readParts: no files");
  std::vector<PartFile> parts;
  for (const std::string& file : files) {
    parts.push_back(readPart(file));
    const PartFile &first = parts.front(), &part = parts.back();
    if (part.kind != first.kind)
      throw InputError(file, "", "holds \"" + part.kind + "\", " + first.file + " \"" + first.kind + "\"");
    if (part.program != first.program)
      throw InputError(file, "shard.program", "was written by " + part.program + ", " + first.file + " by " + first.program);
    if (part.shard.of != first.shard.of)
      throw InputError(file, "shard.of", "is part " + part.shard.text() + ", " + first.file + " is " + first.shard.text());
    for (std::size_t i = 0; i + 1 < parts.size(); ++i)
      if (parts[i].shard == part.shard)
        throw InputError(file, "", "is part " + part.shard.text() + ", as " + parts[i].file + " is");
  }
  std::sort(parts.begin(), parts.end(), [](const PartFile& a, const PartFile& b) { return a.shard.index < b.shard.index; });
  std::vector<int> missing;
  for (int i = 1, at = 0; i <= parts.front().shard.of; ++i) {
    if (at < static_cast<int>(parts.size()) && parts[static_cast<std::size_t>(at)].shard.index == i)
      ++at;
    else
      missing.push_back(i);
  }
  if (!missing.empty())
    throw InputError("", "",
                     (missing.size() == 1 ? "part " : "parts ") + shortList(missing) + " of " +
                         std::to_string(parts.front().shard.of) + (missing.size() == 1 ? " is" : " are") + " missing");
  return parts;
}

void requireSame(const PartFile& first, const PartFile& second, const std::string& key) {
  const std::optional<Json> a = valueOf(first, key), b = valueOf(second, key);
  if ((!a && !b) || (a && b && *a == *b)) return;
  std::string place = key;
  if (a && b && a->is_object() && b->is_object()) {
    // In their order, which is that of one program: looking every key up would take the square of a hostile file's keys.
    auto i = a->begin(), k = b->begin();
    while (i != a->end() && k != b->end() && i.key() == k.key() && *i == *k) ++i, ++k;
    if (i != a->end() && k != b->end() && i.key() == k.key())
      throw InputError(second.file, place + "." + i.key(), "is " + shown(&*k) + ", in " + first.file + " " + shown(&*i));
  }
  throw InputError(second.file, place, "is " + shown(b ? &*b : nullptr) + ", in " + first.file + " " + shown(a ? &*a : nullptr));
}

}  // namespace glint
