// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include "core/draw/frame_overlay.h"
#include "core/draw/selection.h"
#include "core/geometry/polyline.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr std::size_t kMostObservedFrames = 24;  ///< the training frames of a long sequence would cover the surface

// How far contours are drawn before the surface that they lie on, see Drawn::nearerPx: half of a line's width where the surface
// slants away by 70 degrees, and a little more for what is to show above the others.
constexpr double kObservedPx = 5, kSelectedPx = 5.5, kPredictedPx = 6, kNextModelPx = 0.25, kMarkPx = 12;

/// Every third segment of the chains.
std::vector<Points> dots(const std::vector<Points>& chains) {
  std::vector<Points> result;
  for (const Points& chain : chains) {
    for (std::size_t i = 1; i + 1 < chain.size(); i += 3) result.push_back({chain[i], chain[i + 1]});
  }
  return result;
}

/// The chains in dashes: `pattern` says how many parts of a dash's length are drawn and left out in turn.
std::vector<Points> inDashes(const std::vector<Points>& chains, double dash, const std::vector<double>& pattern) {
  std::vector<Points> result;
  for (const Points& chain : chains) {
    std::size_t at = 0;
    double left = pattern[0] * dash;
    Points piece;
    if (!chain.empty()) piece.push_back(chain.front());
    for (std::size_t i = 1; i < chain.size(); ++i) {
      Eigen::Vector3d from = chain[i - 1];
      double length = (chain[i] - from).norm();
      while (length > left) {
        from += (chain[i] - from) * (left / length);
        length = (chain[i] - from).norm();
        if (at % 2 == 0) {
          piece.push_back(from);
          result.push_back(piece);
        }
        piece = {from};
        at = (at + 1) % pattern.size();
        left = pattern[at] * dash;
      }
      left -= length;
      if (at % 2 == 0) piece.push_back(chain[i]);
    }
    if (at % 2 == 0 && piece.size() > 1) result.push_back(piece);
  }
  return result;
}

/// A dash: a sixteenth of the contour that it is of, so that small ones show some.
double dashOf(const std::vector<Points>& chains) {
  constexpr int kDashes = 16;
  double length = 0;
  for (const Points& chain : chains)
    for (std::size_t i = 1; i < chain.size(); ++i) length += (chain[i] - chain[i - 1]).norm();
  return std::max(length / kDashes, 1e-12);
}
const std::vector<double> kMissedDashes{0.6, 0.4}, kSpuriousDashes{0.9, 0.35, 0.2, 0.35}, kPoorDashes{0.5, 0.5};

std::vector<int> observedFrames(const LayerInput& in) {
  std::vector<int> frames;
  for (const TrainingView* view : in.views()) frames.push_back(view->frame);
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  const std::size_t n = frames.size(), count = std::min(n, kMostObservedFrames);
  std::set<int> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.insert(frames[i * n / count]);
  if (in.shows(in.selection.frame)) chosen.insert(in.selection.frame);
  return {chosen.begin(), chosen.end()};
}

/// The selected direction on a contour: a ball in its colour within a ring of ink.
void addMark(LayerContent& content, const LayerInput& in, const Camera& camera, const Highlight& observed,
             const Polyline& contour, const Colour& colour, const Picked& info) {
  const std::optional<Pixel> vertex = vertexInDirection(camera, observed, contour, *in.selection.direction);
  if (!vertex) return;
  const std::optional<Eigen::Vector3d> at = castPixel(camera, *in.surface, *vertex, 0);
  if (!at) return;
  const double r = in.scale.point;
  const Eigen::Matrix3d axes = camera.camFromWorld.linear();
  content.addOnSurface(sphereActor({*at}, 0.8 * r, colour), info, 0, kMarkPx);
  content.addOnSurface(
      lineActor({circle(*at, 1.7 * r * axes.row(0).transpose(), 1.7 * r * axes.row(1).transpose(), 32)}, in.ink(), 2), info, 2,
      kMarkPx);
}

/// What directions of a frame's selected highlight are measured from: the selected one, else the first of the light, else the
/// first.
const Highlight* selectedHighlight(const LayerInput& in, const std::string& light) {
  const auto frame = static_cast<std::size_t>(in.selection.frame);
  if (frame >= in.inspection->evidence.size()) return nullptr;
  const std::vector<Highlight>& highlights = in.inspection->evidence[frame].highlights;
  if (in.selection.highlight >= 0 && in.selection.highlight < static_cast<int>(highlights.size())) {
    const Highlight& h = highlights[static_cast<std::size_t>(in.selection.highlight)];
    return light.empty() || h.light == light ? &h : nullptr;
  }
  for (const Highlight& h : highlights) {
    if (light.empty() || h.light == light) return &h;
  }
  return nullptr;
}

/// Which models miss an observed highlight of the selected frame; "" if none does.
std::string modelsThatMiss(const LayerInput& in, int observed) {
  std::string names;
  const std::set<std::string> shown(in.models.begin(), in.models.end());
  for (const std::string& model : draw::missedBy(*in.inspection, in.selection.frame, observed, [&](const std::string& m) {
         return shown.count(m) > 0 && (in.selection.model.empty() || in.selection.model == m);
       }))
    names += (names.empty() ? "" : ", ") + model;
  return names;
}

}  // namespace

