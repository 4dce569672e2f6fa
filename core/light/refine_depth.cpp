// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/refine_depth.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/base/dense_algebra.h"
#include "core/base/residual_spread.h"
#include "core/geometry/polyline.h"
#include "core/light/contour_evidence.h"
#include "core/light/dense_solver.h"
#include "core/light/left_out.h"

namespace glint {
namespace {

using Terms = DepthCorrection::Terms;
constexpr int kDepthRounds = 20, kIterations = 50;
constexpr double kTolerance = 1e-10;    // the differences by the terms keep about as many digits
constexpr double kDepthSettled = 1e-6;  // of the unit light, the limit angle and the priors, between rounds: far below any band
constexpr double kColumnStep = 1e-3;    // of a prior's standard deviation, for derivatives; the angle is smooth in the depth

struct Monomials {
  Terms value, byX, byY;  ///< byX, byY per unit of x and y
};
Monomials monomials(double x, double y) {
  Monomials m;
  double px[DepthCorrection::kOrder + 1] = {1}, py[DepthCorrection::kOrder + 1] = {1};
  for (int i = 1; i <= DepthCorrection::kOrder; ++i) px[i] = px[i - 1] * x, py[i] = py[i - 1] * y;
  int k = 0;
  for (int n = 0; n <= DepthCorrection::kOrder; ++n)
    for (int j = 0; j <= n; ++j, ++k) {
      const int i = n - j;
      m.value(k) = px[i] * py[j];
      m.byX(k) = i > 0 ? i * px[i - 1] * py[j] : 0;
      m.byY(k) = j > 0 ? j * px[i] * py[j - 1] : 0;
    }
  return m;
}
Terms priors(double sigma) {
  Terms s;
  int k = 0;
  for (int n = 0; n <= DepthCorrection::kOrder; ++n)
    for (int j = 0; j <= n; ++j, ++k) s(k) = sigma / std::max(1, n);  // so that the slopes of all degrees have about one size
  return s;
}
double halfDiagonal(const Camera& c) { return 0.5 * std::hypot(c.width, c.height); }
Pixel normalised(const Camera& c, const Pixel& p) { return (p - 0.5 * Pixel(c.width - 1, c.height - 1)) / halfDiagonal(c); }

/// A pixel with its depth and slope, in the camera's frame.
struct Sample {
  Eigen::Vector3d ray, rayByU, rayByV;  ///< of depth 1, and per pixel
  double depth = 0, depthByU = 0, depthByV = 0;
  Monomials terms;  ///< derivatives per pixel
};
struct Point {
  Sample at, left, right, up, down;
  int view = 0;
};
struct View {
  Eigen::Isometry3d worldFromCamera;
  Eigen::Vector3d eye;
};

std::optional<Sample> sampleAt(const BundleView& view, const Pixel& p) {
  const Outcome<SurfacePoint> hit = view.surface->firstHit(view.camera.ray(p));
  if (!hit) return std::nullopt;
  const Eigen::Matrix3d rayFromPixel = view.camera.pixelFromRay.inverse();
  Sample s;
  s.ray = rayFromPixel * Eigen::Vector3d(p.x(), p.y(), 1);
  s.rayByU = rayFromPixel.col(0);
  s.rayByV = rayFromPixel.col(1);
  s.depth = (view.camera.camFromWorld * hit->position).z();
  const Eigen::Vector3d n = view.camera.camFromWorld.linear() * hit->normal;
  const double across = n.dot(s.ray);
  if (!(s.depth > 0) || !(std::abs(across) > 1e-6)) return std::nullopt;  // seen edge on: no slope to correct
  s.depthByU = -s.depth * n.dot(s.rayByU) / across;
  s.depthByV = -s.depth * n.dot(s.rayByV) / across;
  const Pixel x = normalised(view.camera, p);
  s.terms = monomials(x.x(), x.y());
  s.terms.byX /= halfDiagonal(view.camera);
  s.terms.byY /= halfDiagonal(view.camera);
  return s;
}

struct Seen {
  Eigen::Vector3d position, normal, toCamera;
};
struct Problem {
  std::vector<Point> points;
  std::vector<View> views;
  std::vector<int> places;  ///< of placesOf(), one per view
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 1;

