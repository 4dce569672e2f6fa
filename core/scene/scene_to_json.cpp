// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <unordered_set>
#include <utility>

#include "core/base/json_dom.h"
#include "core/scene/scene_dom.h"
#include "core/scene/scene_json.h"

namespace glint {
namespace fs = std::filesystem;
using json_dom::Json;

Json toJson(const Eigen::VectorXd& v) {
  Json j = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) j.push_back(v[i]);
  return j;
}

Json toJson(const Eigen::Matrix4d& m) {
  Json j = Json::array();
  for (int i = 0; i < 4; ++i) j.push_back(toJson(Eigen::VectorXd(m.row(i).transpose())));
  return j;
}

namespace {
using glint::toJson;  // of vectors and matrices

Json toJson(const Camera& camera) {
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  Json j = {{"width", camera.width}, {"height", camera.height}, {"fx", k(0, 0)},
            {"fy", k(1, 1)},         {"cx", k(0, 2)},           {"cy", k(1, 2)}};
  if (k(0, 1) != 0) j["skew"] = k(0, 1);
  const Lens& lens = camera.lens;
  if (lens.model != LensModel::OpenCv) j["model"] = nameOf(lens.model);
  j["distortion"] = Json::array();
  for (int i = 0; i < parameterCountOf(lens.model); ++i) j["distortion"].push_back(lens.parameters[static_cast<std::size_t>(i)]);
  return j;
}

Json depthCameraJson(const Camera& camera) {
  Json j = toJson(camera);
  j["camera_from_depth"] = toJson(camera.camFromWorld.inverse().matrix());
  return j;
}

bool sameIntrinsics(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.pixelFromRay == b.pixelFromRay && a.lens == b.lens;
}

/// Puts kept unknown keys back; never overwrites a known one.
void restore(Json& target, const Json& kept) {
  std::unordered_set<std::string> known;
  for (const auto& item : target.items()) known.insert(item.key());
  for (const auto& item : kept.items()) {
    if (!known.count(item.key())) {
      json_dom::append(target, item.key(), item.value());
      continue;
    }
    Json& old = target[item.key()];
    if (old.is_object() && item.value().is_object()) restore(old, item.value());
    if (old.is_array() && item.value().is_array())
      for (std::size_t i = 0; i < std::min(old.size(), item.value().size()); ++i)
        if (old[i].is_object()) restore(old[i], item.value()[i]);
  }
}

Json toJson(const Highlight& h, const Camera& camera) {
  Json j = Json::object();
  if (!h.light.empty()) j["light"] = h.light;
  j["level"] = h.level;
  j["peak"] = toJson(Eigen::VectorXd(camera.distorted(h.peak)));
  Json contour = Json::array();
  for (const Pixel& p : h.contour.points) contour.push_back(toJson(Eigen::VectorXd(camera.distorted(p))));
  j["contour"] = std::move(contour);
  return j;
}

Json toJson(const TrueLight& light) {
  Json j = {{"id", light.id}};
  if (light.frame != LightFrame::World) j["frame"] = nameOf(light.frame);
  if (light.known) j["known"] = true;
  if (light.sigma > 0) j[sigmaKey(light.lamp.atInfinity())] = light.sigma;
  for (const LampField& f : fieldsOf(light.lamp)) {
    if (f.value.size() == 1)
      j[f.name] = f.value(0);
    else if (f.value.rows() == 1)
      j[f.name] = toJson(Eigen::VectorXd(f.value.row(0)));
    else
      for (const auto& point : f.value.rowwise()) j[f.name].push_back(toJson(Eigen::VectorXd(point)));
  }
  return j;
}

}  // namespace

