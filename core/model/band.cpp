// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/band.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/uncertainty.h"
#include "core/model/models.h"
#include "core/model/uncertainty.h"

namespace glint {

namespace {

// A clipped peak may have been ten times as high: a Gaussian lobe's contour at half of it then has half the radius. 1.96 times
// this share covers that.
constexpr double kClippedShare = 0.25;

const PredictedHighlight* nearest(const Prediction& p, const Pixel& to) {
  const auto distance = [&](const PredictedHighlight& h) { return (centroid(h.contour) - to).norm(); };
  const auto best =
      std::min_element(p.highlights().begin(), p.highlights().end(),
                       [&](const PredictedHighlight& a, const PredictedHighlight& b) { return distance(a) < distance(b); });
  return best == p.highlights().end() ? nullptr : &*best;
}

/// A measured contour against the predicted one: every point's distance from its foot, and the shifts there.
std::optional<ViewResiduals> residualsOf(const TrainingView& view, const Polyline& predicted, const Eigen::MatrixXd& shifts,
                                         int points) {
  const std::size_t n = predicted.points.size();
  if (n < 3 || shifts.cols() == 0 || shifts.rows() != Eigen::Index(n)) return std::nullopt;
  const std::vector<Pixel>& all = view.highlight.contour.points;
  const std::vector<Pixel> observed =
      view.highlight.touchesBorder || all.size() > std::size_t(points) ? levelSetPoints(view, points) : all;
  std::vector<double> residual, arcs;
  std::vector<Pixel> directions;
  std::vector<Eigen::RowVectorXd> rows;
  for (const ContourFoot& foot : feetOn(predicted, observed)) {
    const Eigen::Index i = Eigen::Index(foot.from), j = Eigen::Index(foot.to);
    if (!(shifts.row(i).norm() > 0) || !(shifts.row(j).norm() > 0)) continue;  // the surface ends there
    if (!foot.normal.allFinite()) continue;
    residual.push_back(foot.distance);
    directions.push_back(foot.normal);
    arcs.push_back(foot.arc);
    rows.push_back((1 - foot.share) * shifts.row(i) + foot.share * shifts.row(j));
  }
  constexpr std::size_t kLeast = 5;  // as many as the light's bundle needs
  if (residual.size() < kLeast) return std::nullopt;
  ViewResiduals v;
  v.residual = Eigen::Map<const Eigen::VectorXd>(residual.data(), Eigen::Index(residual.size()));
  v.byParameter.resize(Eigen::Index(rows.size()), shifts.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) v.byParameter.row(Eigen::Index(i)) = rows[i];
  v.shapes = contourShapes(directions, arcs);
  return v;
}

/// Where a highlight lies and from where it is seen: neighbouring views share a bump of the surface, and a lobe's error at an
/// angle.
/// @param unit  distance of a camera: a turn by a radian is this far on the surface
Eigen::VectorXd placeOf(const PredictedHighlight& h, const Camera& camera, double unit) {
  Eigen::VectorXd place(6);
  place << h.brightest.point.position / unit, (camera.centreInWorld() - h.brightest.point.position).normalized();
  return place;
}

}  // namespace

std::shared_ptr<Band> Band::of(const HighlightModel& model, const ModelFit& fit, const std::vector<TrainingView>& views,
                               const Settings& settings) {
  if (!fit.uncertainty) return nullptr;
  std::vector<ViewResiduals> residuals;
  const ReflectanceFit* const lobe = fit.as<ReflectanceFit>();
  bool clipped = false;
  double radius = 0, unit = 0;
  for (const TrainingView& v : views) {
    if (!v.seen || v.highlight.contour.points.size() < 3) continue;
    clipped = clipped || (v.highlight.clipped && !(lobe && lobe->evidence == "pixels"));  // pixels leave out what is clipped
    const Prediction p = model.predict(fit, v.camera, v.surface.get(), settings);
    const PredictedHighlight* h = nearest(p, centroid(v.highlight.contour));
    if (!h) continue;
    const Eigen::MatrixXd shifts = model.bandShiftsPx(fit, *h, v.camera, v.surface.get(), settings);
    if (!residuals.empty() && shifts.cols() != residuals.front().byParameter.cols()) continue;
    if (std::optional<ViewResiduals> r = residualsOf(v, h->contour, shifts, settings.integer("light.bundle_points"))) {
      if (!(unit > 0)) unit = (v.camera.centreInWorld() - h->brightest.point.position).norm();
      r->where = placeOf(*h, v.camera, unit);
      residuals.push_back(std::move(*r));
      radius += std::sqrt(std::abs(signedArea(h->contour)) / M_PI);
    }
  }
  if (residuals.empty()) return nullptr;
  std::shared_ptr<Band> band(new Band(model, fit, settings, ViewEffects(residuals, settings.number("light.robust_px"))));
  band->clipped_ = clipped;
  band->unit_ = unit;
  band->radius_ = radius / double(residuals.size());
  return band;
}

std::vector<double> Band::sigmaPx(const PredictedHighlight& highlight, const Camera& camera, const Surface* surface) const {
  const Eigen::MatrixXd shifts = model_.bandShiftsPx(fit_, highlight, camera, surface, settings_);
  const std::size_t n = highlight.contour.points.size();
  if (shifts.cols() == 0 || shifts.rows() != Eigen::Index(n) || n < 3) return {};
  const std::vector<double> own = effects_.sigmaPx(
      shifts, contourShapes(outwardNormals(highlight.contour), arcOf(highlight.contour)), placeOf(highlight, camera, unit_));
  const Eigen::MatrixXd stated =
      stated_ ? model_.bandShiftsPx(*stated_, highlight, camera, surface, settings_) : Eigen::MatrixXd();
  std::vector<double> variance(n);
  for (std::size_t i = 0; i < n; ++i) {
    variance[i] = own[i] * own[i];
    if (stated.rows() == shifts.rows()) variance[i] += stated.row(Eigen::Index(i)).squaredNorm();
    if (own_) variance[i] += shifts.row(Eigen::Index(i)).squaredNorm();
    if (clipped_) variance[i] += std::pow(kClippedShare * (highlight.contour.points[i] - highlight.brightest.pixel).norm(), 2);
  }
  for (const BandAlternative& other : alternatives_) {
    const Prediction p = other.model->predict(other.fit, other.camera ? other.camera(camera) : camera, surface, settings_);
    const PredictedHighlight* h = nearest(p, centroid(highlight.contour));
    if (!h) continue;
    std::vector<double> away = shiftsAlongNormals(highlight.contour, h->contour);
    if (other.reference) {
      const Prediction q = other.model->predict(*other.reference, camera, surface, settings_);
      const PredictedHighlight* from = nearest(q, centroid(highlight.contour));
      if (!from) continue;
      const std::vector<double> start = shiftsAlongNormals(highlight.contour, from->contour);
      for (std::size_t i = 0; i < n; ++i) away[i] -= start[i];
    }
    double squares = 0, count = 0;
    for (const double d : away)
      if (std::isfinite(d)) squares += d * d, count += 1;
    for (std::size_t i = 0; i < n && count > 0; ++i)
      variance[i] += other.share * (std::isfinite(away[i]) ? away[i] * away[i] : squares / count);
  }
  std::vector<double> sigma(n);
  for (std::size_t i = 0; i < n; ++i) sigma[i] = shifts.row(Eigen::Index(i)).norm() > 0 ? std::sqrt(variance[i]) : 0;
  return sigma;
}

std::vector<double> arcOf(const Polyline& line) {
  std::vector<double> arc;
  double sum = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    arc.push_back(sum);
    sum += (line.points[(i + 1) % line.points.size()] - line.points[i]).norm();
  }
  for (double& a : arc) a /= sum;
  return arc;
}

