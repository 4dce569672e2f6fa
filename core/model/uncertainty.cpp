// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/uncertainty.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/light/contour_evidence.h"
#include "core/model/fit_ellipsoid.h"

namespace glint {
namespace {

constexpr double kEdgePx = 0.5;       // a polished vertex lies on the level to 1e-9 px: farther off it is on the surface's edge
constexpr double kColumnStep = 0.25;  // of a standard deviation: small for the derivative, far above the walk's tolerance

/// Signed distance along `normal` from p to the nearest crossing of a polyline; NaN when the line through p misses it.
double alongNormal(const Polyline& line, const Pixel& p, const Pixel& normal) {
  double best = std::numeric_limits<double>::infinity();
  const std::size_t n = line.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Pixel a = line.points[i] - p, b = line.points[(i + 1) % n] - p;
    const double u = normal.x() * a.y() - normal.y() * a.x(), v = normal.x() * b.y() - normal.y() * b.x();
    if ((u > 0) == (v > 0)) continue;
    const double at = normal.dot(a + u / (u - v) * (b - a));
    if (std::abs(at) < std::abs(best)) best = at;
  }
  return std::isfinite(best) ? best : std::nan("");
}

/// Nearest positive semidefinite matrix.
Eigen::Matrix3d semidefinite(const Eigen::Matrix3d& s) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(s);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

Eigen::MatrixXd levelSetShiftsPx(const std::vector<Pixel>& points, const SurfaceField& field, const Camera& camera,
                                 const Surface& surface, const ColumnSlopes& slopes) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  const auto seen = [&](const Pixel& p) -> std::optional<SurfacePoint> {
    const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(p));
    return hit ? std::optional<SurfacePoint>(facing(*hit, eye)) : std::nullopt;
  };
  const auto valueAt = [&](const Pixel& p) -> std::optional<double> {
    const std::optional<SurfacePoint> at = seen(p);
    return at ? field.value(*at) : std::nullopt;
  };
  Eigen::MatrixXd shifts = Eigen::MatrixXd::Zero(Eigen::Index(points.size()), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<SurfacePoint> at = seen(points[i]);
    const std::optional<double> here = at ? field.value(*at) : std::nullopt;
    if (!here) continue;
    const auto slope = [&](const Pixel& by) {
      const std::optional<double> before = valueAt(points[i] - by), after = valueAt(points[i] + by);
      if (!before && !after) return 0.0;
      return (after.value_or(*here) - before.value_or(*here)) /
             ((before ? ContourEvidence::kStepPx : 0) + (after ? ContourEvidence::kStepPx : 0));
    };
    const double gradient = std::hypot(slope({ContourEvidence::kStepPx, 0}), slope({0, ContourEvidence::kStepPx}));
    if (!(gradient > 0) || !(std::abs(*here - field.level) <= kEdgePx * gradient)) continue;
    const std::optional<Eigen::VectorXd> change = slopes(*at);
    if (!change || !change->allFinite()) continue;
    if (shifts.cols() == 0) shifts = Eigen::MatrixXd::Zero(shifts.rows(), change->size());
    shifts.row(Eigen::Index(i)) = -change->transpose() / gradient;
  }
  return shifts;
}

std::vector<Pixel> outwardNormals(const Polyline& contour) {
  const std::size_t n = contour.points.size();
  std::vector<Pixel> normals(n, Pixel(0, 0));
  const double side = signedArea(contour) >= 0 ? 1 : -1;
  for (std::size_t i = 0; n >= 3 && i < n; ++i) {
    const Pixel tangent = contour.points[(i + 1) % n] - contour.points[(i + n - 1) % n];
    const Pixel normal = side * Pixel(tangent.y(), -tangent.x()).normalized();
    if (normal.allFinite()) normals[i] = normal;
  }
  return normals;
}

std::vector<double> shiftsAlongNormals(const Polyline& contour, const Polyline& other) {
  const std::vector<Pixel> normals = outwardNormals(contour);
  std::vector<double> shifts;
  for (std::size_t i = 0; i < contour.points.size(); ++i)
    shifts.push_back(normals[i].norm() > 0 ? alongNormal(other, contour.points[i], normals[i]) : std::nan(""));
  return shifts;
}

Eigen::MatrixXd polylineShiftsPx(const Polyline& contour, const std::vector<std::pair<Polyline, Polyline>>& perturbed,
                                 double step) {
  require(step > 0, "polylineShiftsPx: step");
  const std::size_t n = contour.points.size();
  Eigen::MatrixXd shifts = Eigen::MatrixXd::Zero(Eigen::Index(n), Eigen::Index(perturbed.size()));
  if (n < 3) return shifts;
  const std::vector<Pixel> normals = outwardNormals(contour);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(normals[i].norm() > 0)) continue;
    for (std::size_t k = 0; k < perturbed.size(); ++k) {
      const auto& [plus, minus] = perturbed[k];
      double change;
      if (plus.points.size() == n && minus.points.size() == n) {
        change = normals[i].dot(plus.points[i] - minus.points[i]);
      } else {
        const double after = alongNormal(plus, contour.points[i], normals[i]),
                     before = alongNormal(minus, contour.points[i], normals[i]);
        change = (std::isfinite(after) ? after : 0) - (std::isfinite(before) ? before : 0);
      }
      if (std::isfinite(change)) shifts(Eigen::Index(i), Eigen::Index(k)) = change / (2 * step);
    }
  }
  return shifts;
}

Eigen::MatrixXd EllipsoidModel::bandShiftsPx(const ModelFit& fit, const PredictedHighlight& highlight, const Camera& camera,
                                             const Surface* surface, const Settings& settings) const {
  const Ellipsoid* const ellipsoid = fit.ellipsoid();
  if (!fit.uncertainty || !ellipsoid || !parameters::kShape.isIn(fit.uncertainty->root)) return {};
  const Eigen::MatrixXd& root = fit.uncertainty->root;
  const auto predicted = [&](const Eigen::VectorXd& change) -> std::optional<Polyline> {
    const Eigen::Matrix<double, 6, 1> d = parameters::kShape.of(change);
    const Eigen::Matrix3d shape =
        ellipsoid->shape() + Eigen::Matrix3d{{d(0), d(3), d(4)}, {d(3), d(1), d(5)}, {d(4), d(5), d(2)}};
    const Outcome<Ellipsoid> moved =
        Ellipsoid::fromCentreAndShape(ellipsoid->centre() + parameters::kCentre.of(change), semidefinite(shape));
    if (!moved) return std::nullopt;
    ModelFit other = fit;
    other.family = EllipsoidFit{moved->dual(), *moved};
    if (fit.lightEstimate && parameters::kLampOfEllipsoid.isIn(change))
      other.lightEstimate = Light::homogeneous(fit.lightEstimate->homogeneous() + parameters::kLampOfEllipsoid.of(change));
    const Prediction p = predict(other, camera, surface, settings);
    const auto distance = [&](const PredictedHighlight& h) { return (h.brightest.pixel - highlight.brightest.pixel).norm(); };
    const auto nearest =
        std::min_element(p.highlights().begin(), p.highlights().end(),
                         [&](const PredictedHighlight& a, const PredictedHighlight& b) { return distance(a) < distance(b); });
    if (nearest == p.highlights().end()) return std::nullopt;
    return nearest->contour;
  };
  std::vector<std::pair<Polyline, Polyline>> perturbed;
  for (Eigen::Index k = 0; k < root.cols(); ++k) {
    std::optional<Polyline> plus = predicted(kColumnStep * root.col(k)), minus = predicted(-kColumnStep * root.col(k));
    if (!plus || !minus) return {};  // the highlight would vanish or merge within the uncertainty: any band would be wrong
    perturbed.emplace_back(std::move(*plus), std::move(*minus));
  }
  return polylineShiftsPx(highlight.contour, perturbed, kColumnStep);
}

}  // namespace glint
