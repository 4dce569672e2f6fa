// SPDX-License-Identifier: BSD-3-Clause
#include "viz/timeline_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/draw/frame_overlay.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/summary.h"
#include "viz/style.h"

namespace glint::viz {

namespace {
constexpr double kWorstShownPct = 1000;  // ten times the highlight's size: a very wrong model must not flatten the others
}

namespace {
/// The evidence of a frame with all its lights; null before it exists.
const FrameEvidence* asFound(const Inspection* inspection, std::size_t frame) {
  if (!inspection || frame >= inspection->evidence.size()) return nullptr;
  const auto before = inspection->evidenceBefore.find(static_cast<int>(frame));
  return before != inspection->evidenceBefore.end() ? &before->second : &inspection->evidence[frame];
}
}  // namespace

std::vector<LightRow> lightRows(const Scene& scene, const Inspection* inspection) {
  std::set<std::string> known;
  std::vector<std::set<std::string>> seen(scene.frames.size());
  bool differ = false;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Frame& frame = scene.frames[i];
    known.insert(frame.lightsOn.begin(), frame.lightsOn.end());
    differ = differ || frame.lightsOn != scene.frames.front().lightsOn;
    const FrameEvidence* evidence = frame.lightsOn.empty() ? asFound(inspection, i) : nullptr;
    if (!evidence) continue;
    for (const Highlight& h : evidence->highlights)
      if (!h.light.empty()) seen[i].insert(h.light);
    known.insert(seen[i].begin(), seen[i].end());
  }
  if (!differ && known.size() < 2) return {};
  // In the scene's order, as everywhere; those that only frames name come after them, then those that were only found.
  std::vector<std::string> lights;
  const auto add = [&](const std::string& light) {
    if (known.erase(light) > 0) lights.push_back(light);
  };
  for (const TrueLight& light : scene.lights) add(light.id);
  for (const Frame& frame : scene.frames)
    for (const std::string& light : frame.lightsOn) add(light);
  lights.insert(lights.end(), known.begin(), known.end());
  std::vector<LightRow> rows;
  for (const std::string& light : lights) {
    LightRow row{light, {}};
    for (std::size_t i = 0; i < scene.frames.size(); ++i) {
      const std::vector<std::string>& on = scene.frames[i].lightsOn;
      const bool stated = !on.empty(),
                 lit = stated ? std::find(on.begin(), on.end(), light) != on.end() : seen[i].count(light) > 0;
      row.captured.push_back(lit ? LightState::On : stated ? LightState::Off : LightState::NotStated);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

LightState lightState(const LightRow& row, const Scene& scene, const WhatIf& whatIf, int frame) {
  const LightState captured = row.captured.at(static_cast<std::size_t>(frame));
  if (isSwitchedOff(whatIf, frame, row.light)) return LightState::SwitchedOff;
  return captured == LightState::Off && isOn(scene, whatIf, frame, row.light) ? LightState::SwitchedOn : captured;
}

bool isLit(LightState state) { return state == LightState::On || state == LightState::SwitchedOn; }

TimelineData timelineData(const Scene& scene, const Inspection* inspection) {
  TimelineData data;
  const int n = static_cast<int>(scene.frames.size());
  data.lights = lightRows(scene, inspection);
  if (!inspection) return data;
  for (const std::string& model : modelsInOrder(*inspection)) {
    TimelineData::Series series{model, {}, {}, {}, {}, {}, !reasonsOf(inspection->models.at(model)).poor.empty()};
    for (const FrameScore& score : frameScores(inspection->models.at(model), n)) {
      series.errorPct.push_back(wholeErrorPct(score));
      series.missed.push_back(score.missed > 0);
      series.spurious.push_back(score.spurious > 0);
      series.spuriousWords.push_back(spuriousText(score));
      const std::string missed = missedText(score);
      series.reason.push_back(missed + (missed.empty() || score.reason.empty() ? "" : ": ") + score.reason);
    }
    data.series.push_back(std::move(series));
  }
  return data;
}

bool TimelineData::Series::answers() const {
  return std::any_of(errorPct.begin(), errorPct.end(), [](const std::optional<double>& pct) { return pct.has_value(); });
}

double ErrorAxis::place(double pct) const {
  if (!logarithmic) return std::clamp((pct - lowPct) / (highPct - lowPct), 0.0, 1.0);
  if (!(pct > lowPct)) return 0;
  return std::clamp(std::log(pct / lowPct) / std::log(highPct / lowPct), 0.0, 1.0);
}

ErrorAxis errorAxis(const TimelineData& data, const std::string& model, const std::vector<int>& ignored) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const TimelineData::Series& series : data.series) {
    if (!model.empty() && series.model != model) continue;
    for (std::size_t i = 0; i < series.errorPct.size(); ++i) {
      const std::optional<double>& pct = series.errorPct[i];
      if (!pct || !(*pct > 0) || std::binary_search(ignored.begin(), ignored.end(), static_cast<int>(i))) continue;
      low = std::min(low, *pct);
      high = std::max(high, *pct);
    }
  }
  ErrorAxis axis;
  if (!(high > 0)) return axis;
  high = std::min(high, kWorstShownPct);
  low = std::min(low, high);
  const auto roundUp = [](double v) {
    const double decade = std::pow(10.0, std::floor(std::log10(v)));
    for (const double step : {1.0, 2.0, 5.0, 10.0})
      if (step * decade >= v * (1 - 1e-9)) return step * decade;  // a round number must not round up by its own round-off
    return 10 * decade;
  };
  axis.highPct = roundUp(high);
  axis.logarithmic = high > 30 * low;
  // Exact predictions have errors of round-off: they would stretch the axis over many decades.
  if (axis.logarithmic) axis.lowPct = std::pow(10.0, std::floor(std::log10(std::max(low, 1e-5 * high))));
  return axis;
}

namespace {
/// The column that a frame is in; nothing outside of [first, last).
std::optional<std::size_t> columnOf(std::size_t frame, double first, double last, int n) {
  const double middle = static_cast<double>(frame) + 0.5;
  if (middle < first || middle >= last || n < 1) return std::nullopt;
  return static_cast<std::size_t>(std::clamp((middle - first) / (last - first) * n, 0.0, n - 1.0));
}
}  // namespace

std::vector<std::optional<double>> columnMaxima(const std::vector<std::optional<double>>& errors, double first, double last,
                                                int n) {
  std::vector<std::optional<double>> columns(static_cast<std::size_t>(std::max(0, n)));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const std::optional<std::size_t> column = columnOf(i, first, last, n);
    if (column && errors[i] && (!columns[*column] || *errors[i] > *columns[*column])) columns[*column] = errors[i];
  }
  return columns;
}

std::vector<char> columnMarks(const std::vector<char>& marks, double first, double last, int n) {
  std::vector<char> columns(static_cast<std::size_t>(std::max(0, n)), 0);
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (const std::optional<std::size_t> column = columnOf(i, first, last, n); column && marks[i]) columns[*column] = 1;
  return columns;
}

}  // namespace glint::viz