  Seen seen(const Sample& s, const View& v, const Terms& c) const {
    const double factor = 1 + c.dot(s.terms.value), depth = s.depth * factor;
    const double byU = s.depthByU * factor + s.depth * c.dot(s.terms.byX),
                 byV = s.depthByV * factor + s.depth * c.dot(s.terms.byY);
    const Eigen::Vector3d u = byU * s.ray + depth * s.rayByU, w = byV * s.ray + depth * s.rayByV;
    Seen result;
    const Eigen::Vector3d position = v.worldFromCamera * Eigen::Vector3d(depth * s.ray);
    result.toCamera = (v.eye - position).normalized();
    result.normal = (v.worldFromCamera.linear() * u.cross(w)).normalized();
    if (result.normal.dot(result.toCamera) < 0) result.normal = -result.normal;
    result.position = (position - origin) / scale;
    return result;
  }
  static double alpha(const Seen& s, const Eigen::Vector4d& light) {
    Eigen::Vector3d d = (light.head<3>() - light.w() * s.position).normalized();
    if (s.normal.dot(d) < 0) d = -d;
    return incidentAngle(s.normal, d, s.toCamera);
  }
  double alpha(const Sample& s, const View& v, const Eigen::Vector4d& light, const Terms& c) const {
    return alpha(seen(s, v, c), light);
  }
  /// d alpha / d c_k in units of the prior.
  double alphaByTerm(const Sample& s, const View& v, const Eigen::Vector4d& light, const Terms& c, const Terms& prior,
                     int k) const {
    const Terms by = kColumnStep * prior(k) * Terms::Unit(k);
    return (alpha(s, v, light, c + by) - alpha(s, v, light, c - by)) / (2 * kColumnStep);
  }
};

struct State {
  Eigen::Vector4d light;
  double limit = 0;
  Terms c = Terms::Zero();
};

/// Signed contour distances in pixels; the slopes too where asked.
std::vector<double> residuals(const Problem& problem, const State& s, std::vector<double>* slopes = nullptr) {
  std::vector<double> result;
  result.reserve(problem.points.size());
  for (const Point& p : problem.points) {
    const View& v = problem.views[p.view];
    const auto a = [&](const Sample& sample) { return problem.alpha(sample, v, s.light, s.c); };
    const double slope = std::hypot(a(p.right) - a(p.left), a(p.down) - a(p.up)) / (2 * ContourEvidence::kStepPx);
    result.push_back(slope > 0 ? (a(p.at) - s.limit) / slope : 0.0);
    if (slopes) slopes->push_back(slope);
  }
  return result;
}

double rms(const std::vector<double>& residuals) {
  double sum = 0;
  for (const double r : residuals) sum += r * r;
  return std::sqrt(sum / double(residuals.size()));
}

Eigen::Matrix<double, 4, 3> chartOf(const Eigen::Vector4d& light) {
  const Eigen::Matrix4d q = Eigen::HouseholderQR<Eigen::Vector4d>(light).householderQ();
  return q.rightCols<3>();
}

/// d residual / d (chart of L, limit, the first `terms` of c in units of the prior), px, with the weights held.
Eigen::MatrixXd jacobian(const Problem& problem, const State& s, const std::vector<double>& slopes, const Terms& prior,
                         int terms) {
  const Eigen::Matrix<double, 4, 3> chart = chartOf(s.light);
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(Eigen::Index(problem.points.size()), 4 + terms);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    if (!(slopes[i] > 0)) continue;
    const Point& p = problem.points[i];
    const View& v = problem.views[p.view];
    const Seen at = problem.seen(p.at, v, s.c);
    j.row(i).head<3>() = incidentAngleByLight(at.position, at.normal, at.toCamera, s.light).transpose() * chart;
    j(i, 3) = -1;
    for (int k = 0; k < terms; ++k) j(i, 4 + k) = problem.alphaByTerm(p.at, v, s.light, s.c, prior, k);
    j.row(i) /= slopes[i];
  }
  return j;
}

/// Contour distance of one point over the noise, its weight held.
class PointCost final : public ceres::CostFunction {
 public:
  PointCost(const Problem& problem, const Point& point, double slope, double noise, const Terms& prior, int terms)
      : problem_(problem), point_(point), unit_(slope * noise), prior_(prior), terms_(terms) {
    set_num_residuals(1);
    *mutable_parameter_block_sizes() = {4, 1};
    if (terms > 0) mutable_parameter_block_sizes()->push_back(terms);
  }
  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const Eigen::Map<const Eigen::Vector4d> light(parameters[0]);
    Terms c = Terms::Zero();  // the parameters are in units of the prior
    for (int k = 0; k < terms_; ++k) c(k) = parameters[2][k] * prior_(k);
    const View& v = problem_.views[point_.view];
    const Seen at = problem_.seen(point_.at, v, c);
    residuals[0] = (problem_.alpha(at, light) - parameters[1][0]) / unit_;
    if (!std::isfinite(residuals[0])) return false;
    if (!jacobians) return true;
    if (jacobians[0]) {
      const Eigen::Vector4d byLight = incidentAngleByLight(at.position, at.normal, at.toCamera, light) / unit_;
      std::copy_n(byLight.data(), 4, jacobians[0]);
    }
    if (jacobians[1]) jacobians[1][0] = -1 / unit_;
    if (terms_ > 0 && jacobians[2])
      for (int k = 0; k < terms_; ++k) jacobians[2][k] = problem_.alphaByTerm(point_.at, v, light, c, prior_, k) / unit_;
    return true;
  }

