// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/pixel_problem.h"

#include <ceres/ceres.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/base/progress.h"
#include "core/base/solver_trace.h"
#include "core/light/dense_solver.h"
#include "core/reflectance/light_radiance.h"

namespace glint::patch {
namespace {

constexpr double kStep = 1e-6;               // of the differences by L and log m: both of the order of one
constexpr double kBlurStep = 1e-3;           // px^2
constexpr double kMirrorRoughness = 1e-5;    // roughness of a mirror: no pixel shows its lobe
constexpr double kNoHighlightRoughness = 3;  // roughness beyond which there is no highlight
constexpr double kLargestBlurPx = 12;        // beyond it an image shows no contour that could be compared
constexpr int kFinerRules = 3;               // times that a lamp may outgrow its quadrature

/// Parameter blocks of a state: L (4), log m, the blur's variance, and what the shape has of its own.
std::vector<double*> blocksOf(State& s) {
  std::vector<double*> blocks{s.lamp.centre.data(), &s.logRoughness, &s.blurVariance};
  if (unknownCount(s.lamp.shape) > 0) blocks.push_back(unknownsOf(s.lamp.shape).data());
  return blocks;
}

/// Step of the differences by the unknowns of a shape: a small share of them.
double shapeStep(LampShape shape) {
  const std::span<const double> own = unknownsOf(shape);
  const double least = std::visit([](const auto& s) { return s.kLeastStep; }, shape);
  constexpr double kShare = 1e-4;  // its second order stays below this
  return std::max(least, kShare * Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size())).norm());
}
State alongShape(const State& at, int k, double step) {
  State moved = at;
  unknownsOf(moved.lamp.shape)[std::size_t(k)] += step;
  return moved;
}

/// @param like  of the same shape and ratio of widths, which no block holds
State stateOf(double const* const* parameters, const State& like) {
  State s = like;
  s.lamp.centre = Eigen::Map<const Eigen::Vector4d>(parameters[0]).normalized();
  s.logRoughness = *parameters[1];
  s.blurVariance = *parameters[2];
  const std::span<double> own = unknownsOf(s.lamp.shape);
  if (!own.empty()) std::copy_n(parameters[3], own.size(), own.begin());
  return s;
}

State alongLight(const State& at, const Eigen::Vector4d& direction) {
  State moved = at;
  moved.lamp.centre = (at.lamp.centre + kStep * direction).normalized();
  return moved;
}

/// Robust residuals of all cells over blocksOf().
class PixelCost final : public ceres::CostFunction {
 public:
  PixelCost(PixelProblem& problem, const State& start, const ProgressFn& progress)
      : problem_(problem), start_(start), progress_(progress) {
    set_num_residuals(problem.residuals());
    *mutable_parameter_block_sizes() = {4, 1, 1};
    if (const int own = unknownCount(start.lamp.shape); own > 0) mutable_parameter_block_sizes()->push_back(own);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const State at = stateOf(parameters, start_);
    if (!(at.logRoughness < std::log(kNoHighlightRoughness)) || !(at.logRoughness > std::log(kMirrorRoughness))) return false;
    if (!std::visit([](const auto& s) { return s.kMayVanish || s.reach() > 0; }, at.lamp.shape)) return false;
    if (!goesOn()) return nothingLeft(residuals, jacobians);
    if (!problem_.residualsAt(at, residuals)) return false;
    if (!jacobians) return true;
    if (jacobians[0]) {
      const Eigen::Matrix<double, 4, 3> basis = across(at.lamp.centre);
      Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> tangent(problem_.residuals(), 3);
      for (int k = 0; k < 3 && goesOn(); ++k) problem_.differences(alongLight(at, basis.col(k)), kStep, tangent.data() + k, 3);
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>>(jacobians[0], problem_.residuals(), 4) =
          tangent * basis.transpose();
    }
    const auto scalar = [&](int block, double State::*member, double step) {
      if (!jacobians[block] || !goesOn()) return;
      State moved = at;
      moved.*member += step;
      problem_.differences(moved, step, jacobians[block], 1);
    };
    scalar(1, &State::logRoughness, kStep);
    scalar(2, &State::blurVariance, kBlurStep);
    const int own = unknownCount(at.lamp.shape);
    for (int k = 0; k < own && jacobians[3] && goesOn(); ++k)
      problem_.differences(alongShape(at, k, shapeStep(at.lamp.shape)), shapeStep(at.lamp.shape), jacobians[3] + k, own);
    return stopped_ ? nothingLeft(residuals, jacobians) : true;
  }
  bool stopped() const { return stopped_; }

