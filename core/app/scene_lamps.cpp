// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "core/app/lamp_answer.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/geometry/plane.h"
#include "core/light/estimate.h"
#include "core/light/left_out.h"
#include "core/model/plausible.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/known_lamps.h"
#include "core/pipeline/training.h"

namespace glint {
namespace {

constexpr double kContraryAngle = 6;     // degrees: no off-specular shift or blur turns a mirrored ray that far
constexpr double kContrarySpread = 5;    // standard deviations of the other views' angles
constexpr double kMadToSigma = 1.4826;   // of normal noise
constexpr std::size_t kMostPairs = 300;  // of rays that are tried as the lamp: all of 25 views
constexpr double kKnownInverse = 5;      // standard deviations of the inverse distance; ball lamps have the same
constexpr int kMostLeftOut = 8;          // parts of the views that are left out in turn: a spread of eight is known to a quarter
constexpr int kLeastLeftOut = 4;         // parts; fewer tell no spread
constexpr double kViewErrorPx = 0.2;     // of one view among too few to tell: a good pose, surface and lobe leave that much
constexpr double kOffSpecularPx = 1.4;   // how far a peak was seen from its mirror point (method.md, section 15)

struct SceneLight {
  std::string id;
  std::vector<int> views;   ///< indices into Inspection::views
  std::vector<int> frames;  ///< in which it is on or seen
};

std::vector<SceneLight> lightsOf(const Inspection& r) {
  std::vector<SceneLight> lights;
  const auto lightOf = [&](const std::string& id) -> SceneLight& {
    const auto at = std::find_if(lights.begin(), lights.end(), [&](const SceneLight& l) { return l.id == id; });
    return at != lights.end() ? *at : *lights.insert(lights.end(), SceneLight{id, {}, {}});
  };
  for (const int frame : r.train.frames) {
    if (!r.isTraining(frame)) continue;
    std::set<std::string> here;
    for (const std::string& id : r.scene->frames[static_cast<std::size_t>(frame)].lightsOn) {
      lightOf(id);
      here.insert(id);
    }
    for (std::size_t v = 0; v < r.views.size(); ++v) {
      if (r.views[v].frame != frame || r.views[v].highlight.light.empty()) continue;
      lightOf(r.views[v].highlight.light).views.push_back(static_cast<int>(v));
      here.insert(r.views[v].highlight.light);
    }
    for (const std::string& id : here) lightOf(id).frames.push_back(frame);
  }
  return lights;
}

/// Angles between the mirrored rays and a light, rad.
std::vector<double> anglesTo(const Light& light, const std::vector<ReflectedRay>& rays) {
  std::vector<double> angles;
  for (const ReflectedRay& r : rays) {
    const Eigen::Vector3d to = light.directionFrom(r.origin);
    angles.push_back(std::atan2(r.direction.cross(to).norm(), r.direction.dot(to)));
  }
  return angles;
}

/// Which of at least three rays go elsewhere than most of them.
std::vector<bool> contraryRays(const std::vector<ReflectedRay>& rays) {
  std::vector<bool> contrary(rays.size(), false);
  if (rays.size() < 3) return contrary;
  std::vector<double> best;
  double least = 0;
  const std::size_t pairs = rays.size() * (rays.size() - 1) / 2, stride = pairs / kMostPairs + 1;
  std::size_t next = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      if (next++ % stride != 0) continue;
      const Outcome<Triangulation> t = triangulateLight({rays[i], rays[j]});
      if (!t) continue;
      std::vector<double> angles = anglesTo(t->light, rays);
      // The two that made it fit it: the middle of the others counts.
      const double middle = upperMedian(angles);
      if (!best.empty() && middle >= least) continue;
      best = std::move(angles);
      least = middle;
    }
  if (best.empty()) return contrary;
  const double limit = std::max(radians(kContraryAngle), kContrarySpread * kMadToSigma * least);
  for (std::size_t i = 0; i < rays.size(); ++i) contrary[i] = best[i] > limit;
  return contrary;
}

/// Middle of the surfaces that the views see; of their brightest points where a surface has no bounds.
Eigen::Vector3d middleOf(const std::vector<TrainingView>& views) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const TrainingView& v : views) {
    const Eigen::AlignedBox3d box = v.surface->bounds();
    const bool bounded = box.min().allFinite() && box.max().allFinite();
    sum += bounded ? box.center() : v.seen->brightest.point.position;
  }
  return sum / static_cast<double>(views.size());
}

