// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/geometry/polyline.h"
#include "core/light/contour_evidence.h"
#include "core/light/estimate.h"

namespace glint {
namespace {

constexpr double kPoseStep = 0.02;  // of a standard deviation of the prior: central differences, far above the round-off of a hit
constexpr int kPoseRounds = 8;

/// Turn (3) and shift (3) in the camera's frame, in standard deviations of the prior.
using Correction = Eigen::Matrix<double, 6, 1>;

struct View {
  const BundleView* given;
  std::vector<Pixel> pixels;
  double turn = 0, shift = 0;  ///< one standard deviation: rad, world units
  Correction correction = Correction::Zero();

  Camera camera(const Correction& c) const {
    Camera moved = given->camera;
    const Eigen::Vector3d axis = turn * c.head<3>();
    Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
    if (axis.norm() > 0) by.linear() = Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix();
    by.translation() = shift * c.tail<3>();
    moved.camFromWorld = by * moved.camFromWorld;
    return moved;
  }
};

struct Hit {
  Eigen::Vector3d position, normal, toCamera;
};
std::optional<Hit> hitAt(const Surface& surface, const Camera& camera, const Pixel& p) {
  const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(p));
  if (!hit) return std::nullopt;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint s = facing(*hit, eye);
  return Hit{s.position, s.normal, (eye - s.position).normalized()};
}
double alphaOf(const Hit& h, const Eigen::Vector4d& light) {
  Eigen::Vector3d d = (light.head<3>() - light.w() * h.position).normalized();
  if (h.normal.dot(d) < 0) d = -d;
  return incidentAngle(h.normal, d, h.toCamera);
}

std::vector<BundleView> withCameras(const std::vector<View>& views) {
  std::vector<BundleView> moved;
  for (const View& v : views) {
    moved.push_back(*v.given);
    moved.back().camera = v.camera(v.correction);
  }
  return moved;
}

/// One joint step. @return the corrections of all views, or nothing where too few points are on the surface.
std::optional<std::vector<Correction>> step(const std::vector<View>& views, const Bundle& bundle, double robustPx,
                                            double noisePx) {
  const Eigen::Vector4d& light = bundle.light.homogeneous();
  // Tangent directions of |L| = 1: the three columns of Q after the first, for the QR of L itself.
  const Eigen::Matrix4d q = Eigen::HouseholderQR<Eigen::Vector4d>(light).householderQ();
  const Eigen::Matrix<double, 4, 3> chart = q.rightCols<3>();
  const Eigen::Index columns = 4 + 6 * Eigen::Index(views.size());
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const View& view = views[v];
    const Surface& surface = *view.given->surface;
    const Camera camera = view.camera(view.correction);
    std::vector<Camera> plus, minus;
    for (int k = 0; k < 6; ++k) {
      plus.push_back(view.camera(view.correction + kPoseStep * Correction::Unit(k)));
      minus.push_back(view.camera(view.correction - kPoseStep * Correction::Unit(k)));
    }
    for (const Pixel& p : view.pixels) {
      const std::optional<Hit> at = hitAt(surface, camera, p);
      const std::optional<Hit> l = hitAt(surface, camera, p - Pixel(ContourEvidence::kStepPx, 0)),
                               r = hitAt(surface, camera, p + Pixel(ContourEvidence::kStepPx, 0)),
                               u = hitAt(surface, camera, p - Pixel(0, ContourEvidence::kStepPx)),
                               d = hitAt(surface, camera, p + Pixel(0, ContourEvidence::kStepPx));
      if (!at || !l || !r || !u || !d) continue;
      const double slope = std::hypot(alphaOf(*r, light) - alphaOf(*l, light), alphaOf(*d, light) - alphaOf(*u, light)) /
                           (2 * ContourEvidence::kStepPx);
      if (!(slope > 0)) continue;
      Eigen::VectorXd row = Eigen::VectorXd::Zero(columns + 1);
      row.head<3>() = chart.transpose() * incidentAngleByLight(at->position, at->normal, at->toCamera, light);
      row(3) = -1;
      bool whole = true;
      for (int k = 0; k < 6 && whole; ++k) {
        const std::optional<Hit> a = hitAt(surface, plus[k], p), b = hitAt(surface, minus[k], p);
        whole = a && b;
        if (whole) row(4 + 6 * v + k) = (alphaOf(*a, light) - alphaOf(*b, light)) / (2 * kPoseStep);
      }
      if (!whole) continue;
      row(columns) = alphaOf(*at, light) - bundle.limitAngle;
      row /= slope;
      const double size = std::abs(row(columns));
      if (size > robustPx) row *= std::sqrt(robustPx / size);  // Huber's weight
      row /= noisePx;
      if (row.allFinite()) rows.push_back(std::move(row));
    }
  }
  if (Eigen::Index(rows.size()) < 5) return std::nullopt;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(Eigen::Index(rows.size()) + 6 * Eigen::Index(views.size()), columns + 1);
  for (std::size_t i = 0; i < rows.size(); ++i) system.row(i) = rows[i].transpose();
  for (std::size_t v = 0; v < views.size(); ++v)
    for (int k = 0; k < 6; ++k) {
      const Eigen::Index i = Eigen::Index(rows.size()) + 6 * Eigen::Index(v) + k;
      system(i, 4 + 6 * v + k) = 1;
      system(i, columns) = views[v].correction(k);
    }
  const Eigen::VectorXd solution = system.leftCols(columns).colPivHouseholderQr().solve(-system.col(columns));
  if (!solution.allFinite()) return std::nullopt;
  std::vector<Correction> corrections;
  for (std::size_t v = 0; v < views.size(); ++v) corrections.push_back(solution.segment<6>(4 + 6 * v));
  return corrections;
}

