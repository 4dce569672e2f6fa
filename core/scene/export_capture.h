// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace glint {

/// Cameras of a scene for another program, ready to be written.
struct Exported {
  std::vector<std::string> leftOut;  ///< what the other format cannot hold, one line each
  std::function<void()> write;       ///< InputError where a file exists already, a lens is not supported or the disk fails
};

/// nerfstudio's transforms.json: paths relative to its folder; depth maps and masks too, where nerfstudio reads them.
Exported transformsOf(const Scene& scene, const std::filesystem::path& file);
/// COLMAP's text model. Names of images are relative to `images/` of the project's root (the folder, or the one above `sparse` or
/// `sparse/0`), or to that root.
Exported colmapOf(const Scene& scene, const std::filesystem::path& folder);

}  // namespace glint
