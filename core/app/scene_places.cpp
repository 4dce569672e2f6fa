// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/scene_places.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/scene/scene_files.h"

namespace glint {
namespace fs = std::filesystem;

namespace {
void requireFolder(const std::string& folder, const std::string& given) {
  std::error_code ignored;  // unreadable counts as missing
  if (!fs::is_directory(folder, ignored)) throw InputError("", given, "this folder does not exist");
}

/// The meshes' paths as the scene file writes them.
std::set<std::string> meshNames(const Scene& scene) {
  std::set<std::string> names;
  for (const auto& [id, source] : scene.surfaces)
    if (const SurfaceFile* const read = source.file()) {
      const auto moved =
          std::find_if(scene.meshes.begin(), scene.meshes.end(), [&](const auto& m) { return m.second == read->file; });
      names.insert(moved != scene.meshes.end() ? moved->first : read->file.lexically_relative(scene.folder).generic_string());
    }
  return names;
}
}  // namespace

InputChoices ScenePlaces::choices() const {
  InputChoices c;
  for (const ChoiceOption& option : choiceOptions())
    if (const auto given = reading.find(option.flag); given != reading.end() && !given->second.empty())
      option.set(c, given->second);
  return c;
}

Relinked ScenePlaces::relinked() const {
  Relinked r;
  for (const std::string& entry : mesh) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == entry.size())
      throw InputError("", "--mesh " + entry, "expected NAME=FILE");
    r.meshes[entry.substr(0, equals)] = entry.substr(equals + 1);
  }
  for (const std::string& folder : meshFolders) {
    requireFolder(folder, "--meshes " + folder);
    r.meshFolders.push_back(folder);
  }
  r.folders.assign(photographs.begin(), photographs.end());
  for (const std::string& entry : files)
    if (const std::size_t equals = entry.find('='); equals != std::string::npos) r.folders.push_back(entry.substr(equals + 1));
  return r;
}

void ScenePlaces::check(Scene& scene) const {
  for (const auto& [named, file] : relinked().meshes)
    if (!scene.meshes.count(named)) {
      std::string known;
      for (const std::string& name : meshNames(scene)) known += (known.empty() ? "" : ", ") + name;
      throw InputError("", "--mesh " + named + "=" + file.string(),
                       "the scene has no mesh '" + named + "'" + (known.empty() ? "" : "; known: " + known));
    }
  for (const std::string& folder : photographs) lookIn(scene, FrameFile::Photograph, folder, "--photographs " + folder);
  for (const std::string& entry : files) {
    const std::size_t equals = entry.find('=');
    const auto kind =
        std::find_if(kFrameFiles.begin(), kFrameFiles.end(), [&](FrameFile k) { return entry.substr(0, equals) == nameOf(k); });
    if (equals == std::string::npos || kind == kFrameFiles.end())
      throw InputError("", "--files " + entry, "expected KIND=DIR, where KIND is one of: photographs, depth, normals, masks");
    lookIn(scene, *kind, entry.substr(equals + 1), "--files " + entry);
  }
}

void ScenePlaces::lookIn(Scene& scene, FrameFile kind, const std::string& folder, const std::string& given) const {
  requireFolder(folder, given);
  int found = 0;
  scene = withFilesIn(std::move(scene), kind, folder, &found);
  if (found == 0)
    throw InputError(
        "", given,
        kind == FrameFile::Photograph ? "contains no photograph of this scene" : "contains no such file of this scene");
}

Scene ScenePlaces::read(const std::string& input) const {
  const Relinked r = relinked();
  ReadOptions options;
  options.allowOutsidePaths = allowOutside;
  options.meshes = r.meshes;
  options.meshFolders = r.meshFolders;
  options.folders = r.folders;
  options.photographs.assign(photographs.begin(), photographs.end());
  options.choices = choices();
  Scene scene = readScene(input, options);
  check(scene);
  return scene;
}

Replay ScenePlaces::replay(Session session, const ProgressFn& progress) const {
  session.allowOutsidePaths = allowOutside;
  return glint::replay(session, relinked(), progress);
}

Session ScenePlaces::readRequestOf(const std::string& file, bool withItsTruth) const {
  Session session = readSession(file);
  session.allowOutsidePaths = allowOutside;
  if (withItsTruth) requirePermittedTruth(session, relinked());
  return session;
}

OpenedSession ScenePlaces::openSession(const std::string& file) const {
  if (!choices().none())
    throw InputError(file, "",
                     "is a session, which keeps how its input is read: --as, --surface, --camera, --units and the like "
                     "are not for sessions");
  Session session = readSession(file);
  session.allowOutsidePaths = allowOutside;
  OpenedSession opened = glint::openSession(std::move(session), relinked());
  Scene scene = *opened.scene;
  check(scene);
  opened.scene = std::make_shared<const Scene>(std::move(scene));
  return opened;
}

}  // namespace glint