/// Robust cost of the bundle plus that of the prior, both in squared standard deviations.
double cost(const Bundle& bundle, const std::vector<View>& views, const BundleOptions& options, double noisePx) {
  double sum = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double rms = bundle.residualPx[v], n = double(views[v].pixels.size());
    sum += n * (rms <= options.robustPx ? rms * rms : options.robustPx * (2 * rms - options.robustPx)) / (noisePx * noisePx);
    sum += views[v].correction.squaredNorm();
  }
  return sum;
}

}  // namespace

Outcome<PoseRefinement> refinePoses(const std::vector<BundleView>& given, const Light& start, double sigmaPx,
                                    const BundleOptions& options) {
  require(sigmaPx > 0, "refinePoses: sigmaPx");
  Outcome<Bundle> bundle = bundleLight(given, start, options);
  if (!bundle) return bundle.failure();
  std::vector<View> views;
  for (const BundleView& g : given) {
    View v{&g, g.contour.size() > std::size_t(options.pointsPerView) ? resample(Polyline{g.contour, true}, options.pointsPerView)
                                                                     : g.contour};
    double distance = 0;
    int n = 0;
    for (const Pixel& p : v.pixels)
      if (const std::optional<Hit> hit = hitAt(*g.surface, g.camera, p))
        distance += (hit->position - g.camera.centreInWorld()).norm(), ++n;
    const double focal = g.camera.pixelFromRay(0, 0);
    v.turn = sigmaPx / focal;
    v.shift = n > 0 ? sigmaPx / focal * distance / n : 0;
    views.push_back(std::move(v));
  }
  // Wrong poses leave residuals that keep their sign along contours. Without such residuals the bundle is as good as it gets, and
  // free poses would only move noise into the light.
  std::size_t points = 0;
  for (const View& v : views) points += v.pixels.size();
  const bool systematic = bundle->rmsPx > refining::kLeastNoisePx && bundle->uncertainty &&
                          bundle->uncertainty->degreesOfFreedom < refining::kSystematic * double(points);
  for (int round = 0; systematic && round < kPoseRounds; ++round) {
    // What remains counts as the contours' noise; it falls as the poses explain more.
    const double noise = std::clamp(bundle->rmsPx, refining::kLeastNoisePx, 1.0);
    double best = cost(*bundle, views, options, noise);
    const std::optional<std::vector<Correction>> change = step(views, *bundle, options.robustPx, noise);
    if (!change) break;
    bool better = false;
    double moved = 0;
    for (double share = 1; share > 0.1 && !better; share *= 0.5) {
      std::vector<View> next = views;
      moved = 0;
      for (std::size_t v = 0; v < views.size(); ++v) {
        next[v].correction += share * (*change)[v];
        moved = std::max(moved, share * (*change)[v].cwiseAbs().maxCoeff());
      }
      const Outcome<Bundle> other = bundleLight(withCameras(next), bundle->light, options);
      if (!other) continue;
      const double value = cost(*other, next, options, noise);
      if (!(value < best)) continue;
      best = value;
      views = std::move(next);
      bundle = other;
      better = true;
    }
    if (!better || moved < 1e-4) break;  // of a standard deviation of the prior
  }
  PoseRefinement result;
  result.bundle = *bundle;
  double squares = 0;
  for (const View& v : views) {
    result.cameras.push_back(v.camera(v.correction));
    squares += (sigmaPx * v.correction).squaredNorm() / 6;
  }
  result.movedPx = std::sqrt(squares / double(views.size()));
  return result;
}

}  // namespace glint
