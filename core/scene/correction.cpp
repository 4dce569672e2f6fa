// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/correction.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/number_text.h"
#include "core/scene/image_scale.h"

namespace glint {
namespace {

constexpr const char* kMeshSimilarity = "mesh-similarity";
constexpr const char* kSimilarityForm =
    "expected mesh-similarity=S,RX,RY,RZ,TX,TY,TZ (from the mesh to the cameras' world: scale, rotation vector in radians, shift "
    "in metres)";

constexpr std::string_view kPrincipalPoint = "principal-point", kFocalLength = "focal-length", kDepthScale = "depth-scale",
                           kImageScale = "image-scale", kCameraScale = "camera-scale", kTurnCameras = "turn-cameras";

struct ValuedCorrection {
  std::string_view name;
  double least, most;  ///< of its value
  const char* unit;    ///< for messages
};

constexpr ValuedCorrection kValued[] = {
    {kPrincipalPoint, -10, 10, "px, added to cx and cy"},  // more than that is another image, not another origin of pixels
    {kFocalLength, 0.1, 10, "a factor of fx and fy"},      // beyond that it is another camera
    {kDepthScale, 1e-9, 1e9, "metres per unit of depth"},  // as scene files: more is a typing error
    {kCameraScale, 1.0 / 64, 64, "a factor of fx, fy and of the principal point's distance from the image's corner"},
    {kImageScale, 1.0 / 64, 64, "the size of the photographs in sizes of the cameras' images"},
    {kTurnCameras, 90, 270, "90, 180 or 270 degrees clockwise, as the photographs are turned"},
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
  for (auto& [id, source] : scene.surfaces)
    if (SurfaceFile* const f = source.file()) f->metresPerUnit *= c.meshScale, any = true;
  if (!any) throw InputError("--fix", c.fix, "the scene has no mesh");
}

/// The lens seen in turned pictures: radial terms stay, the tangential one is a vector of the image plane and turns.
Lens turned(const Frame& f, const Eigen::Matrix2d& turn) {
  Lens lens = f.camera.lens;
  if (lens.isIdeal()) return lens;
  const bool brown = lens.model == LensModel::OpenCv || lens.model == LensModel::FullOpenCv;
  if (!brown && lens.model == LensModel::ThinPrismFisheye)
    throw InputError("--fix", std::string(kTurnCameras),
                     "frame " + f.id + " has a lens of the model THIN_PRISM_FISHEYE, which cannot be turned");
  if (brown) {
    const Eigen::Vector2d bends = turn * Eigen::Vector2d(lens.parameters[3], lens.parameters[2]);  // p2 along x, p1 along y
    lens.parameters[3] = bends.x();
    lens.parameters[2] = bends.y();
  }
  return lens;
}

/// Cameras of the stored pictures become those of the pictures as they are shown, turned clockwise by `degrees`; their size is
/// that of the shown ones.
void turnCameras(Scene& scene, double degrees) {
  const auto refuse = [](const std::string& why) { throw InputError("--fix", std::string(kTurnCameras), why); };
  if (degrees != 90 && degrees != 180 && degrees != 270) refuse("expected 90, 180 or 270 degrees");
  const int quarters = static_cast<int>(degrees) / 90;
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity(), quarter;
  quarter << 0, -1, 1, 0;
  for (int i = 0; i < quarters; ++i) turn = quarter * turn;
  for (Frame& f : scene.frames) {
    if (!f.normals.empty() || !f.depth.empty())
      refuse("frame " + f.id + " has a map of depth or normals, which would have to turn, too");
    if (f.camera.pixelFromRay(0, 1) != 0) refuse("the camera of frame " + f.id + " has a skew");
    Camera changed = f.camera;
    changed.lens = turned(f, turn);
    Eigen::Matrix3d& k = changed.pixelFromRay;
    if (quarters != 2) std::swap(k(0, 0), k(1, 1));
    // The middle of the first pixel is 0, that of the last one is width - 1: the turn is about the middle between them.
    const Eigen::Vector2d shown(f.camera.width - 1, f.camera.height - 1),
        stored = quarters == 2 ? shown : Eigen::Vector2d(shown.reverse());
    k.topRightCorner<2, 1>() = shown / 2 + turn * (f.camera.pixelFromRay.topRightCorner<2, 1>() - stored / 2);
    Eigen::Matrix3d about = Eigen::Matrix3d::Identity();
    about.topLeftCorner<2, 2>() = turn;
    changed.camFromWorld.linear() = about * f.camera.camFromWorld.linear();
    changed.camFromWorld.translation() = about * f.camera.camFromWorld.translation();
    const auto moved = [&](const Pixel& ideal) { return Pixel(changed.undistorted(f.camera.distorted(ideal))); };
    if (f.camera.hasDistortion())
      for (Highlight& h : f.highlights) {
        h.peak = moved(h.peak);
        for (Pixel& p : h.contour.points) p = moved(p);
      }
    f.camera = changed;
  }
}

void applyValue(Scene& scene, std::string_view name, double value) {
  if (name == kTurnCameras) return turnCameras(scene, value);
  if (name == kImageScale) return applyImageScale(scene, value);
  bool any = false;
  for (Frame& f : scene.frames) {
    Eigen::Matrix3d k = f.camera.pixelFromRay;
    if (name == kPrincipalPoint) k(0, 2) += value, k(1, 2) += value;
    if (name == kFocalLength) k(0, 0) *= value, k(1, 1) *= value, k(0, 1) *= value;
    if (name == kCameraScale) {
      k.topRows<2>() *= value;
      k(0, 2) += 0.5 * (value - 1);  // (0, 0) is the centre of the first pixel
      k(1, 2) += 0.5 * (value - 1);
    }
    if (name == kDepthScale && f.depthScale > 0) f.depthScale = value, any = true;
    if (k != f.camera.pixelFromRay) takeIntrinsics(f, k);
  }
  if (name == kDepthScale && !any) throw InputError("--fix", std::string(name), "no frame has an integer depth map");
}

Similarity similarityFrom(std::string_view fix) {
  const std::string whole(fix);
  constexpr double kMostScale = 1e9, kMostShift = 1e12;  // as scene files: more is a typing error
  std::array<double, 7> v{};
  std::size_t from = std::min(fix.find('='), fix.size() - 1) + 1;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t comma = fix.find(',', from);
    if ((comma == std::string_view::npos) != (i + 1 == v.size())) throw InputError("--fix", whole, kSimilarityForm);
    const std::optional<double> value = numberFrom(fix.substr(from, comma == std::string_view::npos ? comma : comma - from));
    if (!value || !(std::abs(*value) <= kMostShift)) throw InputError("--fix", whole, kSimilarityForm);
    v[i] = *value;
    from = comma + 1;
  }
  if (!(v[0] >= 1 / kMostScale && v[0] <= kMostScale)) throw InputError("--fix", whole, "the scale is out of range");
  const Eigen::Vector3d turn(v[1], v[2], v[3]);
  if (!(turn.norm() <= 2 * EIGEN_PI)) throw InputError("--fix", whole, "the rotation is more than one turn (radians)");
  Similarity s{v[0], Eigen::Matrix3d::Identity(), {v[4], v[5], v[6]}};
  if (turn.norm() > 0) s.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return s;
}

void moveIntoMeshFrame(Frame& f, const Similarity& s) {
  const Eigen::Isometry3d& pose = f.camera.camFromWorld;
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  moved.linear() = Eigen::Quaterniond(Eigen::Matrix3d(pose.linear() * s.rotation)).normalized().toRotationMatrix();
  moved.translation() = (pose.linear() * s.translation + pose.translation()) / s.scale;
  f.camera.camFromWorld = moved;
  f.depthScale /= s.scale;
  if (f.depthCamera) f.depthCamera->camFromWorld.translation() /= s.scale;
}

/// The world becomes that of the mesh, in its unit: x_camera = R (s Q m + t) + r has the direction of R Q m + (R t + r) / s.
void applySimilarity(Scene& scene, std::string_view fix) {
  const Similarity s = similarityFrom(fix), back = s.inverse();
  const auto refuse = [&](const std::string& why) { throw InputError("--fix", kMeshSimilarity, why); };
  if (scene.surfaces.size() != 1)
    refuse(formatted("the scene has %zu surfaces; it moves the cameras to a single one", scene.surfaces.size()));
  const SurfaceSource& surface = scene.surfaces.begin()->second;
  if (!surface.file() || std::get_if<CapturePoints>(&surface)) refuse("the surface is no mesh of its own file");
  for (Frame& f : scene.frames) {
    if (!standsStill(f)) refuse("frame " + f.id + " has an object that moves (world_from_object)");
    if (!f.normals.empty()) refuse("frame " + f.id + " has a map of normals, which would have to turn, too");
    if (!f.depth.empty() && !(f.depthScale > 0))
      refuse("frame " + f.id + " has a depth map in floating point, in the unit of the cameras");
    moveIntoMeshFrame(f, s);
  }
  for (TrueLight& light : scene.lights) {
    const bool inWorld = light.frame == LightFrame::World;
    light.lamp = transformed(light.lamp, back.scale, inWorld ? back.rotation : Eigen::Matrix3d::Identity(),
                             inWorld ? back.translation : Eigen::Vector3d::Zero());
  }
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

Correction turnCamerasCorrection(int degrees) {
  return {valued(kTurnCameras, degrees), formatted("Turn the cameras by %d degrees, as the photographs are", degrees)};
}

Correction meshSimilarityCorrection(const Similarity& s) {
  const Eigen::AngleAxisd turn(s.rotation);
  const Eigen::Vector3d r = turn.angle() * turn.axis(), &t = s.translation;
  std::string value = std::string(kMeshSimilarity) + "=";
  for (const double v : {s.scale, r.x(), r.y(), r.z(), t.x(), t.y(), t.z()})
    value += (value.back() == '=' ? "" : ",") + formatted("%.12g", v);
  return {value, "Move the cameras into the frame of the mesh"};
}

Scene corrected(Scene scene, std::string_view fix) {
  for (const GeometryCorrection& c : geometryCorrections())
    if (fix == c.fix) {
      applyGeometry(scene, c);
      return scene;
    }
  if (fix == "mirror-photographs")
    throw InputError(
        "--fix", std::string(fix),
        "Glint does not rewrite photographs: mirror the image files themselves, for example by ImageMagick's mogrify "
        "-flop (left-right), -flip (upside down) or -rotate 180, and give their folder by --photographs");
  const std::size_t equals = fix.find('=');
  if (fix.substr(0, equals) == kMeshSimilarity) {
    applySimilarity(scene, fix);
    return scene;
  }
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
  for (const ValuedCorrection& c : kValued) names += std::string(c.name) + "=VALUE, ";
  return names + kMeshSimilarity + "=S,RX,RY,RZ,TX,TY,TZ, flip-faces";
}

}  // namespace glint
