// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/capture/capture.h"
#include "core/scene/scene.h"

namespace glint {

/// The scene of a capture: lengths in metres, a surface, ids of frames (the image's name without folder and ending; with the folder
/// where names repeat). InputError where no surface, or more than one, is named or found, or a choice does not fit the capture.
///
/// The surface is `choices.surfaceFile`, else the mesh that the capture names, else the only mesh in its folder (`mesh.*` before
/// others; a PLY without faces does not count), else the frames' own depth maps.
Scene sceneOfCapture(const Capture& capture, const ReadOptions& options);

/// What a capture is read with.
CaptureOptions captureOptionsOf(const ReadOptions& options);
/// The same of a scene that was read: for its sparse points.
CaptureOptions captureOptionsOf(const Scene& scene);

}  // namespace glint
