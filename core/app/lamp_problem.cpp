// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/lamp_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/plane.h"

namespace glint {
namespace {

constexpr double kDifference =
    1e-6;                          // of a radian, of the scale's inverse, of a radius: central differences then have ten digits
constexpr int kMostSteps = 60;     // five are usual; a lamp that touches a ball takes more
constexpr int kMostHalvings = 30;  // a step of 1e-9 that does not help is the end
constexpr double kSettledStep = 1e-11;  // rad and shares of a sigma: below the differences' own error
constexpr double kLeastPivot = 1e-6;    // of the direction's: a distance that moves no peak by a millionth as much as a turn does

}  // namespace

LampProblem::LampProblem(BallProjection view, std::vector<BallParameters> balls, double scale)
    : view_(std::move(view)), balls_(std::move(balls)), scale_(scale) {
  for (const BallParameters& b : balls_) roots_.push_back(b.covariance.llt().matrixL());
  z_ = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(balls_.size()));
}

Eigen::Vector3d LampProblem::parametersOf(std::size_t ball) const { return balls_[ball].value + shiftOf(ball); }

void LampProblem::move(LampUnknowns& lamp, const Eigen::VectorXd& by, double scale) {
  AimedLamp& aimed = lamp.lamp;
  aimed.direction = (aimed.direction + tangentBasis(aimed.direction) * by.head<2>()).normalized();
  if (by.size() > 2) aimed.inverseDistance += by(2) / scale;
}

std::optional<Eigen::VectorXd> LampProblem::residuals(const LampUnknowns& lamp) const {
  Eigen::VectorXd r(2 * static_cast<Eigen::Index>(lamp.peaks.size()));
  for (std::size_t i = 0; i < lamp.peaks.size(); ++i) {
    const WeightedPeak& p = lamp.peaks[i];
    const std::optional<Pixel> predicted = mirrorPixel(view_, ball(p.ball), lamp.lamp);
    if (!predicted) return std::nullopt;
    r.segment<2>(2 * static_cast<Eigen::Index>(i)) = p.root * (p.peak - *predicted);
  }
  return r;
}

std::optional<LampProblem::Eliminated> LampProblem::eliminated(const LampUnknowns& lamp) const {
  const std::optional<Eigen::VectorXd> here = residuals(lamp);
  if (!here) return std::nullopt;
  const Eigen::Index rows = here->size(), own = lamp.count(), outlines = z_.size();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, own + outlines);
  for (Eigen::Index k = 0; k < own; ++k) {
    LampUnknowns more = lamp, less = lamp;
    const Eigen::VectorXd by = kDifference * Eigen::VectorXd::Unit(own, k);
    move(more, by, scale_);
    move(less, -by, scale_);
    const std::optional<Eigen::VectorXd> a = residuals(more), b = residuals(less);
    if (!a || !b) return std::nullopt;
    jacobian.col(k) = -(*a - *b) / (2 * kDifference);
  }
  for (std::size_t i = 0; i < lamp.peaks.size(); ++i) {
    const WeightedPeak& p = lamp.peaks[i];
    const Eigen::Vector3d at = parametersOf(p.ball);
    const double step = kDifference * at.z();
    Eigen::Matrix<double, 2, 3> slope;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d by = step * Eigen::Vector3d::Unit(k);
      const std::optional<Pixel> a = mirrorPixel(view_, ballOf(view_, at + by), lamp.lamp),
                                 b = mirrorPixel(view_, ballOf(view_, at - by), lamp.lamp);
      if (!a || !b) return std::nullopt;
      slope.col(k) = (*a - *b) / (2 * step);
    }
    jacobian.block<2, 3>(2 * static_cast<Eigen::Index>(i), own + 3 * static_cast<Eigen::Index>(p.ball)) =
        p.root * slope * roots_[p.ball];
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(jacobian.leftCols(own));
  Eigen::MatrixXd turned(rows, outlines + 1);
  turned << jacobian.rightCols(outlines), *here;
  turned.applyOnTheLeft(qr.householderQ().adjoint());
  Eliminated e;
  e.own = qr.matrixQR().topRows(own).triangularView<Eigen::Upper>();
  e.outlinesOwn = turned.topLeftCorner(own, outlines);
  e.right = turned.col(outlines).head(own);
  e.outlinesRest = turned.bottomLeftCorner(rows - own, outlines);
  e.rest = turned.col(outlines).tail(rows - own);
  e.redundant = (qr.householderQ() * Eigen::MatrixXd::Identity(rows, rows)).rightCols(rows - own);
  return e;
}

