// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/base/outcome.h"
#include "core/inspect/live_prediction.h"

namespace glint {

/// What a line of a live stream says of its pose.
struct LivePose {
  std::string id;
  std::optional<double> time;  ///< s
};

/// One line of JSON in ASCII, with its line end: what was predicted for a pose. Keys as in docs/formats.md, "predict --stream".
/// @param timeUs  from the end of the pose's line to the contours
std::string liveLine(const LivePose& pose, const LiveAnswer& answer, double timeUs);

/// The same for a pose that could not be answered.
/// @param status  "failed" (there is no pose, or no camera for it) or "error" (the line is wrong)
/// @param id      "" = not known
std::string liveRefusal(const std::string& id, std::size_t line, const std::string& status, const std::string& reason);

}  // namespace glint
