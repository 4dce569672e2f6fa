// SPDX-License-Identifier: BSD-3-Clause
#include "viz/timeline_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "viz/frame_overlay.h"

namespace glint::viz {

namespace {
constexpr double kWorstShownPct = 1000;  // ten times the highlight's size: a model that went astray must not flatten the others
}

TimelineData timelineData(const Scene& scene, const Inspection* inspection) {
  TimelineData data;
  const int n = static_cast<int>(scene.frames.size());
  std::set<std::string> named;
  bool differ = false;
  for (const Frame& frame : scene.frames) {
    named.insert(frame.lightsOn.begin(), frame.lightsOn.end());
    differ = differ || frame.lightsOn != scene.frames.front().lightsOn;
  }
  // In the scene's order, as everywhere; those that it only names with frames come after them.
  std::vector<std::string> lights;
  const auto add = [&](const std::string& light) {
    if (named.erase(light) > 0) lights.push_back(light);
  };
  for (const TrueLight& light : scene.lights) add(light.id);
  for (const Frame& frame : scene.frames)
    for (const std::string& light : frame.lightsOn) add(light);
  if (differ || lights.size() > 1) {
    for (const std::string& light : lights) {
      TimelineData::LightRow row{light, {}};
      for (const Frame& frame : scene.frames) {
        const bool on = std::find(frame.lightsOn.begin(), frame.lightsOn.end(), light) != frame.lightsOn.end();
        row.on.push_back(frame.lightsOn.empty() ? 2 : on ? 1 : 0);
      }
      data.lights.push_back(std::move(row));
    }
  }
  if (!inspection) return data;
  for (const std::string& model : modelsInOrder(*inspection)) {
    TimelineData::Series series{model, {}, {}};
    for (FrameScore& score : frameScores(inspection->models.at(model), n)) {
      series.errorPct.push_back(score.errorPct);
      series.reason.push_back(std::move(score.reason));
    }
    data.series.push_back(std::move(series));
  }
  return data;
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

std::vector<std::optional<double>> columnMaxima(const std::vector<std::optional<double>>& errors, double first, double last,
                                                int n) {
  std::vector<std::optional<double>> columns(static_cast<std::size_t>(std::max(0, n)));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double middle = static_cast<double>(i) + 0.5;
    if (!errors[i] || middle < first || middle >= last) continue;
    const auto column = static_cast<std::size_t>(std::clamp((middle - first) / (last - first) * n, 0.0, n - 1.0));
    if (!columns[column] || *errors[i] > *columns[column]) columns[column] = errors[i];
  }
  return columns;
}

}  // namespace glint::viz
