// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/pixel_fit.h"

#include <ceres/ceres.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/parallel.h"
#include "core/base/residual_spread.h"
#include "core/light/dense_solver.h"
#include "core/reflectance/patch_model.h"

namespace glint {
namespace {

using patch::FramePatches;
using patch::LobeImage;
using patch::State;
using patch::Weights;

constexpr double kStep = 1e-6;           // of the differences by L and log m: both of the order of one
constexpr double kBlurStep = 1e-3;       // px^2
constexpr double kTolerance = 1e-9;      // of the unknowns; contours resolve 1e-4
constexpr double kCostTolerance = 1e-12;  // of the cost: a session replayed elsewhere comes to the same digits
constexpr double kSearchTolerance = 1e-4;  // of fits that only choose a start or a background
constexpr double kNarrowest = 1e-5;      // roughness of a mirror: no pixel shows its lobe
constexpr double kLeastSizeSquared = 1e-12;  // of the lamp's radius, normalised: keeps differences finite
constexpr double kWidest = 3;            // roughness beyond which there is no highlight
constexpr double kPoorShare = 0.1;       // of the contour's radius, or of the top: what a lobe that explains the pixels never leaves
constexpr double kMicrofacetMargin = 0.02;  // of the cost, by which a cosine power must be better than a microfacet lobe
constexpr double kClearGain = 0.1;       // of the cost, before a size or a blur is believed
constexpr int kSizeIterations = 12;      // a size that is there shows after a few, and sums over a lamp take long
constexpr double kLargestBlurPx = 12;    // beyond it an image shows no contour that could be compared
constexpr double kInsideShare = 0.1;     // of the top: cells that show the highlight
constexpr double kEdgeLow = 0.3, kEdgeHigh = 0.7;  // of the top: cells at the contour

/// All frames under one lobe and one kind of background.
class Pixels {
 public:
  Pixels(const patch::Normalised& evidence, Lobe lobe, BackgroundKind kind)
      : evidence_(evidence), lobe_(lobe), kind_(kind), weights_(evidence.frames.size()) {
    for (std::size_t f = 0; f < weights_.size(); ++f) {
      first_.push_back(total_);
      total_ += evidence.frames[f].used;
      weights_[f].assign(evidence.frames[f].used, 1.0);
    }
  }
  int residuals() const { return static_cast<int>(total_); }
  Lobe lobe() const { return lobe_; }
  BackgroundKind kind() const { return kind_; }

  /// Residuals r' with r'^2 = rho(r^2); false where no frame is lit or nothing is finite.
  bool residualsAt(const State& at, double* out) {
    bool any = false;
    each([&](std::size_t f) { solveAt(f, at, true); });
    for (std::size_t f = 0; f < solved_.size(); ++f) {
      any = any || lit_[f];
      for (std::size_t i = 0; i < solved_[f].residual.size(); ++i) {
        const double r = solved_[f].residual[i];
        if (!std::isfinite(r)) return false;
        out[first_[f] + i] = std::copysign(std::sqrt(patch::robustSquare(r)), r);
      }
    }
    return any;
  }

  /// Change of r' when the state moves by `step`, the robust weights held (to first order they do not change the sum).
  void differences(const State& moved, double step, double* column, int stride) {
    each([&](std::size_t f) {
      const patch::LinearFit there = fitFixed(f, moved);
      for (std::size_t i = 0; i < there.residual.size(); ++i) {
        const double r = solved_[f].residual[i], root = std::copysign(std::sqrt(patch::robustSquare(r)), r);
        // d r' / d r = rho'(r) r / r'.
        const double slope = root != 0 ? patch::robustWeight(r) * r / root : 1;
        const double d = (there.residual[i] - r) / step;
        column[static_cast<std::ptrdiff_t>(first_[f] + i) * stride] = std::isfinite(d) ? slope * d : 0;
      }
    });
  }

