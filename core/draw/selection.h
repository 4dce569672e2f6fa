// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace glint::draw {

/// What is selected; one for all views. A camera is selected as its frame, an ellipsoid as its model and light, a contour point
/// as frame, highlight and direction, a sample of a plot as whatever of these it stands for.
struct Selection {
  int frame = 0;
  std::string model;    ///< "" = all models
  int highlight = -1;   ///< index in the frame's evidence, -1 = none
  std::string light{};  ///< id of the light whose ellipsoid or highlight is selected, "" = any
  /// A point of the contours of this frame: its direction in the photograph, seen from the centroid of the observed contour (its
  /// peak where there is no contour), rad in (-pi, pi], 0 = right, pi/2 = down. The same direction is marked on observed and
  /// predicted contours, dials and plots.
  std::optional<double> direction{};
  /// A spurious highlight: index in what `model` predicts for `light` in this frame; `highlight` is -1 then. -1 = none. See
  /// core/draw/unmatched.h.
  int predicted = -1;

  friend bool operator==(const Selection&, const Selection&) = default;
};

}  // namespace glint::draw
