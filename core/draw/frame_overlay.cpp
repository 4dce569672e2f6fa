// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/frame_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error_text.h"
#include "core/base/number_text.h"
#include "core/draw/frame_details.h"
#include "core/scene/scene_files.h"

namespace glint::draw {
namespace {

constexpr Colour kObservedEllipse{0.82, 0.82, 0.82};

/// Both borders of the 95 % band, where it is known and wide enough to be seen beside the contour.
void addBand(const PredictedHighlight& highlight, const Camera& camera, const OverlayLine& style,
             std::vector<OverlayLine>& lines) {
  constexpr double kFactor = 1.96;  // many degrees of freedom; the exact factor differs by less than a line's width
  constexpr double kVisiblePx = 0.5;
  const std::vector<Pixel>& p = highlight.contour.points;
  const std::vector<double>& sigma = highlight.sigmaPx;
  const std::size_t n = p.size();
  if (n < 3 || sigma.size() != n || !(kFactor * *std::max_element(sigma.begin(), sigma.end()) >= kVisiblePx)) return;
  for (const double side : {-kFactor, kFactor}) {
    std::vector<Pixel> border;
    for (std::size_t i = 0; i < n; ++i) {
      const Pixel tangent = p[(i + 1) % n] - p[(i + n - 1) % n];
      const double length = tangent.norm();
      if (length > 0) border.push_back(p[i] + side * sigma[i] / length * Pixel(tangent.y(), -tangent.x()));
    }
    lines.push_back(style);
    lines.back().role = OverlayRole::UncertaintyBand;
    lines.back().points = toPhotograph(camera, border);
    lines.back().closed = highlight.contour.closed;
    lines.back().width = std::max(0.75, 0.4 * style.width);
    lines.back().halo = false;
    lines.back().dash = Dash::Dotted;
    lines.back().label = style.label.empty() ? "" : style.label + ", 95 % band";
  }
}

void addPrediction(const PredictedHighlight& highlight, const Camera& camera, const OverlayLine& style,
                   std::vector<OverlayLine>& lines) {
  for (const ContourRun& run : contourRuns(highlight)) {
    lines.push_back(style);
    OverlayLine& line = lines.back();
    line.points = toPhotograph(camera, run.points);
    line.closed = run.closed;
    if (run.gap) {
      line.dash = Dash::Dotted;
      line.width = std::max(1.0, style.width - 0.5);
    }
  }
}

std::string scoreText(const std::string& model, const FrameScore& score) {
  std::string text = model;
  if (score.errorPct) text += "  " + errorText(*score.errorPct) + " %";
  if (score.errorPx) text += "  " + errorText(*score.errorPx) + " px";
  if (score.iou && score.matched > 0) text += "  IoU " + formatted("%.3f", *score.iou);
  if (score.missed > 0) text += "  missed " + std::to_string(score.missed);
  if (score.spurious > 0) text += "  spurious " + std::to_string(score.spurious);
  if (!score.reason.empty()) text += "  " + score.reason;
  return text;
}

}  // namespace

const std::vector<OverlayLayer>& overlayLayers() {
  static const std::vector<OverlayLayer> layers{
      {OverlayRole::ObservedContour, "frame/observed", "Observed",
       "Contour detected in the photograph at the contour level: white", true},
      {OverlayRole::ObservedEllipse, "frame/observed-ellipse", "Ellipse", "Ellipse fitted to the observed contour: grey, dashed",
       true},
      {OverlayRole::PredictedContour, "frame/predicted", "Predicted",
       "Contour predicted by each model, in its colour: dashed in frames not used for training, dotted where directions failed",
       true},
      {OverlayRole::PredictedEllipse, "frame/predicted-ellipse", "Pred. ellipse",
       "Ellipse fitted to each predicted contour, dashed", true},
      {OverlayRole::UncertaintyBand, "frame/band", "Band",
       "95 % band of each predicted contour, if Predict > Uncertainty band is on and the band is wider than half a pixel", true},
      {OverlayRole::CanonicalEllipse, "frame/canonical", "Canonical",
       "Ellipse of the canonical contour on the tangent plane, dotted: observed in training frames, predicted elsewhere", true},
      {OverlayRole::ObservedPeak, "frame/peak", "Peaks", "Observed peak: cross; predicted brightest points: circles", true},
      {OverlayRole::ResidualArrows, "frame/residuals", "Residuals",
       "Arrows from the observed to the predicted contour, every 10 degrees", false},
      {OverlayRole::LimitDirections, "frame/directions", "Directions",
       "Walks from the brightest point: to the limit angle on the surface; dotted: on to the same angle on the tangent plane",
       false}};
  return layers;
}

std::vector<ContourRun> contourRuns(const PredictedHighlight& highlight) {
  const std::vector<Pixel>& points = highlight.contour.points;
  const int n = static_cast<int>(points.size());
  if (n < 2) return {};
  const int segments = highlight.contour.closed ? n : n - 1;
  std::vector<char> isGap(static_cast<std::size_t>(segments), 0);
  for (const auto& [from, to] : highlight.gaps) {
    for (int i = from; i != to && i >= 0 && i < n; i = (i + 1) % n) {
      if (i < segments) isGap[static_cast<std::size_t>(i)] = 1;
    }
  }
  if (std::find(isGap.begin(), isGap.end(), 1) == isGap.end()) return {{points, highlight.contour.closed, false}};
  // Start right after a change of kind, so that no run is cut where the vertex list happens to begin.
  int start = 0;
  if (highlight.contour.closed) {
    while (start < segments &&
           isGap[static_cast<std::size_t>(start)] == isGap[static_cast<std::size_t>((start + segments - 1) % segments)])
      ++start;
    start %= segments;
  }
  std::vector<ContourRun> runs;
  for (int done = 0; done < segments;) {
    const char kind = isGap[static_cast<std::size_t>((start + done) % segments)];
    ContourRun run;
    run.gap = kind != 0;
    run.points.push_back(points[static_cast<std::size_t>((start + done) % n)]);
    while (done < segments && isGap[static_cast<std::size_t>((start + done) % segments)] == kind) {
      ++done;
      run.points.push_back(points[static_cast<std::size_t>((start + done) % n)]);
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

Eigen::AlignedBox2d extentAround(const FrameOverlay& overlay, OverlayRole role, const Pixel& pixel) {
  Eigen::AlignedBox2d all;
  for (const OverlayLine& line : overlay.lines) {
    if (line.role != role || !line.closed) continue;
    Eigen::AlignedBox2d box;
    for (const Pixel& p : line.points)
      if (p.allFinite()) box.extend(p);
    if (!box.isEmpty() && box.contains(pixel)) all.extend(box);
  }
  return all;
}

FrameOverlay frameOverlay(const Inspection& inspection, int frame, const OverlayOptions& options) {
  require(inspection.scene && frame >= 0 && frame < static_cast<int>(inspection.scene->frames.size()),
          "frameOverlay: no such frame");
  require(options.ellipseSegments >= 8, "frameOverlay: ellipseSegments < 8");
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  const auto shown = [&](OverlayRole role) { return !options.hidden.count(role); };
  const auto ellipsePoints = [&](const Ellipse& e) { return toPhotograph(camera, e.sample(options.ellipseSegments)); };
  FrameOverlay overlay;
  const Selection* selected = options.selection && options.selection->frame == frame ? &*options.selection : nullptr;
  const bool training = inspection.isTraining(frame);
  const Colour roleColour = training ? kTraining : inspection.isHeldOut(frame) ? kHeldOut : kExcluded;
  const auto drawn = [&](const std::string& model) {
    return !options.hiddenModels.count(model) && (options.models.empty() || options.models.count(model));
  };

  std::optional<Failure> unreadable;
  if (static_cast<std::size_t>(frame) < inspection.evidence.size()) {
    const FrameEvidence& evidence = inspection.evidence[static_cast<std::size_t>(frame)];
    const std::vector<Highlight>& observed = evidence.scored();  // what the rows of the comparison refer to
    for (std::size_t i = 0; i < observed.size(); ++i) {
      const Highlight& h = observed[i];
      OverlayLine line;
      line.light = h.light;
      line.highlight = static_cast<int>(i);
      line.label = "observed" + (h.light.empty() ? std::string{} : " " + h.light);
      if (shown(OverlayRole::ObservedContour) && h.contour.points.size() > 1) {
        line.role = OverlayRole::ObservedContour;
        line.points = toPhotograph(camera, h.contour.points);
        line.closed = h.contour.closed;
        line.colour = kObserved;
        line.width = selected && selected->highlight == static_cast<int>(i) ? 3.5 : 2.5;
        line.halo = true;
        overlay.lines.push_back(line);
      }
      if (shown(OverlayRole::ObservedEllipse) && h.ellipse) {
        line.role = OverlayRole::ObservedEllipse;
        line.points = ellipsePoints(*h.ellipse);
        line.closed = true;
        line.colour = kObservedEllipse;
        line.width = 1;
        line.halo = false;
        line.dash = Dash::Dashed;
        line.label = "ellipse of the observed contour";
        overlay.lines.push_back(line);
      }
      if (shown(OverlayRole::ObservedPeak)) {
        OverlayMark mark;
        mark.at = toPhotograph(camera, {h.peak}).front();
        mark.colour = kObserved;
        mark.light = h.light;
        mark.highlight = static_cast<int>(i);
        mark.label = h.clipped ? "centre of a clipped highlight" : "observed peak";
        overlay.marks.push_back(mark);
      }
    }
    if (evidence.failure && evidence.failure->reason == Reason::FrameUnreadable) unreadable = evidence.failure;
    if (evidence.failure)
      overlay.captions.push_back(
          {kObserved, "", "observed: " + withoutFolder(evidence.failure->message(), *inspection.scene), true, {}});
  }
  // The canonical contour of a training view lies on its tangent plane; its ellipse in the photograph is what the fit uses.
  if (shown(OverlayRole::CanonicalEllipse)) {
    for (const TrainingView& view : inspection.views) {
      if (view.frame != frame || !view.canonical || !view.canonical->ellipse) continue;
      if (!drawn(canonicalModel().id())) continue;
      OverlayLine line;
      line.role = OverlayRole::CanonicalEllipse;
      line.points = ellipsePoints(*view.canonical->ellipse);
      line.closed = true;
      line.colour = canonicalColour();
      line.width = 1;
      line.dash = Dash::Dotted;
      line.label = "canonical ellipse on the tangent plane";
      line.light = view.highlight.light;
      overlay.lines.push_back(line);
    }
  }
  if (shown(OverlayRole::LimitDirections)) addLimitDirections(inspection, frame, drawn, selected, overlay.lines);
  for (const std::string& model : modelsInOrder(inspection, options.models)) {
    const ModelResult& result = inspection.models.at(model);
    FrameScore score = frameScore(result, frame);
    bool answered = false;
    for (const FrameComparison& comparison : result.frames) {
      if (comparison.frame != frame) continue;
      answered = true;
      if (!drawn(model)) continue;
      for (std::size_t i = 0; i < comparison.prediction.highlights().size(); ++i) {
        const PredictedHighlight& h = comparison.prediction.highlights()[i];
        OverlayLine line;
        line.model = model;
        line.light = comparison.light;
        line.highlight = static_cast<int>(i);
        line.colour = options.colourByRole ? roleColour : modelColour(model);
        line.halo = options.colourByRole;
        line.label = model + (score.errorPct ? " " + errorText(*score.errorPct) + " %" : std::string{});
        if (shown(OverlayRole::PredictedContour)) {
          line.role = OverlayRole::PredictedContour;
          line.width = selected && selected->model == model ? 2.75 : 1.75;
          line.dash = training ? Dash::Solid : Dash::Dashed;
          addPrediction(h, camera, line, overlay.lines);
        }
        if (shown(OverlayRole::UncertaintyBand)) addBand(h, camera, line, overlay.lines);
        line.halo = false;
        line.dash = Dash::Solid;
        if (shown(OverlayRole::CanonicalEllipse) && !training && modelByName(model).hasOutlines() && h.canonical &&
            h.canonical->ellipse) {
          line.role = OverlayRole::CanonicalEllipse;
          line.points = ellipsePoints(*h.canonical->ellipse);
          line.closed = true;
          line.width = 1;
          line.dash = Dash::Dotted;
          overlay.lines.push_back(line);
        }
        if (shown(OverlayRole::ResidualArrows)) {
          line.role = OverlayRole::ResidualArrows;
          line.width = 1.25;
          line.dash = Dash::Solid;
          addResidualArrows(inspection, comparison, static_cast<int>(i), camera, line, options.residualScale, overlay.lines);
        }
        if (shown(OverlayRole::PredictedEllipse) && h.ellipse) {
          line.role = OverlayRole::PredictedEllipse;
          line.points = ellipsePoints(*h.ellipse);
          line.closed = true;
          line.width = 1;
          line.dash = Dash::Dashed;
          overlay.lines.push_back(line);
          // On T, before the walk back onto the surface; the canonical layer has one there already.
          if (h.canonical && h.canonical->ellipse && !shown(OverlayRole::CanonicalEllipse)) {
            line.points = ellipsePoints(*h.canonical->ellipse);
            line.dash = Dash::Dotted;
            overlay.lines.push_back(line);
          }
        }
        if (shown(OverlayRole::PredictedPeak) && h.brightest.pixel.allFinite()) {
          OverlayMark mark;
          mark.role = OverlayRole::PredictedPeak;
          mark.at = toPhotograph(camera, {h.brightest.pixel}).front();
          mark.shape = MarkShape::Circle;
          mark.colour = modelColour(model);
          mark.size = 3.5;
          mark.label = model + " brightest point";
          mark.model = model;
          mark.light = comparison.light;
          mark.highlight = static_cast<int>(i);
          overlay.marks.push_back(mark);
        }
      }
    }
    if (!answered) {
      std::string reason = "no prediction for this frame";
      for (const ModelResult::Fit& fit : result.fits) {
        if (fit.failure()) reason = fit.failure()->message();
      }
      FrameScore none;
      none.reason = reason;
      overlay.captions.push_back({modelColour(model), model, model + "  " + reason, true, none});
    } else {
      if (unreadable && score.reason == unreadable->message()) {
        score.reason = "not compared";  // why is said once, for the frame
        score.spurious = 0;
      }
      // Drawn like a held-out frame's prediction, but it counts in no summary.
      const bool excluded = !training && !inspection.isHeldOut(frame);
      overlay.captions.push_back({modelColour(model), model,
                                  scoreText(model, score) + (excluded ? "   excluded, not evaluated" : ""),
                                  score.matched == 0 || score.missed > 0 || score.spurious > 0, score});
    }
  }
  // What is selected lies on top of what almost coincides with it.
  if (selected && !selected->model.empty()) {
    const auto other = [&](const auto& drawnThing) { return drawnThing.model != selected->model; };
    std::stable_partition(overlay.lines.begin(), overlay.lines.end(), other);
    std::stable_partition(overlay.marks.begin(), overlay.marks.end(), other);
  }
  if (selected && selected->direction && shown(OverlayRole::SelectedPoint))
    addSelectedPoint(inspection, *selected, shown, drawn, overlay.marks);
  return overlay;
}

}  // namespace glint::draw
