// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/scene.h"

#include <algorithm>
#include <fstream>

#include "core/base/atomic_file.h"
#include "core/base/json_text.h"
#include "core/base/limits.h"
#include "core/scene/permitted.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_json.h"
#include "core/scene/scene_reader.h"
#include "core/scene/session_input.h"

namespace glint {
namespace fs = std::filesystem;

std::string firstBytes(const fs::path& file, std::size_t n) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  std::ifstream in(file, std::ios::binary);
  std::string bytes(n, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(n));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return bytes;
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
  const double most =
      std::min(double(size), limitOf(Limit::JsonMegabytes) * kMegabyte);  // what is longer is refused by its reader
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
  std::string describe() const override { return "scene file (scene.json, version 1)"; }
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
    return readSceneJson(readFile(file, Limit::JsonMegabytes), file, options);
  }
};

class SessionSceneReader final : public SceneReader {
 public:
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
    SessionInput input = readSessionInput(root, fs::absolute(file).lexically_normal().parent_path());
    for (const auto& given : options.meshes) input.meshes.erase(given.first);  // what the caller says comes first
    std::vector<fs::path> named = options.folders;
    named.insert(named.end(), options.meshFolders.begin(), options.meshFolders.end());
    ReadOptions own = options;
    own.folders = foldersOfSession(file, input.scene, named);
    if (!options.allowOutsidePaths) requirePermitted(input, file.string(), own.folders);
    own.meshes.insert(input.meshes.begin(), input.meshes.end());
    std::error_code ignored;  // what cannot be asked about is not there
    if (!fs::exists(input.scene, ignored))
      root.at("input").at("path").fail("the scene " + input.scene.string() + " does not exist");
    requireSceneFile(input.scene, file.string());
    Scene scene = withFilesIn(readSceneOfSession(input.scene, own), input.folders);
    if (!options.allowOutsidePaths) requirePermittedFiles(scene, input.folders, file.string(), own.folders);
    return scene;
  }
};

std::string whatIsUnderstood() {
  std::string all;
  for (const auto& reader : sceneReaders()) all += (all.empty() ? "" : ", ") + reader->describe();
  return all;
}

}  // namespace

std::unique_ptr<const SceneReader> makeSceneFileReader() { return std::make_unique<SceneFileReader>(); }
std::unique_ptr<const SceneReader> makeSessionSceneReader() { return std::make_unique<SessionSceneReader>(); }

const std::vector<std::unique_ptr<const SceneReader>>& sceneReaders() {
  static const std::vector<std::unique_ptr<const SceneReader>> readers = [] {
    std::vector<std::unique_ptr<const SceneReader>> list;
    list.push_back(makeSceneFileReader());
    list.push_back(makeSessionSceneReader());
    return list;
  }();
  return readers;
}

fs::path resolveInside(const fs::path& folder, const std::string& relative, const ReadOptions& options, const std::string& file,
                       const std::string& place) {
  if (relative.empty()) throw InputError(file, place, "the path is empty");
  if (relative.find('\0') != std::string::npos) throw InputError(file, place, "the path contains a zero byte");
  const fs::path path(relative);
  const fs::path absolute = (path.is_absolute() ? path : folder / path).lexically_normal();
  if (options.allowOutsidePaths || liesIn(options.folders, absolute)) return absolute;
  if (path.is_absolute())
    throw OutsidePath(file, place,
                      "'" + relative + "' is absolute; paths must be relative to the file (--allow-outside accepts it)",
                      realPath(absolute).parent_path());
  if (!liesIn({folder}, folder / path))
    throw OutsidePath(file, place, "'" + relative + "' leaves the folder of the file (--allow-outside accepts it)",
                      realPath(absolute).parent_path());
  return absolute;
}

namespace {

Scene readRecognised(const fs::path& input, const ReadOptions& options, bool sessions) {
  std::error_code error;
  const fs::file_status status = fs::status(input, error);
  if (!fs::exists(status)) throw InputError(input.string(), "", "no such file or folder");
  for (const auto& reader : sceneReaders()) {
    const fs::path file = reader->recognise(input);
    if (file.empty()) continue;
    if (!sessions && dynamic_cast<const SessionSceneReader*>(reader.get()) != nullptr)
      throw InputError(file.string(), "", "is a session; the input of a session must be a scene");
    return reader->read(file, options);
  }
  if (fs::is_directory(status)) {
    const bool empty = fs::is_empty(input, error);
    throw InputError(input.string(), "",
                     std::string(empty ? "the folder is empty" : "nothing in this folder is recognised") +
                         "; supported: " + whatIsUnderstood());
  }
  if (!fs::is_regular_file(status)) throw InputError(input.string(), "", "is a device or a pipe, not a file");
  const bool empty = fs::file_size(input, error) == 0;
  throw InputError(
      input.string(), "",
      std::string(empty ? "the file is empty" : "the content is not recognised") + "; supported: " + whatIsUnderstood());
}

}  // namespace

Scene readScene(const fs::path& input, const ReadOptions& options) { return readRecognised(input, options, true); }
Scene readSceneOfSession(const fs::path& input, const ReadOptions& options) { return readRecognised(input, options, false); }

fs::path recognisedFile(const fs::path& input) {
  for (const auto& reader : sceneReaders())
    if (fs::path file = reader->recognise(input); !file.empty()) return file;
  return {};
}

void writeScene(const Scene& scene, const fs::path& file) {
  const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  atomicWrite(file, prettyJson(sceneToJson(scene, folder)));
}

}  // namespace glint
