// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/reconstruct_boxes.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/SVD>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <numbers>

#include "core/base/dense_algebra.h"
#include "core/base/number_text.h"
#include "core/base/uncertainty.h"
#include "core/light/dense_solver.h"
#include "core/model/reconstruct_detail.h"

namespace glint {
namespace {

constexpr int kUnknowns = 9;          // centre, rotation, three lengths
constexpr double kBorderPx = 2;       // detectors end the box of a cut object at the border, up to rounding
constexpr int kStarts = 16;           // rotations; with 8 each object of the published data is found too
constexpr int kMostIterations = 100;  // a start that needs more is not the best one
constexpr double kTolerance = 1e-14;  // relative, of cost and unknowns: round-off of 32 sides
constexpr double kSidesRank = 1e-9;  // last over first singular value of the slopes: the same as ReconstructOptions' minRankRatio
constexpr double kFlattest = 1e-6;   // of the longest length: thinner is a disc to any box
constexpr double kStandsOut = 0.05;  // chance that one of all sides stands out without cause (Bonferroni)
constexpr double kLeastStandsOutPx = 1;    // below this no box is drawn
constexpr double kLeastVariance = 1e-300;  // px^2, so that exact sides divide by no zero
constexpr double kTellsApart = 0.95;       // confidence of the F test
constexpr double kCentreUnknown = 0.5;     // of the shortest semi-axis: two standard deviations then leave the object

/// A side: its plane in the normalised world, with the normal away from the object, and the row of depth of its camera.
struct Side {
  Eigen::Vector4d plane, depth;
  int view = 0, which = 0;
};

template <class T>
T supportOf(BoxSolid solid, const T* n, const T* a, T* gradient) {
  if (solid == BoxSolid::Cuboid) {
    T sum(0);
    for (int i = 0; i < 3; ++i) {
      gradient[i] = n[i] < T(0) ? -a[i] : a[i];
      sum += gradient[i] * n[i];
    }
    return sum;
  }
  T sum(0);
  for (int i = 0; i < 3; ++i) sum += a[i] * a[i] * n[i] * n[i];
  using std::sqrt;
  const T length = sqrt(sum);
  for (int i = 0; i < 3; ++i) gradient[i] = a[i] * a[i] * n[i] / length;
  return length;
}

/// Gap between a side and the solid, px: the distance of the plane over the depth of the point that it should touch, which is the
/// slope of that distance along the image.
struct SideGap {
  const Side* side;
  BoxSolid solid;

  /// @param c  centre. @param w  rotation vector, world from body. @param s  logarithms of the three lengths
  template <class T>
  bool operator()(const T* c, const T* w, const T* s, T* gap) const {
    using std::exp;
    const T n[3] = {T(side->plane[0]), T(side->plane[1]), T(side->plane[2])}, back[3] = {-w[0], -w[1], -w[2]};
    T body[3], touch[3], world[3];
    ceres::AngleAxisRotatePoint(back, n, body);
    const T a[3] = {exp(s[0]), exp(s[1]), exp(s[2])};
    const T support = supportOf(solid, body, a, touch);
    ceres::AngleAxisRotatePoint(w, touch, world);
    T away = T(side->plane[3]), depth = T(side->depth[3]);
    for (int i = 0; i < 3; ++i) {
      away += n[i] * c[i];
      depth += side->depth[i] * (c[i] + world[i]);
    }
    if (!(depth > T(0))) return false;
    gap[0] = (away + support) / depth;
    return true;
  }
};

/// Centre, rotation vector and logarithms of the lengths, in the normalised world.
struct SolidState {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), rotation = Eigen::Vector3d::Zero(), logs = Eigen::Vector3d::Zero();
  double cost = 0;
  bool converged = false;
};

std::optional<Failure> checkBoxes(const std::vector<BoxView>& views) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BoxView& v = views[i];
    if (!v.visible) continue;
    if (!v.projection.matrix.allFinite() || !v.low.allFinite() || !v.high.allFinite())
      return Failure{Reason::NotFinite, "view " + std::to_string(i)};
    if (!((v.high - v.low).minCoeff() > 0))
      return Failure{Reason::NotAnEllipse, "view " + std::to_string(i) + ": a box without area"};
  }
  return std::nullopt;
}