/// Direction and inverse distance of a light from a point, with the covariance of (two tangent coordinates, inverse distance).
struct SeenLight {
  Eigen::Vector3d direction;
  double inverse = 0;
  Eigen::Matrix3d covariance;
};
SeenLight seenFrom(const Eigen::Vector3d& from, const Light& light, const Eigen::MatrixXd& root) {
  const Eigen::Vector4d& lw = light.homogeneous();
  const Eigen::Vector3d q = lw.head<3>() - lw.w() * from;
  const double length = q.norm();
  SeenLight seen{q / length, lw.w() / length, {}};
  Eigen::Matrix<double, 3, 4> slopes;
  Eigen::Matrix<double, 3, 4> ofQ;
  ofQ << Eigen::Matrix3d::Identity(), -from;
  slopes.topRows<2>() = tangentBasis(seen.direction).transpose() * ofQ / length;
  slopes.row(2) = -seen.inverse / length * seen.direction.transpose() * ofQ;
  slopes(2, 3) += 1 / length;
  const Eigen::MatrixXd moved = slopes * root.topRows<4>();
  seen.covariance = moved * moved.transpose();
  return seen;
}

/// Covariance of (two tangent coordinates, inverse distance) by leaving out parts of the views in turn: (k - 1) / k times the sum
/// of squares about the mean (Efron, The Jackknife, 1982, 3.1). It holds the errors of whole views, which no residual within a
/// view shows: poses, bumps, a lobe that does not quite fit. Zero if fewer than four parts have an answer.
/// @param without  the light of the views that are true
Eigen::Matrix3d leftOutCovariance(const Eigen::Vector3d& from, const SeenLight& seen, std::size_t views,
                                  const std::function<std::optional<Light>(const std::vector<bool>&)>& without) {
  const int parts = std::min(static_cast<int>(views), kMostLeftOut);
  if (parts < kLeastLeftOut) return Eigen::Matrix3d::Zero();
  std::vector<Eigen::Vector3d> moved;
  for (int part = 0; part < parts; ++part) {
    std::vector<bool> kept(views);
    for (std::size_t v = 0; v < views; ++v) kept[v] = static_cast<int>(v) % parts != part;
    const std::optional<Light> light = without(kept);
    if (!light) continue;
    const SeenLight other = seenFrom(from, *light, Eigen::MatrixXd::Zero(4, 1));
    Eigen::Vector3d m;
    m << tangentBasis(seen.direction).transpose() * (other.direction - seen.direction), other.inverse - seen.inverse;
    moved.push_back(m);
  }
  if (static_cast<int>(moved.size()) < kLeastLeftOut) return Eigen::Matrix3d::Zero();
  const double k = static_cast<double>(moved.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& m : moved) mean += m / k;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& m : moved) squares += (m - mean) * (m - mean).transpose();
  return (k - 1) / k * squares;
}

class SceneLamp {
 public:
  SceneLamp(const Inspection& r, const SceneLight& light) : r_(r), light_(light) {}

  LampAnswer run() {
    a_.id = light_.id;
    a_.frame = r_.lightFrame.frameOf(light_.id);
    a_.frameReason = r_.lightFrame.reason;
    if (!r_.lightFrame.doubt.empty()) a_.remarks.push_back(r_.lightFrame.doubt);
    for (const int frame : light_.frames) a_.frames.push_back(idOf(frame));
    gather();
    if (views_.empty()) {
      if (!a_.failure)
        a_.failure = Failure{Reason::NoHighlight, "no frame shows a highlight of this lamp that can be told apart"};
      return a_;
    }
    dropContrary();
    a_.from = middleOf(views_);
    if (!fromModel() && !fromBundle()) fromRays();
    compareWithStated();
    return a_;
  }

