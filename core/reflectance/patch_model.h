// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "core/reflectance/pixel_fit.h"

/// The lobe's image on the cells of patches, and the linear part of its fit; internal to core/reflectance.
namespace glint::patch {

/// The unknowns of a lobe and its lamp, in normalised coordinates (x - origin) / scale.
struct State : lobe::State {
  double blurVariance = 0;  ///< px^2

  bool operator==(const State&) const = default;
};

/// The patches of one frame with positions in normalised coordinates.
struct FramePatches {
  std::vector<PixelPatch> patches;
  double top = 0;  ///< largest used value of all
  std::size_t used = 0;
};

struct Normalised {
  std::vector<FramePatches> frames;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 1;
  std::size_t cells = 0;  ///< used, of all frames
  double radiusPx = 0;    ///< of the contours, mean
};
Normalised normalised(const std::vector<const PixelPatch*>& patches);

/// Two by two cells become one: four times fewer, for the search.
PixelPatch coarsened(const PixelPatch& patch);

/// S = exp(log I - logTop) over all cells of a frame's patches; logTop is the largest log I of the frame's cells.
struct LobeImage {
  std::vector<std::vector<double>> value;  ///< per patch and cell
  double logTop = 0;
  std::size_t topPatch = 0, topCell = 0;  ///< where it is
  bool lit = false;                       ///< some used cell is
};
/// Without blur: does not depend on the state's.
LobeImage sharpImage(Lobe lobe, const FramePatches& frame, const State& at, const lobe::LampRule& rule);
/// Blurred by the state's blur and the square of a pixel.
LobeImage blurredImage(LobeImage sharp, const FramePatches& frame, const State& at);

/// Variance of the square that a pixel averages over, px^2. A blur of minus this makes pixels of samples at their centres.
inline constexpr double kPixelVariance = 1.0 / 12;

/// Weights of iteratively reweighted least squares, per used cell of a frame; ones to begin with.
using Weights = std::vector<double>;

/// What the background's coefficients multiply at the used cells of a frame: all that the linear part takes from a state besides
/// the lobe.
struct BackgroundBasis {
  int each = 0;                ///< coefficients of a patch
  std::vector<double> terms;   ///< per used cell, `each` of them
  std::vector<double> spread;  ///< per used cell: I_max sqrt(max(I / I_max, darkest)), the residual's unit
};
BackgroundBasis backgroundBasis(const FramePatches& frame, BackgroundKind kind, const State& at);
/// Whether the basis changes with the lamp.
bool dependsOnLight(BackgroundKind kind);

/// Strength and background coefficients of a frame for fixed weights, and the weighted residuals of all used cells.
struct LinearFit {
  Eigen::VectorXd coefficients;  ///< strength, then each patch's background
  std::vector<double> residual;  ///< w (I - K S - b) / I_max, without the robust weight
  bool solved = false;
};
LinearFit linearFit(const FramePatches& frame, const LobeImage& image, const BackgroundBasis& basis, const Weights& weights);

/// Reweights until the coefficients settle. `weights` are the start, and hold the result afterwards.
LinearFit robustFit(const FramePatches& frame, const LobeImage& image, const BackgroundBasis& basis, Weights& weights);

/// rho(r) = 2 a^2 (sqrt(1 + r^2 / a^2) - 1), a = kRobust.
double robustSquare(double residual);
double robustWeight(double residual);

int coefficientsOf(BackgroundKind kind);
/// The background of one patch at all cells on the surface; `coefficients` are that patch's.
std::vector<double> backgroundOf(const PixelPatch& patch, const FramePatches& frame, BackgroundKind kind, const State& at,
                                 const Eigen::VectorXd& coefficients);

}  // namespace glint::patch
