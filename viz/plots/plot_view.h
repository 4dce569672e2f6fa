// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "viz/plots/plot_data.h"

class vtkRenderer;

namespace glint::viz {

struct PlotStyle {
  bool dark = true;
  double scale = 1;  ///< device pixels per screen px
  friend bool operator==(const PlotStyle&, const PlotStyle&) = default;
};

/// Draws one plot into a renderer: VTK's chart for layout, axes and grid; series, title, legend, bars, error bars, tinted ranges
/// and the marks of the selection over it; a dial of its own. Its window's DPI must be 72: sizes are scaled by the style alone.
class PlotView {
 public:
  PlotView();
  ~PlotView();
  PlotView(const PlotView&) = delete;
  PlotView& operator=(const PlotView&) = delete;

  vtkRenderer* renderer() const;
  void setStyle(const PlotStyle& style);
  /// Keeps the part that is zoomed to when the plot has the same id and range as the one before.
  void show(const PlotData& plot);
  const PlotData& plot() const;
  void setSelection(const Selection& selection);
  void setHovered(const std::optional<PlotSample>& sample);

  /// Where a sample was drawn last, device px from the top left; empty before the first picture, outside the visible part, or for
  /// a gap.
  std::optional<Eigen::Vector2d> positionOf(const PlotSample& sample) const;
  /// The sample drawn nearest to a place, at most `reach` device px away (bars: whose column the place is in).
  std::optional<PlotSample> at(const Eigen::Vector2d& place, double reach) const;

  /// Shows 1/factor of the range of x (and, where `both`, of y) about a place. A dial does not zoom.
  void zoom(double factor, const Eigen::Vector2d& about, bool both);
  void pan(const Eigen::Vector2d& by);
  void showAll();
  bool zoomed() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz
