// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/evidence.h"

#include <pybind11/stl.h>

#include <cmath>

#include "core/base/number_text.h"
#include "core/geometry/camera.h"
#include "core/pipeline/training.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

Highlight highlightFrom(const ArrayLike& contour, const ArrayLike& peak, const std::string& light, double level) {
  Highlight h;
  h.fromScene = true;
  h.light = light;
  h.level = level;
  if (!(level > 0 && level < 1)) throw py::value_error("level: must be a fraction of the peak, more than 0 and less than 1");
  h.contour.points = pointsFrom<2>(contour, "contour");
  if (h.contour.points.size() < 5)
    throw py::value_error("contour: must have at least 5 points, has " + std::to_string(h.contour.points.size()));
  h.peak = vectorFrom<2>(peak, "peak");
  const double area = signedArea(h.contour);
  if (!(std::abs(area) > 0)) throw py::value_error("contour: has no area");
  // One orientation for all contours, whatever their origin; the first point stays first.
  if (area < 0) std::reverse(h.contour.points.begin() + 1, h.contour.points.end());
  h.areaPx2 = std::abs(area);
  if (Outcome<Ellipse> ellipse = fitEllipse(h.contour.points)) h.ellipse = *ellipse;
  return h;
}

std::vector<Highlight> detect(const ArrayLike& linear, const ArrayLike& mask, const std::string& light, py::handle settings) {
  // A pixel without a value is no error: detection names it where it matters.
  const Image image = imageFrom(linear, "image", false);
  if (image.channels != 1 && image.channels != 3) throw py::value_error("image: expected 1 or 3 channels");
  std::optional<Image> on;
  if (!mask.is_none()) {
    py::array array = py::array::ensure(mask);
    if (array && array.dtype().kind() == 'b') array = array.attr("astype")("uint8").cast<py::array>();
    on = imageFrom(array ? py::handle(array) : py::handle(mask), "mask", true);
    if (on->channels != 1 || on->width != image.width || on->height != image.height)
      throw py::value_error("mask: must have one channel and the image's size");
  }
  Frame frame;
  frame.radiance = "array";  // float values, which have no largest code
  const DetectOptions options = detectOptionsFor(frame, FrameSource::Radiance, settingsFrom(settings));
  const py::gil_scoped_release release;
  std::vector<Highlight> found = valueOf(detectHighlights(image, on ? &*on : nullptr, options));
  for (Highlight& h : found) h.light = light;
  return found;
}

Highlight withoutLens(Highlight h, const Camera& camera) {
  if (!camera.hasDistortion()) return h;
  for (Pixel& p : h.contour.points) p = valueOf(withoutDistortion(camera, p));
  h.peak = valueOf(withoutDistortion(camera, h.peak));
  h.areaPx2 = std::abs(signedArea(h.contour));
  h.ellipse.reset();
  if (Outcome<Ellipse> ellipse = fitEllipse(h.contour.points)) h.ellipse = *ellipse;
  return h;
}

void declareHighlight(py::module_& module) {
  py::class_<Highlight>(module, "Highlight", "One highlight in one frame: evidence. Ideal pixels.")
      .def(py::init(&highlightFrom), py::arg("contour"), py::arg("peak"), py::arg("light") = "light", py::arg("level") = 0.5,
           "Parameters\n----------\ncontour : (n, 2) array, px\n    Closed, n >= 5, the first point not repeated.\npeak : (2,) "
           "array, "
           "px\nlight : str\n    Id of its light.\nlevel : float\n    Fraction of the peak above the background at which the "
           "contour "
           "lies.")
      .def_property_readonly(
          "contour", [](py::object self) { return viewOf(self.cast<const Highlight&>().contour.points, self); },
          "(n, 2) px, closed; a view, without a copy.")
      .def_property_readonly(
          "peak", [](const Highlight& h) { return copyOf(h.peak); }, "(2,) px.")
      .def_property_readonly(
          "ellipse", [](const Highlight& h) { return h.ellipse; }, "Least-squares Ellipse of the contour, or None.")
      .def_readonly("light", &Highlight::light, "Id of its light; empty while unknown.")
      .def_readonly("level", &Highlight::level, "Fraction of the peak above the background.")
      .def_readonly("peak_value", &Highlight::peakValue, "Radiance at the peak, background removed; 0 when unknown.")
      .def_readonly("area", &Highlight::areaPx2, "px^2.")
      .def_readonly("clipped", &Highlight::clipped, "Saturated: its peak is not known.")
      .def_readonly("touches_border", &Highlight::touchesBorder, "Cut by the image's border.")
      .def_readonly("peak_cut", &Highlight::peakCut, "Brightest at the border that cuts it: the peak lies beyond.")
      .def_readonly("from_scene", &Highlight::fromScene, "Given, not detected.")
      .def("undistorted", &withoutLens, py::arg("camera"),
           "The same highlight, seen in measured pixels of this camera, in ideal ones. Raises CannotAnswer where the lens shows "
           "none.")
      .def("__repr__", [](const Highlight& h) {
        return formatted("<glint.Highlight of %s at (%.6g, %.6g), %zu points>",
                         h.light.empty() ? "an unknown light" : h.light.c_str(), h.peak.x(), h.peak.y(), h.contour.points.size());
      });
}

