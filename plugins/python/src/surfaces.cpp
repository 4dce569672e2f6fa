// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "core/base/number_text.h"
#include "core/base/progress.h"
#include "core/geometry/light.h"
#include "core/surface/analytic.h"
#include "core/surface/brightest_point.h"
#include "core/surface/depth_map.h"
#include "core/surface/mesh.h"
#include "core/surface/mesh_policy.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

// Finer than any picture needs, and 17 million cells are still built in seconds.
constexpr int kFinestResolution = 4096;

SurfaceHandle meshSurface(const ArrayLike& vertices, const ArrayLike& triangles, const ArrayLike& normals, py::handle settings) {
  TriangleMesh mesh;
  mesh.vertices = pointsFrom<3>(vertices, "vertices");
  mesh.triangles = trianglesFrom(triangles, "triangles");
  // What is not finite or zero is replaced by the mean of the triangles around.
  if (!normals.is_none()) mesh.normals = pointsFrom<3>(normals, "normals", false);
  const MeshPolicy policy = meshPolicy(settingsFrom(settings));
  const py::gil_scoped_release release;
  return {makeMesh(std::move(mesh), policy)};
}

SurfaceHandle depthSurface(const ArrayLike& depth, const Camera& camera, py::handle settings) {
  const Image image = imageFrom(depth, "depth", false);
  DepthMapOptions options;
  options.mesh = meshPolicy(settingsFrom(settings));
  const py::gil_scoped_release release;
  return {valueOf(makeDepthMap(image, camera, options))};
}

SurfaceHandle analyticSurface(const std::string& type, double radius, const ArrayLike& semiAxes, double curvature,
                              std::optional<double> length, std::optional<double> width, double majorRadius, double minorRadius,
                              const ArrayLike& matrix, const ArrayLike& pose) {
  AnalyticSpec spec;
  spec.type = type;
  spec.radius = radius;
  spec.curvature = curvature;
  spec.length = length;
  spec.width = width;
  spec.majorRadius = majorRadius;
  spec.minorRadius = minorRadius;
  if (!semiAxes.is_none()) spec.semiAxes = vectorFrom<3>(semiAxes, "semi_axes");
  if (!matrix.is_none()) spec.matrix = matrixFrom<4, 4>(matrix, "matrix");
  if (!pose.is_none()) spec.worldFromSurface = poseFrom(pose, "world_from_surface");
  return {makeAnalytic(spec)};
}

/// Where rays meet a surface.
struct Hits {
  std::vector<Eigen::Vector3d> positions, normals;
  std::vector<int> elements;
  std::vector<char> hit;
};

Hits firstHits(const SurfaceHandle& handle, const ArrayLike& origins, const ArrayLike& directions, py::object progress) {
  const auto from = pointsFrom<3>(origins, "origins");
  const auto along = pointsFrom<3>(directions, "directions");
  if (from.size() != along.size() && from.size() != 1)
    throw py::value_error("origins: expected one, or as many as directions (" + std::to_string(along.size()) + "), not " +
                          std::to_string(from.size()));
  for (std::size_t i = 0; i < along.size(); ++i)
    if (!(along[i].norm() > 0)) throw py::value_error("directions[" + std::to_string(i) + "]: must have a length");
  Hits hits;
  hits.positions.assign(along.size(), Eigen::Vector3d::Constant(kNoNumber));
  hits.normals = hits.positions;
  hits.elements.assign(along.size(), -1);
  hits.hit.assign(along.size(), 0);
  constexpr std::size_t kBatch = 1024;  // rays a report: some milliseconds
  const auto one = [&](std::size_t i) {
    const Outcome<SurfacePoint> found = handle.surface->firstHit({from[from.size() == 1 ? 0 : i], along[i].normalized()});
    if (!found) return;
    hits.positions[i] = found->position;
    hits.normals[i] = found->normal;
    hits.elements[i] = found->element;
    hits.hit[i] = 1;
  };
  const auto batches = static_cast<int>((along.size() + kBatch - 1) / kBatch);
  withProgress(std::move(progress), [&](const ProgressFn& report) {
    parallelFor(
        batches,
        [&](int batch) {
          const std::size_t first = static_cast<std::size_t>(batch) * kBatch;
          for (std::size_t i = first; i < std::min(first + kBatch, along.size()); ++i) one(i);
        },
        report, "surface");
    return 0;
  });
  return hits;
}