 private:
  /// Where the scene states the lamp as known: by how much the highlights see it elsewhere.
  void compareWithStated() {
    const std::optional<KnownLamp> stated = knownLamp(*r_.scene, light_.id);
    if (!stated || a_.failure) return;
    const Eigen::Vector3d to = lightOf(stated->lamp).directionFrom(*a_.from);
    a_.remarks.push_back(formatted("the scene states this lamp: it lies %.2g\u00b0 from the measured direction",
                                   degrees(std::atan2(to.cross(a_.direction).norm(), to.dot(a_.direction)))));
  }
  const std::string& idOf(int frame) const { return r_.scene->frames[static_cast<std::size_t>(frame)].id; }

  void drop(const TrainingView& v, const std::string& reason) {
    a_.dropped.push_back({idOf(v.frame), std::nullopt, v.camera.distorted(v.highlight.peak), reason});
  }

  void gather() {
    for (const int v : light_.views) {
      TrainingView view = r_.viewAsGiven(v);
      view.known.reset();  // the highlights are asked, not the scene
      if (view.seen) {
        // The points of a given contour may be exact; points between them lie on chords, inside the contour.
        Polyline& contour = view.highlight.contour;
        if (view.highlight.fromScene) contour.points = thinned(contour, r_.request.settings.integer("light.bundle_points"));
        views_.push_back(std::move(view));
        continue;
      }
      if (!a_.failure) a_.failure = Failure{view.failure()->reason, "frame " + idOf(view.frame) + ": " + view.failure()->detail};
      drop(view, view.failure()->message());
    }
    if (!views_.empty()) a_.failure.reset();
    whole_ = true;
  }

  void dropContrary() {
    std::vector<ReflectedRay> rays;
    for (const TrainingView& v : views_) rays.push_back(reflectedRay(v.seen->brightest, v.camera));
    const std::vector<bool> contrary = contraryRays(rays);
    std::vector<TrainingView> kept;
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (contrary[i]) {
        drop(views_[i], "contradicts the other frames: its mirrored ray passes far from the lamp that the others see");
        whole_ = false;
      } else {
        kept.push_back(std::move(views_[i]));
      }
    views_ = std::move(kept);
  }

  bool fromModel() {
    const Settings& settings = r_.request.settings;
    LightFit lit = fitLight(views_, *r_.scene, *r_.surfaces, settings, r_.chosenFor(r_.keyFor(views_.front().frame, light_.id)));
    views_ = std::move(lit.views);
    estimate_ = std::move(lit.light);
    const auto known = r_.pixelFits.find(r_.keyFor(views_.front().frame, light_.id));
    const bool use =
        whole_ && !lit.correction && !knownLamp(*r_.scene, light_.id) && known != r_.pixelFits.end() && known->second;
    const Outcome<ModelFit> fit =
        accepted(fitModel(radianceModel(), views_, estimate_, settings, use ? KnownPixels{*known->second} : KnownPixels{}),
                 PoorFits::Refuse);
    if (!fit || !fit->lightEstimate || !fit->uncertainty) return false;
    a_.solver = fit->solver;
    a_.remarks = fit->remarks;
    a_.degreesOfFreedom = fit->uncertainty->degreesOfFreedom;
    const auto near = std::make_shared<const ModelFit>(*fit);
    // Contours instead of pixels: errors of views move both, and a fit takes a twentieth of the time.
    Settings ofContours = settings;
    if (settings.text("fit.evidence") != "levels") ofContours.set("fit.evidence", std::string("contours"));
    const auto again = [&](const std::vector<bool>& kept) -> std::optional<Light> {
      FitInput input = fitInput(radianceModel(), part(kept), estimate_, ofContours);
      input.near = near;
      const Outcome<ModelFit> other = accepted(radianceModel().fit(input, ofContours), PoorFits::Refuse);
      return other ? other->lightEstimate : std::nullopt;
    };
    return place(*fit->lightEstimate, fit->uncertainty->root.topRows(4), fit->residualPx, again);
  }

