// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/advise/highlight_rows.h"
#include "core/draw/plot_data.h"

namespace glint::draw {

/// What the colours of a scatter plot mean.
enum class ScatterColour { Model, Role, Light, Status };
struct ScatterColourKind {
  ScatterColour colour;
  const char* id;  ///< "model"
  const char* title;
};
const std::vector<ScatterColourKind>& scatterColours();

struct ScatterOptions {
  RowValue x = RowValue::IncidentDeg, y = RowValue::ErrorPct;
  ScatterColour colour = ScatterColour::Model;
  bool logX = false, logY = false;
  std::set<RowKey> brushed{};  ///< empty = none: else the others are grey
};

/// Two numbers of every highlight, one dot each. A highlight that lacks one has no dot: the plot's remarks count it, and its
/// row of CSV has no value.
struct ScatterPlot {
  PlotData plot;
  std::vector<std::vector<int>> rows;         ///< of each series: the row of each of its points
  int rowOf(const PlotSample& sample) const;  ///< -1 for none
};
/// @param rows  highlightRows() of this inspection
ScatterPlot scatterPlot(const Inspection& inspection, const std::vector<HighlightRow>& rows, const ScatterOptions& options);

}  // namespace glint::draw
