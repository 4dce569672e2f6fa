// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "viz/annotations.h"
#include "viz/layers.h"

namespace glint::viz {

/// Errors have one absolute scale, so that a colour means the same in every scene: logarithmic from 0.01 to 100 %.
constexpr double kLeastErrorPct = 0.01, kMostErrorPct = 100;
/// A highlight was missed: not on the scale of errors.
inline constexpr Colour kMissed{0.93, 0.20, 0.75};
/// Blue (small) over yellow to red (large), told apart by the colour-blind and on dark and light grounds. NaN is grey.
Colour errorColour(double errorPct);

ColourBar errorBar(const std::string& model);

/// Blue: the frame helps; vermilion: it harms; pale: neither. `most` is the largest size among the frames, > 0.
Colour influenceColour(double points, double most);
ColourBar influenceBar(const std::string& model, double most);
/// The largest size of an influence among the frames; 0 without any.
double mostInfluence(const CameraColours& colours);

/// Colour of a camera, and what it stands for in the legend ("training", "dual"; empty on a scale).
struct CameraColour {
  Colour colour;
  std::string meaning;
};
/// Role: training, held-out. Model: the one that predicted this frame best, of those that missed no highlight of it. Error: of
/// `in.colours.model`, or where that is empty the richest one that is shown; grey without one, a colour of its own where
/// a highlight was missed. Influence: `in.colours.influence`; grey where the frame was not left out. Excluded frames look
/// excluded in all of them.
CameraColour cameraColour(const LayerInput& in, int frame);
/// The model whose error colours the cameras; "" without models.
std::string errorModel(const LayerInput& in);

}  // namespace glint::viz
