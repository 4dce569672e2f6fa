// SPDX-License-Identifier: BSD-3-Clause
#include "plugins/python/src/arrays.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/geometry/transforms.h"

namespace glint::python {
namespace {

std::string shapeText(const std::vector<py::ssize_t>& shape) {
  std::string text;
  for (const py::ssize_t n : shape) text += (text.empty() ? "" : ", ") + (n < 0 ? std::string("n") : std::to_string(n));
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

std::vector<py::ssize_t> shapeFrom(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

/// What NumPy makes of it, of real numbers. Nothing of it is copied yet where it is an array.
py::array numbersFrom(py::handle given, const std::string& name, const char* kinds, const char* words) {
  if (!given || given.is_none()) throw py::type_error(name + ": expected an array of " + words + ", not None");
  if (py::hasattr(given, "mask") && py::hasattr(given, "filled"))
    throw py::type_error(name + ": is a masked array; fill it, or leave out what is masked");
  const py::array array = py::array::ensure(given);
  if (!array) throw py::type_error(name + ": expected an array of " + words);
  // An empty list has no numbers that could be of a wrong kind.
  if (array.size() > 0 && std::string(kinds).find(array.dtype().kind()) == std::string::npos)
    throw py::type_error(name + ": expected " + words + ", not " + py::str(array.dtype()).cast<std::string>());
  return array;
}

constexpr const char* kReal = "fiu";  // NumPy's letters for kinds of numbers: neither complex nor objects, texts and truth values

void requireShape(const py::array& array, const std::vector<py::ssize_t>& shape, const std::string& name) {
  bool same = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (std::size_t i = 0; same && i < shape.size(); ++i)
    same = shape[i] < 0 || array.shape(static_cast<py::ssize_t>(i)) == shape[i];
  if (!same) throw py::value_error(name + ": expected the shape " + shapeText(shape) + ", not " + shapeText(shapeFrom(array)));
}

template <class Value>
void requireFinite(const Value* values, py::ssize_t count, py::ssize_t perRow, const std::string& name) {
  for (py::ssize_t i = 0; i < count; ++i)
    if (!std::isfinite(values[i]))
      throw py::value_error(name + "[" + std::to_string(i / std::max<py::ssize_t>(perRow, 1)) + "]: is not finite");
}

}  // namespace

Doubles doublesFrom(py::handle given, const std::vector<py::ssize_t>& shape, const std::string& name, bool finite) {
  py::array array = numbersFrom(given, name, kReal, "real numbers");
  // An empty list stands for no points, whatever their dimension.
  if (array.size() == 0 && array.ndim() == 1 && shape.size() == 2 && shape[0] < 0)
    array = py::array(py::dtype::of<double>(), std::vector<py::ssize_t>{0, shape[1]});
  requireShape(array, shape, name);
  if (array.size() == 0) return Doubles(shapeFrom(array));  // whatever type no numbers have
  const Doubles doubles = Doubles::ensure(array);
  if (!doubles) throw py::error_already_set();
  if (finite) requireFinite(doubles.data(), doubles.size(), shape.size() > 1 ? doubles.shape(1) : 1, name);
  return doubles;
}

std::vector<Eigen::Vector3i> trianglesFrom(py::handle given, const std::string& name) {
  const py::array array = numbersFrom(given, name, "iu", "whole numbers");
  requireShape(array, {-1, 3}, name);
  if (array.dtype().kind() == 'u' && array.itemsize() == 8) {
    // The only type whose numbers do not all fit into signed ones of 64 bits.
    const auto large = py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>::ensure(array);
    for (py::ssize_t i = 0; i < large.size(); ++i)
      if (large.data()[i] > static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()))
        throw py::value_error(name + "[" + std::to_string(i / 3) + "]: does not fit into 32 bits");
  }
  const auto whole = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!whole) throw py::error_already_set();
  std::vector<Eigen::Vector3i> triangles(static_cast<std::size_t>(whole.shape(0)));
  for (py::ssize_t i = 0; i < whole.size(); ++i) {
    const std::int64_t value = whole.data()[i];
    if (value < std::numeric_limits<std::int32_t>::min() || value > std::numeric_limits<std::int32_t>::max())
      throw py::value_error(name + "[" + std::to_string(i / 3) + "]: does not fit into 32 bits");
    triangles[static_cast<std::size_t>(i / 3)][static_cast<int>(i % 3)] = static_cast<int>(value);
  }
  return triangles;
}

Image imageFrom(py::handle given, const std::string& name, bool finite) {
  const py::array array = numbersFrom(given, name, kReal, "real numbers");
  if (array.ndim() != 2 && array.ndim() != 3)
    throw py::value_error(name + ": expected the shape (height, width) or (height, width, channels), not " +
                          shapeText(shapeFrom(array)));
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    if (array.shape(i) < 1 || array.shape(i) > 65536)  // as large as a camera of a scene may be
      throw py::value_error(name + ": every side must be 1 to 65536, not " + shapeText(shapeFrom(array)));
  const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!values) throw py::error_already_set();
  Image image;
  image.height = static_cast<int>(array.shape(0));
  image.width = static_cast<int>(array.shape(1));
  image.channels = array.ndim() == 3 ? static_cast<int>(array.shape(2)) : 1;
  if (finite) requireFinite(values.data(), values.size(), py::ssize_t{image.width} * image.channels, name);
  image.data.assign(values.data(), values.data() + values.size());
  return image;
}

Eigen::Isometry3d poseFrom(py::handle given, const std::string& name) {
  const Eigen::Matrix4d m = matrixFrom<4, 4>(given, name);
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) throw py::value_error(name + ": must be rigid: the last row must be 0 0 0 1");
  // As poses of files are read.
  const TypedPose typed = typedPose(m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>());
  if (typed.rotation == TypedRotation::NotARotation)
    throw py::value_error(name + ": must be rigid: the 3x3 block is not a rotation");
  if (typed.rotation == TypedRotation::Mirrored)
    throw py::value_error(name + ": must be rigid: the 3x3 block is mirrored (determinant -1)");
  return typed.pose;
}

py::array viewOf(const py::dtype& type, std::vector<py::ssize_t> shape, const void* data, py::handle owner) {
  std::vector<py::ssize_t> strides(shape.size());
  py::ssize_t step = type.itemsize();
  for (std::size_t i = shape.size(); i-- > 0;) {
    strides[i] = step;
    step *= shape[i];
  }
  // Without values there may be no address; pybind11 then makes memory of its own, which is right, too.
  py::array view(type, std::move(shape), std::move(strides), data, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::array viewOf(const Image& image, py::handle owner) {
  std::vector<py::ssize_t> shape{image.height, image.width};
  if (image.channels > 1) shape.push_back(image.channels);
  return viewOf(py::dtype::of<float>(), std::move(shape), image.data.data(), owner);
}

}  // namespace glint::python
