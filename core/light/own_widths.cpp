// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/own_widths.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/evenly.h"
#include "core/base/numeric.h"
#include "core/geometry/polyline.h"
#include "core/surface/posed_surface.h"

namespace glint {
namespace {

constexpr double kWidthShare = 0.03;     // of the angle, scale of the robust sums: what a detection leaves of a small highlight
constexpr double kSilentRms = 0.01;      // of the angle: below, views that differ by a tenth in width would leave more
constexpr double kFitsShare = 0.1;       // of the angle: a point this near lies on the contour
constexpr double kMostPoints = 2.0 / 3;  // of a contour, that one angle describes
constexpr double kFewUnlit = 0.1;        // of the points; more say that the light is behind the surface
constexpr double kIndependent = 4;       // of a contour's residuals: they keep their sign along a quarter of it
constexpr std::size_t kWidthStarts = 24, kWidthAttempts = 3;  // pairs of rays; the best of them that are followed
constexpr int kWidthRounds = 40, kMeanRounds = 12;

struct WidthPoint {
  Eigen::Vector3d position, normal, toCamera;
  std::size_t view;
};

/// The contours on their surfaces, in units of their distance from the cameras about their middle.
struct WidthPoints {
  std::vector<WidthPoint> all;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 0;
  std::size_t views = 0;

