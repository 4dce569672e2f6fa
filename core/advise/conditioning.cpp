// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/conditioning.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/highlight/peak.h"
#include "core/light/estimate.h"
#include "core/model/fit_ellipsoid.h"
#include "core/model/plausible.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

constexpr const char* kLightOfOneAngle =
    " It covers noise only: a real lobe moves the light of one limit angle off the lamp by more than that. `glint lights` "
    "measures lamps.";
constexpr std::size_t kMostDirections = 256;  // 33,000 pairs: a millisecond

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Small numbers are good.
Verdict below(double value, double amber, double red) {
  return !std::isfinite(value) ? Verdict::Unknown : value < amber ? Verdict::Green : value < red ? Verdict::Amber : Verdict::Red;
}
/// Large numbers are good.
Verdict above(double value, double amber, double red) {
  return !std::isfinite(value) ? Verdict::Unknown
         : value >= amber      ? Verdict::Green
         : value >= red        ? Verdict::Amber
                               : Verdict::Red;
}

const char* chosen(Verdict v, const char* green, const char* amber, const char* red) {
  return v == Verdict::Green ? green : v == Verdict::Amber ? amber : v == Verdict::Red ? red : "";
}

/// The outlines that the model takes for those of its ellipsoid.
std::vector<ConicView> outlinesOf(const HighlightModel& model, const std::vector<TrainingView>& views) {
  std::vector<ConicView> conics;
  for (const TrainingView& v : views)
    if (std::optional<ConicView> outline = model.outlineIn(v)) conics.push_back(*std::move(outline));
  return conics;
}

/// Where each view looks for the reconstructed thing: along its reflected ray, or straight on for a model without a mirror.
std::vector<Eigen::Vector3d> raysOf(const HighlightModel& model, const std::vector<TrainingView>& views) {
  std::vector<Eigen::Vector3d> rays;
  for (const TrainingView& v : views) {
    if (!model.traits().mirrored) {
      if (const std::optional<ConicView> outline = model.outlineIn(v))
        rays.push_back(v.camera.ray(outline->ellipse.centre).direction.normalized());
    } else if (v.seen) {
      rays.push_back(reflectedRay(v.seen->brightest, v.camera).direction);
    }
  }
  return rays;
}

class Findings {
 public:
  Findings(const Inspection& inspection, const ModelResult& result, const ModelResult::Fit& fit)
      : inspection_(inspection),
        result_(result),
        fit_(fit),
        model_(modelByName(result.model)),
        views_(inspection.viewsOf(fit.key())),
        rays_(raysOf(model_, views_)) {
    c_.model = result.model;
    c_.light = fit.light;
    c_.surface = fit.surface;
    c_.poor = fit.fit && !fit.fit->poor.empty();
    estimate_ = inspection.lightOf(fit.key());
    outlines_ = outlinesOf(model_, views_);
    if (model_.traits().mirrored) findStrayPeaks();  // without a mirror it looks at ellipses only
  }

  Conditioning all() {
    if (fit_.failure()) add("fit", "fit", std::nan(""), "failed", Verdict::Red, "No fit: " + fit_.failure()->message() + ".");
    addPeaks();
    if (model_.hasOutlines()) addLinearSystem();
    const bool held = estimate_ && estimate_->known && model_.needsLight();  // rays need not meet in a lamp that is stated
    if (!held) {
      addAngle();
      addViews();
      addLight();
    }
    addResidual();
    return std::move(c_);
  }

 private:
  void add(const char* id, const char* title, double value, std::string valueText, Verdict verdict, std::string reason) {
    if (verdict == Verdict::Green && !strayFrames_.empty()) {
      verdict = Verdict::Amber;
      reason += " It rests on evidence whose peak lies outside its contour, so it proves little.";
    }
    c_.findings.push_back({id, title, value, std::move(valueText), verdict, std::move(reason)});
  }

