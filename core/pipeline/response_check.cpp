// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/response_check.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/base/evenly.h"
#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr std::size_t kAskedViews = 3;    // one curve is behind all of them
constexpr double kTogether = 0.5;         // of the cells, independent ones: noise and 8 bits leave more
constexpr double kClearlyLess = 2.0 / 3;  // of the residual; right curves leave a half to a sixth of what wrong ones do
constexpr std::array<const char*, 3> kOthers{"linear", "gamma:1.8", "gamma:2.2"};  // of raw converters, old Macs, and displays

/// Whether a frame's values are codes through the curve that is taken where none is stated.
bool isAssumed(const Frame& frame, FrameSource source) {
  const bool photograph = !frame.image.empty() && (source == FrameSource::Image || frame.radiance.empty());
  if (!photograph || frame.response.isStated()) return false;
  std::string how;
  return readLinear(frame, source, &how) && how.find("(default") != std::string::npos;
}

/// A patch whose codes mean other light.
PixelPatch throughCurve(PixelPatch patch, const CameraResponse& response) {
  const CameraResponse assumed;
  patch.top = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    patch.value[i] = static_cast<float>(response.lightOf(assumed.codeOf(patch.value[i], 0), 0));
    if (patch.used[i]) patch.top = std::max<double>(patch.top, patch.value[i]);
  }
  return patch;
}

/// What remains of the patches, px.
std::optional<double> remainsOf(const std::vector<PixelPatch>& patches, const PixelFit& start, const ProgressFn& progress) {
  std::vector<const PixelPatch*> all;
  for (const PixelPatch& patch : patches) all.push_back(&patch);
  std::vector<Lobe> lobes{start.model.lobe};
  for (const Lobe other : {Lobe::TorranceSparrow, Lobe::Ggx})
    if (other != start.model.lobe) lobes.push_back(other);
  PixelFitOptions options;
  options.progress = progress;
  const Outcome<PixelFit> fit = fitPixels(lobes, all, start.model.lamp, start.model.roughness, options);
  return fit && !fit->poor ? std::optional(fit->rmsPx) : std::nullopt;
}

}  // namespace

std::string responseDoubt(const Scene& scene, FrameSource source, const std::vector<TrainingView>& views, const PixelFit& fit,
                          const ProgressFn& progress) {
  if (fit.poor || !(fit.independentCells < kTogether * fit.cells)) return "";
  std::vector<const TrainingView*> seen;
  for (const TrainingView& view : views) {
    if (!isAssumed(scene.frames[static_cast<std::size_t>(view.frame)], source)) return "";
    if (view.pixels) seen.push_back(&view);
  }
  std::vector<PixelPatch> asRead;
  for (const TrainingView* view : evenly(seen, kAskedViews)) asRead.push_back(*view->pixels);
  if (asRead.empty()) return "";
  const std::optional<double> given = remainsOf(asRead, fit, progress);
  if (!given) return "";
  const char* better = nullptr;
  double least = kClearlyLess * *given;
  for (const char* text : kOthers) {
    const CameraResponse response = *CameraResponse::named(text, "", "");
    std::vector<PixelPatch> other;
    for (const PixelPatch& patch : asRead) other.push_back(throughCurve(patch, response));
    const std::optional<double> left = remainsOf(other, fit, progress);
    if (left && *left < least) better = text, least = *left;
  }
  if (!better) return "";
  return formatted(
      "no response of the camera is stated, and the pixels of the highlights do not follow the sRGB curve: read as %s, the fit "
      "leaves %.2g px instead of %.2g px (state it: \"response\": \"%s\" in the camera, or --response %s for a capture)",
      better, least, *given, better, better);
}

}  // namespace glint