/// left, top, right, bottom
double sideAt(const BoxView& v, int which) { return which < 2 ? v.low[which] : v.high[which - 2]; }

/// The image's border is at -0.5 and size - 0.5; a side beyond it belongs to a box that was not cut (some detectors complete
/// objects).
bool atBorder(const BoxView& v, int which) {
  const int size = v.imageSize[which % 2];
  return size > 0 && std::abs(sideAt(v, which) - (which < 2 ? -0.5 : size - 0.5)) < kBorderPx;
}

/// A real camera's projection whose row of depth measures world units, positive in front: its left block is then right-handed.
Eigen::Matrix<double, 3, 4> withDepth(const Projection& p) {
  return p.matrix / std::copysign(p.matrix.row(2).head<3>().norm(), p.matrix.leftCols<3>().determinant());
}

/// Rotations spread over all directions: the same for every input, seen from the first camera, so that the world's axes do not
/// matter.
Eigen::Matrix3d startRotation(int i) {
  // Quasi-random quaternions: Shoemake's map of three additive recurrences (their steps are powers of 1 / 1.2207, Roberts' R3).
  const auto part = [&](double step) { return std::fmod(0.5 + i * step, 1.0); };
  const double u = part(0.8191725), v = 2 * std::numbers::pi * part(0.6710436), w = 2 * std::numbers::pi * part(0.5497005);
  return Eigen::Quaterniond(std::sqrt(u) * std::cos(w), std::sqrt(1 - u) * std::sin(v), std::sqrt(1 - u) * std::cos(v),
                            std::sqrt(u) * std::sin(w))
      .normalized()
      .toRotationMatrix();
}

class BoxProblem {
 public:
  BoxProblem(std::vector<Side> sides, const Eigen::Matrix3d& worldFromFirst) : sides_(std::move(sides)), first_(worldFromFirst) {}

  /// The least cost over all starts; nothing when none converged.
  std::optional<SolidState> solve(BoxSolid solid) const {
    std::optional<SolidState> best;
    for (int i = 0; i < kStarts; ++i) {
      SolidState s;
      const Eigen::AngleAxisd turn(first_ * startRotation(i));
      s.rotation = turn.angle() * turn.axis();
      // The lengths differ, or turning would change nothing at first; those of a cuboid are somewhat shorter.
      s.logs = Eigen::Vector3d(0.3, 0, -0.3).array() - (solid == BoxSolid::Cuboid ? 0.4 : 0.0);
      ceres::Problem problem;
      for (const Side& side : sides_)
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SideGap, 1, 3, 3, 3>(new SideGap{&side, solid}), nullptr,
                                 s.centre.data(), s.rotation.data(), s.logs.data());
      const DenseSolution d = solveDense(problem, kMostIterations, kTolerance);
      const bool good = d.usable && std::isfinite(d.cost) && s.centre.allFinite() && s.logs.allFinite();
      if (!good || (best && d.cost >= best->cost)) continue;
      s.cost = d.cost;
      s.converged = d.converged;
      best = s;
    }
    return best;
  }

  /// Gaps in px, and their slopes: by the centre and by the shape (of an ellipsoid, whose rotation means nothing where axes
  /// agree) or the rotation and logarithms (of a cuboid).
  std::pair<Eigen::VectorXd, Eigen::MatrixXd> rows(BoxSolid solid, const SolidState& s) const {
    const Eigen::Index n = Eigen::Index(sides_.size());
    Eigen::VectorXd gaps = Eigen::VectorXd::Zero(n);
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(n, kUnknowns);
    const Eigen::Matrix3d worldFromBody = rotationOf(s);
    for (Eigen::Index i = 0; i < n; ++i) {
      const ceres::AutoDiffCostFunction<SideGap, 1, 3, 3, 3> gap(new SideGap{&sides_[std::size_t(i)], solid});
      const double* at[3] = {s.centre.data(), s.rotation.data(), s.logs.data()};
      Eigen::RowVector3d parts[3];
      double* out[3] = {parts[0].data(), parts[1].data(), parts[2].data()};
      if (!gap.Evaluate(at, &gaps[i], out)) continue;
      slopes.row(i).head<3>() = parts[0];
      slopes.row(i).segment<3>(3) = parts[1];
      slopes.row(i).tail<3>() = parts[2];
      if (solid == BoxSolid::Cuboid) continue;
      const Eigen::Vector3d normal = sides_[std::size_t(i)].plane.head<3>(), body = worldFromBody.transpose() * normal;
      const Eigen::Vector3d a = s.logs.array().exp();
      const double support = a.cwiseProduct(body).norm();
      const Eigen::Vector3d touch = s.centre + worldFromBody * a.cwiseAbs2().cwiseProduct(body) / support;
      const double depth = sides_[std::size_t(i)].depth.dot(touch.homogeneous());
      slopes.row(i).tail<6>() = detail::vech(normal * normal.transpose()).transpose() / (2 * support * depth);
    }
    return {gaps, slopes};
  }

  static Eigen::Matrix3d rotationOf(const SolidState& s) {
    const double angle = s.rotation.norm();
    if (!(angle > 0)) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, s.rotation / angle).toRotationMatrix();
  }

  const std::vector<Side>& sides() const { return sides_; }

 private:
  std::vector<Side> sides_;
  Eigen::Matrix3d first_;
};

