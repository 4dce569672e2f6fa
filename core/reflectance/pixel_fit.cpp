// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/pixel_fit.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/reflectance/added_lobe.h"
#include "core/reflectance/pixel_problem.h"

namespace glint {
namespace {

using patch::FramePatches;
using patch::PixelProblem;

constexpr double kSearchTolerance = 1e-4;   // of fits that only choose a start or a background
constexpr double kMicrofacetMargin = 0.02;  // of the cost, by which a cosine power must be better than a microfacet lobe
constexpr double kClearGain = 0.1;          // of the cost, before an extent or a blur is believed
// Gain of the cost over its mean per independent cell, by up to three more parameters. Noise alone exceeds this in one of a
// million images (chi squared, three degrees of freedom).
constexpr double kBeyondNoise = 30;
constexpr std::size_t kCoarseFrom = 400;  // cells of a patch, from which the search takes a quarter of them
constexpr std::size_t kFewestFrom = 100;  // and below which no lamp is worth joining more
constexpr double kMostEvaluations = 2e5;  // of an extended lamp's lobe in one look at all cells: some hundredths of a second
constexpr double kExtentWork = 1.5e7;     // such evaluations in all: a lamp that explains the pixels takes about ten iterations

/// Patches, some of them with joined cells, as one problem.
class Cells {
 public:
  explicit Cells(const std::vector<const PixelPatch*>& patches) : pointers_(patches), all_(patch::normalised(patches)) {}
  Cells(const Cells&) = delete;
  Cells& operator=(const Cells&) = delete;
  const patch::Normalised& all() const { return all_; }

  /// Joins 2 x 2 cells of every patch with more than `from` of them; false where none has.
  bool coarsen(std::size_t from = kCoarseFrom) {
    bool any = false;
    for (const PixelPatch*& p : pointers_) {
      if (p->usedCells() <= from) continue;
      PixelPatch coarse = patch::coarsened(*p);
      if (!(coarse.top > 0)) continue;
      owned_.push_back(std::move(coarse));
      p = &owned_.back();
      any = true;
    }
    if (any) all_ = patch::normalised(pointers_);
    return any;
  }

 private:
  std::deque<PixelPatch> owned_;
  std::vector<const PixelPatch*> pointers_;
  patch::Normalised all_;
};

/// Bayesian information criterion of a fit to n cells, up to a constant.
double criterion(const patch::Attempt& a, const patch::Normalised& evidence, BackgroundKind kind) {
  double unknowns = 4;
  for (const FramePatches& f : evidence.frames) unknowns += 1 + patch::coefficientsOf(kind) * double(f.patches.size());
  const double n = static_cast<double>(evidence.cells);
  // 1e-14: single precision of the images, squared, with some reserve.
  return n * std::log(a.cost / n + 1e-14) + unknowns * std::log(n);
}

Lamp inWorld(const patch::State& at, const patch::Normalised& n) { return fromNormalised(at.lamp, n.origin, n.scale); }

patch::State stateOf(const LobeModel& model, const patch::Normalised& n) {
  const double logRatio = hasTwoWidths(model.lobe) ? std::log(model.roughness.ratio) : 0;
  return {{normalised(model.lamp, n.origin, n.scale), std::log(model.roughness.mean), logRatio}, model.blurVariance};
}

/// Evaluations of the lobe in one look at all cells.
double evaluationsOf(const LobeModel& model, const patch::Normalised& evidence) {
  PixelProblem trial(evidence, model.lobe, BackgroundKind::None);
  trial.chooseRule(stateOf(model, evidence));
  return trial.evaluations();
}

/// The search over lobes and kinds of background, on coarse cells.
class Search {
 public:
  Search(const patch::Normalised& evidence, const PixelFitOptions& options) : evidence_(evidence), options_(options) {}

  struct Candidate {
    Lobe lobe;
    BackgroundKind kind;
    patch::Attempt attempt;
    double criterion;
  };

  /// The kinds of background with the lobe that comes first; then all lobes with all kinds, each from the best so far, and once
  /// more from the best of all: a start far off may have held one back. Nothing where no lobe reaches the pixels.
  std::optional<Candidate> run(const std::vector<Lobe>& lobes, const patch::State& start) {
    for (const Lobe lobe : lobes) {
      const Candidate* best = least([](const Candidate&) { return true; });
      const patch::State from = best ? best->attempt.at : start;
      for (const BackgroundKind kind : {BackgroundKind::None, BackgroundKind::Cosine, BackgroundKind::AmbientCosine,
                                        BackgroundKind::SlopedCosine, BackgroundKind::Quadratic})
        // A lamp with an extent takes long: the first lobe tells which backgrounds compete.
        if ((!options_.background || kind == *options_.background) && (!best || start.lamp.isPoint() || kind == best->kind))
          tryOut(lobe, kind, from);
    }
    const Candidate* best = least([](const Candidate&) { return true; });
    if (!best) return std::nullopt;
    const Candidate leader = *best;  // the list grows
    for (const Lobe lobe : lobes)
      if (lobe != leader.lobe && start.lamp.isPoint()) tryOut(lobe, leader.kind, leader.attempt.at);
    best = least([](const Candidate&) { return true; });
    const Candidate* microfacet = least([](const Candidate& c) { return isMicrofacet(c.lobe); });
    if (microfacet && microfacet->attempt.cost <= (1 + kMicrofacetMargin) * best->attempt.cost) best = microfacet;
    return *best;
  }
  int iterations() const { return iterations_; }

