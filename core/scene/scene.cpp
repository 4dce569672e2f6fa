// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/scene.h"

#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/found_file.h"
#include "core/base/json_text.h"
#include "core/base/limits.h"
#include "core/base/permitted.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_json.h"
#include "core/scene/scene_reader.h"
#include "core/scene/session_input.h"

namespace glint {
namespace fs = std::filesystem;

const AnalyticSpec* Scene::formulaOf(const std::string& surface) const {
  const auto found = surfaces.find(surface);
  return found == surfaces.end() ? nullptr : found->second.analytic();
}

namespace {

/// An opening brace (after blanks and a byte-order mark) and this key in quotes somewhere in the file.
bool isJsonObjectWith(const fs::path& file, const std::string& key) {
  std::error_code error;
  const auto size = fs::file_size(file, error);
  if (error || !fs::is_regular_file(file, error)) return false;
  const std::string start = firstBytes(file, 64);
  const std::size_t at = start.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (at == std::string::npos || start[at] != '{') return false;
  constexpr double kMegabyte = 1e6;
  // The reader refuses a longer file.
  const double most = std::min(double(size), limitOf(Limit::JsonMegabytes) * kMegabyte);
  return firstBytes(file, static_cast<std::size_t>(most)).find("\"" + key + "\"") != std::string::npos;
}

std::vector<fs::path> sortedFiles(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == extension && it->path().filename().string()[0] != '.') files.push_back(it->path());
  std::sort(files.begin(), files.end());
  return files;
}

class SceneFileReader final : public SceneReader {
 public:
  std::string name() const override { return "scene"; }
  std::string describe() const override { return "scene file (scene.json)"; }
  fs::path recognise(const fs::path& input) const override {
    std::error_code error;
    if (fs::is_directory(input, error)) {
      if (fs::exists(input / "scene.json", error)) return input / "scene.json";
      for (const fs::path& file : sortedFiles(input, ".json"))
        if (isJsonObjectWith(file, "glint_scene")) return file;
      return {};
    }
    // A file of this name is meant as a scene even when its first key is missing or its text is broken: the reader's
    // message says more than "not recognised".
    return input.filename() == "scene.json" || isJsonObjectWith(input, "glint_scene") ? input : fs::path();
  }
  Scene read(const fs::path& file, const ReadOptions& options) const override {
    InputChoices others = options.choices;
    others.as.clear();
    if (!others.none())
      throw InputError(file.string(), "",
                       "is a scene file, which says everything itself: --surface, --camera, --units and the "
                       "like are for captures of other programs");
    return readSceneJson(readFile(file, Limit::JsonMegabytes), file, options);
  }
};

class SessionSceneReader final : public SceneReader {
 public:
  std::string name() const override { return "session"; }
  std::string describe() const override { return "session (*.glint)"; }
  fs::path recognise(const fs::path& input) const override {
    std::error_code error;
    if (fs::is_directory(input, error)) {
      for (const fs::path& file : sortedFiles(input, ".glint"))
        if (isJsonObjectWith(file, "glint_session")) return file;
      return {};
    }
    return isJsonObjectWith(input, "glint_session") ? input : fs::path();
  }
  Scene read(const fs::path& file, const ReadOptions& options) const override {
    const JsonNode root = JsonNode::parse(readFile(file, Limit::JsonMegabytes), file.string());
    readSessionVersion(root);
    if (!options.choices.none())
      throw InputError(file.string(), "",
                       "is a session, which keeps how its input is read: --as, --surface, --camera, --units and "
                       "the like are not for sessions");
    SessionInput input = readSessionInput(root, fs::absolute(file).lexically_normal().parent_path());
    for (const auto& given : options.meshes) input.meshes.erase(given.first);  // the caller's choice comes first
    std::vector<fs::path> named = options.folders;
    named.insert(named.end(), options.meshFolders.begin(), options.meshFolders.end());
    ReadOptions own = options;
    own.folders = foldersOfSession(file, input.scene, named);
    if (!options.allowOutsidePaths) requirePermitted(input, file.string(), own.folders);
    own.meshes.insert(input.meshes.begin(), input.meshes.end());
    own.choices = input.choices;
    for (const FilesFolder& f : input.folders)
      if (f.kind == FrameFile::Photograph) own.photographs.push_back(f.folder);
    std::error_code ignored;  // a file that cannot be looked at counts as missing
    if (!fs::exists(input.scene, ignored))
      root.at("input").at("path").fail("the scene " + input.scene.string() + " does not exist");
    requireSceneFile(input.scene, file.string());
    Scene scene = withFilesIn(readSceneOfSession(input.scene, own), input.folders);
    if (!options.allowOutsidePaths) requirePermittedFiles(scene, input.folders, file.string(), own.folders);
    return scene;
  }
};

}  // namespace

std::unique_ptr<const SceneReader> makeSceneFileReader() { return std::make_unique<SceneFileReader>(); }
std::unique_ptr<const SceneReader> makeSessionSceneReader() { return std::make_unique<SessionSceneReader>(); }

void writeScene(const Scene& scene, const fs::path& file) {
  const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  atomicWrite(file, sceneToJson(scene, folder));
}

}  // namespace glint
