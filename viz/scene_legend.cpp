// SPDX-License-Identifier: BSD-3-Clause
#include "viz/scene_legend.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "core/base/number_text.h"
#include "core/draw/frame_overlay.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/summary.h"
#include "core/scene/scene_files.h"
#include "viz/style.h"

namespace glint::viz {
namespace {

std::string useOf(const Inspection& inspection, int frame) {
  return inspection.isTraining(frame) ? "training" : inspection.isHeldOut(frame) ? "held out" : "excluded";
}

void addCameras(SceneLegend& legend, const LayerInput& in) {
  if (in.inspection->lightFrame.frame == LightFrame::Camera)
    legend.remarks.push_back("drawn in the camera's coordinates: the object moves");
  if (in.colours.by == CameraColours::By::Error) {
    const std::string model = errorModel(in);
    if (!model.empty()) legend.bar = errorBar(model);
  }
  if (in.colours.by == CameraColours::By::Influence) {
    if (in.colours.influence.empty()) {
      legend.remarks.push_back("cameras: influence not measured for these settings (Plots > Measure influence of frames)");
    } else if (const double most = mostInfluence(in.colours); most > 0) {
      legend.bar = influenceBar(in.colours.model, most);
    } else {
      legend.remarks.push_back("cameras: leaving out a frame does not change the error of " + in.colours.model);
    }
  }
  std::vector<CameraColour> kinds;
  for (const int frame : in.frames) {
    const CameraColour c = cameraColour(in, frame);
    if (c.meaning.empty()) continue;  // on the scale
    if (std::none_of(kinds.begin(), kinds.end(), [&](const CameraColour& k) { return k.meaning == c.meaning; }))
      kinds.push_back(c);
  }
  if (in.colours.by == CameraColours::By::Role)
    std::sort(kinds.begin(), kinds.end(), [](const CameraColour& a, const CameraColour& b) { return a.meaning > b.meaning; });
  for (const CameraColour& kind : kinds) legend.entries.push_back({kind.colour, kind.meaning});
}

/// The reason is that a fit of the model is no ellipsoid.
bool isItsQuadric(const LayerInput& in, const std::string& model, const std::string& reason) {
  const std::vector<const ModelFit*> fits = in.fits(model);
  return std::any_of(fits.begin(), fits.end(), [&](const ModelFit* fit) {
    const EllipsoidFit* const e = fit->as<EllipsoidFit>();
    return e && !e->ellipsoid && reason == Failure{Reason::NotAnEllipsoid, describe(e->quadric)}.message();
  });
}

/// What is said of lights that move.
std::string movesText(const LightFrameChoice& choice) {
  if (!choice.elsewhere.empty()) return ", some move with the camera";
  return choice.frame == LightFrame::Camera ? ", moves with the camera" : "";
}

std::string statedLightText(const Scene& scene) {
  const bool known = std::any_of(scene.lights.begin(), scene.lights.end(), [](const TrueLight& l) { return l.known; });
  return known ? "light (known)" : "light (truth)";
}

}  // namespace

SceneLegend legendOf(const LayerInput& in, const std::vector<ShownLayer>& layers) {
  SceneLegend legend;
  const std::vector<Layer>& names = sceneLayers();
  const auto shown = [&](std::string_view name) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == name) return layers[i].visible;
    }
    return false;
  };
  const auto drawn = [&](std::string_view name) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].name == name) return layers[i].visible && !layers[i].content->drawn.empty();
    }
    return false;
  };
  if (drawn("cameras")) addCameras(legend, in);
  if (drawn("virtual-cameras") || drawn("tangent-planes"))
    legend.entries.push_back({kVirtualCamera, "virtual camera, tangent plane"});
  if (drawn("observed-contours")) legend.entries.push_back({kObserved, "observed contour"});
  // Said once, for all lights in sight.
  std::string carried = movesText(in.inspection->lightFrame);
  if (drawn("light")) legend.entries.push_back({kLightColour, "light (estimate)" + std::exchange(carried, "")});
  if (drawn("true-light")) legend.entries.push_back({kTruth, statedLightText(*in.inspection->scene) + carried});
  if (drawn("measured-lamps")) legend.entries.push_back({kMeasuredLamp, "measured lamp, 95 % region"});
  if (drawn("solver-runs")) legend.entries.push_back({in.ink(), "runs of a solver: hollow start, full end"});
  std::string noEvidence;
  if (const auto at = static_cast<std::size_t>(in.selection.frame); at < in.inspection->evidence.size()) {
    const std::optional<Failure>& failure = in.inspection->evidence[at].scoringFailure();
    if (failure && failure->reason == Reason::FrameUnreadable) {
      noEvidence = failure->message();
      legend.notes.push_back(withoutFolder(noEvidence, *in.inspection->scene));
    }
  }
  if (shown("predicted-contours") || shown("ellipsoids")) {
    for (const std::string& model : in.models) {
      const ModelResult& result = in.inspection->models.at(model);
      const FrameScore score = frameScore(result, in.selection.frame);
      const bool poor = !reasonsOf(result).poor.empty();
      const std::string error = score.missed > 0 && score.matched > 0 ? "  " + missedText(score)
                                : score.errorPct                      ? "  " + errorText(*score.errorPct) + " %"
                                                                      : "";
      legend.entries.push_back({draw::modelColour(model, poor), model + error + (poor ? ", poor" : ""), true});
      // A fault of the frame itself is listed once, not for every model; a fit that is no ellipsoid by its layer.
      if (!score.errorPct && !score.reason.empty() && score.reason != noEvidence &&
          !(shown("ellipsoids") && isItsQuadric(in, model, score.reason)))
        legend.notes.push_back(model + ": " + score.reason);
    }
  }
  for (const ShownLayer& layer : layers) {
    if (!layer.visible) continue;
    for (const std::string& note : layer.content->notes)  // the fits of several lights may have the same fault
      if (std::find(legend.notes.begin(), legend.notes.end(), note) == legend.notes.end()) legend.notes.push_back(note);
    legend.remarks.insert(legend.remarks.end(), layer.content->remarks.begin(), layer.content->remarks.end());
  }
  if (const std::size_t hidden = in.hidden.count(); hidden > 0)
    legend.remarks.push_back(std::to_string(hidden) + (hidden == 1 ? " object hidden" : " objects hidden"));
  legend.title = in.inspection->scene->name + ", frame " + in.frame(in.selection.frame).id + " (" +
                 useOf(*in.inspection, in.selection.frame) + ")";
  return legend;
}

}  // namespace glint::viz
