// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/refine_normals.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/dense_algebra.h"
#include "core/base/numeric.h"
#include "core/base/residual_spread.h"
#include "core/geometry/polyline.h"
#include "core/light/contour_evidence.h"
#include "core/light/left_out.h"

namespace glint {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kNormalRounds = 40;
constexpr double kNormalsSettled = 1e-7;  // of the unit light, the limit angle and the priors, between rounds: far below any band
constexpr std::size_t kLeastPoints = 30;
constexpr std::size_t kMostPoints = 1500;  // of all views: more would say little more of bumps that are as wide as a highlight
constexpr int kLeastPerView = 12;
constexpr int kMostTerms = 120;
constexpr double kSmallTerm = 1e-5;                 // of a height's prior variance: what is left out is invisible
constexpr double kReaches[] = {4, 2, 1, 0.5};       // of a highlight's size: the length of the process
constexpr double kSteepness[] = {0.0625, 0.25, 1};  // of sigma, the flattest first
constexpr int kLeftOut = 6;                         // more places left out would not change a choice between so few

struct Seen {
  Vector3d position, normal, toCamera;  ///< unit vectors away from the surface
};
/// A contour point; lengths in units of the problem's scale.
struct Point {
  Seen at;
  double side = 1;             ///< -1 where the stored normal points away from the camera
  std::array<Seen, 4> around;  ///< of the pixels left, right, up, down
  double expected = 0;         ///< angle less the constant, rad
  int view = 0;
};

/// The gradient of the height at every point, per coefficient of unit prior.
struct Basis {
  std::array<MatrixXd, 3> gradient;  ///< by coordinate: points x terms
  MatrixXd weightsOfTerms;           ///< centres x terms
  std::vector<int> centres;          ///< indices of points
  double length = 1;
  Eigen::Index terms() const { return gradient[0].cols(); }
  Vector3d gradientAt(Eigen::Index point, const VectorXd& c) const {
    if (c.size() == 0) return Vector3d::Zero();
    return {gradient[0].row(point).dot(c), gradient[1].row(point).dot(c), gradient[2].row(point).dot(c)};
  }
};

struct State {
  Eigen::Vector4d light;
  double limit = 0;
  VectorXd c;  ///< in units of the prior
};

/// Towards the light, on the normal's side.
Vector3d toLight(const Seen& s, const Eigen::Vector4d& light) {
  const Vector3d d = (light.head<3>() - light.w() * s.position).normalized();
  return s.normal.dot(d) < 0 ? Vector3d(-d) : d;
}
double alphaOf(const Seen& s, const Eigen::Vector4d& light) { return incidentAngle(s.normal, toLight(s, light), s.toCamera); }

/// Unit tangent at N towards H: d alpha = -t . dN.
Vector3d towardsH(const Seen& s, const Eigen::Vector4d& light) {
  const Vector3d h = (toLight(s, light) + s.toCamera).normalized();
  return (h - s.normal * s.normal.dot(h)).normalized();
}

Eigen::Matrix<double, 4, 3> chartOf(const Eigen::Vector4d& light) {
  const Eigen::Matrix4d q = Eigen::HouseholderQR<Eigen::Vector4d>(light).householderQ();
  return q.rightCols<3>();
}

struct Problem {
  std::vector<Point> points;
  std::size_t views = 0;
  std::vector<int> places;  ///< of placesOf(), one per view
  Vector3d origin = Vector3d::Zero();
  double scale = 1;
  double robustPx = 1;

