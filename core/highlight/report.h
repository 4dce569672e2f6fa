// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/highlight/highlight.h"

namespace glint {

/// What detection said about one frame.
struct DetectedFrame {
  std::string id;
  std::vector<Highlight> highlights;
  std::vector<double>
      uncertaintyPct;  ///< per highlight: of its contour, in percent of the diameter, because the lobe's tail is unknown
  std::optional<Failure> failure;
};

/// JSON of `glint detect`: { "glint_detection": 1, "input", "level", "source", "frames": [{"id", "status", "reason",
/// "highlights":
/// [{"light", "level", "peak", "peak_value", "area_px2", "clipped", "touches_border", "background_uncertainty_pct", "ellipse": {"centre", "semi_axes",
/// "angle_deg"}, "contour"}]}] }. Pixels are ideal ones. `light` is absent while unknown.
std::string detectionJson(const std::string& input, double level, const std::string& source,
                          const std::vector<DetectedFrame>& frames);

/// The photograph (3 channels, sRGB 0..1, any size) with each highlight's contour (green), ellipse (orange) and peak (cross; red
/// when clipped), drawn anti-aliased at a scale of at least 2 so that sub-pixel positions can be seen.
Image drawDetection(const Image& photograph, const Camera& camera, const std::vector<Highlight>& highlights);

/// Writes sRGB 0..1 as 8-bit PNG, atomically. InputError when it cannot be written.
void writePng(const std::filesystem::path& file, const Image& image);

}  // namespace glint
