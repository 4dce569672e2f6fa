// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/explain.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/advise/conditioning.h"
#include "core/advise/explain_case.h"
#include "core/base/numeric.h"
#include "core/geometry/camera.h"
#include "core/geometry/epipolar.h"
#include "core/highlight/peak.h"
#include "core/light/estimate.h"
#include "core/pipeline/training.h"

namespace glint {

using namespace explain_steps;

namespace {
constexpr double kSameLimit = 0.05;      // relative spread over the directions: beyond, one limit angle is not the contour
constexpr double kPricePct = 1;          // of the highlight's size: below, a broken assumption has cost nothing that one sees
constexpr double kEllipticShare = 0.01;  // of the size: a contour this near to its ellipse looks like one
constexpr double kWeakGap = 0.5;         // of the last two singular values: above, two quadrics fit almost alike
constexpr double kNeedle = 10;           // longest over middle semi-axis: a lamp's blurred image is about as wide as it is long
// Below these a number is what rounding leaves: contours are followed to about 1e-3 px.
constexpr double kLeastPx = 1e-3, kLeastPct = 1e-3;
constexpr double kLeastDeg = 1e-4;     // 1e-3 px at a focal length of 600 px
constexpr double kLeastOfView = 1e-6;  // of the distance to what is seen: 1e-3 px there
constexpr int kMostPairedViews = 12;   // 66 pairs of views tell what their epipolar lines do

const std::vector<std::string>& idsFromPoorToRich() {
  static const std::vector<std::string> ids = [] {
    std::vector<std::string> all;
    for (const auto& m : allModels()) all.push_back(m->id());
    return all;
  }();
  return ids;
}

/// Light, fit and comparison of this highlight, and its view with the canonical contour.
void gather(Case& c) {
  const Inspection& in = c.inspection;
  Explanation& out = c.out;
  const FrameEvidence& evidence = in.evidence[std::size_t(out.frame)];
  if (out.highlight < 0 || out.highlight >= int(evidence.highlights.size())) out.highlight = evidence.highlights.empty() ? -1 : 0;
  const auto result = in.models.find(out.model);
  c.result = result == in.models.end() ? nullptr : &result->second;
  if (out.highlight >= 0) {
    c.highlight = &evidence.highlights[std::size_t(out.highlight)];
    out.light = c.highlight->light;
  } else if (c.result && !c.result->fits.empty()) {
    out.light = c.result->fits.front().light;
  }
  const std::string surfaceKey = in.surfaces ? in.surfaces->keyOf(out.frame) : "";
  if (c.result)
    for (const ModelResult::Fit& f : c.result->fits)
      if (f.light == out.light && (!f.surface || *f.surface == surfaceKey)) c.fit = &f;
  if (c.result)
    for (const FrameComparison& comparison : c.result->frames) {
      if (comparison.frame != out.frame || comparison.light != out.light) continue;
      c.comparison = &comparison;
      for (const FrameComparison::Row& row : comparison.rows)
        if (!c.row || row.observed == out.highlight) c.row = &row;
    }
  if (const LightEstimate* common = c.common()) out.lightUsed = common->light;
  if (!c.highlight) return;
  for (const TrainingView& v : in.views)
    if (v.frame == out.frame && v.highlight.light == out.light && (v.highlight.peak - c.highlight->peak).norm() < 1)
      out.view = v;  // px; noise moves it less
  if (!out.view && in.surfaces) {
    const auto found = surfaceFor(in, out.frame, out.light);
    out.view = trainingView(evidence, out.highlight, c.camera(), found ? *found : nullptr);
  }
  c.surface = out.view ? out.view->surface : nullptr;
  if (out.view && out.view->seen && !out.view->canonical && out.lightUsed)
    addCanonicalContour(*out.view, *out.lightUsed, in.request.settings);
}

void peakStep(const Case& c, ExplainStep& step) {
  if (!c.highlight) return void(reached(c, step));
  step.numbers.push_back(pixel("p", "peak in the photograph", c.highlight->peak));
  if (c.highlight->clipped) step.broken.push_back({"clipped-peak", {}});
  if (const double away = outsideOfContour(*c.highlight); away > 0)
    step.broken.push_back({"peak-outside-contour", {one("", "from the peak to its contour", away, "px")}});
  if (!reached(c, step)) return;
  const TrainingView& v = *c.out.view;
  step.numbers.push_back(point("P_B", "brightest point", v.seen->brightest.point.position));
  step.numbers.push_back(
      one("d", "distance from the camera", (v.seen->brightest.point.position - v.camera.centreInWorld()).norm(), "m"));
}

void tangentStep(const Case& c, ExplainStep& step) {
  if (!reached(c, step) || !c.out.view->seen) return;
  const TrainingView& v = *c.out.view;
  const Eigen::Vector3d toCamera = (v.camera.centreInWorld() - v.seen->brightest.point.position).normalized();
  step.numbers.push_back(point("N", "normal at P_B", v.seen->tangentPlane.normal, ""));
  step.numbers.push_back(one(
      "θ", "angle between N and the view ray",
      degrees(std::atan2(toCamera.cross(v.seen->tangentPlane.normal).norm(), toCamera.dot(v.seen->tangentPlane.normal))), "deg"));
  if (!c.surface) return;
  if (const Outcome<Curvature> k = c.surface->curvatureAt(v.seen->brightest.point)) {
    step.numbers.push_back(one("κ₁", "principal curvature", k->k1, "1/m"));
    step.numbers.push_back(one("κ₂", "principal curvature", k->k2, "1/m"));
  }
}

void contourStep(const Case& c, ExplainStep& step) {
  if (!c.highlight) return void(reached(c, step));
  const Highlight& h = *c.highlight;
  step.numbers.push_back(one("q", "level, share of the peak", h.level));
  step.numbers.push_back(one("", "area", h.areaPx2, "px²"));
  if (h.ellipse)
    step.numbers.push_back({"a, b", "semi-axes of its ellipse", {h.ellipse->semiAxes.x(), h.ellipse->semiAxes.y()}, "px"});
  if (h.touchesBorder) step.broken.push_back({"contour-cut", {}});
  if (!h.ellipse) return;
  // A contour on a bent mirror is no ellipse: how far it is from its own.
  double sum = 0;
  const Polyline own{h.ellipse->sample(360), true};
  for (const Pixel& p : h.contour.points) sum += std::pow(distance(own, p), 2);
  const double rms = std::sqrt(sum / double(h.contour.points.size())), share = rms / std::sqrt(h.ellipse->semiAxes.prod());
  step.numbers.push_back(one("", "distance of the contour from its ellipse", rms, "px"));
  if (share > kEllipticShare && modelByName(c.out.model).traits().stopsAtOutline)
    step.broken.push_back({"contour-not-elliptic", {one("", "of the contour's size", 100 * share, "%")}});
}

/// Whether the limit angles differ by more than one angle would explain, and what it comes from.
void addSpread(const Case& c, double spread, ExplainStep& step) {
  const int here = endsAtEdge(*c.out.view);
  const auto& views = c.inspection.views;
  const auto elsewhere = std::count_if(views.begin(), views.end(), [&](const TrainingView& v) {
    return v.frame != c.out.frame && v.highlight.light == c.out.light && c.sharesModel(v.frame) && endsAtEdge(v) > 0;
  });
  if (here > 0 || (elsewhere > 0 && spread > kSameLimit))
    step.broken.push_back({"contour-at-edge",
                           {one("", "of 72 points of this contour", here),
                            one("", "other training views with such a contour", double(elsewhere))}});
  else if (spread > kSameLimit)
    step.broken.push_back({"limit-angle-varies", {one("", "spread of the limit angles", 100 * spread, "%")}});
}

void limitAngleStep(const Case& c, ExplainStep& step) {
  if (!reached(c, step)) return;
  if (!c.out.view->canonical) {
    step.failure = Failure{Reason::NoLight, "the walk needs the light"};
    return;
  }
  std::vector<double> angles;
  std::map<std::string, int> failed;
  for (const DirectionResult& d : c.out.view->canonical->directions) {
    if (d.limitAngle && !d.failure)
      angles.push_back(*d.limitAngle);
    else if (d.failure)
      ++failed[nameOf(d.failure->reason)];
  }
  step.numbers.push_back(one("n", "directions", double(c.out.view->canonical->directions.size())));
  step.numbers.push_back(one("", "reached the contour", double(angles.size())));
  if (!angles.empty()) {
    const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
    step.numbers.push_back(one("α_i", "smallest limit angle", degrees(*least), "deg"));
    step.numbers.push_back(one("α_i", "largest limit angle", degrees(*most), "deg"));
    const double mean = std::accumulate(angles.begin(), angles.end(), 0.0) / double(angles.size());
    addSpread(c, (*most - *least) / mean, step);
  }
  for (const auto& [reason, count] : failed) step.broken.push_back({"directions-failed", {one("", reason, count)}});
  addOtherLight(c, step);
}

void canonicalStep(const Case& c, ExplainStep& step) {
  if (!reached(c, step)) return;
  const std::optional<CanonicalContour>& canonical = c.out.view->canonical;
  if (!canonical || !canonical->ellipse) {
    step.failure = canonical ? Failure{Reason::TooFewPoints, "no ellipse through the canonical points"}
                             : Failure{Reason::NoLight, "the walk needs the light"};
    return;
  }
  const Ellipse& e = *canonical->ellipse;
  step.numbers.push_back({"a, b", "semi-axes of the canonical ellipse", {e.semiAxes.x(), e.semiAxes.y()}, "px"});
  if (c.highlight->ellipse)
    step.numbers.push_back(
        {"",
         "relative to the observed",
         {e.semiAxes.x() / c.highlight->ellipse->semiAxes.x(), e.semiAxes.y() / c.highlight->ellipse->semiAxes.y()},
         "times"});
  double sum = 0;
  const Polyline own{e.sample(360), true};
  for (const Pixel& p : canonical->pixels) sum += std::pow(distance(own, p), 2);
  const double rms = std::sqrt(sum / double(canonical->pixels.size()));
  step.numbers.push_back(one("", "distance of the canonical points from it", rms, "px"));
  if (rms > kEllipticShare * std::sqrt(e.semiAxes.prod()))
    step.broken.push_back({"canonical-not-elliptic", {one("", "of its size", 100 * rms / std::sqrt(e.semiAxes.prod()), "%")}});
  addOtherLight(c, step);
}

/// How far tangent epipolar lines miss the ellipses of the views that were used, RMS over their pairs, px.
std::optional<double> epipolarMiss(const Case& c, bool mirrored) {
  std::vector<const TrainingView*> views;
  for (const TrainingView& v : c.inspection.views) {
    const std::vector<int>& used = c.fit->fit->frames;
    if (!v.seen || !v.highlight.ellipse || v.highlight.light != c.out.light) continue;
    if (std::find(used.begin(), used.end(), v.frame) != used.end()) views.push_back(&v);
  }
  const std::size_t every = (views.size() + kMostPairedViews - 1) / kMostPairedViews;
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < views.size(); i += every)
    for (std::size_t j = i + every; j < views.size(); j += every) {
      const auto camera = [&](const TrainingView& v) { return mirrored ? v.seen->virtualCamera : v.camera.projection(); };
      const Outcome<EpipolarTangents> t =
          epipolarTangents(camera(*views[i]), *views[i]->highlight.ellipse, camera(*views[j]), *views[j]->highlight.ellipse);
      if (!t || !std::isfinite(t->rmsPx())) continue;
      sum += std::pow(t->rmsPx(), 2);
      ++n;
    }
  return n > 0 ? std::optional(std::sqrt(sum / n)) : std::nullopt;
}

/// Why a model fails that has failed: what it assumes, and what the views say of that.
void addReason(const Case& c, ExplainStep& step) {
  if (!c.fit || !c.fit->fit) return;
  if (assumes(c.out.model) == ModelTraits::Assumes::ConstantCurvature) step.broken.push_back({"dual-keeps-bend", {}});
  if (modelByName(c.out.model).traits().mirrored) return;
  std::vector<ExplainNumber> numbers;
  if (const std::optional<double> real = epipolarMiss(c, false))
    numbers.push_back(one("", "epipolar lines of the cameras miss the ellipses by", *real, "px"));
  if (const std::optional<double> mirrored = epipolarMiss(c, true))
    numbers.push_back(one("", "those of the virtual cameras by", *mirrored, "px"));
  step.broken.push_back({"primal-not-mirrored", numbers});
}

/// What is wrong with the prediction for this highlight, so far that no number of it means anything.
void addMisses(const Case& c, ExplainStep& step, bool withReason) {
  const PredictedHighlight* p = c.predicted();
  if (!p || !c.row) return;
  const std::size_t before = step.broken.size();
  const Pixel half(0.5, 0.5);  // to the centres of the outermost pixels
  const Eigen::AlignedBox2d window = seenWindow(c.camera()), seen(window.min() + half, window.max() - half);
  const double outside = !p->brightest.pixel.allFinite() ? 0 : seen.exteriorDistance(p->brightest.pixel);
  if (outside > 0) step.broken.push_back({"prediction-outside", {one("", "outside by", outside, "px")}});
  if (c.row->metrics && c.row->metrics->contourErrorPct > kOwnSizePct)
    step.broken.push_back(
        {"prediction-misses", {one("e", "of the highlight's equivalent diameter", c.row->metrics->contourErrorPct, "%")}});
  else if (c.row->predicted < 0 && c.row->observed >= 0)
    step.broken.push_back({"prediction-misses", {}});
  if (withReason && step.broken.size() > before) addReason(c, step);
}

/// The largest error in a training frame, by the measure of the last step.
std::optional<ContourMetrics> worstInTraining(const Case& c) {
  std::optional<ContourMetrics> worst;
  for (const FrameComparison& comparison : c.result->frames) {
    const bool ofThisFit = comparison.fit >= 0 && &c.result->fits[std::size_t(comparison.fit)] == c.fit;
    if (!ofThisFit || !c.inspection.isTraining(comparison.frame)) continue;
    for (const FrameComparison::Row& row : comparison.rows)
      if (row.metrics && (!worst || row.metrics->contourErrorPx > worst->contourErrorPx)) worst = row.metrics;
  }
  return worst;
}

void ellipsoidStep(const Case& c, ExplainStep& step) {
  if (!c.fit) {
    step.failure = Failure{Reason::NoHighlight, "no model of this light"};
    return;
  }
  if (!c.fit->fit) {
    step.failure = c.fit->fit.failure();
    return;
  }
  const ModelFit& f = *c.fit->fit;
  step.numbers.push_back(one("", "highlights used", double(f.frames.size())));
  const EllipsoidFit* const quadric = f.as<EllipsoidFit>();
  if (f.ellipsoid()) {
    step.numbers.push_back(point("", "centre", f.ellipsoid()->centre()));
    step.numbers.push_back(point("a, b, c", "semi-axes", f.ellipsoid()->semiAxes()));
  }
  if (f.limitAngle()) step.numbers.push_back(one("α_lim", "limit angle", degrees(*f.limitAngle()), "deg"));
  if (const ReflectanceFit* const lobe = f.as<ReflectanceFit>())
    step.numbers.push_back(one("m", "roughness", lobe->roughness.mean));
  if (quadric && quadric->gapRatio > 0) {
    step.numbers.push_back(one("", "last over second-last singular value", quadric->gapRatio));
    if (quadric->gapRatio > kWeakGap) step.broken.push_back({"weak-gap", {one("", "ratio", quadric->gapRatio)}});
  }
  const std::optional<ContourMetrics> worst = worstInTraining(c);
  if (worst) step.numbers.push_back(one("d", "largest mean distance in a training frame", worst->contourErrorPx, "px"));
  if (!f.residualPx.empty())
    step.numbers.push_back(one("",
                               quadric ? "largest distance from a training contour to its outline, one way"
                                       : "largest distance of a training contour from its level set",
                               *std::max_element(f.residualPx.begin(), f.residualPx.end()), "px"));
  const std::size_t before = step.broken.size();
  if (f.ellipsoid()) {
    Eigen::Vector3d axes = f.ellipsoid()->semiAxes();
    std::sort(axes.data(), axes.data() + 3);
    if (axes[2] > kNeedle * axes[1])
      step.broken.push_back({"needle", {one("", "longest semi-axis", axes[2], "m"), one("", "the next one", axes[1], "m")}});
  }
  if (worst && worst->contourErrorPct > kOwnSizePct)
    step.broken.push_back({"training-missed", {one("e", "of the highlight's equivalent diameter", worst->contourErrorPct, "%")}});
  if (step.broken.size() > before) addReason(c, step);
  if (quadric && !f.ellipsoid()) step.broken.push_back({"not-an-ellipsoid", {}});
  if (!quadric) step.broken.push_back({"no-ellipsoid", {}});
}

void projectionStep(const Case& c, ExplainStep& step) {
  if (!c.comparison) {
    step.failure = Failure{Reason::LightOff, "the model predicts nothing for this frame"};
    return;
  }
  const PredictedHighlight* p = c.predicted();
  if (!p) {
    step.failure = c.comparison->prediction.failure() ? *c.comparison->prediction.failure()
                                                      : Failure{Reason::NoBrightestPoint, "this highlight is not predicted"};
    return;
  }
  // An ellipsoid's outline alone has no brightest point: what stands for it is its centre.
  const bool outline = !modelByName(c.out.model).traits().mirrored;
  step.numbers.push_back(
      pixel("", outline ? "centre of the predicted outline" : "predicted brightest point", p->brightest.pixel));
  if (c.highlight)
    step.numbers.push_back(one("", "from the observed peak", (p->brightest.pixel - c.highlight->peak).norm(), "px"));
  // With a walk still to come this is the ellipse on T, not that of the contour in the end.
  const bool walks = p->canonical && p->canonical->ellipse;
  if (const std::optional<Ellipse>& e = walks ? p->canonical->ellipse : p->ellipse)
    step.numbers.push_back(
        {"a, b",
         walks ? "semi-axes of the ellipse that a flat mirror would show" : "semi-axes of the predicted ellipse",
         {e->semiAxes.x(), e->semiAxes.y()},
         "px"});
  addMisses(c, step, true);
}

void inverseWalkStep(const Case& c, ExplainStep& step) {
  const PredictedHighlight* p = c.predicted();
  if (!p) return projectionStep(c, step);
  step.numbers.push_back(one("", "points of the predicted contour", double(p->contour.points.size())));
  if (p->canonical) step.numbers.push_back(one("", "of directions gave a point", 100 * p->coverage, "%"));
  if (p->canonical && p->ellipse)
    step.numbers.push_back(
        {"a, b", "semi-axes of the resulting ellipse", {p->ellipse->semiAxes.x(), p->ellipse->semiAxes.y()}, "px"});
  addMisses(c, step, false);
  if (!p->canonical) {
    if (modelByName(c.out.model).traits().stopsAtOutline)
      step.broken.push_back({"outline-only", {}});
    else
      step.broken.push_back({"no-walk", {}});
    return;
  }
  std::map<std::string, int> failed;
  for (const DirectionResult& d : p->canonical->directions)
    if (d.failure) ++failed[nameOf(d.failure->reason)];
  for (const auto& [reason, count] : failed) step.broken.push_back({"directions-failed", {one("", reason, count)}});
}

void comparisonStep(const Case& c, ExplainStep& step) {
  if (!c.comparison || !c.row) {
    step.failure = Failure{Reason::NoHighlight, "nothing to compare"};
    return;
  }
  if (c.row->failure || !c.row->metrics) {
    step.failure = c.row->failure ? *c.row->failure
                                  : Failure{Reason::NoHighlight, c.row->observed < 0 ? "spurious highlight" : "missed highlight"};
    addMisses(c, step, true);
    return;
  }
  addMisses(c, step, true);
  const ContourMetrics& m = *c.row->metrics;
  step.numbers.push_back(one("d", "mean distance of the contours", m.contourErrorPx, "px"));
  step.numbers.push_back(one("e", "of the equivalent diameter", m.contourErrorPct, "%"));
  step.numbers.push_back(one("IoU", "overlap of all regions of this light", c.comparison->iou));
  step.numbers.push_back(one("", !modelByName(c.out.model).traits().mirrored ? "its centre from the peak" : "offset of the peaks",
                             m.peakOffsetPx, "px"));
  if (c.inspection.isTraining(c.out.frame)) step.broken.push_back({"training-frame", {}});
  // The step of the mirror says what the surface did to the model's assumption: this is its price.
  const ModelTraits::Assumes assumed = assumes(c.out.model);
  std::vector<std::string> because;
  if (assumed == ModelTraits::Assumes::Plane) because = {"primal-off-plane"};
  if (assumed == ModelTraits::Assumes::ConstantCurvature) because = {"dual-curvature-varies", "dual-bends-one-way"};
  for (const ExplainStep& earlier : c.out.steps)
    for (const BrokenAssumption& b : earlier.broken)
      if (m.contourErrorPct > kPricePct && std::find(because.begin(), because.end(), b.id) != because.end())
        return step.broken.push_back(b);
}
/// Says of each number what is too small to mean anything. @param distance  m, to what the camera sees; > 0.
void setLeast(std::vector<ExplainNumber>& numbers, double distance) {
  for (ExplainNumber& n : numbers) {
    if (n.unit == "px") n.least = kLeastPx;
    if (n.unit == "%") n.least = kLeastPct;
    if (n.unit == "deg") n.least = kLeastDeg;
    if (n.unit == "m") n.least = kLeastOfView * distance;
    if (n.unit == "1/m") n.least = kLeastOfView / distance;
  }
}
}  // namespace

