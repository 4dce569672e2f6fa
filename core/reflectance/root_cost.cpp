// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/root_cost.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>

#include <cmath>
#include <type_traits>

#include "core/reflectance/light_radiance.h"

// By itself the compiler calls a function for every sum of dual numbers. One flat function with a sanitizer's checks in each sum
// takes more than 46 minutes to compile.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define GLINT_FLATTEN
#else
#define GLINT_FLATTEN [[gnu::flatten]]
#endif

namespace glint::lobe {
namespace {

/// @tparam Shape  of lamp.h
template <template <class> class Shape>
using DualOf = ceres::Jet<double, 5 + Shape<double>::kUnknowns>;

double valueOf(double x) { return x; }
template <class T, int kSize>
T valueOf(const ceres::Jet<T, kSize>& x) {
  return x.a;
}
bool isFinite(double x) { return std::isfinite(x); }
template <class T, int kSize>
bool isFinite(const ceres::Jet<T, kSize>& x) {
  return std::isfinite(x.a) && x.v.allFinite();
}

/// log I at a point, with its derivatives where the scalar carries them. @param parameters  as Blocks has them
template <template <class> class Shape, class T>
GLINT_FLATTEN std::optional<T> logOf(const RadianceProblem& problem, const Seen& s, double const* const* parameters,
                                     double ratio) {
  using std::exp;
  const auto unknown = [&](double value, int i) {
    if constexpr (std::is_same_v<T, double>)
      return value;
    else
      return T(value, i);
  };
  Eigen::Matrix<T, 4, 1> light;
  for (int i = 0; i < 4; ++i) light(i) = unknown(parameters[0][i], i);
  const T roughness = exp(unknown(parameters[1][0], 4));
  if (!(valueOf(roughness) > 0) || !std::isfinite(valueOf(roughness))) return std::nullopt;
  Shape<T> shape;
  for (int i = 0; i < shape.kUnknowns; ++i) shape.unknowns()[i] = unknown(parameters[2][i], 5 + i);
  return logOfShape<T>(shape, problem.lobe(), {roughness, ratio}, s.position, s.axes, s.toCamera, light, problem.rule());
}

/// (g - sqrt(-log q)) in pixels, with its derivatives by dual numbers; g at the frame's peak is the problem's, of the same
/// parameters. The ratio of two widths is by differences: dual numbers of another size would compile all of the lobes once more.
template <template <class> class Shape>
class RootCost final : public ceres::CostFunction {
 public:
  static constexpr int kOwn = Shape<double>::kUnknowns;
  static constexpr int kBlocks = kOwn > 0 ? 3 : 2;  ///< without the ratio's
  using Dual = DualOf<Shape>;

  RootCost(const RadianceProblem& problem, const Evidence& evidence)
      : problem_(problem), e_(evidence), twoWidths_(hasTwoWidths(problem.lobe())) {
    set_num_residuals(1);
    *mutable_parameter_block_sizes() = {4, 1};
    if (kOwn > 0) mutable_parameter_block_sizes()->push_back(kOwn);
    if (twoWidths_) mutable_parameter_block_sizes()->push_back(1);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    if (!jacobians) {
      const std::optional<double> plain = residualOf<double>(parameters, [](const LogAndSlopes& peak) { return peak.value; });
      residuals[0] = plain.value_or(kUnlitPx);
      return true;
    }
    const std::optional<Dual> residual =
        residualOf<Dual>(parameters, [](const LogAndSlopes& peak) { return Dual(peak.value, peak.slopes.head<5 + kOwn>()); });
    // A light that does not reach the point is far off: a large residual that pulls nowhere, so that the others decide.
    residuals[0] = residual ? residual->a : kUnlitPx;
    constexpr int kFirst[] = {0, 4, 5}, kSize[] = {4, 1, kOwn};
    for (int b = 0; b < kBlocks; ++b)
      for (int i = 0; jacobians[b] && i < kSize[b]; ++i) jacobians[b][i] = residual ? residual->v(kFirst[b] + i) : 0;
    if (twoWidths_ && jacobians[kBlocks]) *jacobians[kBlocks] = residual ? byLogRatio(parameters) : 0;
    return true;
  }

 private:
  double ratioOf(double const* const* parameters, double step = 0) const {
    return twoWidths_ ? std::exp(*parameters[kBlocks] + step) : 1;
  }

  /// Derivative of the residual by the logarithm of the ratio; 0 where the light does not reach a point.
  double byLogRatio(double const* const* parameters) const {
    constexpr double kStep = 1e-4;  // its second order stays below 1e-8
    const auto at = [&](double step) {
      const double ratio = ratioOf(parameters, step);
      const std::optional<double> top = logOf<Shape, double>(problem_, *problem_.frame(e_.frame).at, parameters, ratio);
      const std::optional<double> here = logOf<Shape, double>(problem_, e_.foot.at, parameters, ratio);
      return top && here ? rootOf(*top - *here, e_.level) * e_.pixelsPerUnit : std::nan("");
    };
    const double slope = (at(kStep) - at(-kStep)) / (2 * kStep);
    return std::isfinite(slope) ? slope : 0;
  }

  template <class T, class Top>
  std::optional<T> residualOf(double const* const* parameters, const Top& topOf) const {
    const std::optional<LogAndSlopes>& peak = problem_.frame(e_.frame).log;
    if (!peak) return std::nullopt;
    const std::optional<T> here = logOf<Shape, T>(problem_, e_.foot.at, parameters, ratioOf(parameters));
    if (!here) return std::nullopt;
    const T top = topOf(*peak);
    const T residual = (rootOf<T>(top - *here, e_.level) - T(e_.level)) * T(e_.pixelsPerUnit) + T(e_.offsetPx - e_.biasPx);
    return isFinite(residual) ? std::optional<T>(residual) : std::nullopt;
  }

  const RadianceProblem& problem_;
  const Evidence& e_;
  bool twoWidths_;
};

template <template <class> class Shape>
std::optional<LogAndSlopes> logAndSlopesOf(const RadianceProblem& problem, const Seen& s, State& state) {
  const auto log = logOf<Shape, DualOf<Shape>>(problem, s, Blocks(state, problem.lobe()).at, state.roughness().ratio);
  if (!log || !isFinite(*log)) return std::nullopt;
  LogAndSlopes result;
  result.value = log->a;
  result.slopes.template head<5 + Shape<double>::kUnknowns>() = log->v;
  return result;
}

}  // namespace

std::unique_ptr<ceres::CostFunction> rootCost(const LampShape& shape, const RadianceProblem& problem, const Evidence& evidence) {
  return std::visit(
      [&]<template <class> class Shape>(const Shape<double>&) -> std::unique_ptr<ceres::CostFunction> {
        return std::make_unique<RootCost<Shape>>(problem, evidence);
      },
      shape);
}

std::optional<LogAndSlopes> logAndSlopes(const RadianceProblem& problem, const Seen& s, State state) {
  return std::visit([&]<template <class> class Shape>(const Shape<double>&) { return logAndSlopesOf<Shape>(problem, s, state); },
                    state.lamp.shape);
}

}  // namespace glint::lobe
