// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/scene/capture.h"
#include "core/scene/capture_parts.h"

namespace glint {
using json_dom::Json;

namespace {

/// The terms of a lens under nerfstudio's names, in the order of our parameters; empty for a lens that it does not have.
/// https://docs.nerf.studio/quickstart/data_conventions.html; k3 of OPENCV is a part of its polynomial as well.
std::vector<std::string> nerfTermsOf(LensModel model) {
  switch (model) {
    case LensModel::OpenCv: return {"k1", "k2", "p1", "p2", "k3"};
    case LensModel::SimpleRadial: return {"k1"};
    case LensModel::Radial: return {std::string("k1"), "k2"};
    case LensModel::OpenCvFisheye: return {"k1", "k2", "k3", "k4"};
    default: return {};
  }
}

/// nerfstudio has one camera_model for all images. A radial lens is an OPENCV one without the other terms.
LensModel nerfModelForAll(const std::vector<PosedImage>& images, const std::string& file) {
  const LensModel first = images.front().camera.lens.model;
  LensModel all = first;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const LensModel model = images[i].camera.lens.model;
    const std::string place = "frames[" + std::to_string(i) + "]";
    if (nerfTermsOf(model).empty())
      throw InputError(file, place, "'" + images[i].name + "' has a lens that nerfstudio does not have: " + nameOf(model));
    if (model == first) continue;
    if (model == LensModel::OpenCvFisheye || first == LensModel::OpenCvFisheye)
      throw InputError(file, place,
                       "'" + images[i].name + "' has a lens " + nameOf(model) + ", others " + nameOf(first) +
                           ": nerfstudio takes one camera model for all images");
    all = LensModel::OpenCv;
  }
  return all;
}

bool sameNerfIntrinsics(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.pixelFromRay == b.pixelFromRay && a.lens == b.lens;
}

/// Puts the intrinsics of one camera into `target`, with the terms that the model of all has.
void appendNerfIntrinsics(const Camera& camera, LensModel all, Json& target) {
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  json_dom::append(target, "w", camera.width);
  json_dom::append(target, "h", camera.height);
  json_dom::append(target, "fl_x", k(0, 0));
  json_dom::append(target, "fl_y", k(1, 1));
  json_dom::append(target, "cx", k(0, 2) - capture::kFromCorner);
  json_dom::append(target, "cy", k(1, 2) - capture::kFromCorner);
  const std::vector<std::string> own = nerfTermsOf(camera.lens.model);
  for (const std::string& term : nerfTermsOf(all)) {
    const auto at = std::find(own.begin(), own.end(), term);
    json_dom::append(target, term, at == own.end() ? 0.0 : camera.lens.parameters[std::size_t(at - own.begin())]);
  }
}

/// Camera to world, y up, looking along -z.
Json nerfMatrixOf(const Camera& camera) {
  Eigen::Matrix4d worldFromCam = camera.camFromWorld.inverse().matrix();
  worldFromCam.col(1) *= -1;
  worldFromCam.col(2) *= -1;
  worldFromCam.array() += 0.0;  // -0 is 0
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({worldFromCam(i, 0), worldFromCam(i, 1), worldFromCam(i, 2), worldFromCam(i, 3)});
  return rows;
}

void checkNerfImage(const PosedImage& image, const std::string& file, const std::string& place) {
  require(image.camera.pixelFromRay.allFinite() && image.camera.camFromWorld.matrix().allFinite(),
          "writeTransforms: a camera is not finite");
  if (image.name.empty()) throw InputError(file, place, "has no name");
  if (image.camera.pixelFromRay(0, 1) != 0)
    throw InputError(file, place, "'" + image.name + "' has skew, which nerfstudio does not have");
}

}  // namespace

void writeTransforms(const std::vector<PosedImage>& images, const std::filesystem::path& file, const std::string& points) {
  require(!images.empty(), "writeTransforms: no images");
  const std::string target = file.string();
  for (std::size_t i = 0; i < images.size(); ++i) checkNerfImage(images[i], target, "frames[" + std::to_string(i) + "]");
  const LensModel all = nerfModelForAll(images, target);
  const Camera& first = images.front().camera;
  const bool shared =
      std::all_of(images.begin(), images.end(), [&](const PosedImage& i) { return sameNerfIntrinsics(i.camera, first); });
  Json root = {{"camera_model", nameOf(all)}};
  if (shared) appendNerfIntrinsics(first, all, root);
  if (!points.empty()) json_dom::append(root, "ply_file_path", points);
  Json frames = Json::array();
  for (const PosedImage& image : images) {
    Json frame = {{"file_path", image.name}};
    if (!shared) appendNerfIntrinsics(image.camera, all, frame);
    json_dom::append(frame, "transform_matrix", nerfMatrixOf(image.camera));
    if (!image.depth.empty()) json_dom::append(frame, "depth_file_path", image.depth);
    if (!image.mask.empty()) json_dom::append(frame, "mask_path", image.mask);
    frames.push_back(std::move(frame));
  }
  json_dom::append(root, "frames", std::move(frames));
  atomicWrite(file, json_dom::prettyWithPaths(root, target));
}

}  // namespace glint
