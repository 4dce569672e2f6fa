// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"

// NumPy arrays in and out. Input is checked: its shape, its type of number and, unless said otherwise, that it is finite. Output
// is a read-only view of memory that an object of Glint owns, and keeps that object alive; small matrices are copied.
namespace glint::python {

namespace py = pybind11;

inline int isAnything(PyObject*) { return 1; }
/// An argument that NumPy makes an array of; so named in signatures and stubs.
class ArrayLike : public py::object {
  PYBIND11_OBJECT_DEFAULT(ArrayLike, py::object, isAnything)
};

/// A caller's array as doubles in row order: the array itself where it is that already, else a copy.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// @param shape  -1 = any. TypeError unless the values are real numbers; ValueError for another shape or values not finite.
Doubles doublesFrom(py::handle given, const std::vector<py::ssize_t>& shape, const std::string& name, bool finite = true);
/// Whole numbers of 32 bits, N x 3. TypeError for other numbers; ValueError for another shape, or a number that does not fit.
std::vector<Eigen::Vector3i> trianglesFrom(py::handle given, const std::string& name);
/// H x W or H x W x C. Not finite where `finite` is false: depth maps mark pixels without depth so.
Image imageFrom(py::handle given, const std::string& name, bool finite);

template <int N>
std::vector<Eigen::Matrix<double, N, 1>> pointsFrom(py::handle given, const std::string& name, bool finite = true) {
  const Doubles array = doublesFrom(given, {-1, N}, name, finite);
  std::vector<Eigen::Matrix<double, N, 1>> points(static_cast<std::size_t>(array.shape(0)));
  static_assert(sizeof(points[0]) == N * sizeof(double));
  std::copy_n(array.data(), array.size(), reinterpret_cast<double*>(points.data()));
  return points;
}

template <int N>
Eigen::Matrix<double, N, 1> vectorFrom(py::handle given, const std::string& name) {
  const Doubles array = doublesFrom(given, {N}, name);
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(array.data());
}

template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns> matrixFrom(py::handle given, const std::string& name) {
  const Doubles array = doublesFrom(given, {Rows, Columns}, name);
  return Eigen::Map<const Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>>(array.data());
}

/// What stands for a number that there is not.
inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// A rigid pose from a 4 x 4 matrix; ValueError for any other matrix.
Eigen::Isometry3d poseFrom(py::handle given, const std::string& name);

/// Memory of `owner`, which lives as long as the array; read-only.
py::array viewOf(const py::dtype& type, std::vector<py::ssize_t> shape, const void* data, py::handle owner);

/// N x (length of a point).
template <class Scalar, int N>
py::array viewOf(const std::vector<Eigen::Matrix<Scalar, N, 1>>& points, py::handle owner) {
  static_assert(sizeof(Eigen::Matrix<Scalar, N, 1>) == N * sizeof(Scalar));
  return viewOf(py::dtype::of<Scalar>(), {static_cast<py::ssize_t>(points.size()), N}, points.data(), owner);
}
inline py::array viewOf(const std::vector<double>& values, py::handle owner) {
  return viewOf(py::dtype::of<double>(), {static_cast<py::ssize_t>(values.size())}, values.data(), owner);
}
/// H x W where the image has one channel, else H x W x C, float32.
py::array viewOf(const Image& image, py::handle owner);

/// An array that owns these values: no copy of them.
template <class Value>
py::array ownedBy(std::vector<Value> values) {
  auto* const kept = new std::vector<Value>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Value>*>(p); });
  return viewOf(*kept, owner);
}

template <class Derived>
py::array copyOf(const Eigen::MatrixBase<Derived>& matrix) {
  constexpr bool kVector = Derived::ColsAtCompileTime == 1;
  py::array_t<double> out(kVector ? std::vector<py::ssize_t>{matrix.rows()}
                                  : std::vector<py::ssize_t>{matrix.rows(), matrix.cols()});
  double* to = out.mutable_data();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) *to++ = matrix(r, c);
  return out;
}

template <class Matrix>
std::optional<py::array> arrayOrNone(const std::optional<Matrix>& matrix) {
  if (!matrix) return std::nullopt;
  return copyOf(*matrix);
}

}  // namespace glint::python

namespace pybind11::detail {
template <>
struct handle_type_name<glint::python::ArrayLike> {
  static constexpr auto name = const_name("ArrayLike");
};
}  // namespace pybind11::detail
