// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "core/model/model.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/training.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

/// Held by Python; models live as long as the program.
struct ModelHandle {
  const HighlightModel* model;
};

LightEstimate estimate(const std::vector<TrainingView>& views, py::handle settings) {
  const Settings s = settingsFrom(settings);
  if (views.empty()) throw py::value_error("views: is empty");
  const py::gil_scoped_release release;
  return valueOf(estimateLight(views, s));
}

LightEstimate knownLight(const Light& light, double limitAngle) {
  LightEstimate e;
  e.light = light;
  e.limitAngle = limitAngle;
  e.solver = "given";
  return e;
}

/// All views must be of one light and have a surface where the model needs one.
void requireViews(const HighlightModel& model, const std::vector<TrainingView>& views) {
  if (views.empty()) throw py::value_error("views: is empty");
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].highlight.light != views.front().highlight.light)
      throw py::value_error("views[" + std::to_string(i) + "]: is of light '" + views[i].highlight.light + "', the first of '" +
                            views.front().highlight.light + "'; a fit is of one light");
    if (!views[i].surface && model.needsLight()) throw py::value_error("views[" + std::to_string(i) + "]: has no surface");
  }
}

ModelFit fit(const ModelHandle& handle, const std::vector<TrainingView>& views, const std::optional<LightEstimate>& light,
             py::handle settings, py::object progress) {
  const Settings s = settingsFrom(settings);
  requireViews(*handle.model, views);
  return withProgress(std::move(progress), [&](const ProgressFn& report) {
    std::optional<Outcome<LightEstimate>> of;
    if (light) of = *light;
    if (!light && handle.model->needsLight()) of = estimateLight(views, s);
    ModelFit fitted = valueOf(fitModel(*handle.model, views, of, s, {}, report));
    fitted.model = handle.model->id();
    fitted.light = views.front().highlight.light;
    return fitted;
  });
}

Prediction predict(const ModelHandle& handle, const ModelFit& fitted, const Camera& camera, const SurfaceHandle* surface,
                   py::handle settings) {
  const Settings s = settingsFrom(settings);
  if (fitted.model != handle.model->id())
    throw py::value_error("fit: is of model '" + fitted.model + "', not of '" + handle.model->id() + "'");
  if (!surface && handle.model->traits().mirrored)
    throw CannotAnswer{{Reason::NoSurface, handle.model->id() + " needs a surface"}};
  const py::gil_scoped_release release;
  Prediction p = handle.model->predict(fitted, camera, surface ? surface->surface.get() : nullptr, s);
  if (p.failure()) throw CannotAnswer{*p.failure()};
  return p;
}

std::string colourOf(const HighlightModel& m) {
  const auto [r, g, b] = m.traits().rgb;
  char text[8];
  for (int i = 0, v[3] = {r, g, b}; i < 3; ++i) {
    text[1 + 2 * i] = "0123456789abcdef"[(v[i] >> 4) & 15];
    text[2 + 2 * i] = "0123456789abcdef"[v[i] & 15];
  }
  text[0] = '#';
  text[7] = 0;
  return text;
}

}  // namespace

void declareModels(py::module_& module) {
  py::class_<ModelHandle>(module, "Model",
                          "A model of highlights: fitted to training views, it predicts contours for other cameras.")
      .def_property_readonly(
          "id", [](const ModelHandle& m) { return m.model->id(); }, "\"canonical\"")
      .def_property_readonly(
          "title", [](const ModelHandle& m) { return m.model->title(); }, "\"Canonical JOLIMAS\"")
      .def_property_readonly(
          "assumption", [](const ModelHandle& m) { return m.model->assumption(); }, "One sentence.")
      .def_property_readonly(
          "reference", [](const ModelHandle& m) { return m.model->reference(); }, "The paper.")
      .def_property_readonly(
          "needs_light", [](const ModelHandle& m) { return m.model->needsLight(); }, "Whether a fit uses the light's place.")
      .def_property_readonly(
          "colour", [](const ModelHandle& m) { return colourOf(*m.model); }, "\"#rrggbb\", its colour in every view and report.")
      .def("_fit", &fit)
      .def("_predict", &predict)
      .def("__repr__", [](const ModelHandle& m) { return "<glint.Model " + m.model->id() + ">"; });
  module.def(
      "models",
      [] {
        std::vector<ModelHandle> all;
        for (const auto& m : allModels()) all.push_back({m.get()});
        return all;
      },
      "All models, from simple to rich.");
  module.def(
      "model", [](const std::string& id) { return ModelHandle{&modelByName(id)}; }, py::arg("id"),
      "The model of this name. InputError, with the known names, if it is unknown.");
  py::class_<LightEstimate>(module, "LightEstimate", "The light of some views, with what the contours say of it.")
      .def(py::init(&knownLight), py::arg("light"), py::arg("limit_angle") = 0.0,
           "A light that is known already. limit_angle : rad, of its contours.")
      .def_readonly("light", &LightEstimate::light, "Light.")
      .def_property_readonly(
          "covariance", [](const LightEstimate& e) { return arrayOrNone(e.covariance); },
          "(3, 3) of the position, squared world units; None where it is not known.")
      .def_readonly("limit_angle", &LightEstimate::limitAngle, "rad: robust mean over all contour points.")
      .def_readonly("condition", &LightEstimate::condition,
                    "Condition of the triangulation, in (0, 1]; small = rays nearly parallel.")
      .def_readonly("rms_px", &LightEstimate::rmsPx, "RMS of the bundle's residuals, px; 0 when triangulated.")
      .def_property_readonly(
          "residual_px", [](py::object self) { return viewOf(self.cast<const LightEstimate&>().residualPx, self); },
          "(n,) px, of the views that were used.")
      .def_readonly("solver", &LightEstimate::solver, "\"bundle\", \"triangulated\" or \"given\".")
      .def_property_readonly(
          "extent", [](const LightEstimate& e) { return arrayOrNone(e.extent); },
          "(3, 3) second moment of an extended light, squared world units; else None.");
  module.def("_estimate_light", &estimate);
}

}  // namespace glint::python
