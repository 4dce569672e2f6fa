// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "core/base/residual_spread.h"
#include "core/light/contour_evidence.h"
#include "core/light/directed_limit.h"

/// What the parts of the bundle share: one attempt at a light, its residuals and its weights. No other file includes this one.
namespace glint::bundling {

constexpr int kMaxReweightings = 8;

/// In the coordinates of NormalisedContours.
struct Attempt {
  Eigen::Vector4d light = Eigen::Vector4d::Zero();
  double limit = 0, cost = std::numeric_limits<double>::infinity();
  double noiseShare = 0;  ///< with which the weights moved
  int iterations = 0;
  bool converged = false, behind = false;
  bool directed = false;             ///< the limit angle has an extent
  Vector6 extent = Vector6::Zero();  ///< normalised length squared; rad^2 for a light at infinity
  std::vector<double> biasesPx;      ///< of the points, as its rounds left them
  int run = -1;                      ///< see TracedRun::index()
};

/// Incident angle of a point under a light seen with N.L > 0, rad.
double angle(const EvidencePoint& s, const Eigen::Vector4d& light);

/// Signed distance of a point from the level set, px.
double residual(const ContourEvidence& e, const Attempt& a);

/// 1 / |d alpha / d pixel| of every point under a light.
void reweight(std::vector<ContourEvidence>& points, const Eigen::Vector4d& light);
/// Weights and biases for the light of an attempt.
void renew(std::vector<ContourEvidence>& points, const Attempt& a, double share);
/// A bias follows from residuals that contain the previous bias. So an attempt goes on from its own biases, not from those that
/// another attempt left.
void keepBiases(const std::vector<ContourEvidence>& points, Attempt& a);
void restoreBiases(std::vector<ContourEvidence>& points, const Attempt& a);

/// Which share of the residuals' variance is noise of the single points: half the squared difference of neighbours on a contour,
/// since what a model gets wrong varies slowly along it. Noise adds s^2 |d alpha / d pixel|^2 k^2 to every expected square, so
/// with held weights k lights win under which the angle changes slowly over the image; weights that move with the light make that
/// term a constant. What is not noise must not move them, because it would prefer lights under which the angle changes fast;
/// hence the share.
double noiseShare(const std::vector<ContourEvidence>& points, const Attempt& a);

/// What the residuals of an attempt with so many parameters say about the noise. @param scale  of the Huber loss, px
ResidualSpread spreadOf(const std::vector<ContourEvidence>& points, const Attempt& a, int parameters, double scale);

/// Huber's sum of squares, px^2; infinite where a residual is not a number.
double robustCost(const std::vector<ContourEvidence>& points, const Attempt& a, double scale);

/// Makes w >= 0, turns a direction to the side of most points, and sets `behind` where more than a tenth of the points still do
/// not see the light. Every attempt ends with this, whatever it estimated.
void settleSide(const std::vector<ContourEvidence>& points, Attempt& a);

/// Goes on from a solution with one constant limit angle and estimates the extent of the light, too. A light that is far, or that
/// the extent drives beyond infinity, is tried at infinity as well, where the extent is an angle. Returns the start where nothing
/// better is found in front of the surface. The points hold the weights of the result.
Attempt directed(std::vector<ContourEvidence>& points, const Attempt& start, double robustPx, int maxIterations);

/// Reluctance against an extent, 1 / its standard deviation: one for an extent that widens the limit angle by a seventh.
/// Entries that the contours show win over it; those that no view shows stay zero.
double extentPrior(const Attempt& a, const std::vector<ContourEvidence>& points);

/// Residual with an extent, and its derivatives by light (4), limit (1) and extent (6) where asked. False where it is not a
/// number.
bool directedResidual(const ContourEvidence& e, const Eigen::Vector4d& light, double limit, const Vector6& extent,
                      double& residual, Eigen::Matrix<double, 1, 11>* derivatives);

}  // namespace glint::bundling
