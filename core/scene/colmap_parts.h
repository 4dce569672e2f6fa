// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/scene: a COLMAP model as its files hold it, text and binary alike. All throw InputError with file, place and
// reason.
// The format: colmap.github.io/format.html.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/bounded_json.h"
#include "core/base/outcome.h"
#include "core/scene/capture.h"
#include "core/scene/capture_parts.h"
#include "io/binary.h"

namespace glint::capture::colmap {

/// The files of one model.
struct Files {
  std::filesystem::path folder;  ///< absolute
  bool binary = false;
  std::filesystem::path operator()(const char* stem) const { return folder / (std::string(stem) + (binary ? ".bin" : ".txt")); }
  /// Whether the model has this file.
  bool has(const char* stem) const;
};

/// The file's data in our conventions. Identifiers are any numbers.
struct ModelCamera {
  std::uint32_t id = 0;
  std::string model;  ///< COLMAP's name
  Camera camera;      ///< without a pose
};
struct ModelImage {
  std::uint32_t id = 0, camera = 0;
  std::string name, place;
  Eigen::Isometry3d camFromWorld = Eigen::Isometry3d::Identity();
  bool lost = false;               ///< its pose is not finite
  std::size_t pixels = 0;          ///< number of its 2D points, which are not read yet:
  std::size_t from = 0, size = 0;  ///< bytes of the file that hold them
};
/// A place of an image that shows a point.
struct TrackEntry {
  std::uint32_t image = 0, pixel = 0;
};
using EachPoint = std::function<void(const Eigen::Vector3d& point, const std::vector<TrackEntry>& track)>;

// Readers of both kinds, by Files::binary. `bytes` is the content of the file.

// In a text, a line that cannot be read is a warning; its camera, image or point is missing. InputError if nothing is left.

std::vector<ModelCamera> readCameras(const Files& files, std::vector<std::string>& warnings);
/// Poses and names; the 2D points are skipped. An image that is there twice, word for word, counts once. `warnings`: one line for
/// each quaternion that was not of length 1.
std::vector<ModelImage> readImages(const Files& files, std::string_view bytes, std::vector<std::string>& warnings);
/// The 2D points of one image, in our pixels.
std::vector<Pixel> pixelsOf(const Files& files, std::string_view bytes, const ModelImage& image);
/// Calls `each` for every point, in the order of the file.
void readPoints(const Files& files, std::vector<std::string>& warnings, const EachPoint& each);
/// Compares `rigs` and `frames` with the images where a model has them. They say the same once more; what a later version of
/// COLMAP writes there may not be understood, which is a warning.
void checkRigs(const Files& files, const std::vector<ModelImage>& images, Capture& capture);

std::vector<ModelCamera> readCamerasBinary(std::string_view bytes, const std::string& file);
std::vector<ModelCamera> readCamerasText(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings);
std::vector<ModelImage> readImagesBinary(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings);
std::vector<ModelImage> readImagesText(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings);
std::vector<Pixel> pixelsOfBinary(std::string_view bytes, const ModelImage& image, const std::string& file);
std::vector<Pixel> pixelsOfText(std::string_view bytes, const ModelImage& image, const std::string& file);
void readPointsBinary(std::string_view bytes, const std::string& file, const EachPoint& each);
void readPointsText(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings, const EachPoint& each);

// Shared by both kinds.

/// A camera model of COLMAP's, by its number in binary files.
struct CameraModel {
  const char* name;
  bool supported;
  int focalLengths;               ///< 1 or 2; the principal point follows them
  std::optional<LensModel> lens;  ///< nothing: a pinhole
  int lensParameters;             ///< at the end
  int parameters() const { return focalLengths + 2 + lensParameters; }
};
/// InputError if the number or name is unknown, or not supported.
const CameraModel& cameraModelOf(std::int64_t number, const std::string& file, const std::string& place);
const CameraModel& cameraModelOf(std::string_view name, const std::string& file, const std::string& place);
/// @param parameters  as many as the model has, in COLMAP's order
ModelCamera cameraOf(std::uint32_t id, const CameraModel& model, std::uint64_t width, std::uint64_t height,
                     const std::vector<double>& parameters, const std::string& file, const std::string& place);

inline bool anyNotFinite(const std::array<double, 7>& pose) {
  return std::any_of(pose.begin(), pose.end(), [](double v) { return !std::isfinite(v); });
}
/// @param values  QW QX QY QZ TX TY TZ, finite
Eigen::Isometry3d poseOf(const std::array<double, 7>& values, const std::string& file, const std::string& place,
                         std::vector<std::string>& warnings);
/// A name that a file can have.
std::string checkedName(std::string_view name, const std::string& file, const std::string& place);

// `place()` is asked for only where a number is refused: there are millions of them.
template <class Place>
double boundedAt(double value, double most, const std::string& file, const Place& place) {
  return std::abs(value) <= most ? value : bounded(value, most, file, place());  // not true for NaN
}
template <class Place>
Eigen::Vector3d pointAt(double x, double y, double z, const std::string& file, const Place& place) {
  return {boundedAt(x, kFarthest, file, place), boundedAt(y, kFarthest, file, place), boundedAt(z, kFarthest, file, place)};
}
/// In our pixels: COLMAP's origin is the corner of the first one.
template <class Place>
Pixel pixelAt(double x, double y, const std::string& file, const Place& place) {
  return {boundedAt(x, kFarthestPx, file, place) + kFromCorner, boundedAt(y, kFarthestPx, file, place) + kFromCorner};
}
/// A word as an identifier or an index, a whole number of 32 bits without a sign; nothing for any other word.
std::optional<std::uint32_t> number32(std::string_view word);
std::string byteNo(std::size_t byte);
std::string lineNo(std::size_t line);

/// "1 image", "12 images"; `nouns` where another letter than "s" makes the plural
std::string counted(std::size_t number, const std::string& noun, const std::string& nouns = "");
/// At most 8 of `lines`, and how many more there are.
void addWarnings(const std::vector<std::string>& lines, std::vector<std::string>& warnings);

/// Index of each element by its identifier. InputError if two have the same.
template <class Element>
std::unordered_map<std::uint32_t, std::size_t> indexById(const std::vector<Element>& elements, const char* noun,
                                                         const std::string& file) {
  std::unordered_map<std::uint32_t, std::size_t> index;
  index.reserve(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (!index.emplace(elements[i].id, i).second)
      throw InputError(file, "", std::string("two ") + noun + " have the number " + std::to_string(elements[i].id));
  return index;
}

/// Numbers of a binary file (little-endian), one after the other.
class Bytes {
 public:
  Bytes(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }
  std::string place() const { return byteNo(at_); }
  template <class Number>
  Number take() {
    if (left() < sizeof(Number)) truncated();
    const Number value = io::valueAt<Number>(bytes_.data() + at_, false);
    at_ += sizeof(Number);
    return value;
  }
  template <std::size_t n>
  std::array<double, n> takeDoubles() {
    std::array<double, n> values{};
    for (double& v : values) v = take<double>();
    return values;
  }
  /// A count of elements that take at least `least` bytes each; refused if the rest of the file cannot hold them.
  template <class Number>
  std::size_t takeCount(std::size_t least, const char* noun) {
    const Number count = take<Number>();
    if (count > left() / least)
      throw InputError(file_, byteNo(at_ - sizeof count),
                       "is truncated: it declares " + std::to_string(count) + " " + noun + ", more than it can hold");
    return static_cast<std::size_t>(count);
  }
  void skip(std::size_t size) {
    if (left() < size) truncated();
    at_ += size;
  }
  /// A text that ends with a zero byte.
  std::string_view takeText();
  /// Refuses what follows the last element.
  void end() const;

 private:
  [[noreturn]] void truncated() const { throw InputError(file_, place(), "is truncated"); }

  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
};

}  // namespace glint::capture::colmap
