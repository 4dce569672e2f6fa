// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/frame_overlay.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/base/number_text.h"
#include "core/draw/frame_details.h"
#include "core/draw/plots.h"
#include "core/draw/selection.h"
#include "core/pipeline/summary.h"
#include "core/scene/scene_files.h"

namespace glint::draw {
namespace {

constexpr Colour kObservedEllipse{0.82, 0.82, 0.82}, kIgnored{0.7, 0.7, 0.7};

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

/// The overlay of one frame, layer by layer; see frameOverlay.
class FrameLayers {
 public:
  FrameLayers(const Inspection& inspection, int frame, const OverlayOptions& options)
      : inspection_(inspection),
        frame_(frame),
        options_(options),
        camera_(inspection.scene->frames[static_cast<std::size_t>(frame)].camera),
        selected_(options.selection && options.selection->frame == frame ? &*options.selection : nullptr),
        training_(inspection.isTraining(frame)),
        heldOut_(inspection.isHeldOut(frame)) {}

  FrameOverlay draw() {
    if (static_cast<std::size_t>(frame_) < inspection_.evidence.size())
      addEvidence(inspection_.evidence[static_cast<std::size_t>(frame_)]);
    addObservedCanonical();
    if (shown_(OverlayRole::LimitDirections)) addLimitDirections(inspection_, frame_, drawn_, selected_, overlay_.lines);
    for (const std::string& model : modelsInOrder(inspection_, options_.models)) addModel(model);
    if (options_.samples && options_.samples->frame == frame_ && shown_(OverlayRole::Lobes))
      addLobes(*options_.samples, selected_ ? selected_->highlight : -1, overlay_);
    raiseSelected();
    if (selected_ && selected_->direction && shown_(OverlayRole::SelectedPoint))
      addSelectedPoint(inspection_, *selected_, shown_, drawn_, overlay_.marks);
    return std::move(overlay_);
  }

 private:
  void addEvidence(const FrameEvidence& evidence) {
    const std::vector<Highlight>& observed = evidence.scored();  // what the rows of the comparison refer to
    for (std::size_t i = 0; i < observed.size(); ++i) addObserved(observed[i], static_cast<int>(i));
    for (const Highlight& h : evidence.ignored) addIgnored(h);
    if (!evidence.failure) return;
    if (evidence.failure->reason == Reason::FrameUnreadable) unreadable_ = evidence.failure;
    overlay_.captions.push_back(
        {kObserved, "", "observed: " + withoutFolder(evidence.failure->message(), *inspection_.scene), true, {}});
  }

  void addObserved(const Highlight& h, int index) {
    OverlayLine line;
    line.light = h.light;
    line.highlight = index;
    const std::vector<std::string> missing = missedBy(inspection_, frame_, index, [&](const std::string& model) {
      return drawn_(model) && (!selected_ || selected_->model.empty() || selected_->model == model);
    });
    line.unmatched = !missing.empty();
    line.label = "observed" + (h.light.empty() ? std::string{} : " " + h.light);
    if (h.touchesBorder) line.label += ", cut by the image's border";
    for (const std::string& model : missing) line.label += (model == missing.front() ? ", missed by " : ", ") + model;
    if (line.unmatched) addUnmatched(h.peak, MarkShape::Square, 7, line);
    if (shown_(OverlayRole::ObservedContour) && h.contour.points.size() > 1) {
      line.role = OverlayRole::ObservedContour;
      line.points = toPhotograph(camera_, h.contour.points);
      line.closed = h.contour.closed;
      line.colour = kObserved;
      line.width = selected_ && selected_->highlight == index ? 3.5 : 2.5;
      line.halo = true;
      line.dash = line.unmatched ? Dash::Dashed : Dash::Solid;
      overlay_.lines.push_back(line);
    }
    if (shown_(OverlayRole::ObservedEllipse) && h.ellipse) {
      line.colour = kObservedEllipse;
      line.halo = false;
      line.label = "ellipse of the observed contour";
      addEllipse(OverlayRole::ObservedEllipse, *h.ellipse, Dash::Dashed, line);
    }
    if (shown_(OverlayRole::ObservedPeak)) {
      OverlayMark mark;
      mark.at = toPhotograph(camera_, {h.peak}).front();
      mark.colour = kObserved;
      mark.light = h.light;
      mark.highlight = index;
      mark.label = h.clipped ? "centre of a clipped highlight" : "observed peak";
      overlay_.marks.push_back(mark);
    }
  }