std::vector<BrightestPoint> brightestPoints(const SurfaceHandle& s, const Camera& camera, const Light& light) {
  const py::gil_scoped_release release;
  return valueOf(predictedBrightestPoints(*s.surface, camera, light));
}

TriangleMesh tessellate(const SurfaceHandle& s, int resolution, const ArrayLike& lower, const ArrayLike& upper) {
  if (resolution < 1 || resolution > kFinestResolution) throw py::value_error("resolution: must be 1 to 4096");
  Eigen::AlignedBox3d region = s.surface->bounds();
  if (lower.is_none() != upper.is_none()) throw py::value_error("lower, upper: give both or none");
  if (!lower.is_none()) region = Eigen::AlignedBox3d(vectorFrom<3>(lower, "lower"), vectorFrom<3>(upper, "upper"));
  if (region.isEmpty()) throw py::value_error("lower, upper: the box is empty");
  if (!region.min().allFinite() || !region.max().allFinite())
    throw py::value_error("lower, upper: this surface has no end; say which box of it is meant");
  const py::gil_scoped_release release;
  return s.surface->tessellate(region, resolution);
}

void declareResults(py::module_& module) {
  py::class_<Hits>(module, "Hits", "Where n rays meet a surface; arrays are views of memory that this object owns.")
      .def_property_readonly(
          "hit",
          [](py::object self) {
            const auto& h = self.cast<const Hits&>();
            return viewOf(py::dtype::of<bool>(), {py::ssize_t(h.hit.size())}, h.hit.data(), self);
          },
          "(n,) bool: whether the ray meets it.")
      .def_property_readonly(
          "positions", [](py::object self) { return viewOf(self.cast<const Hits&>().positions, self); },
          "(n, 3) world; NaN where no hit is.")
      .def_property_readonly(
          "normals", [](py::object self) { return viewOf(self.cast<const Hits&>().normals, self); },
          "(n, 3) unit vectors on the side that the surface stores; NaN where no hit is.")
      .def_property_readonly(
          "elements",
          [](py::object self) {
            const auto& h = self.cast<const Hits&>();
            return viewOf(py::dtype::of<int>(), {py::ssize_t(h.elements.size())}, h.elements.data(), self);
          },
          "(n,) int32: triangles of a mesh; -1 elsewhere.")
      .def("__len__", [](const Hits& h) { return h.hit.size(); });
  py::class_<BrightestPoint>(module, "BrightestPoint", "Where the highlight of a light is brightest.")
      .def_property_readonly(
          "position", [](const BrightestPoint& b) { return copyOf(b.point.position); }, "(3,) world.")
      .def_property_readonly(
          "normal", [](const BrightestPoint& b) { return copyOf(b.point.normal); }, "(3,) unit vector on the camera's side.")
      .def_property_readonly(
          "pixel", [](const BrightestPoint& b) { return copyOf(b.pixel); }, "(2,) ideal px.")
      .def_readonly("alpha", &BrightestPoint::alpha, "Remaining angle between normal and half vector, rad.");
  py::class_<TriangleMesh>(module, "Mesh", "Indexed triangles; arrays are views of memory that this object owns.")
      .def_property_readonly(
          "vertices", [](py::object self) { return viewOf(self.cast<const TriangleMesh&>().vertices, self); }, "(n, 3) world.")
      .def_property_readonly(
          "normals", [](py::object self) { return viewOf(self.cast<const TriangleMesh&>().normals, self); },
          "(n, 3) unit vectors, or (0, 3).")
      .def_property_readonly(
          "triangles", [](py::object self) { return viewOf(self.cast<const TriangleMesh&>().triangles, self); },
          "(m, 3) int32 indices of vertices.");
}

}  // namespace

