// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/session/session.h"

namespace glint {

/// SHA-256 of what a scene names, by the path relative to its folder: the same on machines that keep the folder in different
/// places. "" for what cannot be read. Reads every file. Stopped.
inline std::vector<std::pair<std::string, std::string>> inputDigests(const Scene& scene, const ProgressFn& progress) {
  std::vector<std::pair<std::string, std::string>> digests;
  for (SessionFile& file : hashInputs(scene, InspectionRequest{}, progress)) {
    const std::filesystem::path relative = file.path.lexically_relative(scene.folder);
    digests.emplace_back((relative.empty() ? file.path : relative).generic_string(), std::move(file.sha256));
  }
  return digests;
}

}  // namespace glint
