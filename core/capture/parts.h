// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/capture: what several readers share. All throw InputError with file, place and reason.

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/capture/capture.h"

namespace glint::capture {

/// Added to a coordinate whose origin is the corner of the first pixel (COLMAP, nerfstudio) gives ours, whose origin is its centre.
inline constexpr double kFromCorner = -0.5;

/// Rotation of a quaternion of any length but 0. A length that is off by more than 1e-3 was hardly meant as one: `warnings` says so.
/// InputError where it is 0 or not finite.
Eigen::Quaterniond unitQuaternion(double w, double x, double y, double z, const std::string& file, const std::string& place,
                                  std::vector<std::string>& warnings);

/// Finite and at most `most` in size (kFarthest, kFarthestPx, kLargestFactor of core/base/bounded_json.h).
double bounded(double value, double most, const std::string& file, const std::string& place);

/// K with positive focal lengths, (0, 0) at the centre of the first pixel.
/// @param lens  default: no distortion
Camera cameraOf(int width, int height, double fx, double fy, double cx, double cy, const Lens& lens, const std::string& file,
                const std::string& place);

/// Where the image of this name is: in the first of `options.photographs` that holds it (by the longest end of its path), else in the
/// first of `folders` that does, else in the first of `folders`, where it is missing. OutsidePath where the name leaves that folder.
std::filesystem::path imagePlace(const std::string& name, const std::vector<std::filesystem::path>& folders,
                                 const CaptureOptions& options, const std::string& file, const std::string& place);

/// Width and height of an image file, without decoding it. InputError where it is missing or no image: programs whose files do not
/// say the size need it ("the file does not say the size of its images; name their folder by --photographs").
std::array<int, 2> sizeOfImage(const std::filesystem::path& image, const std::string& file, const std::string& place);

/// Sorts views by name (text order) and refuses two of one name.
void orderByName(Capture& capture);

/// The words of one line of a text.
struct Row {
  std::size_t number = 0;  ///< of its line, from 1
  std::vector<std::string_view> words;
  std::string place() const { return "line " + std::to_string(number); }
};
/// The word as a number. InputError where it is missing or not a finite number ("needs 8 numbers, has 7").
double numberAt(const Row& row, std::size_t word, const std::string& file);
long long integerAt(const Row& row, std::size_t word, const std::string& file);

}  // namespace glint::capture
