// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/likely_mistakes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"

namespace glint {
namespace {

LikelyMistake images(const char* is, bool swapXY, bool flipX, bool flipY, const char* mogrify, int turned = 0) {
  LikelyMistake m{"the images", true, is, {}, {}, {}};
  m.undoing.swapXY = swapXY;
  m.undoing.flipX = flipX;
  m.undoing.flipY = flipY;
  m.remedy = std::string("Glint does not rewrite photographs: ImageMagick's mogrify ") + mogrify + " does";
  if (turned) m.correction = turnCamerasCorrection(turned);
  return m;
}

LikelyMistake turnedMesh(int axis, int degrees) {
  const char* names[] = {"x", "y", "z"};
  LikelyMistake m{"the mesh", false, formatted("turned by %d degrees about its %s axis", degrees, names[axis]), {}, {}, {}};
  if (axis == 0 && degrees != 180) m.is += " (y up against z up)";
  m.undoing.camerasFromMesh.rotation =
      Eigen::AngleAxisd(-degrees * EIGEN_PI / 180, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
  m.correction = meshSimilarityCorrection(m.undoing.camerasFromMesh);
  m.correction->words = formatted("Turn the mesh by %+d degrees about %s", -degrees, names[axis]);
  return m;
}

LikelyMistake scaledMesh(const std::string& is, double factor, const char* fix, const std::string& words) {
  LikelyMistake m{"the mesh", false, is, {}, {}, {}};
  m.undoing.camerasFromMesh.scale = factor;
  m.correction = meshSimilarityCorrection(m.undoing.camerasFromMesh);
  if (fix) m.correction->fix = fix;
  m.correction->words = words;
  return m;
}

LikelyMistake otherPoses(const GeometryCorrection& c) {
  LikelyMistake m{"the poses", true, c.inverse ? "camera to world" : "of OpenGL's axes, y up and z backwards", {}, {}, {}};
  if (c.inverse && c.turned) m.is += " with OpenGL's axes, y up and z backwards";
  m.undoing.poses = &c;
  m.correction = Correction{c.fix, c.words};
  return m;
}

LikelyMistake resizedImages(const char* is, double factor) {
  LikelyMistake m{"the images", true, is, {}, focalLengthCorrection(factor), {}};
  m.undoing.logFocal = std::log(factor);
  return m;
}

}  // namespace

Camera CameraChange::of(Camera camera) const {
  camera.pixelFromRay(0, 2) += cx;
  camera.pixelFromRay(1, 2) += cy;
  camera.pixelFromRay.topLeftCorner<2, 2>() *= std::exp(logFocal);
  if (poses) camera.camFromWorld = poses->camFromWorld(camera.camFromWorld);
  // A point m of the mesh is at R (s Q m + t) + r: the direction of R Q m + (R t + r) / s.
  const Similarity& s = camerasFromMesh;
  const Eigen::Isometry3d pose = camera.camFromWorld;
  camera.camFromWorld.linear() = pose.linear() * s.rotation;
  camera.camFromWorld.translation() = (pose.linear() * s.translation + pose.translation()) / s.scale;
  return camera;
}

void CameraChange::move(Highlight& h, const Camera& camera) const {
  const int width = swapXY ? camera.height : camera.width, height = swapXY ? camera.width : camera.height;
  const auto moved = [&](Pixel p) {
    if (swapXY) std::swap(p.x(), p.y());
    if (flipX) p.x() = width - 1 - p.x();
    if (flipY) p.y() = height - 1 - p.y();
    return p;
  };
  h.peak = moved(h.peak);
  for (Pixel& p : h.contour.points) p = moved(p);
  if ((flipX != flipY) != swapXY) std::reverse(h.contour.points.begin(), h.contour.points.end());
}

const std::vector<LikelyMistake>& likelyMistakes() {
  static const std::vector<LikelyMistake> all = [] {
    std::vector<LikelyMistake> list{images("mirrored left-right", false, true, false, "-flop"),
                                    images("mirrored upside down", false, false, true, "-flip"),
                                    images("turned by 180 degrees", false, true, true, "-rotate 180", 180)};
    for (const int axis : {0, 1, 2})
      for (const int degrees : {-90, 90, 180}) list.push_back(turnedMesh(axis, degrees));
    list.push_back(scaledMesh("in millimetres", 0.001, "mesh-mm", "Read the mesh in millimetres"));
    list.push_back(scaledMesh("in centimetres", 0.01, "mesh-cm", "Read the mesh in centimetres"));
    list.push_back(scaledMesh("in inches", 0.0254, nullptr, "Read the mesh in inches"));
    list.push_back(scaledMesh("in feet", 0.3048, nullptr, "Read the mesh in feet"));
    list.push_back(scaledMesh("in metres and the poses are in millimetres", 1000, "poses-mm", "Read the poses in millimetres"));
    list.push_back(scaledMesh("in metres and the poses are in centimetres", 100, nullptr, "Read the poses in centimetres"));
    list.push_back(scaledMesh("in metres and the poses are in inches", 1 / 0.0254, nullptr, "Read the poses in inches"));
    list.push_back(scaledMesh("in metres and the poses are in feet", 1 / 0.3048, nullptr, "Read the poses in feet"));
    list.push_back(scaledMesh("half as large as it should be", 2, nullptr, "Double the mesh"));
    list.push_back(scaledMesh("twice as large as it should be", 0.5, nullptr, "Halve the mesh"));
    for (const GeometryCorrection& c : geometryCorrections())
      if (c.inverse || c.turned) list.push_back(otherPoses(c));
    list.push_back(resizedImages("half as large as the calibrated ones", 1.0 / 2));
    list.push_back(resizedImages("a quarter as large as the calibrated ones", 1.0 / 4));
    list.push_back(resizedImages("an eighth as large as the calibrated ones", 1.0 / 8));
    list.push_back(images("turned by 90 degrees clockwise", true, false, true, "-rotate -90", 90));
    list.push_back(images("turned by 90 degrees counterclockwise", true, true, false, "-rotate 90", 270));
    for (LikelyMistake* m : {&list[list.size() - 2], &list[list.size() - 1]})
      m->remedy =
          "as by the rotation tag of a video or of a photograph, where poses and intrinsics are those of the stored pictures";
    return list;
  }();
  return all;
}

}  // namespace glint