 private:
  /// Ends the solver at once. Without it the solver would log an error where an evaluation fails.
  bool nothingLeft(double* residuals, double** jacobians) const {
    std::fill_n(residuals, num_residuals(), 0.0);
    for (std::size_t k = 0; jacobians && k < parameter_block_sizes().size(); ++k)
      if (jacobians[k]) std::fill_n(jacobians[k], num_residuals() * parameter_block_sizes()[k], 0.0);
    return true;
  }
  bool goesOn() const {
    stopped_ = stopped_ || !report(progress_, {"fit", 0, 0});
    return !stopped_;
  }

  PixelProblem& problem_;
  State start_;
  const ProgressFn& progress_;
  mutable bool stopped_ = false;  // the solver knows functions without a state only
};

/// One run of the solver with the present quadrature.
bool run(PixelProblem& problem, Attempt& a, const SolveOptions& options, bool atInfinity) {
  PixelCost cost(problem, a.at, options.progress);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres(ownership);
  State& s = a.at;
  const std::vector<double*> blocks = blocksOf(s);
  ceres.AddResidualBlock(&cost, nullptr, blocks);
  if (atInfinity)
    ceres.SetManifold(blocks[0], new ceres::ProductManifold<ceres::SphereManifold<3>, ceres::SubsetManifold>(
                                     ceres::SphereManifold<3>(), ceres::SubsetManifold(1, {0})));
  else
    ceres.SetManifold(blocks[0], new ceres::SphereManifold<4>());
  if (options.holdLamp) ceres.SetParameterBlockConstant(blocks[0]);
  if (options.holdLamp && blocks.size() > 3) ceres.SetParameterBlockConstant(blocks[3]);
  if (blocks.size() > 3 && std::visit([](const auto& shape) { return shape.kMayVanish; }, s.lamp.shape))
    ceres.SetParameterLowerBound(blocks[3], 0, std::visit([](const auto& shape) { return shape.kLeastStep; }, s.lamp.shape));
  if (options.blur) {
    ceres.SetParameterLowerBound(&s.blurVariance, 0, -kPixelVariance);
    ceres.SetParameterUpperBound(&s.blurVariance, 0, kLargestBlurPx * kLargestBlurPx);
  } else {
    ceres.SetParameterBlockConstant(&s.blurVariance);
  }
  const DenseSolution solution = solveDense(ceres, options.maxIterations, options.tolerance, options.costTolerance);
  // No exception may pass through the solver, which is not written for it.
  if (cost.stopped()) throw Stopped{};
  a.iterations += solution.iterations;
  if (!solution.usable || !s.isFinite()) return false;
  a.cost = 2 * solution.cost;
  a.converged = solution.converged;
  return true;
}

}  // namespace

Eigen::Matrix<double, 4, 3> across(const Eigen::Vector4d& light) {
  Eigen::Matrix4d q = Eigen::HouseholderQR<Eigen::Matrix<double, 4, 1>>(light).householderQ();
  return q.rightCols<3>();
}

std::vector<Moved> movedStates(const State& at, FreeUnknowns free) {
  std::vector<Moved> moved;
  const Eigen::Matrix<double, 4, 3> basis = across(at.lamp.centre);
  for (int k = 0; k < 3 && !free.heldLamp; ++k) moved.push_back({alongLight(at, basis.col(k)), kStep});
  const auto add = [&](double step, const auto& change) {
    moved.push_back({at, step});
    change(moved.back().state);
  };
  add(kStep, [](State& s) { s.logRoughness += kStep; });
  const double step = shapeStep(at.lamp.shape);
  for (int k = 0; k < unknownCount(at.lamp.shape) && !free.heldLamp; ++k) moved.push_back({alongShape(at, k, step), step});
  if (free.blur) add(kBlurStep, [](State& s) { s.blurVariance += kBlurStep; });
  return moved;
}