  /// The point with the normal of the corrected surface: N' ~ N - grad h along the surface.
  static Seen corrected(const Point& p, const Vector3d& gradient) {
    Seen s = p.at;
    s.normal = (s.normal - p.side * (gradient - s.normal * s.normal.dot(gradient))).normalized();
    return s;
  }
};

/// Greedy choice of centres among the points (pivoted Cholesky) until they explain the process everywhere.
Basis basisOf(const Problem& problem, double length) {
  const std::vector<Point>& points = problem.points;
  const Eigen::Index n = Eigen::Index(points.size());
  const auto kernel = [&](Eigen::Index i, Eigen::Index j) {
    return std::exp(-0.5 * (points[std::size_t(i)].at.position - points[std::size_t(j)].at.position).squaredNorm() /
                    (length * length));
  };
  Basis b;
  b.length = length;
  VectorXd left = VectorXd::Ones(n);
  MatrixXd columns(n, kMostTerms);
  Eigen::Index m = 0;
  for (; m < std::min<Eigen::Index>(kMostTerms, n); ++m) {
    Eigen::Index best = 0;
    if (!(left.maxCoeff(&best) > kSmallTerm)) break;
    const double root = std::sqrt(left(best));
    for (Eigen::Index i = 0; i < n; ++i)
      columns(i, m) = (kernel(i, best) - columns.row(i).head(m).dot(columns.row(best).head(m))) / root;
    left -= columns.col(m).cwiseAbs2();
    b.centres.push_back(int(best));
  }
  // K_zz = L L^T; the terms are L^-1 k(z, x).
  MatrixXd lower(m, m);
  for (Eigen::Index i = 0; i < m; ++i) lower.row(i) = columns.row(b.centres[std::size_t(i)]).head(m);
  for (int k = 0; k < 3; ++k) {
    MatrixXd slopes(m, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < m; ++j) {
        const Eigen::Index z = b.centres[std::size_t(j)];
        slopes(j, i) =
            -(points[std::size_t(i)].at.position(k) - points[std::size_t(z)].at.position(k)) / (length * length) * kernel(i, z);
      }
    b.gradient[std::size_t(k)] = lower.triangularView<Eigen::Lower>().solve(slopes).transpose();
  }
  b.weightsOfTerms = lower.transpose().triangularView<Eigen::Upper>().solve(MatrixXd::Identity(m, m));
  return b;
}

struct Linearised {
  VectorXd residuals, slopes;  ///< px, rad per px
  MatrixXd jacobian;           ///< px per (chart of L, limit, c)
};

Linearised linearised(const Problem& problem, const Basis& basis, double amplitude, const State& s, bool derivatives) {
  const Eigen::Index n = Eigen::Index(problem.points.size()), m = s.c.size();
  Linearised result;
  result.residuals = VectorXd::Zero(n);
  result.slopes = VectorXd::Zero(n);
  if (derivatives) result.jacobian = MatrixXd::Zero(n, 4 + m);
  const Eigen::Matrix<double, 4, 3> chart = chartOf(s.light);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Point& p = problem.points[std::size_t(i)];
    // The slope over the image is that of the given surface: bumps turn normals much more than they change curvature.
    const auto beside = [&](std::size_t k) { return alphaOf(p.around[k], s.light); };
    const double slope = std::hypot(beside(1) - beside(0), beside(3) - beside(2)) / (2 * ContourEvidence::kStepPx);
    if (!(slope > 0)) continue;
    result.slopes(i) = slope;
    const Seen at = Problem::corrected(p, amplitude * basis.gradientAt(i, s.c));
    result.residuals(i) = (alphaOf(at, s.light) - p.expected - s.limit) / slope;
    if (!derivatives) continue;
    auto row = result.jacobian.row(i);
    row.head<3>() = incidentAngleByLight(at.position, at.normal, at.toCamera, s.light).transpose() * chart;
    row(3) = -1;
    const Vector3d t = amplitude * p.side * towardsH(at, s.light);
    if (m > 0)
      for (int k = 0; k < 3; ++k) row.tail(m) += t(k) * basis.gradient[std::size_t(k)].row(i);
    row /= slope;
  }
  return result;
}

std::vector<double> list(const VectorXd& v) { return {v.data(), v.data() + v.size()}; }
double rms(const VectorXd& r) { return std::sqrt(r.squaredNorm() / double(std::max<Eigen::Index>(1, r.size()))); }

/// Huber's loss of residuals in px over the noise, with the prior.
double objective(const VectorXd& residuals, const VectorXd& c, double noise, double robustPx, const std::vector<char>& used) {
  double sum = c.squaredNorm();
  for (Eigen::Index i = 0; i < residuals.size(); ++i) {
    if (!used[std::size_t(i)]) continue;
    const double a = std::abs(residuals(i));
    sum += (a <= robustPx ? a * a : 2 * robustPx * a - robustPx * robustPx) / (noise * noise);
  }
  return sum;
}

