// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/mirror_ball.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace glint {
namespace {

constexpr int kCirclePoints = 72;       // of an outline that is given as a circle: three numbers need no more
constexpr int kMostOutlineSteps = 50;   // five are usual
constexpr double kOutlineStop = 1e-12;  // of the size of the numbers, px: a few hundred ulp
constexpr double kStepShare =
    1e-6;  // of a central difference: half of the digits of a double for the square, a third of them for round-off
constexpr int kMostRootSteps = 100;  // halving alone takes 53 to the last bit

/// Signed angle of a tangent ray beyond the cone of the ball, in pixels along the outline's normal.
double beyondOutline(const BallProjection& view, const Eigen::Vector3d& parameters, const Pixel& edge) {
  const MirrorBall ball = ballOf(view, parameters);
  const double half = std::asin(std::min(1.0, ball.radius / ball.centre.norm()));
  const auto angle = [&](const Pixel& p) {
    const Eigen::Vector3d e = view.camera->pixelFromRay.inverse() * p.homogeneous();
    return std::atan2(e.cross(ball.centre).norm(), e.dot(ball.centre));
  };
  const Eigen::Vector2d outwards = (edge - parameters.head<2>()).normalized();
  constexpr double kHalfPx = 0.5;  // angles are straight over a pixel
  return (angle(edge) - half) / (angle(edge + kHalfPx * outwards) - angle(edge - kHalfPx * outwards));
}

std::vector<EdgePoint> edgesOf(const RefinedOutline& outline) {
  if (!outline.edge.empty()) return outline.edge;
  std::vector<EdgePoint> edges;
  for (int k = 0; k < kCirclePoints; ++k) {
    const double t = 2 * std::numbers::pi * k / kCirclePoints;
    edges.push_back({outline.outline.centre + outline.outline.radius * Eigen::Vector2d(std::cos(t), std::sin(t)), 1.0});
  }
  return edges;
}

/// Normal equations of the cone through the points. The three unknowns are well separated: a squared condition does no harm.
struct OutlineEquations {
  /// `circle` is that of centre and radius of a circle.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), circle = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
};
OutlineEquations outlineEquations(const BallProjection& view, const Eigen::Vector3d& at, const std::vector<EdgePoint>& edges) {
  OutlineEquations e;
  const double step = kStepShare * std::max(1.0, at(2));
  for (const EdgePoint& p : edges) {
    Eigen::Vector3d row;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d by = step * Eigen::Vector3d::Unit(k);
      row(k) = (beyondOutline(view, at + by, p.place) - beyondOutline(view, at - by, p.place)) / (2 * step);
    }
    const double weight = 1 / (p.sigmaPx * p.sigmaPx);
    e.normal += weight * row * row.transpose();
    e.right -= weight * beyondOutline(view, at, p.place) * row;
    const Eigen::Vector2d out = (p.place - at.head<2>()).normalized();
    const Eigen::Vector3d ofCircle(out.x(), out.y(), 1);
    e.circle += weight * ofCircle * ofCircle.transpose();
  }
  return e;
}

Outcome<BallParameters> coneParameters(const BallProjection& view, const RefinedOutline& outline) {
  const std::vector<EdgePoint> edges = edgesOf(outline);
  BallParameters result;
  result.value << outline.outline.centre, outline.outline.radius;
  const double limit = view.camera->pixelFromRay(0, 0);  // a ball nearer than its own radius
  OutlineEquations e;
  bool settled = false;
  for (int i = 0; i < kMostOutlineSteps && !settled; ++i) {
    if (!(result.value(2) > 0 && result.value(2) < limit) || !result.value.allFinite())
      return Failure{Reason::NotConverged, "no ball before the camera has this outline"};
    e = outlineEquations(view, result.value, edges);
    const Eigen::Vector3d step = e.normal.ldlt().solve(e.right);
    result.value += step;
    settled = step.norm() <= kOutlineStop * result.value.norm();
  }
  if (!result.value.allFinite() || !(result.value(2) > 0 && result.value(2) < limit))
    return Failure{Reason::NotConverged, "no ball before the camera has this outline"};
  // The outline's covariance knows more than its points: edges that go together, a residual larger than stated.
  const double excess = outline.covariance.trace() / e.circle.inverse().trace();
  result.covariance = excess * e.normal.inverse();
  if (!result.covariance.allFinite()) return Failure{Reason::NotFinite, "the outline of a ball"};
  return result;
}

}  // namespace

