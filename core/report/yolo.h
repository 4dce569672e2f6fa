// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// One model's predictions as labels of YOLO's segmentation format, in `folder`, which exists:
///   labels/0007.txt   a line for each highlight: class x1 y1 x2 y2 ..., of width and height, 0 .. 1 from edge to edge of the
///                     image (a pixel's centre x lies at (x + 0.5) / width). Empty if a frame shows none
///   classes.txt       "highlight lamp": one light a line, numbered from 0
///   notes.json        glint_yolo 1, model, files[]: file, frame, id, image, width, height, reason, highlights[]: line, class,
///                     light, coverage, truncated, occluded, edge_share, level; what the format has no room for
/// A file has the name of its photograph, without folder and ending; where two would have the same, all have the frames' ids.
/// InputError if it cannot be written.
void writeYolo(const Inspection& inspection, const std::string& model, const std::vector<int>& frames,
               const std::filesystem::path& folder);

/// Names without ending of the frames' label files, in the order of `frames`: all different.
std::vector<std::string> yoloNames(const Scene& scene, const std::vector<int>& frames);

}  // namespace glint
