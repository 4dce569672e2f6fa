// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// A predicted highlight as a label of the captured image, whatever the format that it is written in.
struct LabelShape {
  int frame = 0;
  int light = 0;           ///< index in LabelSet::lights
  Polyline polygon;        ///< closed, measured pixels, within the image: from -0.5 to width - 0.5 and height - 0.5; no gap
  double areaPx2 = 0;      ///< of the polygon, shoelace
  double level = 0;        ///< of the contour
  double coverage = 1;     ///< PredictedHighlight::coverage
  bool truncated = false;  ///< the image's edge, or the end of the lens, cuts it
  bool occluded = false;   ///< the surface ends or hides itself there: the highlight goes on where no image shows it
  double edgeShare = 0;    ///< of the contour, by length: runs along such an edge; 0 of models that know no surface
};

/// The labels of one model.
struct LabelSet {
  /// With a fit, whether a frame shows them or not: categories do not depend on the frames chosen.
  std::vector<std::string> lights;
  std::vector<LabelShape> shapes;      ///< by frame, light and highlight
  std::map<int, std::string> reasons;  ///< of frames without a shape
};

/// @param frames  which are labelled
LabelSet labelsOf(const Inspection& inspection, const std::string& model, const std::vector<int>& frames);

/// "highlight lamp": what a light's labels are called.
std::string categoryOf(const std::string& light);

/// The file that shows a frame's highlights, relative to the scene; "" without one: the scene names no picture, the file is
/// not there, or the highlights are synthesised and the photograph shows others.
std::string shownIn(const Inspection& inspection, const Frame& frame);

/// The share of a contour, by length, along which the surface ends, or hides what lies behind it: there the points just inside
/// and just outside of the contour are not neighbours on the surface.
/// @param contour  closed, ideal pixels
double edgeShareOf(const Polyline& contour, const Camera& camera, const Surface& surface);

}  // namespace glint