 private:
  const Problem& problem_;
  const Point& point_;
  double unit_;
  const Terms& prior_;
  int terms_;
};

/// Light, limit angle and the first `terms` terms together; weights and noise are renewed until nothing moves.
State fitted(const Problem& problem, State state, const Terms& prior, int terms, double robustPx) {
  for (int round = 0; round < kDepthRounds; ++round) {
    std::vector<double> slopes;
    // What remains counts as noise; it falls as the depth explains more.
    const double noise = std::clamp(rms(residuals(problem, state, &slopes)), refining::kLeastNoisePx, 1.0);
    Eigen::VectorXd c = state.c.cwiseQuotient(prior).head(terms);
    State next = state;
    ceres::Problem ceresProblem;
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      if (!(slopes[i] > 0)) continue;
      auto* cost = new PointCost(problem, problem.points[i], slopes[i], noise, prior, terms);
      auto* loss = new ceres::HuberLoss(robustPx / noise);
      if (terms > 0)
        ceresProblem.AddResidualBlock(cost, loss, next.light.data(), &next.limit, c.data());
      else
        ceresProblem.AddResidualBlock(cost, loss, next.light.data(), &next.limit);
    }
    if (ceresProblem.NumResiduals() == 0) return state;
    if (terms > 0)
      ceresProblem.AddResidualBlock(new ceres::NormalPrior(Eigen::MatrixXd::Identity(terms, terms), Eigen::VectorXd::Zero(terms)),
                                    nullptr, c.data());
    ceresProblem.SetManifold(next.light.data(), new ceres::SphereManifold<4>());
    const DenseSolution solution = solveDense(ceresProblem, kIterations, kTolerance);
    next.c.head(terms) = c.cwiseProduct(prior.head(terms));
    if (!solution.usable || !next.light.allFinite() || !next.c.allFinite() || !(next.limit > 0)) break;
    const double moved = std::max({(next.light - state.light).norm(), std::abs(next.limit - state.limit) / state.limit,
                                   (next.c - state.c).cwiseQuotient(prior).norm()});
    state = next;
    if (moved < kDepthSettled) break;
  }
  return state;
}

/// RMS distance of each of some views' contours from the level set that the other views give, px.
std::vector<double> leftOutErrors(const Problem& problem, const State& start, const Terms& prior, int terms, double robustPx) {
  constexpr int kLeftOut = 6;  // more places left out would not change a choice between so few
  std::vector<double> errors;
  for (const int left : placesToLeaveOut(problem.places, kLeftOut)) {
    const auto isLeft = [&](const Point& p) { return problem.places[std::size_t(p.view)] == left; };
    Problem others = problem, one = problem;
    std::erase_if(others.points, isLeft);
    std::erase_if(one.points, [&](const Point& p) { return !isLeft(p); });
    if (one.points.empty() || others.points.size() < 30) continue;
    errors.push_back(rms(residuals(one, fitted(others, start, prior, terms, robustPx))));
  }
  return errors;
}

std::optional<Point> pointAt(const BundleView& view, const Pixel& p) {
  constexpr double kStep = ContourEvidence::kStepPx;
  const auto at = [&](double x, double y) { return sampleAt(view, p + Pixel(x, y)); };
  const std::optional<Sample> here = at(0, 0), left = at(-kStep, 0), right = at(kStep, 0), up = at(0, -kStep),
                              down = at(0, kStep);
  if (!here || !left || !right || !up || !down) return std::nullopt;
  return Point{*here, *left, *right, *up, *down};
}

/// The views' contours, measured from the mean of their points in units of their mean distance.
Problem problemOf(const std::vector<BundleView>& given, int pointsPerView) {
  Problem problem;
  problem.places = placesOf(given);
  double distance = 0;
  for (std::size_t v = 0; v < given.size(); ++v) {
    const BundleView& g = given[v];
    problem.views.push_back({g.camera.camFromWorld.inverse(), g.camera.centreInWorld()});
    const std::vector<Pixel> pixels =
        g.contour.size() > std::size_t(pointsPerView) ? resample(Polyline{g.contour, true}, pointsPerView) : g.contour;
    for (const Pixel& p : pixels) {
      std::optional<Point> point = pointAt(g, p);
      if (!point) continue;
      point->view = int(v);
      problem.points.push_back(*point);
      const Sample& here = point->at;
      problem.origin += problem.views[v].worldFromCamera * Eigen::Vector3d(here.depth * here.ray);
      distance += here.depth * here.ray.norm();
    }
  }
  problem.origin /= double(problem.points.size());
  problem.scale = distance / double(problem.points.size());
  return problem;
}

