// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/scene_files.h"

#include <set>
#include <vector>

#include "core/base/found_file.h"
#include "core/scene/relinked.h"

namespace glint {
namespace fs = std::filesystem;

std::vector<fs::path> filesOf(const Scene& scene) {
  std::vector<fs::path> paths{fs::absolute(scene.file).lexically_normal()};
  std::set<fs::path> seen(paths.begin(), paths.end());
  const auto add = [&](const fs::path& p) {
    if (!p.empty() && seen.insert(p).second) paths.push_back(p);
  };
  for (const fs::path& p : scene.sources) add(p);
  for (const auto& [id, source] : scene.surfaces)
    if (source.file()) add(source.file()->file);
  for (const Frame& f : scene.frames)
    for (const fs::path* p : {&f.image, &f.radiance, &f.depth, &f.normals, &f.mask, &f.response.file()}) add(*p);
  return paths;
}

const char* nameOf(FrameFile kind) {
  switch (kind) {
    case FrameFile::Photograph: return "photographs";
    case FrameFile::Depth: return "depth";
    case FrameFile::Normals: return "normals";
    case FrameFile::Mask: return "masks";
  }
  return "";
}

FrameFileProblems frameFileProblems(const Scene& scene, const FrameFileProblems& known, const ProgressFn& progress) {
  FrameFileProblems problems;
  const int n = static_cast<int>(scene.frames.size());
  for (int i = 0; i < n; ++i) {
    if (!report(progress, {"frame files", i, n})) throw Stopped{};
    for (const FrameFile kind : kFrameFiles) {
      const auto of = known.find(kind);
      if (of != known.end() && of->second.count(i)) continue;
      if (std::string problem = frameFileProblem(scene.frames[static_cast<std::size_t>(i)], kind); !problem.empty())
        problems[kind][i] = std::move(problem);
    }
  }
  return problems;
}

std::optional<FrameFile> fileNamedIn(const std::string& sentence, const Frame& frame) {
  const auto names = [&](const fs::path& file) { return !file.empty() && sentence.rfind(file.string() + ": ", 0) == 0; };
  if (names(frame.image) || names(frame.radiance)) return FrameFile::Photograph;
  if (names(frame.depth)) return FrameFile::Depth;
  if (names(frame.normals)) return FrameFile::Normals;
  if (names(frame.mask)) return FrameFile::Mask;
  return std::nullopt;
}

std::string meshNamedIn(const std::string& sentence, const Scene& scene) {
  for (const auto& [id, source] : scene.surfaces)
    if (const SurfaceFile* const f = source.file(); f && sentence.rfind(f->file.string() + ": ", 0) == 0) return f->named;
  return "";
}

MissingMesh::MissingMesh(const std::string& file, const std::string& place, std::string named, fs::path mesh)
    : InputError(file, place, "file '" + mesh.string() + "' does not exist"), named_(std::move(named)), mesh_(std::move(mesh)) {}

fs::path folderOfMove(const fs::path& file, const fs::path& now) {
  fs::path was = file.lexically_normal(), is = now.lexically_normal();
  if (was.filename() != is.filename()) return is.parent_path();
  while (was.has_filename() && was.filename() == is.filename() && is.has_relative_path()) {
    was = was.parent_path();
    is = is.parent_path();
  }
  return is;
}

fs::path placeOfMesh(const std::string& named, const std::function<fs::path()>& place, const ReadOptions& options, Scene& scene,
                     const std::string& where) {
  const auto moved = options.meshes.find(named);
  const bool isMoved = moved != options.meshes.end();
  const fs::path first = isMoved ? fs::absolute(moved->second).lexically_normal() : place();
  std::error_code ignored;  // a file that cannot be looked at counts as missing
  fs::path found = fs::is_regular_file(first, ignored) ? first : fs::path();
  for (const fs::path& folder : options.meshFolders)
    if (found.empty()) found = sameUnder(fs::absolute(folder), first);
  if (found.empty()) throw MissingMesh(scene.file.string(), where, named, first);
  if (isMoved || found != first) scene.meshes[named] = found;
  return found;
}

Scene withMeshAt(Scene scene, const std::string& named, const fs::path& now) {
  for (auto& [id, source] : scene.surfaces)
    if (SurfaceFile* const f = source.file(); f && f->named == named)
      f->file = scene.meshes[named] = fs::absolute(now).lexically_normal();
  return scene;
}

std::string withoutFolder(std::string sentence, const Scene& scene) {
  const std::string folder = (scene.folder / "").string();
  if (scene.folder.empty()) return sentence;
  for (std::size_t at = sentence.find(folder); at != std::string::npos; at = sentence.find(folder, at))
    sentence.erase(at, folder.size());
  return sentence;
}

namespace {
/// The paths of one kind. The path that counts where both could be the same file comes first.
std::vector<fs::path*> filesOfKind(Frame& frame, FrameFile kind) {
  switch (kind) {
    case FrameFile::Photograph: return {&frame.image, &frame.radiance};
    case FrameFile::Depth: return {&frame.depth};
    case FrameFile::Normals: return {&frame.normals};
    case FrameFile::Mask: return {&frame.mask};
  }
  return {};
}
}  // namespace

Scene withFilesIn(Scene scene, FrameFile kind, const fs::path& folder, int* found) {
  int count = 0;
  for (Frame& frame : scene.frames) {
    std::set<fs::path> taken;
    for (const FrameFile other : kFrameFiles)
      for (const fs::path* file : filesOfKind(frame, other))
        if (other != kind) taken.insert(*file);
    for (fs::path* file : filesOfKind(frame, kind)) {
      const fs::path now = sameUnder(folder, *file);
      if (now.empty() || !taken.insert(now).second) continue;
      *file = now;
      ++count;
    }
  }
  if (count > 0) {
    const FilesFolder entry{kind, fs::absolute(folder).lexically_normal()};
    std::erase(scene.folders, entry);
    scene.folders.push_back(entry);
  }
  if (found) *found = count;
  return scene;
}

Scene withFilesIn(Scene scene, const std::vector<FilesFolder>& folders) {
  for (const FilesFolder& f : folders) scene = withFilesIn(std::move(scene), f.kind, f.folder);
  scene.folders = folders;
  return scene;
}

std::set<FrameFile> ambiguousIn(const Scene& scene, const std::set<FrameFile>& kinds, const fs::path& folder) {
  std::set<FrameFile> ambiguous;
  for (Frame frame : scene.frames) {
    std::map<fs::path, FrameFile> found;
    for (const FrameFile kind : kinds)
      for (const fs::path* file : filesOfKind(frame, kind)) {
        const fs::path now = sameUnder(folder, *file);
        if (now.empty()) continue;
        const auto [first, isNew] = found.emplace(now, kind);
        if (!isNew && first->second != kind) ambiguous.insert({first->second, kind});
      }
  }
  return ambiguous;
}

}  // namespace glint
