// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/retexture/texture_map.h"

namespace glint {

struct Inspection;

struct SurfaceTextureRequest {
  TextureMapping mapping = TextureMapping::Natural;
  double repeat = 1;  ///< textures across the surface, > 0
  /// px of the picture, 1 to kWidestTexture; 0 = a power of two whose texels are about as fine as the frames' pixels
  int width = 0;
  bool withoutShading = false;   ///< the Lambert shading under the estimated lights is divided out of each frame
  std::vector<int> frames = {};  ///< those that are asked; none = all that are not excluded
};
inline constexpr int kWidestTexture = 4096;

/// The colour of a surface without its highlights.
struct SurfaceTexture {
  Image colour;              ///< 3 channels, linear, exposed as most frames; texels that no view sees have the mean colour
  std::vector<int> views;    ///< per texel: that see it beside their highlights; 0 = none
  std::vector<float> codes;  ///< per texel: between the quarters of its views, in codes of 8 bits; 255 for a single view
  double albedo = 1;         ///< withoutShading: the texture's value where a frame is as bright as its shading
  int frames = 0;            ///< that were used
  std::string words;         ///< how it lies: "longitude and latitude"
  std::vector<std::string> remarks;  ///< what may not hold, for the user
};

/// A picture of the surface in the coordinates of TextureCoordinates, so that retexture() puts it back where it was. Texels
/// between the pixels of a frame are interpolated in linear light. Each texel keeps its seven best views (by angle,
/// resolution and distance from highlights) and becomes the mean of their middle half. Frames are read one after the other;
/// each is brought to the exposure of those before it, by the median ratio of the texels that they share.
/// @param inspection  with the highlights of all frames, and with lights where shading is divided out
/// NotSupported for frames without photographs, and for surfaces that differ between frames and have no coordinates of their own;
/// NoSurface; NoLight where shading is divided out; the first frame's failure where all fail. Stopped.
Outcome<SurfaceTexture> surfaceTexture(const Inspection& inspection, const SurfaceTextureRequest& request,
                                       const ProgressFn& progress = {});

/// sRGB and alpha, 4 channels: transparent where no view sees the surface.
Image texturePicture(const SurfaceTexture& texture);
/// How sure each texel is, as codes of 8 bits that end at 255: red the number of its views, green SurfaceTexture::codes.
Image surePicture(const SurfaceTexture& texture);

}  // namespace glint
