// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/output_folder.h"

#include <string>

#include "core/base/atomic_file.h"
#include "core/base/json_text.h"
#include "core/base/outcome.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

/// Photographs that a person took may lie in `frames` too, but not with radiance, depth, normals and a mask beside each of them.
bool writtenBySynth(const JsonNode& frame) {
  int files = 0;
  for (const char* key : {"image", "radiance", "depth", "normals", "mask"}) {
    const std::optional<JsonNode> named = frame.find(key);
    if (!named) continue;
    const std::string folder = std::string(key) == "image" ? "frames" : key;
    if (fs::path(named->text()).parent_path() != folder) return false;
    files += std::string(key) != "image";
  }
  constexpr int kAll = 4;
  return files == kAll || (files == 0 && !frame.find("image"));
}

bool madeBySynth(const fs::path& sceneFile) {
  try {
    const JsonNode root = JsonNode::parse(readFile(sceneFile, Limit::JsonMegabytes), sceneFile.string());
    if (!root.find("glint_scene")) return false;
    const JsonNode frames = root.at("frames");
    for (std::size_t i = 0; i < frames.size(); ++i)
      if (!writtenBySynth(frames.at(i))) return false;
    return true;
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
      throw InputError((folder / name).string(), "",
                       "exists, and no earlier run of synth wrote it; it stays as it is: choose another folder");
  }
}

}  // namespace glint
