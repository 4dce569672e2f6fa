// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/scene_json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/base/bounded_json.h"
#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/geometry/camera.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_reader.h"

namespace glint {
namespace fs = std::filesystem;
using json_dom::Json;

namespace {

/// Collects what this version does not know: kept for writing back, warned of once per place.
struct Unknown {
  Scene& scene;
  Json kept = Json::object();

  Json of(const JsonNode& node, const std::set<std::string>& known) {
    Json rest = Json::object();
    const std::vector<std::string> keys = node.unknownKeys(known);
    constexpr std::size_t kEach = 8;  // as many as a person reads
    if (keys.size() > kEach)
      scene.warnings.push_back((node.place().empty() ? "" : node.place() + ": ") + std::to_string(keys.size()) +
                               " unknown keys, kept, such as " + keys.front());
    for (const std::string& key : keys) {
      const JsonNode value = node.at(key);
      if (keys.size() <= kEach) scene.warnings.push_back(value.place() + ": unknown key, kept");
      json_dom::append(rest, key, json_dom::NodeValue::of(value));
    }
    return rest;
  }
};

void keep(Json& target, const std::string& key, Json value) {
  if (!value.empty()) json_dom::append(target, key, std::move(value));  // every key stands once
}

constexpr int kNewestScene = 2;
constexpr const char* kNeedsVersion2 = "needs a scene of version 2 (\"glint_scene\": 2)";
constexpr const char *kObjectPoseKey = "world_from_object", *kLightFrameKey = "frame", *kKnownKey = "known";
const std::set<std::string> kCameraKeys = {"width", "height", "fx", "fy", "cx", "cy", "skew", "distortion", "model", "response"};
std::set<std::string> lightKeys() {
  std::set<std::string> keys{"id", "position", "direction", "radius", kLightFrameKey, kKnownKey, sigmaKey(false), sigmaKey(true)};
  for (const PlacedShape& shape : placedShapes()) keys.insert(shape.name);
  return keys;
}

// Like the keys of cameras and frames (core/geometry/camera_json.cpp): they would move a surface, or the whole scene.
const std::set<std::string> kSurfaceGeometry = {"world_from_surface",
                                                "world_from_mesh",
                                                "surface_from_world",
                                                "mesh_from_world",
                                                "transform",
                                                "transform_matrix",
                                                "pose",
                                                "scale",
                                                "offset",
                                                "origin",
                                                "rotation",
                                                "translation",
                                                "displacement"};
const std::set<std::string> kSceneGeometry = {"scale",      "world_scale", "transform", "world_transform", "coordinate_system",
                                              "handedness", "up",          "up_axis",   "convention",      "origin",
                                              "offset"};

}  // namespace

int versionOf(const Frame& frame) { return standsStill(frame) ? 1 : 2; }
int versionOf(const TrueLight& light) { return light.frame == LightFrame::World && !light.known ? 1 : 2; }

const char* sigmaKey(bool ofDirection) { return ofDirection ? "sigma_deg" : "sigma_m"; }

bool isMadeBySynth(const JsonNode& root) {
  const auto n = root.find(kMadeBy);
  return n && n->isString() && n->text() == kMadeBySynth;
}

namespace {
std::string placeKeys() {
  std::string keys = "position, direction";
  for (const PlacedShape& shape : placedShapes()) keys += ", " + shape.name;
  return keys;
}

/// `known`, and how well its place is known.
void readKnown(const JsonNode& node, TrueLight& light) {
  if (const auto n = node.find(kKnownKey)) light.known = n->boolean();
  for (const bool ofDirection : {false, true}) {
    const auto n = node.find(sigmaKey(ofDirection));
    if (!n) continue;
    if (!light.known) n->fail("belongs to a light that is known (\"known\": true)");
    if (ofDirection != light.lamp.atInfinity()) n->fail(ofDirection ? "belongs to a direction" : "belongs to a place");
    light.sigma = bounded(*n, ofDirection ? 90 : kFarthest);  // a lamp whose direction is less certain is not known
    if (light.sigma < 0) n->fail("must not be negative");
  }
}
}  // namespace

TrueLight readLightJson(const JsonNode& node) {
  TrueLight light;
  light.id = readIdJson(node.at("id"));
  int places = 0;
  if (const auto n = node.find("position")) light.lamp = lampAt(lengths3(*n)), ++places;
  if (const auto n = node.find("direction")) {
    const Eigen::Vector3d d = lengths3(*n);
    if (!(d.norm() > 0)) n->fail("must not be zero");
    light.lamp = lampTowards(d), ++places;
  }
  for (const PlacedShape& shape : placedShapes()) {
    const auto n = node.find(shape.name);
    if (!n) continue;
    if (n->size() != std::size_t(shape.points)) n->fail(shape.wrongSize);
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < n->size(); ++i) points.push_back(lengths3(n->at(i)));
    if (const std::string fault = shape.faultOf(points); !fault.empty()) n->fail(fault);
    light.lamp = shape.make(points), ++places;
  }
  if (places != 1) node.fail("needs exactly one of " + placeKeys());
  if (const auto n = node.find("radius")) {
    const double radius = bounded(*n, kFarthest);
    if (radius < 0) n->fail("must not be negative");
    light.lamp = withRadius(light.lamp, radius);
  }
  if (const auto n = node.find(kLightFrameKey)) {
    if (n->text() != nameOf(LightFrame::World) && n->text() != nameOf(LightFrame::Camera))
      n->fail("must be \"world\" or \"camera\"");
    if (n->text() == nameOf(LightFrame::Camera)) light.frame = LightFrame::Camera;
  }
  readKnown(node, light);
  return light;
}

namespace {

Highlight readHighlight(const JsonNode& node, const Camera& camera) {
  Highlight h;
  h.fromScene = true;
  if (const auto n = node.find("light")) h.light = readIdJson(*n);
  if (const auto n = node.find("level")) {
    h.level = n->number();
    if (!(h.level >= kLeastLevel && h.level <= kMostLevel)) n->fail("must be between 0.000001 and 0.999999");
  }
  const auto ideal = [&camera](const JsonNode& point) {
    const Outcome<Pixel> found = withoutDistortion(camera, pixel(point));
    if (!found) point.fail("lies where the lens distortion cannot be removed: " + found.failure().detail);
    return *found;
  };
  const JsonNode contour = node.at("contour");
  const std::size_t n = contour.size();
  if (n < 5) contour.fail("must have at least 5 points, has " + std::to_string(n));
  for (std::size_t i = 0; i < n; ++i) h.contour.points.push_back(ideal(contour.at(i)));
  h.touchesBorder = runsAlongImageBorder(camera, h.contour);  // one that leaves the image and comes back is whole
  h.peak = ideal(node.at("peak"));
  // One orientation for all contours, whatever program wrote them; the first point stays first.
  const double area = signedArea(h.contour);
  if (area < 0) std::reverse(h.contour.points.begin() + 1, h.contour.points.end());
  h.areaPx2 = std::abs(area);
  if (!(h.areaPx2 > 0)) contour.fail("encloses no area");
  return h;
}

/// Intrinsics of the camera that took the depth maps, with `camera_from_depth`; its camFromWorld is from the frame's camera.
Camera readDepthCamera(const JsonNode& node) {
  Camera camera = readCameraJson(node);
  camera.camFromWorld = readPoseJson(node.at("camera_from_depth")).inverse();
  return camera;
}

std::set<std::string> depthCameraKeys() {
  std::set<std::string> keys = kCameraKeys;
  keys.insert("camera_from_depth");
  return keys;
}

constexpr double kMostVideoSeconds = 1e6;  // eleven days

/// {"index", "seconds"} of a picture of the video that `image` names.
VideoPicture readOfVideo(const JsonNode& node) {
  VideoPicture picture{node.at("index").integer(), bounded(node.at("seconds"), kMostVideoSeconds)};
  if (picture.index < 0 || picture.index >= kMostPictures) node.at("index").fail("is no picture of a video");
  if (picture.seconds < 0) node.at("seconds").fail("must not be negative");
  return picture;
}

/// A camera and what its codes mean.
using CameraOfFrames = std::pair<Camera, CameraResponse>;

CameraOfFrames readCameraOfFrames(const JsonNode& node, const ReadOptions& options, Scene& scene) {
  CameraOfFrames read{readCameraJson(node), readResponseJson(node, scene.folder, options.rights())};
  if (const std::string doubt = read.second.doubt(); !doubt.empty())
    scene.warnings.push_back(node.place() + ".response: " + doubt);
  return read;
}

struct FrameContext {
  const std::optional<CameraOfFrames>& sharedCamera;
  const std::optional<Camera>& sharedDepthCamera;
  const ReadOptions& options;
  Scene& scene;
  Unknown& unknown;
  capture::FileNames& names;
};

std::vector<std::string> readIds(const JsonNode& list) {
  std::vector<std::string> ids;
  for (std::size_t i = 0; i < list.size(); ++i) ids.push_back(readIdJson(list.at(i)));
  return ids;
}

void readHighlights(const JsonNode& list, const FrameContext& context, Frame& frame, Json& rest) {
  Json rests = Json::array();
  bool any = false;
  for (std::size_t i = 0; i < list.size(); ++i) {
    frame.highlights.push_back(readHighlight(list.at(i), frame.camera));
    rests.push_back(context.unknown.of(list.at(i), {"light", "level", "peak", "contour"}));
    any = any || !rests.back().empty();
  }
  if (any) rest["highlights"] = rests;
}

Frame readFrame(const JsonNode& node, const FrameContext& context, Json& rest) {
  Frame frame;
  const Scene& scene = context.scene;
  refuseFrameGeometry(node);
  frame.id = readIdJson(node.at("id"));
  const auto path = [&](const char* key) -> fs::path {
    const auto n = node.find(key);
    if (!n || n->isNull()) return {};
    return context.names.other(scene.folder, n->text(), n->file(), n->place());
  };
  frame.image = path("image");
  if (const auto n = node.find("of_video")) frame.ofVideo = readOfVideo(*n);
  frame.radiance = path("radiance");
  frame.depth = path("depth");
  frame.normals = path("normals");
  frame.mask = path("mask");
  if (const auto n = node.find("depth_scale")) frame.depthScale = positive(*n, kLargestFactor);
  if (const auto n = node.find("camera")) {
    std::tie(frame.camera, frame.response) = readCameraOfFrames(*n, context.options, context.scene);
    keep(rest, "camera", context.unknown.of(*n, kCameraKeys));
  } else if (context.sharedCamera) {
    std::tie(frame.camera, frame.response) = *context.sharedCamera;
  } else {
    throw InputError(node.file(), node.place() + ".camera", "is missing, and the scene has no camera for all frames");
  }
  if (const auto n = node.find("depth_camera")) {
    frame.depthCamera = readDepthCamera(*n);
    keep(rest, "depth_camera", context.unknown.of(*n, depthCameraKeys()));
  } else if (!frame.depth.empty()) {
    frame.depthCamera = context.sharedDepthCamera;
  }
  const auto pose = [&](const JsonNode& n) {
    std::string warning;
    const Eigen::Isometry3d read = readPoseJson(n, &warning);
    if (!warning.empty()) context.scene.warnings.push_back(warning);
    return read;
  };
  frame.camera.camFromWorld = pose(node.at("camera_from_world"));
  if (const auto n = node.find(kObjectPoseKey)) frame.worldFromObject = pose(*n);
  if (const auto n = node.find("surface"); n && !n->isNull()) {
    frame.surface = n->text();
    if (!scene.surfaces.count(frame.surface)) n->fail("surface '" + frame.surface + "' does not exist");
  } else if (frame.depth.empty()) {
    if (scene.surfaces.size() != 1)
      throw InputError(node.file(), node.place() + ".surface",
                       scene.surfaces.empty() ? "is missing: the scene has no surface and the frame no depth"
                                              : "is missing: the scene has several surfaces");
    frame.surface = scene.surfaces.begin()->first;
  }
  if (const auto n = node.find("lights_on")) frame.lightsOn = readIds(*n);
  if (const auto n = node.find("highlights")) readHighlights(*n, context, frame, rest);
  return frame;
}

}  // namespace

