// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/number_text.h"
#include "core/base/stage_times.h"
#include "core/choice/choice_ground.h"
#include "core/choice/surface_assumption.h"

namespace glint {
namespace {

/// A frame that is to be predicted shows a surface of the scene file that no training view shows. Depth maps are one object seen
/// from many sides, so they do not count.
bool predictsOtherSurfaces(const Inspection& inspection) {
  if (inspection.train.perSurface) return false;
  std::set<std::string> seen;
  const std::vector<Frame>& frames = inspection.scene->frames;
  for (const TrainingView& v : inspection.views) seen.insert(frames[v.frame].surface);
  for (int f = 0; f < static_cast<int>(frames.size()); ++f)
    if (inspection.isHeldOut(f) && !frames[f].surface.empty() && !seen.count(frames[f].surface)) return true;
  return false;
}

double atLeastNegligible(double pct) { return std::max(kNegligiblePct, pct); }

/// A candidate whose fit to all views failed.
Candidate untried(const HighlightModel& model, int views) {
  Candidate c;
  c.model = model.id();
  c.views = views;
  c.meanPct = c.standardErrorPct = c.predictUs = std::nan("");
  return c;
}

/// Where the chosen model has to predict: at most this many views tell.
constexpr std::size_t kViewsShown = 8;

/// The search, step by step; see selectModel.
class Search {
 public:
  /// @param poor  whether fits that explain their views badly count as answers: the choice is then poor
  Search(ChoiceGround& ground, const std::optional<double>& goodEnoughPct, PoorFits poor, const ProgressFn& progress)
      : ground_(ground),
        goodEnough_(goodEnoughPct),
        poor_(poor),
        progress_(progress),
        settings_(ground.inspection.request.settings) {}

  Selection run();

 private:
  struct Tried {
    const HighlightModel* model = nullptr;
    std::vector<Answer> answers;
    bool bound = false, eligible = false;
    std::map<std::string, Outcome<ModelFit>> fits;  ///< by light, to all training views
    std::optional<Outlook> outlook;                 ///< see lookAt()
    bool ellipsoid = false;                         ///< of one shape; not traced on the surface
    std::string contradiction;                      ///< by the surface, in words
    bool confirmed = false;                         ///< by the surface: the assumption holds as far as contours resolve
    std::vector<double> aheadPct;                   ///< per view to predict: spread and disagreement; NaN where nothing predicts
  };

  double mostPct() const { return poor_ == PoorFits::Take ? kLargestPoorPct : kLargestExpectedPct; }
  double ranked(std::size_t m) const { return rankedPct(tried_[m].answers, known_.possible); }
  std::string errorText(std::size_t m) const;
  void tryNext(const HighlightModel& model);
  std::optional<Failure> fitWhole(Tried& t);
  void lookAt(std::size_t m);
  SurfaceShape shapeUnder(std::size_t m);
  bool meetsTolerance(std::size_t m);
  std::vector<std::vector<PredictedHighlight>> witness();
  void checkAssumption(std::size_t m, const SurfaceShape& shape);
  void compareOutlooks(const std::vector<std::size_t>& plausible);
  double leftOutPct(std::size_t m) const;
  void expect(std::size_t m);
  void choose(std::size_t m, double mostPct);
  std::string whereText() const;
  /// The reasons for the choice once all models were tried.
  struct Decision {
    std::size_t best = 0;                ///< least ranked error, and the surface does not contradict it
    std::vector<std::size_t> plausible;  ///< as good in leave-one-out, from simple to rich
    double slackPct = kNegligiblePct;    ///< what they may be worse by
    std::size_t choice = 0;
    bool ahead = false;  ///< the views to predict decided
  };
  std::optional<std::size_t> best(bool allowedBySurface) const;
  void addRemark(std::size_t m, const std::string& text);
  std::string whyNoAnswer() const;
  bool chooseUnderTolerance();
  bool heedContradictions(Decision& d);
  void findPlausible(Decision& d);
  void compareAhead(Decision& d);
  std::string whyRefused(std::size_t choice) const;
  std::string whyChosen(const Decision& d) const;
  void decide();

