// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "core/app/session.h"
#include "core/pipeline/level_choice.h"
#include "core/pipeline/live_prediction.h"
#include "core/pipeline/summary.h"
#include "core/report/masks.h"
#include "core/report/report.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/evaluation.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

py::dict statisticDict(const Statistic& s) {
  py::dict out;
  out["mean"] = s.mean;
  out["median"] = s.median;
  out["p95"] = s.p95;
  out["max"] = s.max;
  out["count"] = s.count;
  return out;
}

py::dict summaryOf(const InspectionHandle& handle, const std::string& model) {
  const auto it = handle.inspection->models.find(model);
  if (it == handle.inspection->models.end()) throw py::key_error("the inspection has no model '" + model + "'");
  const ModelSummary s = summarise(*handle.inspection, it->second);
  py::dict out;
  out["answered"] = s.answered;
  out["status"] = s.status();
  out["reason"] = s.reason;
  out["frames"] = s.frames;
  out["predicted"] = s.predicted;
  out["matched"] = s.matched;
  out["missed"] = s.missed;
  out["spurious"] = s.spurious;
  out["contour_error_pct"] = statisticDict(s.contourErrorPct);
  out["contour_error_px"] = statisticDict(s.contourErrorPx);
  out["ellipse_error_pct"] = statisticDict(s.ellipseErrorPct);
  out["hausdorff_px"] = statisticDict(s.hausdorffPx);
  out["iou"] = statisticDict(s.iou);
  out["peak_offset_px"] = statisticDict(s.peakOffsetPx);
  out["coverage"] = statisticDict(s.coverage);
  out["time_us"] = statisticDict(s.timeUs);
  return out;
}

py::dict lightsOf(const InspectionHandle& handle, const FrameName& frame) {
  const SceneHandle scene{handle.inspection->scene, nullptr, handle.context.input};
  py::dict out;
  for (const auto& [id, estimate] : handle.inspection->lightsFor(scene.frameOf(frame)))
    out[py::str(id)] = *estimate ? py::cast(**estimate) : py::object(py::str(estimate->failure().message()));
  return out;
}

/// Pointers, so that Python holds the parts themselves.
template <class Part>
std::vector<const Part*> partsOf(const std::vector<Part>& parts) {
  std::vector<const Part*> out;
  for (const Part& part : parts) out.push_back(&part);
  return out;
}

void declareModelResult(py::module_& module) {
  using Fit = ModelResult::Fit;
  py::class_<Fit>(module, "FitResult", "The fit of a model to one light (and one surface, with train=\"per-surface\").")
      .def_readonly("light", &Fit::light, "Id of the light.")
      .def_readonly("surface", &Fit::surface, "Key of the surface, or None.")
      .def_property_readonly(
          "fit", [](const Fit& f) { return f.fit ? &*f.fit : nullptr; }, "ModelFit, or None where it failed.")
      .def_property_readonly(
          "failure", [](const Fit& f) { return messageOrNone(f.failure()); }, "Why it failed, or None.")
      .def_property_readonly("status", &fitStatus,
                             "\"ok\", \"poor\" (it answers, but explains its training views badly) or \"failed\".")
      .def_property_readonly("reason", &fitReason, "Why it is poor or failed; \"\" where it is ok.");
  py::class_<ModelResult>(module, "ModelResult", "What one model did.")
      .def_readonly("model", &ModelResult::model, "Id of the model.")
      .def_property_readonly(
          "fits", [](const ModelResult& s) { return partsOf(s.fits); }, "List of FitResult.")
      .def_property_readonly(
          "frames", [](const ModelResult& s) { return partsOf(s.frames); },
          "List of FrameComparison. Every frame, training ones too; Inspection.held_out tells which count.");
}

void declareRequest(py::module_& module) {
  py::class_<RequestHandle>(module, "Request", "How a scene is inspected.")
      .def_property_readonly(
          "models", [](const RequestHandle& r) { return r.request.models; }, "Ids of the models.")
      .def_property_readonly(
          "train", [](const RequestHandle& r) { return r.request.train; }, "Which frames train, as `--train` takes it.")
      .def_property_readonly(
          "exclude", [](const RequestHandle& r) { return r.request.excluded; }, "Frames never used.")
      .def_property_readonly(
          "source", [](const RequestHandle& r) { return r.request.source == FrameSource::Image ? "image" : "radiance"; },
          "\"radiance\" or \"image\".")
      .def_property_readonly(
          "settings", [](const RequestHandle& r) { return dictOf(r.request.settings); }, "Every setting by its dotted name.")
      .def_property_readonly(
          "noise_px", [](const RequestHandle& r) { return r.request.noisePx; }, "Noise added to training contours, px.")
      .def_property_readonly(
          "seed", [](const RequestHandle& r) { return r.request.seed; }, "Seed of the noise.")
      .def_property_readonly(
          "truth", [](const RequestHandle& r) { return r.request.truthFolder; },
          "Folder of true contours; empty = own detection.");
}

void saveSession(const InspectionHandle& handle, const std::string& file, const std::string& notes, py::object progress) {
  const Scene& scene = *handle.inspection->given;
  if (scene.file.empty())
    throw py::value_error("the scene is of no file, so a session could not name it; save it first, and open that");
  Outputs(handle.context.input, scene).file(file, "file", OutputKind::document("glint_session"));
  withProgress(std::move(progress), [&](const ProgressFn& report) {
    Session session = sessionOf(*handle.inspection, report);
    session.file = file;
    session.notes = notes;
    writeSession(session, file);
    return 0;
  });
}