bool LampProblem::standApart(const LampUnknowns& lamp) const {
  for (const WeightedPeak& a : lamp.peaks)
    for (const WeightedPeak& b : lamp.peaks) {
      const MirrorBall one = ball(a.ball), other = ball(b.ball);
      if ((one.centre - other.centre).norm() > std::max(one.radius, other.radius)) return true;
    }
  return false;
}

bool LampProblem::tellsDistance(const LampUnknowns& lamp) const {
  if (!standApart(lamp)) return false;
  LampUnknowns free = lamp;
  free.distanceFree = true;
  if (2 * free.peaks.size() < static_cast<std::size_t>(free.count())) return false;
  const std::optional<Eliminated> e = eliminated(free);
  return e && std::abs(e->own(2, 2)) > kLeastPivot * std::abs(e->own(0, 0));
}

LampProblem::OutlineSystem LampProblem::outlineSystem(const std::vector<Eliminated>& lamps,
                                                      std::optional<std::size_t> without) const {
  // The unit prior keeps every eigenvalue at 1 or above: normal equations are safe here.
  Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(z_.size(), z_.size());
  Eigen::VectorXd right = -z_;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    if (without == i) continue;
    normal += lamps[i].outlinesRest.transpose() * lamps[i].outlinesRest;
    right += lamps[i].outlinesRest.transpose() * lamps[i].rest;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(normal);
  return {factor.solve(Eigen::MatrixXd::Identity(z_.size(), z_.size())), factor.solve(right)};
}

double LampProblem::costOf(const std::vector<LampUnknowns>& lamps) const {
  double cost = z_.squaredNorm();
  for (const LampUnknowns& lamp : lamps) {
    const std::optional<Eigen::VectorXd> r = residuals(lamp);
    if (!r) return std::numeric_limits<double>::infinity();
    cost += r->squaredNorm();
  }
  return cost;
}

bool LampProblem::solve(std::vector<LampUnknowns>& lamps, bool outlinesToo) {
  double cost = costOf(lamps);
  for (int i = 0; i < kMostSteps && std::isfinite(cost); ++i) {
    std::vector<Eliminated> equations;
    for (const LampUnknowns& lamp : lamps) {
      std::optional<Eliminated> e = eliminated(lamp);
      if (!e) return false;
      equations.push_back(*std::move(e));
    }
    const Eigen::VectorXd outlineStep =
        outlinesToo ? outlineSystem(equations).step : Eigen::VectorXd(Eigen::VectorXd::Zero(z_.size()));
    std::vector<Eigen::VectorXd> steps;
    double size = outlineStep.norm();
    for (const Eliminated& e : equations) {
      steps.emplace_back(e.own.triangularView<Eigen::Upper>().solve(e.right - e.outlinesOwn * outlineStep));
      size = std::max(size, steps.back().norm());
    }
    if (!std::isfinite(size)) return false;
    const std::vector<LampUnknowns> lampsBefore = lamps;
    const Eigen::VectorXd outlinesBefore = z_;
    double factor = 1, next = 0;
    for (int h = 0; h < kMostHalvings; ++h, factor /= 2) {
      lamps = lampsBefore;
      z_ = outlinesBefore + factor * outlineStep;
      for (std::size_t k = 0; k < lamps.size(); ++k) move(lamps[k], factor * steps[k], scale_);
      next = costOf(lamps);
      if (next <= cost) break;
    }
    if (!(next <= cost)) {  // no better: the least to round-off
      lamps = lampsBefore;
      z_ = outlinesBefore;
      return size < std::sqrt(kSettledStep);
    }
    cost = next;
    if (factor * size < kSettledStep) return true;
  }
  return false;
}

}  // namespace glint
