// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/found_file.h"
#include "core/base/outcome.h"
#include "core/scene/input_choices.h"

namespace glint {

/// Where inputs are now that are not where a session or scene says (an empty member: they are where it says), and how a capture
/// is read.
struct Relinked {
  std::filesystem::path scene = {};                          ///< of a session
  std::map<std::string, std::filesystem::path> meshes = {};  ///< by the path that the scene file writes
  std::vector<std::filesystem::path> meshFolders = {};       ///< in which those are looked for that are not in their place
  std::vector<std::filesystem::path> folders = {};           ///< in which the session may name files: those that a person named
  InputChoices choices = {};                                 ///< for a capture that is opened, not for that of a session
  bool any() const { return !scene.empty() || !meshes.empty() || !meshFolders.empty(); }
};

/// A mesh of a scene is not where the scene says, nor where it was relinked to: a person can mend it by pointing at the mesh.
/// `what()` names the scene file, the place in it, and the path.
class MissingMesh : public InputError {
 public:
  MissingMesh(const std::string& file, const std::string& place, std::string named, std::filesystem::path mesh);
  const std::string& named() const { return named_; }          ///< as the scene file writes it: a key of Relinked::meshes
  const std::filesystem::path& mesh() const { return mesh_; }  ///< absolute, where it was looked for

 private:
  std::string named_;
  std::filesystem::path mesh_;
};

/// The folder in which to look for what lay beside `file`, now that it is `now`: `now` without the end that both paths share; its
/// folder where they share none. sameUnder(folderOfMove(file, now), file) is `now` where the names agree.
std::filesystem::path folderOfMove(const std::filesystem::path& file, const std::filesystem::path& now);

}  // namespace glint
