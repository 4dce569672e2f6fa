// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/settings.h"
#include "core/pipeline/highlight_motion.h"

namespace glint {

/// What lies under a highlight, see detect.background.
enum class BackgroundUse { Smooth, Lobe, Colours };

/// The settings of the detection: looked up once, for all frames and all that they are asked for. Two runs with equal ones
/// detect the same.
struct DetectSettings {
  double level = 0.5;          ///< fraction of the peak above the background, 0 to 1
  double minAreaPx2 = 0;       ///< px^2
  double minContrast = 0;      ///< of a peak above its surroundings
  double peakWindowLevel = 0;  ///< fraction of the peak, down to which pixels tell its place
  double clipValue = 0;        ///< of linear values; 0 = what the file says
  BackgroundUse background = BackgroundUse::Lobe;
  MotionUse motion = MotionUse::Reject;
  bool texture = false;  ///< taken off where other views show it, see detect.texture

  DetectSettings() : DetectSettings(Settings{}) {}
  /// Not explicit: whoever has settings asks with them.
  DetectSettings(const Settings& settings);  // NOLINT(google-explicit-constructor)
  DetectSettings at(double otherLevel) const;
  friend bool operator==(const DetectSettings&, const DetectSettings&) = default;
};

}  // namespace glint
