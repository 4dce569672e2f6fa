// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viz/layers.h"
#include "viz/text_sizes.h"

class vtkRenderer;

namespace glint::viz {

/// One row of the legend: a stroke in its colour, and what it stands for.
struct LegendEntry {
  Colour colour;
  std::string text;
  bool always = false;  ///< in a row of its own even in a low picture, which the whole legend would cover
};

/// A scale with its ticks, 0..1 from left to right.
struct ColourBar {
  std::string title;
  std::vector<Colour> colours;  ///< equal steps
  std::vector<std::pair<double, std::string>> ticks;
};

/// Lines about a view among others.
enum class Border { None, Around, Active, Wipe };

/// Everything of the 3D picture that is drawn in screen space: legend, notes, labels of world points, scale bar, axes.
/// Sizes follow the window's height and the screen's scaling. Call `place` before every frame: it projects the labels with the
/// current camera.
class Annotations {
 public:
  explicit Annotations(vtkRenderer* renderer);
  ~Annotations();
  void setLegend(const std::vector<LegendEntry>& entries, const std::vector<std::string>& notes,
                 const std::vector<std::string>& remarks, const std::string& title);
  void setLabels(const std::vector<DrawnLabel>& labels);
  /// Corners of drawn things that would make a label hard to read: labels avoid them if there is room.
  void setGlyphs(std::vector<Points> corners);
  void setColourBar(const std::optional<ColourBar>& bar);
  /// A line at the top that cannot be overlooked ("through camera 0007"); "" = none.
  void setBadge(const std::string& text);
  /// @param name  of the view, in its upper right corner; "" = none. Border::Wipe draws the line at its left edge.
  void setBorder(Border border, const std::string& name);
  /// @param title  also the legend's title, which views side by side have in common.
  void setLegendVisible(bool visible, bool title = true);
  /// Width and height of the legend from the upper left corner, window px; 0 without one.
  Eigen::Vector2d legendSize();
  /// Height of the texts with the colour bar at the lower right, window px; 0 without any.
  double colourBarHeight();
  /// The legend lies over a photograph: its panel keeps it readable.
  void setOnPicture(bool on);
  void setDark(bool dark);
  /// Scales all texts by this factor.
  void setTextScale(double scale);
  /// @param reference  world point at whose depth the scale bar is measured.
  void place(const Eigen::Vector3d& reference);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz
