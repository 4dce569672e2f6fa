// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/dense_algebra.h"
#include "core/base/number_text.h"
#include "core/base/solver_trace.h"
#include "core/model/reconstruct_detail.h"

namespace glint {
namespace {

/// Changes of the centre (3) and of the shape S (6, detail::vech, whose length is Frobenius': a rotation of the world changes no
/// length, so the way of the iteration does not depend on the world's axes).
using Step = Eigen::Matrix<double, 9, 1>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 10>;  ///< Jacobian (9) and residual

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Below this share of the largest singular value several ellipsoids explain the contours: the same as ReconstructOptions'
/// minRankRatio, six decades above the round-off of the Jacobian.
constexpr double kRankRatio = 1e-9;
/// The second axis is kept above this share of the longest, squared: a segment has no outline to step from.
constexpr double kSegment = 1e-10;
/// Share of the cost that the linear model may still promise at a minimum: the root of round-off, as the cost is flat to second
/// order there.
constexpr double kStationary = 1e-8;

/// Centre and shape S = V diag(e) V^T with ascending e >= 0: distances are linear in S where an axis vanishes, while a factor of
/// S has no slope there and would creep towards the flat ellipsoid.
struct State {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d vectors = Eigen::Matrix3d::Identity();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();

  Eigen::Matrix3d root() const { return vectors * squares.cwiseSqrt().asDiagonal(); }
  bool flat() const { return squares(0) == 0; }
  /// vech of v v^T for the shortest axis: the direction of thickness.
  Eigen::Matrix<double, 6, 1> thickness() const { return detail::vech(vectors.col(0) * vectors.col(0).transpose()); }

  /// Nearest legal state to this one plus a step.
  State after(const Step& step) const {
    const double r = 1 / std::sqrt(2.0);
    Eigen::Matrix3d s = vectors * squares.asDiagonal() * vectors.transpose();
    s += Eigen::Matrix3d{
        {step(3), r * step(6), r * step(7)}, {r * step(6), step(4), r * step(8)}, {r * step(7), r * step(8), step(5)}};
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(s);
    State next;
    next.centre = centre + step.head<3>();
    next.vectors = eigen.eigenvectors();
    next.squares = eigen.eigenvalues().cwiseMax(0.0);
    // An axis that is round-off counts as zero.
    if (next.squares(0) <= 4 * std::numeric_limits<double>::epsilon() * next.squares(2)) next.squares(0) = 0;
    next.squares(1) = std::max(next.squares(1), kSegment * next.squares(2));
    return next;
  }
};

/// Outline of (c, L) in a projection whose pixels are near the origin; nothing when it is no ellipse.
std::optional<Ellipse> outlineOf(const Eigen::Matrix<double, 3, 4>& p, const Eigen::Vector3d& c, const Eigen::Matrix3d& l) {
  const Outcome<Ellipse> e = [&]() -> Outcome<Ellipse> {
    const Eigen::Vector3d h = p.leftCols<3>() * c + p.col(3);
    const Eigen::Matrix3d g = p.leftCols<3>() * l;
    const double reach = g.row(2).norm();
    if (!(h.z() > reach)) return Failure{Reason::NotAnEllipse, ""};
    const double d = (h.z() - reach) * (h.z() + reach);
    const Pixel origin = h.head<2>() / h.z();
    const Eigen::Matrix<double, 2, 3> spread = g.topRows<2>() - origin * g.row(2);
    const Eigen::Vector2d offset = -(spread * g.row(2).transpose()) / d;
    const Eigen::Matrix2d shape = offset * offset.transpose() + spread * spread.transpose() / d;
    DualConic local;
    local.matrix << -shape, Eigen::Vector2d::Zero(), Eigen::RowVector2d::Zero(), 1.0;
    Outcome<Ellipse> ellipse = toEllipse(local);
    if (ellipse) ellipse->centre = origin + offset;
    return ellipse;
  }();
  if (!e) return std::nullopt;
  return *e;
}

/// One view: the projection whose pixels are measured from its own ellipse's centre, and its contour points.
struct Outline {
  Eigen::Matrix<double, 3, 4> projection;
  std::vector<Pixel> points;
};

/// Signed distances of contour points to the outline, px, and their slopes. By the envelope theorem only the outline's support in
/// the direction of the foot's normal moves the distance: with l = (n, -n.foot) the tangent and pi = P^T l its plane,
/// d(distance) = -d(pi^T Q pi) / (2 e3^T P Q pi), which is linear in dS.
/// @return false where a view has no elliptic outline.
bool addRows(const Outline& view, const State& state, Rows& rows, Eigen::Index at) {
  const Eigen::Matrix3d root = state.root();
  const std::optional<Ellipse> e = outlineOf(view.projection, state.centre, root);
  if (!e) return false;
  for (const Pixel& p : view.points) {
    const EllipseFoot foot = footOnEllipse(*e, p);
    const Eigen::Vector3d tangent(foot.normal.x(), foot.normal.y(), -foot.normal.dot(foot.point));
    const Eigen::Vector4d plane = view.projection.transpose() * tangent;
    const Eigen::Vector3d n = plane.head<3>();
    const double atCentre = n.dot(state.centre) + plane.w();
    // Q pi = ( (c.n + w) c - S n , c.n + w )
    const Eigen::Vector3d q = atCentre * state.centre - root * (root.transpose() * n);
    const double third = view.projection.row(2).head<3>().dot(q) + view.projection(2, 3) * atCentre;
    rows.row(at).head<3>() = -(atCentre / third) * n.transpose();
    rows.row(at).segment<6>(3) = (0.5 / third) * detail::vech(n * n.transpose()).transpose();
    rows(at, 9) = foot.distance;
    ++at;
  }
  return true;
}

/// All residuals about one state; the prior's three rows are U (c - mean) with U^T U the inverse of its covariance.
class Contours {
 public:
  void add(Outline view) {
    count_ += Eigen::Index(view.points.size());
    views_.push_back(std::move(view));
  }
  void setPrior(const Eigen::Matrix3d& whitening, const Eigen::Vector3d& mean) { whitening_ = whitening, mean_ = mean; }