  const patch::Normalised& evidence() const { return evidence_; }
  const std::vector<patch::LinearFit>& solutions() const { return solved_; }
  const std::vector<LobeImage>& images() const { return images_; }
  const lobe::DiscRule& rule(const State& at) const {
    double largest = 0;
    if (at.radiusSquared > 0)
      for (const FramePatches& frame : evidence_.frames)
        for (const PixelPatch& p : frame.patches) {
          const std::size_t middle = static_cast<std::size_t>(p.rows / 2) * p.columns + p.columns / 2;
          if (p.onSurface[middle])
            largest = std::max(largest, lobe::sizeRatio(std::exp(at.logRoughness), p.seen[middle].position, p.seen[middle].toCamera,
                                                        at.light, std::sqrt(at.radiusSquared)));
        }
    return lobe::discRuleFor(largest);
  }
  void chooseRule(const State& at) { rule_ = &rule(at); }

 private:
  template <class F>
  void each(const F& work) {
    solved_.resize(evidence_.frames.size());
    images_.resize(evidence_.frames.size());
    lit_.resize(evidence_.frames.size());
    parallelFor(static_cast<int>(evidence_.frames.size()), [&](int f) { work(static_cast<std::size_t>(f)); }, {}, "pixels");
  }
  void solveAt(std::size_t f, const State& at, bool keepImage) {
    LobeImage image = patch::lobeImage(lobe_, evidence_.frames[f], at, *rule_);
    lit_[f] = image.lit;
    if (image.lit) {
      Weights weights(weights_[f].size(), 1.0);
      solved_[f] = patch::robustFit(evidence_.frames[f], image, kind_, at, weights);
      weights_[f] = std::move(weights);
      // A highlight takes nothing away from the light that is there.
      if (solved_[f].solved && !(solved_[f].coefficients(0) > 0)) solved_[f].solved = false;
    }
    if (!image.lit || !solved_[f].solved) {
      // Nothing of the frame is explained: what it shows above zero is the residual.
      solved_[f] = {};
      for (const PixelPatch& p : evidence_.frames[f].patches)
        for (std::size_t i = 0; i < p.size(); ++i)
          if (p.used[i]) solved_[f].residual.push_back(std::sqrt(std::max(0.0f, p.value[i]) / evidence_.frames[f].top));
    }
    if (keepImage) images_[f] = std::move(image);
  }
  patch::LinearFit fitFixed(std::size_t f, const State& at) const {
    const LobeImage image = patch::lobeImage(lobe_, evidence_.frames[f], at, *rule_);
    if (!image.lit || !solved_[f].solved) return solved_[f];
    patch::LinearFit fit = patch::linearFit(evidence_.frames[f], image, kind_, at, weights_[f]);
    return fit.solved ? fit : solved_[f];
  }

  const patch::Normalised& evidence_;
  Lobe lobe_;
  BackgroundKind kind_;
  const lobe::DiscRule* rule_ = &lobe::discRuleFor(0);
  std::vector<std::size_t> first_;
  std::size_t total_ = 0;
  std::vector<Weights> weights_;
  std::vector<patch::LinearFit> solved_;
  std::vector<LobeImage> images_;
  std::vector<char> lit_;
};

/// Step of the differences by the squared radius: a small share of it.
double sizeStep(const State& at) { return std::max(kLeastSizeSquared, 1e-4 * at.radiusSquared); }  // second order stays below 1e-4

State stateOf(double const* const* parameters) {
  State s;
  s.light = Eigen::Map<const Eigen::Vector4d>(parameters[0]).normalized();
  s.logRoughness = *parameters[1];
  s.radiusSquared = *parameters[2];
  s.blurVariance = *parameters[3];
  return s;
}

/// Three orthonormal directions across the unit vector L.
Eigen::Matrix<double, 4, 3> across(const Eigen::Vector4d& light) {
  Eigen::Matrix4d q = Eigen::HouseholderQR<Eigen::Matrix<double, 4, 1>>(light).householderQ();
  return q.rightCols<3>();
}

State movedBy(const State& at, const Eigen::Vector4d& direction, double step) {
  State moved = at;
  moved.light = (at.light + step * direction).normalized();
  return moved;
}

/// Robust residuals of all cells over L (4), log m, the lamp's squared radius and the blur's variance.
class PixelCost final : public ceres::CostFunction {
 public:
  explicit PixelCost(Pixels& pixels) : pixels_(pixels) {
    set_num_residuals(pixels.residuals());
    for (const int size : {4, 1, 1, 1}) mutable_parameter_block_sizes()->push_back(size);
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const State at = stateOf(parameters);
    if (!(at.logRoughness < std::log(kWidest)) || !(at.logRoughness > std::log(kNarrowest))) return false;
    if (!pixels_.residualsAt(at, residuals)) return false;
    if (!jacobians) return true;
    if (jacobians[0]) {
      const Eigen::Matrix<double, 4, 3> basis = across(at.light);
      Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> tangent(pixels_.residuals(), 3);
      for (int k = 0; k < 3; ++k) pixels_.differences(movedBy(at, basis.col(k), kStep), kStep, tangent.data() + k, 3);
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>>(jacobians[0], pixels_.residuals(), 4) =
          tangent * basis.transpose();
    }
    const auto scalar = [&](int block, double State::*member, double step) {
      if (!jacobians[block]) return;
      State moved = at;
      moved.*member += step;
      pixels_.differences(moved, step, jacobians[block], 1);
    };
    scalar(1, &State::logRoughness, kStep);
    scalar(2, &State::radiusSquared, sizeStep(at));
    scalar(3, &State::blurVariance, kBlurStep);
    return true;
  }