const std::vector<std::string>& explainSteps() {
  static const std::vector<std::string> ids{"peak",       "tangent-plane", "virtual-camera",    "light",
                                            "contour",    "limit-angles",  "canonical-ellipse", "ellipsoid",
                                            "projection", "inverse-walk",  "comparison"};
  return ids;
}

std::string modelToExplain(const Inspection& inspection, const std::string& wanted) {
  if (inspection.models.count(wanted)) return wanted;
  std::string richest, withEllipsoid;
  for (const std::string& id : idsFromPoorToRich()) {
    const auto it = inspection.models.find(id);
    if (it == inspection.models.end()) continue;
    richest = id;
    for (const ModelResult::Fit& f : it->second.fits)
      if (f.fit && f.fit->ellipsoid()) withEllipsoid = id;
  }
  return withEllipsoid.empty() ? richest : withEllipsoid;
}

Explanation explain(const Inspection& inspection, int frame, int highlight, const std::string& model) {
  require(inspection.scene && frame >= 0 && frame < int(inspection.scene->frames.size()), "explain: no such frame");
  require(inspection.evidence.size() == inspection.scene->frames.size(), "explain: no evidence");
  Explanation out;
  out.frame = frame;
  out.highlight = highlight;
  out.model = modelToExplain(inspection, model);
  Case c{inspection, out};
  gather(c);
  using Fill = void (*)(const Case&, ExplainStep&);
  static const std::map<std::string, Fill> fill{{"peak", peakStep},
                                                {"tangent-plane", tangentStep},
                                                {"virtual-camera", virtualCameraStep},
                                                {"light", lightStep},
                                                {"contour", contourStep},
                                                {"limit-angles", limitAngleStep},
                                                {"canonical-ellipse", canonicalStep},
                                                {"ellipsoid", ellipsoidStep},
                                                {"projection", projectionStep},
                                                {"inverse-walk", inverseWalkStep},
                                                {"comparison", comparisonStep}};
  const bool seen = out.view && out.view->seen;
  const double distance =
      seen ? (out.view->seen->brightest.point.position - c.camera().centreInWorld()).norm() : workingDistance(*inspection.scene);
  for (const std::string& id : explainSteps()) {
    ExplainStep step;
    step.id = id;
    fill.at(id)(c, step);
    setLeast(step.numbers, distance);
    for (BrokenAssumption& b : step.broken) setLeast(b.numbers, distance);
    out.steps.push_back(std::move(step));
  }
  return out;
}

}  // namespace glint
