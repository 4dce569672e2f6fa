// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "viz/layers.h"

class vtkRenderer;

namespace glint::viz {

/// One row of the legend: a stroke in its colour, and what it stands for.
struct LegendEntry {
  Colour colour;
  std::string text;
  bool always = false;  ///< also in a narrow picture, which would be covered by the whole legend
};
constexpr int kNarrowPicture = 600;  ///< px at 100 % scaling

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
  void setDark(bool dark);
  /// @param reference  world point at whose depth the scale bar is measured.
  void place(const Eigen::Vector3d& reference);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Text size in screen pixels for a window of this height.
int fontSizeFor(int windowHeight);
/// Largest of 1, 2, 5 times a power of ten that is not above `limit` (> 0).
double roundLength(double limit);
/// "0.5 m", "20 cm", "3 km".
std::string lengthText(double metres);

}  // namespace glint::viz