  void findStrayPeaks() {
    for (const TrainingView& v : views_) {
      if (!v.seen) continue;
      const double away = outsideOfContour(v.highlight);
      if (away == 0) continue;
      farthestStray_ = std::max(farthestStray_, away);
      strayFrames_.push_back(frameNameOf(v));
    }
  }

  void addPeaks() {
    if (strayFrames_.empty()) return;
    const int stray = int(strayFrames_.size());
    add("peaks", "peaks", stray, formatted("%d outside", stray), Verdict::Red,
        formatted("The peak lies outside its own contour in %d of %d training views (%s), by up to %.3g px: the ray through it "
                  "does not come from the highlight, so the light is sought in the wrong place.",
                  stray, int(rays_.size()), framesText(strayFrames_).c_str(), farthestStray_));
  }

  void addLinearSystem() {
    std::optional<Eigen::Vector3d> origin;
    if (!model_.traits().mirrored) {
      if (const std::optional<CentreAnchor> anchor = anchorFromCentres(views_)) origin = anchor->position;
    } else if (estimate_ && !estimate_->light.atInfinity()) {
      origin = estimate_->light.position();
    }
    // Asked to refuse nothing: what would be refused is what is to be shown.
    ReconstructOptions anything;
    anything.minRankRatio = 0;
    anything.maxGapRatio = std::numeric_limits<double>::infinity();
    const Outcome<Reconstruction> linear = reconstructLinear(outlines_, origin, anything);
    if (!linear) {
      add("signature", "Q*", std::nan(""), "undetermined", fit_.fit ? Verdict::Amber : Verdict::Red,
          "The contours alone do not determine a quadric (" + linear.failure().message() + ")" +
              (fit_.fit ? "; the ellipsoid shown relies on the expected position of its centre." : "."));
      return;
    }
    c_.singularValues = linear->singularValues;
    c_.quadricKind = describe(linear->quadric);
    const std::size_t n = c_.singularValues.size();
    const double rank = c_.singularValues[n - 2] / c_.singularValues[0], gap = linear->gapRatio;
    const Verdict rankVerdict = above(rank, bounds::kRankAmber, bounds::kRankRed);
    add("rank", "singular values", rank, formatted("%.2g", rank), rankVerdict,
        formatted("The second-last singular value is %.2g of the first: ", rank) +
            chosen(rankVerdict, "above 1e-4, the accuracy of contours, so the views tell quadrics apart.",  // kRankAmber
                   "below 1e-4, the accuracy of contours, so a second quadric hides in the noise.",
                   "below 1e-9, round-off: the views repeat one geometry and several quadrics fit."));  // kRankRed
    const Verdict gapVerdict = below(gap, bounds::kGapAmber, bounds::kGapRed);
    add("gap", "gap", gap, formatted("%.2g", gap), gapVerdict,
        formatted("The last singular value is %.2g of the one before: ", gap) +
            chosen(gapVerdict, "below 0.2, so the best quadric fits more than five times better than the second.",
                   "above 0.2, so the second-best quadric fits nearly as well.",
                   "above 0.5, where the linear solver refuses: no quadric fits clearly better than another."));
    const Signature s = signatureOf(linear->quadric);
    const std::string signs = formatted("(%d+ %d- %dx0)", s.positive, s.negative, s.zero);
    const bool good = linear->ellipsoid.has_value();
    std::string reason = "The contours alone, without any prior, give a Q* of signature " + signs + ": " + c_.quadricKind + ".";
    if (!good)
      reason += fit_.fit && fit_.fit->ellipsoid() ? " The solver '" + fit_.fit->solver +
                                                        "' forced an ellipsoid; it relies on the expected position of its centre."
                                                  : " This is not an ellipsoid, so it has no outline to predict with.";
    add("signature", "Q*", double(s.positive - s.negative), c_.quadricKind,
        good                                ? Verdict::Green
        : fit_.fit && fit_.fit->ellipsoid() ? Verdict::Amber
                                            : Verdict::Red,
        reason);
  }