  bool rows(const State& state, Rows& rows) const {
    rows = Rows::Zero(std::max<Eigen::Index>(count_ + 3, 10), 10);
    Eigen::Index at = 0;
    for (const Outline& v : views_) {
      if (!addRows(v, state, rows, at)) return false;
      at += Eigen::Index(v.points.size());
    }
    if (whitening_) {
      rows.block<3, 3>(at, 0) = *whitening_;
      rows.block<3, 1>(at, 9) = *whitening_ * (state.centre - mean_);
    }
    return rows.allFinite();
  }

 private:
  std::vector<Outline> views_;
  std::optional<Eigen::Matrix3d> whitening_;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  Eigen::Index count_ = 0;
};

/// The linear least-squares problem at one state, as the singular values of its triangular factor.
struct Linearised {
  Eigen::JacobiSVD<Eigen::MatrixXd> svd;
  Eigen::Matrix<double, 9, 1> along;  ///< residual along the left singular vectors
  double cost = 0;                    ///< sum of squares, px^2
  int unknowns = 9;

  Linearised(const Rows& rows, const State& state) : cost(rows.col(9).squaredNorm()) {
    Eigen::Matrix<double, 10, 10> r = triangularFactor(rows);
    if (state.flat()) {
      // On the border of the semidefinite cone the thickness may only grow. Where the cost would rise with it, it stays zero, and
      // the step moves within the flat ellipsoids (turning the disc is among them).
      Step direction = Step::Zero();
      direction.tail<6>() = state.thickness();
      const double slope = (r.leftCols<9>() * direction).dot(r.col(9));
      if (slope >= 0) {
        const Eigen::Matrix<double, 10, 1> column = r.leftCols<9>() * direction;
        r.leftCols<9>() -= column * direction.transpose();
        unknowns = 8;
      }
    }
    const Eigen::MatrixXd factor = triangularFactor(r);
    svd.compute(factor.topLeftCorner<9, 9>(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    along = svd.matrixU().transpose() * factor.topRightCorner<9, 1>();
  }
  double largest() const { return svd.singularValues()(0); }
  double smallest() const { return svd.singularValues()(unknowns - 1); }
  /// Damped step: singular values well above the root of the damping take their full part.
  Step step(double damping) const {
    Step y = Step::Zero();
    for (int i = 0; i < unknowns; ++i) {
      const double s = svd.singularValues()(i);
      if (s > 0) y(i) = -s / (s * s + damping * largest() * largest()) * along(i);
    }
    return svd.matrixV() * y;
  }
  /// What the linear model says that the full step gains.
  double gain() const { return along.head(unknowns).squaredNorm(); }
};

/// Covariance at the solution. With H = J^T J + W^T W (contours and prior) the estimate moves by H^-1 (J^T noise + W^T e), e the
/// prior's own unit errors; with [J; W] = Q R that is R^-1 Q^T diag(noise.., 1..), so no product of Jacobians is formed. The
/// thickness of a flat ellipsoid that the contours hold at zero counts as fixed.
std::optional<ParameterUncertainty> uncertaintyOf(const Rows& rows, const State& state, int unknowns, bool prior, double scale) {
  const Eigen::Index data = rows.rows() - 3;  // the prior's rows come last, zero without one
  const double free = double(data) + (prior ? 3 : 0) - unknowns;
  if (data < 10 || !(free > 0)) return std::nullopt;
  Eigen::MatrixXd jacobian = rows.leftCols<9>();
  if (unknowns < 9) {
    Step direction = Step::Zero();
    direction.tail<6>() = state.thickness();
    const Eigen::VectorXd column = jacobian * direction;
    jacobian -= column * direction.transpose();
  }
  ParameterUncertainty u;
  u.degreesOfFreedom = std::max(1.0, free);
  u.noisePx = rows.col(9).head(data).norm() / std::sqrt(u.degreesOfFreedom);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian);
  Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(rows.rows(), 9);
  q.topRows(data) *= u.noisePx;
  const Eigen::Matrix<double, 9, 9> spread = triangularFactor(q);
  const Eigen::Matrix<double, 9, 9> r = qr.matrixQR().topRows<9>().triangularView<Eigen::Upper>();
  Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(kRankRatio);
  u.root = svd.solve(Eigen::Matrix<double, 9, 9>(spread.transpose()));
  u.root.topRows<3>() *= scale;
  u.root.bottomRows<6>() *= scale * scale;
  u.root.bottomRows<3>() /= std::sqrt(2.0);  // vech holds the off-diagonal entries times sqrt(2)
  if (!u.root.allFinite()) return std::nullopt;
  return u;
}

/// The contours and the prior, measured from an origin in units of a scale, each image from its own ellipse's centre.
Outcome<Contours> contoursAbout(const Eigen::Vector3d& origin, double scale, const std::vector<ConicView>& views,
                                const std::optional<CentrePrior>& prior) {
  Contours contours;
  for (const ConicView& v : views) {
    Outline outline{v.projection.matrix, detail::contourOf(v)};
    outline.projection.topRows<2>() -= v.ellipse.centre * outline.projection.row(2);
    outline.projection.col(3) += outline.projection.leftCols<3>() * origin;
    outline.projection.leftCols<3>() *= scale;
    for (Pixel& q : outline.points) q -= v.ellipse.centre;
    contours.add(std::move(outline));
  }
  if (prior) {
    if (!prior->mean.allFinite() || !prior->covariance.allFinite()) return Failure{Reason::NotFinite, "prior"};
    const Eigen::LLT<Eigen::Matrix3d> llt(prior->covariance / (scale * scale));
    require(llt.info() == Eigen::Success, "reconstructRefined: the prior's covariance is not positive definite");
    contours.setPrior(llt.matrixL().solve(Eigen::Matrix3d::Identity()), (prior->mean - origin) / scale);
  }
  return contours;
}

/// The way down to the least cost.
struct Descent {
  const Contours& contours;
  State state;
  Linearised linear;  ///< at the state
  std::vector<double> costs{linear.cost};
  int iterations = 0;
  bool converged = false;