void declareSurfaces(py::module_& module) {
  declareResults(module);
  py::class_<SurfaceHandle>(
      module, "Surface",
      "A surface, whatever its source: mesh, analytic shape, depth map. Never changes; may be asked from several threads.")
      .def_static("_mesh", &meshSurface)
      .def_static("_depth_map", &depthSurface)
      .def_static(
          "analytic", &analyticSurface, py::arg("type"), py::kw_only(), py::arg("radius") = 0.0,
          py::arg("semi_axes") = py::none(), py::arg("curvature") = 0.0, py::arg("length") = py::none(),
          py::arg("width") = py::none(), py::arg("major_radius") = 0.0, py::arg("minor_radius") = 0.0,
          py::arg("matrix") = py::none(), py::arg("world_from_surface") = py::none(),
          "An analytic surface, as scene.json names it.\n\nParameters\n----------\ntype : str\n    plane, sphere (radius), "
          "ellipsoid "
          "(semi_axes), cylinder (radius; axis: local y), sheet (curvature, 1/m; length, width), torus (major_radius, "
          "minor_radius; axis: local z), quadric (matrix).\nradius, length, width, major_radius, minor_radius : float, world "
          "units\nsemi_axes : (3,) array\nmatrix : (4, 4) array A\n    x^T A x = 0.\nworld_from_surface : (4, 4) array\n    "
          "Rigid "
          "pose; None = identity.")
      .def("first_hits", &firstHits, py::arg("origins"), py::arg("directions"), py::arg("progress") = py::none(),
           "The first points of n rays on the surface.\n\nParameters\n----------\norigins : (n, 3) or (1, 3) array, "
           "world\ndirections : "
           "(n, 3) array\n    Of any length above 0.\nprogress : function (stage, done, total)\n    Returns False to stop.")
      .def(
          "observed_brightest_point",
          [](const SurfaceHandle& s, const Camera& camera, const ArrayLike& peak) {
            return valueOf(observedBrightestPoint(*s.surface, camera, vectorFrom<2>(peak, "peak")));
          },
          py::arg("camera"), py::arg("peak"),
          "Where the ray through a measured peak, (2,) ideal px, meets the surface. Raises CannotAnswer: \"peak off surface\".")
      .def("brightest_points", &brightestPoints, py::arg("camera"), py::arg("light"),
           "Every visible and lit point where the reflection law holds for a light. Raises CannotAnswer: \"no brightest point\".")
      .def(
          "curvature",
          [](const SurfaceHandle& s, const ArrayLike& origin, const ArrayLike& direction) {
            const Eigen::Vector3d d = vectorFrom<3>(direction, "direction");
            if (!(d.norm() > 0)) throw py::value_error("direction: must have a length");
            const SurfacePoint hit = valueOf(s.surface->firstHit({vectorFrom<3>(origin, "origin"), d.normalized()}));
            const Curvature k = valueOf(s.surface->curvatureAt(hit));
            return std::pair(k.k1, k.k2);
          },
          py::arg("origin"), py::arg("direction"),
          "Principal curvatures (k1, k2), k1 >= k2, 1 / world unit, where a ray meets the surface; positive where it bends away "
          "from the\n"
          "stored normal. Raises CannotAnswer: \"no hit\", \"not supported\" on facets.")
      .def_property_readonly(
          "bounds",
          [](const SurfaceHandle& s) {
            const Eigen::AlignedBox3d box = s.surface->bounds();
            Eigen::Matrix<double, 2, 3> corners;
            corners << box.min().transpose(), box.max().transpose();
            return copyOf(corners);
          },
          "(2, 3) lower and upper corner, world; infinite where the surface has no end.")
      .def("tessellate", &tessellate, py::arg("resolution") = 64, py::arg("lower") = py::none(), py::arg("upper") = py::none(),
           "Triangles for display, about `resolution` cells a side, of the box between two (3,) corners (default: all of it).")
      .def("__repr__", [](const SurfaceHandle& s) { return "<glint.Surface: " + s.surface->describe() + ">"; });
}

}  // namespace glint::python
