// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <vector>

#include "core/base/progress.h"
#include "core/reflectance/patch_model.h"

/// The least squares problem behind fitPixels; internal to core/reflectance.
namespace glint::patch {

/// All frames under one lobe and one kind of background. The strengths and backgrounds are eliminated: residuals are functions of
/// the state alone (variable projection).
class PixelProblem {
 public:
  PixelProblem(const Normalised& evidence, Lobe lobe, BackgroundKind kind);

  int residuals() const { return static_cast<int>(total_); }
  const Normalised& evidence() const { return evidence_; }
  Lobe lobe() const { return lobe_; }
  BackgroundKind kind() const { return kind_; }

  /// Residuals r' with r'^2 = rho(r^2); false where no frame is lit or nothing is finite.
  bool residualsAt(const State& at, double* out);
  /// Change of r' from the state of the last residualsAt() to `moved`, over `step`; the robust weights are held (to first order
  /// they do not change the sum).
  void differences(const State& moved, double step, double* column, int stride);

  /// The linear part at the state of the last residualsAt(), per frame.
  const std::vector<LinearFit>& solutions() const { return solved_; }
  const std::vector<LobeImage>& images() const { return images_; }

  /// Chooses the quadrature over the lamp for a state: it stays while a solver moves the state, so that the residuals stay
  /// smooth.
  /// @return whether it is a finer one than before.
  bool chooseRule(const State& at);
  /// Evaluations of the lobe in one look at all cells, with the quadrature chosen.
  double evaluations() const;
  /// A normalised light, homogeneous, in the world.
  Eigen::Vector4d worldOf(const Eigen::Vector4d& light) const;

 private:
  template <class F>
  void each(const F& work);
  void solveAt(std::size_t f, const State& at);
  LinearFit fitFixed(std::size_t f, const State& at) const;

  const Normalised& evidence_;
  Lobe lobe_;
  BackgroundKind kind_;
  lobe::LampRule rule_;
  double largestRatio_ = 0;  ///< of the lamp, in lobe widths, that the rule serves
  std::vector<std::size_t> first_;
  std::size_t total_ = 0;
  std::vector<Weights> weights_;
  std::vector<LinearFit> solved_;
  std::vector<LobeImage> sharp_, images_;
  std::vector<BackgroundBasis> bases_;
  State here_;          ///< of the last residualsAt()
  bool fresh_ = false;  ///< sharp_ and bases_ are of that state and of this rule
  std::vector<char> lit_;
};

/// A column of the Jacobian: the state moved along one unknown by `step`.
struct Moved {
  State state;
  double step;
};
/// Which unknowns are free beside those of the lobe.
struct FreeUnknowns {
  bool blur = false;
  bool heldLamp = false;  ///< its place and shape are not
};
/// The columns of L (three directions across it), log m, what the shape adds (the squared radius; the half axis) and the blur's
/// variance, each where it is free.
std::vector<Moved> movedStates(const State& at, FreeUnknowns free);
/// Three orthonormal directions across the unit vector L.
Eigen::Matrix<double, 4, 3> across(const Eigen::Vector4d& light);

struct Attempt {
  State at;
  double cost = std::numeric_limits<double>::infinity();
  int iterations = 0;
  bool converged = false;
};

struct SolveOptions {
  bool blur = false;  ///< free
  int maxIterations = 60;
  double tolerance = 1e-9;       ///< of the unknowns; contours resolve 1e-4
  double costTolerance = 1e-12;  ///< of the cost: a session replayed elsewhere comes to the same digits
  /// Evaluations in one look: a lamp that outgrows them is given up, with infinite cost.
  double mostEvaluations = std::numeric_limits<double>::infinity();
  double work = std::numeric_limits<double>::infinity();  ///< evaluations in all; some iterations are always made
  ProgressFn progress{};                                  ///< asked at every look at all cells
  bool holdLamp = false;                                  ///< place and shape stay
};

/// The minimum that is reached from a state with all unknowns of its shape free. A light at infinity stays there; a point that
/// the search drives beyond infinity is put there. Stopped.
Attempt solve(PixelProblem& problem, const State& start, const SolveOptions& options);

/// Fills residualPx, relativeRms, rmsPx and poor of a fit from the problem's last residuals.
void describeResiduals(const PixelProblem& problem, PixelFit& fit);

/// Fills the covariances at the solution, and for a point at a finite place what an extent would gain.
void describeUncertainty(PixelProblem& problem, const State& at, FreeUnknowns free, PixelFit& fit);

}  // namespace glint::patch