  void take(const State& next, const Rows& rows) {
    state = next;
    linear = Linearised(rows, state);
    costs.push_back(linear.cost);
  }

  /// Levenberg and Marquardt's iteration with the damping relative to the largest singular value. A flat valley (an axis that the
  /// contours hardly see) has a small but certain slope: damping falls by decades, so that the full Gauss-Newton step is taken
  /// there.
  void iterate(int maxIterations) {
    Rows rows;
    double damping = 1e-3;  // of the largest singular value: cautious first; it adapts by decades
    for (; iterations < maxIterations && !converged; ++iterations) {
      constexpr double kEnough = 1e-14;  // the cost cannot be told apart below a hundred units of its round-off
      if (!(linear.cost > 0) || linear.gain() <= kEnough * kEnough * linear.cost) break;
      bool moved = false;
      for (; damping < 1e8; damping *= 10) {
        const Step step = linear.step(damping);
        const State next = state.after(step);
        double cost = kInfinity;
        if (step.allFinite() && contours.rows(next, rows)) cost = rows.col(9).squaredNorm();
        if (!(cost < linear.cost)) continue;
        converged = linear.cost - cost <= kEnough * linear.cost && linear.gain() <= kStationary * linear.cost;
        take(next, rows);
        damping = std::max(damping * 0.03, 1e-16);  // below round-off of the singular values damping does nothing
        moved = true;
        break;
      }
      if (!moved) break;  // no step of any length gains: round-off
    }
    converged = converged || iterations < maxIterations;
  }

