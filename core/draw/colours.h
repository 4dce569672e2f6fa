// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "core/model/models.h"

namespace glint::draw {

/// sRGB, 0..1.
using Colour = std::array<double, 3>;

/// Colour of a model, the same in every view and report; grey for an unknown one.
inline Colour modelColour(const std::string& model) {
  const std::array<int, 3> rgb = modelRgb(model);
  return {rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0};
}
/// Nearer to grey, for what counts less: poor models, earlier requests, filtered predictions.
inline Colour pale(Colour colour) {
  for (double& channel : colour) channel = 0.5 * (channel + 0.5);
  return colour;
}
/// The colour of a model is paler where its fit is poor, in every view and report.
inline Colour modelColour(const std::string& model, bool poor) { return poor ? pale(modelColour(model)) : modelColour(model); }
/// What lies on the tangent planes: canonical contours, their ellipses and the walks to them.
inline Colour canonicalColour() { return modelColour(canonicalModel().id()); }
inline constexpr Colour kObserved{1.0, 1.0, 1.0};  ///< drawn with a dark halo
inline constexpr Colour kLightColour{0.941, 0.894, 0.259};
inline constexpr Colour kVirtualCamera{0.70, 0.62, 0.95};  ///< not a model's colour
inline constexpr Colour kTraining{0.000, 0.447, 0.698};    ///< blue: training frames
inline constexpr Colour kHeldOut{0.55, 0.55, 0.55};
inline constexpr Colour kExcluded{0.55, 0.33, 0.30};       ///< frames that are left out
inline constexpr Colour kFailed{0.85, 0.10, 0.10};         ///< directions and frames that failed
inline constexpr Colour kTruth{0.80, 0.00, 0.60};          ///< true lights: never used by the method
inline constexpr Colour kSurface{0.46, 0.49, 0.53};        ///< subdued, so that lines and models stand out
inline constexpr Colour kActiveView{0.184, 0.486, 0.769};  ///< the accent colour: border of the active view, badges
inline constexpr Colour kDarkBackground{0.10, 0.11, 0.13}, kLightBackground{0.97, 0.97, 0.97};
inline constexpr Colour kTextOnDark{0.92, 0.92, 0.92}, kTextOnLight{0.10, 0.10, 0.10};
inline constexpr Colour kHalo{0.12, 0.13, 0.15};  ///< dark stroke beneath what is white on every background

inline constexpr Colour kMeasuredLamp{
    0.42, 0.74, 0.13};  ///< neither a model's, nor that of a scene's lights; also of balls' refined outlines

/// Colour of what the user points at elsewhere, such as a symbol. No model, light or axis has it; texts in it can be read.
inline constexpr Colour kLitOnDark{0.35, 1.0, 1.0}, kLitOnLight{0.0, 0.47, 0.55};

}  // namespace glint::draw
