// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/retexture.h"

#include <pybind11/stl.h>

#include <cstdint>

#include "core/highlight/report.h"
#include "core/report/evaluation.h"
#include "core/report/texts.h"
#include "core/retexture/wish.h"
#include "core/scene/outputs.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

/// A picture with what its files are checked against.
struct RetexturedHandle {
  Retextured result;
  std::string model, frame, input, given;  ///< given: the file of the texture or background; may be empty
  std::vector<std::string> warnings;
  std::shared_ptr<const Scene> scene;
};

/// Linear light as a file of a picture has it after decoding.
Image pictureFrom(py::handle array, const std::string& name) {
  Image image = imageFrom(array, name, true);
  if (image.channels != 3) throw py::value_error(name + ": expected (height, width, 3) linear values");
  for (const float v : image.data)
    if (v < 0) throw py::value_error(name + ": has a negative value");
  return image;
}

/// A path, or an array in its place.
void takePicture(py::handle given, const char* name, std::string& file, std::optional<Image>& picture) {
  if (given.is_none()) return;
  if (py::isinstance<py::str>(given) || py::hasattr(given, "__fspath__")) {
    file = py::module_::import("os").attr("fspath")(given).cast<std::string>();
    return;
  }
  picture = pictureFrom(given, name);
  file = name;
}

RetextureWish wishFrom(const py::dict& asked) {
  RetextureWish wish;
  wish.model = asked["model"].cast<std::string>();
  wish.shown = asked["shown"].cast<std::string>();
  wish.light = asked["light"].cast<std::string>();
  takePicture(asked["texture"], "texture", wish.texture, wish.picture);
  takePicture(asked["background"], "background", wish.background, wish.picture);
  wish.remove = asked["remove"].cast<bool>();
  wish.mapping = asked["mapping"].cast<std::string>();
  wish.shading = asked["shading"].cast<std::string>();
  wish.repeat = asked["repeat"].cast<double>();
  wish.albedo = asked["albedo"].cast<double>();
  wish.marginPx = asked["margin_px"].cast<double>();
  return wish;
}

RetexturedHandle retextured(const SceneHandle& scene, const RequestHandle* request, const InspectionHandle* previous,
                            const FrameName& frame, const py::dict& asked, py::handle settings, py::object progress) {
  RetextureWish wish = wishFrom(asked);
  wish.session = scene.input;
  InspectionRequest r = request ? request->request : InspectionRequest{};
  applySettings(settings, r.settings);
  const int index = scene.frameOf(frame);
  return withProgress(std::move(progress), [&](const ProgressFn& report) {
    RetexturedFrame made =
        retextureAsWished(scene.scene, r, index, wish, report, previous ? previous->inspection.get() : nullptr);
    if (!made.result) {
      if (std::optional<Failure> none = noUsableView(made.inspection)) throw CannotAnswer{*none};
      throw CannotAnswer{made.result.failure()};
    }
    RetexturedHandle out;
    out.warnings = warningsOf(made.inspection);
    out.warnings.insert(out.warnings.end(), made.result->remarks.begin(), made.result->remarks.end());
    out.result = *std::move(made.result);
    out.model = made.model;
    out.frame = scene.scene->frames[static_cast<std::size_t>(index)].id;
    out.input = scene.input;
    if (!wish.picture) out.given = wish.texture.empty() ? wish.background : wish.texture;
    out.scene = scene.scene;
    return out;
  });
}

void savePicture(const RetexturedHandle& made, const std::string& file, const Image& picture) {
  Outputs(made.input, *made.scene).file(file, "file", OutputKind::png());
  if (!made.given.empty()) Outputs(std::vector<std::filesystem::path>{made.given}).file(file, "file", OutputKind::png());
  const py::gil_scoped_release release;
  writePng(file, picture);
}

std::vector<py::dict> appearancesIn(const RetexturedHandle& made) {
  std::vector<py::dict> out;
  for (const PredictedRadiance::OfLight& l : made.result.lights) {
    py::dict of;
    of["light"] = l.light;
    of["fall_by"] = nameOf(l.appearance.kind);
    of["strength"] = copyOf(l.appearance.strength);
    of["views"] = l.appearance.views;
    of["spread"] = l.appearance.spread;
    out.push_back(of);
  }
  return out;
}

}  // namespace

void declareRetexture(py::module_& module) {
  py::class_<RetexturedHandle>(module, "Retextured",
                               "A frame's predicted highlight over another picture, or the frame without it.")
      .def_readonly("model", &RetexturedHandle::model, "Id of the model that predicted.")
      .def_readonly("frame", &RetexturedHandle::frame, "Id of the frame.")
      .def_property_readonly(
          "picture", [](py::object self) { return viewOf(self.cast<const RetexturedHandle&>().result.picture, self); },
          "(h, w, 3) float32, sRGB 0 .. 1.")
      .def_property_readonly(
          "marks",
          [](py::object self) {
            const Retextured& r = self.cast<const RetexturedHandle&>().result;
            static_assert(sizeof(RetextureMark) == sizeof(std::uint8_t));
            return viewOf(py::dtype::of<std::uint8_t>(), {r.picture.height, r.picture.width}, r.marks.data(), self);
          },
          "(h, w) uint8: 0 as it was, 1 extrapolated beyond prediction and training pixels, 2 predicted or filled.")
      .def_property_readonly("lights", &appearancesIn,
                             "List of dictionaries: light, fall_by (in words), strength (3,) in linear light (1 = the largest "
                             "code), views, and spread:\n(largest - smallest) / median of the strength over the training views.")
      .def_property_readonly(
          "clipped_share", [](const RetexturedHandle& r) { return r.result.clippedShare; },
          "Share of the changed pixels that are brighter than the largest code.")
      .def_readonly("warnings", &RetexturedHandle::warnings, "Assumptions that may not hold, in words.")
      .def(
          "save", [](const RetexturedHandle& r, const std::string& file) { savePicture(r, file, r.result.picture); },
          py::arg("file"), "Writes the picture as PNG, as `glint retexture -o`; whole or not at all. InputError where it cannot.")
      .def(
          "save_marks", [](const RetexturedHandle& r, const std::string& file) { savePicture(r, file, markPicture(r.result)); },
          py::arg("file"), "Writes the marks as PNG, as `glint retexture --marks`: black, grey, white.")
      .def("__repr__",
           [](const RetexturedHandle& r) { return "<glint.Retextured frame " + r.frame + ", model " + r.model + ">"; });
  module.def("_retexture", &retextured);
}

}  // namespace glint::python
