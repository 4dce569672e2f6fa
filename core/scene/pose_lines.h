// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <istream>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"

namespace glint {

/// A camera of a live stream, a video or a folder of photographs. The first sign of a line tells its kind:
///   {"id": "0007", "time": 1.23, "camera_from_world": [4x4], "camera": {}, "world_from_object": [4x4]}
///                                                                JSON, keys as in scene files; the last two are optional
///   1305031102.1758 tx ty tz qx qy qz qw                                                TUM: camera to world, quaternion w last
/// Times in seconds (others: capture::secondsOf); lengths in the unit of the scene.
struct PoseLine {
  std::string id;              ///< as the line writes it; if it has none (TUM), the time as written. Never empty
  std::optional<double> time;  ///< s
  Eigen::Isometry3d cameraFromWorld = Eigen::Isometry3d::Identity();
  std::optional<Camera> camera;                      ///< where the line has one; its pose is `cameraFromWorld`
  std::optional<Eigen::Isometry3d> worldFromObject;  ///< where the line says where the object stands
};

/// The line says that there is no pose: TUM's NaN, or null in JSON. Trackers write it where they have lost the camera.
class LostPose : public InputError {
 public:
  using InputError::InputError;
};

/// The line ends before its pose does, as a full disk or a killed program leaves the last one.
class CutPose : public InputError {
 public:
  using InputError::InputError;
};

/// The longest line in bytes: one with a camera has 600.
inline constexpr std::size_t kLongestPoseLine = 65536;

/// Reads poses one at a time, as soon as their line has ended: lines come from others, and may come live. Blank lines and
/// comments (#) are skipped. Memory is bounded, whatever the input.
class PoseLineReader {
 public:
  /// @param in    outlives the reader
  /// @param name  of the file, for messages
  PoseLineReader(std::istream& in, std::string name);

  /// The next pose; nothing at the end. After a throw about a line, the next call reads the line behind it.
  /// @throw LostPose    for a line that says that there is no pose
  /// @throw CutPose     for a line with fewer numbers than a pose, or of JSON that the end of the file cuts
  /// @throw InputError  (name, "line 7" or "line 7: camera_from_world[0]") for a line without pose, longer than kLongestPoseLine,
  ///                    or whose pose is not rigid (core/geometry/camera_json.h); with the name alone where the file cannot be
  ///                    read
  std::optional<PoseLine> next();

  std::size_t line() const { return number_; }  ///< number of the line that was read last, from 1
  /// The id of that line where it could be read, although the line may be refused; else "".
  const std::string& id() const { return id_; }
  /// What a person should know about that line (a rotation that is one to three digits only); "" = nothing.
  const std::string& warning() const { return warning_; }
  /// When the end of that line was read: what a live answer's time counts from.
  std::chrono::steady_clock::time_point arrived() const { return arrived_; }
  /// Nothing more can be read: the end, or a failure of the file.
  bool ended() const { return ended_; }

 private:
  bool takeLine(std::string& line);
  PoseLine fromJson(const std::string& line);
  PoseLine fromTum(const std::string& line);
  std::string place() const { return "line " + std::to_string(number_); }

  std::istream& in_;
  std::string name_;
  std::size_t number_ = 0;
  std::string id_, warning_;
  std::chrono::steady_clock::time_point arrived_;
  bool ended_ = false;
};

/// All poses of a file, in its order. Lines without a whole pose (LostPose, CutPose) and lines that say the same again are passed
/// over, with a line in `warnings` for each kind.
/// @throw InputError for the first line that is wrong, for two poses of one id, and where there is no pose at all
std::vector<PoseLine> readPoseLines(const std::filesystem::path& file, std::vector<std::string>& warnings);

}  // namespace glint