  ChoiceGround& ground_;
  const std::optional<double>& goodEnough_;
  const PoorFits poor_;
  const ProgressFn& progress_;
  const Settings& settings_;
  const Inspection& inspection_ = ground_.inspection;
  std::vector<Fold>& folds_ = ground_.folds;
  const std::vector<ViewToPredict>& views_ = ground_.views;
  Selection s_;
  SurfaceShape trained_;  ///< under the training highlights
  std::vector<Tried> tried_;
  RankingSoFar known_;
  double noisePct_ = 0;  ///< of the observed contours
};

std::string Search::errorText(std::size_t m) const {
  const Candidate& c = s_.candidates[m];
  return percentText(ranked(m)) + (ranked(m) != c.meanPct && c.answered < c.tried ? " (a missing view counts as 100 %)" : "");
}

void Search::choose(std::size_t m, double mostPct) {
  s_.candidates[m].remark = "chosen" + (s_.candidates[m].remark.empty() ? "" : "; " + s_.candidates[m].remark);
  s_.model = s_.best = s_.candidates[m].model;
  s_.poor = poor_ == PoorFits::Take;
  s_.patches = choosePatches(inspection_, *tried_[m].model, folds_, tried_[m].answers, mostPct, progress_);
}

std::string Search::whereText() const {
  if (s_.outside == 0) return "the views to predict lie among the training views";
  double farthest = 0, tested = 0;
  for (const ViewToPredict& v : views_)
    if (v.outside) farthest = std::max(farthest, v.distanceDeg), tested = std::max(tested, v.testedDeg);
  return formatted(
      "%d of %d views to predict lie outside the training views (up to %.3g degrees from the nearest; leave-one-out "
      "tests up to %.2g)",
      s_.outside, s_.toPredict, farthest, tested);
}

/// Fits the model to all views where there are views to predict. @return why one fit failed: then it cannot be chosen
std::optional<Failure> Search::fitWhole(Tried& t) {
  if (t.model->needsLight()) ground_.findLights(progress_);
  if (t.model->takesPixels()) ground_.fitPixels(progress_);
  if (views_.empty()) return std::nullopt;
  const std::string stage = "leave one out " + t.model->id();
  const ProgressFn goOn = [&](const StageEvent&) { return report(progress_, {stage, 0, s_.leftOut}); };
  for (auto& [light, fold] : ground_.whole) {
    if (!goOn({})) throw Stopped{};
    const Outcome<ModelFit>& fit = t.fits.emplace(light, fitFold(fold, *t.model, settings_, poor_, goOn)).first->second;
    if (!fit) return fit.failure();
    t.ellipsoid = t.ellipsoid || fit->as<EllipsoidFit>();
  }
  return std::nullopt;
}

void Search::tryNext(const HighlightModel& model) {
  const std::size_t m = tried_.size();
  tried_.emplace_back();
  Tried& t = tried_.back();
  t.model = &model;
  t.answers.resize(folds_.size());
  const Clock::time_point start = Clock::now();
  const std::optional<Failure> failure = fitWhole(t);
  s_.candidates.push_back(failure ? untried(model, s_.leftOut)
                                  : tryModel(inspection_, model, folds_, t.answers, known_, poor_, progress_));
  Candidate& c = s_.candidates.back();
  c.timeUs = microsecondsSince(start);
  t.bound = predictsOtherSurfaces(inspection_) &&
            std::any_of(t.answers.begin(), t.answers.end(), [](const Answer& a) { return a.boundToSurface; });
  t.eligible = !t.bound && c.answered > 0 && c.tried == c.views;
  for (std::size_t i = 0; i < folds_.size(); ++i)
    if (t.answers[i].errorPct) known_.possible[i] = 1;
  if (failure)
    c.remark = "no view was left out, as the fit to all of them fails: " + failure->message();
  else if (t.bound)
    c.remark =
        "not eligible: frames to predict show surfaces that no training view shows, and its ellipsoid belongs to the surface "
        "it was fitted on";
  else if (c.tried < c.views)
    c.remark = "given up after " + std::to_string(c.tried) + " views: already worse than the best" +
               (c.remark.empty() ? "" : "; " + c.remark);
  // What the surface contradicts shall not keep others from being tried.
  if (!goodEnough_) checkAssumption(m, trained_);
  known_.best = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e <= m; ++e)
    if (tried_[e].eligible && tried_[e].contradiction.empty()) {
      const double error = s_.candidates[e].standardErrorPct;
      known_.best = std::min(known_.best, ranked(e) + atLeastNegligible(std::isfinite(error) ? error : 0));
    }
}

/// What an eligible model says of the views to predict. That takes as long as its fits, so only who asks pays for it.
void Search::lookAt(std::size_t m) {
  Tried& t = tried_[m];
  if (views_.empty() || t.outlook) return;
  t.outlook = lookAhead(*t.model, t.fits, ground_.whole, folds_, t.answers, views_, settings_, progress_);
  s_.candidates[m].timeUs += t.outlook->timeUs;
}

/// The surface under the training highlights and under those that this model predicts.
SurfaceShape Search::shapeUnder(std::size_t m) {
  lookAt(m);
  std::vector<HighlightOnSurface> highlights;
  for (const Fold& f : folds_) highlights.push_back({f.left.camera, f.leftSurface, f.left.highlight.contour});
  if (const std::optional<Outlook>& outlook = tried_[m].outlook)
    for (std::size_t v = 0; v < views_.size(); ++v)
      for (const PredictedHighlight& h : outlook->predictions[v])
        highlights.push_back({views_[v].camera, views_[v].surface, h.contour});
  return surfaceShape(highlights);
}

void Search::checkAssumption(std::size_t m, const SurfaceShape& shape) {
  Tried& t = tried_[m];
  if (shape.highlights == 0) return;
  const ModelTraits::Assumes assumed = t.model->traits().surface;
  t.contradiction.clear();
  if (assumed == ModelTraits::Assumes::Plane) {
    t.confirmed = shape.bend <= kPlaneBend;
    if (shape.bend > kNoPlaneBend)
      t.contradiction = "it needs a plane, but the surface accounts for " + percentText(100 * shape.bend) + " of the limit angle";
  } else if (assumed == ModelTraits::Assumes::ConstantCurvature && shape.curvatureChange > kNotConstantCurvature) {
    t.contradiction = "it needs nearly constant curvature, but the curvature under the highlights varies by " +
                      percentText(100 * shape.curvatureChange);
  }
}

/// What the model that assumes least, fitted to all training views, predicts in every view to predict.
std::vector<std::vector<PredictedHighlight>> Search::witness() {
  std::vector<std::vector<PredictedHighlight>> predictions(views_.size());
  const HighlightModel& levelSet = levelSetModel();
  for (auto& [light, fold] : ground_.whole)
    if (const Outcome<ModelFit> fit = fitFold(fold, levelSet, settings_, poor_))
      for (std::size_t v = 0; v < views_.size(); ++v)
        if (views_[v].light == light)
          predictions[v] = levelSet.predict(*fit, views_[v].camera, views_[v].surface.get(), settings_).highlights();
  return predictions;
}

/// Leaving one out, and what it cannot see.
bool Search::meetsTolerance(std::size_t m) {
  const Candidate& c = s_.candidates[m];
  Tried& t = tried_[m];
  if (!t.eligible || c.answered < c.views || !(c.meanPct <= *goodEnough_)) return false;
  lookAt(m);
  if (s_.outside == 0) return true;
  const auto levelSet = t.ellipsoid ? witness() : std::vector<std::vector<PredictedHighlight>>(views_.size());
  double sum = 0;
  int count = 0;
  t.aheadPct.assign(views_.size(), 0);  // among the training views leaving one out has told
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (!views_[v].outside) continue;
    double squares = std::pow(t.outlook->spreadPct[v], 2);
    if (!levelSet[v].empty()) squares += std::pow(differencePct(t.outlook->predictions[v], levelSet[v]), 2);
    t.aheadPct[v] = std::sqrt(squares);
    sum += squares;
    ++count;
  }
  const double aheadPct = count ? std::sqrt(sum / count) : 0;
  s_.candidates[m].outlookPct = aheadPct;
  if (aheadPct <= *goodEnough_) return true;
  s_.candidates[m].remark =
      "under the tolerance in leave-one-out, but its predictions outside the training views are uncertain by " +
      percentText(aheadPct);
  return false;
}

