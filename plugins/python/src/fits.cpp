// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "core/base/number_text.h"
#include "core/model/model.h"
#include "core/pipeline/comparison.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

void declareLobe(py::class_<ModelFit>& fit) {
  fit.def_property_readonly(
         "lobe",
         [](const ModelFit& f) {
           const ReflectanceFit* const lobe = f.as<ReflectanceFit>();
           return lobe ? std::optional<std::string>(nameOf(lobe->lobe)) : std::nullopt;
         },
         "Name of the reflectance lobe, or None of models without one.")
      .def_property_readonly(
          "roughness",
          [](const ModelFit& f) {
            const ReflectanceFit* const lobe = f.as<ReflectanceFit>();
            return lobe ? std::optional(lobe->roughness.mean) : std::nullopt;
          },
          "m of the lobe, or None.")
      .def_property_readonly(
          "roughness_ratio",
          [](const ModelFit& f) {
            const ReflectanceFit* const lobe = f.as<ReflectanceFit>();
            return lobe && hasTwoWidths(lobe->lobe) ? std::optional(lobe->roughness.ratio) : std::nullopt;
          },
          "Width across the surface's tangent over that along it, of a lobe with two widths; else None.")
      .def_property_readonly(
          "lamp",
          [](const ModelFit& f) -> py::object {
            if (!f.lamp()) return py::none();
            py::dict out;
            out["shape"] = nameOf(f.lamp()->shape);
            addLamp(*f.lamp(), out);
            py::list outline;
            for (const std::vector<Eigen::Vector3d>& chain : outlineOf(*f.lamp()))
              outline.append(copyOf(Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                  chain.front().data(), static_cast<Eigen::Index>(chain.size()), 3)));
            out["outline"] = outline;
            return std::move(out);
          },
          "The lamp of a model with a lobe, or None: dict of `shape`, its place (`position`, `direction`, or the points of its "
          "shape, "
          "world), `radius` and `outline`, a list of (n, 3) chains to draw.")
      .def_property_readonly(
          "light_radius", [](const ModelFit& f) { return f.lamp() ? std::optional(radiusOf(*f.lamp())) : std::nullopt; },
          "Radius of a spherical lamp, world units; 0 for a point or a tube; None for models without a lobe.")
      .def_property_readonly(
          "light_segment",
          [](const ModelFit& f) {
            const auto ends = f.lamp() ? endsOf(*f.lamp()) : std::nullopt;
            std::optional<Eigen::Matrix<double, 2, 3>> rows;
            if (ends) rows.emplace() << ends->first.transpose(), ends->second.transpose();
            return arrayOrNone(rows);
          },
          "(2, 3) ends of a lamp with a length, world, or None.");
}

void declareFit(py::module_& module) {
  py::class_<ModelFit> fit(module, "ModelFit", "What fitting a model produced.");
  fit.def_readonly("model", &ModelFit::model, "Id of the model.")
      .def_readonly("light", &ModelFit::light, "Id of the light.")
      .def_readonly("surface", &ModelFit::surface, "Key of the surface, where the fit is of one only; else None.")
      .def_property_readonly(
          "ellipsoid", [](const ModelFit& f) { return f.ellipsoid() ? std::optional(*f.ellipsoid()) : std::nullopt; },
          "Ellipsoid of primal, dual and canonical, or None.")
      .def_property_readonly(
          "q_dual",
          [](const ModelFit& f) {
            const EllipsoidFit* const e = f.as<EllipsoidFit>();
            return arrayOrNone(e ? std::optional(e->quadric.matrix) : std::nullopt);
          },
          "(4, 4) dual quadric Q*, also where it is no ellipsoid; None of other models.")
      .def_property_readonly(
          "gap_ratio",
          [](const ModelFit& f) {
            const EllipsoidFit* const e = f.as<EllipsoidFit>();
            return e && !e->singularValues.empty() ? std::optional(e->gapRatio) : std::nullopt;
          },
          "Last over second last singular value; near 1 = ambiguous; None where nothing was solved.")
      .def_property_readonly(
          "light_estimate", [](const ModelFit& f) { return f.lightEstimate; }, "Light, or None.")
      .def_property_readonly(
          "light_covariance", [](const ModelFit& f) { return arrayOrNone(f.lightCovariance); },
          "(3, 3) of the light's position, squared world units, or None.")
      .def_property_readonly("limit_angle", &ModelFit::limitAngle, "rad, or None.")
      .def_property_readonly(
          "light_extent",
          [](const ModelFit& f) {
            const LimitAngleFit* const c = f.as<LimitAngleFit>();
            return c ? arrayOrNone(c->extent) : std::nullopt;
          },
          "(3, 3) second moment of an extended light, squared world units, of limit-angle; else None.")
      .def_readonly("condition", &ModelFit::condition, "Condition of the linear system, or of the rays that fix the light.")
      .def_property_readonly(
          "residual_px", [](py::object self) { return viewOf(self.cast<const ModelFit&>().residualPx, self); },
          "(n,) RMS contour distance of each training view, px.")
      .def_readonly("solver", &ModelFit::solver, "\"linear\", \"anchored\", \"refined\", \"bundle\", ...")
      .def_readonly("frames", &ModelFit::frames, "Frames used.")
      .def_readonly("warnings", &ModelFit::remarks, "What makes the answer doubtful, in words.")
      .def_readonly("poor", &ModelFit::poor, "Why it explains its training views badly; \"\" where it explains them.")
      .def_readonly("time_us", &ModelFit::timeUs, "Microseconds.")
      .def("__repr__", [](const ModelFit& f) {
        return "<glint.ModelFit of " + f.model + ", light " + f.light + ", " + std::to_string(f.frames.size()) + " views>";
      });
  declareLobe(fit);
}

