// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/outcome.h"

namespace glint {

const char* nameOf(Reason reason) {
  switch (reason) {
    case Reason::TooFewViews: return "too few views";
    case Reason::TooFewPoints: return "too few points";
    case Reason::RankDeficient: return "rank deficient";
    case Reason::NotAnEllipse: return "not an ellipse";
    case Reason::NotAnEllipsoid: return "not an ellipsoid";
    case Reason::ParallelRays: return "parallel rays";
    case Reason::LightBehindSurface: return "light behind surface";
    case Reason::NoHit: return "no hit";
    case Reason::SurfaceEnded: return "surface ended";
    case Reason::Occluded: return "occluded";
    case Reason::NotReached: return "not reached";
    case Reason::NotMonotonic: return "not monotonic";
    case Reason::NoBrightestPoint: return "no brightest point";
    case Reason::NoHighlight: return "no highlight";
    case Reason::Clipped: return "clipped";
    case Reason::OutsideImage: return "outside image";
    case Reason::BehindCamera: return "behind camera";
    case Reason::PeakOffSurface: return "peak off surface";
    case Reason::NoLight: return "no light";
    case Reason::LightOff: return "light off";
    case Reason::NotFinite: return "not finite";
    case Reason::NotConverged: return "not converged";
    case Reason::NotSupported: return "not supported";
    case Reason::NoSurface: return "no surface";
    case Reason::FrameUnreadable: return "frame unreadable";
    case Reason::Cancelled: return "cancelled";
  }
  return "unknown";
}

std::optional<Reason> reasonNamed(std::string_view name) {
  for (int i = 0; i <= static_cast<int>(Reason::Cancelled); ++i)
    if (nameOf(static_cast<Reason>(i)) == name) return static_cast<Reason>(i);
  return std::nullopt;
}

std::string Failure::message() const {
  return detail.empty() ? std::string(nameOf(reason)) : std::string(nameOf(reason)) + ": " + detail;
}

void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}
void require(bool condition, const std::string& message) { require(condition, message.c_str()); }

namespace {
std::string oneLine(const std::string& file, const std::string& place, const std::string& reason) {
  std::string line = file;
  if (!place.empty()) line += (line.empty() ? "" : ": ") + place;
  return line.empty() ? reason : line + ": " + reason;
}
}  // namespace

InputError::InputError(std::string file, std::string place, const std::string& reason)
    : std::runtime_error(oneLine(file, place, reason)), file_(std::move(file)), place_(std::move(place)) {}

}  // namespace glint
