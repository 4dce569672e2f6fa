// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/session_input.h"

#include <algorithm>

#include "core/base/permitted.h"
#include "core/scene/capture.h"
#include "core/scene/scene_files.h"

namespace glint {
namespace fs = std::filesystem;

namespace {
constexpr std::size_t kMostFolders = 100;  // every frame is looked for in each; a user names one or two of a kind
}  // namespace

fs::path absolutePath(const JsonNode& node, const fs::path& folder) {
  const std::string text = node.text();
  if (text.empty()) node.fail("the path is empty");
  if (text.find('\0') != std::string::npos) node.fail("the path contains a zero byte");
  return (folder / fs::path(text)).lexically_normal();
}

int readSessionVersion(const JsonNode& root) {
  const auto node = root.find("glint_session");
  if (!node && root.has("path") && !root.has("frames"))
    root.fail(
        "is a specification, not a session (`glint synth` makes a scene from it, `glint reconstruct` a session from that scene)");
  if (!node && root.has("glint_scene")) root.fail("is a scene, not a session (`glint reconstruct` makes a session from it)");
  if (!node) root.fail("is not a session: glint_session is missing");
  const int version = node->integer();
  if (version > kSessionVersion)
    node->fail("version " + std::to_string(version) + " is newer than this program supports (" + std::to_string(kSessionVersion) +
               ")");
  if (version < 1) node->fail("version " + std::to_string(version) + " does not exist");
  return version;
}

SessionInput readSessionInput(const JsonNode& root, const fs::path& folder) {
  const JsonNode input = root.at("input");
  SessionInput result;
  result.scene = absolutePath(input.at("path"), folder);
  if (const auto n = input.find("allow_outside")) n->boolean();  // what a session says about its own rights counts for nothing
  if (const auto n = input.find("photographs"); n && !n->isNull())
    result.folders.push_back({FrameFile::Photograph, absolutePath(*n, folder)});
  const auto all = input.find("folders");
  if (all && all->size() > kMostFolders)
    all->fail("names " + std::to_string(all->size()) + " folders; the limit is " + std::to_string(kMostFolders));
  for (std::size_t i = 0; all && i < all->size(); ++i) {
    const JsonNode of = all->at(i).at("of");
    const auto kind = std::find_if(kFrameFiles.begin(), kFrameFiles.end(), [&](FrameFile k) { return of.text() == nameOf(k); });
    if (kind == kFrameFiles.end()) of.fail("'" + of.text() + "' is not one of: photographs, depth, normals, masks");
    result.folders.push_back({*kind, absolutePath(all->at(i).at("folder"), folder)});
  }
  if (const auto meshes = input.find("meshes"); meshes && !meshes->isNull())
    for (const std::string& named : meshes->keys()) result.meshes[named] = absolutePath(meshes->at(named), folder);
  if (const auto reading = input.find("reading"); reading && !reading->isNull())
    result.choices = readInputChoices(*reading, folder);
  return result;
}

std::vector<fs::path> foldersOfSession(const fs::path& session, const fs::path& scene, const std::vector<fs::path>& named) {
  std::vector<fs::path> folders = named;
  if (!session.empty()) folders.push_back(fs::absolute(session).lexically_normal().parent_path());
  std::error_code ignored;  // a path that cannot be looked at counts as a file
  folders.push_back(fs::is_directory(scene, ignored) ? scene : scene.parent_path());
  for (fs::path& folder : foldersOfCapture(scene)) folders.push_back(std::move(folder));
  return folders;
}

namespace {
void require(bool lies, const fs::path& path, const std::string& file, const std::string& place, const std::string& option,
             const fs::path& folder) {
  if (lies) return;
  throw OutsidePath(file, place,
                    "'" + path.string() + "' is outside the folders of the session and its scene (" + option +
                        " names it, --allow-outside accepts it)",
                    folder);
}
}  // namespace

void requireSceneFile(const fs::path& scene, const std::string& session) {
  std::error_code ignored;  // a path that cannot be looked at counts as no folder
  if (fs::is_directory(scene, ignored))
    throw InputError(session, "input.path", "'" + scene.string() + "' is a folder; name the scene file");
}

void requirePermitted(const fs::path& folder, const std::vector<fs::path>& permitted, const std::string& file,
                      const std::string& place, const std::string& option) {
  require(liesIn(permitted, folder), folder, file, place, option, realPath(folder));
}

namespace {
std::string placeOf(std::size_t folder) { return "input.folders[" + std::to_string(folder) + "].folder"; }
std::string optionOf(const FilesFolder& f) {
  return f.kind == FrameFile::Photograph ? "--photographs DIR" : std::string("--files ") + nameOf(f.kind) + "=DIR";
}
}  // namespace

void requirePermittedFiles(const Scene& scene, const std::vector<FilesFolder>& folders, const std::string& file,
                           const std::vector<fs::path>& permitted) {
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const fs::path root = fs::absolute(folders[i].folder).lexically_normal();
    for (const Frame& frame : scene.frames)
      for (const fs::path* p : {&frame.image, &frame.radiance, &frame.depth, &frame.normals, &frame.mask}) {
        if (p->empty()) continue;
        const fs::path below = fs::absolute(*p).lexically_normal().lexically_relative(root);
        if (below.empty() || *below.begin() == "..") continue;
        require(liesIn(permitted, *p), *p, file, placeOf(i), optionOf(folders[i]), realPath(*p).parent_path());
      }
  }
}

void requirePermitted(const SessionInput& input, const std::string& file, const std::vector<fs::path>& permitted) {
  for (std::size_t i = 0; i < input.folders.size(); ++i)
    requirePermitted(input.folders[i].folder, permitted, file, placeOf(i), optionOf(input.folders[i]));
  for (const auto& [named, mesh] : input.meshes)
    require(liesIn(permitted, mesh), mesh, file, "input.meshes." + named, "--mesh " + named + "=FILE",
            realPath(mesh).parent_path());
  if (const fs::path& mesh = input.choices.surfaceFile; !mesh.empty())
    require(liesIn(permitted, mesh), mesh, file, "input.reading.surface_file", "--meshes DIR", realPath(mesh).parent_path());
  if (const fs::path& poses = input.choices.poses; !poses.empty())
    require(liesIn(permitted, poses), poses, file, "input.reading.poses", "--photographs DIR", realPath(poses).parent_path());
  if (const fs::path response = responseFileOf(input.choices); !response.empty())
    require(liesIn(permitted, response), response, file, "input.reading.response_file", "--photographs DIR",
            realPath(response).parent_path());
}

}  // namespace glint
