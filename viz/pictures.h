// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/draw/frame_overlay.h"
#include "viz/canvas.h"
#include "viz/style.h"

namespace glint::viz {

struct PictureOptions {
  std::set<std::string> models;  ///< empty = all
  std::set<OverlayRole> hidden;  ///< roles left out of the overlays
  bool dark = true;
};

/// One photograph with its overlay, the error of each model below, and, where the highlight is small, an enlarged part beside it.
/// Needs no display. @param photograph  3 channels 0..1; empty = the reason is written in its place.
/// std::invalid_argument for a frame that does not exist or a size out of Canvas's range.
Image framePicture(const Inspection& inspection, int frame, const Outcome<Image>& photograph, int width, int height,
                   const PictureOptions& options = {});

/// One tile for each model, from simple to rich: the same enlarged part of the photograph with the observed contour and that
/// model's prediction, its error below. As framePicture.
Image ladderPicture(const Inspection& inspection, int frame, const Outcome<Image>& photograph, int width, int height,
                    const PictureOptions& options = {});

/// Contour error over frames (errorPlot), with the means of held-out frames in the legend. std::invalid_argument unless
/// 16 <= width, height <= 16384.
Image plotsPicture(const Inspection& inspection, int width, int height, const PictureOptions& options = {});

/// The part of the photograph that holds the frame's contours with a margin, `aspect` = width / height (0 = as the contours are);
/// nothing without contours.
std::optional<Crop> highlightCrop(const Inspection& inspection, int frame, const std::set<std::string>& models, double aspect);

/// A larger part around another of the given shape, moved into the photograph where it fits.
Crop grownTo(const Crop& crop, double aspect, const Camera& camera);

/// Number of columns of a grid of tiles on an area, in which a picture of `aspect` = width / height becomes largest.
/// @param foot  height of the text below each.
int ladderColumns(int tiles, double width, double height, double foot, double aspect);

}  // namespace glint::viz
