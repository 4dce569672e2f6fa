// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <cmath>

#include "core/base/number_text.h"
#include "core/geometry/conic.h"
#include "core/geometry/ellipsoid.h"
#include "core/geometry/light.h"
#include "core/geometry/plane.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

Plane planeThrough(const ArrayLike& point, const ArrayLike& normal) {
  const Eigen::Vector3d n = vectorFrom<3>(normal, "normal");
  const double length = n.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) throw py::value_error("normal: must have a length");
  return Plane::through(vectorFrom<3>(point, "point"), n / length);
}

void declarePlane(py::module_& module) {
  py::class_<Plane>(module, "Plane", "Oriented plane: normal . x + offset = 0, world units.")
      .def(
          py::init(&planeThrough), py::arg("point"), py::arg("normal"),
          "Through a point.\n\nParameters\n----------\npoint, normal : (3,) array\n    World; the normal is brought to length 1.")
      .def_property_readonly(
          "normal", [](const Plane& p) { return copyOf(p.normal); }, "(3,) unit vector, world.")
      .def_readonly("offset", &Plane::offset, "In normal . x + offset = 0, world units.")
      .def_property_readonly(
          "reflection", [](const Plane& p) { return copyOf(p.reflection()); },
          "(4, 4) matrix that mirrors world points; its own inverse.")
      .def(
          "signed_distance",
          [](const Plane& p, const ArrayLike& points) {
            std::vector<double> out;
            for (const Eigen::Vector3d& x : pointsFrom<3>(points, "points")) out.push_back(p.signedDistance(x));
            return ownedBy(std::move(out));
          },
          py::arg("points"), "(n,) distances of (n, 3) world points, positive on the normal's side.")
      .def("__repr__", [](const Plane& p) {
        return formatted("<glint.Plane %.6g x + %.6g y + %.6g z + %.6g = 0>", p.normal.x(), p.normal.y(), p.normal.z(), p.offset);
      });
}

Ellipse ellipseFrom(const ArrayLike& centre, const ArrayLike& semiAxes, double angle) {
  const Eigen::Vector2d axes = vectorFrom<2>(semiAxes, "semi_axes");
  if (!(axes.y() > 0 && axes.x() >= axes.y())) throw py::value_error("semi_axes: the longer one first, both above 0");
  if (!(angle > -M_PI / 2 && angle <= M_PI / 2)) throw py::value_error("angle: must be in (-pi/2, pi/2], radians");
  return {vectorFrom<2>(centre, "centre"), axes, angle};
}

void declareEllipse(py::module_& module) {
  py::class_<Ellipse>(module, "Ellipse", "An ellipse in an image, pixels. (0, 0) is the centre of the top-left pixel.")
      .def(py::init(&ellipseFrom), py::arg("centre"), py::arg("semi_axes"), py::arg("angle") = 0.0,
           "Parameters\n----------\ncentre : (2,) array, px\nsemi_axes : (2,) array, px\n    The longer one first.\nangle : "
           "float, rad\n    "
           "Angle of the longer axis, from +x towards +y (down), in (-pi/2, pi/2].")
      .def_static(
          "from_conic", [](const ArrayLike& conic) { return valueOf(toEllipse(Conic{matrixFrom<3, 3>(conic, "conic")})); },
          py::arg("conic"),
          "The ellipse of the point conic x^T C x = 0, (3, 3), of any scale and sign.\n\nRaises CannotAnswer: \"not an "
          "ellipse\", \"rank "
          "deficient\".")
      .def_static(
          "from_dual", [](const ArrayLike& dual) { return valueOf(toEllipse(DualConic{matrixFrom<3, 3>(dual, "dual")})); },
          py::arg("dual"), "The ellipse of the line conic l^T C* l = 0, (3, 3). Raises CannotAnswer as from_conic.")
      .def_static(
          "fit", [](const ArrayLike& points) { return valueOf(fitEllipse(pointsFrom<2>(points, "points"))); }, py::arg("points"),
          "Direct least-squares ellipse through (n, 2) points, n >= 5 (Halir and Flusser, 1998).\n\nRaises CannotAnswer: \"too "
          "few "
          "points\", \"rank deficient\".")
      .def_property_readonly(
          "centre", [](const Ellipse& e) { return copyOf(e.centre); }, "(2,) px.")
      .def_property_readonly(
          "semi_axes", [](const Ellipse& e) { return copyOf(e.semiAxes); }, "(2,) px, the longer one first.")
      .def_readonly("angle", &Ellipse::angle, "Angle of the longer axis, rad, from +x towards +y (down).")
      .def_property_readonly("area", &Ellipse::area, "px^2.")
      .def_property_readonly(
          "conic", [](const Ellipse& e) { return copyOf(e.conic().matrix); },
          "(3, 3): x^T C x, -1 at the centre, 0 on the ellipse.")
      .def_property_readonly(
          "dual", [](const Ellipse& e) { return copyOf(e.dual().matrix); }, "(3, 3) line conic C*.")
      .def(
          "sample",
          [](const Ellipse& e, int n) {
            if (n < 1) throw py::value_error("n: must be at least 1");
            return ownedBy(e.sample(n));
          },
          py::arg("n"), "(n, 2) points at equal steps of the parameter, px; the first is not repeated.")
      .def("__repr__", [](const Ellipse& e) {
        return formatted("<glint.Ellipse at (%.6g, %.6g), %.6g x %.6g px, %.6g rad>", e.centre.x(), e.centre.y(), e.semiAxes.x(),
                         e.semiAxes.y(), e.angle);
      });
}