Scene readSceneJson(const std::string& text, const fs::path& file, const ReadOptions& options) {
  const JsonNode root = JsonNode::parse(text, file.string());
  Scene scene;
  scene.file = file;
  scene.folder = fs::absolute(file).lexically_normal().parent_path();
  scene.allowOutsidePaths = options.allowOutsidePaths;
  Unknown unknown{scene};
  refuseGeometry(root, kSceneGeometry);

  const JsonNode version = root.at("glint_scene");
  if (version.integer() < 1 || version.integer() > kNewestScene)
    version.fail(
        formatted("version %lld is not supported, only 1 to %d", static_cast<long long>(version.integer()), kNewestScene));
  if (!root.has("frames") && root.has("path")) root.fail("is a specification, not a scene (`glint synth` makes a scene from it)");
  scene.name = scene.folder.filename().string();
  if (const auto n = root.find("name")) scene.name = n->text();
  if (const auto n = root.find("units"); n && n->text() != "m")
    n->fail("'" + n->text() + "' is not supported: lengths are in metres (\"m\")");

  std::optional<CameraOfFrames> shared;
  if (const auto n = root.find("camera")) {
    shared = readCameraOfFrames(*n, options, scene);
    keep(unknown.kept, "camera", unknown.of(*n, kCameraKeys));
  }
  std::optional<Camera> sharedDepth;
  if (const auto n = root.find("depth_camera")) {
    sharedDepth = readDepthCamera(*n);
    keep(unknown.kept, "depth_camera", unknown.of(*n, depthCameraKeys()));
  }
  capture::FileNames names(options.rights());
  const FrameContext context{shared, sharedDepth, options, scene, unknown, names};

  Json surfaceRests = Json::object();
  if (const auto n = root.find("surfaces")) {
    for (const std::string& id : n->keys()) {
      const JsonNode node = n->at(id);
      if (!isIdentifier(id)) node.fail("a surface needs a name without control characters");
      refuseGeometry(node, kSurfaceGeometry);
      ReadSurface read = readSurfaceJson(node, [&](const JsonNode& named) {
        return placeOfMesh(
            named.text(), [&] { return names.other(scene.folder, named.text(), named.file(), named.place()); }, options, scene,
            named.place());
      });
      scene.surfaces[id] = std::move(read.source);
      Json rest = unknown.of(node, read.known.at(""));
      read.known.erase("");
      for (const auto& [key, known] : read.known) keep(rest, key, unknown.of(node.at(key), known));
      keep(surfaceRests, id, rest);
    }
  }
  keep(unknown.kept, "surfaces", surfaceRests);

  std::set<std::string> lightIds;
  Json lightRests = Json::object();
  if (const auto n = root.find("lights")) {
    for (std::size_t i = 0; i < n->size(); ++i) {
      const JsonNode node = n->at(i);
      scene.lights.push_back(readLightJson(node));
      if (version.integer() < versionOf(scene.lights.back()))
        node.at(scene.lights.back().known ? kKnownKey : kLightFrameKey).fail(kNeedsVersion2);
      const std::string& id = scene.lights.back().id;
      if (!lightIds.insert(id).second) node.at("id").fail("duplicate id '" + id + "'");
      keep(lightRests, id, unknown.of(node, lightKeys()));
    }
  }
  keep(unknown.kept, "lights", lightRests);

  std::set<std::string> frameIds;
  Json frameRests = Json::object();
  const JsonNode frames = root.at("frames");
  if (frames.size() == 0) frames.fail("is empty: a scene needs at least one frame");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const JsonNode node = frames.at(i);
    Json rest = unknown.of(node, {"id", "image", "of_video", "radiance", "depth", "normals", "mask", "depth_scale", "camera",
                                  "depth_camera", "camera_from_world", kObjectPoseKey, "surface", "lights_on", "highlights"});
    Frame frame = readFrame(node, context, rest);
    if (version.integer() < versionOf(frame)) node.at(kObjectPoseKey).fail(kNeedsVersion2);
    if (!frameIds.insert(frame.id).second) node.at("id").fail("duplicate id '" + frame.id + "'");
    if (!lightIds.empty())
      for (const std::string& light : frame.lightsOn)
        if (!lightIds.count(light)) scene.warnings.push_back(node.place() + ".lights_on: '" + light + "' is not in lights");
    keep(frameRests, frame.id, rest);
    scene.frames.push_back(std::move(frame));
  }
  keep(unknown.kept, "frames", frameRests);
  names.tell(scene.warnings);
  if (shared && shared->second.isStated())
    if (const auto n =
            std::count_if(scene.frames.begin(), scene.frames.end(), [](const Frame& f) { return !f.response.isStated(); }))
      scene.warnings.push_back("camera.response does not hold for " + std::to_string(n) +
                               " frames with a camera of their own that states none");

  for (const auto& [named, place] : options.meshes)
    if (!scene.meshes.count(named))
      scene.warnings.push_back("no surface has the mesh '" + named + "' for which a file was given");

  std::set<std::string> topKeys = {"glint_scene", "name", "units", "camera", "depth_camera", "frames", "surfaces", "lights"};
  if (isMadeBySynth(root)) topKeys.insert(kMadeBy);
  keep(unknown.kept, "scene", unknown.of(root, topKeys));  // it may be most of the file: no copy
  if (!unknown.kept.empty()) scene.unknownJson = unknown.kept.dump();
  return scene;
}

}  // namespace glint
