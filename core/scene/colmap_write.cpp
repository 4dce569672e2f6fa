// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <map>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/number_text.h"
#include "core/scene/capture.h"
#include "core/scene/colmap_parts.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

using capture::kFromCorner;

/// What a camera is in COLMAP: the name of a model, and the parameters behind the principal point.
struct ColmapLens {
  std::string model;
  bool oneFocalLength = false;
  std::vector<double> parameters;
};

/// The same lens with as many parameters as another model of its family has, the further ones 0.
std::vector<double> colmapFirst(const Lens& lens, int count) {
  return {lens.parameters.begin(), lens.parameters.begin() + count};
}

ColmapLens colmapLensOf(const Camera& camera, const std::string& folder, const std::string& name) {
  const Lens& lens = camera.lens;
  const std::array<double, 8>& p = lens.parameters;
  const bool oneFocalLength = camera.pixelFromRay(0, 0) == camera.pixelFromRay(1, 1);
  constexpr int kOpenCv = 4, kFisheye = 4, kFullOpenCv = 8;
  if (lens.isIdeal()) return {"PINHOLE", false, {}};
  switch (lens.model) {
    case LensModel::OpenCv:
      return p[4] == 0 ? ColmapLens{"OPENCV", false, colmapFirst(lens, kOpenCv)}  // COLMAP's has no k3
                       : ColmapLens{"FULL_OPENCV", false, colmapFirst(lens, kFullOpenCv)};
    case LensModel::SimpleRadial:
    case LensModel::Radial:  // COLMAP's have one focal length; k1 and k2 begin OPENCV as well
      return oneFocalLength ? ColmapLens{nameOf(lens.model), true, colmapFirst(lens, parameterCountOf(lens.model))}
                            : ColmapLens{"OPENCV", false, colmapFirst(lens, kOpenCv)};
    case LensModel::SimpleRadialFisheye:
    case LensModel::RadialFisheye:
      return oneFocalLength ? ColmapLens{nameOf(lens.model), true, colmapFirst(lens, parameterCountOf(lens.model))}
                            : ColmapLens{"OPENCV_FISHEYE", false, colmapFirst(lens, kFisheye)};
    case LensModel::FullOpenCv:
    case LensModel::OpenCvFisheye:
    case LensModel::Fov:
    case LensModel::ThinPrismFisheye: return {nameOf(lens.model), false, colmapFirst(lens, parameterCountOf(lens.model))};
    case LensModel::VisualSfm: break;
  }
  throw InputError(folder, name, "COLMAP has no lens as VISUALSFM's");
}

/// MODEL, WIDTH, HEIGHT, PARAMS
std::string colmapCameraText(const Camera& camera, const std::string& folder, const std::string& name) {
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  require(camera.width > 0 && camera.height > 0, "writeColmapText: a camera without a size");
  if (k(0, 1) != 0) throw InputError(folder, name, formatted("COLMAP has no camera with skew (%.4g px)", k(0, 1)));
  const ColmapLens lens = colmapLensOf(camera, folder, name);
  std::string text = formatted("%s %d %d %.17g", lens.model.c_str(), camera.width, camera.height, k(0, 0));
  if (!lens.oneFocalLength) text += formatted(" %.17g", k(1, 1));
  text += formatted(" %.17g %.17g", k(0, 2) - kFromCorner, k(1, 2) - kFromCorner);
  for (const double p : lens.parameters) text += formatted(" %.17g", p);
  return text;
}

std::string colmapPoseText(const Eigen::Isometry3d& pose) {
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const Eigen::Vector3d t = pose.translation();
  return formatted("%.17g %.17g %.17g %.17g %.17g %.17g %.17g", q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z());
}

/// Files that would be read instead of the text, or with it.
void refuseOtherModel(const fs::path& folder) {
  std::error_code ignored;  // unreadable counts as missing
  for (const char* file : {"cameras.bin", "images.bin", "points3D.bin", "rigs.bin", "frames.bin", "rigs.txt", "frames.txt"})
    if (fs::exists(folder / file, ignored))
      throw InputError(
          folder.string(), "",
          std::string("contains ") + file + " of another model, which would be read with this one; choose another folder");
}

}  // namespace

void writeColmapText(const std::vector<PosedImage>& images, const fs::path& folder) {
  refuseOtherModel(folder);
  std::map<std::string, std::size_t> numbers;  // of cameras, by their text
  std::set<std::string> names;
  std::string cameraLines, imageLines;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const PosedImage& image = images[i];
    const std::string name = capture::colmap::checkedName(image.name, folder.string(), "image " + std::to_string(i + 1));
    if (name.find(' ') != std::string::npos)  // "photo 1.jpg" and "photo 2.jpg" would both become "photo"
      throw InputError(folder.string(), name, "COLMAP ends the name of an image at its first blank; rename the file");
    if (!names.insert(name).second) throw InputError(folder.string(), name, "two images have this name");
    const std::string text = colmapCameraText(image.camera, folder.string(), name);
    const auto [camera, isNew] = numbers.emplace(text, numbers.size() + 1);
    if (isNew) cameraLines += std::to_string(camera->second) + " " + text + "\n";
    imageLines += std::to_string(i + 1) + " " + colmapPoseText(image.camera.camFromWorld) + " " + std::to_string(camera->second) +
                  " " + name + "\n\n";  // the second line holds its 2D points: none
  }
  atomicFiles(folder, "cameras.txt", [&](const fs::path& temporary) {
    atomicWrite(temporary / "cameras.txt", "# Cameras: CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n" + cameraLines);
    atomicWrite(temporary / "images.txt",
                "# Images, two lines each: IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
                "#   POINTS2D[] as (X, Y, POINT3D_ID)\n" +
                    imageLines);
    atomicWrite(temporary / "points3D.txt",
                "# Points: POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n");
  });
}

}  // namespace glint