LayerContent observedContoursLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.surface) return content;
  for (const int index : observedFrames(in)) {
    if (static_cast<std::size_t>(index) >= in.inspection->evidence.size()) continue;
    const Camera& camera = in.frame(index).camera;
    const std::vector<Highlight>& highlights = in.inspection->evidence[static_cast<std::size_t>(index)].highlights;
    const bool selected = index == in.selection.frame;
    for (std::size_t i = 0; i < highlights.size(); ++i) {
      const Highlight& h = highlights[i];
      Picked info;
      info.layer = "observed-contours";
      info.frame = index;
      info.highlight = static_cast<int>(i);
      info.light = h.light;
      info.text = line("observed highlight of frame", in.frame(index).id) + line("light", h.light) + line("level", h.level) +
                  line("area", h.areaPx2, "px^2") + line("peak x", h.peak.x(), "px") + line("peak y", h.peak.y(), "px");
      const bool strong = selected && (in.selection.highlight < 0 || in.selection.highlight == static_cast<int>(i));
      const double width = strong ? 3.0 : 1.2;
      const Colour colour = selected ? kObserved : Colour{0.80, 0.82, 0.84};
      std::vector<Points> chains = castContour(camera, *in.surface, h.contour, in.scale, 0);
      if (selected && !in.inspection->evidence[static_cast<std::size_t>(index)].againstTruth)
        if (const std::string missed = modelsThatMiss(in, static_cast<int>(i)); !missed.empty()) {
          info.text += line("missed by", missed);
          chains = inDashes(chains, dashOf(chains), kMissedDashes);
        }
      content.addOnSurface(lineActor(chains, colour, width), info, width, selected ? kSelectedPx : kObservedPx);
      if (selected && in.selection.direction && &h == selectedHighlight(in, ""))
        addMark(content, in, camera, h, h.contour, kObserved, info);
    }
  }
  return content;
}

namespace {
/// What a filter took out: thin, dotted, faint.
void addGhost(LayerContent& content, const LayerInput& in, const std::string& model, const FilteredHighlight& f,
              double nearerPx) {
  Picked info;
  info.layer = "predicted-contours";
  info.frame = in.selection.frame;
  info.model = model;
  info.text = line("filtered prediction", model) + line("reason", f.reason);
  const Colour colour = modelColour(model, true);
  const std::vector<Points> chains =
      castContour(in.frame(in.selection.frame).camera, *in.surface, f.highlight.contour, in.scale, 0);
  content.addOnSurface(lineActor(inDashes(chains, dashOf(chains), {0.2, 0.4}), colour, 1), info, 1, nearerPx);
}
}  // namespace

LayerContent predictedContoursLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.surface) return content;
  const Camera& camera = in.frame(in.selection.frame).camera;
  double nearerPx = kPredictedPx;               // each model a little more, so that equal contours do not flicker
  std::vector<std::string> models = in.models;  // the selected one last, on top of the others
  std::stable_partition(models.begin(), models.end(), [&](const std::string& m) { return m != in.selection.model; });
  for (const std::string& model : models) {
    for (const FrameComparison* comparison : in.comparisons(model)) {
      const bool poor = in.isPoor(model, *comparison);  // pale and dashed, as in the frames
      const Colour colour = modelColour(model, poor);
      for (std::size_t i = 0; i < comparison->prediction.highlights().size(); ++i) {
        const PredictedHighlight& h = comparison->prediction.highlights()[i];
        Picked info;
        info.layer = "predicted-contours";
        info.frame = in.selection.frame;
        info.model = model;
        info.light = comparison->light;
        for (const FrameComparison::Row& row : comparison->rows) {
          if (row.predicted == static_cast<int>(i)) info.highlight = row.observed;
        }
        const bool spurious = draw::isSpurious(*comparison, static_cast<int>(i));
        if (spurious) info.predicted = static_cast<int>(i);
        info.text = line(spurious ? "spurious prediction" : "prediction", model) +
                    line("frame", in.frame(in.selection.frame).id) + line("light", comparison->light) +
                    line("coverage", h.coverage) + line("IoU", comparison->iou);
        if (poor) info.text += line("poor", poorFit(in.inspection->models.at(model), *comparison));
        for (const FrameComparison::Row& row : comparison->rows) {
          if (row.predicted != static_cast<int>(i) || !row.metrics) continue;
          info.text += line("contour error", row.metrics->contourErrorPct, "%") +
                       line("contour error", row.metrics->contourErrorPx, "px") +
                       line("Hausdorff", row.metrics->hausdorffPx, "px") + line("peak offset", row.metrics->peakOffsetPx, "px");
        }
        const std::vector<SceneThing> parts = predictedContourThings(camera, *in.surface, h, in.scale.surfaceSize);
        const Highlight* observed = in.selection.direction ? selectedHighlight(in, comparison->light) : nullptr;
        if (observed && (in.selection.highlight < 0 || in.selection.highlight == info.highlight))
          addMark(content, in, camera, *observed, h.contour, colour, info);
        const bool chosen = spurious && in.selection.highlight < 0 && in.selection.predicted == static_cast<int>(i) &&
                            in.selection.model == model && in.selection.light == comparison->light;
        const double width = chosen ? 4.4 : in.selection.model == model ? 3.4 : 2.2;  // the selected model stands out
        std::vector<Points> chains = parts.front().chains;
        if (spurious || poor) chains = inDashes(chains, dashOf(chains), spurious ? kSpuriousDashes : kPoorDashes);
        if (!chains.empty()) content.addOnSurface(lineActor(chains, colour, width), info, width, nearerPx);
        if (parts.size() > 1) {
          info.text += line("this part", "not predicted; bridges failed directions");
          content.addOnSurface(lineActor(dots(parts.back().chains), colour, 1.5), info, 1.5, nearerPx);
        }
      }
    }
    for (const FrameComparison* comparison : in.comparisons(model))
      for (const FilteredHighlight& f : comparison->prediction.filtered) addGhost(content, in, model, f, nearerPx);
    nearerPx += kNextModelPx;
  }
  return content;
}

}  // namespace glint::viz