/// Gauss-Newton with renewed weights and noise. Only the points of `used` count.
State fitted(const Problem& problem, const Basis& basis, double amplitude, State state, const std::vector<char>& used) {
  const Eigen::Index m = state.c.size(), n = Eigen::Index(problem.points.size());
  for (int round = 0; round < kNormalRounds; ++round) {
    const Linearised at = linearised(problem, basis, amplitude, state, true);
    std::vector<double> kept;
    for (Eigen::Index i = 0; i < n; ++i)
      if (used[std::size_t(i)]) kept.push_back(at.residuals(i));
    // What remains counts as noise; it falls as the normals explain more.
    const double noise = std::clamp(rmsWithoutTail(kept), refining::kLeastNoisePx, 1.0);
    MatrixXd rows = MatrixXd::Zero(n + m, 4 + m);
    VectorXd right = VectorXd::Zero(n + m);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!used[std::size_t(i)]) continue;
      const double size = std::max(std::abs(at.residuals(i)), 1e-300);  // no division by zero
      const double root = std::sqrt(std::min(1.0, problem.robustPx / size)) / noise;
      rows.row(i) = root * at.jacobian.row(i);
      right(i) = -root * at.residuals(i);
    }
    rows.bottomRightCorner(m, m).setIdentity();
    right.tail(m) = -state.c;
    // Angles and unit vectors: columns are alike enough for QR with column pivoting to see a free direction.
    const VectorXd step = Eigen::ColPivHouseholderQR<MatrixXd>(rows).solve(right);
    if (!step.allFinite()) break;
    const double before = objective(at.residuals, state.c, noise, problem.robustPx, used);
    bool accepted = false;
    double share = 1;
    State next;
    for (int halving = 0; halving < 8 && !accepted; ++halving, share *= 0.5) {
      next = state;
      next.light = (state.light + chartOf(state.light) * (share * step.head<3>())).normalized();
      next.limit = state.limit + share * step(3);
      next.c = state.c + share * step.tail(m);
      const VectorXd r = linearised(problem, basis, amplitude, next, false).residuals;
      accepted = r.allFinite() && objective(r, next.c, noise, problem.robustPx, used) <= before;
    }
    if (!accepted) break;
    const double moved = (next.light - state.light).norm() + std::abs(next.limit - state.limit) + (next.c - state.c).norm();
    state = next;
    if (moved < kNormalsSettled) break;
  }
  return state;
}

/// RMS distance of each of some views' contours from what the other views give, px.
std::vector<double> leftOutErrors(const Problem& problem, const Basis& basis, double amplitude, const State& start) {
  std::vector<double> errors;
  for (const int left : placesToLeaveOut(problem.places, kLeftOut)) {
    std::vector<char> used;
    std::size_t others = 0;
    for (const Point& p : problem.points) {
      const bool stays = problem.places[std::size_t(p.view)] != left;
      used.push_back(stays);
      others += stays;
    }
    if (others < kLeastPoints || others == problem.points.size()) continue;
    const VectorXd r = linearised(problem, basis, amplitude, fitted(problem, basis, amplitude, start, used), false).residuals;
    std::vector<double> own;
    for (std::size_t k = 0; k < used.size(); ++k)
      if (!used[k]) own.push_back(r(Eigen::Index(k)));
    errors.push_back(std::max(refining::kLeastNoisePx, rms(Eigen::Map<VectorXd>(own.data(), Eigen::Index(own.size())))));
  }
  return errors;
}

std::optional<Point> pointAt(const BundleView& view, const Pixel& pixel) {
  const Vector3d eye = view.camera.centreInWorld();
  const auto seen = [&](const Pixel& p, double* side = nullptr) -> std::optional<Seen> {
    const Outcome<SurfacePoint> hit = view.surface->firstHit(view.camera.ray(p));
    if (!hit || !hit->position.allFinite() || !hit->normal.allFinite()) return std::nullopt;
    const SurfacePoint s = facing(*hit, eye);
    if (side) *side = s.normal.dot(hit->normal) < 0 ? -1 : 1;
    return Seen{s.position, s.normal, (eye - s.position).normalized()};
  };
  Point p;
  const std::optional<Seen> at = seen(pixel, &p.side);
  if (!at) return std::nullopt;
  p.at = *at;
  const Pixel offsets[] = {{-ContourEvidence::kStepPx, 0},
                           {ContourEvidence::kStepPx, 0},
                           {0, -ContourEvidence::kStepPx},
                           {0, ContourEvidence::kStepPx}};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::optional<Seen> beside = seen(pixel + offsets[k]);
    if (!beside) return std::nullopt;
    p.around[k] = *beside;
  }
  return p;
}