void declareEllipsoid(py::module_& module) {
  py::class_<Ellipsoid>(module, "Ellipsoid", "A solid ellipsoid in the world.")
      .def(py::init([](const ArrayLike& pose, const ArrayLike& axes) {
             return Ellipsoid(poseFrom(pose, "world_from_ellipsoid"), vectorFrom<3>(axes, "semi_axes"));
           }),
           py::arg("world_from_ellipsoid"), py::arg("semi_axes"),
           "Parameters\n----------\nworld_from_ellipsoid : (4, 4) array\n    Rigid pose.\nsemi_axes : (3,) array\n    World "
           "units, at most "
           "one of them 0; sorted, the axes with them.")
      .def_static(
          "from_dual",
          [](const ArrayLike& q) { return valueOf(Ellipsoid::fromDual(DualQuadric{matrixFrom<4, 4>(q, "q_dual")})); },
          py::arg("q_dual"),
          "The ellipsoid of the dual quadric Q*, (4, 4), of any scale. Raises CannotAnswer: \"not an ellipsoid\".")
      .def_property_readonly(
          "centre", [](const Ellipsoid& e) { return copyOf(e.centre()); }, "(3,) world.")
      .def_property_readonly(
          "semi_axes", [](const Ellipsoid& e) { return copyOf(e.semiAxes()); }, "(3,) world units, descending.")
      .def_property_readonly(
          "world_from_ellipsoid", [](const Ellipsoid& e) { return copyOf(e.worldFromBody().matrix()); }, "(4, 4) rigid pose.")
      .def_property_readonly(
          "q_dual", [](const Ellipsoid& e) { return copyOf(e.dual().matrix); }, "(4, 4) dual quadric Q*, with 1 at (3, 3).")
      .def(
          "outline",
          [](const Ellipsoid& e, const ArrayLike& projection) {
            return valueOf(outlineEllipse(e, Projection{matrixFrom<3, 4>(projection, "projection")}));
          },
          py::arg("projection"),
          "Its outline in an image: C* ~ P Q* P^T.\n\nParameters\n----------\nprojection : (3, 4) array\n    Homogeneous pixels "
          "from "
          "homogeneous world points: Camera.projection or Camera.virtual(plane).\n\nRaises CannotAnswer: \"not an ellipse\" (the "
          "outline "
          "is unbounded), \"behind camera\".")
      .def("__repr__", [](const Ellipsoid& e) {
        return formatted("<glint.Ellipsoid at (%.6g, %.6g, %.6g), semi-axes %.6g, %.6g, %.6g>", e.centre().x(), e.centre().y(),
                         e.centre().z(), e.semiAxes().x(), e.semiAxes().y(), e.semiAxes().z());
      });
}

void declareLight(py::module_& module) {
  py::class_<Light>(module, "Light", "A point light, at a finite place or at infinity.")
      .def_static(
          "at", [](const ArrayLike& position) { return Light::at(vectorFrom<3>(position, "position")); }, py::arg("position"),
          "The light at a world point, (3,).")
      .def_static(
          "towards", [](const ArrayLike& direction) { return Light::towards(vectorFrom<3>(direction, "direction")); },
          py::arg("direction"), "At infinity. direction : (3,) world vector from the scene to the light, not zero.")
      .def_static(
          "from_homogeneous", [](const ArrayLike& lw) { return Light::homogeneous(vectorFrom<4>(lw, "light")); },
          py::arg("light"), "The light of (4,) homogeneous coordinates (l, w): at l / w, or at infinity towards l where w is 0.")
      .def_property_readonly(
          "homogeneous", [](const Light& l) { return copyOf(l.homogeneous()); }, "(4,) homogeneous, of length 1, w >= 0.")
      .def_property_readonly("at_infinity", &Light::atInfinity, "Whether it has no place.")
      .def_property_readonly(
          "position", [](const Light& l) { return arrayOrNone(l.atInfinity() ? std::nullopt : std::optional(l.position())); },
          "(3,) world; None at infinity.")
      .def(
          "direction_from",
          [](const Light& l, const ArrayLike& point) { return copyOf(l.directionFrom(vectorFrom<3>(point, "point"))); },
          py::arg("point"), "(3,) unit vector from a world point (3,) to the light.")
      .def("__repr__", [](const Light& l) {
        const Eigen::Vector3d p = l.atInfinity() ? Eigen::Vector3d(l.homogeneous().head<3>()) : l.position();
        return formatted("<glint.Light %s (%.6g, %.6g, %.6g)>", l.atInfinity() ? "at infinity, towards" : "at", p.x(), p.y(),
                         p.z());
      });
}

}  // namespace

void declareGeometry(py::module_& module) {
  declarePlane(module);
  declareEllipse(module);
  declareEllipsoid(module);
  declareLight(module);
}

}  // namespace glint::python
