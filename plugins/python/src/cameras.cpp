// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <cmath>
#include <numbers>

#include "core/base/number_text.h"
#include "core/geometry/camera.h"
#include "core/geometry/plane.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

constexpr int kLargestSide = 65536;  // px, as a scene file may say

Lens lensFrom(const std::string& model, const ArrayLike& distortion) {
  const std::optional<LensModel> known = lensModelNamed(model);
  if (!known) {
    std::string names;
    for (const LensModel m : kLensModels) names += (names.empty() ? "" : ", ") + std::string(nameOf(m));
    throw py::value_error("model: '" + model + "' is not supported, only " + names);
  }
  Lens lens;
  lens.model = *known;
  if (distortion.is_none()) return lens;
  const Doubles values = doublesFrom(distortion, {-1}, "distortion");
  const auto count = static_cast<py::ssize_t>(parameterCountOf(lens.model));
  const bool withoutK3 = lens.model == LensModel::OpenCv && values.size() == 4;  // as OpenCV takes them
  if (values.size() != 0 && values.size() != count && !withoutK3)
    throw py::value_error("distortion: must have " + std::to_string(count) + " numbers (" + parametersOf(lens.model) + "), has " +
                          std::to_string(values.size()));
  std::copy_n(values.data(), values.size(), lens.parameters.begin());
  if (lens.model == LensModel::Fov && !(std::abs(lens.parameters[0]) < std::numbers::pi))
    throw py::value_error("distortion[0]: must be between -pi and pi: omega is the lens's field of view");
  return lens;
}

Camera checked(Camera camera) {
  if (camera.width < 1 || camera.height < 1 || camera.width > kLargestSide || camera.height > kLargestSide)
    throw py::value_error("width, height: must be 1 to 65536");
  const Eigen::Matrix3d& k = camera.pixelFromRay;
  if (!k.allFinite()) throw py::value_error("K: is not finite");
  if (!(k(0, 0) > 0 && k(1, 1) > 0)) throw py::value_error("fx, fy: must be above 0");
  if (k(1, 0) != 0 || k(2, 0) != 0 || k(2, 1) != 0 || k(2, 2) != 1)
    throw py::value_error("K: must be upper triangular with 1 at (2, 2)");
  return camera;
}

Camera cameraFrom(int width, int height, double fx, double fy, double cx, double cy, double skew, const std::string& model,
                  const ArrayLike& distortion, const ArrayLike& pose) {
  Camera c;
  c.width = width;
  c.height = height;
  c.pixelFromRay << fx, skew, cx, 0, fy, cy, 0, 0, 1;
  c.lens = lensFrom(model, distortion);
  if (!pose.is_none()) c.camFromWorld = poseFrom(pose, "camera_from_world");
  return checked(c);
}

Camera cameraOfMatrix(const ArrayLike& k, int width, int height, const ArrayLike& pose, const std::string& model,
                      const ArrayLike& distortion) {
  Camera c;
  c.width = width;
  c.height = height;
  c.pixelFromRay = matrixFrom<3, 3>(k, "K");
  c.lens = lensFrom(model, distortion);
  if (!pose.is_none()) c.camFromWorld = poseFrom(pose, "camera_from_world");
  return checked(c);
}

template <class Change>
py::array eachPixel(const ArrayLike& pixels, const Change& change) {
  std::vector<Pixel> out = pointsFrom<2>(pixels, "pixels");
  {
    const py::gil_scoped_release release;  // the inverse of a lens is found by iteration
    for (Pixel& p : out) {
      p = change(p);
      if (!p.allFinite()) p.setConstant(kNoNumber);  // one sign for what there is not
    }
  }
  return ownedBy(std::move(out));
}

py::array project(const Camera& c, const ArrayLike& points) {
  std::vector<Pixel> out;
  for (const Eigen::Vector3d& x : pointsFrom<3>(points, "points"))
    out.push_back(c.project(x).value_or(Pixel(kNoNumber, kNoNumber)));
  return ownedBy(std::move(out));
}

py::array directions(const Camera& c, const ArrayLike& pixels) {
  std::vector<Eigen::Vector3d> out;
  for (const Pixel& p : pointsFrom<2>(pixels, "pixels")) out.push_back(c.ray(p).direction);
  return ownedBy(std::move(out));
}