/// As many terms as predict views that were left out better: free terms that nothing asks for would trade noise between depth
/// and light.
int usefulTerms(const Problem& problem, const State& start, const Terms& prior, double robustPx) {
  int terms = 0;
  std::vector<double> best = leftOutErrors(problem, start, prior, 0, robustPx);
  for (const int more : {6, DepthCorrection::kTerms}) {  // up to second, up to fourth degree
    std::vector<double> errors = leftOutErrors(problem, start, prior, more, robustPx);
    if (!predictsLeftOutBetter(errors, best)) continue;
    terms = more;
    best = std::move(errors);
  }
  return terms;
}

/// Covariance of everything together, the prior as further rows in units of the noise.
/// @param toWorld  of homogeneous points. @param r, slopes  residuals and slopes at the state
void addUncertainty(const Problem& problem, const State& state, const Terms& prior, int terms, double robustPx,
                    const Eigen::Matrix4d& toWorld, const std::vector<double>& r, const std::vector<double>& slopes,
                    DepthRefinement& result) {
  const Eigen::Index columns = 4 + terms;
  std::vector<int> views;
  for (const Point& p : problem.points) views.push_back(p.view);
  const ResidualSpread spread = residualSpread(r, views, int(columns), robustPx);
  const Eigen::MatrixXd j = jacobian(problem, state, slopes, prior, terms);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(j.rows() + terms, columns);
  rows.topRows(j.rows()) = j / std::sqrt(spread.factor);
  rows.bottomRightCorner(terms, terms).setIdentity();
  const Eigen::MatrixXd upper = triangularFactor(rows);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(upper, Eigen::ComputeFullV);
  if (!(svd.singularValues()(columns - 1) > 1e-14 * svd.singularValues()(0))) return;  // a free direction, to round-off
  const Eigen::MatrixXd root = svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
  for (int k = 0; k < terms; ++k) result.openShare(k) = root.row(4 + k).norm();
  const Eigen::MatrixXd dy = toWorld * chartOf(state.light) * root.topRows<3>();
  result.uncertainty = uncertaintyOfUnit(toWorld * state.light, dy, root.row(3), spread.noisePx, spread.degreesOfFreedom);
}

}  // namespace
double DepthCorrection::factorAt(const Camera& camera, const Pixel& ideal) const {
  const Pixel x = normalised(camera, ideal);
  return 1 + coefficients.dot(monomials(x.x(), x.y()).value);
}

Outcome<DepthRefinement> refineDepth(const std::vector<BundleView>& given, const Light& start, double sigma,
                                     const BundleOptions& options) {
  require(sigma > 0, "refineDepth: sigma");
  const Outcome<Bundle> bundle = bundleLight(given, start, options);
  if (!bundle) return bundle.failure();
  DepthRefinement result;
  result.light = bundle->light;
  result.limitAngle = bundle->limitAngle;
  result.rmsPx = bundle->rmsPx;

  const Problem problem = problemOf(given, options.pointsPerView);
  // A depth that is off leaves residuals that keep their sign along contours.
  const bool systematic = bundle->rmsPx > refining::kLeastNoisePx && bundle->uncertainty &&
                          bundle->uncertainty->degreesOfFreedom < refining::kSystematic * double(problem.points.size());
  if (!systematic || problem.points.size() < 4 + DepthCorrection::kTerms) return result;

  State state;
  const Eigen::Vector4d& lw = bundle->light.homogeneous();
  state.light << (lw.head<3>() - lw.w() * problem.origin) / problem.scale, lw.w();
  state.light.normalize();
  state.limit = bundle->limitAngle;
  const Terms prior = priors(sigma);
  const int terms = usefulTerms(problem, state, prior, options.robustPx);
  if (terms == 0) return result;
  state = fitted(problem, state, prior, terms, options.robustPx);
  std::vector<double> slopes;
  const std::vector<double> r = residuals(problem, state, &slopes);

  if (state.light.w() < 0) state.light = -state.light;
  Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
  toWorld.topLeftCorner<3, 3>() *= problem.scale;
  toWorld.topRightCorner<3, 1>() = problem.origin;
  const Eigen::Vector4d world = toWorld * state.light;
  if (!world.allFinite() || !state.c.allFinite()) return Failure{Reason::NotFinite, "refined depth"};
  result.light = Light::homogeneous(world);
  result.limitAngle = state.limit;
  result.rmsPx = rms(r);
  result.correction.coefficients = state.c;
  addUncertainty(problem, state, prior, terms, options.robustPx, toWorld, r, slopes, result);
  return result;
}

}  // namespace glint
