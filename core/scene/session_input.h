// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/scene/scene.h"

namespace glint {

/// Version 1 was the first. 2: `tradeoff` may stand in it; a file of version 1 reads as one without. 3: `input.folders` for every
/// kind of file and `view.more_cameras`; the one folder of photographs that older ones name (`input.photographs`) is the first of
/// them. 4: `input.reading`, how a capture of another program is read.
inline constexpr int kSessionVersion = 4;

/// The version of a session's document. InputError when the document is no session (a scene is named as such), or its version is
/// newer than this program's or never existed.
int readSessionVersion(const JsonNode& root);

/// A path that a session writes, relative to its folder. InputError for an empty one and one with a zero byte.
std::filesystem::path absolutePath(const JsonNode& node, const std::filesystem::path& folder);

/// What the `input` of a session names, absolute. A session comes from others: `requirePermitted` before anything of it is
/// looked at.
struct SessionInput {
  std::filesystem::path scene;                          ///< a file, see requireSceneFile(); may lie anywhere
  std::vector<FilesFolder> folders;                     ///< in which frames' files are looked for, in the session's order
  std::map<std::string, std::filesystem::path> meshes;  ///< by the path that the scene file writes
  InputChoices choices;                                 ///< for a capture of another program
};

/// @param folder  of the session, absolute
SessionInput readSessionInput(const JsonNode& root, const std::filesystem::path& folder);

/// The folders in which a session may name files: its own, its scene's, and those of the caller.
std::vector<std::filesystem::path> foldersOfSession(const std::filesystem::path& session, const std::filesystem::path& scene,
                                                    const std::vector<std::filesystem::path>& named);

/// InputError where the scene that a session names is a folder: which of its files is meant would not be known.
void requireSceneFile(const std::filesystem::path& scene, const std::string& session);

/// OutsidePath (place input.folders[i].folder, input.meshes.NAME) for the first that lies in none of `permitted`.
void requirePermitted(const SessionInput& input, const std::string& file, const std::vector<std::filesystem::path>& permitted);
/// The same for the files that the folders of a session gave to its scene: a link in a folder may lead out of it.
void requirePermittedFiles(const Scene& scene, const std::vector<FilesFolder>& folders, const std::string& file,
                           const std::vector<std::filesystem::path>& permitted);
/// The same for one folder. @param option  that names such a folder on the command line, "--photographs"
void requirePermitted(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& permitted,
                      const std::string& file, const std::string& place, const std::string& option);

}  // namespace glint