  /// The canonical contour of a training view lies on its tangent plane; its ellipse in the photograph is what the fit uses.
  void addObservedCanonical() {
    if (!shown_(OverlayRole::CanonicalEllipse) || !drawn_(canonicalModel().id())) return;
    for (const TrainingView& view : inspection_.views) {
      if (view.frame != frame_ || !view.canonical || !view.canonical->ellipse) continue;
      if (failedFor(inspection_, canonicalModel().id(), view.highlight.light)) continue;  // it was fitted to nothing
      OverlayLine line;
      line.colour = canonicalColour();
      line.label = "canonical ellipse on the tangent plane";
      line.light = view.highlight.light;
      addEllipse(OverlayRole::CanonicalEllipse, *view.canonical->ellipse, Dash::Dotted, line);
    }
  }

  void addModel(const std::string& model) {
    const ModelResult& result = inspection_.models.at(model);
    FrameScore score = frameScore(result, frame_);
    const Colour roleColour = training_ ? kTraining : heldOut_ ? kHeldOut : kExcluded;
    bool answered = false, anyPoor = false;
    for (const FrameComparison& comparison : result.frames) {
      if (comparison.frame != frame_) continue;
      answered = true;
      const std::string why = poorFit(result, comparison);
      const bool poor = !why.empty();
      anyPoor = anyPoor || poor;
      if (poor && score.reason.empty()) score.reason = "poor: " + why;
      if (!drawn_(model)) continue;
      OverlayLine line;
      line.model = model;
      line.light = comparison.light;
      line.colour = options_.colourByRole ? roleColour : modelColour(model);
      line.halo = options_.colourByRole;
      line.label = model + (score.errorPct ? " " + errorText(*score.errorPct) + " %" : std::string{}) + (poor ? ", poor" : "") +
                   (options_.predictionsEarlier ? ", updating" : "");
      if (poor || options_.predictionsEarlier) line.colour = pale(line.colour);
      for (std::size_t i = 0; i < comparison.prediction.highlights().size(); ++i)
        addPredicted(comparison, static_cast<int>(i), line, poor);
      for (const FilteredHighlight& filtered : comparison.prediction.filtered) addGhost(filtered, line);
    }
    if (answered)
      addCaption(model, score, anyPoor);
    else
      addNoAnswer(model, result);
  }

  /// @param line  with model, light, colour and label
  /// @param poor  its fit explains the training views badly: dashed wherever it is drawn
  void addPredicted(const FrameComparison& comparison, int index, OverlayLine line, bool poor) {
    const PredictedHighlight& h = comparison.prediction.highlights()[static_cast<std::size_t>(index)];
    const bool onPlane = h.canonical && h.canonical->ellipse;
    line.highlight = index;
    line.unmatched = isSpurious(comparison, index);
    const bool chosen = line.unmatched && selected_ && selected_->model == line.model && selected_->light == line.light &&
                        selected_->highlight < 0 && selected_->predicted == index;
    if (line.unmatched) {
      line.label = line.model + ", spurious: no observed highlight overlaps it";
      addUnmatched(centroid(h.contour), MarkShape::Triangle, chosen ? 9 : 7, line);
    }
    if (shown_(OverlayRole::PredictedContour)) {
      line.role = OverlayRole::PredictedContour;
      line.width = chosen ? 3.75 : selected_ && selected_->model == line.model ? 2.75 : 1.75;
      line.dash = line.unmatched ? Dash::DashDotted : training_ && !poor ? Dash::Solid : Dash::Dashed;
      addPrediction(h, camera_, line, overlay_.lines);
    }
    if (shown_(OverlayRole::UncertaintyBand)) addBand(h, camera_, line, overlay_.lines);
    line.halo = false;
    if (shown_(OverlayRole::CanonicalEllipse) && !training_ && modelByName(line.model).hasOutlines() && onPlane)
      addEllipse(OverlayRole::CanonicalEllipse, *h.canonical->ellipse, Dash::Dotted, line);
    if (shown_(OverlayRole::ResidualArrows)) {
      line.role = OverlayRole::ResidualArrows;
      line.width = 1.25;
      line.dash = Dash::Solid;
      addResidualArrows(inspection_, comparison, index, camera_, line, options_.residualScale, overlay_.lines);
    }
    if (shown_(OverlayRole::PredictedEllipse) && h.ellipse) {
      addEllipse(OverlayRole::PredictedEllipse, *h.ellipse, Dash::Dashed, line);
      // On T, before the walk back onto the surface; the canonical layer has one there already.
      if (onPlane && !shown_(OverlayRole::CanonicalEllipse))
        addEllipse(OverlayRole::PredictedEllipse, *h.canonical->ellipse, Dash::Dotted, line);
    }
    if (shown_(OverlayRole::PredictedPeak) && h.brightest.pixel.allFinite()) addPredictedPeak(h, line);
  }