  bool fromBundle() {
    if (!estimate_) return false;
    a_.solver = estimate_->solver;
    const auto again = [&](const std::vector<bool>& kept) -> std::optional<Light> {
      const Outcome<LightEstimate> other = estimateLight(part(kept), r_.request.settings);
      return other ? std::optional(other->light) : std::nullopt;
    };
    a_.degreesOfFreedom = estimate_->uncertainty ? estimate_->uncertainty->degreesOfFreedom : 0;
    if (estimate_->uncertainty)
      return place(estimate_->light, estimate_->uncertainty->root.topRows(4), estimate_->residualPx, again);
    if (!estimate_->covariance || estimate_->light.atInfinity()) return false;
    // A position has homogeneous coordinates with w = 1, so that d(l / w) = dl.
    Eigen::MatrixXd root = Eigen::MatrixXd::Zero(4, 3);
    root.topRows<3>() = estimate_->covariance->llt().matrixL();
    return place(estimate_->light, root * estimate_->light.homogeneous().w(), estimate_->residualPx, again);
  }

  std::vector<TrainingView> part(const std::vector<bool>& kept) const {
    std::vector<TrainingView> views;
    for (std::size_t v = 0; v < kept.size(); ++v)
      if (kept[v]) views.push_back(views_[v]);
    return views;
  }

  /// By how much the mirrored ray of a view turns when its peak moves by a pixel, rad.
  double turnPerPixel(const TrainingView& v) const {
    const Eigen::Vector3d here = reflectedRay(v.seen->brightest, v.camera).direction;
    double most = 0;
    for (const Pixel& by : {Pixel(1, 0), Pixel(-1, 0), Pixel(0, 1), Pixel(0, -1)})
      if (const Outcome<BrightestPoint> b = observedBrightestPoint(*v.surface, v.camera, v.highlight.peak + by))
        most = std::max(most, (reflectedRay(*b, v.camera).direction - here).norm());
    return most;
  }