  void addAngle() {
    const char* what = model_.traits().mirrored ? "reflected rays" : "viewing rays";
    if (rays_.size() < 2)
      return add("angle", "triangulation angle", std::nan(""), "-", Verdict::Red,
                 formatted("Fewer than two %s: nothing can be triangulated.", what));
    const double angle = widestAngle(rays_);
    const double deg = degrees(angle);
    const Verdict v = above(deg, bounds::kAngleAmberDeg, bounds::kAngleRedDeg);
    const double factor = 1 / std::max(std::sin(std::min(angle, std::numbers::pi / 2)), std::numeric_limits<double>::min());
    std::string reason =
        formatted("The widest angle between two %s is %.3g\u00b0: an error across them is %.3g times as large along them", what,
                  deg, factor);
    reason += chosen(v, ".", " (amber below 5\u00b0).", " (red below 1.5\u00b0): only a direction is known well.");
    add("angle", "triangulation angle", deg, formatted("%.3g\u00b0", deg), v, reason);
  }

  void addViews() {
    const double effective = effectiveNumber(rays_, radians(bounds::kAngleAmberDeg));
    const Verdict v = above(effective, bounds::kViewsAmber, bounds::kViewsRed);
    std::string reason =
        formatted("%d training highlights count as %.2g different views (those within 5\u00b0 of each other count in part): ",
                  int(rays_.size()), effective);
    reason += model_.hasOutlines()
                  ? chosen(v, "three or more determine an ellipsoid with a free centre.",
                           "fewer than three, which an ellipsoid with a free centre needs.",
                           "fewer than two: only the contours' shape tells the light's distance and an ellipsoid.")
                  : chosen(v, "three or more determine the light and leave data to check it.",
                           "fewer than three: two determine the light, but no data is left to check it.",
                           "fewer than two: only the contours' shape tells the light's distance.");
    add("views", "effective views", effective, formatted("%.2g of %d", effective, int(rays_.size())), v, reason);
  }

  /// Mean distance from the views' brightest points, or from the cameras for a model that knows no mirror.
  double distanceFrom(const Eigen::Vector3d& at) const {
    double sum = 0;
    int n = 0;
    for (const TrainingView& v : views_) {
      const bool mirrored = model_.traits().mirrored;
      if (mirrored && !v.seen) continue;
      sum += (at - (mirrored ? v.seen->brightest.point.position : v.camera.centreInWorld())).norm();
      ++n;
    }
    return n ? sum / n : std::nan("");
  }

