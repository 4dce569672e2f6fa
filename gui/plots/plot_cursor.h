// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QPointF>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/draw/plot_data.h"

namespace glint::gui {

/// A point of a plot that the keyboard goes to, and the points from another one up to it. It stays with its point when the plot
/// is drawn anew, even if the point is in another series then; it goes if that point no longer exists.
class PlotCursor {
 public:
  /// Where a sample is drawn; nothing for what is not in sight.
  using Where = std::function<std::optional<QPointF>(const draw::PlotSample&)>;
  enum class Step { Next, Previous, First, Last };

  /// Goes from point to point, left to right, of those above each other from the top. Without a point yet, Next begins at the
  /// first and Previous at the last.
  /// @param extend  the range goes on from where it began; else it is the point alone
  /// @return whether it is at a point now
  bool move(const draw::PlotData& plot, const Where& where, Step step, bool extend);
  std::optional<draw::PlotSample> sample(const draw::PlotData& plot) const { return find(plot, at_); }
  /// From where the range began up to the point.
  std::vector<draw::PlotSample> range(const draw::PlotData& plot, const Where& where) const;
  /// "3 of 24: ..." with the point's own words; "" without a point.
  std::string words(const draw::PlotData& plot, const Where& where) const;
  void clear() { at_ = from_ = std::nullopt; }
  bool any() const { return at_.has_value(); }

 private:
  struct Point {
    draw::PlotSample sample;  ///< where it was last
    double x = 0, y = 0;
    std::string label;
  };
  static std::vector<draw::PlotSample> inOrder(const draw::PlotData& plot, const Where& where);
  static std::optional<draw::PlotSample> find(const draw::PlotData& plot, const std::optional<Point>& point);

  std::optional<Point> at_, from_;
};

}  // namespace glint::gui