 private:
  Pixels& pixels_;
};

struct Attempt {
  State at;
  double cost = std::numeric_limits<double>::infinity();
  int iterations = 0;
  bool converged = false;
};

struct Free {
  bool size = false, blur = false, atInfinity = false;
};

Attempt solve(Pixels& pixels, const State& start, const Free& free, int maxIterations, double tolerance, double costTolerance) {
  Attempt a;
  a.at = start;
  if (free.atInfinity) {
    a.at.light.w() = 0;
    a.at.light.normalize();
  }
  pixels.chooseRule(a.at);
  PixelCost cost(pixels);
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(ownership);
  problem.AddResidualBlock(&cost, nullptr, a.at.light.data(), &a.at.logRoughness, &a.at.radiusSquared, &a.at.blurVariance);
  if (free.atInfinity)
    problem.SetManifold(a.at.light.data(), new ceres::ProductManifold<ceres::SphereManifold<3>, ceres::SubsetManifold>(
                                               ceres::SphereManifold<3>(), ceres::SubsetManifold(1, {0})));
  else
    problem.SetManifold(a.at.light.data(), new ceres::SphereManifold<4>());
  if (free.size) problem.SetParameterLowerBound(&a.at.radiusSquared, 0, kLeastSizeSquared);
  else problem.SetParameterBlockConstant(&a.at.radiusSquared);
  if (free.blur) {
    problem.SetParameterLowerBound(&a.at.blurVariance, 0, 0);
    problem.SetParameterUpperBound(&a.at.blurVariance, 0, kLargestBlurPx * kLargestBlurPx);
  } else {
    problem.SetParameterBlockConstant(&a.at.blurVariance);
  }
  const DenseSolution solution = solveDense(problem, maxIterations, tolerance, costTolerance);
  a.iterations = solution.iterations;
  a.converged = solution.usable && solution.converged;
  if (!solution.usable || !a.at.light.allFinite() || !std::isfinite(a.at.logRoughness)) return a;
  a.cost = 2 * solution.cost;
  // Beyond infinity the rays towards the lamp converge behind the scene: it is at infinity, as far as the pixels tell.
  if (a.at.light.w() < 0 && !free.atInfinity) {
    Free there = free;
    there.atInfinity = true;
    there.size = false;
    Attempt far = solve(pixels, a.at, there, maxIterations, tolerance, costTolerance);
    far.iterations += a.iterations;
    return far;
  }
  return a;
}

/// Bayesian information criterion of a fit to n cells, up to a constant.
double criterion(const Attempt& a, const patch::Normalised& evidence, BackgroundKind kind) {
  double unknowns = 4;
  for (const FramePatches& f : evidence.frames) unknowns += 1 + patch::coefficientsOf(kind) * double(f.patches.size());
  const double n = static_cast<double>(evidence.cells);
  // 1e-14: single precision of the images, squared, with some reserve.
  return n * std::log(a.cost / n + 1e-14) + unknowns * std::log(n);
}

bool isMicrofacet(Lobe lobe) { return lobe == Lobe::TorranceSparrow || lobe == Lobe::Ggx; }

Light inWorld(const State& at, const patch::Normalised& n) {
  Eigen::Vector4d world;
  world << n.scale * at.light.head<3>() + at.light.w() * n.origin, at.light.w();
  return Light::homogeneous(world);
}

/// What remains, per patch: as a share of the top, and as a displacement of the contour.
void describeResiduals(const Pixels& pixels, PixelFit& fit) {
  double squares = 0, count = 0;
  bool unexplained = false;
  for (std::size_t f = 0; f < pixels.evidence().frames.size(); ++f) {
    const FramePatches& frame = pixels.evidence().frames[f];
    const patch::LinearFit& solved = pixels.solutions()[f];
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
      fit.poor = fit.poor || !(fit.relativeRms.back() < kPoorShare);
    }
  }
  fit.rmsPx = count > 0 ? std::sqrt(squares / count) : std::nan("");
  fit.poor = fit.poor || unexplained || !(fit.rmsPx <= kPoorShare * pixels.evidence().radiusPx);
}

/// Covariance of the unknowns from the Jacobian at the solution; residuals of neighbouring cells go together along rows and along
/// columns, so that the inflation that residualSpread() sees along rows counts twice.
void describeUncertainty(Pixels& pixels, const Attempt& a, const Free& free, PixelFit& fit) {
  fit.positionCovariance.setZero();
  fit.positionCovariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  std::vector<double> residuals(static_cast<std::size_t>(pixels.residuals()));
  if (!pixels.residualsAt(a.at, residuals.data())) return;
  const Eigen::Index unknowns = 4 + (free.size ? 1 : 0) + (free.blur ? 1 : 0);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(pixels.residuals(), unknowns);
  const Eigen::Matrix<double, 4, 3> basis = across(a.at.light);
  const int stride = static_cast<int>(unknowns);
  for (int k = 0; k < 3; ++k) pixels.differences(movedBy(a.at, basis.col(k), kStep), kStep, jacobian.data() + k, stride);
  const auto scalar = [&](Eigen::Index column, double State::*member, double step) {
    State moved = a.at;
    moved.*member += step;
    pixels.differences(moved, step, jacobian.data() + column, stride);
  };
  scalar(3, &State::logRoughness, kStep);
  Eigen::Index next = 4;
  if (free.size) scalar(next++, &State::radiusSquared, sizeStep(a.at));
  if (free.blur) scalar(next++, &State::blurVariance, kBlurStep);
  const Eigen::MatrixXd r =
      Eigen::HouseholderQR<Eigen::MatrixXd>(jacobian).matrixQR().topRows(unknowns).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeFullV);
  if (!(svd.singularValues()(unknowns - 1) > 1e-12 * svd.singularValues()(0))) return;  // a free direction
  std::vector<int> views;
  for (std::size_t f = 0; f < pixels.evidence().frames.size(); ++f)
    views.insert(views.end(), pixels.evidence().frames[f].used, static_cast<int>(f));
  const ResidualSpread spread = residualSpread(residuals, views, static_cast<int>(unknowns), 1);
  const double inflation = std::max(1.0, double(residuals.size()) / spread.degreesOfFreedom);
  const Eigen::MatrixXd all =
      std::sqrt(spread.factor * inflation) * svd.matrixV() * svd.singularValues().cwiseInverse().asDiagonal();
  const patch::Normalised& n = pixels.evidence();
  if (a.at.light.w() != 0) {
    const double w = a.at.light.w();
    Eigen::Matrix<double, 3, 4> position;  // d(l / w)
    position << Eigen::Matrix3d::Identity() / w, -a.at.light.head<3>() / (w * w);
    const Eigen::MatrixXd half = n.scale * position * basis * all.topRows<3>();
    const Eigen::Matrix3d covariance = half * half.transpose();
    if (covariance.allFinite()) fit.positionCovariance = covariance;
  }
  // In the world, with |L| = 1 again: d(y / |y|) = (I - u u^T) dy / |y|.
  Eigen::Matrix4d toWorld = Eigen::Matrix4d::Identity();
  toWorld.topLeftCorner<3, 3>() *= n.scale;
  toWorld.topRightCorner<3, 1>() = n.origin;
  const Eigen::Vector4d y = toWorld * a.at.light, u = y.normalized();
  const Eigen::MatrixXd dy = toWorld * basis * all.topRows<3>();
  ParameterUncertainty uncertainty;
  uncertainty.root.resize(5, unknowns);
  uncertainty.root.topRows<4>() = (dy - u * (u.transpose() * dy)) / y.norm();
  uncertainty.root.bottomRows<1>() = all.row(3);
  uncertainty.noisePx = fit.rmsPx;
  uncertainty.degreesOfFreedom = std::max(1.0, spread.degreesOfFreedom / inflation);
  if (uncertainty.root.allFinite()) fit.uncertainty = std::move(uncertainty);
}

State stateOf(const LobeModel& model, const patch::Normalised& n) {
  State s;
  s.light = patch::normalisedLight(model.light, n);
  s.logRoughness = std::log(model.roughness);
  s.radiusSquared = std::pow(model.lightRadius / n.scale, 2);
  s.blurVariance = model.blurPx * model.blurPx;
  return s;
}

}  // namespace

const char* nameOf(BackgroundKind kind) {
  switch (kind) {
    case BackgroundKind::None: return "none";
    case BackgroundKind::Cosine: return "cosine";
    case BackgroundKind::SlopedCosine: return "sloped cosine";
    case BackgroundKind::Quadratic: return "quadratic";
  }
  return "";
}

Outcome<std::vector<PatchSolution>> solvePatches(const std::vector<const PixelPatch*>& patches, const LobeModel& model,
                                                 BackgroundKind background) {
  const patch::Normalised n = patch::normalised(patches);
  require(n.frames.size() == 1, "solvePatches: patches of one frame");
  Pixels pixels(n, model.lobe, background);
  const State at = stateOf(model, n);
  pixels.chooseRule(at);
  std::vector<double> residuals(static_cast<std::size_t>(pixels.residuals()));
  if (!pixels.residualsAt(at, residuals.data()) || !pixels.solutions()[0].solved)
    return Failure{Reason::NoBrightestPoint, "the lobe does not reach the pixels around the highlight"};
  PixelFit fit;
  describeResiduals(pixels, fit);
  const patch::LinearFit& solved = pixels.solutions()[0];
  const int each = patch::coefficientsOf(background);
  std::vector<PatchSolution> result;
  for (std::size_t k = 0; k < n.frames[0].patches.size(); ++k) {
    PatchSolution s;
    s.strength = solved.coefficients(0);
    const LobeImage& image = pixels.images()[0];
    const PixelPatch::Seen& top = patches[image.topPatch]->seen[image.topCell];
    s.topPoint = SurfacePoint{top.position, top.normal};
    s.background = patch::backgroundOf(n.frames[0].patches[k], n.frames[0], background, at,
                                       solved.coefficients.segment(1 + each * static_cast<Eigen::Index>(k), each));
    s.relativeRms = fit.relativeRms[k];
    result.push_back(std::move(s));
  }
  return result;
}