Pixel BallProjection::project(const Eigen::Vector3d& point) const {
  if (!camera) return point.head<2>();
  return Eigen::Vector3d(camera->pixelFromRay * point).hnormalized();
}

MirrorBall ballOf(const BallProjection& view, const Eigen::Vector3d& p) {
  if (!view.camera) return {{p.x(), p.y(), 0}, p.z()};
  const Eigen::Matrix3d& k = view.camera->pixelFromRay;
  return {k.inverse() * Eigen::Vector3d(p.x(), p.y(), 1) * (k(0, 0) / p.z()), 1};
}

Outcome<BallParameters> ballParameters(const BallProjection& view, const RefinedOutline& outline) {
  BallParameters result;
  result.value << outline.outline.centre, outline.outline.radius;
  result.covariance = outline.covariance;
  if (!result.value.allFinite() || !result.covariance.allFinite()) return Failure{Reason::NotFinite, "the outline of a ball"};
  return view.camera ? coneParameters(view, outline) : Outcome<BallParameters>(result);
}

std::vector<Pixel> outlinePixels(const BallProjection& view, const Eigen::Vector3d& parameters, int points) {
  const MirrorBall ball = ballOf(view, parameters);
  // The points where rays touch the ball: a circle square to the way to its centre.
  const double distance = ball.centre.norm();
  Eigen::Vector3d middle = ball.centre, u = Eigen::Vector3d::UnitX(), v = Eigen::Vector3d::UnitY();
  double radius = ball.radius;
  if (view.camera) {
    if (!(distance > ball.radius)) return {};
    const double share = ball.radius / distance;
    middle *= 1 - share * share;
    radius *= std::sqrt(1 - share * share);
    u = ball.centre.unitOrthogonal();
    v = ball.centre.normalized().cross(u);
  }
  std::vector<Pixel> outline;
  for (int k = 0; k < points; ++k) {
    const double t = 2 * std::numbers::pi * k / points;
    const Eigen::Vector3d p = middle + radius * (std::cos(t) * u + std::sin(t) * v);
    if (view.camera && !(p.z() > 0)) return {};
    outline.push_back(view.project(p));
  }
  return outline;
}

Outcome<MirrorRay> mirrorRay(const BallProjection& view, const MirrorBall& ball, const Pixel& peak) {
  const Failure missed{Reason::PeakOffSurface, "the highlight lies outside of the ball's outline"};
  Eigen::Vector3d point;
  if (view.camera) {
    const Eigen::Vector3d d = (view.camera->pixelFromRay.inverse() * peak.homogeneous()).normalized();
    const double along = d.dot(ball.centre), across = (ball.centre - along * d).squaredNorm();
    const double inside = ball.radius * ball.radius - across;
    if (!(inside > 0 && along > 0)) return missed;
    point = (along - std::sqrt(inside)) * d;
  } else {
    const Eigen::Vector2d offset = peak - ball.centre.head<2>();
    const double inside = ball.radius * ball.radius - offset.squaredNorm();
    if (!(inside > 0)) return missed;
    point = {peak.x(), peak.y(), ball.centre.z() - std::sqrt(inside)};
  }
  const Eigen::Vector3d n = (point - ball.centre).normalized(), v = view.toCamera(point);
  return MirrorRay{point, (2 * n.dot(v) * n - v).normalized()};
}

