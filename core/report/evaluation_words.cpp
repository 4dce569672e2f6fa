// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/evaluation_words.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/number_text.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/metrics.h"
#include "core/pipeline/summary.h"
#include "core/report/evaluation.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"

namespace glint {

namespace {

constexpr int kFewHighlights = 5;       // a mean of fewer says little about the next frame
constexpr double kStandsOut = 3;        // times the median: one frame that is nothing like the others
constexpr double kWhole = 0.98;         // coverage below which some contour has a gap that can be seen (36 directions by default)
constexpr std::size_t kMostUnused = 4;  // training frames with their reasons, before the rest is counted

using Summaries = std::vector<std::pair<std::string, ModelSummary>>;

std::string counted(int n, const std::string& what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }
std::string percent(double v) { return formatted("%.3g %%", v); }
std::string sentence(const std::string& text) { return text.empty() || text.back() == '.' ? text : text + "."; }

/// Held-out frames in which a model missed highlights, or predicted some that do not exist.
std::vector<int> framesWith(const Inspection& inspection, const std::string& model, int FrameScore::*count) {
  std::vector<int> frames;
  const std::vector<FrameScore> scores = frameScores(inspection.models.at(model), int(inspection.scene->frames.size()));
  for (int f = 0; f < int(scores.size()); ++f)
    if (inspection.isHeldOut(f) && scores[std::size_t(f)].*count > 0) frames.push_back(f);
  return frames;
}

std::string bestInWords(const Inspection& inspection, const std::string& model, const ModelSummary& s, bool alone) {
  const std::string scored = inspection.train.perSurface ? "" : "held-out ";
  std::string text = model + (alone ? ": its contours are off by " : " predicts best: its contours are off by ") +
                     percent(s.contourErrorPct.mean) +
                     formatted(" of a highlight's diameter on average (%.3g px), and by ", s.contourErrorPx.mean) +
                     percent(s.contourErrorPct.max) + " for the worst highlight. Of " +
                     counted(s.matched + s.missed, "highlight") + " in " +
                     counted(heldOutFrames(inspection).all, scored + "frame") + " it ";
  text += s.missed == 0 ? (s.matched == 1 ? "found it" : "found all")
                        : "missed " + std::to_string(s.missed) + " (" +
                              framesText(frameIds(*inspection.scene, framesWith(inspection, model, &FrameScore::missed))) + ")";
  return text + ", and it predicted " +
         (s.spurious == 0
              ? "none that is not there."
              : std::to_string(s.spurious) + (s.spurious == 1 ? " that is" : " that are") + " not there (" +
                    framesText(frameIds(*inspection.scene, framesWith(inspection, model, &FrameScore::spurious))) + ").");
}

/// The next best of those that answered, as bestModel() ranks them.
std::string runnerUp(const Summaries& models, const std::string& best) {
  Summaries others;
  for (const auto& entry : models)
    if (entry.first != best) others.push_back(entry);
  return evaluation::bestOf(others).model;
}

std::string nextInWords(const Inspection& inspection, const Summaries& models, const std::string& best) {
  const std::string next = runnerUp(models, best);
  if (next.empty()) return "";
  const auto of = [&](const std::string& name) -> const ModelSummary& {
    return std::find_if(models.begin(), models.end(), [&](const auto& m) { return m.first == name; })->second;
  };
  const ErrorDifference d = errorDifference(inspection, best, next);
  std::string text = "The next is " + next + " with " + percent(of(next).contourErrorPct.mean) + " on average";
  if (of(next).missed > of(best).missed) text += " and " + std::to_string(of(next).missed) + " missed";
  if (d.highlights >= 2 && !d.isClear())
    text += formatted(
        ": over the %d highlights that both found, its error is larger by %.2g %% with a standard error of %.2g %%, "
        "so this run does not tell which of the two is better",
        d.highlights, d.meanPct, d.standardErrorPct);
  else if (of(next).missed == of(best).missed && percent(of(next).contourErrorPct.mean) == percent(of(best).contourErrorPct.mean))
    text += ", which is the same to three digits: there is nothing to choose between them by this error";
  return text + ".";
}

/// Those of the fits, and those of no model.
void addWarnings(const Inspection& inspection, const std::string& best, std::vector<std::string>& doubts) {
  for (const std::string& warning : warningsOf(inspection)) {
    const bool ofOther = std::any_of(inspection.request.models.begin(), inspection.request.models.end(),
                                     [&](const std::string& m) { return m != best && warning.rfind(m + ", light ", 0) == 0; });
    if (!ofOther) doubts.push_back(sentence(warning));
  }
}

/// What the numbers rest on: the frames and what is taken for the truth.
void addDoubtsOfTheRun(const Inspection& inspection, std::vector<std::string>& doubts) {
  const HeldOutFrames heldOut = heldOutFrames(inspection);
  if (inspection.train.perSurface)
    doubts.push_back("Each surface has a model of all its frames: the errors are of frames that the models have seen.");
  else if (heldOut.all == 0)
    doubts.push_back("No frame is held out, so nothing says how a model does where it has not learned.");
  if (heldOut.unreadable > 0)
    doubts.push_back(counted(heldOut.unreadable, "frame") + " cannot be read and " +
                     (heldOut.unreadable == 1 ? "counts" : "count") + " nowhere.");
  if (scoredAgainst(inspection) == "own detection")
    doubts.push_back(
        "Predictions are scored against Glint's own detection: where that draws a wrong contour, a right prediction counts as "
        "wrong. --truth DIR scores against known contours.");
  if (const std::optional<DetectionError> d = detectionError(inspection))
    doubts.push_back("Glint's own detection is off from the truth by " + percent(d->contourErrorPct.mean) +
                     " on average and by " + percent(d->contourErrorPct.max) + " at worst, and missed " +
                     counted(d->missed, "true highlight") + " in " + counted(d->frames, "frame") + ".");
  const std::vector<std::string> unused = unusedTrainingFrames(inspection);
  for (std::size_t i = 0; i < std::min(kMostUnused, unused.size()); ++i)
    doubts.push_back("A training frame could not be used: " + sentence(unused[i]));
  if (unused.size() > kMostUnused)
    doubts.push_back(formatted("%zu more training frames could not be used.", unused.size() - kMostUnused));
}

void addDoubtsOfTheBest(const ReportContext& context, const std::string& best, const ModelSummary& s, std::size_t answered,
                        std::vector<std::string>& doubts) {
  if (s.missed > 0)
    doubts.push_back("The mean of " + best + " is over the " + std::to_string(s.matched) + " highlights that it found; the " +
                     std::to_string(s.missed) + " that it missed are not in it.");
  if (s.matched < kFewHighlights) doubts.push_back("Only " + counted(s.matched, "highlight") + " scored " + best + ".");
  if (s.matched > 2 && s.contourErrorPct.max > kStandsOut * s.contourErrorPct.median)
    doubts.push_back("One highlight stands out: its error is " +
                     formatted("%.2g", s.contourErrorPct.max / s.contourErrorPct.median) + " times the median of " + best + ".");
  if (s.coverage.mean < kWhole)
    doubts.push_back(
        formatted("On average %.0f %% of the directions around a highlight gave a contour point of ", 100 * s.coverage.mean) +
        best + "; the rest of its contours is bridged.");
  if (!context.selection && answered > 1)
    doubts.push_back(
        "The best was found by the same frames that it is scored on, which flatters it. --models auto chooses from the training "
        "frames alone.");
}

}  // namespace

ErrorDifference errorDifference(const Inspection& inspection, const std::string& best, const std::string& other) {
  std::map<std::tuple<int, std::string, int>, double> errors;
  for (const FrameComparison& c : inspection.models.at(best).frames)
    for (const FrameComparison::Row& row : c.rows)
      if (inspection.isHeldOut(c.frame) && row.metrics) errors[{c.frame, c.light, row.observed}] = row.metrics->contourErrorPct;
  std::vector<double> differences;
  for (const FrameComparison& c : inspection.models.at(other).frames)
    for (const FrameComparison::Row& row : c.rows)
      if (const auto it = errors.find({c.frame, c.light, row.observed}); row.metrics && it != errors.end())
        differences.push_back(row.metrics->contourErrorPct - it->second);
  ErrorDifference d;
  d.highlights = static_cast<int>(differences.size());
  d.meanPct = statisticOf(differences).mean;
  double squares = 0;
  for (const double v : differences) squares += (v - d.meanPct) * (v - d.meanPct);
  const double n = d.highlights;
  d.standardErrorPct = n < 2 ? std::nan("") : std::sqrt(squares / (n - 1) / n);
  return d;
}

EvaluationWords evaluationWords(const Inspection& inspection, const ReportContext& context) {
  EvaluationWords words;
  Summaries models;
  std::size_t answered = 0;
  for (const std::string& name : inspection.request.models)
    if (const auto it = inspection.models.find(name); it != inspection.models.end()) {
      models.emplace_back(name, summarise(inspection, it->second));
      answered += models.back().second.answered;
    }
  const auto chosen = std::find_if(models.begin(), models.end(), [&](const auto& m) { return m.first == context.chosenModel; });
  words.best = chosen != models.end() && chosen->second.answered ? context.chosenModel : evaluation::bestOf(models).model;
  bool helpWanted = words.best.empty();
  for (const auto& [name, s] : models) {
    if (name != words.best) continue;
    words.inShort.push_back(bestInWords(inspection, name, s, answered == 1));
    if (context.selection)
      words.inShort.push_back("It was chosen from the training frames alone. " + sentence(context.whyChosen));
    if (const std::string next = nextInWords(inspection, models, name); !next.empty()) words.inShort.push_back(next);
    if (s.contourErrorPct.mean > kLargestExpectedPct)
      words.inShort.push_back(formatted("No model is good here: even the best is off by more than %g %%.", kLargestExpectedPct));
    else if (s.missed > 0)
      words.inShort.push_back("No model is good here: even the best misses highlights.");
    addDoubtsOfTheBest(context, name, s, answered, words.doubts);
  }
  if (words.best.empty())
    words.inShort.push_back(models.empty() ? "No model was computed." : "No model predicted a highlight that was observed.");
  for (const auto& [name, s] : models) {
    helpWanted = helpWanted || !s.answered || s.poor || s.missed > 0 || s.contourErrorPct.mean > kLargestExpectedPct;
    if (!s.answered) words.inShort.push_back(name + " gives no answer: " + sentence(s.reason));
    if (s.poor) words.inShort.push_back(name + " answers poorly: " + sentence(s.reason));
  }
  if (inspection.lightFrame.anyMoves())
    words.inShort.push_back((inspection.lightFrame.elsewhere.empty() ? "In the world no lamp stands still: " : "") +
                            sentence(inspection.lightFrame.reason));
  words.inShort.insert(words.inShort.begin(), context.advice.begin(), context.advice.end());
  if (helpWanted && !models.empty() && context.advice.empty())
    words.inShort.push_back("glint diagnose " + (context.input.empty() ? "INPUT" : context.input) +
                            " says why a model fails or is poor, and what helps.");
  addDoubtsOfTheRun(inspection, words.doubts);
  addWarnings(inspection, words.best, words.doubts);
  return words;
}

std::optional<DetectionError> detectionError(const Inspection& inspection) {
  DetectionError error;
  std::vector<double> percent, pixels;
  for (const FrameEvidence& e : inspection.evidence) {
    if (e.frame < 0 || !e.againstTruth || e.truthFailure || e.truth.empty()) continue;
    std::vector<Polyline> truth, found;
    for (const Highlight& h : e.truth) truth.push_back(h.contour);
    for (const Highlight& h : e.highlights) found.push_back(h.contour);
    const std::vector<std::pair<int, int>> pairs = matchByOverlap(truth, found);
    ++error.frames;
    error.missed += static_cast<int>(truth.size() - pairs.size());
    for (const auto& [t, f] : pairs) {
      const Highlight& own = e.highlights[static_cast<std::size_t>(f)];
      const Highlight& known = e.truth[static_cast<std::size_t>(t)];
      if (known.peakCut != own.peakCut) continue;  // their levels are fractions of different places
      const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(e.frame)].camera;
      PredictedHighlight asPredicted;
      asPredicted.contour = own.contour;
      asPredicted.ellipse = own.ellipse;
      asPredicted.brightest.pixel = own.peak;
      const ContourMetrics m = comparedHighlights(known, asPredicted, camera, known.touchesBorder || own.touchesBorder);
      percent.push_back(m.contourErrorPct);
      pixels.push_back(m.contourErrorPx);
    }
  }
  if (percent.empty()) return std::nullopt;
  error.contourErrorPct = statisticOf(percent);
  error.contourErrorPx = statisticOf(pixels);
  return error;
}

}  // namespace glint
