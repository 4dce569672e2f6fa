// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/what_if_knobs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/words.h"

namespace glint {

namespace {
constexpr double kLightReach = 1.0;   // of the working distance: a lamp may go anywhere about the scene
constexpr double kCameraReach = 0.1;  // of the working distance: an error of calibration, not another view
constexpr double kSteps = 200;        // of a slider from end to end
const char* const kAxes[] = {"x", "y", "z"};

ParamSpec numberKnob(const std::string& key, const std::string& title, const std::string& unit, double neutral, double min,
                     double max, double step, const std::string& help) {
  ParamSpec s;
  s.key = key;
  s.title = title;
  s.unit = unit;
  s.defaultValue = neutral;
  s.min = min;
  s.max = max;
  s.step = step;
  s.help = help;
  return s;
}

/// A step of one, two or five times a power of ten that divides the range about kSteps times.
double roundStep(double range) {
  const double raw = range / kSteps, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10 * power;
}

template <class Map, class Key>
auto lookUp(const Map& map, const Key& key) {
  const auto it = map.find(key);
  return it == map.end() ? typename Map::mapped_type{} : it->second;
}

/// Keeps only what changes something.
template <class Map, class Key, class Value>
void store(Map& map, const Key& key, const Value& value) {
  if (value == typename Map::mapped_type{})
    map.erase(key);
  else
    map[key] = value;
}

template <class Map, class Key, class Value>
void storeVector(Map& map, const Key& key, const Value& value) {
  if (value.isZero(0))
    map.erase(key);
  else
    map[key] = value;
}

Eigen::Vector3d shiftOf(const WhatIf& w, const std::string& light) {
  const auto it = w.lightsBy.find(light);
  return it == w.lightsBy.end() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : it->second;
}

void addLights(std::vector<WhatIfKnob>& knobs, const Scene& scene, double distance) {
  for (const TrueLight& light : scene.lights) {
    const bool far = light.lamp.atInfinity();  // its unit direction moves
    const bool carried = light.frame == LightFrame::Camera;
    const Eigen::Vector3d at = far ? lightOf(light.lamp).homogeneous().head<3>().eval() : light.lamp.position();
    const std::string help =
        formatted("Moves the light along this axis of the %s. The scene has %s at %.4g, %.4g, %.4g%s.", nameOf(light.frame),
                  far ? "its direction" : "it", at.x(), at.y(), at.z(), far ? "" : " m");
    const double reach = far ? 1.0 : kLightReach * distance;
    for (int axis = 0; axis < 3; ++axis)
      knobs.push_back({(saysLight(light.id) ? light.id : "Light " + light.id) + (carried ? ", moves with the camera" : ""),
                       numberKnob("light." + light.id + "." + kAxes[axis], std::string("Shift ") + kAxes[axis], far ? "" : "m", 0,
                                  -reach, reach, roundStep(2 * reach), help),
                       true, [id = light.id, axis](const WhatIf& w) { return shiftOf(w, id)(axis); },
                       [id = light.id, axis](WhatIf& w, double v) {
                         Eigen::Vector3d by = shiftOf(w, id);
                         by(axis) = v;
                         storeVector(w.lightsBy, id, by);
                       }});
  }
}

void addSurface(std::vector<WhatIfKnob>& knobs, const Scene& scene, const std::string& id) {
  const AnalyticSpec* const formula = scene.formulaOf(id);
  const std::optional<ShapeParameter> shape = formula ? shapeOf(*formula) : std::nullopt;
  if (!shape) return;
  std::string title = shape->name;
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  knobs.push_back({"Surface " + id,
                   numberKnob("surface." + id, title, shape->unit, shape->value, shape->min, shape->max,
                              roundStep(shape->max - shape->min), "Bends or resizes the surface for every camera."),
                   true,
                   [id, shape](const WhatIf& w) {
                     const auto it = w.surfaces.find(id);
                     return it == w.surfaces.end() ? shape->value : it->second;
                   },
                   [id, shape](WhatIf& w, double v) {
                     if (v == shape->value)
                       w.surfaces.erase(id);
                     else
                       w.surfaces[id] = v;
                   }});
}

void addPose(std::vector<WhatIfKnob>& knobs, const Scene& scene, int frame, double distance) {
  const std::string id = scene.frames[std::size_t(frame)].id, group = "Camera of frame " + id;
  for (int axis = 0; axis < 3; ++axis)
    knobs.push_back({group,
                     numberKnob("pose.rotate." + std::string(kAxes[axis]), std::string("Turn about ") + kAxes[axis], "deg", 0, -5,
                                5, 0.02, "Rotates the camera about its centre; x right, y down, z forward."),
                     false, [frame, axis](const WhatIf& w) { return degrees(lookUp(w.poses, frame).rotation(axis)); },
                     [frame, axis](WhatIf& w, double v) {
                       PoseChange change = lookUp(w.poses, frame);
                       change.rotation(axis) = radians(v);
                       store(w.poses, frame, change);
                     }});
  const double reach = kCameraReach * distance;
  for (int axis = 0; axis < 3; ++axis)
    knobs.push_back({group,
                     numberKnob("pose.move." + std::string(kAxes[axis]), std::string("Move along ") + kAxes[axis], "m", 0, -reach,
                                reach, roundStep(2 * reach), "Moves the camera along its own axis."),
                     false, [frame, axis](const WhatIf& w) { return lookUp(w.poses, frame).translation(axis); },
                     [frame, axis](WhatIf& w, double v) {
                       PoseChange change = lookUp(w.poses, frame);
                       change.translation(axis) = v;
                       store(w.poses, frame, change);
                     }});
}

void addHighlight(std::vector<WhatIfKnob>& knobs, const Scene& scene, int frame, int index) {
  const std::pair<int, int> at{frame, index};
  const Camera& camera = scene.frames[std::size_t(frame)].camera;
  const double reach = 0.05 * std::max(camera.width, camera.height);  // beyond that it would be another highlight
  const std::string group = "Highlight " + std::to_string(index + 1) + " of frame " + scene.frames[std::size_t(frame)].id;
  const auto add = [&](const std::string& key, const std::string& title, const std::string& unit, double neutral, double min,
                       double max, double step, const std::string& help, auto member) {
    knobs.push_back(
        {group, numberKnob("highlight." + std::to_string(index) + "." + key, title, unit, neutral, min, max, step, help), false,
         [at, member](const WhatIf& w) {
           HighlightChange change = lookUp(w.highlights, at);
           return member(change);
         },
         [at, member](WhatIf& w, double v) {
           HighlightChange change = lookUp(w.highlights, at);
           member(change) = v;
           store(w.highlights, at, change);
         },
         index});
  };
  add("contour.x", "Contour right", "px", 0, -reach, reach, 0.1, "Moves the observed contour.",
      [](HighlightChange& c) -> double& { return c.contourBy.x(); });
  add("contour.y", "Contour down", "px", 0, -reach, reach, 0.1, "Moves the observed contour.",
      [](HighlightChange& c) -> double& { return c.contourBy.y(); });
  add("scale", "Contour size", "", 1, 0.5, 2, 0.005, "Scales the observed contour about its centroid.",
      [](HighlightChange& c) -> double& { return c.contourScale; });
  add("peak.x", "Peak right", "px", 0, -reach, reach, 0.1, "Moves the observed peak.",
      [](HighlightChange& c) -> double& { return c.peakBy.x(); });
  add("peak.y", "Peak down", "px", 0, -reach, reach, 0.1, "Moves the observed peak.",
      [](HighlightChange& c) -> double& { return c.peakBy.y(); });
}

std::string counted(std::size_t n, const std::string& one) { return std::to_string(n) + " " + one + (n == 1 ? "" : "s"); }
}  // namespace

std::vector<WhatIfKnob> whatIfKnobs(const Scene& scene, int frame, int highlights, double roughness) {
  require(roughness > 0, "whatIfKnobs: roughness must be positive");
  require(frame >= 0 && frame < int(scene.frames.size()), "whatIfKnobs: no such frame");
  std::vector<WhatIfKnob> knobs;
  const double distance = workingDistance(scene);
  addLights(knobs, scene, distance);
  addSurface(knobs, scene, scene.frames[std::size_t(frame)].surface);
  knobs.push_back({"Lobe",
                   numberKnob("roughness", "Roughness", "", roughness, std::min(0.01, roughness), std::max(0.5, roughness), 0.005,
                              "Roughness m of the lobe that makes the contours."),
                   true, [](const WhatIf& w) { return w.roughness; }, [](WhatIf& w, double v) { w.roughness = v; }});
  addPose(knobs, scene, frame, distance);
  for (int h = 0; h < highlights; ++h) addHighlight(knobs, scene, frame, h);
  return knobs;
}

const char* pastOf(HighlightEdit::Kind kind) {
  switch (kind) {
    case HighlightEdit::Kind::Ignore: return "ignored";
    case HighlightEdit::Kind::Merge: return "merged";
    case HighlightEdit::Kind::Split: return "split";
    case HighlightEdit::Kind::Seed: break;
  }
  return "grown";
}

std::string summaryOf(const WhatIf& w) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (w.synthesise) {
    add("contours synthesised");
    if (!w.lightsBy.empty()) add(counted(w.lightsBy.size(), "light"));
    if (!w.surfaces.empty()) add(counted(w.surfaces.size(), "surface"));
  }
  if (!w.poses.empty()) add(counted(w.poses.size(), "pose"));
  if (!w.highlights.empty()) add(counted(w.highlights.size(), "highlight"));
  if (!w.edits.empty()) add(counted(w.edits.size(), "highlight edit") + " by hand");
  const auto switches = std::count_if(w.lightsSwitched.begin(), w.lightsSwitched.end(),
                                      [&](const auto& entry) { return !entry.second || w.synthesise; });
  if (switches > 0) add(counted(std::size_t(switches), "light") + " switched");
  return text;
}

std::string frameNote(const WhatIf& w, int frame) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (w.synthesise) add("contours and photograph synthesised");
  if (w.poses.count(frame)) add("camera moved by hand");
  if (std::any_of(w.highlights.begin(), w.highlights.end(), [&](const auto& h) { return h.first.first == frame; }))
    add("highlight moved by hand");
  for (const HighlightEdit::Kind kind :
       {HighlightEdit::Kind::Ignore, HighlightEdit::Kind::Merge, HighlightEdit::Kind::Split, HighlightEdit::Kind::Seed}) {
    const auto count =
        std::count_if(w.edits.begin(), w.edits.end(), [&](const HighlightEdit& e) { return e.frame == frame && e.kind == kind; });
    if (count > 0) add(counted(std::size_t(count), "highlight") + " " + pastOf(kind) + " by hand");
  }
  for (const auto& [at, on] : w.lightsSwitched)
    if (at.first == frame && (!on || w.synthesise)) add(lightName(at.second) + " switched " + (on ? "on" : "off"));
  return text;
}

}  // namespace glint
