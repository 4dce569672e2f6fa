// SPDX-License-Identifier: BSD-3-Clause
// Parts of a divided work, as other machines send them.
#include <filesystem>
#include <optional>

#include "core/base/part_file.h"
#include "core/report/evaluation_part.h"
#include "core/synth/part.h"
#include "core/trials/part.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/scratch_file.h"

namespace glint::fuzz {
namespace {

/// What a merge writes must be JSON that a reader takes.
void requireJson(const std::string& text, const char* key) {
  try {
    if (!JsonNode::parse(text, "merged").has(key)) throw Finding{std::string("a merged document without ") + key};
  } catch (const InputError& e) {
    throw Finding{std::string("a merged document that is no JSON: ") + e.what()};
  }
}

bool merges(const std::string& file) {
  try {
    const std::string kind = kindOfPart(file);
    if (kind == "glint_evaluation") {
      requireJson(mergedEvaluation({file}).json, "models");
    } else if (kind == "glint_tradeoff") {
      requireJson(tradeoffJson(mergedTradeoff({file})), "points");
    } else if (kind == "glint_synth") {
      requireJson(mergedSynth({file}, scratch().path() / "scene.json").sceneJson, "frames");
    } else {
      return false;
    }
  } catch (const InputError& e) {
    checkRefusal(e, "");
    return false;
  }
  return true;
}

/// The same with a digest that fits again: as if somebody had changed the part on purpose. Else nearly every damage ends at the digest.
std::optional<std::string> resealed(const std::string& bytes) {
  try {
    const JsonNode root = JsonNode::parse(bytes, "fed.json");
    if (!root.isObject() || !root.has("shard") || !root.at("shard").isObject()) return std::nullopt;
    const std::optional<JsonNode> program = root.at("shard").find("program");
    return partText(bytes, {1, 1}, program && program->isString() ? program->text() : "glint");
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

bool feedPart(const std::string& bytes) {
  // In the folder in which parts of a synthetic scene must lie.
  std::filesystem::create_directories(scratch().path() / "parts");
  const bool asIs = merges(scratch().write("parts/fed.json", bytes));
  const std::optional<std::string> changed = resealed(bytes);
  return (changed && merges(scratch().write("parts/changed.json", *changed))) || asIs;
}

}  // namespace glint::fuzz