PixelProblem::PixelProblem(const Normalised& evidence, Lobe lobe, BackgroundKind kind)
    : evidence_(evidence), lobe_(lobe), kind_(kind), weights_(evidence.frames.size()) {
  for (std::size_t f = 0; f < weights_.size(); ++f) {
    first_.push_back(total_);
    total_ += evidence.frames[f].used;
    weights_[f].assign(evidence.frames[f].used, 1.0);
  }
}

template <class F>
void PixelProblem::each(const F& work) {
  solved_.resize(evidence_.frames.size());
  images_.resize(evidence_.frames.size());
  sharp_.resize(evidence_.frames.size());
  bases_.resize(evidence_.frames.size());
  lit_.resize(evidence_.frames.size());
  parallelFor(
      static_cast<int>(evidence_.frames.size()), [&](int f) { work(static_cast<std::size_t>(f)); }, {}, "pixels");
}

bool PixelProblem::residualsAt(const State& at, double* out) {
  bool any = false;
  here_ = at;
  fresh_ = true;
  each([&](std::size_t f) { solveAt(f, at); });
  for (std::size_t f = 0; f < solved_.size(); ++f) {
    any = any || lit_[f];
    for (std::size_t i = 0; i < solved_[f].residual.size(); ++i) {
      const double r = solved_[f].residual[i];
      if (!std::isfinite(r)) return false;
      out[first_[f] + i] = std::copysign(std::sqrt(robustSquare(r)), r);
    }
  }
  return any;
}

void PixelProblem::differences(const State& moved, double step, double* column, int stride) {
  each([&](std::size_t f) {
    const LinearFit there = fitFixed(f, moved);
    for (std::size_t i = 0; i < there.residual.size(); ++i) {
      const double r = solved_[f].residual[i], root = std::copysign(std::sqrt(robustSquare(r)), r);
      // d r' / d r = rho'(r) r / r'.
      const double slope = root != 0 ? robustWeight(r) * r / root : 1;
      const double d = (there.residual[i] - r) / step;
      column[static_cast<std::ptrdiff_t>(first_[f] + i) * stride] = std::isfinite(d) ? slope * d : 0;
    }
  });
}

void PixelProblem::solveAt(std::size_t f, const State& at) {
  const FramePatches& frame = evidence_.frames[f];
  sharp_[f] = sharpImage(lobe_, frame, at, rule_);
  images_[f] = blurredImage(sharp_[f], frame, at);
  lit_[f] = images_[f].lit;
  if (lit_[f]) {
    Weights weights(weights_[f].size(), 1.0);
    bases_[f] = backgroundBasis(frame, kind_, at);
    solved_[f] = robustFit(frame, images_[f], bases_[f], weights);
    weights_[f] = std::move(weights);
    // A highlight takes nothing away from the light that is there.
    if (solved_[f].solved && !(solved_[f].coefficients(0) > 0)) solved_[f].solved = false;
  }
  if (lit_[f] && solved_[f].solved) return;
  // Nothing of the frame is explained: what it shows above zero is the residual.
  solved_[f] = {};
  for (const PixelPatch& p : frame.patches)
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.used[i]) solved_[f].residual.push_back(std::sqrt(std::max(0.0f, p.value[i]) / frame.top));
}

