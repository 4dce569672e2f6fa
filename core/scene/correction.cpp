// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/correction.h"

#include <Eigen/Geometry>
#include <optional>

#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr std::string_view kPrincipalPoint = "principal-point", kFocalLength = "focal-length", kDepthScale = "depth-scale";

struct ValuedCorrection {
  std::string_view name;
  double least, most;  ///< of its value
  const char* unit;    ///< for messages
};

constexpr ValuedCorrection kValued[] = {
    {kPrincipalPoint, -10, 10, "px, added to cx and cy"},  // more is no other origin of pixels but another image
    {kFocalLength, 0.1, 10, "a factor of fx and fy"},      // beyond that it is another camera
    {kDepthScale, 1e-9, 1e9, "metres per unit of depth"},  // as scene files: more is a typing error
};

std::string valued(std::string_view name, double value) { return std::string(name) + "=" + formatted("%.10g", value); }

/// The measured places of given highlights stay where they are while the lens or K changes.
void takeIntrinsics(Frame& frame, const Eigen::Matrix3d& pixelFromRay) {
  Camera changed = frame.camera;
  changed.pixelFromRay = pixelFromRay;
  const auto moved = [&](const Pixel& ideal) { return Pixel(changed.undistorted(frame.camera.distorted(ideal))); };
  if (frame.camera.hasDistortion())
    for (Highlight& h : frame.highlights) {
      h.peak = moved(h.peak);
      for (Pixel& p : h.contour.points) p = moved(p);
    }
  frame.camera = changed;
}

void applyGeometry(Scene& scene, const GeometryCorrection& c) {
  for (Frame& f : scene.frames) f.camera.camFromWorld = c.camFromWorld(f.camera.camFromWorld);
  if (c.meshScale == 1) return;
  bool any = false;
  for (auto& [id, source] : scene.surfaces) {
    if (!source.mesh) continue;
    source.metresPerUnit *= c.meshScale;
    any = true;
  }
  if (!any) throw InputError("--fix", c.fix, "the scene has no mesh");
}

void applyValue(Scene& scene, std::string_view name, double value) {
  bool any = false;
  for (Frame& f : scene.frames) {
    Eigen::Matrix3d k = f.camera.pixelFromRay;
    if (name == kPrincipalPoint) k(0, 2) += value, k(1, 2) += value;
    if (name == kFocalLength) k(0, 0) *= value, k(1, 1) *= value, k(0, 1) *= value;
    if (name == kDepthScale && f.depthScale > 0) f.depthScale = value, any = true;
    if (k != f.camera.pixelFromRay) takeIntrinsics(f, k);
  }
  if (name == kDepthScale && !any) throw InputError("--fix", std::string(name), "no frame has an integer depth map");
}

}  // namespace

Eigen::Isometry3d GeometryCorrection::camFromWorld(const Eigen::Isometry3d& asRead) const {
  const Eigen::Isometry3d turn(Eigen::AngleAxisd(EIGEN_PI, Eigen::Vector3d::UnitX()));
  // Stored as camera to world, y up: turn * stored^-1; stored as world to camera, y up: turn * stored.
  Eigen::Isometry3d pose = inverse ? asRead.inverse() : asRead;
  if (turned) pose = turn * pose;
  pose.translation() *= poseScale;
  return pose;
}

const std::vector<GeometryCorrection>& geometryCorrections() {
  static const std::vector<GeometryCorrection> all{
      {"invert-poses", "Invert the poses", 1, 1, true, false},
      {"turn-axes", "Turn the camera's y and z axes", 1, 1, false, true},
      {"invert-poses-and-turn-axes", "Invert the poses and turn the y and z axes", 1, 1, true, true},
      {"mesh-mm", "Read the mesh in millimetres", 0.001, 1, false, false},
      {"mesh-cm", "Read the mesh in centimetres", 0.01, 1, false, false},
      {"poses-mm", "Read the poses in millimetres", 1, 0.001, false, false},
  };
  return all;
}

Correction principalPointCorrection(double px) {
  return {valued(kPrincipalPoint, px), formatted("Add %+.1f px to cx and cy", px)};
}

Correction focalLengthCorrection(double factor) {
  return {valued(kFocalLength, factor), formatted("Multiply the focal length by %.4g", factor)};
}

Correction depthScaleCorrection(double metresPerUnit) {
  return {valued(kDepthScale, metresPerUnit), formatted("Set depth_scale to %.4g", metresPerUnit)};
}

Scene corrected(Scene scene, std::string_view fix) {
  for (const GeometryCorrection& c : geometryCorrections())
    if (fix == c.fix) {
      applyGeometry(scene, c);
      return scene;
    }
  const std::size_t equals = fix.find('=');
  for (const ValuedCorrection& c : kValued) {
    if (fix.substr(0, equals) != c.name) continue;
    const std::optional<double> value = equals == std::string_view::npos ? std::nullopt : numberFrom(fix.substr(equals + 1));
    if (!value || !(*value >= c.least && *value <= c.most))
      throw InputError(
          "--fix", std::string(fix),
          formatted("expected %s=VALUE with VALUE from %g to %g (%s)", std::string(c.name).c_str(), c.least, c.most, c.unit));
    applyValue(scene, c.name, *value);
    return scene;
  }
  throw InputError("--fix", std::string(fix), "there is no such correction; there are: " + correctionNames());
}

std::string correctionNames() {
  std::string names;
  for (const GeometryCorrection& c : geometryCorrections()) names += std::string(c.fix) + ", ";
  for (const ValuedCorrection& c : kValued) names += std::string(c.name) + "=VALUE" + (&c == std::end(kValued) - 1 ? "" : ", ");
  return names;
}

}  // namespace glint