std::vector<ContourFoot> feetOn(const Polyline& predicted, const std::vector<Pixel>& points) {
  const std::size_t n = predicted.points.size();
  if (n < 3) return {};
  const std::vector<Pixel> normals = outwardNormals(predicted);
  const std::vector<double> arc = arcOf(predicted);
  std::vector<ContourFoot> feet;
  feet.reserve(points.size());
  for (const Pixel& p : points) {
    double best = std::numeric_limits<double>::infinity();
    ContourFoot foot;
    for (std::size_t i = 0; i < n; ++i) {
      const Pixel a = predicted.points[i], along = predicted.points[(i + 1) % n] - a;
      const double squared = along.squaredNorm(), t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
      const double d = (a + t * along - p).squaredNorm();
      if (d < best) best = d, foot.share = t, foot.from = i;
    }
    foot.to = (foot.from + 1) % n;
    const Pixel at = predicted.points[foot.from] + foot.share * (predicted.points[foot.to] - predicted.points[foot.from]);
    foot.normal = ((1 - foot.share) * normals[foot.from] + foot.share * normals[foot.to]).normalized();
    foot.distance = std::copysign(std::sqrt(best), foot.normal.dot(p - at));
    const double end = foot.to == 0 ? 1.0 : arc[foot.to];
    foot.arc = arc[foot.from] + foot.share * (end - arc[foot.from]);
    feet.push_back(foot);
  }
  return feet;
}

}  // namespace glint