LinearFit PixelProblem::fitFixed(std::size_t f, const State& at) const {
  if (!solved_[f].solved) return solved_[f];
  const FramePatches& frame = evidence_.frames[f];
  // residualsAt() has computed what the step does not change.
  State withBlurOfHere = at;
  withBlurOfHere.blurVariance = here_.blurVariance;
  const LobeImage image =
      blurredImage(fresh_ && withBlurOfHere == here_ ? sharp_[f] : sharpImage(lobe_, frame, at, rule_), frame, at);
  if (!image.lit) return solved_[f];
  const bool sameBasis = fresh_ && (!dependsOnLight(kind_) || at.lamp.centre == here_.lamp.centre);
  LinearFit fit = linearFit(frame, image, sameBasis ? bases_[f] : backgroundBasis(frame, kind_, at), weights_[f]);
  return fit.solved ? fit : solved_[f];
}

bool PixelProblem::chooseRule(const State& at) {
  if (at.lamp.isPoint()) return false;
  double largest = 0;
  for (const FramePatches& frame : evidence_.frames)
    for (const PixelPatch& p : frame.patches) {
      const std::size_t middle = static_cast<std::size_t>(p.rows / 2) * p.columns + p.columns / 2;
      if (p.onSurface[middle])
        largest = std::max(largest, lobe::lampRatio(at.roughness(), p.seen[middle].position, p.seen[middle].toCamera, at.lamp));
    }
  const bool first = !rule_.nodes;
  if (!first && largest <= largestRatio_) return false;
  // Some reserve: the lamp may grow a little while it is sought.
  largestRatio_ = 1.3 * largest;
  const lobe::LampRule before = rule_;
  rule_ = lobe::lampRuleFor(at.lamp.shape, largestRatio_);
  fresh_ = false;
  return first || rule_ != before;
}

double PixelProblem::evaluations() const { return rule_.count() * double(evidence_.cells); }

Eigen::Vector4d PixelProblem::worldOf(const Eigen::Vector4d& light) const {
  Eigen::Vector4d world;
  world << evidence_.scale * light.head<3>() + light.w() * evidence_.origin, light.w();
  return world;
}

namespace {

Attempt solveFrom(PixelProblem& problem, const State& start, const SolveOptions& options) {
  Attempt a;
  a.at = start;
  const bool atInfinity = start.atInfinity();
  if (atInfinity) a.at.lamp.centre.normalize();
  problem.chooseRule(a.at);
  for (int round = 0; round < kFinerRules; ++round) {
    if (problem.evaluations() > options.mostEvaluations) {
      a.cost = std::numeric_limits<double>::infinity();
      return a;
    }
    SolveOptions within = options;
    if (std::isfinite(options.work)) {
      constexpr int kLeastIterations = 4, kColumns = 8;  // of the Jacobian; one more look for the residuals
      const int afforded = static_cast<int>(std::min(1e6, options.work / (problem.evaluations() * (kColumns + 1))));
      within.maxIterations = std::min(options.maxIterations, std::max(kLeastIterations, afforded));
    }
    if (!run(problem, a, within, atInfinity) || !problem.chooseRule(a.at)) break;
    if (!a.converged && std::isfinite(options.work)) break;
  }
  // Beyond infinity the rays towards the lamp converge behind the scene: it is at infinity, as far as the pixels tell.
  if (std::isfinite(a.cost) && a.at.lamp.centre.w() < 0 && !atInfinity) {
    if (!a.at.lamp.isPoint()) {
      a.cost = std::numeric_limits<double>::infinity();  // where an extent has no meaning
      return a;
    }
    State there = a.at;
    there.lamp.centre.w() = 0;
    Attempt far = solve(problem, there, options);
    far.iterations += a.iterations;
    return far;
  }
  return a;
}

}  // namespace

Attempt solve(PixelProblem& problem, const State& start, const SolveOptions& options) {
  TracedRun run(options.blur ? "lamp, lobe and blur from pixels" : "lamp and lobe from pixels",
                problem.worldOf(start.lamp.centre), "squares of relative radiance");
  const Attempt a = solveFrom(problem, start, options);
  run.end(a.converged,
          !std::isfinite(a.cost) ? "no usable step"
          : a.converged          ? "at a minimum"
                                 : "out of iterations",
          problem.worldOf(a.at.lamp.centre));
  return a;
}

}  // namespace glint::patch