  static double largestSigma(const Eigen::Matrix3d& covariance) {
    if (!covariance.allFinite()) return std::nan("");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, eigen.eigenvalues()(2)));
  }

  void addLight() {
    const ModelFit* fit = fit_.fit ? &*fit_.fit : nullptr;
    const bool hasLight = fit && fit->lightEstimate;
    const char* title = hasLight ? "light uncertainty" : "centre uncertainty";
    if (!fit) return;
    if (hasLight && fit->lightEstimate->atInfinity()) {
      const ParameterUncertainty* u = estimate_ && estimate_->uncertainty ? &*estimate_->uncertainty : nullptr;
      const double sigma = u && u->root.rows() >= 4
                               ? largestSigma(Eigen::Matrix3d(u->root.topRows(3) * u->root.topRows(3).transpose()))
                               : std::nan("");
      const Verdict v = below(sigma, bounds::kLightAmber, bounds::kLightRed);
      return add("light", title, sigma, std::isfinite(sigma) ? formatted("%.2g\u00b0", degrees(sigma)) : "-", v,
                 std::isfinite(sigma)
                     ? formatted("The light is at infinity; its direction is known to %.2g\u00b0 (one standard deviation).",
                                 degrees(sigma))
                     : "The light is at infinity; its solver gives no uncertainty of the direction.");
    }
    Eigen::Vector3d at(0, 0, 0);
    double sigma = std::nan("");
    if (hasLight) {
      at = fit->lightEstimate->position();
      if (fit->lightCovariance) sigma = largestSigma(*fit->lightCovariance);
    } else if (fit->ellipsoid()) {
      at = fit->ellipsoid()->centre();
      if (fit->uncertainty && fit->uncertainty->root.rows() >= 3)
        sigma = largestSigma(Eigen::Matrix3d(fit->uncertainty->root.topRows(3) * fit->uncertainty->root.topRows(3).transpose()));
    } else {
      return;
    }
    const double share = sigma / distanceFrom(at);
    if (!std::isfinite(share))
      return add("light", title, share, "-", Verdict::Unknown, "The solver of this fit gives no uncertainty.");
    const Verdict v = below(share, bounds::kLightAmber, bounds::kLightRed);
    std::string reason =
        formatted("One standard deviation along the worst direction is %.2g m, %.2g %% of the distance to the surface: ", sigma,
                  100 * share);
    reason += chosen(v, "below 1 %, less than the error of the light that a simple lobe causes.",
                     "above 1 %, the error of the light that a simple lobe causes.",
                     "above 10 %, worse than the error that any lobe causes: add more views, or views farther apart.");
    add("light", title, share, formatted("%.2g %%", 100 * share), v,
        reason + (hasLight && fit->as<ReflectanceFit>() == nullptr ? kLightOfOneAngle : " It covers noise only."));
  }

  void addResidual() {
    if (!fit_.fit) return;
    double squares = 0, diameters = 0, rms = estimate_ && fit_.fit->residualPx.empty() ? estimate_->rmsPx : 0;
    int n = 0;
    for (const double r : fit_.fit->residualPx) squares += r * r;
    if (!fit_.fit->residualPx.empty()) rms = std::sqrt(squares / double(fit_.fit->residualPx.size()));
    // Diameters of what was fitted: a bent surface's canonical contour is several times as large as the highlight.
    if (model_.hasOutlines())
      for (const ConicView& v : outlines_) diameters += 2 * std::sqrt(v.ellipse.semiAxes.prod()), ++n;
    else
      for (const TrainingView& v : views_)
        if (v.seen && v.highlight.areaPx2 > 0) diameters += 2 * std::sqrt(v.highlight.areaPx2 / std::numbers::pi), ++n;
    if (n == 0 || (fit_.fit->residualPx.empty() && !(rms > 0))) return;
    const double share = rms / (diameters / n);
    const Verdict v = below(share, bounds::kResidualAmber, bounds::kResidualRed);
    std::string reason = formatted("%s%.2g px, %.2g %% of %s mean diameter: ",
                                   ("Distance " + residualMeaning(*fit_.fit) + ", over the training views: ").c_str(), rms,
                                   100 * share, model_.needsCanonicalContours() ? "the canonical contours'" : "the highlights'");
    // Every observed point may lie near an outline that runs far beyond the highlight: then this number says nothing.
    if (const std::optional<ContourMetrics> worst = worstInTraining(); worst && worst->contourErrorPct > kOwnSizePct) {
      reason +=
          formatted("but the mean distance both ways in a training frame is up to %.3g px, more than the size of the highlight.",
                    worst->contourErrorPx);
      return add("residual", "fit residual", share, std::isfinite(rms) ? formatted("%.2g px", rms) : "-", Verdict::Red, reason);
    }
    reason +=
        chosen(v, "below 1 %, the model reproduces the highlights.", "above 1 %, the model only approximates the highlights.",
               "above 5 %, the model does not describe these highlights.");
    add("residual", "fit residual", share, std::isfinite(rms) ? formatted("%.2g px", rms) : "-", v, reason);
  }

  /// The largest error of this fit in a frame that it has learnt from.
  std::optional<ContourMetrics> worstInTraining() const {
    std::optional<ContourMetrics> worst;
    for (const FrameComparison& comparison : result_.frames) {
      const bool ofThisFit = comparison.fit >= 0 && std::size_t(comparison.fit) < result_.fits.size() &&
                             &result_.fits[std::size_t(comparison.fit)] == &fit_;
      if (!ofThisFit || !inspection_.isTraining(comparison.frame)) continue;
      for (const FrameComparison::Row& row : comparison.rows)
        if (row.metrics && (!worst || row.metrics->contourErrorPx > worst->contourErrorPx)) worst = row.metrics;
    }
    return worst;
  }

  const Inspection& inspection_;
  const ModelResult& result_;
  const ModelResult::Fit& fit_;
  const HighlightModel& model_;
  std::vector<TrainingView> views_;
  std::vector<Eigen::Vector3d> rays_;
  std::vector<ConicView> outlines_;
  const LightEstimate* estimate_ = nullptr;
  std::vector<std::string> strayFrames_;  ///< ids of those whose peak lies outside its contour
  double farthestStray_ = 0;              ///< px
  Conditioning c_;
};

}  // namespace