  Eigen::Vector4d inside(const Light& light) const {
    Eigen::Vector4d l = light.homogeneous();
    l.head<3>() = (l.head<3>() - l.w() * origin) / scale;
    return l.normalized();
  }
};

WidthPoints widthPoints(const std::vector<BundleView>& views, int pointsPerView) {
  WidthPoints points;
  points.views = views.size();
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Eigen::Vector3d eye = views[v].camera.centreInWorld();
    for (const Pixel& p : thinned(Polyline{views[v].contour, true}, pointsPerView)) {
      const Outcome<SurfacePoint> hit = views[v].surface->firstHit(views[v].camera.ray(p));
      if (!hit || !hit->position.allFinite() || !hit->normal.allFinite()) continue;
      const SurfacePoint s = facing(*hit, eye);
      points.all.push_back({s.position, s.normal, (eye - s.position).normalized(), v});
      points.origin += s.position;
      points.scale += (eye - s.position).norm();
    }
  }
  points.origin /= std::max<double>(1, points.all.size());
  points.scale /= std::max<double>(1, points.all.size());
  for (WidthPoint& p : points.all) p.position = (p.position - points.origin) / points.scale;
  return points;
}

Eigen::Vector3d lightSeenFrom(const Eigen::Vector4d& light, const Eigen::Vector3d& from) {
  return (light.head<3>() - light.w() * from).normalized();
}

enum class Widths { Common, Own };

/// log alpha of every point about the robust mean of its view, or of all.
struct WidthSpread {
  std::vector<double> off, middle;  ///< per point; per view
  double cost = std::numeric_limits<double>::infinity();
};

double widthMean(const std::vector<double>& values) {
  double mean = upperMedian(values);
  for (int k = 0; k < kMeanRounds; ++k) {
    double sum = 0, weights = 0;
    for (const double v : values) {
      const double r = (v - mean) / kWidthShare, w = 1 / (1 + r * r);
      sum += w * v, weights += w;
    }
    mean = sum / weights;
  }
  return mean;
}

WidthSpread widthSpread(const WidthPoints& points, const Eigen::Vector4d& light, Widths widths) {
  constexpr double kLeastAngle = 1e-6;  // rad: a point on the mirror point itself has no logarithm
  WidthSpread s;
  std::vector<std::vector<double>> logs(widths == Widths::Own ? points.views : 1);
  std::size_t unlit = 0;
  for (const WidthPoint& p : points.all) {
    const Eigen::Vector3d to = lightSeenFrom(light, p.position), half = (to + p.toCamera).normalized();
    if (!(p.normal.dot(to) > 0)) ++unlit;
    s.off.push_back(std::log(std::max(kLeastAngle, std::atan2(p.normal.cross(half).norm(), p.normal.dot(half)))));
    logs[widths == Widths::Own ? p.view : 0].push_back(s.off.back());
  }
  s.middle.assign(points.views, 0);
  for (std::size_t v = 0; v < points.views; ++v)
    if (const auto& own = logs[widths == Widths::Own ? v : 0]; !own.empty())
      s.middle[v] = widths == Widths::Own || v == 0 ? widthMean(own) : s.middle[0];
  double cost = 0;
  for (std::size_t i = 0; i < s.off.size(); ++i) {
    s.off[i] -= s.middle[points.all[i].view];
    cost +=
        std::log1p(s.off[i] * s.off[i] / (kWidthShare * kWidthShare));  // Cauchy's: patches leave whole pieces of contours out
  }
  if (std::isfinite(cost) && double(unlit) <= kFewUnlit * double(points.all.size())) s.cost = cost;
  return s;
}

/// Levenberg-Marquardt steps on the sphere of homogeneous lights, reweighted.
std::pair<Eigen::Vector4d, WidthSpread> fittedWidths(const WidthPoints& points, Eigen::Vector4d light, Widths widths) {
  constexpr double kStep = 1e-6, kSettled = 1e-6;  // of unit vectors; of the cost
  constexpr int kTries = 10;
  WidthSpread now = widthSpread(points, light, widths);
  double damping = 1e-3;  // as Levenberg and Marquardt start: small against a curvature of 1
  const Eigen::Index n = Eigen::Index(points.all.size());
  for (int round = 0; round < kWidthRounds; ++round) {
    const Eigen::Matrix4d basis = Eigen::HouseholderQR<Eigen::Vector4d>(light).householderQ();
    const Eigen::Matrix<double, 4, 3> chart = basis.rightCols<3>();
    Eigen::MatrixXd slopes(n, 3);
    for (int c = 0; c < 3; ++c) {
      const auto at = [&](double by) { return widthSpread(points, (light + by * chart.col(c)).normalized(), widths).off; };
      const std::vector<double> up = at(kStep), down = at(-kStep);
      for (Eigen::Index i = 0; i < n; ++i) slopes(i, c) = (up[std::size_t(i)] - down[std::size_t(i)]) / (2 * kStep);
    }
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < n; ++i) {
      const double r = now.off[std::size_t(i)], weight = 1 / (1 + r * r / (kWidthShare * kWidthShare));
      normal += weight * slopes.row(i).transpose() * slopes.row(i);
      gradient += weight * r * slopes.row(i).transpose();
    }
    const double before = now.cost;
    for (int k = 0; k < kTries && now.cost >= before; ++k, damping *= 5) {
      Eigen::Matrix3d damped = normal;
      damped.diagonal() *= 1 + damping;
      const Eigen::Vector4d next = (light - chart * damped.ldlt().solve(gradient)).normalized();
      if (!next.allFinite()) continue;
      WidthSpread there = widthSpread(points, next, widths);
      if (there.cost < now.cost) light = next, now = std::move(there), damping *= 0.04;
    }
    if (!(now.cost < (1 - kSettled) * before)) break;
  }
  return {light, std::move(now)};
}

/// Where pairs of reflected rays meet, and the guess.
std::vector<Eigen::Vector4d> widthStarts(const WidthPoints& points, const std::vector<BundleView>& views,
                                         const std::optional<Light>& start) {
  std::vector<ReflectedRay> rays;
  for (const BundleView& v : views)
    if (v.brightest) rays.push_back(reflectedRay(*v.brightest, v.camera));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < rays.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) pairs.emplace_back(i, k);
  std::vector<Eigen::Vector4d> starts;
  if (start) starts.push_back(points.inside(*start));
  for (const auto& [i, k] : evenly(pairs, kWidthStarts))
    if (const Outcome<Triangulation> t = triangulateLight({rays[i], rays[k]})) starts.push_back(points.inside(t->light));
  return starts;
}

