// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/known_lamps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/geometry/transforms.h"
#include "core/light/estimate.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/training.h"

namespace glint {
namespace {

// Share of the radius. A lamp that is not held takes up what one limit angle leaves of a lobe. Under a held one a path tracer's
// lobe leaves 1.7 % and errs by 0.8 % of the diameter; contours of one limit angle leave 0.01 %.
constexpr double kOneAngleShare = 0.015;
constexpr int kLimitPoints = 36;         // of a contour, for the angle that it reaches
constexpr double kFarthestMirror = 0.2;  // rad: wide lobes at slanted views shift the peak from the mirror point by less

/// What carries coordinates in which one lamp stands somewhere to coordinates in which it stands where the other one does.
Eigen::Isometry3d carriage(const Lamp& from, const Lamp& to, const Eigen::Vector3d& pivot) {
  if (from.centre == to.centre) return Eigen::Isometry3d::Identity();
  if (!from.atInfinity()) return Eigen::Isometry3d(Eigen::Translation3d(lightOf(to).position() - lightOf(from).position()));
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(lightOf(from).directionFrom(pivot), lightOf(to).directionFrom(pivot));
  return Eigen::Translation3d(pivot) * turn * Eigen::Translation3d(-pivot);
}

/// Three changes of L, homogeneous with |L| = 1, each for one standard deviation of the stated place or direction.
Eigen::Matrix<double, 4, 3> statedColumns(const KnownLamp& known) {
  Eigen::Matrix<double, 4, 3> columns = Eigen::Matrix<double, 4, 3>::Zero();
  const Eigen::Vector4d l = lightOf(known.lamp).homogeneous();
  if (known.lamp.atInfinity()) {
    const Eigen::Vector3d d = l.head<3>(), across = d.unitOrthogonal();
    columns.topRows<3>() << known.sigma * across, known.sigma * d.cross(across), Eigen::Vector3d::Zero();
  } else {
    columns.topRows<3>().diagonal().setConstant(known.sigma * l.w());
    columns -= l * (l.transpose() * columns);
  }
  return columns;
}

/// How far a highlight lies from where its known lamp mirrors, as a half angle; nothing for a view without either.
std::optional<double> missedAngle(const TrainingView& v) {
  if (!v.seen || !v.known) return std::nullopt;
  return halfAngleAt(v.seen->brightest.point, v.camera, v.known->lamp);
}

/// Further than that, the lamp and its highlight contradict each other. @param limit  that the contours reach, rad
double mostMissed(const TrainingView& v, double limit) {
  const KnownLamp& known = *v.known;
  // The half vector turns by half of the lamp's own error: this is twice its standard deviation.
  if (known.lamp.atInfinity()) return limit + known.sigma;
  return limit + known.sigma / (lightOf(known.lamp).position() - v.seen->brightest.point.position).norm();
}

/// What a fit leaves of contours beyond their points' noise, as a share of their radius (root of the mean square).
double shareLeft(const std::vector<double>& residualPx, const std::vector<UsedContour>& used) {
  double squares = 0;
  for (std::size_t i = 0; i < used.size(); ++i)
    squares += std::max(0.0, std::pow(residualPx[i], 2) - std::pow(used[i].noise, 2)) / std::pow(used[i].radius, 2);
  return used.empty() ? 0 : std::sqrt(squares / double(used.size()));
}

std::string missedText(double angle) {
  return formatted("the highlight lies %.2g\u00b0 from where the known lamp mirrors: its place or its name may be wrong",
                   degrees(angle));
}

/// Views that contradict their lamp are no evidence of the material. Most of them must be right.
void dropContradictions(std::vector<TrainingView>& views, const KnownLamp& lamp) {
  std::vector<double> limits;
  for (const TrainingView& v : views)
    if (v.seen) limits.push_back(medianContourAngle({v}, lightOf(lamp.lamp), kLimitPoints));
  if (limits.empty()) return;
  const double limit = upperMedian(limits);
  for (TrainingView& v : views)
    if (const std::optional<double> missed = missedAngle(v); missed && *missed > mostMissed(v, limit))
      v.seen = Failure{Reason::NotSupported, missedText(*missed)};
}

}  // namespace

std::optional<KnownLamp> knownLamp(const Scene& scene, const std::string& light) {
  const auto stated =
      std::find_if(scene.lights.begin(), scene.lights.end(), [&](const TrueLight& l) { return l.known && l.id == light; });
  if (stated == scene.lights.end()) return std::nullopt;
  return KnownLamp{stated->lamp, stated->lamp.atInfinity() ? radians(stated->sigma) : stated->sigma};
}

bool knowsAllLamps(const Scene& scene, const Frame& frame) {
  if (scene.lights.empty()) return false;
  if (frame.lightsOn.empty())
    return std::all_of(scene.lights.begin(), scene.lights.end(), [](const TrueLight& l) { return l.known; });
  return std::all_of(frame.lightsOn.begin(), frame.lightsOn.end(),
                     [&](const std::string& id) { return knownLamp(scene, id).has_value(); });
}

double halfAngleAt(const SurfacePoint& point, const Camera& camera, const Lamp& lamp) {
  const Eigen::Vector3d toCamera = (camera.centreInWorld() - point.position).normalized();
  return incidentAngle(point.normal, lightOf(lamp).directionFrom(point.position), toCamera);
}

bool shareMaterial(const KnownLamp& a, const KnownLamp& b) {
  return a.lamp.atInfinity() == b.lamp.atInfinity() && a.lamp.shape == b.lamp.shape;
}

TrainingView carriedTo(const TrainingView& view, const KnownLamp& lamp, const Eigen::Vector3d& pivot) {
  require(view.known.has_value(), "carriedTo: a view of a known lamp");
  const Eigen::Isometry3d by = carriage(view.known->lamp, lamp.lamp, pivot);
  TrainingView there = view.surface ? carried(view, by) : view;
  there.known = lamp;
  if (!isIdentity(by)) there.canonical.reset();  // it was found under the other lamp
  return there;
}

std::vector<TrainingView> pooledViews(const std::vector<TrainingView>& views, const KnownLamp& lamp) {
  std::vector<TrainingView> pooled;
  std::optional<Eigen::Vector3d> pivot;
  for (const TrainingView& v : views) {
    if (!v.known || !shareMaterial(*v.known, lamp)) continue;
    if (!pivot && v.seen) pivot = v.seen->brightest.point.position;
    pooled.push_back(v);
  }
  std::stable_sort(pooled.begin(), pooled.end(), [](const TrainingView& a, const TrainingView& b) {
    return std::pair(a.frame, a.highlight.light) < std::pair(b.frame, b.highlight.light);
  });
  for (TrainingView& v : pooled) v = carriedTo(v, lamp, pivot.value_or(Eigen::Vector3d::Zero()));
  if (pooled.size() > 2) dropContradictions(pooled, lamp);  // of two, nothing tells which one is wrong
  return pooled;
}

Outcome<ModelFit> fitOfKnownLamp(ModelFit fit, const std::string& light, const KnownLamp& known,
                                 const std::vector<TrainingView>& pooled, double mostShare) {
  std::vector<double> residuals;
  std::vector<int> frames;
  std::vector<UsedContour> own;
  std::size_t used = 0;
  for (const TrainingView& v : pooled) {
    if (!v.seen || used >= fit.frames.size()) continue;
    if (v.highlight.light == light) {
      frames.push_back(v.frame);
      if (used < fit.residualPx.size()) residuals.push_back(fit.residualPx[used]), own.push_back(usedContour(v));
    }
    ++used;
  }
  fit.frames = std::move(frames);
  fit.residualPx = std::move(residuals);
  fit.hints.clear();  // they lie where other lamps' views were carried
  if (!known.lamp.atInfinity() && known.sigma > 0) fit.lightCovariance = known.sigma * known.sigma * Eigen::Matrix3d::Identity();
  if (const double left = shareLeft(fit.residualPx, own); fit.as<LimitAngleFit>() && left > kOneAngleShare)
    fit.remarks.push_back(formatted(
        "under known lamps one limit angle leaves %.2g %% of the contours' radius: reflectance, which has a lobe, tells more",
        100 * left));
  // Others may have outvoted this lamp's own highlights.
  if (own.empty() || !fit.poor.empty() || fit.as<EllipsoidFit>()) return fit;
  return explaining(std::move(fit), own, true, mostShare);
}

std::optional<ModelFit> movedAsStated(const ModelFit& fit, const KnownLamp& known) {
  if (!(known.sigma > 0) || !fit.uncertainty || fit.as<EllipsoidFit>()) return std::nullopt;
  ModelFit moved = fit;
  moved.uncertainty->root = Eigen::MatrixXd::Zero(fit.uncertainty->root.rows(), 3);
  moved.uncertainty->root.topRows<4>() = statedColumns(known);
  return moved;
}

std::string knownLampDoubt(const std::vector<TrainingView>& views, const LightEstimate& light) {
  std::string text;
  for (const TrainingView& v : views)
    if (const std::optional<double> missed = missedAngle(v); missed && *missed > mostMissed(v, light.limitAngle))
      text += (text.empty() ? "" : "; ") + ("frame " + v.frameId + ": ") + missedText(*missed);
  return text;
}

bool assignKnownLamps(const Scene& scene, std::vector<FrameEvidence>& evidence,
                      const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf) {
  bool any = false;
  for (FrameEvidence& e : evidence) {
    if (e.frame < 0 || e.highlights.empty()) continue;
    const Frame& frame = scene.frames[static_cast<std::size_t>(e.frame)];
    if (frame.lightsOn.size() == 1 || !knowsAllLamps(scene, frame)) continue;
    const std::shared_ptr<const Surface> surface = surfaceOf(e.frame);
    if (!surface) continue;
    any = true;
    std::vector<std::string> on = frame.lightsOn;
    if (on.empty())
      for (const TrueLight& l : scene.lights) on.push_back(l.id);
    for (Highlight& h : e.highlights) {
      const Outcome<BrightestPoint> seen = observedBrightestPoint(*surface, frame.camera, h.peak);
      if (!seen) continue;
      double least = kFarthestMirror;
      h.light.clear();
      for (const std::string& id : on) {
        const double alpha = halfAngleAt(seen->point, frame.camera, knownLamp(scene, id)->lamp);
        if (alpha < least) least = alpha, h.light = id;
      }
    }
  }
  return any;
}

}  // namespace glint