void writeLabelsOf(const InspectionHandle& handle, const std::string& folder, const std::string& formats,
                   const std::optional<std::string>& frames, py::object progress) {
  const LabelFormats wanted = labelFormatsFrom(formats);
  const Inspection& inspection = *handle.inspection;
  const std::vector<int> which = frames ? parseFrames(*frames, *inspection.scene, "--frames") : std::vector<int>{};
  withProgress(std::move(progress), [&](const ProgressFn& report) {
    writeLabels(inspection, folder, report, wanted, which);
    return 0;
  });
}

void declareParts(py::class_<InspectionHandle>& inspection) {
  inspection
      .def_property_readonly(
          "scene",
          [](const InspectionHandle& i) {
            return SceneHandle{i.inspection->scene, i.inspection->surfaces, i.context.input};
          },
          "Scene, in the coordinates in which its lights stand still (`light_frame`).")
      .def_property_readonly(
          "light_frame", [](const InspectionHandle& i) { return nameOf(i.inspection->lightFrame.frame); },
          "\"world\" or \"camera\": which coordinates `scene`, fits and views have.")
      .def_property_readonly(
          "request", [](const InspectionHandle& i) { return RequestHandle{i.inspection->request}; }, "Request that it answers.")
      .def_property_readonly(
          "train", [](const InspectionHandle& i) { return i.inspection->train.frames; }, "Training frames.")
      .def_property_readonly(
          "held_out",
          [](const InspectionHandle& i) {
            std::vector<int> out;
            for (int f = 0; f < static_cast<int>(i.inspection->scene->frames.size()); ++f)
              if (i.inspection->isHeldOut(f)) out.push_back(f);
            return out;
          },
          "Frames that count in summaries.")
      .def_property_readonly(
          "evidence", [](const InspectionHandle& s) { return partsOf(s.inspection->evidence); },
          "List of FrameEvidence, one per frame.")
      .def_property_readonly(
          "views", [](const InspectionHandle& s) { return partsOf(s.inspection->views); },
          "List of TrainingView, one per training highlight.")
      .def_property_readonly(
          "models",
          [](py::object self) {
            py::dict out;
            const Inspection& i = *self.cast<const InspectionHandle&>().inspection;
            for (const std::string& name : i.request.models)
              if (const auto it = i.models.find(name); it != i.models.end()) out[py::str(name)] = partOrNone(&it->second, self);
            return out;
          },
          "ModelResult by the model's id.")
      .def("lights", &lightsOf, py::arg("frame") = 0,
           "By light id: the LightEstimate that serves a frame, or why it is missing, in words. It is the light with which one "
           "limit angle\n"
           "explains the contours best; on wide highlights that is not the lamp's place: `glint.lights` measures lamps.");
}

}  // namespace

void declareInspections(py::module_& module) {
  declareRequest(module);
  declareModelResult(module);
  py::class_<InspectionHandle> inspection(
      module, "Inspection",
      "Everything that was computed: evidence, views, lights, fits, predictions, errors.\nParts keep it alive.");
  declareParts(inspection);
  inspection
      .def_property_readonly(
          "chosen_model", [](const InspectionHandle& i) { return i.context.chosenModel; }, "Id, or empty: none.")
      .def_property_readonly(
          "why_chosen", [](const InspectionHandle& i) { return i.context.whyChosen; }, "One sentence.")
      .def_property_readonly(
          "warnings", [](const InspectionHandle& i) { return warningsOf(*i.inspection); },
          "What makes the answers doubtful, in words.")
      .def_property_readonly("_failure", [](const InspectionHandle& i) { return partsOrNone(i.failure); })
      .def_property_readonly("_given",
                             [](const InspectionHandle& i) {
                               return SceneHandle{i.inspection->given, nullptr, i.context.input};
                             })
      .def("summary", &summaryOf, py::arg("model"),
           "What `glint evaluate` says of a model over held-out frames: counts, and statistics (mean, median, p95, max, count) "
           "of\n"
           "contour_error_pct, contour_error_px (px), iou, coverage, time_us and others; NaN where nothing was measured.")
      .def("drawing", &drawingOf, py::arg("frame") = py::none(),
           "What a 3D picture shows: a list of dictionaries, one for each thing, in world coordinates (m). Without a frame those "
           "of the\n"
           "whole scene: lights, lamps and ellipsoids of fits, true lamps. With one (number or id) also its surface and camera, "
           "what lies\n"
           "at its highlights, and contours on its surface. docs/python.md lists the keys.")
      .def(
          "to_json", [](const InspectionHandle& i) { return evaluationJson(*i.inspection, i.context); },
          "The text that `glint evaluate --json` writes.")
      .def(
          "to_csv", [](const InspectionHandle& i) { return evaluationCsv(*i.inspection); },
          "The text that `glint evaluate --csv` writes.")
      .def(
          "to_html", [](const InspectionHandle& i) { return evaluationHtml(*i.inspection, i.context); },
          "The page that `glint evaluate --html` writes.")
      .def(
          "table", [](const InspectionHandle& i) { return evaluationTable(*i.inspection); },
          "The table that `glint evaluate` prints.")
      .def("save_session", &saveSession, py::arg("file"), py::arg("notes") = "", py::arg("progress") = py::none(),
           "Writes a session, which `glint replay` and the inspector open; whole or not at all. InputError where it cannot.")
      .def("__repr__", [](const InspectionHandle& i) {
        return "<glint.Inspection of " + i.context.input + ", " + std::to_string(i.inspection->models.size()) + " models>";
      });
  module.def("_inspect", &inspectAsAsked);
  module.def("_write_labels", &writeLabelsOf);
}

}  // namespace glint::python