/// Spread and disagreement of every model that can still be chosen, in every view to predict.
void Search::compareOutlooks(const std::vector<std::size_t>& plausible) {
  // Contours traced on the surface assume least. Where no such model explains the training views, the best one is all there is.
  std::vector<std::size_t> references;
  for (const std::size_t m : plausible) lookAt(m);
  for (const std::size_t r : plausible)
    if (!tried_[r].ellipsoid) references.push_back(r);
  if (references.empty())
    references.push_back(*std::min_element(plausible.begin(), plausible.end(),
                                           [&](std::size_t a, std::size_t b) { return ranked(a) < ranked(b); }));
  for (const std::size_t m : plausible) {
    Tried& t = tried_[m];
    t.aheadPct.assign(views_.size(), std::nan(""));
    double spreads = 0, disagreements = 0;
    int count = 0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      bool predicted = !t.outlook->predictions[v].empty();
      for (const std::size_t r : references) predicted = predicted || !tried_[r].outlook->predictions[v].empty();
      if (!predicted) continue;
      const double spread = t.outlook->spreadPct[v];
      double weights = 0, weighted = 0;
      for (const std::size_t r : references) {
        if (r <= m) continue;  // a simpler model does not contradict a richer one
        const double other = tried_[r].outlook->spreadPct[v];
        const double d = differencePct(t.outlook->predictions[v], tried_[r].outlook->predictions[v]);
        const double w = 1 / std::pow(atLeastNegligible(other), 2);
        // A richer model that is itself less certain says less against one that is traced on the surface too.
        const double counts =
            t.ellipsoid ? 1 : std::min(1.0, 2 * std::pow(atLeastNegligible(spread) / atLeastNegligible(other), 2));
        weighted += w * counts * d * d;
        weights += w;
      }
      const double squares = weights > 0 && !t.confirmed ? weighted / weights : 0;
      t.aheadPct[v] = std::sqrt(spread * spread + squares);
      spreads += spread * spread;
      disagreements += squares;
      ++count;
    }
    Candidate& c = s_.candidates[m];
    if (count == 0) continue;
    c.spreadPct = std::sqrt(spreads / count);
    c.disagreementPct = std::sqrt(disagreements / count);
    c.outlookPct = std::sqrt((spreads + disagreements) / count);
  }
}

