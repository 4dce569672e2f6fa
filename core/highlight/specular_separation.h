// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/highlight/background.h"
#include "core/highlight/highlight.h"

namespace glint {

/// The specular part of a colour image around one highlight: s = channels . I, the combination of channels in which the
/// surrounding diffuse colours vanish. It is linear, and so separates pixels on the edge of two colours as well.
struct SeparatedRegion {
  Eigen::Vector3d channels{0, 0, 0};    ///< of linear R, G, B; s is the specular radiance, averaged over the channels
  Eigen::Vector3d lampColour{1, 1, 1};  ///< of the specular part; mean 1
  Footprint footprint;                  ///< of the highlight, measured pixels
  double angleDeg = 0;                  ///< between the lamp's colour and the mean diffuse one
  double noise = 0;                     ///< standard deviation of s in one pixel, of the peak
  double leftover = 0;                  ///< rms of s around the highlight beyond noise and the lobe's tail, of the peak
};

/// How far an error of s, a share of the peak, moves the contour of a Gaussian lobe, px: as much as its slope says.
double movedBy(double shareOfPeak, const Highlight& highlight);

/// Whether a frame's highlights were separated from what is diffuse, all or none.
struct SpecularSeparation {
  bool separated = false;
  std::string reason;                    ///< in words: why not
  std::vector<SeparatedRegion> regions;  ///< one per highlight, in their order, if separated
};

/// Finds the combination of channels for one highlight, by the dichromatic model: I = m_d D + m_s S, with D of at most two
/// diffuse colours around the highlight (with any m_d, anywhere) and S the lamp's. Among the combinations that are 1 at the
/// highlight's middle it differs least from a lobe's tail around it, by least squares, which also weighs noise against leftover
/// diffuse light. S need not be known: an error of it along D changes nothing.
/// @param linear  3 channels. @param usable  one per pixel. @param clipValue  0 = none
/// @param highlight  measured pixels. @param others  highlights that the surroundings leave out. @return NotSupported, in words:
/// grey image, clipped pixels, no diffuse light (metal, black), a diffuse colour like the lamp's, over two colours, noise;
/// TooFewPoints; NotAnEllipse. @see Shafer, Using color to separate reflection components, Color Research and Application 1985;
/// the combination: Frost, An algorithm for linearly constrained adaptive array processing, Proc. IEEE 1972.
Outcome<SeparatedRegion> separateColours(const Image& linear, const std::vector<char>& usable, double clipValue,
                                         const Highlight& highlight, const std::vector<Highlight>& others);

/// Contours and peaks of the highlights on their specular part alone, with the same level: no diffuse gradient, no texture's edge
/// bends them, and no lobe's tail passes for background. All highlights are traced again or, with the reason, none.
/// @param highlights  measured pixels, as detected with these options; replaced if separated
SpecularSeparation separateHighlights(const Image& linear, const Image* mask, const DetectOptions& options,
                                      std::vector<Highlight>& highlights);

/// The specular part of a separated frame around its highlights, 3 channels, linear; 0 elsewhere and where it would be negative.
/// The rest of the image is the diffuse part.
Image specularPart(const Image& linear, const SpecularSeparation& separation);

}  // namespace glint
