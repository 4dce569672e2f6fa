// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "core/app/scene_places.h"
#include "core/app/session.h"
#include "core/pipeline/live_prediction.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

struct SessionHandle {
  Session session;
  SceneHandle scene;
  ScenePlaces places;
  std::string warning;
};

ScenePlaces placesFrom(bool allowOutside, std::vector<std::string> photographs, std::vector<std::string> files,
                       std::vector<std::string> mesh, std::vector<std::string> meshFolders,
                       std::map<std::string, std::string> reading) {
  for (const auto& given : reading) {
    std::string known;
    bool found = false;
    for (const ChoiceOption& option : choiceOptions()) {
      found = found || given.first == option.flag;
      known += (known.empty() ? "" : ", ") + std::string(option.flag);
    }
    if (!found) throw InputError("", given.first, "there is no such option; known: " + known);
  }
  ScenePlaces p;
  p.allowOutside = allowOutside;
  p.photographs = std::move(photographs);
  p.files = std::move(files);
  p.mesh = std::move(mesh);
  p.meshFolders = std::move(meshFolders);
  p.reading = std::move(reading);
  return p;
}

py::object open(const std::string& input, const ScenePlaces& places) {
  const bool isSession = std::filesystem::path(input).extension() == ".glint";  // as the command line tells them
  SessionHandle opened;
  {
    const py::gil_scoped_release release;
    if (isSession) {
      OpenedSession found = places.openSession(input);
      opened.session = std::move(found.session);
      opened.warning = std::move(found.warning);
      opened.scene.scene = std::move(found.scene);
    } else {
      opened.scene.scene = std::make_shared<const Scene>(places.read(input));
    }
    opened.scene.surfaces = std::make_shared<const SurfaceCache>(*opened.scene.scene);
  }
  opened.scene.input = input;
  opened.places = places;
  return isSession ? py::cast(std::move(opened)) : py::cast(std::move(opened.scene));
}

void declareReplay(py::module_& module) {
  py::class_<Replay>(module, "Replay", "What a replay of a session found.")
      .def_readonly("differences", &Replay::differences, "Key results beyond the tolerance, one line each; empty = they agree.")
      .def_readonly("first_changed", &Replay::firstChanged, "The first stage whose results differ, in words; empty = none.")
      .def_readonly("digest_agrees", &Replay::digestAgrees, "Whether all results are the same to the last bit.")
      .def_readonly("compared", &Replay::compared, "Number of key results.")
      .def_readonly("largest_difference", &Replay::largestDifference, "Largest difference of a key result, relative.");
}

/// A predictor with the scene that it is of.
struct PredictorHandle {
  std::shared_ptr<const LivePredictor> predictor;
};

PredictorHandle predictorOf(const SceneHandle& scene, const RequestHandle& request, py::object progress) {
  return {withProgress(std::move(progress), [&](const ProgressFn& report) {
    auto made = std::make_shared<const LivePredictor>(scene.scene, request.request, report);
    if (std::optional<Failure> none = made->failure()) throw CannotAnswer{*none};
    return made;
  })};
}

std::vector<std::tuple<std::string, std::string, Prediction>> predictLive(const PredictorHandle& handle, const std::string& id,
                                                                          const ArrayLike& pose, const Camera* camera) {
  const Eigen::Isometry3d from = poseFrom(pose, "camera_from_world");
  const py::gil_scoped_release release;
  LiveAnswer answer = valueOf(handle.predictor->predict(id, from, camera ? std::optional(*camera) : std::nullopt));
  std::vector<std::tuple<std::string, std::string, Prediction>> out;
  for (LiveHighlights& h : answer.highlights) out.emplace_back(h.model, h.light, std::move(h.prediction));
  return out;
}

}  // namespace

void declareSessions(py::module_& module) {
  declareReplay(module);
  py::class_<ScenePlaces>(module, "_Places").def(py::init(&placesFrom));
  py::class_<SessionHandle>(module, "Session", "A session *.glint: a scene, how it is inspected, and the key results of that.")
      .def_property_readonly(
          "file", [](const SessionHandle& s) { return s.session.file.string(); }, "As opened.")
      .def_readonly("scene", &SessionHandle::scene, "Scene.")
      .def_property_readonly(
          "request", [](const SessionHandle& s) { return RequestHandle{s.session.request}; },
          "Request: how the scene is inspected.")
      .def_property_readonly(
          "notes", [](const SessionHandle& s) { return s.session.notes; }, "Text of a person.")
      .def_property_readonly("_shown_model", [](const SessionHandle& s) { return s.session.view.model; })
      .def_property_readonly(
          "training", [](const SessionHandle& s) { return s.session.training; }, "Ids of the training frames when it was saved.")
      .def_property_readonly(
          "held_out", [](const SessionHandle& s) { return s.session.heldOut; }, "Ids of the held-out frames when it was saved.")
      .def_property_readonly(
          "key_results",
          [](const SessionHandle& s) {
            py::dict out;
            for (const auto& [name, value] : s.session.keyResults) out[py::str(name)] = value;
            return out;
          },
          "Numbers by stable names (\"canonical.contour_error_pct.mean\"); NaN = not defined.")
      .def_property_readonly(
          "digest", [](const SessionHandle& s) { return s.session.digest; }, "SHA-256 of all results; empty without results.")
      .def_property_readonly(
          "warnings",
          [](const SessionHandle& s) {
            std::vector<std::string> lines = s.session.warnings;
            if (!s.warning.empty()) lines.push_back(s.warning);
            return lines;
          },
          "Unknown keys and other oddities, in words.")
      .def(
          "replay",
          [](const SessionHandle& s, py::object progress) {
            return withProgress(std::move(progress),
                                [&](const ProgressFn& report) { return s.places.replay(s.session, report); });
          },
          py::arg("progress") = py::none(),
          "Computes everything again and compares, as `glint replay`. InputError where an input changed or is missing.")
      .def("__repr__", [](const SessionHandle& s) { return "<glint.Session " + s.session.file.string() + ">"; });
  module.def("_open", &open);
  py::class_<PredictorHandle>(module, "Predictor",
                              "Fits once, and predicts for poses that are in no scene, one after another: for trackers and AR.")
      .def(py::init(&predictorOf), py::arg("scene"), py::arg("request"), py::arg("progress") = py::none(),
           "Fits the request's models from its training frames. Raises CannotAnswer where no model was fitted.")
      .def("predict", &predictLive, py::arg("id"), py::arg("camera_from_world"), py::arg("camera") = py::none(),
           "Predictions for one pose.\n\nParameters\n----------\nid : str\n    Of a frame of the scene: its surface, lamps and "
           "intrinsics count. "
           "Another id: what all frames share.\ncamera_from_world : (4, 4) array\n    Rigid pose.\ncamera : Camera\n    "
           "Intrinsics and size, "
           "where they differ.\n\nReturns a list of (model id, light id, Prediction). Raises CannotAnswer where the intrinsics "
           "are not known.");
}

}  // namespace glint::python
