// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/json_text.h"
#include "core/base/limits.h"
#include "core/base/number_text.h"
#include "core/reflectance/added_lobe.h"
#include "core/scene/scene_json.h"
#include "core/scene/scene_reader.h"
#include "core/synth/synth.h"

namespace glint {
namespace {

std::string shown(double v) { return formatted("%.6g", v); }

double inRange(const JsonNode& node, double low, double high) {
  const double v = node.number();
  if (!(v >= low && v <= high)) node.fail("must be in " + shown(low) + " .. " + shown(high));
  return v;
}

int countOf(const JsonNode& node, int low, int high) {
  const int v = node.integer();
  if (v < low || v > high) node.fail("must be in " + std::to_string(low) + " .. " + std::to_string(high));
  return v;
}

std::string padded(std::size_t i) { return formatted("%04zu", i); }

/// Pose of a camera at `eye` that looks at `target`, image up along world +z.
Eigen::Isometry3d lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const JsonNode& node) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  if (!(right.norm() > 1e-9))  // rad from the vertical
    node.fail("looks straight up or down: world +z cannot be up in the image");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().row(0) = right.normalized();
  pose.linear().row(1) = forward.cross(right.normalized());
  pose.linear().row(2) = forward;
  pose.translation() = -pose.linear() * eye;
  return pose;
}

std::vector<Eigen::Isometry3d> readPath(const JsonNode& node) {
  std::vector<Eigen::Isometry3d> poses;
  if (const auto list = node.find("cameras")) {
    for (std::size_t i = 0; i < list->size(); ++i) poses.push_back(readPoseJson(list->at(i)));
  } else {
    const JsonNode orbit = node.at("orbit");
    const Eigen::Vector3d centre = lengths3(orbit.at("centre"));
    const double radius = inRange(orbit.at("radius"), 1e-9, 1e9), height = bounded(orbit.at("height"), kFarthest);
    const double from = bounded(orbit.at("from"), kLargestFactor), to = bounded(orbit.at("to"), kLargestFactor);
    const int count = countOf(orbit.at("count"), 1, 100000);
    for (int i = 0; i < count; ++i) {
      const double a = count == 1 ? from : from + (to - from) * i / (count - 1);
      poses.push_back(lookAt(centre + Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), height), centre, orbit));
    }
  }
  if (poses.empty()) node.fail("has no camera");
  return poses;
}

/// Where the object stands in each frame: {"poses": [4x4, ...]} or {"turn": {"axis", "through", "from", "to", "count"}}, rad.
std::vector<Eigen::Isometry3d> readMotion(const JsonNode& node) {
  std::vector<Eigen::Isometry3d> poses;
  if (const auto list = node.find("poses")) {
    for (std::size_t i = 0; i < list->size(); ++i) poses.push_back(readPoseJson(list->at(i)));
    if (poses.empty()) list->fail("is empty");
    return poses;
  }
  const JsonNode turn = node.at("turn");
  const Eigen::Vector3d axis = lengths3(turn.at("axis")), through = lengths3(turn.at("through"));
  if (!(axis.norm() > 0)) turn.at("axis").fail("must not be zero");
  const double from = bounded(turn.at("from"), kLargestFactor), to = bounded(turn.at("to"), kLargestFactor);
  const int count = countOf(turn.at("count"), 1, 100000);
  for (int i = 0; i < count; ++i) {
    const double a = count == 1 ? from : from + (to - from) * i / (count - 1);
    poses.push_back(Eigen::Translation3d(through) * Eigen::AngleAxisd(a, axis.normalized()) * Eigen::Translation3d(-through));
  }
  return poses;
}

