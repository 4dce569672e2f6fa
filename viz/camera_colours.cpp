// SPDX-License-Identifier: BSD-3-Clause
#include "viz/camera_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/number_text.h"
#include "core/draw/frame_overlay.h"
#include "core/pipeline/frame_score.h"
#include "viz/style.h"

namespace glint::viz {

Colour errorColour(double errorPct) {
  if (!std::isfinite(errorPct)) return kHeldOut;
  static constexpr std::array<Colour, 5> stops{
      {{0.27, 0.50, 0.90}, {0.25, 0.72, 0.72}, {0.85, 0.80, 0.30}, {0.95, 0.53, 0.15}, {0.80, 0.13, 0.22}}};
  const double share = std::log(std::max(errorPct, kLeastErrorPct) / kLeastErrorPct) / std::log(kMostErrorPct / kLeastErrorPct);
  const double at = std::clamp(share, 0.0, 1.0) * (stops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  Colour colour;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = stops[i][c] + (at - static_cast<double>(i)) * (stops[i + 1][c] - stops[i][c]);
  return colour;
}

ColourBar errorBar(const std::string& model) {
  ColourBar bar;
  bar.title = model + ": contour error";
  constexpr int kSteps = 48;
  for (int i = 0; i < kSteps; ++i)
    bar.colours.push_back(errorColour(kLeastErrorPct * std::pow(kMostErrorPct / kLeastErrorPct, (i + 0.5) / kSteps)));
  bar.ticks = {{0, "0.01"}, {0.25, "0.1"}, {0.5, "1"}, {0.75, "10"}, {1, "100 %"}};
  return bar;
}

Colour influenceColour(double points, double most) {
  constexpr Colour kNeither{0.88, 0.88, 0.84}, kHelps{0.00, 0.45, 0.70},
      kHarms{0.84, 0.37, 0.00};  // Okabe-Ito's blue and vermilion
  const double share = most > 0 ? std::clamp(points / most, -1.0, 1.0) : 0;
  const Colour& end = share >= 0 ? kHelps : kHarms;
  Colour colour;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = kNeither[c] + std::abs(share) * (end[c] - kNeither[c]);
  return colour;
}

ColourBar influenceBar(const std::string& model, double most) {
  ColourBar bar;
  bar.title = model + ": influence, percentage points";
  constexpr int kSteps = 48;
  for (int i = 0; i < kSteps; ++i) bar.colours.push_back(influenceColour(2 * (i + 0.5) / kSteps - 1, 1));
  const std::string text = formatted("%.2g", most);
  bar.ticks = {{0, "harms " + text}, {0.5, "0"}, {1, "helps " + text}};
  return bar;
}

double mostInfluence(const CameraColours& colours) {
  double most = 0;
  for (const auto& [frame, points] : colours.influence) most = std::max(most, std::abs(points));
  return most;
}

std::string errorModel(const LayerInput& in) {
  const std::string& wanted = in.colours.model;
  if (std::find(in.models.begin(), in.models.end(), wanted) != in.models.end()) return wanted;
  return in.models.empty() ? std::string() : in.models.back();
}

CameraColour cameraColour(const LayerInput& in, int frame) {
  constexpr const char* kExcludedCamera = "excluded camera";
  const bool excluded = !in.inspection->isTraining(frame) && !in.inspection->isHeldOut(frame);
  if (excluded) return {kExcluded, kExcludedCamera};  // nothing is evaluated there, whatever the colours say of the others
  if (in.colours.by == CameraColours::By::Model) {
    std::string best;
    double least = 0;
    bool missed = false;
    for (const std::string& model : in.models) {
      const FrameScore score = frameScore(in.inspection->models.at(model), frame);
      missed = missed || score.missed > 0;
      const std::optional<double> pct = wholeErrorPct(score);
      if (!pct || (!best.empty() && *pct >= least)) continue;
      best = model;
      least = *pct;
    }
    if (!best.empty()) return {modelColour(best), "best: " + best};
    return missed ? CameraColour{kMissed, "every model missed a highlight"} : CameraColour{kHeldOut, "no prediction"};
  }
  if (in.colours.by == CameraColours::By::Error) {
    const std::string model = errorModel(in);
    if (model.empty()) return {kHeldOut, ""};
    const FrameScore score = frameScore(in.inspection->models.at(model), frame);
    if (score.missed > 0) return {kMissed, "missed a highlight"};
    return {errorColour(score.errorPct.value_or(std::nan(""))), ""};
  }
  if (in.colours.by == CameraColours::By::Influence) {
    const auto found = in.colours.influence.find(frame);
    if (found == in.colours.influence.end()) return {kHeldOut, ""};
    return {influenceColour(found->second, mostInfluence(in.colours)), ""};
  }
  if (in.inspection->isTraining(frame)) return {kTraining, "training camera"};
  return {kHeldOut, "held-out camera"};
}

}  // namespace glint::viz
