// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/output_folder.h"

#include "core/base/atomic_file.h"
#include "core/base/json_text.h"
#include "core/base/outcome.h"
#include "core/scene/scene_json.h"

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

}  // namespace

void requireSynthFolder(const fs::path& folder, const std::vector<fs::path>& names) {
  const bool ours = madeBySynth(folder / "scene.json");
  if (ours) return;
  for (const fs::path& name : names) {
    std::error_code ignored;
    if (fs::exists(folder / name, ignored))
      throw InputError(
          (folder / name).string(), "",
          "already exists, and no scene.json there says that synth wrote it; nothing is overwritten: choose another folder");
  }
}

}  // namespace glint