/// One camera and one place of the object for each frame of a path: as many of both, or one of one that serves all.
std::vector<std::pair<Eigen::Isometry3d, Eigen::Isometry3d>> pairedPaths(const JsonNode& root, const JsonNode& path) {
  const std::vector<Eigen::Isometry3d> cameras = readPath(path);
  const auto motion = root.find("object");
  const std::vector<Eigen::Isometry3d> objects = motion ? readMotion(*motion) : std::vector{Eigen::Isometry3d::Identity()};
  const std::size_t count = std::max(cameras.size(), objects.size());
  if ((cameras.size() > 1 && cameras.size() != count) || (objects.size() > 1 && objects.size() != count))
    motion->fail(formatted("has %zu places, and the path %zu cameras", objects.size(), cameras.size()));
  std::vector<std::pair<Eigen::Isometry3d, Eigen::Isometry3d>> pairs;
  for (std::size_t i = 0; i < count; ++i)
    pairs.emplace_back(cameras[cameras.size() == 1 ? 0 : i], objects[objects.size() == 1 ? 0 : i]);
  return pairs;
}

std::vector<double> readSteps(const JsonNode& node) {
  if (const auto values = node.find("values")) {
    const std::vector<double> list = boundedAll(*values, kFarthest).numbers();
    if (list.empty()) values->fail("is empty");
    return list;
  }
  const double from = bounded(node.at("from"), kFarthest), to = bounded(node.at("to"), kFarthest);
  const int count = countOf(node.at("count"), 2, 100000);
  std::vector<double> list;
  for (int i = 0; i < count; ++i) list.push_back(from + (to - from) * i / (count - 1));
  return list;
}

void setParameter(AnalyticSpec& spec, const JsonNode& name, double value) {
  const std::string parameter = name.text();
  const bool sheet = spec.type == "sheet", round = spec.type == "sphere" || spec.type == "cylinder", torus = spec.type == "torus";
  if (sheet && parameter == "curvature") {
    spec.curvature = value;
    return;
  }
  if (!(value > 0)) name.fail("'" + parameter + "' must be positive");
  if (sheet && parameter == "length")
    spec.length = value;
  else if (sheet && parameter == "width")
    spec.width = value;
  else if (round && parameter == "radius")
    spec.radius = value;
  else if (torus && parameter == "major_radius")
    spec.majorRadius = value;
  else if (torus && parameter == "minor_radius")
    spec.minorRadius = value;
  else
    name.fail("'" + parameter + "' is not a parameter of " + spec.type);
}

Material readMaterial(const JsonNode& render) {
  Material material;
  if (const auto n = render.find("reflectance")) {
    const std::optional<Lobe> lobe = lobeOf(n->text());
    std::string all;
    for (const Lobe known : allLobes()) all += (all.empty() ? "" : ", ") + std::string(nameOf(known));
    if (!lobe) n->fail("'" + n->text() + "' is not one of: " + all);
    material.lobe = *lobe;
  }
  if (const auto n = render.find("roughness")) material.roughness.mean = inRange(*n, 1e-4, 10);
  if (const auto n = render.find("roughness_ratio")) material.roughness.ratio = inRange(*n, 1e-2, 100);
  if (const auto n = render.find("specular")) material.specular = inRange(*n, 1e-12, 1e12);
  if (const auto n = render.find("diffuse")) {
    material.diffuse =
        n->isArray() ? boundedAll(*n, kLargestFactor).vector3() : Eigen::Vector3d::Constant(bounded(*n, kLargestFactor));
    if (!(material.diffuse.minCoeff() >= 0)) n->fail("must not be negative");
  }
  return material;
}

RenderOptions readRender(const JsonNode& render) {
  RenderOptions options;
  if (const auto n = render.find("exposure")) options.exposure = inRange(*n, 0, 1e12);
  if (const auto n = render.find("noise")) options.noise = inRange(*n, 0, 1);
  if (const auto n = render.find("blur_px")) options.blurPx = inRange(*n, 0, 100);
  if (const auto n = render.find("samples")) options.samples = countOf(*n, 1, 64);
  if (const auto n = render.find("seed")) options.seed = static_cast<unsigned>(countOf(*n, 0, 2147483647));
  if (const auto n = render.find("bits")) {
    options.bits = n->integer();
    if (options.bits != 8 && options.bits != 16 && options.bits != 32) n->fail("must be 8, 16 or 32");
  }
  if (const auto n = render.find("jpeg_quality")) {
    options.jpegQuality = countOf(*n, 1, 100);
    if (options.bits != 8) n->fail("needs \"bits\": 8, the only depth of JPEG");
  }
  return options;
}

