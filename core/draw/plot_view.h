// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/draw/plot_painter.h"

namespace glint::draw {

/// One plot as the user looks at it: which part is shown, what is selected, and what lies where in the last picture.
class PlotView {
 public:
  void setStyle(const PlotStyle& style) { style_ = style; }
  /// Keeps the part that is zoomed to when the plot has the same id and range as the one before.
  void show(const PlotData& plot);
  const PlotData& plot() const { return plot_; }
  void setSelection(const Selection& selection);
  /// Instead of those of the selection, until the next plot or selection.
  void setMarked(const std::vector<PlotSample>& samples) { marks_.selected = samples; }
  void setHovered(const std::optional<PlotSample>& sample) { marks_.hovered = sample; }
  /// @see paintPlot
  void paint(Painter& painter, double width, double height);

  /// Where a sample was drawn last, device px from the top left; empty before the first picture, outside the visible part, or for
  /// a gap.
  std::optional<Eigen::Vector2d> positionOf(const PlotSample& sample) const;
  /// The sample drawn nearest to a place, at most `reach` device px away (bars: whose column the place is in).
  std::optional<PlotSample> at(const Eigen::Vector2d& place, double reach) const;

  /// Shows 1/factor of the range of x (and, where `both`, of y) about a place. A dial does not zoom.
  void zoom(double factor, const Eigen::Vector2d& about, bool both);
  void pan(const Eigen::Vector2d& by);
  void showAll() { shown_ = whole_; }
  bool zoomed() const;

 private:
  const PlotPoint& pointOf(const PlotSample& sample) const;
  std::optional<PlotSample> nearest(const Eigen::Vector2d& place, double reach, const std::string& model) const;

  PlotData plot_;
  PlotStyle style_;
  Selection selection_;
  PlotMarks marks_;
  PlotRange whole_, shown_;
  std::optional<PlotPlaces> places_;  // of the last picture
};

}  // namespace glint::draw