  /// The cost tells states apart to the root of its round-off only. The step does better: full steps are taken while they shrink,
  /// which leaves the same answer in every frame of reference.
  void takeLastSteps() {
    Rows rows;
    double last = kInfinity;
    for (int i = 0; i < 40; ++i) {
      const Step step = linear.step(0);
      const double length = step.norm();
      if (!(length < 0.9 * last) || !(length > 1e-15)) break;  // unknowns are of size 1: steps are round-off from here on
      const State next = state.after(step);
      if (!contours.rows(next, rows) || !(rows.col(9).squaredNorm() <= linear.cost * (1 + 1e-11))) break;  // round-off of the sum
      take(next, rows);
      last = length;
    }
  }

  /// Why the state is no answer.
  std::optional<Failure> fault() const {
    if (!(linear.smallest() > kRankRatio * linear.largest()))
      return Failure{Reason::RankDeficient, "several ellipsoids explain the contours equally well"};
    // Where the iteration stops short of a minimum (at the limit, or because a longer shape would reach a camera) and the next
    // step is longer than the ellipsoid, the state is a place on the way: round-off decides where on a long flat valley it lies.
    const Step left = linear.step(0);
    const double size = std::sqrt(state.squares.sum()),
                 steps = std::max(left.head<3>().norm() / size, left.tail<6>().norm() / (size * size));
    if (linear.gain() > kStationary * linear.cost && !(steps <= 1))
      return Failure{
          Reason::NotConverged,
          formatted("the next step would be %.3g times the size of the ellipsoid: the outlines do not determine it", steps)};
    if (state.squares(1) <= 2 * kSegment * state.squares(2))
      return Failure{Reason::NotAnEllipsoid, "the refined shape has two zero axes"};
    return std::nullopt;
  }
};

}  // namespace
Outcome<Reconstruction> reconstructRefined(const std::vector<ConicView>& views, const Ellipsoid& start,
                                           const std::optional<CentrePrior>& prior, int maxIterations) {
  require(maxIterations >= 1, "reconstructRefined: maxIterations");
  if (const std::optional<Failure> failure = detail::check(views)) return *failure;
  const std::size_t need = prior ? 2 : 3;
  if (views.size() < need)
    return Failure{Reason::TooFewViews, "need " + std::to_string(need) + ", have " + std::to_string(views.size())};
  const Eigen::Vector3d origin = start.centre();
  const double scale = start.semiAxes().norm();
  const Outcome<Contours> contours = contoursAbout(origin, scale, views, prior);
  if (!contours) return contours.failure();

  State first;  // axes ascending
  for (int i = 0; i < 3; ++i) {
    first.vectors.col(i) = start.worldFromBody().linear().col(2 - i);
    first.squares(i) = std::pow(start.semiAxes()(2 - i) / scale, 2);
  }
  Rows rows;
  if (!contours->rows(first, rows))
    return Failure{Reason::NotAnEllipsoid, "the start has no elliptic outline in one of the views"};
  const auto inWorld = [&](const State& s) { return (origin + scale * s.centre).homogeneous().eval(); };
  TracedRun run(prior ? "ellipsoid, centre held near the light" : "ellipsoid", inWorld(first));
  Descent descent{*contours, first, Linearised(rows, first)};
  descent.iterate(maxIterations);
  if (descent.converged) descent.takeLastSteps();
  const State& state = descent.state;
  traceRound(descent.costs);
  run.end(descent.converged, descent.converged ? "at a minimum" : "out of iterations", inWorld(state));
  traceAnswer(run.index());
  if (const std::optional<Failure> fault = descent.fault()) return *fault;

  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = state.vectors;
  if (pose.linear().determinant() < 0) pose.linear().col(0) *= -1;
  pose.translation() = origin + scale * state.centre;
  Reconstruction result;
  result.solver = descent.converged ? "refined" : "refined, stopped at the iteration limit";
  result.iterations = descent.iterations;
  result.condition = descent.linear.largest() / descent.linear.smallest();
  result.ellipsoid = Ellipsoid(pose, scale * state.squares.cwiseSqrt());
  result.quadric = result.ellipsoid->dual();
  result.residualPx = detail::residuals(views, result);
  if (contours->rows(state, rows))
    result.uncertainty = uncertaintyOf(rows, state, descent.linear.unknowns, prior.has_value(), scale);
  return result;
}

}  // namespace glint