 private:
  void tryOut(Lobe lobe, BackgroundKind kind, const patch::State& from) {
    PixelProblem problem(evidence_, lobe, kind);
    patch::SolveOptions solving{false, options_.maxIterations, kSearchTolerance, kSearchTolerance};
    solving.progress = options_.progress;
    solving.holdLamp = options_.holdLamp;
    if (!from.lamp.isPoint()) {
      solving.mostEvaluations = kMostEvaluations;
      solving.work = kExtentWork;
    }
    const patch::Attempt a = patch::solve(problem, from, solving);
    iterations_ += a.iterations;
    if (std::isfinite(a.cost)) candidates_.push_back({lobe, kind, a, criterion(a, evidence_, kind)});
  }
  template <class F>
  const Candidate* least(const F& of) const {
    const Candidate* best = nullptr;
    for (const Candidate& c : candidates_)
      if (of(c) && (!best || c.criterion < best->criterion)) best = &c;
    return best;
  }

  const patch::Normalised& evidence_;
  const PixelFitOptions& options_;
  int iterations_ = 0;
  std::vector<Candidate> candidates_;
};

}  // namespace

const char* nameOf(BackgroundKind kind) {
  switch (kind) {
    case BackgroundKind::None: return "none";
    case BackgroundKind::Cosine: return "cosine";
    case BackgroundKind::AmbientCosine: return "cosine with ambient";
    case BackgroundKind::SlopedCosine: return "sloped cosine";
    case BackgroundKind::Quadratic: return "quadratic";
  }
  return "";
}

Outcome<std::vector<PatchSolution>> solvePatches(const std::vector<const PixelPatch*>& patches, const LobeModel& model,
                                                 BackgroundKind background) {
  const patch::Normalised n = patch::normalised(patches);
  require(n.frames.size() == 1, "solvePatches: patches of one frame");
  PixelProblem pixels(n, model.lobe, background);
  const patch::State at = stateOf(model, n);
  pixels.chooseRule(at);
  std::vector<double> residuals(static_cast<std::size_t>(pixels.residuals()));
  if (!pixels.residualsAt(at, residuals.data()) || !pixels.solutions()[0].solved)
    return Failure{Reason::NoBrightestPoint, "the lobe does not reach the pixels around the highlight"};
  PixelFit fit;
  patch::describeResiduals(pixels, fit);
  const patch::LinearFit& solved = pixels.solutions()[0];
  const int each = patch::coefficientsOf(background);
  std::vector<PatchSolution> result;
  for (std::size_t k = 0; k < n.frames[0].patches.size(); ++k) {
    PatchSolution s;
    s.strength = solved.coefficients(0);
    const patch::LobeImage& image = pixels.images()[0];
    const PixelPatch::Seen& top = patches[image.topPatch]->seen[image.topCell];
    s.topPoint = SurfacePoint{top.position, top.axes.normal};
    s.background = patch::backgroundOf(n.frames[0].patches[k], n.frames[0], background, at,
                                       solved.coefficients.segment(1 + each * static_cast<Eigen::Index>(k), each));
    s.lobe = image.value[k];
    s.relativeRms = fit.relativeRms[k];
    result.push_back(std::move(s));
  }
  return result;
}

bool asksForExtent(const PixelFit& point) {
  return point.patterned || point.gainByExtent > kClearGain || point.gainByExtent * point.independentCells > kBeyondNoise;
}

bool explainsClearlyBetter(const PixelFit& larger, const PixelFit& smaller) {
  if (larger.cost < (1 - kClearGain) * smaller.cost) return true;
  // The smaller lamp was fitted to all cells, the larger one perhaps to joined ones: its count would be theirs.
  return (smaller.cost - larger.cost) / larger.cost * smaller.independentCells > kBeyondNoise;
}

namespace {

/// Fewer cells for the search: a lamp with an extent, wide beside its lobe, takes many evaluations a cell.
void coarsenForSearch(Cells& cells, const LobeModel& start) {
  cells.coarsen();
  if (start.lamp.isPoint()) return;
  while (cells.coarsen()) {
  }
  while (evaluationsOf(start, cells.all()) > kMostEvaluations && cells.coarsen(kFewestFrom)) {
  }
}

/// Lobe, background and a better start from coarse cells. @param fit  gets background and iterations. False where no lobe reaches
/// the pixels.
bool searchStart(const std::vector<const PixelPatch*>& patches, const std::vector<Lobe>& lobes, const PixelFitOptions& options,
                 LobeModel& start, PixelFit& fit) {
  Cells coarse(patches);
  coarsenForSearch(coarse, start);
  const patch::Normalised& few = coarse.all();
  Search search(few, options);
  const std::optional<Search::Candidate> chosen = search.run(lobes, stateOf(start, few));
  if (!chosen) return false;
  const patch::State found = chosen->attempt.at;
  start = {chosen->lobe, found.roughness(), inWorld(found, few), 0};
  fit.background = chosen->kind;
  fit.iterations = search.iterations();
  return true;
}

struct FullFit {
  patch::Attempt attempt;
  bool blur = false;  ///< shows
};

/// In full, as far as an extended lamp lets it, then with a blur where it shows. @param iterations  are added
FullFit solveInFull(PixelProblem& problem, const patch::State& start, const PixelFitOptions& options, int& iterations) {
  const bool point = start.lamp.isPoint();
  patch::SolveOptions solving{false, options.maxIterations};
  solving.progress = options.progress;
  solving.holdLamp = options.holdLamp;
  if (!point) {
    solving.mostEvaluations = 4 * kMostEvaluations;  // it may grow a little more
    solving.work = kExtentWork;
  }
  FullFit fit{patch::solve(problem, start, solving)};
  iterations += fit.attempt.iterations;
  if (!std::isfinite(fit.attempt.cost) || !options.blur || !(point || fit.attempt.converged)) return fit;
  patch::State blurred = fit.attempt.at;
  blurred.blurVariance = 1;
  solving.blur = true;
  const patch::Attempt b = patch::solve(problem, blurred, solving);
  iterations += b.iterations;
  fit.blur = b.cost < (1 - kClearGain) * fit.attempt.cost;
  if (fit.blur) fit.attempt = b;
  return fit;
}

/// What a model leaves in all pixels, so that fits can be compared. False where its lobe does not reach them.
bool describeAllPixels(const std::vector<const PixelPatch*>& patches, PixelFit& fit) {
  const patch::Normalised whole = patch::normalised(patches);
  PixelProblem problem(whole, fit.model.lobe, fit.background);
  const patch::State at = stateOf(fit.model, whole);
  problem.chooseRule(at);
  std::vector<double> residuals(whole.cells);
  if (!problem.residualsAt(at, residuals.data())) return false;
  fit.cost = 0;
  for (const double r : residuals) fit.cost += r * r;
  fit.cells = static_cast<int>(whole.cells);
  patch::describeResiduals(problem, fit);
  return true;
}

}  // namespace

Outcome<PixelFit> fitPixels(const std::vector<Lobe>& lobes, const std::vector<const PixelPatch*>& patches, const Lamp& lamp,
                            const Roughness& roughness, const PixelFitOptions& options) {
  require(!lobes.empty() && roughness > 0 && std::isfinite(roughness.mean), "fitPixels: lobes and roughness");
  require(!options.near || (options.background && lobes.size() == 1), "fitPixels: a fit nearby has a lobe and a background");
  Cells full(patches);
  if (full.all().cells < 30)
    return Failure{Reason::TooFewPoints, "only " + std::to_string(full.all().cells) + " pixels can be used"};
  PixelFit fit;
  LobeModel start{lobes.front(), roughness, lamp, 0};
  if (options.near) {
    fit.background = *options.background;
  } else if (!searchStart(patches, lobes, options, start, fit)) {
    return Failure{Reason::NotConverged, "no lobe reaches the pixels from the contours' light"};
  }
  while (!lamp.isPoint() && evaluationsOf(start, full.all()) > kMostEvaluations &&
         (full.coarsen() || full.coarsen(kFewestFrom))) {
  }
  const patch::Normalised& fine = full.all();
  PixelProblem problem(fine, start.lobe, fit.background);
  const FullFit best = solveInFull(problem, stateOf(start, fine), options, fit.iterations);
  const patch::State& at = best.attempt.at;
  if (!std::isfinite(best.attempt.cost)) return Failure{Reason::NotConverged, "pixels"};
  fit.model = {start.lobe, at.roughness(), options.holdLamp ? lamp : inWorld(at, fine), at.blurVariance};
  if (!describeAllPixels(patches, fit)) return Failure{Reason::NotConverged, "pixels"};
  // The cells that were fitted say how well: joined ones hold the same evidence.
  problem.chooseRule(at);
  std::vector<double> fitted(fine.cells);
  if (!problem.residualsAt(at, fitted.data())) return Failure{Reason::NotConverged, "pixels"};
  patch::describeUncertainty(problem, at, {best.blur, options.holdLamp}, fit);
  return fit;
}

}  // namespace glint