const char* nameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::Green: return "good";
    case Verdict::Amber: return "doubtful";
    case Verdict::Red: return "bad";
    case Verdict::Unknown: return "unknown";
  }
  return "";
}

Verdict Conditioning::worst() const {
  Verdict w = Verdict::Unknown;
  for (const Finding& f : findings) {
    if (f.verdict == Verdict::Unknown) continue;
    if (w == Verdict::Unknown || f.verdict > w) w = f.verdict;
  }
  return w;
}

double widestAngle(const std::vector<Eigen::Vector3d>& directions) {
  const std::vector<Eigen::Vector3d> d = evenly(directions, kMostDirections);
  double widest = 0;
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t j = i + 1; j < d.size(); ++j) widest = std::max(widest, angleBetween(d[i], d[j]));
  return widest;
}

double effectiveNumber(const std::vector<Eigen::Vector3d>& directions, double independent) {
  require(independent > 0, "effectiveNumber: the independent angle must be positive");
  const std::vector<Eigen::Vector3d> d = evenly(directions, kMostDirections);
  if (d.empty()) return 0;
  double similar = double(d.size());  // each with itself
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t j = i + 1; j < d.size(); ++j) similar += 2 * std::max(0.0, 1 - angleBetween(d[i], d[j]) / independent);
  return double(d.size()) * double(d.size()) / similar;
}

namespace {
constexpr const char* kToLevelSet = "from the observed contour to the level set, RMS";
}

std::string residualMeaning(const LightEstimate&) { return kToLevelSet; }

std::string residualMeaning(const ModelFit& fit) {
  if (!fit.as<EllipsoidFit>()) return kToLevelSet;
  const HighlightModel* const model = findModel(fit.model);
  return std::string("from the ") + (model && model->needsCanonicalContours() ? "canonical" : "observed") +
         " contour to the outline, one way, RMS";
}

std::optional<Eigen::Vector3d> semiAxesSigma(const ModelFit& fit) {
  const Ellipsoid* const e = fit.ellipsoid();
  if (!e || !fit.uncertainty || !parameters::kShape.isIn(fit.uncertainty->root) || fit.uncertainty->root.cols() == 0)
    return std::nullopt;
  const Eigen::MatrixXd shape = parameters::kShape.of(fit.uncertainty->root);
  Eigen::Vector3d sigma;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d v = e->worldFromBody().linear().col(i);
    Eigen::Matrix<double, 1, 6> squares;
    squares << v.x() * v.x(), v.y() * v.y(), v.z() * v.z(), 2 * v.x() * v.y(), 2 * v.x() * v.z(), 2 * v.y() * v.z();
    sigma(i) = (squares * shape).norm() / (2 * e->semiAxes()(i));
  }
  return sigma;
}

std::vector<Conditioning> conditioningOf(const Inspection& inspection) {
  std::vector<Conditioning> all;
  const auto take = [&](const ModelResult& result) {
    for (const ModelResult::Fit& fit : result.fits) all.push_back(Findings(inspection, result, fit).all());
  };
  for (const auto& model : allModels())
    if (const auto it = inspection.models.find(model->id()); it != inspection.models.end()) take(it->second);
  return all;
}

}  // namespace glint
