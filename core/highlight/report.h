// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/highlight/frame_blur.h"
#include "core/highlight/highlight.h"
#include "core/highlight/specular_separation.h"

namespace glint {

/// What makes one highlight doubtful, and how well its contour is known across its direction, px, by cause.
struct HighlightQuality {
  std::vector<std::string> flags;  ///< in words: "clipped core", "cut by the image's edge", ...
  double noisePx = 0;              ///< from the pixels' noise, over the gradient on the contour (median)
  double backgroundPx = 0;         ///< because the lobe's tail may pass for background
  double blurPx = 0;               ///< by how much the frame's blur has widened it
  /// A clipped highlight: how far its contour may be from that at its level (sigmaPx of its ClippedFlank); what a tenth of the
  /// level moves it where the slope was not traced.
  double levelPx = 0;
  double silhouetteShare = 0;  ///< of the contour: that runs along the surface's silhouette, or off it

  /// Root of the sum of squares.
  double contourSigmaPx() const {
    return std::sqrt(noisePx * noisePx + backgroundPx * backgroundPx + blurPx * blurPx + levelPx * levelPx);
  }
};

/// What detection said about one frame.
struct DetectedFrame {
  std::string id;
  std::vector<Highlight> highlights;
  std::vector<double> uncertaintyPct;  ///< per highlight: of its contour, in percent of the diameter: the lobe's tail is unknown
  std::vector<HighlightQuality> quality;         ///< per highlight
  std::vector<RejectedCandidate> rejected;       ///< ideal pixels
  std::optional<FrameBlur> blur;                 ///< where the frame has edges that show one
  std::optional<SpecularSeparation> separation;  ///< where it was asked for
  std::optional<Failure> failure;
};

/// JSON of `glint detect`: docs/formats.md, "detect --json". Pixels are ideal ones.
/// @param levelReason  why this level; "" = the user chose it
std::string detectionJson(const std::string& input, double level, const std::string& source,
                          const std::vector<DetectedFrame>& frames, const std::string& levelReason = "");

/// The photograph (3 channels, sRGB 0..1, any size) with each highlight's contour (green), ellipse (orange) and peak (cross; red
/// when clipped), drawn anti-aliased at a scale of at least 2 so that sub-pixel positions can be seen.
Image drawDetection(const Image& photograph, const Camera& camera, const std::vector<Highlight>& highlights);

/// Writes sRGB 0..1, with or without alpha, as 8-bit PNG, atomically. InputError if it cannot be written.
void writePng(const std::filesystem::path& file, const Image& image);

}  // namespace glint
