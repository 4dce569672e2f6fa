// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/retexture/predicted_radiance.h"
#include "core/retexture/texture_map.h"

namespace glint {

/// What the predicted highlight is composited over.
enum class RetextureBase {
  Background,  ///< a picture without the highlight, of the frame's size
  Texture,     ///< the frame with another albedo on its surface
  Removed,     ///< the frame without its highlight, and no highlight over it
};

/// Where the shading under a texture comes from.
enum class ShadingSource {
  Auto,     ///< Lambert where the model or the inspection knows a light, else Frame
  Lambert,  ///< a matt surface of one albedo under the estimated lights, fitted to the frame (core/retexture/shading.h)
  Frame,    ///< the frame itself without its highlight: what is painted on the surface shows through
  None,     ///< 1: the texture is the light that the surface sends, as `glint texture` measures it
};
inline const std::vector<std::string> kShadingSources{"auto", "lambert", "frame", "none"};
/// std::invalid_argument for another name.
ShadingSource shadingSourceNamed(const std::string& name);

struct RetextureRequest {
  std::string model;
  std::string light = {};  ///< id; "" = every light
  RetextureBase base = RetextureBase::Background;
  Image picture = {};  ///< linear, 3 channels: background (of the frame's size) or texture
  TextureMapping mapping = TextureMapping::Natural;
  double repeat = 1;  ///< textures across the surface, > 0
  /// Albedo of the surface as it was, (0, 1]: a texture's values are then albedos. Without it, the texture's mean replaces it.
  std::optional<double> albedo;
  ShadingSource shading = ShadingSource::Auto;
  double marginPx = 4;  ///< Removed, Frame: beyond where the highlight can be seen, >= 0
};

/// What a pixel of the result is.
enum class RetextureMark : char {
  Untouched = 0,
  Extrapolated = 1,  ///< changed by a highlight where neither the prediction nor the training pixels reach
  Changed = 2,       ///< changed by a predicted highlight, or filled
};

struct Retextured {
  Image picture;                     ///< 3 channels, sRGB 0..1, of the frame's size
  std::vector<RetextureMark> marks;  ///< per pixel
  std::vector<PredictedRadiance::OfLight> lights;
  double clippedShare = 0;  ///< of the changed pixels that are brighter than the largest code, as a camera would clip them
  std::vector<std::string> remarks;  ///< assumptions that may not hold, for the user
};

/// The predicted highlight of a frame over another picture of it (retexturing), or the frame without it.
///
///   Background  I = B + H        in linear light per channel, H of predictedRadiance()
///   Texture     I = T shade / A + H   on the surface, T the texture's albedo, A its mean (or `albedo`); the frame elsewhere
///   Removed     I filled inside of the mask from around it (Telea's method); with a known light, I over the Lambert shading, so
///               that shading goes on underneath
/// The mask: where H changes a code by kVisibleCodes or more, and the predicted contour, both dilated by marginPx.
/// The frame's own mask, where there is one, bounds what is changed.
///
/// @param known  as predictedRadiance().
/// @param frame  of the inspection, which computed `request.model` for it.
/// Failures of predictedRadiance(); FrameUnreadable and NotSupported of a frame whose photograph is needed (Texture, Removed) and
/// missing; NoSurface for a texture without a surface; NoHighlight if the mask leaves nothing to fill from.
/// std::invalid_argument for a picture of another size. Stopped.
/// @see Telea, An image inpainting technique based on the fast marching method, Journal of Graphics Tools 2004.
Outcome<Retextured> retexture(const Inspection& inspection, int frame, const RetextureRequest& request,
                              const ProgressFn& progress = {}, LearnedAppearances* known = nullptr);

/// The marks as a picture: black, dark grey (half) and white.
Image markPicture(const Retextured& result);

}  // namespace glint