  /// What has no partner is told by more than its line.
  void addUnmatched(const Pixel& at, MarkShape shape, double size, const OverlayLine& of) {
    if (!shown_(OverlayRole::Unmatched) || !at.allFinite()) return;
    OverlayMark mark;
    mark.role = OverlayRole::Unmatched;
    mark.at = toPhotograph(camera_, {at}).front();
    mark.shape = shape;
    mark.size = size;
    mark.width = 2;
    mark.colour = shape == MarkShape::Square ? kObserved : of.colour;
    mark.label = of.label;
    mark.model = of.model;
    mark.light = of.light;
    mark.highlight = of.highlight;
    overlay_.marks.push_back(mark);
  }

  /// What a filter took out of a prediction.
  void addGhost(const FilteredHighlight& filtered, OverlayLine line) {
    if (!shown_(OverlayRole::PredictedContour)) return;
    line.role = OverlayRole::PredictedContour;
    line.label = line.model + ", filtered: " + filtered.reason;
    line.points = toPhotograph(camera_, filtered.highlight.contour.points);
    line.closed = filtered.highlight.contour.closed;
    line.dash = Dash::Dotted;
    line.width = 0.75;
    line.halo = false;
    line.colour = pale(line.colour);
    overlay_.lines.push_back(std::move(line));
  }

  /// What a person took out of the evidence.
  void addIgnored(const Highlight& h) {
    if (!shown_(OverlayRole::ObservedContour)) return;
    OverlayLine line;
    line.role = OverlayRole::ObservedContour;
    line.light = h.light;
    line.label = "ignored by hand";
    line.points = toPhotograph(camera_, h.contour.points);
    line.closed = h.contour.closed;
    line.colour = kIgnored;
    line.dash = Dash::Dotted;
    line.width = 1;
    line.halo = true;
    overlay_.lines.push_back(std::move(line));
  }

  void addPredictedPeak(const PredictedHighlight& h, const OverlayLine& of) {
    OverlayMark mark;
    mark.role = OverlayRole::PredictedPeak;
    mark.at = toPhotograph(camera_, {h.brightest.pixel}).front();
    mark.shape = MarkShape::Circle;
    mark.colour = modelColour(of.model);
    mark.size = 3.5;
    mark.label = of.model + " brightest point";
    mark.model = of.model;
    mark.light = of.light;
    mark.highlight = of.highlight;
    overlay_.marks.push_back(mark);
  }

  void addEllipse(OverlayRole role, const Ellipse& ellipse, Dash dash, OverlayLine style) {
    style.role = role;
    style.points = toPhotograph(camera_, ellipse.sample(options_.ellipseSegments));
    style.closed = true;
    style.width = 1;
    style.dash = dash;
    overlay_.lines.push_back(std::move(style));
  }