Outcome<Problem> problemOf(const std::vector<BundleView>& views, const BundleOptions& options, const ContourAngle& angles) {
  Problem problem;
  problem.views = views.size();
  problem.places = placesOf(views);
  problem.robustPx = options.robustPx;
  const int perView =
      std::min(options.pointsPerView, std::max(kLeastPerView, int(kMostPoints / std::max<std::size_t>(1, views.size()))));
  problem.scale = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    require(views[v].surface != nullptr, "refineNormals: a view without surface");
    for (const Pixel& pixel : views[v].contour)
      if (!pixel.allFinite()) return Failure{Reason::NotFinite, "a contour point of view " + std::to_string(v)};
    const std::vector<Pixel> pixels =
        views[v].contour.size() > std::size_t(perView) ? resample(Polyline{views[v].contour, true}, perView) : views[v].contour;
    for (const Pixel& pixel : pixels) {
      std::optional<Point> p = pointAt(views[v], pixel);
      if (!p) continue;
      if (angles) {
        const std::optional<double> expected = angles(v, pixel);
        if (!expected || !std::isfinite(*expected)) continue;
        p->expected = *expected;
      }
      p->view = int(v);
      problem.origin += p->at.position;
      problem.scale += (views[v].camera.centreInWorld() - p->at.position).norm();
      problem.points.push_back(*std::move(p));
    }
  }
  if (problem.points.size() < kLeastPoints)
    return Failure{Reason::TooFewPoints,
                   "need " + std::to_string(kLeastPoints) + " on the surface, have " + std::to_string(problem.points.size())};
  problem.origin /= double(problem.points.size());
  problem.scale /= double(problem.points.size());
  if (!(problem.scale > 0) || !std::isfinite(problem.scale)) return Failure{Reason::NotFinite, "camera distance"};
  for (Point& p : problem.points) {
    p.at.position = (p.at.position - problem.origin) / problem.scale;
    for (Seen& s : p.around) s.position = (s.position - problem.origin) / problem.scale;
  }
  return problem;
}

/// Median over the views of twice the RMS distance of a contour's points from their middle.
double highlightSize(const Problem& problem) {
  std::vector<double> sizes;
  for (std::size_t first = 0; first < problem.points.size();) {
    std::size_t end = first;
    Vector3d middle = Vector3d::Zero();
    for (; end < problem.points.size() && problem.points[end].view == problem.points[first].view; ++end)
      middle += problem.points[end].at.position;
    middle /= double(end - first);
    double sum = 0;
    for (std::size_t i = first; i < end; ++i) sum += (problem.points[i].at.position - middle).squaredNorm();
    sizes.push_back(2 * std::sqrt(sum / double(end - first)));
    first = end;
  }
  return upperMedian(sizes);
}

struct Choice {
  Basis basis;
  double amplitude = 0;         ///< standard deviation of the height
  std::vector<double> leftOut;  ///< errors of left-out views
};

double meanLog(const std::vector<double>& errors) {
  double sum = 0;
  for (const double e : errors) sum += std::log(e) / double(errors.size());
  return sum;
}

/// The best of the flattest processes that predict left-out views no worse than the best one by more than the standard error.
/// Nothing where it gains nothing over the normals as they are. A flat one is preferred, because a steep one would go astray
/// where no highlight shows the surface.
std::optional<Choice> choose(const Problem& problem, const State& plain, const Basis& none, double sigma, double size) {
  std::vector<Basis> bases;
  for (const double reach : kReaches) bases.push_back(basisOf(problem, reach * size));
  std::vector<std::vector<Choice>> choices;
  const Choice* best = nullptr;
  for (const double steep : kSteepness) {
    choices.emplace_back();
    for (const Basis& basis : bases) {
      State from = plain;
      from.c = VectorXd::Zero(basis.terms());
      const double height = steep * sigma * basis.length;
      choices.back().push_back({basis, height, leftOutErrors(problem, basis, height, from)});
    }
  }
  for (const std::vector<Choice>& row : choices)
    for (const Choice& c : row)
      if (!c.leftOut.empty() && (!best || meanLog(c.leftOut) < meanLog(best->leftOut))) best = &c;
  if (!best) return std::nullopt;
  const Choice* chosen = nullptr;
  for (const std::vector<Choice>& row : choices) {
    for (const Choice& c : row)
      if (!predictsLeftOutBetter(best->leftOut, c.leftOut) && (!chosen || meanLog(c.leftOut) < meanLog(chosen->leftOut)))
        chosen = &c;
    if (chosen) break;
  }
  if (!chosen || !predictsLeftOutBetter(chosen->leftOut, leftOutErrors(problem, none, 0, plain))) return std::nullopt;
  return *chosen;
}

/// Covariance of everything together, the prior as further rows in units of the noise: columns of its root. Empty where a
/// direction is free.
MatrixXd rootOf(const Linearised& at, Eigen::Index terms, const ResidualSpread& spread) {
  const Eigen::Index columns = 4 + terms;
  MatrixXd rows = MatrixXd::Zero(at.jacobian.rows() + terms, columns);
  rows.topRows(at.jacobian.rows()) = at.jacobian / std::sqrt(spread.factor);
  rows.bottomRightCorner(terms, terms).setIdentity();
  const MatrixXd upper = triangularFactor(rows);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(upper, Eigen::ComputeFullV);
  if (!(svd.singularValues()(columns - 1) > 1e-14 * svd.singularValues()(0))) return {};  // free to round-off
  return svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
}

}  // namespace