/// What leaving one out shows without the noise of the left-out contours.
double Search::leftOutPct(std::size_t m) const {
  return std::sqrt(std::max(0.0, std::pow(ranked(m), 2) - std::pow(noisePct_, 2)));
}

void Search::expect(std::size_t m) {
  Tried& t = tried_[m];
  Candidate& c = s_.candidates[m];
  double common = leftOutPct(m);
  if (t.outlook && s_.trainingViews < kFewViews) {
    // A fit to one or two views less is another fit: what the fit to all leaves in the training views, and its own uncertainty.
    double sum = 0;
    for (const Fold& f : folds_) {
      const Answer a = predictLeft(f, *t.model, *t.outlook->fits.at(f.left.highlight.light), settings_);
      sum += a.countedPct() / double(folds_.size());
    }
    common = std::min(common, std::sqrt(std::max(0.0, sum * sum - noisePct_ * noisePct_)));
    // Nothing was left out that could tell how far the fit is from others: another model does.
    if (c.disagreementPct == 0 && t.model != &levelSetModel()) {
      const auto levelSet = witness();
      for (std::size_t v = 0; v < t.aheadPct.size(); ++v)
        if (!levelSet[v].empty())
          t.aheadPct[v] = std::hypot(t.aheadPct[v], differencePct(t.outlook->predictions[v], levelSet[v]));
    }
  }
  double squares = 0;
  int count = 0;
  for (std::size_t v = 0; v < t.aheadPct.size(); ++v) {
    if (std::isnan(t.aheadPct[v])) continue;
    const bool ahead = views_[v].outside || s_.trainingViews < kFewViews;
    // Among the training views both tell the same; the larger counts, because the noise of smooth contours may be overrated.
    squares += ahead ? common * common + t.aheadPct[v] * t.aheadPct[v] : std::pow(std::max(common, t.aheadPct[v]), 2);
    ++count;
  }
  c.expectedPct = count ? std::sqrt(squares / count) : common;
}

