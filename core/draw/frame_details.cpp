// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/frame_details.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/polyline.h"

namespace glint::draw {
namespace {

constexpr int kArrows = 36;
constexpr double kPi = 3.14159265358979323846;

Pixel towards(double direction) { return {std::cos(direction), std::sin(direction)}; }

/// Walks of one canonical contour, from its brightest point.
void addWalks(const CanonicalContour& contour, const Pixel& start, const Camera& camera, const OverlayLine& style,
              std::vector<OverlayLine>& lines) {
  for (const DirectionResult& direction : contour.directions) {
    if (!direction.limitAngle || direction.failure) continue;
    const std::optional<Pixel> onSurface = camera.project(direction.onSurface),
                               onPlane = camera.project(direction.onTangentPlane);
    if (!onSurface || !onPlane) continue;
    OverlayLine line = style;
    line.role = OverlayRole::LimitDirections;
    line.closed = false;
    line.halo = false;
    line.width = 1;
    line.points = toPhotograph(camera, {start, *onSurface});
    lines.push_back(line);
    line.dash = Dash::Dotted;
    line.width = 1.5;
    line.points = toPhotograph(camera, {*onSurface, *onPlane});
    lines.push_back(line);
  }
}

}  // namespace

std::vector<Pixel> toPhotograph(const Camera& camera, const std::vector<Pixel>& ideal) {
  if (!camera.hasDistortion()) return ideal;
  std::vector<Pixel> measured;
  measured.reserve(ideal.size());
  for (const Pixel& p : ideal) measured.push_back(camera.distorted(p));
  return measured;
}

std::optional<Pixel> directionOrigin(const Inspection& inspection, int frame, int highlight) {
  if (frame < 0 || static_cast<std::size_t>(frame) >= inspection.evidence.size()) return std::nullopt;
  const std::vector<Highlight>& observed = inspection.evidence[static_cast<std::size_t>(frame)].scored();
  if (highlight < 0 || static_cast<std::size_t>(highlight) >= observed.size()) return std::nullopt;
  const Highlight& h = observed[static_cast<std::size_t>(highlight)];
  return h.contour.points.empty() ? h.peak : centroid(h.contour);
}

int observedOf(const FrameComparison& comparison, int predicted) {
  for (const FrameComparison::Row& row : comparison.rows)
    if (row.predicted == predicted) return row.observed;
  return -1;
}

std::optional<Pixel> onPrediction(const PredictedHighlight& highlight, const Pixel& origin, double direction) {
  std::optional<double> farthest;
  for (const ContourRun& run : contourRuns(highlight)) {
    const std::optional<double> r = run.gap ? std::nullopt : reach({run.points, run.closed}, origin, direction);
    if (r && (!farthest || *r > *farthest)) farthest = r;
  }
  if (!farthest) return std::nullopt;
  return origin + *farthest * towards(direction);
}

void addResidualArrows(const Inspection& inspection, const FrameComparison& comparison, int predicted, const Camera& camera,
                       const OverlayLine& style, double scale, std::vector<OverlayLine>& lines) {
  const int observed = observedOf(comparison, predicted);
  const std::optional<Pixel> origin = directionOrigin(inspection, comparison.frame, observed);
  if (!origin) return;
  const Polyline& contour =
      inspection.evidence[static_cast<std::size_t>(comparison.frame)].scored()[static_cast<std::size_t>(observed)].contour;
  const PredictedHighlight& prediction = comparison.prediction.highlights()[static_cast<std::size_t>(predicted)];
  for (int i = 0; i < kArrows; ++i) {
    const double direction = 2 * kPi * i / kArrows;
    const std::optional<double> from = reach(contour, *origin, direction);
    const std::optional<Pixel> to = onPrediction(prediction, *origin, direction);
    if (!from || !to) continue;
    const Pixel tail = *origin + *from * towards(direction), tip = tail + scale * (*to - tail);
    const Pixel back = 0.3 * (tail - tip), side(-0.5 * back.y(), 0.5 * back.x());
    OverlayLine line = style;
    line.closed = false;
    line.points = toPhotograph(camera, {tail, tip, tip + back + side, tip, tip + back - side});
    lines.push_back(std::move(line));
  }
}

void addLimitDirections(const Inspection& inspection, int frame, const std::function<bool(const std::string&)>& drawn,
                        const Selection* selected, std::vector<OverlayLine>& lines) {
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  OverlayLine style;
  bool any = false;
  for (const TrainingView& view : inspection.views) {
    if (view.frame != frame || !view.canonical || !view.seen || !drawn(canonicalModel().id())) continue;
    style.model = canonicalModel().id();
    style.light = view.highlight.light;
    style.colour = canonicalColour();
    style.label = "walks of the observed contour";
    addWalks(*view.canonical, view.seen->brightest.pixel, camera, style, lines);
    any = true;
  }
  if (any) return;
  const auto walks = [&](const std::string& model) {
    const auto result = inspection.models.find(model);
    if (result == inspection.models.end() || !drawn(model)) return false;
    for (const FrameComparison& comparison : result->second.frames) {
      if (comparison.frame != frame) continue;
      for (const PredictedHighlight& h : comparison.prediction.highlights()) {
        if (!h.canonical || !h.brightest.pixel.allFinite()) continue;
        style.model = model;
        style.light = comparison.light;
        style.colour = modelColour(model);
        style.label = model + ": walks of the prediction";
        addWalks(*h.canonical, h.brightest.pixel, camera, style, lines);
        any = true;
      }
    }
    return any;
  };
  if (selected && walks(selected->model)) return;
  for (const std::string& model : modelsInOrder(inspection))
    if (walks(model)) return;
}

void addSelectedPoint(const Inspection& inspection, const Selection& selection, const std::function<bool(OverlayRole)>& shown,
                      const std::function<bool(const std::string&)>& drawn, std::vector<OverlayMark>& marks) {
  const int highlight = std::max(0, selection.highlight);
  const std::optional<Pixel> origin = directionOrigin(inspection, selection.frame, highlight);
  if (!origin || !selection.direction) return;
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(selection.frame)].camera;
  OverlayMark mark;
  mark.role = OverlayRole::SelectedPoint;
  mark.shape = MarkShape::Circle;
  mark.highlight = highlight;
  const auto add = [&](const Pixel& ideal, const Colour& colour, const std::string& model, double size) {
    mark.at = toPhotograph(camera, {ideal}).front();
    mark.colour = colour;
    mark.model = model;
    mark.size = size;
    mark.width = 2;
    mark.label = "selected contour point" + (model.empty() ? std::string{} : ", " + model);
    marks.push_back(mark);
  };
  const Highlight& observed =
      inspection.evidence[static_cast<std::size_t>(selection.frame)].scored()[static_cast<std::size_t>(highlight)];
  if (const std::optional<double> r = reach(observed.contour, *origin, *selection.direction);
      r && shown(OverlayRole::ObservedContour))
    add(*origin + *r * towards(*selection.direction), kObserved, "", 6);
  if (!shown(OverlayRole::PredictedContour)) return;
  for (const std::string& model : modelsInOrder(inspection)) {
    if (!drawn(model)) continue;
    for (const FrameComparison& comparison : inspection.models.at(model).frames) {
      if (comparison.frame != selection.frame) continue;
      for (std::size_t i = 0; i < comparison.prediction.highlights().size(); ++i) {
        if (observedOf(comparison, static_cast<int>(i)) != highlight) continue;
        const std::optional<Pixel> at = onPrediction(comparison.prediction.highlights()[i], *origin, *selection.direction);
        if (at) add(*at, modelColour(model), model, model == selection.model ? 6 : 4.5);
      }
    }
  }
}

}  // namespace glint::draw
