// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/live_prediction.h"

namespace glint {

/// Predicted contours of some frames: per frame, light and model the polyline (ideal pixels), ellipse, brightest point, coverage,
/// gaps and failed directions with their reasons. Keys as in docs/formats.md, "predict --json".
std::string predictionsJson(const Inspection& inspection, const std::vector<int>& frames);

/// COCO labels of one model's predictions: images, annotations (polygon, bounding box, area by the shoelace formula), one
/// category for each light with a fit. COCO puts (0, 0) at the corner of the top-left pixel, so half a pixel is added; lens
/// distortion is put back. Polygons end at the image's edge. `attributes` of an annotation: coverage, truncated (by the image),
/// occluded (the surface ends or hides itself), edge_share, level. An image without annotation has a `reason`.
/// Where no photograph shows these highlights (none is named, its file is missing, the contours are synthesised), `file_name` is
/// the frame's id, and a `note` of the image and of `info` says so.
std::string cocoJson(const Inspection& inspection, const std::string& model, const std::vector<int>& frames);

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

/// What a line of a live stream says of its pose.
struct LivePose {
  std::string id;
  std::optional<double> time;  ///< s
};

/// One line of JSON in ASCII, with its line end: what was predicted for a pose. Keys as in docs/formats.md, "predict --stream".
/// @param timeUs  from the end of the pose's line to the contours
std::string liveLine(const LivePose& pose, const LiveAnswer& answer, double timeUs);

/// The same for a pose that could not be answered.
/// @param status  "failed" (there is no pose, or no camera for it) or "error" (the line is wrong)
/// @param id      "" = not known
std::string liveRefusal(const std::string& id, std::size_t line, const std::string& status, const std::string& reason);

}  // namespace glint
