// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/geometry/camera.h"
#include "core/scene/correction.h"

namespace glint {

/// By which factor an image is smaller or larger than the camera says, exact to a pixel in both directions. Nothing where it has
/// the camera's size, or another shape.
std::optional<double> imageScale(int width, int height, const Camera& camera);

/// The camera of the image resized to width x height px: (0, 0) is the centre of the first pixel, so cx becomes (cx + 0.5) s -
/// 0.5.
Camera resized(const Camera& camera, int width, int height);

/// "image-scale=0.5": for cameras of full photographs (images_2, images_4 of other programs). Nothing unless all photographs that
/// can be read ask for the same factor.
std::optional<Correction> imageScaleCorrection(const Scene& scene);

/// "camera-scale=0.5": for intrinsics of full photographs where only the principal point tells: it is the middle of pictures
/// twice, three times, ... as large. Nothing unless that holds in all frames.
std::optional<Correction> cameraScaleCorrection(const Scene& scene);

/// The scene with its cameras and given highlights for photographs that were resized by `scale`. Sizes are those of the files,
/// where these are within a pixel of it.
void applyImageScale(Scene& scene, double scale);

}  // namespace glint