struct SynthCamera {
  Camera camera;
  CameraResponse response;
};

void addFrame(Scene& scene, const SynthCamera& of, const Eigen::Isometry3d& pose, const std::string& surface,
              const Eigen::Isometry3d& worldFromObject = Eigen::Isometry3d::Identity()) {
  Frame frame;
  frame.id = padded(scene.frames.size());
  frame.camera = of.camera;
  frame.response = of.response;
  frame.camera.camFromWorld = pose;
  frame.surface = surface;
  frame.worldFromObject = worldFromObject;
  for (const TrueLight& light : scene.lights) frame.lightsOn.push_back(light.id);
  scene.frames.push_back(std::move(frame));
}

void readLights(const JsonNode& lights, Scene& scene) {
  std::set<std::string> ids;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    scene.lights.push_back(readLightJson(lights.at(i)));
    const std::string& id = scene.lights.back().id;
    if (!ids.insert(id).second) lights.at(i).at("id").fail("duplicate id '" + id + "'");
  }
  if (scene.lights.empty()) lights.fail("is empty: a highlight needs a light");
}

void readSurfaces(const JsonNode& surfaces, Scene& scene) {
  const auto find = [&](const JsonNode& named) {
    const std::filesystem::path file = resolveInside(scene.folder, named.text(), {}, named.file(), named.place());
    std::error_code ignored;  // a file that cannot be looked at counts as missing
    if (!std::filesystem::is_regular_file(file, ignored)) named.fail("file '" + named.text() + "' does not exist");
    return file;
  };
  for (const std::string& id : surfaces.keys()) {
    const JsonNode node = surfaces.at(id);
    if (!isIdentifier(id)) node.fail("an id must not be empty and must not contain control characters");
    scene.surfaces[id] = readSurfaceJson(node, find, {"mesh", "analytic"}).source;
  }
  if (scene.surfaces.empty()) surfaces.fail("is empty");
}

/// Puts one surface for each step in the place of the surface that is varied. @return their ids, in the order of the steps
std::vector<std::string> stepSurface(const JsonNode& steps, Scene& scene) {
  const JsonNode name = steps.at("surface");
  const auto base = scene.surfaces.find(name.text());
  if (base == scene.surfaces.end()) name.fail("surface '" + name.text() + "' does not exist");
  if (!base->second.analytic()) name.fail("'" + name.text() + "' is a mesh: only analytic surfaces have parameters");
  const AnalyticSpec original = *base->second.analytic();
  const std::string prefix = base->first;
  scene.surfaces.erase(base);
  std::vector<std::string> order;
  for (const double value : readSteps(steps)) {
    AnalyticSpec step = original;
    setParameter(step, steps.at("parameter"), value);
    if (step.type == "torus" && step.minorRadius >= step.majorRadius)
      steps.fail("minor_radius " + shown(step.minorRadius) + " must be smaller than major_radius " + shown(step.majorRadius));
    order.push_back(prefix + "_" + padded(order.size()));
    scene.surfaces[order.back()] = step;
  }
  return order;
}

