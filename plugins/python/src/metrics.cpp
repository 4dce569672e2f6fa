// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/metrics.h"

#include <pybind11/stl.h>

#include "core/pipeline/comparison.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

Polyline closedFrom(py::handle points, const std::string& name) {
  Polyline line{pointsFrom<2>(points, name), true};
  if (line.points.size() < 3)
    throw py::value_error(name + ": must have at least 3 points, has " + std::to_string(line.points.size()));
  return line;
}

std::vector<Polyline> regionFrom(py::handle given, const std::string& name) {
  // One contour, or several.
  if (py::isinstance<py::array>(given)) return {closedFrom(given, name)};
  if (!py::isinstance<py::sequence>(given)) throw py::type_error(name + ": expected a contour (n, 2) or a list of contours");
  std::vector<Polyline> lines;
  for (const py::handle one : given) lines.push_back(closedFrom(one, name + "[" + std::to_string(lines.size()) + "]"));
  return lines;
}

ContourMetrics compare(const ArrayLike& observed, const ArrayLike& predicted, const std::vector<std::pair<int, int>>& gaps,
                       const ArrayLike& observedPeak, const ArrayLike& predictedPeak) {
  const Polyline o = closedFrom(observed, "observed"), p = closedFrom(predicted, "predicted");
  const auto n = static_cast<int>(p.points.size());
  for (const auto& [from, to] : gaps)
    if (from < 0 || to < 0 || from >= n || to >= n) throw py::value_error("gaps: names a vertex that predicted does not have");
  // Where no peak is given, the middles stand for both, so that the offset between peaks is that of the centres.
  const Pixel peakO = observedPeak.is_none() ? centroid(o) : Pixel(vectorFrom<2>(observedPeak, "observed_peak"));
  const Pixel peakP = predictedPeak.is_none() ? centroid(p) : Pixel(vectorFrom<2>(predictedPeak, "predicted_peak"));
  std::optional<Ellipse> ellipse;
  if (const Outcome<Ellipse> fitted = fitEllipse(p.points)) ellipse = *fitted;
  const py::gil_scoped_release release;
  return compareContours(o, p, gaps, ellipse, peakO, peakP);
}

void declareComparison(py::module_& module) {
  using Row = FrameComparison::Row;
  py::class_<Row>(module, "ComparisonRow", "A matched pair of highlights, a missed or a spurious one.")
      .def_readonly("observed", &Row::observed, "Index among the frame's highlights; -1 = spurious.")
      .def_readonly("predicted", &Row::predicted, "Index in prediction.highlights; -1 = missed.")
      .def_property_readonly(
          "metrics", [](const Row& r) { return r.metrics; }, "ContourMetrics of a matched pair, or None.")
      .def_property_readonly(
          "failure", [](const Row& r) { return messageOrNone(r.failure ? &*r.failure : nullptr); }, "Why not, or None.");
  py::class_<FrameComparison>(module, "FrameComparison",
                              "Prediction of one model for one light in one frame, against the evidence.")
      .def_readonly("frame", &FrameComparison::frame, "Index of the frame.")
      .def_readonly("light", &FrameComparison::light, "Id of the light.")
      .def_readonly("prediction", &FrameComparison::prediction, "Prediction.")
      .def_readonly("rows", &FrameComparison::rows, "List of ComparisonRow.")
      .def_readonly("iou", &FrameComparison::iou, "Over the union of all regions of this light.");
}

}  // namespace

void declareMetrics(py::module_& module) {
  py::class_<ContourMetrics>(module, "ContourMetrics", "A predicted contour against an observed one.")
      .def_readonly("contour_error_px", &ContourMetrics::contourErrorPx, "Symmetric mean distance, px.")
      .def_readonly("contour_error_pct", &ContourMetrics::contourErrorPct,
                    "The same in percent of the observed equivalent diameter.")
      .def_readonly("ellipse_error_pct", &ContourMetrics::ellipseErrorPct, "The same between ellipses; NaN without one.")
      .def_readonly("hausdorff_px", &ContourMetrics::hausdorffPx, "Largest distance, px.")
      .def_readonly("iou", &ContourMetrics::iou, "Overlap of the filled contours, 0 .. 1.")
      .def_readonly("centre_offset_px", &ContourMetrics::centreOffsetPx, "Between area centroids, px.")
      .def_readonly("axis_ratio_error", &ContourMetrics::axisRatioError, "Difference of the ellipses' axis ratios.")
      .def_readonly("angle_error_deg", &ContourMetrics::angleErrorDeg, "Between the longer axes, 0 .. 90 degrees.")
      .def_readonly("peak_offset_px", &ContourMetrics::peakOffsetPx, "Between peaks, px.");
  module.def(
      "compare_contours", &compare, py::arg("observed"), py::arg("predicted"), py::kw_only(),
      py::arg("gaps") = std::vector<std::pair<int, int>>{}, py::arg("observed_peak") = py::none(),
      py::arg("predicted_peak") = py::none(),
      "The metrics of `glint evaluate` for two closed contours.\n\nParameters\n----------\nobserved, predicted : (n, 2) array, "
      "px\ngaps : list of (from vertex, to vertex)\n    Segments of `predicted` that are not part of it.\nobserved_peak, "
      "predicted_peak : (2,) array, px\n    Default: the contours' centroids.");
  module.def(
      "iou",
      [](const ArrayLike& a, const ArrayLike& b, double cell) {
        if (!(cell > 0) || !std::isfinite(cell)) throw py::value_error("cell_px: must be above 0");
        const auto ra = regionFrom(a, "a"), rb = regionFrom(b, "b");
        const py::gil_scoped_release release;
        return regionIou(ra, rb, cell);
      },
      py::arg("a"), py::arg("b"), py::arg("cell_px") = 0.1,
      "Intersection over union of two regions, each a closed contour (n, 2) in px or a list of them; exact up to a raster of "
      "cell_px.");
  declareComparison(module);
}

}  // namespace glint::python