Outcome<NormalRefinement> refineNormals(const std::vector<BundleView>& views, const Light& start, double sigma,
                                        const BundleOptions& options, const ContourAngle& angles) {
  require(sigma > 0, "refineNormals: sigma");
  Outcome<Problem> made = problemOf(views, options, angles);
  if (!made) return made.failure();
  const Problem& problem = *made;
  const std::vector<char> all(problem.points.size(), 1);

  State state;
  const Eigen::Vector4d& lw = start.homogeneous();
  state.light << (lw.head<3>() - lw.w() * problem.origin) / problem.scale, lw.w();
  state.light.normalize();
  std::vector<double> first;
  for (const Point& p : problem.points) first.push_back(alphaOf(p.at, state.light) - p.expected);
  state.limit = upperMedian(first);
  Basis basis;
  state.c.resize(0);
  state = fitted(problem, basis, 0, state, all);
  if (!state.light.allFinite() || !std::isfinite(state.limit)) return Failure{Reason::NotFinite, "normals"};

  std::vector<int> owners;
  for (const Point& p : problem.points) owners.push_back(p.view);
  NormalRefinement result;
  const VectorXd plain = linearised(problem, basis, 0, state, false).residuals;
  result.plainRmsPx = result.rmsPx = rms(plain);
  Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
  toWorld.topLeftCorner<3, 3>() *= problem.scale;
  toWorld.topRightCorner<3, 1>() = problem.origin;
  const auto worldLight = [&](const State& s) {
    return Eigen::Vector4d(toWorld * (s.light.w() < 0 ? Eigen::Vector4d(-s.light) : s.light));
  };
  if (!worldLight(state).allFinite()) return Failure{Reason::NotFinite, "light"};
  result.light = Light::homogeneous(worldLight(state));
  result.limitAngle = state.limit;
  // Wrong normals leave residuals that keep their sign along contours.
  const ResidualSpread before = residualSpread(list(plain), owners, 4, options.robustPx);
  if (!(result.plainRmsPx > refining::kLeastNoisePx) ||
      !(before.degreesOfFreedom < refining::kSystematic * double(problem.points.size())))
    return result;

  const std::optional<Choice> choice = choose(problem, state, basis, sigma, highlightSize(problem));
  if (!choice) return result;
  basis = choice->basis;
  const double amplitude = choice->amplitude;
  state.c = VectorXd::Zero(basis.terms());
  state = fitted(problem, basis, amplitude, state, all);
  const Linearised at = linearised(problem, basis, amplitude, state, true);
  if (!worldLight(state).allFinite() || !state.c.allFinite()) return Failure{Reason::NotFinite, "refined normals"};
  const Eigen::Vector4d world = worldLight(state);
  result.light = Light::homogeneous(world);
  result.limitAngle = state.limit;
  result.rmsPx = rms(at.residuals);
  result.correction.length = basis.length * problem.scale;
  result.correction.weights = amplitude * problem.scale * basis.weightsOfTerms * state.c;
  for (const int i : basis.centres)
    result.correction.centres.push_back(problem.origin + problem.scale * problem.points[std::size_t(i)].at.position);
  MatrixXd mean = MatrixXd::Zero(3, basis.terms());
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const Vector3d& n = problem.points[i].at.normal;
    MatrixXd g(3, basis.terms());
    for (int k = 0; k < 3; ++k) g.row(k) = amplitude * basis.gradient[std::size_t(k)].row(Eigen::Index(i));
    g -= n * (n.transpose() * g);
    mean += g / double(problem.points.size());
    result.slope += (g * state.c).squaredNorm() / double(problem.points.size());
  }
  result.slope = std::sqrt(result.slope);

  const ResidualSpread spread = residualSpread(list(at.residuals), owners, int(4 + basis.terms()), options.robustPx);
  const MatrixXd root = rootOf(at, basis.terms(), spread);
  if (root.size() == 0) return result;
  result.openTilt = std::min(1.0, (mean * root.bottomRows(basis.terms())).norm() / mean.norm());
  const MatrixXd dy = toWorld * chartOf(state.light) * root.topRows<3>();
  result.uncertainty = uncertaintyOfUnit(world, dy, root.row(3), spread.noisePx, spread.degreesOfFreedom);
  return result;
}

}  // namespace glint
