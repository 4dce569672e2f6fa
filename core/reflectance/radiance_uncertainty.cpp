// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/cost_function.h>
#include <ceres/sphere_manifold.h>

#include <Eigen/QR>
#include <cmath>

#include "core/base/dense_algebra.h"
#include "core/base/residual_spread.h"
#include "core/reflectance/radiance_problem.h"
#include "core/reflectance/root_cost.h"

namespace glint::lobe {

RadianceFit RadianceProblem::describe(const Attempt& a, std::size_t views) {
  settle(a.state);
  RadianceFit fit;
  fit.lobe = lobe_;
  fit.roughness = a.state.roughness();
  fit.lamp = inWorld(a.state);
  fit.cost = a.cost;
  fit.points = points();
  fit.iterations = a.iterations;
  fit.residualPx.assign(views, 0);
  setUncertainty(a.state, fit);
  return fit;
}

/// Residuals, and what the Jacobian at the solution makes of their spread.
void RadianceProblem::setUncertainty(State state, RadianceFit& fit) const {
  const Eigen::Index own = unknownCount(state.lamp.shape), ratio = hasTwoWidths(lobe_) ? 1 : 0, parameters = 4 + own + ratio;
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> chart;  // ambient from tangent coordinates of L
  ceres::SphereManifold<4>().PlusJacobian(state.lamp.centre.data(), chart.data());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(points(), parameters), parameters);
  std::vector<double> residuals;
  std::vector<int> views;
  std::vector<std::vector<double>> ofViews(fit.residualPx.size());
  double sum = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Evidence& e = points_[i];
    double residual = 0, byRoughness = 0, byRatio = 0;
    Eigen::RowVector4d byLight;
    Eigen::Matrix<double, 1, kMostShapeUnknowns> byShape = Eigen::Matrix<double, 1, kMostShapeUnknowns>::Zero();
    double* slopes[] = {byLight.data(), &byRoughness, own > 0 ? byShape.data() : &byRatio, &byRatio};
    (void)rootCost(state.lamp.shape, *this, e)->Evaluate(Blocks(state, lobe_).at, &residual, slopes);
    jacobian.row(i).head<4>() << byLight * chart, byRoughness;
    jacobian.row(i).segment(4, own) = byShape.head(own);
    if (ratio > 0) jacobian(i, parameters - 1) = byRatio;
    residuals.push_back(residual);
    views.push_back(e.view);
    sum += residual * residual;
    ofViews[std::size_t(e.view)].push_back(residual);
  }
  for (std::size_t v = 0; v < ofViews.size(); ++v) fit.residualPx[v] = rmsWithoutTail(ofViews[v]);
  fit.rmsPx = std::sqrt(sum / double(points_.size()));
  fit.positionCovariance.setZero();
  fit.positionCovariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  std::vector<Eigen::Index> free;  // columns; a known lamp leaves those of the lobe
  for (Eigen::Index k = 0; k < parameters; ++k)
    if (!options_.holdLamp || k == 3 || k >= 4 + own) free.push_back(k);
  const Eigen::Index unknowns = static_cast<Eigen::Index>(free.size());
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(Eigen::MatrixXd(jacobian(Eigen::all, free)));
  const Eigen::MatrixXd r = qr.matrixQR().topRows(unknowns).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeThinU | Eigen::ComputeThinV);
  if (!(svd.singularValues()(unknowns - 1) > 1e-14 * svd.singularValues()(0))) return;  // a free direction, to round-off
  const ResidualSpread spread = residualSpread(residuals, views, static_cast<int>(unknowns), options_.robustPx);
  Eigen::MatrixXd root = Eigen::MatrixXd::Zero(parameters, unknowns);
  root(free, Eigen::all) =
      std::sqrt(spread.factor) * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal().toDenseMatrix();
  if (!state.atInfinity()) {
    const double w = state.lamp.centre.w();
    Eigen::Matrix<double, 3, 4> position;  // d(l / w)
    position << Eigen::Matrix3d::Identity() / w, -state.lamp.centre.head<3>() / (w * w);
    const Eigen::MatrixXd half = scale_ * position * chart * root.topRows<3>();
    const Eigen::Matrix3d covariance = half * half.transpose();
    if (covariance.allFinite()) fit.positionCovariance = covariance;
  }
  // In the world, with |L| = 1 again.
  Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
  toWorld.topLeftCorner<3, 3>() *= scale_;
  toWorld.topRightCorner<3, 1>() = origin_;
  const Eigen::Vector4d y = toWorld * state.lamp.centre;
  const Eigen::MatrixXd dy = toWorld * chart * root.topRows<3>();
  Eigen::MatrixXd others = root.bottomRows(1 + own + ratio);
  const int length = std::visit([](const auto& shape) { return shape.kLength; }, state.lamp.shape);
  others.middleRows(1, own) *= length == 2 ? scale_ * scale_ : scale_;
  if (auto known = uncertaintyOfUnit(y, dy, others, spread.noisePx, spread.degreesOfFreedom)) fit.uncertainty = std::move(known);
}

}  // namespace glint::lobe
