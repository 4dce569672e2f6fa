// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/on_surface.h"
#include "core/fit/training.h"
#include "core/inspect/summary.h"
#include "core/report/share_parts.h"
#include "core/surface/mesh_policy.h"

namespace glint::share {
namespace {

constexpr double kDiscTimes = 1.5;  // of the contour: a page shows the discs of all frames at once

constexpr int kMostPoints = 180;  ///< of a contour in 3D: chords of 2 degrees are round on a screen

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

/// The views of a frame: those that train, else what was observed in it, with canonical contours where its light is known.
std::vector<TrainingView> viewsIn(const Inspection& inspection, int frame, const std::shared_ptr<const Surface>& surface) {
  std::vector<TrainingView> views;
  for (const TrainingView& view : inspection.views)
    if (view.frame == frame && view.seen) views.push_back(view);
  if (!views.empty() || !surface) return views;
  const FrameEvidence& evidence = inspection.evidence[static_cast<std::size_t>(frame)];
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  for (std::size_t i = 0; i < evidence.highlights.size(); ++i) {
    TrainingView view = trainingView(evidence, static_cast<int>(i), camera, surface);
    if (!view.seen) continue;
    if (const LightEstimate* const light = inspection.lightFor(frame, view.highlight.light))
      addCanonicalContour(view, light->light, inspection.request.settings);
    views.push_back(std::move(view));
  }
  return views;
}

/// Tangent plane and canonical ellipse of a view; the page makes the virtual camera of them.
std::string mirrorJson(const TrainingView& view, double surfaceSize, const Rounding& rounding) {
  const Plane& plane = view.seen->tangentPlane;
  const Eigen::Vector3d& at = view.seen->brightest.point.position;
  const bool ellipse = view.canonical && view.canonical->ellipse;
  return "{\"light\":" + quoted(view.highlight.light) + ",\"at\":" + rounding.world(at) + ",\"normal\":[" +
         exactly(plane.normal.x()) + "," + exactly(plane.normal.y()) + "," + exactly(plane.normal.z()) +
         "],\"offset\":" + exactly(plane.offset) + ",\"radius\":" +
         rounding.world(draw::planeRadius(view.camera, plane, at, view.highlight.contour.points, surfaceSize, kDiscTimes)) +
         ",\"ellipse\":" +
         (ellipse ? chains(draw::ellipseOnPlane(view.camera, plane, *view.canonical->ellipse, 0), rounding) : "[]") + "}";
}

/// Contours on the surface: of the observation, then of each model.
std::string onSurfaceJson(const Inspection& inspection, int frame, const Surface& surface, double surfaceSize,
                          const Rounding& rounding) {
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  std::vector<std::string> all;
  const auto add = [&](const std::string& model, Polyline contour, const draw::Colour& colour, bool dashed) {
    contour.points = thinned(contour, kMostPoints);
    all.push_back("{\"model\":" + quoted(model) + ",\"colour\":" + quoted(hexOf(colour)) + ",\"dashed\":" + truth(dashed) +
                  ",\"chains\":" + chains(draw::castContour(camera, surface, contour, surfaceSize, 0), rounding) + "}");
  };
  for (const Highlight& h : inspection.evidence[static_cast<std::size_t>(frame)].scored())
    if (h.contour.points.size() > 1) add("", h.contour, draw::kObserved, false);
  for (const std::string& name : modelsInOrder(inspection))
    for (const FrameComparison& comparison : inspection.models.at(name).frames) {
      if (comparison.frame != frame) continue;
      const bool poor = !poorFit(inspection.models.at(name), comparison).empty();
      const draw::Colour colour = draw::modelColour(name, poor);
      for (const PredictedHighlight& h : comparison.prediction.highlights())
        for (const draw::ContourRun& run : draw::contourRuns(h)) add(name, {run.points, run.closed}, colour, run.gap || poor);
    }
  return array(all, [](const std::string& text) { return text; });
}

std::string frameJson(const Inspection& inspection, int frame, int surfaceIndex, double surfaceSize, const Rounding& rounding) {
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  const char* const role = inspection.isTraining(frame) ? "training" : inspection.isHeldOut(frame) ? "held out" : "excluded";
  // Per surface a frame both trains and is scored.
  std::string json = "{\"index\":" + std::to_string(frame) + ",\"id\":" + quoted(f.id) + ",\"role\":\"" + role +
                     "\",\"scored\":" + truth(inspection.isHeldOut(frame)) + ",\"surface\":" + std::to_string(surfaceIndex) +
                     ",\"camera\":" + cameraJson(f.camera) + "," + overlayJson(inspection, frame);
  std::shared_ptr<const Surface> surface;
  if (inspection.surfaces)
    if (const auto found = inspection.surfaces->surfaceOf(frame, meshPolicy(inspection.request.settings))) surface = *found;
  json += ",\"mirrors\":" + array(viewsIn(inspection, frame, surface),
                                  [&](const TrainingView& view) { return mirrorJson(view, surfaceSize, rounding); });
  json += ",\"on_surface\":" + (surface ? onSurfaceJson(inspection, frame, *surface, surfaceSize, rounding) : "[]");
  return json + "}";
}

std::string vectorJson(const Eigen::Vector3d& v) {
  return "[" + exactly(v.x()) + "," + exactly(v.y()) + "," + exactly(v.z()) + "]";
}

}  // namespace

std::string framesJson(const Inspection& inspection, const std::vector<int>& frames, const SharedSurfaces& surfaces,
                       const Rounding& rounding, const ProgressFn& progress) {
  std::string json;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!report(progress, {"frame", static_cast<int>(i), static_cast<int>(frames.size())})) throw Stopped{};
    const int surface = surfaces.ofFrame[i];
    const double size = surface >= 0 ? surfaces.size[static_cast<std::size_t>(surface)] : 0;
    json += (i ? ",\n" : "") + frameJson(inspection, frames[i], surface, size, rounding);
  }
  return "[" + json + "]";
}

std::string lightsJson(const Inspection& inspection) {
  std::string json;
  for (const auto& [key, outcome] : inspection.lights) {
    if (!outcome) continue;
    const Light& light = outcome->light;
    json += (json.empty() ? "" : ",") + std::string("{\"id\":") + quoted(key.light) +
            ",\"surface\":" + (key.surface ? quoted(*key.surface) : "null") + ",\"homogeneous\":[" +
            exactly(light.homogeneous()[0]) + "," + exactly(light.homogeneous()[1]) + "," + exactly(light.homogeneous()[2]) +
            "," + exactly(light.homogeneous()[3]) + "]}";
  }
  return "[" + json + "]";
}

std::string trueLightsJson(const Inspection& inspection) {
  return array(inspection.scene->lights, [](const TrueLight& light) {
    std::string json = "{\"id\":" + quoted(light.id) + ",\"radius\":" + exactly(radiusOf(light.lamp));
    for (const LampField& f : fieldsOf(light.lamp)) {
      if (f.value.size() == 1) continue;
      std::string points;
      for (const auto& point : f.value.rowwise()) points += (points.empty() ? "" : ",") + vectorJson(point.transpose());
      json += ",\"" + f.name + "\":" + (f.value.rows() == 1 ? points : "[" + points + "]");
    }
    return json + "}";
  });
}

}  // namespace glint::share
