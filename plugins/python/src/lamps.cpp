// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <cmath>

#include "core/app/ball_photographs.h"
#include "core/report/measured_lamps.h"
#include "core/scene/frame_name.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

LampsReport lampsOf(const SceneHandle& scene, const std::optional<std::string>& exclude, const std::string& source,
                    py::handle settings, py::object progress) {
  InspectionRequest request;
  if (source == "image") request.source = FrameSource::Image;
  applySettings(settings, request.settings);
  if (exclude) request.excluded = parseFrames(*exclude, *scene.scene, "--exclude");
  if (request.excluded.size() == scene.scene->frames.size())
    throw InputError("", "--exclude " + exclude.value_or(""), "excludes every frame");
  return withProgress(std::move(progress), [&](const ProgressFn& report) {
    const Inspection inspection = inspect(scene.scene, lampsRequest(request, *scene.scene), report);
    return lampsReportOf(inspection, scene.input, report);
  });
}

LampsReport lampsOfBalls(const std::string& folder, const std::vector<std::string>& balls, std::optional<double> radius,
                         const std::string& camera, const std::string& exclude, const std::string& outlines,
                         double outlineSigmaPx, const std::string& response, py::object progress) {
  BallQuestion question;
  question.input = folder;
  for (const std::string& text : balls) question.balls.push_back(namedBall(text));
  if (question.balls.empty()) throw py::value_error("balls: is empty");
  question.exclude = exclude;
  if (radius && !(*radius > 0 && std::isfinite(*radius)))
    throw InputError("", "--ball-radius", "expected a radius in metres, above 0");
  question.ballRadius = radius;
  question.outlines = outlinesOf(outlines);
  question.outlineSigmaPx = outlineSigmaPx;
  if (!(outlineSigmaPx > 0 && std::isfinite(outlineSigmaPx)))
    throw InputError("", "--outline-sigma", "expected a number of pixels above 0");
  if (!camera.empty()) question.camera = cameraOfNumbers(cameraNumbers(camera, "--camera"));
  std::error_code ignored;  // what cannot be asked about is no folder
  if (!std::filesystem::is_directory(folder, ignored))
    throw InputError(folder, "", "with --ball, INPUT is a folder of photographs");
  InputChoices choices;
  choices.response = response;
  return withProgress(std::move(progress), [&](const ProgressFn& report) {
    BallShots shots = ballShotsIn(folder, question.balls, question.exclude);
    shots.response = responseOf(choices);
    return valueOf(lampsReportOf(question, shots, report));
  });
}

void declareLamp(py::module_& module) {
  py::class_<LampAnswer>(module, "Lamp", "Where a lamp is, or why that is not known.")
      .def_readonly("id", &LampAnswer::id, "Id.")
      .def_readonly("frames", &LampAnswer::frames, "Ids of the frames that show it.")
      .def_property_readonly(
          "frame", [](const LampAnswer& l) { return l.frame ? std::optional<std::string>(nameOf(*l.frame)) : std::nullopt; },
          "In which coordinates it stands still: \"world\" or \"camera\"; None of photographs of balls.")
      .def_property_readonly(
          "failure", [](const LampAnswer& l) { return messageOrNone(l.failure ? &*l.failure : nullptr); },
          "Why nothing is known, or None.")
      .def_property_readonly(
          "position", [](const LampAnswer& l) { return arrayOrNone(l.position); },
          "(3,) where the data determine a distance, else None.")
      .def_property_readonly(
          "covariance", [](const LampAnswer& l) { return arrayOrNone(l.covariance); }, "(3, 3) of the position, or None.")
      .def_readonly("without_position", &LampAnswer::withoutPosition, "Why there is no position, in words.")
      .def_property_readonly(
          "direction", [](const LampAnswer& l) { return arrayOrNone(l.failure ? std::nullopt : std::optional(l.direction)); },
          "(3,) unit vector from `origin` towards the lamp, or None.")
      .def_property_readonly(
          "direction_sigma_deg", [](const LampAnswer& l) { return l.directionSigma * 180 / M_PI; },
          "Standard deviation of the direction, degrees.")
      .def_property_readonly(
          "origin", [](const LampAnswer& l) { return arrayOrNone(l.from); },
          "(3,) middle of the object; None without a focal length.")
      .def_readonly("residual_px", &LampAnswer::residualPx, "Root mean square over its highlights, px.")
      .def_readonly("highlights", &LampAnswer::highlights, "How many were used.")
      .def_readonly("solver", &LampAnswer::solver, "For lamps of a scene: \"pixels\", \"contours\", \"bundle\", ...")
      .def_readonly("remarks", &LampAnswer::remarks, "What makes the answer doubtful, in words.")
      .def("__repr__", [](const LampAnswer& l) { return "<glint.Lamp " + l.id + (l.failure ? ", not known>" : ">"); });
}

}  // namespace

void declareLamps(py::module_& module) {
  declareLamp(module);
  py::class_<LampsReport>(module, "Lamps", "What `glint lights` finds.")
      .def_readonly("lamps", &LampsReport::lamps, "List of Lamp.")
      .def_readonly("length_unit", &LampsReport::lengthUnit, "\"m\", \"ball radius\"; empty = no lengths are known.")
      .def_readonly("warnings", &LampsReport::warnings, "In words.")
      .def(
          "to_json", [](const LampsReport& r) { return lampsJson(r); }, "The text that `glint lights --json` writes.")
      .def(
          "to_csv", [](const LampsReport& r) { return lampsCsv(r); }, "One row per lamp.")
      .def(
          "table", [](const LampsReport& r) { return lampsTable(r); }, "The table that `glint lights` prints.")
      .def_property_readonly("_failure", [](const LampsReport& r) { return partsOrNone(nothingMeasured(r)); })
      .def("__len__", [](const LampsReport& r) { return r.lamps.size(); });
  module.def("_lights", &lampsOf);
  module.def("_lights_of_balls", &lampsOfBalls);
}

}  // namespace glint::python
