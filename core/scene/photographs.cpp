// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/photographs.h"

#include <set>
#include <vector>

#include "core/scene/relinked.h"

namespace glint {
namespace fs = std::filesystem;

std::vector<fs::path> filesOf(const Scene& scene) {
  std::vector<fs::path> paths{fs::absolute(scene.file).lexically_normal()};
  std::set<fs::path> seen(paths.begin(), paths.end());
  const auto add = [&](const fs::path& p) {
    if (!p.empty() && seen.insert(p).second) paths.push_back(p);
  };
  for (const auto& [id, source] : scene.surfaces)
    if (source.mesh) add(*source.mesh);
  for (const Frame& f : scene.frames)
    for (const fs::path* p : {&f.image, &f.radiance, &f.depth, &f.normals, &f.mask}) add(*p);
  return paths;
}

std::map<int, std::string> photographProblems(const Scene& scene, const std::map<int, std::string>& known,
                                              const ProgressFn& progress) {
  std::map<int, std::string> problems;
  const int n = static_cast<int>(scene.frames.size());
  for (int i = 0; i < n; ++i) {
    if (!report(progress, {"photographs", i, n})) throw Stopped{};
    if (known.count(i)) continue;
    if (std::string problem = photographProblem(scene.frames[static_cast<std::size_t>(i)]); !problem.empty())
      problems[i] = std::move(problem);
  }
  return problems;
}

std::string withoutFolder(std::string sentence, const Scene& scene) {
  const std::string folder = (scene.folder / "").string();
  if (scene.folder.empty()) return sentence;
  for (std::size_t at = sentence.find(folder); at != std::string::npos; at = sentence.find(folder, at))
    sentence.erase(at, folder.size());
  return sentence;
}

Scene withPhotographsIn(Scene scene, const fs::path& folder, int* found) {
  int count = 0;
  for (Frame& frame : scene.frames) {
    const fs::path image = sameUnder(folder, frame.image), radiance = sameUnder(folder, frame.radiance);
    if (!image.empty()) {
      frame.image = image;
      ++count;
    }
    if (!radiance.empty() && radiance != image) {
      frame.radiance = radiance;
      ++count;
    }
  }
  if (count > 0) scene.photographs = fs::absolute(folder).lexically_normal();
  if (found) *found = count;
  return scene;
}

}  // namespace glint