std::optional<Pixel> mirrorPixel(const BallProjection& view, const MirrorBall& ball, const AimedLamp& lamp) {
  const double w = lamp.inverseDistance;
  const Eigen::Vector3d toEye = view.camera ? Eigen::Vector3d(-ball.centre) : Eigen::Vector3d(0, 0, -1);
  const Eigen::Vector3d toLamp = lamp.from(ball.centre);
  const Eigen::Vector3d x = toEye.normalized();
  const Eigen::Vector3d across = toLamp - toLamp.dot(x) * x;
  const double eyeDistance = toEye.norm(), sideways = across.norm();
  const Eigen::Vector3d y = sideways > 0 ? Eigen::Vector3d(across / sideways) : x.unitOrthogonal();
  // In the plane of x and y; the lamp's coordinates are homogeneous with w.
  const Eigen::Vector2d lampInPlane(toLamp.dot(x), sideways);
  const auto angles = [&](double t) {
    const Eigen::Vector2d p = ball.radius * Eigen::Vector2d(std::cos(t), std::sin(t));
    const Eigen::Vector2d v = view.camera ? Eigen::Vector2d(Eigen::Vector2d(eyeDistance, 0) - p) : Eigen::Vector2d(1, 0);
    const Eigen::Vector2d l = lampInPlane - w * p;
    return Eigen::Vector2d(std::atan2(v.y(), v.x()), std::atan2(l.y(), l.x()));
  };
  const auto open = [&](double t) {
    const Eigen::Vector2d a = angles(t);
    return 2 * t - a.x() - a.y();
  };
  double low = 0, high = std::atan2(lampInPlane.y(), lampInPlane.x()), t = high / 2;
  for (int i = 0; i < kMostRootSteps && low < high; ++i) {
    const double value = open(t);
    if (value == 0) break;
    (value > 0 ? high : low) = t;
    constexpr double kSlopeStep = 1e-6;  // rad; the slope only steers
    const double next = t - value * 2 * kSlopeStep / (open(t + kSlopeStep) - open(t - kSlopeStep));
    const double before = t;
    t = next > low && next < high ? next : (low + high) / 2;
    if (t == before) break;
  }
  if (!(std::abs(t - angles(t).x()) < std::numbers::pi / 2)) return std::nullopt;  // grazing: out of sight, or not lit
  const Pixel pixel = view.project(ball.centre + ball.radius * (std::cos(t) * x + std::sin(t) * y));
  return pixel.allFinite() ? std::optional(pixel) : std::nullopt;
}

AimedLamp lampOfRays(std::span<const MirrorRay> rays, const Eigen::Vector3d& reference, double scale) {
  AimedLamp lamp;
  lamp.reference = reference;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const MirrorRay& r : rays) mean += r.direction;
  lamp.direction = mean.normalized();
  if (rays.size() < 2) return lamp;
  Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(rays.size()), 4);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto block = static_cast<Eigen::Index>(3 * i);
    for (int k = 0; k < 3; ++k) rows.block<3, 1>(block, k) = rays[i].direction.cross(Eigen::Vector3d::Unit(k));
    rows.block<3, 1>(block, 3) = -rays[i].direction.cross((rays[i].origin - reference) / scale);
  }
  const Eigen::Vector4d solution = Eigen::JacobiSVD<Eigen::MatrixXd>(rows, Eigen::ComputeFullV).matrixV().col(3);
  const double length = solution.head<3>().norm();
  constexpr double kLeastLength =
      1e-3;  // of (direction, inverse distance): nearer than a thousandth of the arrangement there is no lamp
  if (!(length > kLeastLength)) return lamp;
  const double sign = solution.head<3>().dot(mean) < 0 ? -1 : 1;
  lamp.direction = sign * solution.head<3>() / length;
  lamp.inverseDistance = sign * solution(3) / length / scale;
  return lamp;
}

}  // namespace glint
