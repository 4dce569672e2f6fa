// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/scene.h"

namespace glint {

/// Every file that a scene names, each once: itself, its meshes, and the frames' pictures, depth maps, normals and masks.
std::vector<std::filesystem::path> filesOf(const Scene& scene);

/// Why a frame's photograph (its radiance where it has none) cannot be read, as far as its file tells without being decoded:
/// missing, empty, cut off, another size than the camera's (PNG). "FILE: reason"; "" = nothing is wrong, or the frame names no
/// file.
std::string photographProblem(const Frame& frame);

/// The same for all frames of a scene but those of `known`, by their index. Reads every file once. Stopped.
std::map<int, std::string> photographProblems(const Scene& scene, const std::map<int, std::string>& known = {},
                                              const ProgressFn& progress = {});

/// A sentence with the scene's folder taken off its paths: people know where their scene is, and a line has little room.
std::string withoutFolder(std::string sentence, const Scene& scene);

/// The scene with its photographs and radiances in another place: every file that `folder` holds under the same name, with the
/// longest part of its path that is found there ("a/frames/0003.png": FOLDER/a/frames/0003.png, then FOLDER/frames/0003.png, then
/// FOLDER/0003.png). What is not there stays where it was; depth maps, normals and masks do. A file that is found for both of a
/// frame's pictures is its photograph. Where anything is found, Scene::photographs names the folder.
/// @param found  how many files were found there; may be null.
Scene withPhotographsIn(Scene scene, const std::filesystem::path& folder, int* found = nullptr);

}  // namespace glint