Outcome<SolidFit> fitSolid(const BoxProblem& problem, BoxSolid solid, const Eigen::Vector3d& origin, double scale,
                           std::size_t views) {
  const std::optional<SolidState> s = problem.solve(solid);
  if (!s) return Failure{Reason::NotConverged, std::string("no ") + nameOf(solid) + " in front of the cameras touches the boxes"};
  const auto [gaps, slopes] = problem.rows(solid, *s);
  if (!gaps.allFinite() || !slopes.allFinite()) return Failure{Reason::NotFinite, nameOf(solid)};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(slopes, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd singular = svd.singularValues();
  if (!(singular(kUnknowns - 1) > kSidesRank * singular(0)))
    return Failure{Reason::RankDeficient, std::string("several ") + nameOf(solid) +
                                              "s touch the boxes: the views repeat each other or share their centre"};
  const Eigen::Vector3d lengths = s->logs.array().exp();
  if (!(lengths.minCoeff() > kFlattest * lengths.maxCoeff())) return Failure{Reason::NotAnEllipsoid, "flat"};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d axes = BoxProblem::rotationOf(*s);
  // In descending order, as an ellipsoid has them.
  int order[3] = {0, 1, 2};
  std::sort(order, order + 3, [&](int i, int j) { return lengths[i] > lengths[j]; });
  SolidFit fit{solid, Ellipsoid(pose, {1, 1, 1}), {}, 0, 0, s->converged, {}, {}, {}};
  for (int i = 0; i < 3; ++i) {
    pose.linear().col(i) = axes.col(order[i]);
    fit.halfEdges[i] = scale * lengths[order[i]];
  }
  if (pose.linear().determinant() < 0) pose.linear().col(2) *= -1;
  pose.translation() = origin + scale * s->centre;
  fit.ellipsoid = Ellipsoid(pose, solid == BoxSolid::Cuboid ? ellipsoidOfCuboid(fit.halfEdges) : fit.halfEdges);
  fit.rmsPx = gaps.norm() / std::sqrt(double(gaps.size()));
  fit.condition = singular(0) / singular(kUnknowns - 1);
  fit.residualPx.assign(views, Eigen::Vector4d::Zero());
  for (Eigen::Index i = 0; i < gaps.size(); ++i) {
    const Side& side = problem.sides()[std::size_t(i)];
    // The gap is positive where the solid reaches beyond the side: to the left of a left side.
    fit.residualPx[std::size_t(side.view)][side.which] = side.which < 2 ? gaps[i] : -gaps[i];
  }
  for (Eigen::Index i = 0; i < gaps.size(); ++i) fit.leverage.push_back(svd.matrixU().row(i).squaredNorm());
  if (gaps.size() > kUnknowns) {
    const double variance = gaps.squaredNorm() / double(gaps.size() - kUnknowns);
    const Eigen::MatrixXd root = svd.matrixV().topRows<3>() * singular.cwiseInverse().asDiagonal();
    fit.centreCovariance = scale * scale * variance * root * root.transpose();
  }
  return fit;
}

/// The side that the others contradict most, if by more than chance: residuals divided by their standard deviation, which the
/// other sides tell. @see Cook and Weisberg, Residuals and Influence in Regression, 1982, sec. 2.2 (externally studentised).
std::optional<std::string> outlierOf(const SolidFit& fit, const std::vector<Side>& sides) {
  static const char* const kSideNames[4] = {"left", "top", "right", "bottom"};
  const double free = double(sides.size()) - kUnknowns - 1;
  if (free < 1) return std::nullopt;
  double squares = 0;
  for (const Side& s : sides) squares += std::pow(fit.residualPx[std::size_t(s.view)][s.which], 2);
  const Side* worst = nullptr;
  double most = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const double residual = fit.residualPx[std::size_t(sides[i].view)][sides[i].which], rest = 1 - fit.leverage[i];
    if (!(rest > kFlattest)) continue;  // no other side tells what this one tells
    const double variance = (squares - residual * residual / rest) / free;
    const double studentised = std::abs(residual) / std::sqrt(std::max(variance, kLeastVariance) * rest);
    if (std::abs(residual) > kLeastStandsOutPx && studentised > most) {
      most = studentised;
      worst = &sides[i];
    }
  }
  if (!worst || !(most > studentFactor(1 - kStandsOut / double(sides.size()), free))) return std::nullopt;
  return formatted("the %s side of view %d is off by %.1f px and stands out: is the object occluded there?",
                   kSideNames[worst->which], worst->view, std::abs(fit.residualPx[std::size_t(worst->view)][worst->which]));
}