void declareNumbers(py::class_<Camera>& camera) {
  camera.def_readonly("width", &Camera::width, "px.")
      .def_readonly("height", &Camera::height, "px.")
      .def_property_readonly(
          "K", [](const Camera& c) { return copyOf(c.pixelFromRay); }, "(3, 3) pixels from rays of the camera's frame, px.")
      .def_property_readonly(
          "camera_from_world", [](const Camera& c) { return copyOf(c.camFromWorld.matrix()); }, "(4, 4) rigid pose.")
      .def_property_readonly(
          "centre", [](const Camera& c) { return copyOf(c.centreInWorld()); }, "(3,) world.")
      .def_property_readonly(
          "projection", [](const Camera& c) { return copyOf(c.projection().matrix); },
          "(3, 4) P = K [R | t]: homogeneous ideal pixels from homogeneous world points.")
      .def_property_readonly(
          "model", [](const Camera& c) { return std::string(nameOf(c.lens.model)); },
          "Name of how the lens bends rays, such as \"OPENCV\".")
      .def_property_readonly(
          "distortion",
          [](const Camera& c) {
            const auto& p = c.lens.parameters;
            return ownedBy(std::vector<double>(p.begin(), p.begin() + parameterCountOf(c.lens.model)));
          },
          "(n,) parameters of the model, in COLMAP's order after cx cy.");
}

}  // namespace

void declareCameras(py::module_& module) {
  py::class_<Camera> camera(
      module, "Camera",
      "A calibrated camera. Axes: x right, y down, z forward. Pixel (0, 0) is the centre of the top-left pixel. Ideal pixels "
      "have no lens\n"
      "distortion: contours, peaks and predictions are in ideal pixels; `distort` gives the place in the photograph.");
  camera
      .def(
          py::init(&cameraFrom), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"),
          py::kw_only(), py::arg("skew") = 0.0, py::arg("model") = "OPENCV", py::arg("distortion") = py::none(),
          py::arg("camera_from_world") = py::none(),
          "Parameters\n----------\nwidth, height : int, px\nfx, fy, cx, cy, skew : float, px\nmodel : str\n    As scene.json "
          "writes it: "
          "OPENCV, FULL_OPENCV, SIMPLE_RADIAL, RADIAL, OPENCV_FISHEYE, ...\ndistortion : (n,) array\n    The model's parameters; "
          "None = ideal.\ncamera_from_world : (4, 4) array\n    Rigid pose; None = identity.")
      .def_static("from_matrix", &cameraOfMatrix, py::arg("K"), py::arg("width"), py::arg("height"),
                  py::arg("camera_from_world") = py::none(), py::arg("model") = "OPENCV", py::arg("distortion") = py::none(),
                  "The same from K, (3, 3), px, upper triangular with 1 at (2, 2).")
      .def(
          "at",
          [](Camera c, const ArrayLike& pose) {
            c.camFromWorld = poseFrom(pose, "camera_from_world");
            return c;
          },
          py::arg("camera_from_world"), "The same camera with another pose, (4, 4).")
      .def("project", &project, py::arg("points"),
           "(n, 2) ideal pixels of (n, 3) world points; NaN where a point is not in front of the camera.")
      .def("directions", &directions, py::arg("pixels"), "(n, 3) unit world directions of the rays through (n, 2) ideal pixels.")
      .def(
          "depth",
          [](const Camera& c, const ArrayLike& points) {
            std::vector<double> out;
            for (const Eigen::Vector3d& x : pointsFrom<3>(points, "points")) out.push_back(c.depth(x));
            return ownedBy(std::move(out));
          },
          py::arg("points"), "(n,) depths of (n, 3) world points along the optical axis, world units.")
      .def(
          "distort",
          [](const Camera& c, const ArrayLike& pixels) {
            return eachPixel(pixels, [&](const Pixel& p) { return c.distorted(p); });
          },
          py::arg("pixels"), "(n, 2) measured pixels of (n, 2) ideal ones; NaN where the lens shows none.")
      .def(
          "undistort",
          [](const Camera& c, const ArrayLike& pixels) {
            return eachPixel(pixels, [&](const Pixel& p) { return c.undistorted(p); });
          },
          py::arg("pixels"), "(n, 2) ideal pixels of (n, 2) measured ones; NaN where no such pixel exists.")
      .def(
          "virtual", [](const Camera& c, const Plane& plane) { return copyOf(virtualCamera(c, plane).matrix); }, py::arg("plane"),
          "(3, 4) projection of the virtual camera, which sees the world through the plane as a mirror: P M. Its left block has "
          "a negative\n"
          "determinant; pixels keep the photograph's orientation.")
      .def("__repr__", [](const Camera& c) {
        return formatted("<glint.Camera %d x %d px, %s, fx %.6g px>", c.width, c.height, nameOf(c.lens.model),
                         c.pixelFromRay(0, 0));
      });
  declareNumbers(camera);
}

}  // namespace glint::python
