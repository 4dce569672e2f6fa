// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/scene/capture.h"
#include "core/scene/outputs.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

/// "" where the path leaves the folder.
std::string below(const fs::path& file, const fs::path& folder) {
  const fs::path relative = fs::absolute(file).lexically_normal().lexically_relative(folder);
  return relative.empty() || *relative.begin() == ".." ? "" : relative.generic_string();
}

void requireNew(const fs::path& file) {
  std::error_code ignored;  // a path that cannot be looked at cannot be written either
  if (fs::exists(file, ignored))
    throw InputError(file.string(), "--out", "already exists; nothing is overwritten: choose another place or remove this file");
}

/// What neither format holds.
std::vector<std::string> leftOutOf(const Scene& scene) {
  std::vector<std::string> lines;
  for (const auto& [id, source] : scene.surfaces)
    lines.push_back(
        "surface '" + id + "' is left out: " +
        (source.file() ? "name it by --surface " + source.file()->file.string() : "only meshes can be named by --surface"));
  const auto count = [&](const auto& has) { return std::count_if(scene.frames.begin(), scene.frames.end(), has); };
  const auto say = [&](long n, const std::string& what) {
    if (n > 0) lines.push_back(what + " of " + std::to_string(n) + " frames are left out");
  };
  say(count([](const Frame& f) { return !f.highlights.empty(); }), "highlights");
  say(count([](const Frame& f) { return !f.radiance.empty(); }), "radiance images");
  say(count([](const Frame& f) { return !f.normals.empty(); }), "normal maps");
  if (const long n = count([](const Frame& f) { return !f.response.text().empty(); }))
    lines.push_back("the camera response of " + std::to_string(n) + " frames is left out: name it by --response");
  if (const long n = count([](const Frame& f) { return !standsStill(f); }))
    lines.push_back("the object moves in " + std::to_string(n) + " frames: the cameras are written as it sees them");
  if (!scene.lights.empty()) lines.push_back(std::to_string(scene.lights.size()) + " lights are left out");
  return lines;
}

/// The cameras as the object sees them: other programs know no motion.
Scene asTheObjectSeesIt(const Scene& scene) { return standsStill(scene) ? scene : inObject(scene); }

/// The photograph, else the radiance image. Other programs cannot read a picture of a video as a file.
fs::path pictureOf(const Frame& frame) {
  if (frame.ofVideo) return {};
  return frame.image.empty() ? frame.radiance : frame.image;
}

std::string pathFrom(const fs::path& file, const fs::path& folder) {
  return file.empty() ? "" : fs::absolute(file).lexically_normal().lexically_relative(folder).generic_string();
}

}  // namespace

Exported transformsOf(const Scene& given, const fs::path& file) {
  const Scene scene = asTheObjectSeesIt(given);
  const fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  Exported exported;
  exported.leftOut = leftOutOf(given);
  constexpr double kMillimetre = 0.001;
  std::vector<PosedImage> images;
  int otherDepth = 0, outside = 0, unnamed = 0;
  for (const Frame& frame : scene.frames) {
    PosedImage image{pathFrom(pictureOf(frame), folder), frame.camera, "", pathFrom(frame.mask, folder)};
    unnamed += image.name.empty();
    if (image.name.empty()) image.name = frame.id + ".png";
    outside += !image.name.empty() && image.name.starts_with("..");
    if (frame.depthScale == kMillimetre && !frame.depthCamera)
      image.depth = pathFrom(frame.depth, folder);
    else
      otherDepth += !frame.depth.empty();
    images.push_back(std::move(image));
  }
  if (otherDepth)
    exported.leftOut.push_back(std::to_string(otherDepth) +
                               " depth maps are left out: nerfstudio reads millimetres of the frame's own camera");
  if (outside) exported.leftOut.push_back(std::to_string(outside) + " images lie outside of " + folder.string());
  if (unnamed) exported.leftOut.push_back(std::to_string(unnamed) + " frames have no image; FRAME.png is written instead");
  exported.write = [images = std::move(images), file] {
    requireNew(file);
    writeTransforms(images, file);
  };
  return exported;
}

Exported colmapOf(const Scene& given, const fs::path& folder) {
  const Scene scene = asTheObjectSeesIt(given);
  const fs::path own = fs::absolute(folder / "cameras.txt").lexically_normal();
  const std::vector<fs::path> others = foldersOfCapture(own);
  const fs::path root = others.empty() ? own.parent_path() : others.front();
  Exported exported;
  exported.leftOut = leftOutOf(given);
  const auto allBelow = [&](const fs::path& place) {
    return std::all_of(scene.frames.begin(), scene.frames.end(),
                       [&](const Frame& f) { return pictureOf(f).empty() || !below(pictureOf(f), place).empty(); });
  };
  const fs::path images = root / "images";
  const bool inImages = allBelow(images), inRoot = inImages || allBelow(root);
  const fs::path base = inImages ? images : inRoot ? root : scene.folder;
  if (!inRoot)
    exported.leftOut.push_back("the images lie outside of " + root.string() + ": name their folder by --photographs " +
                               base.string());
  std::vector<PosedImage> posed;
  int unnamed = 0, depth = 0;
  for (const Frame& frame : scene.frames) {
    const fs::path& picture = pictureOf(frame);
    unnamed += picture.empty();
    depth += !frame.depth.empty() || !frame.mask.empty();
    posed.push_back({picture.empty() ? frame.id + ".png" : pathFrom(picture, base), frame.camera, "", ""});
  }
  if (unnamed) exported.leftOut.push_back(std::to_string(unnamed) + " frames have no image; FRAME.png is written instead");
  if (depth) exported.leftOut.push_back("depth maps and masks of " + std::to_string(depth) + " frames are left out");
  exported.write = [posed = std::move(posed), folder] {
    for (const char* name : {"cameras.txt", "images.txt", "points3D.txt", "cameras.bin", "images.bin", "points3D.bin"})
      requireNew(folder / name);
    writeColmapText(posed, folder);
  };
  return exported;
}

}  // namespace glint