void declareFrameEvidence(py::module_& module) {
  py::class_<FrameEvidence>(module, "FrameEvidence", "What one frame shows.")
      .def_readonly("frame", &FrameEvidence::frame, "Index of the frame.")
      .def_readonly("highlights", &FrameEvidence::highlights, "List of Highlight.")
      .def_property_readonly(
          "failure", [](const FrameEvidence& e) { return messageOrNone(e.failure ? &*e.failure : nullptr); },
          "Why they are missing, or None.")
      .def_property_readonly(
          "rejected",
          [](const FrameEvidence& e) {
            std::vector<std::pair<std::array<double, 2>, std::string>> out;
            for (const RejectedCandidate& r : e.rejected) out.push_back({{r.place.x(), r.place.y()}, r.reason});
            return out;
          },
          "What stands out and is no highlight, as a list of ((x, y) in measured px, reason).");
}

void declareViews(py::module_& module) {
  py::class_<CanonicalContour>(module, "CanonicalContour", "A contour carried to the tangent plane.")
      .def_property_readonly(
          "pixels", [](py::object self) { return viewOf(self.cast<const CanonicalContour&>().pixels, self); },
          "(n, 2) px: canonical points in the photograph; a view.")
      .def_property_readonly(
          "ellipse", [](const CanonicalContour& c) { return c.ellipse; }, "Ellipse of these points, or None.")
      .def_property_readonly(
          "on_surface",
          [](const CanonicalContour& c) {
            std::vector<Eigen::Vector3d> out;
            for (const DirectionResult& d : c.directions)
              if (d.limitAngle) out.push_back(d.onSurface);
            return ownedBy(std::move(out));
          },
          "(k, 3) world: where the walks that reached the limit angle ended on the surface.")
      .def_property_readonly(
          "on_tangent_plane",
          [](const CanonicalContour& c) {
            std::vector<Eigen::Vector3d> out;
            for (const DirectionResult& d : c.directions)
              if (d.limitAngle) out.push_back(d.onTangentPlane);
            return ownedBy(std::move(out));
          },
          "(k, 3) world: the same on the tangent plane.");
  py::class_<TrainingView>(module, "TrainingView", "One highlight that trains, with what the geometry adds.")
      .def(py::init([](const Camera& camera, const SurfaceHandle* surface, const Highlight& highlight, int frame) {
             FrameEvidence evidence;
             evidence.frame = frame;
             evidence.highlights = {highlight};
             return trainingView(evidence, 0, camera, surface ? surface->surface : nullptr);
           }),
           py::arg("camera"), py::arg("surface").none(true), py::arg("highlight"), py::arg("frame") = 0,
           "Parameters\n----------\ncamera : Camera\nsurface : Surface\n    None only for `primal`.\nhighlight : "
           "Highlight\nframe : "
           "int\n    A number that tells views apart.")
      .def_readonly("frame", &TrainingView::frame, "Index of the frame.")
      .def_readonly("camera", &TrainingView::camera, "Camera.")
      .def_readonly("highlight", &TrainingView::highlight, "Highlight.")
      .def_property_readonly(
          "failure",
          [](const TrainingView& v) {
            const std::optional<Failure> f = v.failure();
            return messageOrNone(f ? &*f : nullptr);
          },
          "Why the view cannot be used, or None.")
      .def_property_readonly(
          "brightest_point", [](const TrainingView& v) { return v.seen ? std::optional(v.seen->brightest) : std::nullopt; },
          "Observed BrightestPoint, or None.")
      .def_property_readonly(
          "tangent_plane", [](const TrainingView& v) { return v.seen ? std::optional(v.seen->tangentPlane) : std::nullopt; },
          "Plane there, its normal towards the camera, or None.")
      .def_property_readonly(
          "virtual_camera",
          [](const TrainingView& v) { return arrayOrNone(v.seen ? std::optional(v.seen->virtualCamera.matrix) : std::nullopt); },
          "(3, 4) projection P M, or None.")
      .def_property_readonly(
          "canonical", [](const TrainingView& v) { return v.canonical ? &*v.canonical : nullptr; },
          "CanonicalContour, once the light is known, or None.");
}

}  // namespace

void declareEvidence(py::module_& module) {
  declareHighlight(module);
  declareFrameEvidence(module);
  declareViews(module);
  module.def("_detect", &detect);
}

}  // namespace glint::python
