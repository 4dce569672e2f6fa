// SPDX-License-Identifier: BSD-3-Clause
#include "viz/frame_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace glint::viz {
namespace {

constexpr Colour kObservedEllipse{0.82, 0.82, 0.82};

/// Contours live in ideal pixels; the photograph on screen is the distorted one.
std::vector<Pixel> toPhotograph(const Camera& camera, const std::vector<Pixel>& ideal) {
  if (!camera.hasDistortion()) return ideal;
  std::vector<Pixel> measured;
  measured.reserve(ideal.size());
  for (const Pixel& p : ideal) measured.push_back(camera.distorted(p));
  return measured;
}

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Both borders of the 95 % band, where it is known and wide enough to be seen beside the contour.
void addBand(const PredictedHighlight& highlight, const Camera& camera, const OverlayLine& style, std::vector<OverlayLine>& lines) {
  constexpr double kFactor = 1.96;    // many degrees of freedom; the exact factor differs by less than a line's width
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
  addBand(highlight, camera, style, lines);
}

std::string scoreText(const std::string& model, const FrameScore& score) {
  std::string text = model;
  if (score.errorPct) text += "  " + formatted("%.2f %%", *score.errorPct);
  if (score.errorPx) text += "  " + formatted("%.2f px", *score.errorPx);
  if (score.iou && score.matched > 0) text += "  IoU " + formatted("%.3f", *score.iou);
  if (score.missed > 0) text += "  missed " + std::to_string(score.missed);
  if (score.spurious > 0) text += "  spurious " + std::to_string(score.spurious);
  if (!score.reason.empty()) text += "  " + score.reason;
  return text;
}

}  // namespace

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

std::vector<std::string> modelsInOrder(const Inspection& inspection, const std::set<std::string>& only) {
  static const std::array<const char*, 5> known{"primal", "dual", "canonical", "limit-angle", "reflectance"};
  std::vector<std::string> names;
  const auto take = [&](const std::string& name) {
    if (only.empty() || only.count(name)) names.push_back(name);
  };
  for (const char* name : known) {
    if (inspection.models.count(name)) take(name);
  }
  for (const auto& [name, result] : inspection.models) {
    if (std::find(known.begin(), known.end(), name) == known.end()) take(name);
  }
  return names;
}

FrameScore frameScore(const ModelResult& result, int frame) {
  FrameScore score;
  double pct = 0, px = 0, iou = 0;
  int predictedLights = 0;
  std::string reason;
  const auto note = [&](const std::optional<Failure>& failure) {
    if (failure && reason.empty()) reason = failure->message();
  };
  for (const FrameComparison& comparison : result.frames) {
    if (comparison.frame != frame) continue;
    note(comparison.prediction.failure);
    if (!comparison.prediction.highlights.empty()) {
      ++predictedLights;
      iou += comparison.iou;
    }
    for (const FrameComparison::Row& row : comparison.rows) {
      if (row.observed < 0) {
        ++score.spurious;
      } else if (row.predicted < 0) {
        ++score.missed;
      } else if (row.metrics) {
        ++score.matched;
        pct += row.metrics->contourErrorPct;
        px += row.metrics->contourErrorPx;
      }
      note(row.failure);
    }
  }
  if (score.matched > 0) {
    score.errorPct = pct / score.matched;
    score.errorPx = px / score.matched;
  } else {
    score.reason = reason;
  }
  if (predictedLights > 0) score.iou = iou / predictedLights;
  return score;
}

FrameOverlay frameOverlay(const Inspection& inspection, int frame, const OverlayOptions& options) {
  require(inspection.scene && frame >= 0 && frame < static_cast<int>(inspection.scene->frames.size()),
          "frameOverlay: no such frame");
  require(options.ellipseSegments >= 8, "frameOverlay: ellipseSegments < 8");
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  const auto shown = [&](OverlayRole role) { return !options.hidden.count(role); };
  const auto ellipsePoints = [&](const Ellipse& e) { return toPhotograph(camera, e.sample(options.ellipseSegments)); };
  FrameOverlay overlay;

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
        line.width = 2.5;
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
    if (evidence.failure) overlay.captions.push_back({kObserved, "", "observed: " + evidence.failure->message(), true, {}});
  }
  // The canonical contour of a training view lies on its tangent plane; its ellipse in the photograph is what the fit uses.
  if (shown(OverlayRole::CanonicalEllipse)) {
    for (const TrainingView& view : inspection.views) {
      if (view.frame != frame || !view.canonical || !view.canonical->ellipse) continue;
      if (!options.models.empty() && !options.models.count("canonical")) continue;
      OverlayLine line;
      line.role = OverlayRole::CanonicalEllipse;
      line.points = ellipsePoints(*view.canonical->ellipse);
      line.closed = true;
      line.colour = modelColour("canonical");
      line.width = 1;
      line.dash = Dash::Dotted;
      line.label = "canonical ellipse on the tangent plane";
      line.light = view.highlight.light;
      overlay.lines.push_back(line);
    }
  }
  for (const std::string& model : modelsInOrder(inspection, options.models)) {
    const ModelResult& result = inspection.models.at(model);
    const FrameScore score = frameScore(result, frame);
    bool answered = false;
    for (const FrameComparison& comparison : result.frames) {
      if (comparison.frame != frame) continue;
      answered = true;
      for (std::size_t i = 0; i < comparison.prediction.highlights.size(); ++i) {
        const PredictedHighlight& h = comparison.prediction.highlights[i];
        OverlayLine line;
        line.model = model;
        line.light = comparison.light;
        line.highlight = static_cast<int>(i);
        line.colour = modelColour(model);
        line.label = model + (score.errorPct ? " " + formatted("%.2f %%", *score.errorPct) : std::string{});
        if (shown(OverlayRole::PredictedContour)) {
          line.role = OverlayRole::PredictedContour;
          line.width = 1.75;
          addPrediction(h, camera, line, overlay.lines);
        }
        if (shown(OverlayRole::PredictedEllipse) && h.ellipse) {
          line.role = OverlayRole::PredictedEllipse;
          line.points = ellipsePoints(*h.ellipse);
          line.closed = true;
          line.width = 1;
          line.dash = Dash::Dashed;
          overlay.lines.push_back(line);
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
      std::string reason = "no answer for this frame";
      for (const ModelResult::Fit& fit : result.fits) {
        if (fit.failure) reason = fit.failure->message();
      }
      FrameScore none;
      none.reason = reason;
      overlay.captions.push_back({modelColour(model), model, model + "  " + reason, true, none});
    } else {
      overlay.captions.push_back({modelColour(model), model, scoreText(model, score),
                                  score.matched == 0 || score.missed > 0 || score.spurious > 0, score});
    }
  }
  return overlay;
}

}  // namespace glint::viz