/// The frames as listed, once for each surface of `order`. @param stepped  `order` holds steps, whatever surface a frame names
void readFrames(const JsonNode& frames, const SynthCamera& camera, const std::vector<std::string>& order, bool stepped,
                Scene& scene) {
  std::set<std::string> ids;
  for (const std::string& step : order)
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const JsonNode node = frames.at(i);
      std::string surface = step;
      if (const auto n = node.find("surface"); n && !stepped) {
        surface = n->text();
        if (!scene.surfaces.count(surface)) n->fail("surface '" + surface + "' does not exist");
      }
      const auto object = node.find("world_from_object");
      addFrame(scene, camera, readPoseJson(node.at("camera_from_world")), surface,
               object ? readPoseJson(*object) : Eigen::Isometry3d::Identity());
      Frame& frame = scene.frames.back();
      if (const auto n = node.find("id"); n && order.size() == 1) {
        frame.id = readIdJson(*n);
        if (!ids.insert(frame.id).second) n->fail("duplicate id '" + frame.id + "'");
      } else if (!ids.insert(frame.id).second) {
        node.fail("the id '" + frame.id + "' of this frame already exists");
      }
      if (const auto n = node.find("lights_on")) {
        frame.lightsOn.clear();
        for (std::size_t k = 0; k < n->size(); ++k) frame.lightsOn.push_back(readIdJson(n->at(k)));
      }
    }
  if (scene.frames.empty()) frames.fail("is empty");
}

ExactOptions readExact(const JsonNode& root) {
  ExactOptions exact;
  if (const auto n = root.find("contour")) {
    if (n->text() == "limit-angle")
      exact.kind = ContourKind::LimitAngle;
    else if (n->text() != "radiance")
      n->fail("'" + n->text() + "' is not one of: radiance, limit-angle");
  }
  if (const auto n = root.find("level")) exact.level = inRange(*n, kLeastLevel, kMostLevel);
  if (const auto n = root.find("margin_px")) exact.marginPx = inRange(*n, 0, 10000);
  if (exact.kind == ContourKind::LimitAngle) exact.limitAngle = inRange(root.at("limit_angle_deg"), 1e-6, 60) * M_PI / 180;
  return exact;
}

}  // namespace

SynthSpec readSynthSpec(const std::filesystem::path& file) {
  const JsonNode root = JsonNode::parse(readFile(file, Limit::JsonMegabytes), file.string());
  if (root.has("glint_session")) root.fail("is a session, not the specification of a synthetic scene");
  SynthSpec spec;
  Scene& scene = spec.scene;
  scene.file = file;
  scene.folder = std::filesystem::absolute(file).lexically_normal().parent_path();
  scene.name = file.stem().string();
  if (const auto n = root.find("name")) scene.name = n->text();
  const JsonNode cameraNode = root.at("camera");
  const SynthCamera camera{readCameraJson(cameraNode), readResponseJson(cameraNode, scene.folder, {})};
  if (camera.response.vignetting() > 0) cameraNode.at("response").fail("synth renders no vignetting");
  if (!camera.response.file().empty()) cameraNode.at("response").fail("must be srgb, linear, gamma:G or s-curve:S");
  readLights(root.at("lights"), scene);
  const JsonNode surfaces = root.at("surfaces");
  readSurfaces(surfaces, scene);
  std::vector<std::string> order{scene.surfaces.begin()->first};
  const auto steps = root.find("surface_steps");
  if (steps)
    order = stepSurface(*steps, scene);
  else if (scene.surfaces.size() > 1 && root.has("path"))
    surfaces.fail("a path needs exactly one surface");

  const auto requireFew = [&](std::size_t cameras, const JsonNode& node) {
    requireWithin(Limit::SynthFrames, double(order.size()) * double(cameras), file.string(), node.place());
  };
  if (const auto path = root.find("path")) {
    const auto poses = pairedPaths(root, *path);
    requireFew(poses.size(), *path);
    for (const std::string& surface : order)
      for (const auto& [pose, object] : poses) addFrame(scene, camera, pose, surface, object);
  } else {
    const JsonNode frames = root.at("frames");
    requireFew(frames.size(), frames);
    readFrames(frames, camera, order, steps.has_value(), scene);
  }

  spec.exact = readExact(root);
  if (const auto n = root.find("render")) {
    spec.material = readMaterial(*n);
    spec.render = readRender(*n);
  } else if (spec.exact.kind == ContourKind::Radiance) {
    root.fail("a radiance contour needs \"render\" with the reflectance");
  }
  return spec;
}

}  // namespace glint