std::string sceneToJson(const Scene& scene, const fs::path& folder) {
  // Written by this program: its limits were checked when the scene was read, and the grouping nests it one level deeper.
  const Json kept = scene.unknownJson.empty() ? Json::object() : Json::parse(scene.unknownJson);
  std::map<std::pair<std::string, std::string>, const Json*> keptById;  // the JSON library looks through all ids for one
  for (const auto& group : kept.items())
    for (const auto& item : group.value().items()) keptById.emplace(std::pair(group.key(), item.key()), &item.value());
  const auto keptOf = [&](const char* group, const std::string& id) -> Json {
    const auto found = keptById.find({group, id});
    return found == keptById.end() ? Json::object() : *found->second;
  };
  const auto relative = [&](const fs::path& path, const std::string& place) {
    const fs::path r = fs::absolute(path).lexically_normal().lexically_relative(folder);
    if (r.empty()) throw InputError(path.string(), place, "has no path relative to " + folder.string());
    return r.generic_string();
  };
  const auto response = [&](Json camera, const Frame& frame, const std::string& place) {
    const CameraResponse& r = frame.response;
    if (!r.text().empty()) camera["response"] = r.file().empty() ? r.text() : relative(r.file(), place + "response");
    return camera;
  };
  int version = 1;
  for (const Frame& frame : scene.frames) version = std::max(version, versionOf(frame));
  for (const TrueLight& light : scene.lights) version = std::max(version, versionOf(light));
  Json root = {{"glint_scene", version}, {"name", scene.name}, {"units", "m"}};
  const bool shared = std::all_of(scene.frames.begin(), scene.frames.end(), [&](const Frame& f) {
    return sameIntrinsics(f.camera, scene.frames.front().camera) && f.response == scene.frames.front().response;
  });
  if (shared && !scene.frames.empty()) {
    root["camera"] = response(toJson(scene.frames.front().camera), scene.frames.front(), "camera.");
    if (kept.contains("camera")) restore(root["camera"], kept["camera"]);
  }
  root["frames"] = Json::array();
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Frame& frame = scene.frames[i];
    const std::string place = "frames[" + std::to_string(i) + "].";
    Json j = {{"id", frame.id}};
    const auto path = [&](const char* key, const fs::path& p) {
      if (!p.empty()) j[key] = relative(p, place + key);
    };
    path("image", frame.image);
    if (frame.ofVideo) j["of_video"] = {{"index", frame.ofVideo->index}, {"seconds", frame.ofVideo->seconds}};
    path("radiance", frame.radiance);
    path("depth", frame.depth);
    if (frame.depthScale > 0) j["depth_scale"] = frame.depthScale;
    path("normals", frame.normals);
    path("mask", frame.mask);
    if (!shared) j["camera"] = response(toJson(frame.camera), frame, place + "camera.");
    if (frame.depthCamera) {
      j["depth_camera"] = depthCameraJson(*frame.depthCamera);
      if (kept.contains("depth_camera")) restore(j["depth_camera"], kept["depth_camera"]);
    }
    j["camera_from_world"] = toJson(frame.camera.camFromWorld.matrix());
    if (!standsStill(frame)) j["world_from_object"] = toJson(frame.worldFromObject.matrix());
    if (!frame.surface.empty()) j["surface"] = frame.surface;
    if (!frame.lightsOn.empty()) j["lights_on"] = frame.lightsOn;
    for (const Highlight& h : frame.highlights) j["highlights"].push_back(toJson(h, frame.camera));
    restore(j, keptOf("frames", frame.id));
    root["frames"].push_back(std::move(j));
  }
  root["surfaces"] = Json::object();
  for (const auto& [id, source] : scene.surfaces) {
    Json j = toJson(source, "surfaces." + id, relative);
    restore(j, keptOf("surfaces", id));
    root["surfaces"][id] = std::move(j);
  }
  if (!scene.lights.empty()) {
    root["lights"] = Json::array();
    for (const TrueLight& light : scene.lights) {
      Json j = toJson(light);
      restore(j, keptOf("lights", light.id));
      root["lights"].push_back(std::move(j));
    }
  }
  if (kept.contains("scene")) restore(root, kept["scene"]);
  return json_dom::prettyWithPaths(root, folder.string());
}

}  // namespace glint
