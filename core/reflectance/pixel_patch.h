// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/highlight/highlight.h"
#include "core/reflectance/lobe.h"
#include "core/surface/surface.h"

namespace glint {

/// Which pixels of a frame may be used as evidence, and their values.
struct LinearPixels {
  Image value;                ///< one channel, linear: the mean of the image's channels
  std::vector<char> usable;   ///< one per pixel: finite, not negative, on the glossy object, not clipped in any channel
  std::vector<char> clipped;  ///< one per pixel: at or above the clip value in some channel
};
/// @param linear     1 or 3 channels. @param mask  optional, non-zero on the glossy object; same size.
/// @param clipValue  values at or above it are clipped; 0 = none.
/// @param under      diffuse light that is taken off; pixels where it is unknown are not usable
LinearPixels linearPixels(const Image& linear, const Image* mask, double clipValue, const DiffuseLight* under = nullptr);

/// The pixels around one highlight as evidence of the radiance, averaged over square cells and joined with the surface that they
/// show (method.md section 15, "Pixels").
struct PixelPatch {
  using Seen = lobe::Seen;  ///< what a cell's centre shows
  std::string light;        ///< whose highlight it is
  int frame = 0;            ///< patches of one frame share the light's strength
  Camera camera;
  Pixel firstCell{0, 0};  ///< measured pixel of the centre of cell (0, 0)
  int cellPx = 1;         ///< side of a cell, px
  int columns = 0, rows = 0;
  std::vector<float> value;  ///< per cell, row by row: mean of its pixels
  std::vector<char> used;    ///< per cell: evidence. The others are there so that a blur has something to take in
  std::vector<char> onSurface;
  std::vector<Seen> seen;  ///< per cell; meaningless where onSurface is 0
  double top = 0;          ///< largest used value
  Pixel peak{0, 0};        ///< ideal pixel of the highlight's peak
  double radiusPx = 0;     ///< of the highlight's contour: mean of the semi-axes

  std::size_t size() const { return value.size(); }
  std::size_t usedCells() const;
};

struct PatchOptions {
  /// The patch reaches this many times the semi-axes of the highlight at half its peak: Gaussian lobes have fallen to 0.1 %,
  /// GGX's to 3 %, and what remains is background.
  double reach = 3.2;
  int cells = 3000;   ///< about as many; cells grow with the highlight
  double blurPx = 0;  ///< room for a blur of this standard deviation around the cells that are used
};

/// @param highlight  ideal pixels, with its ellipse. @param others  highlights of other lights in this frame: their
///                   surroundings are left out.
/// TooFewPoints where fewer than 30 cells can be used; NotSupported without an ellipse.
Outcome<PixelPatch> pixelPatch(const LinearPixels& pixels, const Camera& camera, const Surface& surface, int frame,
                               const Highlight& highlight, const std::vector<Highlight>& others,
                               const PatchOptions& options = {});

/// The same pixels where camera and surface were carried together.
/// @param by  rigid, world
PixelPatch carriedBy(PixelPatch patch, const Eigen::Isometry3d& by);

/// The same pixels, joined with another surface under the same camera.
PixelPatch onSurface(PixelPatch patch, const Surface& surface);

}  // namespace glint