Selection Search::run() {
  s_.leftOut = static_cast<int>(folds_.size());
  double noise = 0;
  for (const Fold& f : folds_) noise += contourNoisePct(f.left.highlight.contour) / double(folds_.size());
  noisePct_ = noise;
  for (const TrainingView& v : inspection_.views) s_.trainingViews += v.seen ? 1 : 0;
  std::vector<HighlightOnSurface> observed;
  for (const Fold& f : folds_) observed.push_back({f.left.camera, f.leftSurface, f.left.highlight.contour});
  trained_ = surfaceShape(observed);
  s_.toPredict = static_cast<int>(views_.size());
  for (const ViewToPredict& v : views_) s_.outside += v.outside;
  known_.possible.assign(folds_.size(), 0);
  for (const auto& model : allModels()) {
    tryNext(*model);
    const std::size_t m = tried_.size() - 1;
    const Candidate& c = s_.candidates[m];
    if (goodEnough_) {
      if (!meetsTolerance(m)) continue;
      expect(m);
      if (!(s_.candidates[m].expectedPct <= mostPct())) continue;
      s_.why = "Simplest model under the stated tolerance of " + percentText(*goodEnough_) + ": " + c.model +
               " has a leave-one-view-out error of " + percentText(c.meanPct) + "; richer models were not tried.";
      s_.decidedBy = "leave-one-out";
      choose(m, *goodEnough_);
      return s_;
    }
    if (!tried_[m].eligible || c.answered < c.views || !(c.meanPct <= kNegligiblePct) ||
        model->traits().surface != ModelTraits::Assumes::Plane)
      continue;
    // On a plane such a model is exact; if its predictions are reproduced as well, contours can resolve nothing better.
    checkAssumption(m, shapeUnder(m));
    if (!tried_[m].confirmed) continue;
    if (!views_.empty()) compareOutlooks({m});
    if (views_.empty() || c.outlookPct <= kNegligiblePct) {
      expect(m);
      s_.why = c.model + " has a leave-one-view-out error of " + percentText(c.meanPct) +
               ", and the surface is a plane in every view as far as contours resolve (" + percentText(kNegligiblePct) +
               "), as this model assumes. Richer models were not tried: none could be better by more than that.";
      s_.decidedBy = "leave-one-out";
      choose(m, 2 * kNegligiblePct);
      return s_;
    }
  }
  decide();
  return s_;
}

std::optional<std::size_t> Search::best(bool allowedBySurface) const {
  std::optional<std::size_t> least;
  for (std::size_t m = 0; m < tried_.size(); ++m) {
    if (!tried_[m].eligible || (allowedBySurface && !tried_[m].contradiction.empty())) continue;
    if (!least || ranked(m) < ranked(*least)) least = m;
  }
  return least;
}

void Search::addRemark(std::size_t m, const std::string& text) {
  std::string& remark = s_.candidates[m].remark;
  remark = remark.empty() ? text : text + "; " + remark;
}

std::string Search::whyNoAnswer() const {
  const bool onePlace = std::all_of(folds_.begin(), folds_.end(), [](const Fold& f) { return f.others.empty(); });
  return s_.leftOut == 0 ? "No training view can be left out."
         : onePlace      ? "Leaving out a training view leaves nothing to fit: each fit has views from one place only."
                         : "No model predicted a left-out training view.";
}