Outcome<PixelFit> fitPixels(const std::vector<Lobe>& lobes, const std::vector<const PixelPatch*>& patches, const Light& light,
                            double roughness, const PixelFitOptions& options) {
  require(!lobes.empty() && roughness > 0 && std::isfinite(roughness), "fitPixels: lobes and roughness");
  const patch::Normalised fine = patch::normalised(patches);
  if (fine.cells < 30) return Failure{Reason::TooFewPoints, "only " + std::to_string(fine.cells) + " pixels can be used"};
  std::vector<PixelPatch> coarse;
  for (const PixelPatch* p : patches) {
    coarse.push_back(p->usedCells() > 400 ? patch::coarsened(*p) : *p);
    if (!(coarse.back().top > 0)) coarse.back() = *p;
  }
  std::vector<const PixelPatch*> coarsePointers;
  for (const PixelPatch& p : coarse) coarsePointers.push_back(&p);
  const patch::Normalised search = patch::normalised(coarsePointers);

  LobeModel first{lobes.front(), roughness, light, 0, 0};
  int iterations = 0;
  struct Candidate {
    Lobe lobe;
    BackgroundKind kind;
    Attempt attempt;
    double criterion;
  };
  std::vector<Candidate> candidates;
  const auto tryOut = [&](Lobe lobe, BackgroundKind kind, const State& from) {
    Pixels pixels(search, lobe, kind);
    const Attempt a = solve(pixels, from, {false, false, from.light.w() == 0}, options.maxIterations, kSearchTolerance, kSearchTolerance);
    iterations += a.iterations;
    if (std::isfinite(a.cost)) candidates.push_back({lobe, kind, a, criterion(a, search, kind)});
  };
  const auto least = [&](const auto& of) {
    const Candidate* best = nullptr;
    for (const Candidate& c : candidates)
      if (of(c) && (!best || c.criterion < best->criterion)) best = &c;
    return best;
  };
  // The kind of background with the lobe that is asked for first, each from the start; then all lobes with the kinds that compete.
  const State start = stateOf(first, search);
  for (const Lobe lobe : lobes) {
    const Candidate* best = least([](const Candidate&) { return true; });
    const State from = best ? best->attempt.at : start;
    for (const BackgroundKind kind :
         {BackgroundKind::None, BackgroundKind::Cosine, BackgroundKind::SlopedCosine, BackgroundKind::Quadratic})
      tryOut(lobe, kind, from);
  }
  const Candidate* best = least([](const Candidate&) { return true; });
  if (!best) return Failure{Reason::NotConverged, "no lobe reaches the pixels from the contours' light"};
  // Every lobe once more from the best light: a start far off may have held one back.
  const Candidate leader = *best;  // `candidates` grows
  if (lobes.size() > 1)
    for (const Lobe lobe : lobes)
      if (lobe != leader.lobe) tryOut(lobe, leader.kind, leader.attempt.at);
  best = least([](const Candidate&) { return true; });
  const Candidate* microfacet = least([](const Candidate& c) { return isMicrofacet(c.lobe); });
  if (microfacet && microfacet->attempt.cost <= (1 + kMicrofacetMargin) * best->attempt.cost) best = microfacet;
  const Candidate chosen = *best;

  // In full, then with a blur and a size where they show.
  Pixels pixels(fine, chosen.lobe, chosen.kind);
  State from = chosen.attempt.at;
  {
    const Light world = inWorld(from, search);
    from.light = patch::normalisedLight(world, fine);
  }
  Free free{false, false, from.light.w() == 0};
  Attempt a = solve(pixels, from, free, options.maxIterations, kTolerance, kCostTolerance);
  iterations += a.iterations;
  if (!std::isfinite(a.cost)) return Failure{Reason::NotConverged, "pixels"};
  const auto improve = [&](const Free& with, const State& at, int most) {
    const Attempt b = solve(pixels, at, with, most, kTolerance, kCostTolerance);
    iterations += b.iterations;
    if (!(b.cost < (1 - kClearGain) * a.cost)) return;
    a = b;
    free = with;
  };
  if (options.blur) {
    State blurred = a.at;
    blurred.blurVariance = 1;
    improve({false, true, free.atInfinity}, blurred, options.maxIterations);
  }
  if (options.lightSize && !free.atInfinity && a.at.light.w() > 0) {
    State sized = a.at;
    const double distance = a.at.light.head<3>().norm() / a.at.light.w();
    sized.radiusSquared = std::pow(0.5 * std::exp(a.at.logRoughness) * distance, 2);
    improve({true, free.blur, false}, sized, kSizeIterations);
  }
  PixelFit fit;
  fit.model = {chosen.lobe, std::exp(a.at.logRoughness), inWorld(a.at, fine), fine.scale * std::sqrt(std::max(0.0, a.at.radiusSquared)),
               std::sqrt(std::max(0.0, a.at.blurVariance))};
  fit.background = chosen.kind;
  fit.cost = a.cost;
  fit.cells = static_cast<int>(fine.cells);
  fit.iterations = iterations;
  pixels.chooseRule(a.at);
  std::vector<double> residuals(fine.cells);
  if (!pixels.residualsAt(a.at, residuals.data())) return Failure{Reason::NotConverged, "pixels"};
  describeResiduals(pixels, fit);
  describeUncertainty(pixels, a, free, fit);
  return fit;
}

}  // namespace glint
