// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// Predicted contours of some frames: per frame, light and model the polyline (ideal pixels), ellipse, brightest point, coverage,
/// gaps and failed directions with their reasons. Keys as in docs/formats.md, "predict --json".
std::string predictionsJson(const Inspection& inspection, const std::vector<int>& frames);

/// COCO labels (images, annotations with segmentation polygons, bounding boxes and areas, one category per light) of one
/// model's predictions. COCO puts (0, 0) at the corner of the top-left pixel, so half a pixel is added; lens distortion is put back.
/// Where no photograph shows these highlights (none is named, its file is missing, the contours are synthesised), `file_name` is
/// the frame's id, and a `note` of the image and of `info` says so.
std::string cocoJson(const Inspection& inspection, const std::string& model, const std::vector<int>& frames);

}  // namespace glint