void declarePrediction(py::module_& module) {
  py::class_<PredictedHighlight>(module, "PredictedHighlight", "One predicted highlight. Ideal pixels.")
      .def_property_readonly(
          "contour", [](py::object self) { return viewOf(self.cast<const PredictedHighlight&>().contour.points, self); },
          "(n, 2) px, closed over gaps; a view, without a copy.")
      .def_readonly("gaps", &PredictedHighlight::gaps,
                    "Segments of the contour (from vertex, to vertex) that bridge failed directions.")
      .def_property_readonly(
          "ellipse", [](const PredictedHighlight& h) { return h.ellipse; }, "Ellipse, or None.")
      .def_readonly("brightest_point", &PredictedHighlight::brightest, "Predicted BrightestPoint.")
      .def_property_readonly(
          "tangent_plane", [](const PredictedHighlight& h) { return h.tangentPlane; }, "Plane, or None.")
      .def_property_readonly(
          "canonical", [](const PredictedHighlight& h) { return h.canonical ? &*h.canonical : nullptr; },
          "CanonicalContour: directions with their ends on surface and tangent plane, or None.")
      .def_readonly("coverage", &PredictedHighlight::coverage, "Share of directions that gave a point.")
      .def_property_readonly(
          "sigma_px", [](py::object self) { return viewOf(self.cast<const PredictedHighlight&>().sigmaPx, self); },
          "(n,) px, or (0,): standard deviation across the contour at each vertex (setting predict.band).")
      .def("__repr__", [](const PredictedHighlight& h) {
        return formatted("<glint.PredictedHighlight at (%.6g, %.6g), %zu points, coverage %.3g>", h.brightest.pixel.x(),
                         h.brightest.pixel.y(), h.contour.points.size(), h.coverage);
      });
  py::class_<Prediction>(module, "Prediction", "What is predicted of one light in one view.")
      .def_property_readonly("highlights", &Prediction::highlights, "List of PredictedHighlight; empty where there is a failure.",
                             py::return_value_policy::reference_internal)
      .def_property_readonly(
          "failure", [](const Prediction& p) { return messageOrNone(p.failure()); }, "Why they are missing, or None.")
      .def_readonly("time_us", &Prediction::timeUs, "Microseconds.")
      .def("__len__", [](const Prediction& p) { return p.highlights().size(); })
      .def(
          "__getitem__",
          [](const Prediction& p, py::ssize_t i) -> const PredictedHighlight& {
            const auto n = static_cast<py::ssize_t>(p.highlights().size());
            if (i < 0) i += n;
            if (i < 0 || i >= n) throw py::index_error("no such highlight");
            return p.highlights()[static_cast<std::size_t>(i)];
          },
          py::return_value_policy::reference_internal);
}

}  // namespace

void addLamp(const Lamp& lamp, py::dict& out) {
  for (const LampField& f : fieldsOf(lamp)) {
    if (f.value.size() == 1) continue;
    if (f.value.rows() == 1)
      out[f.name.c_str()] = copyOf(Eigen::Vector3d(f.value.row(0)));
    else
      out[f.name.c_str()] = copyOf(f.value);
  }
  out["radius"] = radiusOf(lamp);
}

void declareFits(py::module_& module) {
  declareFit(module);
  declarePrediction(module);
}

}  // namespace glint::python