  /// Covariance (as above) if each view is off by kViewErrorPx on its own: what a few views cannot show themselves.
  Eigen::Matrix3d assumedCovariance(const SeenLight& seen) const {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const TrainingView& v : views_) {
      const Eigen::Vector3d& at = v.seen->brightest.point.position;
      const Eigen::Vector3d to = (seen.direction - seen.inverse * (at - *a_.from)).normalized();
      Eigen::Matrix3d by;
      by << tangentBasis(seen.direction), *a_.from - at;
      const Eigen::Matrix<double, 2, 3> rows = tangentBasis(to).transpose() * by;
      information += rows.transpose() * rows / std::pow(kViewErrorPx * turnPerPixel(v), 2);
    }
    return information.inverse();
  }

  void addResidual(const std::vector<double>& residualPx) {
    a_.highlights = static_cast<int>(views_.size());
    double squares = 0;
    for (const double px : residualPx) squares += px * px;
    if (!residualPx.empty()) a_.residualPx = std::sqrt(squares / static_cast<double>(residualPx.size()));
  }

  /// All views from one place see one ray: what a fit says of the distance along it is the lobe's shape, no evidence.
  bool placeFromOneView(const Light& light, const Eigen::MatrixXd& root) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double variance = 0;
    for (const TrainingView& v : views_) {
      const SeenLight seen = seenFrom(v.seen->brightest.point.position, light, root);
      sum += seen.direction;
      const double assumed = kViewErrorPx * turnPerPixel(v);
      variance = std::max(variance, seen.covariance.topLeftCorner<2, 2>().trace() + 2 * assumed * assumed);
    }
    if (!sum.allFinite() || !std::isfinite(variance)) return false;
    a_.direction = sum.normalized();
    a_.directionSigma = std::sqrt(variance);
    a_.withoutPosition = "one view leaves the distance open; the direction is that of a distant lamp";
    return true;
  }

  /// @param root  of the homogeneous coordinates of length 1. @param without  see leftOutCovariance()
  bool place(const Light& light, const Eigen::MatrixXd& root, const std::vector<double>& residualPx,
             const std::function<std::optional<Light>(const std::vector<bool>&)>& without) {
    addResidual(residualPx);
    if (countOf(placesOf(views_)) < 2) return placeFromOneView(light, root);
    SeenLight seen = seenFrom(*a_.from, light, root);
    if (!seen.covariance.allFinite() || !seen.direction.allFinite()) return false;
    Eigen::Matrix3d ofViews = leftOutCovariance(*a_.from, seen, views_.size(), without);
    const bool few = ofViews.isZero(0);
    if (few) ofViews = assumedCovariance(seen);
    seen.covariance += ofViews;
    const double sigma = std::sqrt(seen.covariance(2, 2));
    a_.direction = seen.direction;
    a_.directionSigma = std::sqrt(seen.covariance.topLeftCorner<2, 2>().trace());
    if (!std::isfinite(a_.directionSigma)) return false;
    if (!(seen.inverse > kKnownInverse * sigma)) {
      a_.withoutPosition = "parallel rays: the lamp is farther away than its highlights can tell";
      const double nearest = 1 / (std::max(0.0, seen.inverse) + 1.645 * sigma);
      if (!few && std::isfinite(nearest)) a_.withoutPosition += formatted(", at %.3g m or more (95 %%)", nearest);
      return true;
    }
    Eigen::Matrix3d slopes;
    slopes << tangentBasis(seen.direction) / seen.inverse, -seen.direction / (seen.inverse * seen.inverse);
    a_.position = light.position();
    a_.covariance = slopes * seen.covariance * slopes.transpose();
    return true;
  }

  /// The mean of the mirrored rays: all that is left.
  void fromRays() {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> directions;
    double turned = 0;
    for (const TrainingView& v : views_) {
      directions.push_back(reflectedRay(v.seen->brightest, v.camera).direction);
      sum += directions.back();
      turned = std::max(turned, kOffSpecularPx * turnPerPixel(v));
    }
    const double n = static_cast<double>(views_.size());
    if (!(sum.norm() > 0.5 * n)) {
      a_.failure =
          Failure{Reason::NotConverged, "the mirrored rays of " + std::to_string(views_.size()) + " views point everywhere"};
      return;
    }
    a_.direction = sum.normalized();
    double squares = 0;
    for (const Eigen::Vector3d& d : directions) squares += (d - a_.direction).squaredNorm();
    a_.directionSigma = std::max(turned, n > 1 ? std::sqrt(squares / (n - 1)) : 0);
    a_.highlights = static_cast<int>(views_.size());
    a_.residualPx = a_.degreesOfFreedom = 0;  // of a fit that was not taken
    a_.solver = "mirror rays";
    a_.withoutPosition = "only the mirrored rays of the peaks were used; " +
                         (estimate_ ? std::string("no fit explains the contours") : estimate_.failure().message());
  }

  const Inspection& r_;
  const SceneLight& light_;
  std::vector<TrainingView> views_;
  bool whole_ = true;  ///< all usable views count: the inspection's own fits are of them
  Outcome<LightEstimate> estimate_ = Failure{Reason::NotReached, "not estimated"};
  LampAnswer a_;
};

}  // namespace

std::vector<LampAnswer> lampsOfScene(const Inspection& inspection, const ProgressFn& progress) {
  const std::vector<SceneLight> lights = lightsOf(inspection);
  std::vector<LampAnswer> answers(lights.size());
  parallelFor(
      static_cast<int>(lights.size()),
      [&](int i) { answers[static_cast<std::size_t>(i)] = SceneLamp(inspection, lights[static_cast<std::size_t>(i)]).run(); },
      progress, "lamps");
  return answers;
}

}  // namespace glint
