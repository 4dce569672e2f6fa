// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/json_text.h"
#include "core/base/outcome.h"
#include "core/base/output_place.h"
#include "core/scene/scene_json.h"
#include "core/synth/synth.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

bool madeBySynth(const fs::path& sceneFile) {
  try {
    const JsonNode root = JsonNode::parse(readFile(sceneFile, Limit::JsonMegabytes), sceneFile.string());
    return root.has("glint_scene") && isMadeBySynth(root);
  } catch (const std::exception&) {
    return false;  // not what synth writes
  }
}

/// The first of these files that exists and was not written by `synth`; "" = no such file.
fs::path takenIn(const fs::path& folder, const std::vector<fs::path>& names) {
  if (madeBySynth(folder / "scene.json")) return {};
  std::error_code ignored;  // a file that cannot be looked at counts as missing
  const auto taken =
      std::find_if(names.begin(), names.end(), [&](const fs::path& name) { return fs::exists(folder / name, ignored); });
  return taken == names.end() ? fs::path() : *taken;
}

}  // namespace

void requireSynthFolder(const fs::path& folder, const std::vector<fs::path>& names) {
  if (const fs::path taken = takenIn(folder, names); !taken.empty())
    throw InputError(
        (folder / taken).string(), "",
        "already exists, and no scene.json there says that synth wrote it; nothing is overwritten: choose another folder");
  expectOutput(folder, [folder = fs::absolute(folder), names] { return takenIn(folder, names).empty(); });
}

}  // namespace glint
