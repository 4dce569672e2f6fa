// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace glint {

/// Why the data cannot answer. Every member has a text (`nameOf`) that reports and JSON use;
/// the texts are stable, so scripts may compare them.
enum class Reason {
  TooFewViews,         ///< fewer views than the unknowns need
  TooFewPoints,        ///< fewer points than the unknowns need
  RankDeficient,       ///< the linear system has more than one solution
  NotAnEllipse,        ///< the conic is a hyperbola, a parabola, imaginary or degenerate
  NotAnEllipsoid,      ///< the quadric has the wrong signature
  ParallelRays,        ///< rays too parallel for a point: the answer is a direction
  LightBehindSurface,  ///< N.(L - P) <= 0
  NoHit,               ///< the ray misses the surface
  SurfaceEnded,        ///< walked over the border or into a hole of the surface
  Occluded,            ///< another part of the surface is in front
  NotReached,          ///< the walk ended before the limit angle or the contour was reached
  NotMonotonic,        ///< the angle fell again before the limit was reached
  NoBrightestPoint,    ///< the reflection law holds nowhere that is visible and lit
  NoHighlight,         ///< nothing in the frame rises above the local background
  Clipped,             ///< the highlight is saturated: it has no single peak
  OutsideImage,        ///< the highlight leaves the image
  BehindCamera,        ///< the point is not in front of the camera
  PeakOffSurface,      ///< the ray through the measured peak misses the surface
  NoLight,             ///< the model or the frame has no light to reflect
  LightOff,            ///< the light is switched off in this frame
  NotFinite,           ///< a NaN or an infinity in the input of this step
  NotConverged,        ///< the iteration stopped before its tolerance
  NotSupported,        ///< the combination asked for does not exist
  NoSurface,           ///< the frame has no surface
  FrameUnreadable,     ///< the frame's image could not be used
  Cancelled,           ///< stopped by the caller
};

/// Stable, lower-case text of a reason ("too few views").
const char* nameOf(Reason reason);
/// The reason of that name; nothing for an unknown name.
std::optional<Reason> reasonNamed(std::string_view name);

struct Failure {
  Reason reason;
  std::string detail;  ///< one line for a person; may be empty
  /// "too few views: need 3, have 2"
  std::string message() const;
};

/// A value, or the named reason why it is missing. An unset Outcome cannot exist.
template <class T>
class [[nodiscard]] Outcome {
 public:
  Outcome(T value) : state_(std::move(value)) {}
  Outcome(Failure failure) : state_(std::move(failure)) {}
  explicit operator bool() const { return std::holds_alternative<T>(state_); }
  const T& operator*() const& { return std::get<T>(state_); }
  T& operator*() & { return std::get<T>(state_); }
  T&& operator*() && { return std::get<T>(std::move(state_)); }
  const T* operator->() const { return &std::get<T>(state_); }
  T* operator->() { return &std::get<T>(state_); }
  const Failure& failure() const { return std::get<Failure>(state_); }

 private:
  std::variant<T, Failure> state_;
};

/// The caller's bug: throws std::invalid_argument(message) when `condition` is false.
void require(bool condition, const char* message);
void require(bool condition, const std::string& message);

/// The outside world is wrong (a file, a flag, a disk): one line with file, place and reason.
/// Caught once, in cli/ and gui/; exit code 2.
class InputError : public std::runtime_error {
 public:
  /// @param file   path as the user gave it; may be empty.
  /// @param place  where in it: "frames[3].camera_from_world", "line 12", "--train"; may be empty.
  InputError(std::string file, std::string place, const std::string& reason);
  const std::string& file() const { return file_; }
  const std::string& place() const { return place_; }

 private:
  std::string file_, place_;
};

}  // namespace glint
