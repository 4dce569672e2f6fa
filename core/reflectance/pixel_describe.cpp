// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/dense_algebra.h"
#include "core/base/residual_spread.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/pixel_problem.h"

namespace glint::patch {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Share of the contour's radius, or of the top: a lobe that explains the pixels never leaves so much.
constexpr double kUnexplainedShare = 0.1;
// Share of the radius: right lobes, lamps and surfaces leave less than a tenth of this, but for noise.
constexpr double kPatternShare = 0.01;
constexpr double kInsideShare = 0.1;               // of the top: cells that show the highlight
constexpr double kEdgeLow = 0.3, kEdgeHigh = 0.7;  // of the top: cells at the contour
constexpr double kProbe = 0.3;  // extent whose effect is probed, in lobe widths: beyond the rounding, within the first order

/// The share by which the cost would fall, to first order, if the point became a sphere or a segment: least squares of the
/// residuals over the point's columns and those of the extents.
double gainByExtent(PixelProblem& problem, const State& point, const std::vector<double>& residuals, const Rows& jacobian) {
  const Eigen::Vector3d towards = point.lamp.centre.head<3>().normalized();
  const Eigen::Vector3d u = towards.unitOrthogonal(), v = towards.cross(u);
  const double length = point.lengthOf(kProbe);
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), static_cast<Eigen::Index>(residuals.size()));
  const auto left = [&](const Rows& columns) {
    const Eigen::VectorXd x = Eigen::HouseholderQR<Eigen::MatrixXd>(columns).solve(r);
    return x.allFinite() ? (r - columns * x).squaredNorm() : std::numeric_limits<double>::infinity();
  };
  const double plain = left(jacobian);
  double least = plain;
  // Two moments of a lamp across the direction to it, and the mixed one; a sphere has the first two alike. A tube's intensity
  // goes with the sine of the angle to its axis, however short it is: what its length changes is the difference to a short one.
  PixelProblem segment(problem.evidence(), problem.lobe(), problem.kind());
  State longest = point;
  longest.lamp.shape = SegmentShape<>{length * u, 0};
  segment.chooseRule(longest);
  Rows with(jacobian.rows(), jacobian.cols() + 3);
  with.leftCols(jacobian.cols()) = jacobian;
  std::vector<double> shorter(residuals.size());
  int column = static_cast<int>(jacobian.cols());
  for (const Eigen::Vector3d& axis : {u, v, Eigen::Vector3d((u + v).normalized())}) {
    State grown = longest, plainTube = longest;
    grown.lamp.shape = SegmentShape<>{length * axis, 0};
    plainTube.lamp.shape = SegmentShape<>{1e-3 * length * axis, 0};  // as good as a point
    if (!segment.residualsAt(plainTube, shorter.data())) return 0;
    segment.differences(grown, 1, with.data() + column, static_cast<int>(with.cols()));
    ++column;
  }
  least = std::min(least, left(with));
  return plain > 0 && std::isfinite(least) ? 1 - least / plain : 0;
}

/// The share of the residuals that goes on from cell to cell, along rows, as root of a mean square: noise of single pixels has
/// none.
double patternOf(const std::vector<double>& residuals) {
  double products = 0, squares = 0;
  for (std::size_t i = 1; i < residuals.size(); ++i) {
    products += residuals[i] * residuals[i - 1];
    squares += residuals[i] * residuals[i];
  }
  return squares > 0 ? std::sqrt(std::clamp(products / squares, 0.0, 1.0)) : 0;
}

}  // namespace

void describeResiduals(const PixelProblem& pixels, PixelFit& fit) {
  double squares = 0, count = 0;
  bool unexplained = false;
  for (std::size_t f = 0; f < pixels.evidence().frames.size(); ++f) {
    const FramePatches& frame = pixels.evidence().frames[f];
    const LinearFit& solved = pixels.solutions()[f];
    unexplained = unexplained || !solved.solved;
    std::size_t r = 0;
    for (std::size_t k = 0; k < frame.patches.size(); ++k) {
      const PixelPatch& p = frame.patches[k];
      double inside = 0, insideCount = 0, edge = 0, slope = 0, edgeCount = 0;
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (!p.used[i]) continue;
        const double residual = solved.residual[r++] * std::sqrt(std::max<double>(p.value[i] / frame.top, 0.05));
        if (!solved.solved) continue;
        const std::vector<double>& s = pixels.images()[f].value[k];
        if (s[i] > kInsideShare) {
          inside += residual * residual;
          insideCount += 1;
        }
        const std::size_t column = i % static_cast<std::size_t>(p.columns), row = i / static_cast<std::size_t>(p.columns);
        if (s[i] < kEdgeLow || s[i] > kEdgeHigh || column == 0 || row == 0 || column + 1 == std::size_t(p.columns) ||
            row + 1 == std::size_t(p.rows))
          continue;
        const double c = static_cast<double>(p.columns);
        const double gx = s[i + 1] - s[i - 1], gy = s[i + static_cast<std::size_t>(c)] - s[i - static_cast<std::size_t>(c)];
        slope += solved.coefficients(0) / frame.top * std::hypot(gx, gy) / (2 * p.cellPx);
        edge += residual * residual;
        edgeCount += 1;
      }
      const double nan = std::nan("");
      fit.relativeRms.push_back(insideCount > 0 ? std::sqrt(inside / insideCount) : nan);
      fit.residualPx.push_back(edgeCount > 0 && slope > 0 ? std::sqrt(edge / edgeCount) / (slope / edgeCount) : nan);
      if (std::isfinite(fit.residualPx.back())) {
        squares += fit.residualPx.back() * fit.residualPx.back();
        count += 1;
      }
      fit.poor = fit.poor || !(fit.relativeRms.back() < kUnexplainedShare);
    }
  }
  fit.rmsPx = count > 0 ? std::sqrt(squares / count) : std::nan("");
  fit.poor = fit.poor || unexplained || !(fit.rmsPx <= kUnexplainedShare * pixels.evidence().radiusPx);
}

