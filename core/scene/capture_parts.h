// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/scene: what several readers share. All throw InputError with file, place and reason.
#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/scene/capture.h"

namespace glint::capture {

/// Turns coordinates from the corner of the first pixel (COLMAP, nerfstudio) into ours, from its centre, when added.
inline constexpr double kFromCorner = -0.5;

/// Rotation of a quaternion of any length but 0. A length that is off by more than 1e-3 was hardly meant as one: `warnings` says
/// so. InputError if it is 0 or not finite.
Eigen::Quaterniond unitQuaternion(double w, double x, double y, double z, const std::string& file, const std::string& place,
                                  std::vector<std::string>& warnings);

/// Finite and at most `most` in size (kFarthest, kFarthestPx, kLargestFactor of core/base/bounded_json.h).
double bounded(double value, double most, const std::string& file, const std::string& place);

/// K with positive focal lengths, (0, 0) at the centre of the first pixel.
/// @param lens  default: no distortion
Camera cameraOf(int width, int height, double fx, double fy, double cx, double cy, const Lens& lens, const std::string& file,
                const std::string& place);

/// Width and height of an image file, without decoding it. InputError if it is missing or no image: programs whose files do
/// not say the size need it ("the file does not say the size of its images; name their folder by --photographs").
std::array<int, 2> sizeOfImage(const std::filesystem::path& image, const std::string& file, const std::string& place);

/// The folders `models*` of the data set whose scene_camera.json this is, in the order of their names. They may be links.
std::vector<std::filesystem::path> modelFoldersOfBop(const std::filesystem::path& file);

/// Sorts views by name (text order). One that is there twice, with one camera, counts once, with a warning; InputError for two of
/// one name that differ.
void orderByName(Capture& capture);

/// Skipped lines or frames of one kind: a file may have thousands of them.
class PassedOver {
 public:
  void add(const std::string& place) {
    if (number_++ == 0) first_ = place;
  }
  std::size_t number() const { return number_; }
  /// Adds "FILE: line 7 and 3 more: WHY; they are left out" where there are any.
  void tell(const std::string& file, const std::string& why, std::vector<std::string>& warnings) const;

 private:
  std::size_t number_ = 0;
  std::string first_;
};

/// Lines that cannot be read, each of which costs no more than its frame or point.
class BadLines {
 public:
  /// Whether `read` went through without an InputError.
  template <class Read>
  bool passes(const Read& read) {
    try {
      read();
      return true;
    } catch (const InputError& e) {
      add(e);
      return false;
    }
  }
  void add(const InputError& error) {
    if (number_++ == 0) first_ = error;
  }
  /// InputError of the first one, where there is any: for files of which nothing is left.
  void refuse() const {
    if (first_) throw InputError(*first_);
  }
  /// Adds "FILE: line 7: WHY; it and 3 more are left out" where there are any.
  void tell(std::vector<std::string>& warnings) const;

 private:
  std::size_t number_ = 0;
  std::optional<InputError> first_;
};

/// Why a frame or a line is skipped, for PassedOver::tell().
inline constexpr const char* kNoFinitePose = "no finite pose (tracking was lost)";  // or nothing but zeros
inline constexpr const char* kCutPose = "has fewer numbers than a pose (a cut line?)";
inline constexpr const char* kSaidBefore = "says the same as a line before";

/// Whether a pose, or a part of it, is null, NaN or infinite (JsonNode reads all of them as null): programs write it where they
/// have lost the camera. So is a matrix of zeros.
bool isLostPose(const JsonNode& pose);
/// Whether a matrix has fewer than three rows, or one of them fewer than four numbers.
bool isCutPose(const JsonNode& pose);

/// The words of one line of a text.
struct Row {
  std::size_t number = 0;  ///< of its line, from 1
  std::vector<std::string_view> words;
  std::string place() const { return "line " + std::to_string(number); }
};
/// The word as a number. InputError if it is missing or not a finite number ("needs 8 numbers, has 7").
double numberAt(const Row& row, std::size_t word, const std::string& file);
long long integerAt(const Row& row, std::size_t word, const std::string& file);
/// Whether one of the words from this one on, at most `words` of them, is NaN or infinite.
bool anyNotFinite(const Row& row, std::size_t word, std::size_t words);
/// Whether a line of TUM (time tx ty tz qx qy qz qw) has no pose: a number that is not finite, or a quaternion of zeros.
bool isLostTum(const Row& row);

// Internal to core/scene: which moments of two lists belong together.

inline constexpr double kApart = 0.02 + 5e-7;  // s: TUM's own limit of 20 ms, to half of the last digit (1 us) of its times

/// Seconds of a time as programs write it. One beyond the year 5138 in seconds is in milliseconds, microseconds or nanoseconds
/// (ROS, EuRoC): in each of these units the years from 1973 on have numbers of their own.
double secondsOf(double time);

/// The index that means "no partner".
inline constexpr std::size_t kNoPair = static_cast<std::size_t>(-1);

/// For each time (s) the index of the one among `others` that belongs to it, else kNoPair: again and again the two closest that
/// are left become a pair, as long as they are at most kApart apart, as TUM's associate.py does with the table of all pairs.
///
/// On the line of time the two closest of different kind are neighbours (one between them would be closer to one of them),
/// so only neighbours matter. The whole table would be quadratic if a file repeats a time.
std::vector<std::size_t> timePairs(const std::vector<double>& times, const std::vector<double>& others);

}  // namespace glint::capture