/// Once more, now that it is known which views nothing answers: those tell nothing about the models.
bool Search::chooseUnderTolerance() {
  if (!goodEnough_ || s_.outside > 0) return false;
  for (std::size_t m = 0; m < tried_.size(); ++m) {
    if (!tried_[m].eligible || !(ranked(m) <= *goodEnough_)) continue;
    s_.why = "Simplest model under the stated tolerance of " + percentText(*goodEnough_) + ": " + s_.candidates[m].model +
             " has a leave-one-view-out error of " + percentText(ranked(m)) + " over the views that any model answers.";
    s_.decidedBy = "leave-one-out";
    choose(m, *goodEnough_);
    return true;
  }
  return false;
}

/// The best that the surface allows, unless it is much worse. @return false: refused
bool Search::heedContradictions(Decision& d) {
  // The surface under the training views and where the least assuming model that answered sees the highlights to come.
  std::size_t seen = d.best;
  for (std::size_t m = 0; m < tried_.size(); ++m)
    if (tried_[m].eligible && !tried_[m].ellipsoid && (tried_[seen].ellipsoid || ranked(m) < ranked(seen))) seen = m;
  const SurfaceShape shape = shapeUnder(seen);
  for (std::size_t m = 0; m < tried_.size(); ++m)
    if (tried_[m].eligible) checkAssumption(m, shape);
  const std::optional<std::size_t> allowed = best(true);
  Tried& first = tried_[d.best];
  if (!allowed) {
    s_.best = s_.candidates[d.best].model;
    s_.why = "Refused: the surface contradicts every model that answered. The best of them is " + s_.candidates[d.best].model +
             ": " + first.contradiction + ".";
    return false;
  }
  if (*allowed == d.best) return true;
  const ExcessError e = excessOf(tried_[*allowed].answers, first.answers, known_.possible);
  constexpr double kClear = 2;  // times as good, and standard errors
  if (ranked(*allowed) > kClear * atLeastNegligible(ranked(d.best)) && e.mean > kClear * e.standardError) {
    s_.candidates[d.best].remark =
        "kept although " + first.contradiction + ": every model that the surface allows has more than twice the error";
    first.contradiction.clear();
  } else {
    d.best = *allowed;
  }
  return true;
}

void Search::findPlausible(Decision& d) {
  for (std::size_t m = 0; m < tried_.size(); ++m) {
    if (!tried_[m].eligible) continue;
    if (!tried_[m].contradiction.empty()) {
      addRemark(m, "the surface contradicts it: " + tried_[m].contradiction);
      continue;
    }
    const ExcessError e = excessOf(tried_[m].answers, tried_[d.best].answers, known_.possible);
    if (e.mean > atLeastNegligible(e.standardError)) {
      addRemark(m, "worse than the best by " + percentText(e.mean) + " in leave-one-out");
    } else {
      d.plausible.push_back(m);
      d.slackPct = std::max(d.slackPct, e.standardError);
    }
  }
  d.choice = d.plausible.front();
}

/// The simplest of the plausible models whose outlook is as good as the best.
void Search::compareAhead(Decision& d) {
  if (views_.empty()) return;
  compareOutlooks(d.plausible);
  double least = std::numeric_limits<double>::infinity();
  std::size_t leastOf = d.choice;
  for (const std::size_t m : d.plausible)
    if (const double x = s_.candidates[m].outlookPct; x < least) least = x, leastOf = m;
  if (!std::isfinite(least)) return;
  d.choice = leastOf;
  for (const std::size_t m : d.plausible) {
    const double x = atLeastNegligible(s_.candidates[m].outlookPct) / atLeastNegligible(least);
    if (x <= kAsGood || (tried_[m].confirmed && x <= 2)) {
      d.choice = m;
      break;
    }
  }
  for (const std::size_t m : d.plausible)
    if (m < d.choice)
      addRemark(m, "in the views to predict it is uncertain by " + percentText(s_.candidates[m].outlookPct) + ", " +
                       s_.candidates[leastOf].model + " by " + percentText(least));
  d.ahead = d.choice != d.plausible.front();
}

std::string Search::whyRefused(std::size_t choice) const {
  const Candidate& c = s_.candidates[choice];
  return "Refused: the smallest expected error is " + percentText(c.expectedPct) + " of the diameter, of " + c.model +
         ", above the limit of " + percentText(mostPct()) + ". Its leave-one-view-out error is " + errorText(choice) +
         (s_.toPredict
              ? "; in the views to predict its contours are uncertain by " + percentText(c.outlookPct) + "; " + whereText()
              : "") +
         ".";
}