std::vector<std::string> remarksOn(const BoxReconstruction& r, const std::vector<Side>& sides) {
  std::vector<std::string> remarks;
  const int free = r.sides - kUnknowns;
  if (!r.best.converged) remarks.push_back("the iteration stopped at its limit: a better solid may exist");
  if (free < 1) {
    remarks.push_back("nine sides determine a solid exactly: no residual says whether it is right");
    return remarks;
  }
  if (r.other) {
    const double limit = boost::math::quantile(boost::math::fisher_f(free, free), kTellsApart);
    if (!(r.other->rmsPx * r.other->rmsPx > limit * r.best.rmsPx * r.best.rmsPx))
      remarks.push_back(formatted("the boxes hardly tell the %s (%.2f px) from a %s (%.2f px)", nameOf(r.best.solid),
                                  r.best.rmsPx, nameOf(r.other->solid), r.other->rmsPx));
  }
  if (const std::optional<std::string> remark = outlierOf(r.best, sides)) remarks.push_back(*remark);
  const double sigma = std::sqrt(Eigen::JacobiSVD<Eigen::Matrix3d>(*r.best.centreCovariance).singularValues()(0));
  if (!(sigma < kCentreUnknown * r.best.ellipsoid.semiAxes().z()))
    remarks.push_back(
        formatted("the centre is known to %.3g only, the shortest semi-axis is %.3g", sigma, r.best.ellipsoid.semiAxes().z()));
  return remarks;
}

