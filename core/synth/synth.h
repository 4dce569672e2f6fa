// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/base/progress.h"
#include "core/scene/scene.h"
#include "core/synth/exact_highlight.h"
#include "core/synth/light_source.h"

namespace glint {

/// How frames are made from exact radiance.
struct RenderOptions {
  double exposure = 0;  ///< image = sRGB(exposure (specular + diffuse)); 0 = the brightest peak of the sequence becomes 0.9
  double noise = 0;     ///< standard deviation of Gaussian noise, as a fraction of the brightest peak
  double blurPx = 0;    ///< standard deviation of a Gaussian blur, px
  int bits = 8;         ///< of the images: 8, 16 (PNG, sRGB), or 32 (no photograph, the float radiance alone)
  int jpegQuality = 0;  ///< 1 to 100: images of 8 bits are JPEG files of this quality; 0 = PNG
  /// Rays per pixel side; 1 = through the pixel's centre, n = mean over an n x n grid in the pixel (box filter).
  int samples = 1;
  unsigned seed = 1;  ///< of the noise; frame i uses its own stream
};

/// A synthetic scene, read from SPEC.json (docs/formats.md, "Synth SPEC"): the scene without images, what its surfaces are
/// made of, and which contours to write. The same file without "render" asks for exact highlights only.
struct SynthSpec {
  Scene scene;
  Material material;
  ExactOptions exact;
  std::optional<RenderOptions> render;
};

/// InputError with file, place and reason.
///
/// Beside the keys of scene.json: `contour` ("radiance" or "limit-angle"), `level`, `limit_angle_deg`,
/// `margin_px` (exact contours are followed this far beyond the image); `path` in place of `frames`, with
/// `cameras` (list of camera_from_world) or `orbit` {centre, radius, from, to, height, count}: camera i at centre + (radius cos
/// a, radius sin a, height), a = from + (to - from) i / (count - 1) in radians, looking at the centre, image up = world +z;
/// `surface_steps` {surface, parameter, values or from, to, count}: every value is one surface, `SURFACE_STEP`, seen by every
/// camera, frame = cameras * step + camera.
SynthSpec readSynthSpec(const std::filesystem::path& file);

/// One exact frame, before noise, blur and quantisation. Pixel centres are the camera's measured (distorted) pixels.
struct RenderedFrame {
  Image specular;  ///< one channel
  Image diffuse;   ///< three channels
  Image depth;     ///< along the optical axis, 0 = nothing
  Image normals;   ///< world, camera's side; 0 where there is nothing
  Image mask;      ///< 1 on the surface
};
RenderedFrame renderFrame(const Surface& surface, const Camera& camera, const std::vector<TrueLight>& lights,
                          const Material& material, int samples = 1);

/// The two parts of the radiance of a frame, one channel each, the diffuse one for albedo 1, through the centres of measured
/// pixels; 0 where there is no surface. Rows run beside each other.
/// @param every  only each n-th pixel of both directions, repeated around (the middle one of its square). Stopped.
struct RenderedRadiance {
  Image specular, diffuse;
};
RenderedRadiance renderRadiance(const Surface& surface, const Camera& camera, const std::vector<TrueLight>& lights,
                                const Material& material, int every = 1, const ProgressFn& progress = {});

/// Makes everything that the specification asks for in `folder`: scene.json last, so that a folder with it is complete.
/// @return the scene as written. InputError when something cannot be written; Stopped.
Scene synthesise(const SynthSpec& spec, const std::filesystem::path& folder, const ProgressFn& progress = {});

/// Whether `synth` may write these files into `folder`: none of them exists, or an earlier run of it made the folder, which the
/// folder's scene.json says ("made_by"). The names of files are no sign of it: anyone may name highlights and files as `synth`
/// does. The write checks again (expectOutput).
/// @param names  relative to the folder
/// @throw InputError (the file that exists)
void requireSynthFolder(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& names);

}  // namespace glint