std::string Search::whyChosen(const Decision& d) const {
  const Candidate& c = s_.candidates[d.choice];
  const std::string slack = d.slackPct > kNegligiblePct ? "one standard error of the difference"
                                                        : "what contours resolve (" + percentText(kNegligiblePct) + ")";
  const std::string leftOut = d.choice == d.best
                                  ? c.model + " has the smallest leave-one-view-out error, " + errorText(d.choice)
                                  : c.model + " has a leave-one-view-out error of " + errorText(d.choice) + ", within " + slack +
                                        " of the best, " + s_.candidates[d.best].model + " with " + errorText(d.best);
  const std::string why =
      d.ahead ? "The views to predict decided: " + leftOut + "; there its contours are uncertain by " +
                    percentText(c.outlookPct) + ", those of simpler models by more than " +
                    percentText(kAsGood * atLeastNegligible(c.outlookPct)) + "; " + whereText()
              : "Simplest model that is as good as the best: " + leftOut + "; " + whereText() +
                    (std::isfinite(c.outlookPct) ? ", where its contours are uncertain by " + percentText(c.outlookPct) : "");
  return why + "." + (goodEnough_ ? " No model reached the stated tolerance of " + percentText(*goodEnough_) + "." : "");
}

void Search::decide() {
  const std::optional<std::size_t> first = best(false);
  if (!first) {
    s_.why = whyNoAnswer();
    return;
  }
  if (chooseUnderTolerance()) return;
  Decision d;
  d.best = *first;
  if (!heedContradictions(d)) return;
  findPlausible(d);
  compareAhead(d);
  for (const std::size_t m : d.plausible) expect(m);
  for (const std::size_t m : d.plausible)
    if (s_.candidates[d.choice].expectedPct > mostPct() && s_.candidates[m].expectedPct < s_.candidates[d.choice].expectedPct)
      d.choice = m;
  if (!(s_.candidates[d.choice].expectedPct <= mostPct())) {
    s_.best = s_.candidates[d.choice].model;
    s_.why = whyRefused(d.choice);
    return;
  }
  for (const std::size_t m : d.plausible)
    if (m > d.choice) addRemark(m, m == d.best ? "best, but a simpler one is as good" : "a simpler one is as good");
  s_.decidedBy = d.ahead || s_.outside > 0 ? "extrapolation" : "leave-one-out";
  s_.why = whyChosen(d);
  choose(d.choice, ranked(d.best) + d.slackPct);
}

double expectedPctOf(const Selection& s) {
  for (const Candidate& c : s.candidates)
    if (c.model == s.model) return c.expectedPct;
  return std::nan("");
}

}  // namespace

Selection selectModel(const Inspection& inspection, const std::optional<double>& goodEnoughPct, const ProgressFn& progress) {
  ChoiceGround ground(inspection, kViewsShown);
  Selection good = Search(ground, goodEnoughPct, PoorFits::Refuse, progress).run();
  if (!good.model.empty() || good.leftOut == 0) return good;
  Selection poor = Search(ground, goodEnoughPct, PoorFits::Take, progress).run();
  // The fits were made in the first search.
  for (std::size_t m = 0; m < poor.candidates.size() && m < good.candidates.size(); ++m)
    poor.candidates[m].timeUs += good.candidates[m].timeUs;
  if (!poor.model.empty())
    poor.why = formatted(
                   "Poor: no model explains its training views and is expected to be off by less than %g %%; this is the "
                   "best of what answers, expected to be off by %.3g %%. ",
                   kLargestExpectedPct, expectedPctOf(poor)) +
               poor.why;
  return poor;
}

InspectionRequest chosenRequest(InspectionRequest request, const Selection& selection) {
  request.models.clear();
  if (!selection.best.empty()) request.models.push_back(selection.best);
  if (selection.patches)
    request.settings.set("predict.query", std::string(selection.patches->goodEnough ? "local-quadric" : "exact"));
  return request;
}

}  // namespace glint
