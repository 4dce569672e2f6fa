// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "viz/style.h"

namespace glint::viz {

/// A light in one frame.
enum class LightState { Off, On, NotStated, SwitchedOff, SwitchedOn };
struct LightRow {
  std::string light;
  std::vector<LightState> captured;  ///< one per frame: off, on, or the frame does not say and no highlight of it was found
};
/// The state with the user's switches; what was captured dark stays off unless contours are synthesised.
LightState lightState(const LightRow& row, const Scene& scene, const WhatIf& whatIf, int frame);
bool isLit(LightState state);

/// What the timeline draws, read once per result.
struct TimelineData {
  struct Series {
    std::string model;
    std::vector<std::optional<double>> errorPct;  ///< one per frame; none if a highlight was missed
    std::vector<char> missed;                     ///< one per frame: a highlight was missed there
    std::vector<char> spurious;                   ///< one per frame: one was predicted that is not seen there
    std::vector<std::string> spuriousWords;       ///< one per frame
    std::vector<std::string> reason;              ///< where there is no error: why
    bool poor = false;                            ///< a fit of it is poor: dashed and pale, as everywhere
    bool answers() const;                         ///< it has an error somewhere: else missing everything tells nothing new
  };
  std::vector<Series> series;    ///< from simple to rich; empty before the first result
  std::vector<LightRow> lights;  ///< empty unless there are several, or frames differ in which are on; in the scene's order
};
/// @param inspection  null before the first result: lights that the scene does not state are not known yet
TimelineData timelineData(const Scene& scene, const Inspection* inspection);
std::vector<LightRow> lightRows(const Scene& scene, const Inspection* inspection);

/// Vertical axis of errors: from 0, or logarithmic where they span more than a factor of 30. Ends are round numbers.
struct ErrorAxis {
  double lowPct = 0, highPct = 1;
  bool logarithmic = false;
  double place(double pct) const;  ///< 0 at the bottom, 1 at the top, cut to that
};
/// @param model  only this one; "" = all.  @param ignored  frames that do not count (excluded ones).
ErrorAxis errorAxis(const TimelineData& data, const std::string& model, const std::vector<int>& ignored);

/// Whether any frame of each of n columns is marked, as columnMaxima().
std::vector<char> columnMarks(const std::vector<char>& marks, double first, double last, int n);

/// The largest error in each of n columns that share the frames [first, last): with more frames than screen columns nothing is
/// lost.
std::vector<std::optional<double>> columnMaxima(const std::vector<std::optional<double>>& errors, double first, double last,
                                                int n);

}  // namespace glint::viz