  void addCaption(const std::string& model, FrameScore score, bool poor) {
    if (unreadable_ && score.reason == unreadable_->message()) {
      score.reason = "not compared";  // the frame says why, once
      score.spurious = 0;
    }
    // Drawn like a held-out frame's prediction, but it counts in no summary.
    const bool excluded = !training_ && !heldOut_;
    overlay_.captions.push_back({modelColour(model, poor), model,
                                 scoreText(model, score) + (excluded ? "   excluded, not evaluated" : ""),
                                 score.matched == 0 || score.missed > 0 || score.spurious > 0, score});
  }

  void addNoAnswer(const std::string& model, const ModelResult& result) {
    FrameScore none;
    none.reason = "no prediction for this frame";
    for (const ModelResult::Fit& fit : result.fits) {
      if (fit.failure()) none.reason = fit.failure()->message();
    }
    overlay_.captions.push_back({modelColour(model), model, model + "  " + none.reason, true, none});
  }

  /// What is selected lies on top of what almost coincides with it.
  void raiseSelected() {
    if (!selected_ || selected_->model.empty()) return;
    const auto other = [&](const auto& drawnThing) { return drawnThing.model != selected_->model; };
    std::stable_partition(overlay_.lines.begin(), overlay_.lines.end(), other);
    std::stable_partition(overlay_.marks.begin(), overlay_.marks.end(), other);
  }

  const Inspection& inspection_;
  const int frame_;
  const OverlayOptions& options_;
  const Camera& camera_;
  const Selection* const selected_;
  const bool training_, heldOut_;
  const std::function<bool(OverlayRole)> shown_ = [this](OverlayRole role) { return !options_.hidden.count(role); };
  const std::function<bool(const std::string&)> drawn_ = [this](const std::string& model) {
    return !options_.hiddenModels.count(model) && (options_.models.empty() || options_.models.count(model));
  };
  std::optional<Failure> unreadable_;
  FrameOverlay overlay_;
};

}  // namespace

const std::vector<OverlayLayer>& overlayLayers() {
  static const std::vector<OverlayLayer> layers{
      {OverlayRole::ObservedContour, "frame/observed", "Observed",
       "Contour detected in the photograph at the contour level: white", true},
      {OverlayRole::ObservedEllipse, "frame/observed-ellipse", "Ellipse", "Ellipse fitted to the observed contour: grey, dashed",
       true},
      {OverlayRole::PredictedContour, "frame/predicted", "Predicted",
       "Contour predicted by each model, in its colour: dashed in frames not used for training, dashed and pale where the model "
       "is poor, dotted where directions failed",
       true},
      {OverlayRole::PredictedEllipse, "frame/predicted-ellipse", "Pred. ellipse",
       "Ellipse fitted to each predicted contour, dashed", true},
      {OverlayRole::UncertaintyBand, "frame/band", "Band",
       "95 % band of each predicted contour, if Predict > Uncertainty band is on and the band is wider than half a pixel", true},
      {OverlayRole::CanonicalEllipse, "frame/canonical", "Canonical",
       "Ellipse of the canonical contour on the tangent plane, dotted: observed in training frames, predicted elsewhere", true},
      {OverlayRole::ObservedPeak, "frame/peak", "Peaks", "Observed peak: cross; predicted brightest points: circles", true},
      {OverlayRole::Unmatched, "frame/unmatched", "Unmatched",
       "Crossed square: observed, and missed by the selected model (by any shown one, where none is selected), its contour "
       "dashed. "
       "Triangle: predicted but not observed (spurious), its contour in dashes and dots",
       true},
      {OverlayRole::ResidualArrows, "frame/residuals", "Residuals",
       "Arrows from the observed to the predicted contour, every 10 degrees", false},
      {OverlayRole::LimitDirections, "frame/directions", "Directions",
       "Walks from the brightest point: to the limit angle on the surface; dotted: on to the same angle on the tangent plane",
       false},
      {OverlayRole::Lobes, "frame/lobes", "Lobes",
       "Contours of the selected highlight under every lobe: at the contour level, and at 0.3 of it in thin lines. "
       "Colours as in the plot Every lobe",
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
  const std::shared_ptr<const Inspection> there = inSceneAt(inspection, frame);
  return FrameLayers(*there, frame, options).draw();
}

}  // namespace glint::draw
