// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <string>
#include <vector>

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

}  // namespace glint
