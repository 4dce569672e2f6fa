// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <algorithm>
#include <set>

#include "core/advise/camera_check.h"
#include "core/app/scene_places.h"
#include "core/pipeline/evidence.h"
#include "core/scene/outputs.h"
#include "core/scene/scene.h"
#include "core/scene/scene_json.h"
#include "core/surface/mesh_policy.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {

int SceneHandle::frameOf(py::handle indexOrId) const {
  const auto n = static_cast<py::ssize_t>(scene->frames.size());
  if (py::isinstance<py::str>(indexOrId)) {
    const auto id = indexOrId.cast<std::string>();
    for (int i = 0; i < n; ++i)
      if (scene->frames[static_cast<std::size_t>(i)].id == id) return i;
    throw InputError(input, "frame '" + id + "'", "the scene has no such frame");
  }
  if (!PyIndex_Check(indexOrId.ptr()) || PyBool_Check(indexOrId.ptr())) throw py::type_error("frame: expected a number or an id");
  const py::ssize_t index = PyNumber_AsSsize_t(indexOrId.ptr(), PyExc_IndexError);
  if (index == -1 && PyErr_Occurred()) throw py::error_already_set();
  if (index < 0 || index >= n)
    throw py::index_error("frame: " + std::to_string(index) + " is not one of 0 to " + std::to_string(n - 1));
  return static_cast<int>(index);
}

