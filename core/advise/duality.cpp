// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/duality.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/advise/explain.h"

namespace glint {
namespace {

/// The fit of a model for this frame's surface and this light; null if it has none with an ellipsoid.
const ModelFit* fitWithEllipsoid(const Inspection& inspection, int frame, const std::string& light, const std::string& model) {
  const auto found = inspection.models.find(model);
  if (found == inspection.models.end()) return nullptr;
  const std::string surface = inspection.surfaces ? inspection.surfaces->keyOf(frame) : "";
  for (const ModelResult::Fit& f : found->second.fits)
    if ((light.empty() || f.light == light) && (!f.surface || *f.surface == surface) && f.fit && f.fit->ellipsoid())
      return &*f.fit;
  return nullptr;
}

Failure noEllipsoid(const Inspection& inspection, const std::string& model) {
  const auto found = inspection.models.find(model);
  if (found != inspection.models.end())
    for (const ModelResult::Fit& f : found->second.fits) {
      if (!f.fit) return f.fit.failure();
      if (const EllipsoidFit* const quadric = f.fit->as<EllipsoidFit>())
        return {Reason::NotAnEllipsoid, model + " has found a quadric that is no ellipsoid: " + describe(quadric->quadric)};
    }
  return {Reason::NotAnEllipsoid, "no model here has one"};
}

/// Geometric mean of the semi-axes that are not 0: the dual is then about as large as the ellipsoid.
double radiusFor(const Ellipsoid& ellipsoid) {
  const Eigen::Vector3d& a = ellipsoid.semiAxes();  // in descending order, at most one is 0
  return a(2) > 0 ? std::cbrt(a.prod()) : std::sqrt(a(0) * a(1));
}

Duality::Touch touchOf(const ConePlane& cone, const Ellipsoid& ellipsoid, const Reciprocal& chart) {
  Duality::Touch touch;
  touch.cone = cone;
  const Eigen::Vector3d& n = cone.plane.normal;
  const Eigen::Vector3d towards = ellipsoid.shape() * n;
  const double reach = std::sqrt(std::max(0.0, n.dot(towards)));  // the ellipsoid's tangent plane of this normal
  touch.away = -cone.plane.signedDistance(ellipsoid.centre());
  touch.gap = touch.away - reach;
  touch.at = cone.plane.projected(ellipsoid.centre() + (reach > 0 ? Eigen::Vector3d(towards / reach) : Eigen::Vector3d::Zero()));
  if (const Outcome<Eigen::Vector3d> y = dualPoint(cone.plane, chart)) touch.dual = *y;
  return touch;
}

/// Whether a view is one of those that a fit rests on.
bool serves(const TrainingView& view, const ModelFit& fit, const Inspection& inspection) {
  if (view.highlight.light != fit.light || std::find(fit.frames.begin(), fit.frames.end(), view.frame) == fit.frames.end())
    return false;
  return !fit.surface || (inspection.surfaces && inspection.surfaces->keyOf(view.frame) == *fit.surface);
}

/// @param nth  highlight of this light in the frame, from 1.
std::optional<double> fitPxOf(const ModelFit& fit, int frame, int nth) {
  for (std::size_t i = 0; i < fit.frames.size() && i < fit.residualPx.size(); ++i)
    if (fit.frames[i] == frame && --nth == 0) return fit.residualPx[i];
  return std::nullopt;
}

void sumUp(Duality& duality) {
  double gaps = 0, offs = 0;
  int planes = 0, points = 0;
  for (Duality::View& view : duality.views) {
    double own = 0;
    for (const Duality::Touch& t : view.planes) {
      own += t.gap * t.gap;
      if (!t.dual) {
        ++duality.atInfinity;
        continue;
      }
      // |y| = radius^2 / |h|, and on the dual quadric radius^2 / (h - gap).
      offs += std::pow((t.away - t.gap) / std::abs(t.away) - 1, 2);
      ++points;
    }
    gaps += own;
    planes += int(view.planes.size());
    view.rmsGap = std::sqrt(own / double(view.planes.size()));
  }
  duality.rmsGap = std::sqrt(gaps / planes);
  duality.rmsOffDual = points > 0 ? std::sqrt(offs / points) : 0;
}

}  // namespace

Outcome<Duality> dualityOf(const Inspection& inspection, int frame, const std::string& light, const std::string& model,
                           int planes) {
  require(inspection.scene && frame >= 0 && frame < int(inspection.scene->frames.size()), "dualityOf: no such frame");
  std::string name = model;
  const ModelFit* fit = fitWithEllipsoid(inspection, frame, light, name);
  if (!fit) {
    // A model that has looked for an ellipsoid and found none says why; one that has none in principle gives way.
    if (const auto found = inspection.models.find(name); found != inspection.models.end() && modelByName(name).hasOutlines())
      return noEllipsoid(inspection, name);
    name = modelToExplain(inspection, "");
    fit = fitWithEllipsoid(inspection, frame, light, name);
  }
  if (!fit) return noEllipsoid(inspection, name);
  const Ellipsoid& ellipsoid = *fit->ellipsoid();
  const Reciprocal chart{ellipsoid.centre(), radiusFor(ellipsoid)};
  const Outcome<Ellipsoid> dual = reciprocal(ellipsoid, chart);  // about its own centre, only a flat one has none
  Duality result{name, fit->light, ellipsoid, chart, dual ? std::optional(*dual) : std::nullopt, {}, 0, 0, 0};
  const HighlightModel& kind = modelByName(name);
  std::map<int, int> highlightsOf;  // of this light, by frame, so far
  for (const TrainingView& view : inspection.views) {
    if (!serves(view, *fit, inspection)) continue;
    const std::optional<ConicView> outline = kind.outlineIn(view);
    if (!outline) continue;
    const Outcome<std::vector<ConePlane>> cone = conePlanes(outline->projection, outline->ellipse, planes);
    if (!cone) return cone.failure();
    Duality::View one;
    one.frame = view.frame;
    one.mirrored = kind.traits().mirrored;
    one.apex = *centreOf(outline->projection);
    for (const ConePlane& p : *cone) one.planes.push_back(touchOf(p, ellipsoid, chart));
    one.fitPx = fitPxOf(*fit, view.frame, ++highlightsOf[view.frame]);
    result.views.push_back(std::move(one));
  }
  if (result.views.empty()) return Failure{Reason::TooFewViews, "no training view of " + name + " has an ellipse"};
  sumUp(result);
  return result;
}

}  // namespace glint