/// Sides in the world x = origin + scale * normalised. Planes are scaled with their projections, so that a gap over a depth is
/// px.
std::vector<Side> boxSidesOf(const std::vector<BoxView>& views, const Eigen::Vector3d& origin, double scale) {
  std::vector<Side> sides;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BoxView& v = views[i];
    if (!v.visible) continue;
    Eigen::Matrix<double, 3, 4> p = withDepth(v.projection);
    p.col(3) += p.leftCols<3>() * origin;
    p.leftCols<3>() *= scale;
    for (int which = 0; which < 4; ++which) {
      if (atBorder(v, which)) continue;
      // x - side < 0 to the left of it: away from the object for the low sides, so those flip.
      const Eigen::RowVector4d plane = p.row(which % 2) - sideAt(v, which) * p.row(2);
      sides.push_back({which < 2 ? Eigen::Vector4d(-plane.transpose()) : Eigen::Vector4d(plane.transpose()), p.row(2).transpose(),
                       int(i), which});
    }
  }
  return sides;
}

}  // namespace

const char* nameOf(BoxSolid solid) { return solid == BoxSolid::Cuboid ? "cuboid" : "ellipsoid"; }

Eigen::Vector3d ellipsoidOfCuboid(const Eigen::Vector3d& halfEdges) {
  require(halfEdges.allFinite() && halfEdges.minCoeff() >= 0, "ellipsoidOfCuboid: half edges");
  Eigen::Vector3d m;
  for (int i = 0; i < 3; ++i)
    m[i] = std::sqrt(halfEdges[i] * (halfEdges[i] + 2 * std::numbers::inv_pi * (halfEdges.sum() - halfEdges[i])));
  return m;
}

Outcome<BoxReconstruction> reconstructFromBoxes(const std::vector<BoxView>& views) {
  if (const std::optional<Failure> failure = checkBoxes(views)) return *failure;
  std::vector<ConicView> inscribed;  // for the place and the unit of length only
  std::size_t first = views.size();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BoxView& v = views[i];
    if (!v.visible || (atBorder(v, 0) && atBorder(v, 1) && atBorder(v, 2) && atBorder(v, 3))) continue;
    first = std::min(first, i);
    const Eigen::Vector2d half = (v.high - v.low) / 2;
    inscribed.push_back(
        {v.projection,
         {(v.low + v.high) / 2, {half.maxCoeff(), half.minCoeff()}, half.y() > half.x() ? std::numbers::pi / 2 : 0.0},
         {}});
  }
  if (inscribed.size() < 3) return Failure{Reason::TooFewViews, "need 3, have " + std::to_string(inscribed.size())};
  const std::optional<Eigen::Vector3d> origin = detail::axisPoint(inscribed);
  if (!origin) return Failure{Reason::RankDeficient, "the rays through the boxes are parallel or meet in one camera centre"};
  const double scale = detail::normalise(inscribed, *origin).scale;
  if (!std::isfinite(scale) || !(scale > 0)) return Failure{Reason::NotFinite, "the size of the boxes"};
  const BoxProblem problem(boxSidesOf(views, *origin, scale), [&] {
    const Eigen::Matrix3d left = views[first].projection.matrix.leftCols<3>();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(left.inverse(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d r = svd.matrixU() * svd.matrixV().transpose();
    if (r.determinant() < 0) r = -r;
    return r.allFinite() ? r : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  }());
  if (int(problem.sides().size()) < kUnknowns)
    return Failure{Reason::TooFewPoints, formatted("need 9 sides of boxes, have %d", int(problem.sides().size()))};
  for (const Side& s : problem.sides())
    if (!(s.depth.w() > 0)) return Failure{Reason::BehindCamera, formatted("view %d", s.view)};

  Outcome<SolidFit> ellipsoid = fitSolid(problem, BoxSolid::Ellipsoid, *origin, scale, views.size());
  Outcome<SolidFit> cuboid = fitSolid(problem, BoxSolid::Cuboid, *origin, scale, views.size());
  if (!ellipsoid && !cuboid) return ellipsoid.failure();
  BoxReconstruction r{ellipsoid ? *ellipsoid : *cuboid, {}, int(problem.sides().size()), {}};
  if (ellipsoid && cuboid) {
    r.other = *cuboid;
    if (cuboid->rmsPx < ellipsoid->rmsPx) std::swap(r.best, *r.other);
  }
  r.remarks = remarksOn(r, problem.sides());
  return r;
}

}  // namespace glint
