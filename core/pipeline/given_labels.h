// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/scene.h"

namespace glint {

/// A scene whose highlights were drawn or corrected by hand.
struct LabelledScene {
  Scene scene;
  int frames = 0, highlights = 0;     ///< that the labels gave
  std::vector<std::string> warnings;  ///< one line each
};

/// The scene with the highlights of a COCO file: one that `predict --labels coco` wrote and a person corrected, or labels of
/// other origin. Frames with a label lose the highlights that they had at its level; all others keep theirs.
///   image       a frame: by its path in the scene, else by its name with or without ending, or the frame's id, if only one frame
///               has it. A warning lists others. Never opened
///   category    "highlight lamp" or "lamp" names the light if the scene knows it, else the light stays open
///   polygon     the largest of an annotation; minus half a pixel, and without the lens's distortion. Three corners suffice
///   attributes  "level" if present, else 0.5
/// A polygon has no peak. It takes that of the scene's own highlight inside of it, else that of the highlight detected there in
/// the photograph; else the polygon's centroid, with a warning.
/// @throw InputError (file, place) for a file that is no COCO, an image of another size than its frame, two images of one frame,
///        bit masks (RLE) or boxes alone, polygons outside of the image or without area, and if no image is a frame; Stopped
LabelledScene withLabels(const Scene& scene, const std::filesystem::path& file, const ProgressFn& progress = {});
/// The same from the file's text.
LabelledScene withLabels(const Scene& scene, const std::string& text, const std::string& file, const ProgressFn& progress);

}  // namespace glint