namespace {

FrameSource sourceFrom(const std::string& source) {
  if (source == "radiance") return FrameSource::Radiance;
  if (source == "image") return FrameSource::Image;
  throw py::value_error("source: expected \"radiance\" or \"image\", not \"" + source + "\"");
}

const Frame& frameIn(const SceneHandle& s, const FrameName& frame) {
  return s.scene->frames[static_cast<std::size_t>(s.frameOf(frame))];
}

/// An array of what a reader of frames says: no copy of it.
template <class Read>
std::optional<py::array> arrayOf(const Read& read) {
  auto kept = std::make_unique<Image>();
  {
    const py::gil_scoped_release release;
    std::optional<Image> image = read();
    if (image) *kept = std::move(*image);
  }
  if (kept->empty()) return std::nullopt;
  Image* const image = kept.release();
  const py::capsule owner(image, [](void* p) { delete static_cast<Image*>(p); });
  return viewOf(*image, owner);
}

std::optional<py::array> linearOf(const SceneHandle& s, const FrameName& frame, const std::string& source) {
  const Frame& f = frameIn(s, frame);
  const FrameSource from = sourceFrom(source);
  return arrayOf([&] { return std::optional(valueOf(readLinear(f, from))); });
}

FrameEvidence evidenceOf(const SceneHandle& s, const FrameName& frame, const std::string& source, py::handle settings) {
  const int index = s.frameOf(frame);
  const FrameSource from = sourceFrom(source);
  const Settings how = settingsFrom(settings);
  const py::gil_scoped_release release;
  return gatherEvidence(*s.scene, index, from, how);
}

SurfaceHandle surfaceOf(const SceneHandle& s, const FrameName& frame, py::handle settings) {
  const int index = s.frameOf(frame);
  const MeshPolicy policy = meshPolicy(settingsFrom(settings));
  const py::gil_scoped_release release;
  return {valueOf(s.surfaces->surfaceOf(index, policy))};
}

py::dict lightOf(const TrueLight& light) {
  py::dict out;
  out["id"] = light.id;
  out["frame"] = nameOf(light.frame);
  out["known"] = light.known;
  if (light.sigma > 0) out[sigmaKey(light.lamp.atInfinity())] = light.sigma;
  addLamp(light.lamp, out);
  return out;
}

Frame frameFrom(const std::string& id, const Camera& camera, const std::string& surface, const std::vector<Highlight>& highlights,
                const std::vector<std::string>& lightsOn, const std::map<std::string, std::string>& files, double depthScale,
                const ArrayLike& worldFromObject) {
  Frame f;
  f.id = id;
  f.camera = camera;
  f.surface = surface;
  f.highlights = highlights;
  f.lightsOn = lightsOn;
  f.depthScale = depthScale;
  if (!worldFromObject.is_none()) f.worldFromObject = poseFrom(worldFromObject, "world_from_object");
  const auto path = [&](const char* kind) {
    const auto it = files.find(kind);
    return it == files.end() || it->second.empty() ? std::filesystem::path()
                                                   : std::filesystem::absolute(it->second).lexically_normal();
  };
  f.image = path("image");
  f.radiance = path("radiance");
  f.depth = path("depth");
  f.normals = path("normals");
  f.mask = path("mask");
  return f;
}

/// A scene that no file says, of frames and surfaces; meshes are files.
SceneHandle sceneFrom(const std::vector<Frame>& frames, const std::map<std::string, std::string>& meshes,
                      const std::map<std::string, AnalyticSpec>& analytic, const std::string& name) {
  if (frames.empty()) throw py::value_error("frames: is empty");
  auto scene = std::make_shared<Scene>();
  scene->name = name;
  scene->folder = std::filesystem::current_path();
  for (const auto& [id, file] : meshes) {
    const MeshFile mesh{{std::filesystem::absolute(file).lexically_normal()}};
    std::error_code ignored;  // unreadable counts as missing
    if (!std::filesystem::is_regular_file(mesh.file, ignored))
      throw InputError(file, "surfaces." + id, "there is no such mesh file");
    scene->surfaces[id] = mesh;
  }
  for (const auto& [id, spec] : analytic) {
    makeAnalytic(spec);  // says what is wrong with it
    scene->surfaces[id] = spec;
  }
  std::set<std::string> ids;
  for (const Frame& f : frames) {
    if (f.id.empty()) throw py::value_error("frames: an id is empty");
    if (!ids.insert(f.id).second) throw py::value_error("frames: the id '" + f.id + "' is there twice");
    if (!f.surface.empty() && !scene->surfaces.count(f.surface))
      throw py::value_error("frames: '" + f.id + "' names the surface '" + f.surface + "', which is not there");
    if (f.surface.empty() && f.depth.empty()) throw py::value_error("frames: '" + f.id + "' has neither a surface nor depth");
  }
  scene->frames = frames;
  return {scene, std::make_shared<const SurfaceCache>(*scene), name};
}

AnalyticSpec specFrom(const std::string& type, const std::map<std::string, py::object>& keys) {
  AnalyticSpec spec;
  spec.type = type;
  const auto number = [](const py::object& v, const std::string& key) { return *doublesFrom(v, {}, key).data(); };
  for (const auto& [key, value] : keys) {
    if (key == "radius")
      spec.radius = number(value, key);
    else if (key == "semi_axes")
      spec.semiAxes = vectorFrom<3>(value, key);
    else if (key == "curvature")
      spec.curvature = number(value, key);
    else if (key == "length")
      spec.length = number(value, key);
    else if (key == "width")
      spec.width = number(value, key);
    else if (key == "major_radius")
      spec.majorRadius = number(value, key);
    else if (key == "minor_radius")
      spec.minorRadius = number(value, key);
    else if (key == "matrix")
      spec.matrix = matrixFrom<4, 4>(value, key);
    else if (key == "world_from_surface")
      spec.worldFromSurface = poseFrom(value, key);
    else
      throw py::value_error("surfaces: '" + key + "' is no key of an analytic surface");
  }
  return spec;
}

void declareFrame(py::module_& module) {
  py::class_<AnalyticSpec>(module, "_AnalyticSpec").def(py::init(&specFrom));
  py::class_<Frame>(module, "Frame", "One captured view of a scene.")
      .def(py::init(&frameFrom), py::arg("id"), py::arg("camera"), py::kw_only(), py::arg("surface") = "",
           py::arg("highlights") = std::vector<Highlight>{}, py::arg("lights_on") = std::vector<std::string>{},
           py::arg("files") = std::map<std::string, std::string>{}, py::arg("depth_scale") = 0.0,
           py::arg("world_from_object") = py::none(),
           "Parameters\n----------\nid : str\ncamera : Camera\nsurface : str\n    A key of the scene's surfaces; empty = this "
           "frame's own "
           "depth map.\nhighlights : list of Highlight\n    Used instead of detection.\nlights_on : list of str\n    Ids; empty "
           "= not "
           "stated.\nfiles : dict\n    Paths of \"image\", \"radiance\", \"depth\", \"normals\", \"mask\".\ndepth_scale : "
           "float\n    Metres per "
           "stored unit of an integer depth image.\nworld_from_object : (4, 4) array\n    Where the surface stands, rigid; "
           "None = identity.")
      .def_readonly("id", &Frame::id, "Any text.")
      .def_readonly("camera", &Frame::camera, "Camera.")
      .def_readonly("surface", &Frame::surface, "Key of the scene's surfaces; empty = its own depth map.")
      .def_property_readonly(
          "world_from_object", [](const Frame& f) { return copyOf(f.worldFromObject.matrix()); },
          "(4, 4) rigid pose: where its surface stands.")
      .def_readonly("lights_on", &Frame::lightsOn, "Ids; empty = not stated.")
      .def_readonly("highlights", &Frame::highlights, "Given highlights, used instead of detection.")
      .def_property_readonly(
          "files",
          [](const Frame& f) {
            std::map<std::string, std::string> out;
            for (const auto& [kind, path] :
                 {std::pair("image", &f.image), std::pair("radiance", &f.radiance), std::pair("depth", &f.depth),
                  std::pair("normals", &f.normals), std::pair("mask", &f.mask)})
              if (!path->empty()) out[kind] = path->string();
            return out;
          },
          "Absolute paths by kind: \"image\", \"radiance\", \"depth\", \"normals\", \"mask\".")
      .def("__repr__", [](const Frame& f) { return "<glint.Frame " + f.id + ">"; });
}

void declarePixels(py::class_<SceneHandle>& scene) {
  scene
      .def("pixels", &linearOf, py::arg("frame"), py::arg("source") = "radiance",
           "(h, w) or (h, w, 3) float32, linear. frame: number or id. source: \"radiance\" or \"image\", of which a frame may "
           "have one only.\n"
           "Raises CannotAnswer: \"frame unreadable\".")
      .def(
          "photograph",
          [](const SceneHandle& s, const FrameName& frame) {
            const Frame& f = frameIn(s, frame);
            return arrayOf([&] { return std::optional(valueOf(readPhotograph(f))); });
          },
          py::arg("frame"), "(h, w, 3) float32 for display, sRGB 0 .. 1. Raises CannotAnswer.")
      .def(
          "depth",
          [](const SceneHandle& s, const FrameName& frame) {
            const Frame& f = frameIn(s, frame);
            return arrayOf([&] { return valueOf(readDepth(f)); });
          },
          py::arg("frame"), "(h, w) float32 along the optical axis, m, 0 = none; None where the frame has none.")
      .def(
          "normals",
          [](const SceneHandle& s, const FrameName& frame) {
            const Frame& f = frameIn(s, frame);
            return arrayOf([&] { return valueOf(readNormals(f)); });
          },
          py::arg("frame"), "(h, w, 3) float32 world normals as stored; None where the frame has none.")
      .def(
          "mask",
          [](const SceneHandle& s, const FrameName& frame) {
            const Frame& f = frameIn(s, frame);
            return arrayOf([&] { return valueOf(readMask(f)); });
          },
          py::arg("frame"), "(h, w) float32, 1 on the glossy object; None where the frame has none.");
}

}  // namespace

