// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/inspect/inspection.h"

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

}  // namespace glint
