// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "viz/style.h"

namespace glint::viz {

/// What the timeline draws, read once per result.
struct TimelineData {
  struct Series {
    std::string model;
    std::vector<std::optional<double>> errorPct;  ///< one per frame
    std::vector<std::string> reason;              ///< where there is no error: why
  };
  std::vector<Series> series;  ///< from simple to rich; empty before the first result
  struct LightRow {
    std::string light;
    std::vector<char> on;  ///< one per frame; 2 = the frame does not say
  };
  std::vector<LightRow>
      lights;  ///< empty unless the scene says for some frame which of its lights are on, and they differ; in the scene's order
};
TimelineData timelineData(const Scene& scene, const Inspection* inspection);

/// Vertical axis of errors: from 0, or logarithmic where they span more than a factor of 30. Ends are round numbers.
struct ErrorAxis {
  double lowPct = 0, highPct = 1;
  bool logarithmic = false;
  double place(double pct) const;  ///< 0 at the bottom, 1 at the top, cut to that
};
/// @param model  only this one; "" = all.  @param ignored  frames that do not count (excluded ones).
ErrorAxis errorAxis(const TimelineData& data, const std::string& model, const std::vector<int>& ignored);

/// The largest error in each of n columns that share the frames [first, last): with more frames than screen columns nothing is
/// lost.
std::vector<std::optional<double>> columnMaxima(const std::vector<std::optional<double>>& errors, double first, double last,
                                                int n);

}  // namespace glint::viz
