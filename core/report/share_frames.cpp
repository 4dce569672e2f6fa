// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/scene_drawing.h"
#include "core/report/share_parts.h"
#include "core/surface/mesh_policy.h"

namespace glint::share {
namespace {

constexpr double kDiscTimes = 1.5;  // of the contour: a page shows the discs of all frames at once

constexpr int kMostPoints = 180;     ///< of a contour in 3D: chords of 2 degrees are round on a screen
constexpr double kRing = 4.4;        ///< radius of a true lamp's ring, of that of a point, at least
constexpr double kLeastAxis = 1e-5;  ///< of the longest: a flat ellipsoid has no inverse

template <class List, class Text>
std::string array(const List& list, const Text& text) {
  std::string out;
  bool first = true;
  for (const auto& element : list) {
    out += first ? "" : ",";
    out += text(element);
    first = false;
  }
  return "[" + out + "]";
}

std::string chains(const std::vector<draw::WorldChain>& all, const Rounding& rounding) {
  std::vector<draw::WorldChain> drawn;
  for (const draw::WorldChain& chain : all)
    if (chain.size() > 1) drawn.push_back(chain);
  return array(drawn, [&](const draw::WorldChain& chain) { return rounding.world(chain); });
}

/// "#00719e", as the picture draws it: paler where the fit is poor.
std::string hexOf(const draw::Colour& colour) {
  std::string text = "#";
  for (const double channel : colour)
    text += formatted("%02x", static_cast<int>(std::lround(255 * std::clamp(channel, 0.0, 1.0))));
  return text;
}

std::string cameraJson(const Camera& camera) {
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  std::string pose;
  for (int r = 0; r < 3; ++r) {
    pose += r ? ",[" : "[";
    for (int c = 0; c < 4; ++c) pose += (c ? "," : "") + exactly(camera.camFromWorld.matrix()(r, c));
    pose += "]";
  }
  return "{\"width\":" + std::to_string(camera.width) + ",\"height\":" + std::to_string(camera.height) +
         ",\"fx\":" + exactly(k(0, 0)) + ",\"fy\":" + exactly(k(1, 1)) + ",\"cx\":" + exactly(k(0, 2)) +
         ",\"cy\":" + exactly(k(1, 2)) + ",\"skew\":" + exactly(k(0, 1)) + ",\"distorted\":" + truth(camera.hasDistortion()) +
         ",\"camera_from_world\":[" + pose + "]}";
}

/// Contours and peaks over the photograph, and a line of text for each model: as in every other picture of a frame.
std::string overlayJson(const Inspection& inspection, int frame) {
  using draw::OverlayRole;
  const std::set<OverlayRole> shown{OverlayRole::ObservedContour, OverlayRole::PredictedContour, OverlayRole::ObservedPeak,
                                    OverlayRole::PredictedPeak};
  draw::OverlayOptions options;
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    if (shown.count(layer.role) == 0) options.hidden.insert(layer.role);
  const draw::FrameOverlay overlay = draw::frameOverlay(inspection, frame, options);
  const auto line = [](const draw::OverlayLine& l) {
    return "{\"model\":" + quoted(l.model) + ",\"colour\":" + quoted(hexOf(l.colour)) + ",\"light\":" + quoted(l.light) +
           ",\"closed\":" + truth(l.closed) + ",\"dash\":" +
           std::to_string(l.dash == draw::Dash::Dashed       ? 1
                          : l.dash == draw::Dash::Dotted     ? 2
                          : l.dash == draw::Dash::DashDotted ? 3
                                                             : 0) +
           ",\"label\":" + quoted(l.label) + ",\"points\":" + Rounding::pixels(l.points) + "}";
  };
  std::vector<draw::OverlayMark> marks;
  for (const draw::OverlayMark& mark : overlay.marks)
    if (mark.at.allFinite()) marks.push_back(mark);
  const auto mark = [](const draw::OverlayMark& m) {
    return "{\"model\":" + quoted(m.model) + ",\"colour\":" + quoted(hexOf(m.colour)) + ",\"label\":" + quoted(m.label) +
           ",\"at\":" + Rounding::pixels({m.at}) + "}";
  };
  const auto caption = [](const draw::OverlayCaption& c) {
    return "{\"model\":" + quoted(c.model) + ",\"text\":" + quoted(c.text) + ",\"problem\":" + truth(c.problem) + "}";
  };
  return "\"lines\":" + array(overlay.lines, line) + ",\"marks\":" + array(marks, mark) +
         ",\"captions\":" + array(overlay.captions, caption);
}

/// What is set of a thing; its frame is the one that holds it.
std::string thingJson(const draw::SceneThing& t, const Rounding& rounding) {
  std::string json = std::string("{\"role\":\"") + draw::nameOf(t.role) + "\",\"model\":" + quoted(t.model) +
                     ",\"colour\":" + quoted(hexOf(draw::colourOf(t)));
  const auto add = [&](const char* name, bool isSet, const auto& text) {
    if (isSet) json += std::string(",\"") + name + "\":" + text();
  };
  const auto numbers = [](const auto& values) { return array(values.reshaped(), [](double value) { return exactly(value); }); };
  add("light", !t.light.empty(), [&] { return quoted(t.light); });
  add("surface", t.surface.has_value(), [&] { return quoted(*t.surface); });
  for (const auto& [name, value] : {std::pair("poor", t.poor), {"shared", t.shared}, {"gap", t.gap}})
    add(name, value, [] { return "true"; });
  add("label", !t.label.empty(), [&] { return quoted(t.label); });
  add("problem", !t.problem.empty(), [&] { return quoted(t.problem); });
  add("place", t.place.has_value(), [&] { return numbers(*t.place); });
  add("normal", !t.normal.isZero(), [&] { return numbers(t.normal); });
  add("radius", t.radius > 0, [&] { return rounding.world(t.radius); });
  add("chains", !t.chains.empty(), [&] { return chains(t.chains, rounding); });
  add("arrow", t.arrow.has_value(), [&] { return rounding.world(draw::WorldChain{t.arrow->first, t.arrow->second}); });
  add("ball", t.body.has_value(), [&] {
    const Eigen::Matrix<double, 3, 4> ball = draw::ballOf(*t.body, kLeastAxis).matrix().topRows<3>();
    return "[" + numbers(ball.row(0)) + "," + numbers(ball.row(1)) + "," + numbers(ball.row(2)) + "]";
  });
  return json + "}";
}

std::string thingsJson(draw::SceneDrawing things, const Rounding& rounding) {
  std::erase_if(things, [](const draw::SceneThing& t) { return t.mesh != nullptr; });  // the page has its own triangles
  return array(things, [&](const draw::SceneThing& t) { return thingJson(t, rounding); });
}

draw::DrawingOptions optionsFor(const draw::SceneScale& scale) {
  draw::DrawingOptions options;
  options.scale = scale;
  options.planeTimes = kDiscTimes;
  options.leastLamp = kRing * scale.point;
  options.mostPoints = kMostPoints;
  options.predictedMirrors = false;
  return options;
}

std::string frameJson(const Inspection& inspection, int frame, int surfaceIndex, const draw::SceneScale& scale,
                      const Rounding& rounding) {
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  const char* const role = inspection.isTraining(frame) ? "training" : inspection.isHeldOut(frame) ? "held out" : "excluded";
  // Per surface a frame both trains and is scored.
  std::string json = "{\"index\":" + std::to_string(frame) + ",\"id\":" + quoted(f.id) + ",\"role\":\"" + role +
                     "\",\"scored\":" + truth(inspection.isHeldOut(frame)) + ",\"surface\":" + std::to_string(surfaceIndex) +
                     ",\"camera\":" + cameraJson(f.camera) + "," + overlayJson(inspection, frame);
  std::shared_ptr<const Surface> surface;
  if (inspection.surfaces)
    if (const auto found = inspection.surfaces->surfaceOf(frame, meshPolicy(inspection.request.settings))) surface = *found;
  const draw::SceneDrawing things = draw::frameThings(inspection, frame, surface, optionsFor(scale));
  return json + ",\"things\":" + thingsJson(things, rounding) + "}";
}

}  // namespace

std::string framesJson(const Inspection& inspection, const std::vector<int>& frames, const SharedSurfaces& surfaces,
                       const draw::SceneScale& scale, const Rounding& rounding, const ProgressFn& progress) {
  std::string json;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!report(progress, {"frame", static_cast<int>(i), static_cast<int>(frames.size())})) throw Stopped{};
    json += (i ? ",\n" : "") + frameJson(inspection, frames[i], surfaces.ofFrame[i], scale, rounding);
  }
  return "[" + json + "]";
}

std::string sceneThingsJson(const Inspection& inspection, const draw::SceneScale& scale, const Rounding& rounding) {
  return thingsJson(draw::sceneThings(inspection, optionsFor(scale)), rounding);
}

std::string sizesJson(const draw::SceneScale& scale, const Rounding& rounding) {
  return "{\"centre\":" + rounding.world(Eigen::Vector3d(scale.surfaceBox.center())) +
         ",\"surface\":" + exactly(scale.surfaceSize) + ",\"scene\":" + exactly(scale.sceneSize) +
         ",\"point\":" + exactly(scale.point) + ",\"depth\":" + exactly(scale.cameraDepth) + "}";
}

}  // namespace glint::share
