// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/scene.h"

namespace glint {

/// Every file that a scene names, each once: itself, its meshes, and the frames' pictures, depth maps, normals and masks.
std::vector<std::filesystem::path> filesOf(const Scene& scene);

/// All kinds, in the order in which a file that could be of several is taken.
inline constexpr std::array<FrameFile, 4> kFrameFiles{FrameFile::Photograph, FrameFile::Depth, FrameFile::Normals,
                                                      FrameFile::Mask};
/// The word in sessions: "photographs", "depth", "normals", "masks".
const char* nameOf(FrameFile kind);

/// Why a file of a frame (for photographs the image, else the radiance) cannot be read, as far as it shows without decoding:
/// missing; empty; cut off (PNG, JPEG, EXR); another size than the camera's (PNG). "FILE: reason"; "" = nothing is wrong, or the
/// frame names no such file.
std::string frameFileProblem(const Frame& frame, FrameFile kind);

/// Unreadable files by kind and by the frame's index: "FILE: reason".
using FrameFileProblems = std::map<FrameFile, std::map<int, std::string>>;

/// The same for all frames of a scene but those of `known`. Reads every file once. Stopped.
FrameFileProblems frameFileProblems(const Scene& scene, const FrameFileProblems& known = {}, const ProgressFn& progress = {});

/// Which file of a frame a sentence "FILE: reason" is about; nothing = none of them.
std::optional<FrameFile> fileNamedIn(const std::string& sentence, const Frame& frame);

/// The mesh that a sentence "FILE: reason" is about, as the scene file writes it; "" = none.
std::string meshNamedIn(const std::string& sentence, const Scene& scene);

/// Where the mesh is that a document calls `named`: where `options` say, else at its place, else in one of the folders of
/// `options`. Scene::meshes keeps the path of a mesh that is not at its place. @param where  in the document. MissingMesh; what
/// `place` throws.
std::filesystem::path placeOfMesh(const std::string& named, const std::function<std::filesystem::path()>& place,
                                  const ReadOptions& options, Scene& scene, const std::string& where);

/// The scene with another file for the mesh that the scene file calls `named`; Scene::meshes says so.
/// @param now  need not exist.
Scene withMeshAt(Scene scene, const std::string& named, const std::filesystem::path& now);

/// A sentence with the scene's folder taken off its paths: people know where their scene is, and a line has little room.
std::string withoutFolder(std::string sentence, const Scene& scene);

/// The scene with its files of one kind in another place: every one that `folder` holds under the same name, with the longest
/// part of its path that is found there ("a/frames/0003.png": FOLDER/a/frames/0003.png, then FOLDER/frames/0003.png, then
/// FOLDER/0003.png). What is not there stays where it was, and so do the other kinds; a file that the frame uses already is not
/// taken. A file that is found for both of a frame's pictures is its photograph. If anything is found, `folder` becomes the last
/// of Scene::folders.
/// @param found  how many files were found there; may be null.
Scene withFilesIn(Scene scene, FrameFile kind, const std::filesystem::path& folder, int* found = nullptr);

/// The same with one folder after the other, as a session names them; Scene::folders are these, with those that are missing
/// today.
Scene withFilesIn(Scene scene, const std::vector<FilesFolder>& folders);

/// The kinds whose files in `folder` cannot be told from those of another of `kinds`, because both have the same file of a frame
/// there.
std::set<FrameFile> ambiguousIn(const Scene& scene, const std::set<FrameFile>& kinds, const std::filesystem::path& folder);

}  // namespace glint