void declareScenes(py::module_& module) {
  declareFrame(module);
  py::class_<SceneHandle> scene(
      module, "Scene", "Everything that an input says, checked. Images and surfaces are loaded when they are asked for.");
  scene.def_static("_make", &sceneFrom)
      .def_property_readonly(
          "name", [](const SceneHandle& s) { return s.scene->name; }, "As the file says; may be empty.")
      .def_property_readonly(
          "kind", [](const SceneHandle& s) { return s.scene->kind; },
          "How it was read, such as \"scene\", \"colmap\" or \"nerfstudio\".")
      .def_property_readonly(
          "file", [](const SceneHandle& s) { return s.scene->file.string(); }, "As opened; empty for a scene from memory.")
      .def_readonly("input", &SceneHandle::input, "The input as the caller named it.")
      .def_property_readonly(
          "frames",
          [](const SceneHandle& s) {
            std::vector<const Frame*> out;
            for (const Frame& f : s.scene->frames) out.push_back(&f);
            return out;
          },
          "List of Frame.")
      .def_property_readonly(
          "surfaces",
          [](const SceneHandle& s) {
            std::vector<std::string> ids;
            for (const auto& entry : s.scene->surfaces) ids.push_back(entry.first);
            return ids;
          },
          "Keys of the surfaces.")
      .def_property_readonly(
          "lights",
          [](const SceneHandle& s) {
            std::vector<py::dict> out;
            for (const TrueLight& l : s.scene->lights) out.push_back(lightOf(l));
            return out;
          },
          "Lights that the scene states, as dictionaries with id, frame (\"world\", \"camera\"), known, position or direction "
          "(3,), "
          "segment (2, 3), radius, sigma_m or sigma_deg. Fits use known ones alone.")
      .def_property_readonly(
          "warnings", [](const SceneHandle& s) { return s.scene->warnings; }, "Unknown keys and other oddities, in words.")
      .def_property_readonly(
          "facts", [](const SceneHandle& s) { return s.scene->facts; },
          "What was recognised in a capture and converted, in words.")
      .def(
          "surface",
          [](const SceneHandle& s, const FrameName& frame, const py::kwargs& settings) { return surfaceOf(s, frame, settings); },
          py::arg("frame"),
          "The Surface that a frame sees (number or id); settings as keyword arguments. Raises CannotAnswer: \"no surface\".")
      .def(
          "evidence",
          [](const SceneHandle& s, const FrameName& frame, const std::string& source, const py::kwargs& settings) {
            return evidenceOf(s, frame, source, settings);
          },
          py::arg("frame"), py::arg("source") = "radiance",
          "FrameEvidence of one frame: its highlights, given or detected, in ideal pixels; settings as keyword arguments.")
      .def("_conventions",
           [](const SceneHandle& s, py::object progress) {
             return withProgress(std::move(progress),
                                 [&](const ProgressFn& report) { return toJson(fullReport(*s.scene, report)); });
           })
      .def(
          "save",
          [](const SceneHandle& s, const std::string& file) {
            Outputs({s.scene->file}).file(file, "file", OutputKind::document("glint_scene"));
            const py::gil_scoped_release release;
            writeScene(*s.scene, file);
          },
          py::arg("file"), "Writes scene.json, version 1, with relative paths; whole or not at all. InputError where it cannot.")
      .def("__len__", [](const SceneHandle& s) { return s.scene->frames.size(); })
      .def("__repr__", [](const SceneHandle& s) {
        return "<glint.Scene " + s.scene->name + ", " + std::to_string(s.scene->frames.size()) + " frames>";
      });
  declarePixels(scene);
}

}  // namespace glint::python
