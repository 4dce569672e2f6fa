// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/base/settings.h"

namespace glint {

/// One setting of the program with what it was measured to give on the user's input (method.md section 12).
struct TradeoffPoint {
  std::string model;
  Settings settings;  ///< complete: what `--set` would have to say
  int frames = 0;     ///< with an observed highlight, as `evaluate` counts them
  int predicted = 0, matched = 0, missed = 0, spurious = 0;
  double contourErrorPct = 0;  ///< mean over matched highlights
  double iou = 0, coverage = 0;
  double rankedErrorPct = 0;  ///< what points are compared by: see rankedErrorPct()
  double predictUs = 0;       ///< median over frames and repeats, one thread
  double fitUs = 0;           ///< light, canonical contours and fit of all lights and surfaces, one thread, median of repeats
  double peakMb = 0;          ///< peak resident memory of the process with this setting alone, 2^20 bytes
  bool pareto = false;
  std::string poor{};  ///< why the model explains its training views badly; "" if it explains them
};

/// A setting that was not measured in full, and why.
struct PrunedPoint {
  std::string model;
  Settings settings;
  std::string kind;           ///< "failed", "no effect", "not better", "dominated", "expected to be dominated", ...
  std::string reason;         ///< one line for a person
  double rankedErrorPct = 0;  ///< of the coarse pass; NaN when it was not run or failed
  double predictUs = 0;
};

/// Speed against accuracy on one input. Plain data: what `tradeoff --json` writes and the session stores.
struct Tradeoff {
  std::string input;                  ///< as the user named it
  std::vector<int> train;             ///< positions
  std::vector<std::string> trainIds;  ///< the same frames as a person knows them
  std::string trainSpec;
  std::vector<std::string> knobs;      ///< dotted names of the settings that were varied
  std::vector<TradeoffPoint> points;   ///< fastest first
  std::map<std::string, int> presets;  ///< "fast", "balanced", "exact": indices into points
  std::optional<int> chosen;           ///< index into points; none if nothing meets the bound
  std::string reason;                  ///< one sentence
  std::vector<PrunedPoint> pruned;
  int trials = 0;           ///< settings tried on few frames
  std::string measurement;  ///< how time and memory were measured
};

/// The error that points are compared by. A complete point (every frame predicted, nothing missed or spurious, coverage at
/// least kFullCoverage) has its contour error. Else what is left out counts as 100 %, the error of no prediction at all:
/// a missed or spurious highlight wholly, a matched one by its share without coverage. So a model cannot win by leaving out.
double rankedErrorPct(const TradeoffPoint& point);
inline constexpr double kFullCoverage = 0.99;  ///< the bound under which the project's accuracy figures count

/// Short name of a setting in the points' `settings`: "predict.directions" is "directions"; "light.solver" is
/// "light_solver", because "solver" is that of the ellipsoid.
std::string knobName(const std::string& key);
/// "canonical, directions 24, solver anchored": the model and the knobs that differ from the program's defaults.
std::string describe(const Tradeoff& tradeoff, const TradeoffPoint& point);

/// docs/formats.md, "tradeoff --json". Numbers that are not finite become null.
std::string tradeoffJson(const Tradeoff& tradeoff);
/// Reads it back (from a session). InputError with the place.
Tradeoff readTradeoff(const JsonNode& node);
/// What trained, for a person: "first:2, 0000, 0001".
std::string trainedOn(const Tradeoff& tradeoff);

// One number is the error of a setting wherever settings are compared: rankedErrorPct, `error %`. The mean over the highlights
// that were found, which `evaluate` prints, is listed beside it under its own name.
/// One sentence that says what both are.
extern const char* const kTradeoffErrors;
/// "29 of 54": highlights that were found, of those observed.
std::string foundText(const TradeoffPoint& point);
/// The presets that mean this point: "fast and balanced"; "" if none does.
std::string presetNames(const Tradeoff& tradeoff, int point);
/// That presets coincide, and why, in one sentence; "" if each has a point of its own.
std::string presetNote(const Tradeoff& tradeoff);
/// A plain-text table of the front and the presets.
std::string tradeoffTable(const Tradeoff& tradeoff);

/// What the user asks of the choice; at most one is set, none means the balanced preset.
struct TradeoffBound {
  std::optional<double> budgetUs = {}, maxErrorPct = {};
};

/// Sorts the points by time, marks the front, finds the presets, picks a point and says why in one sentence.
/// If no point meets the bound, `chosen` stays empty and `reason` names the nearest point.
void choosePoint(Tradeoff& tradeoff, const TradeoffBound& bound);

/// The point that a preset's name means: "fast", "balanced", "exact", or "chosen". InputError (place "--preset NAME").
const TradeoffPoint& pointOfPreset(const Tradeoff& tradeoff, const std::string& name);

/// A setting that trades speed against accuracy, with the values worth trying.
struct Knob {
  std::string key;                   ///< dotted name
  std::vector<SettingValue> values;  ///< the base value among them
  std::string onlyModel = {};        ///< the one model that looks at it; "" = any
};

/// The knobs of `params` (method.md section 12), so that a setting which is added later is tried without further work: of the
/// stages surface, light, fit and predict every choice and switch, the numbers that have a ladder in knobs.cpp, and every other
/// number of `predict.` at half and twice its value. What changes the problem (detection), how a noisy fit is weighted, or
/// only the description of a contour (the uncertainty band) is no knob.
std::vector<Knob> knobsOf(const Settings& base, const std::vector<ParamSpec>& params = allParams());

/// "24", "1e-06", "refined", "true".
std::string textOf(const SettingValue& value);

}  // namespace glint
