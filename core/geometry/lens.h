// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>

#include "core/base/outcome.h"

namespace glint {

/// How a lens bends rays, by COLMAP's names; the parameters have COLMAP's order after cx cy. A point of the camera's frame at
/// (x, y, 1) is measured at (u, v), both without K; r^2 = x^2 + y^2, theta = atan(r). Without parameters (all 0) the fisheye
/// models measure theta (x, y) / r, the others (x, y).
enum class LensModel {
  OpenCv,               ///< k1 k2 p1 p2 k3: Brown-Conrady (Brown, Close-range camera calibration, 1971)
  FullOpenCv,           ///< k1 k2 p1 p2 k3 k4 k5 k6: OpenCV's rational model
  SimpleRadial,         ///< k
  Radial,               ///< k1 k2
  OpenCvFisheye,        ///< k1 k2 k3 k4: theta (1 + k1 theta^2 + ... + k4 theta^8) (Kannala, Brandt, PAMI 2006)
  SimpleRadialFisheye,  ///< k: the same with one term
  RadialFisheye,        ///< k1 k2
  Fov,               ///< omega: atan(2 r tan(omega / 2)) / omega (Devernay, Faugeras, Straight lines have to be straight, 2001)
  ThinPrismFisheye,  ///< k1 k2 p1 p2 k3 k4 sx1 sy1, on fisheye coordinates theta (x, y) / r
  VisualSfm,         ///< r: the term of NVM, which undistorts: x = u (1 + r (u^2 + v^2))
};

inline constexpr std::array<LensModel, 10> kLensModels{LensModel::OpenCv,           LensModel::FullOpenCv,
                                                       LensModel::SimpleRadial,     LensModel::Radial,
                                                       LensModel::OpenCvFisheye,    LensModel::SimpleRadialFisheye,
                                                       LensModel::RadialFisheye,    LensModel::Fov,
                                                       LensModel::ThinPrismFisheye, LensModel::VisualSfm};

/// As scene.json writes it: "OPENCV", ... "THIN_PRISM_FISHEYE", "VISUALSFM".
const char* nameOf(LensModel model);
/// Nothing for an unknown name.
std::optional<LensModel> lensModelNamed(std::string_view name);
/// "k1 k2 p1 p2 k3"
const char* parametersOf(LensModel model);
int parameterCountOf(LensModel model);

struct Lens {
  LensModel model = LensModel::OpenCv;
  std::array<double, 8> parameters{};  ///< the first parameterCountOf(model) count, the others are 0
  /// Bends nothing: a fisheye always does.
  bool isIdeal() const;
  friend bool operator==(const Lens&, const Lens&) = default;
};

/// (u, v) of (x, y). Not finite where the polynomial overflows, nor for VISUALSFM where the fold of its inverse comes first: such
/// a lens shows no point so far from the axis; nor for FOV unless omega is between -pi and pi.
Eigen::Vector2d distorted(const Lens& lens, const Eigen::Vector2d& ideal);

/// (x, y) of (u, v): the inverse, to 1e-14 of max(1, |(u, v)|), of fisheye models as a function of the angle.
///
/// The polynomials fold back far from the centre, and beyond the fold they show nothing or show it twice. Only the branch that is
/// connected with the centre is an answer; of VISUALSFM, which is stated the other way round, it ends where (x, y) folds back.
/// Fisheye lenses see beyond 90 degrees, where no (x, y, 1) is. The branch of a polynomial in theta and the pole of FULL_OPENCV
/// are found exactly, other folds by samples on the way from the centre.
/// @return  NotConverged if no point of that branch is measured at (u, v); OutsideImage if it is 90 degrees or more from
///          the axis ("is seen 93 degrees from the optical axis; only less than 90 are supported") or lies beyond 180, where
///          nothing is; NotFinite.
Outcome<Eigen::Vector2d> undistorted(const Lens& lens, const Eigen::Vector2d& measured);

}  // namespace glint
