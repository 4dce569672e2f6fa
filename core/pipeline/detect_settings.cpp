// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/detect_settings.h"

#include <string>

namespace glint {

DetectSettings::DetectSettings(const Settings& settings)
    : level(settings.number("detect.level")),
      minAreaPx2(settings.number("detect.min_area")),
      minContrast(settings.number("detect.min_contrast")),
      peakWindowLevel(settings.number("detect.peak_window")),
      clipValue(settings.number("detect.clip")),
      motion(motionUse(settings)) {
  const std::string& under = settings.text("detect.background");
  texture = settings.text("detect.texture") == "auto" && under != "colours";  // colours find the specular part in their own way
  background = under == "lobe" ? BackgroundUse::Lobe : under == "colours" ? BackgroundUse::Colours : BackgroundUse::Smooth;
}

DetectSettings DetectSettings::at(double otherLevel) const {
  DetectSettings other = *this;
  other.level = otherLevel;
  return other;
}

}  // namespace glint