std::pair<Eigen::Vector4d, WidthSpread> bestWidths(const WidthPoints& points, const std::vector<Eigen::Vector4d>& starts,
                                                   Widths widths) {
  std::vector<std::pair<double, Eigen::Vector4d>> ranked;
  for (const Eigen::Vector4d& s : starts) ranked.emplace_back(widthSpread(points, s, widths).cost, s);
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::pair<Eigen::Vector4d, WidthSpread> best;
  for (std::size_t k = 0; k < std::min(ranked.size(), kWidthAttempts); ++k)
    if (auto found = fittedWidths(points, ranked[k].second, widths); found.second.cost < best.second.cost)
      best = std::move(found);
  return best;
}

/// Huber's sum: patches may leave pieces of contours out, and a comparison of two answers must count those.
double countedWidths(const WidthSpread& s) {
  double sum = 0;
  for (const double off : s.off) {
    const double r = std::abs(off) / kWidthShare;
    sum += r <= 1 ? 0.5 * r * r : r - 0.5;
  }
  return sum;
}

OwnWidth ownWidthOf(const WidthPoints& points, const Eigen::Vector4d& light, const WidthSpread& s, std::size_t view) {
  OwnWidth w;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  int count = 0, fits = 0;
  double squares = 0;
  for (std::size_t i = 0; i < points.all.size(); ++i) {
    if (points.all[i].view != view) continue;
    ++count;
    w.place += points.all[i].position;
    normal += points.all[i].normal;
    if (std::abs(s.off[i]) > kFitsShare) continue;
    ++fits;
    squares += s.off[i] * s.off[i];
  }
  constexpr int kLeastPoints = 5;  // of an ellipse
  if (count < kLeastPoints) return w;
  w.place /= count;
  const double cosine = normal.normalized().dot(lightSeenFrom(light, w.place));
  w.sineSquared = 1 - cosine * cosine;
  w.place = points.origin + points.scale * w.place;
  w.limitAngle = std::exp(s.middle[view]);
  w.explained = fits >= kMostPoints * count;
  w.sigma = std::sqrt(squares / std::max(1, fits) / kIndependent);
  return w;
}

}  // namespace

std::optional<OwnWidths> ownWidths(const std::vector<BundleView>& views, const std::optional<Light>& start, int pointsPerView) {
  for (const BundleView& view : views) require(view.surface != nullptr, "ownWidths: a view without surface");
  const WidthPoints points = widthPoints(views, pointsPerView);
  if (views.size() < 2 || points.all.empty() || !(points.scale > 0)) return std::nullopt;
  if (start) {
    const WidthSpread given = widthSpread(points, points.inside(*start), Widths::Common);
    std::vector<double> off;
    for (const double o : given.off) off.push_back(std::abs(o));
    if (std::isfinite(given.cost) &&
        2 * countedWidths(given) * kWidthShare * kWidthShare < kSilentRms * kSilentRms * double(off.size()))
      return std::nullopt;
  }
  const std::vector<Eigen::Vector4d> starts = widthStarts(points, views, start);
  const auto common = bestWidths(points, starts, Widths::Common);
  const auto own = bestWidths(points, starts, Widths::Own);
  if (!std::isfinite(own.second.cost)) return std::nullopt;
  OwnWidths found;
  Eigen::Vector4d world = own.first;
  world.head<3>() = points.scale * world.head<3>() + world.w() * points.origin;
  found.light = Light::homogeneous(world);
  found.cost = countedWidths(own.second);
  found.commonCost = std::isfinite(common.second.cost) ? countedWidths(common.second) : std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < views.size(); ++v) {
    found.views.push_back(ownWidthOf(points, own.first, own.second, v));
    Eigen::Vector3d& place = found.views.back().place;
    place = poseOf(*views[v].surface).inverse() * place;
  }
  return found;
}

}  // namespace glint