/// Residuals of neighbouring cells go together along rows and along columns, so that the inflation that residualSpread() sees
/// along rows counts twice.
void describeUncertainty(PixelProblem& pixels, const State& at, FreeUnknowns free, PixelFit& fit) {
  fit.positionCovariance.setZero();
  fit.positionCovariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  std::vector<double> residuals(static_cast<std::size_t>(pixels.residuals()));
  if (!pixels.residualsAt(at, residuals.data())) return;
  const std::vector<Moved> moved = movedStates(at, free);
  const Eigen::Index unknowns = static_cast<Eigen::Index>(moved.size());
  Rows jacobian(pixels.residuals(), unknowns);
  for (Eigen::Index k = 0; k < unknowns; ++k)
    pixels.differences(moved[static_cast<std::size_t>(k)].state, moved[static_cast<std::size_t>(k)].step, jacobian.data() + k,
                       static_cast<int>(unknowns));
  if (at.lamp.isPoint() && !at.atInfinity() && !free.heldLamp) fit.gainByExtent = gainByExtent(pixels, at, residuals, jacobian);
  std::vector<int> views;
  for (std::size_t f = 0; f < pixels.evidence().frames.size(); ++f)
    views.insert(views.end(), pixels.evidence().frames[f].used, static_cast<int>(f));
  const ResidualSpread spread = residualSpread(residuals, views, static_cast<int>(unknowns), 1, Neighbours::Open);
  const double inflation = std::max(1.0, double(residuals.size()) / spread.degreesOfFreedom);
  fit.independentCells = std::max(1.0, spread.degreesOfFreedom / inflation);
  fit.patterned = !(fit.rmsPx * patternOf(residuals) <= kPatternShare * pixels.evidence().radiusPx);
  const Eigen::MatrixXd r = triangularFactor(jacobian);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullV);
  if (!(svd.singularValues()(unknowns - 1) > 1e-12 * svd.singularValues()(0))) return;  // a free direction
  const Eigen::MatrixXd all =
      std::sqrt(spread.factor * inflation) * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
  if (free.heldLamp) {
    Eigen::MatrixXd root = Eigen::MatrixXd::Zero(5, all.cols());
    root.row(4) = all.row(0);
    fit.positionCovariance.setZero();
    fit.uncertainty = ParameterUncertainty{std::move(root), fit.rmsPx, fit.independentCells};
    return;
  }
  const Eigen::Matrix<double, 4, 3> basis = across(at.lamp.centre);
  const Normalised& n = pixels.evidence();
  if (!at.atInfinity()) {
    const double w = at.lamp.centre.w();
    Eigen::Matrix<double, 3, 4> position;  // d(l / w)
    position << Eigen::Matrix3d::Identity() / w, -at.lamp.centre.head<3>() / (w * w);
    const Eigen::MatrixXd half = n.scale * position * basis * all.topRows<3>();
    const Eigen::Matrix3d covariance = half * half.transpose();
    if (covariance.allFinite()) fit.positionCovariance = covariance;
  }
  // In the world, with |L| = 1 again.
  Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
  toWorld.topLeftCorner<3, 3>() *= n.scale;
  toWorld.topRightCorner<3, 1>() = n.origin;
  const Eigen::Vector4d y = toWorld * at.lamp.centre;
  const Eigen::MatrixXd dy = toWorld * basis * all.topRows<3>();
  if (auto known = uncertaintyOfUnit(y, dy, all.row(3), fit.rmsPx, fit.independentCells)) fit.uncertainty = std::move(known);
}

}  // namespace glint::patch
