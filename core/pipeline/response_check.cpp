// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/response_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/base/evenly.h"
#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr std::size_t kAskedViews = 3;  // one curve is behind all of them
constexpr double kTogether = 0.5;       // of the cells, independent ones: noise and 8 bits leave more
// What the logarithm of the codes' variance must fall by, where the better curve explains the pixels down to noise: gamma 2.2
// leaves 0.2 less than sRGB, in the noise of 8 linear bits; JPEG's blocks leave wrong curves up to 0.01 less.
constexpr double kClearlyLess = 0.15;
// The same where what remains still goes together: poses, lobes in two parts and meshes that are off leave up to 0.6 less
// through a wrong curve, S-curves 1 to 4 less through one that is near.
constexpr double kFarLess = 0.8;
constexpr double kExplains = 0.4;     // of the cells, independent ones
constexpr double kHardlyACode = 0.2;  // of 255: less than rounding leaves (0.29) is explained too, and then this must be gained:
constexpr double kLessOfLittle = 0.3;
constexpr double kBeyondChance = 15;  // of the logarithm of the likelihood: noise gains one or two
/// What raw converters, old Macs and displays write, and contrasts of developed photographs.
constexpr std::array<const char*, 5> kOthers{"linear", "gamma:1.8", "gamma:2.2", "s-curve:0.3", "s-curve:0.6"};
constexpr double kFirstStep = 0.15;       // of the contrast: half way to the other one
constexpr int kMostIterations = 25;       // from a start that is near: curves that take longer leave much
constexpr double kFinestContrast = 0.01;  // of an S-curve: its contours lie within 0.1 %
constexpr int kShades = 16;               // parts of the codes, each with noise of its own: there are hundreds of cells
constexpr double kFinestCode = 1.0 / 65535;

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

/// The codes that a fit leaves unexplained.
struct CodesLeft {
  double logVariance = 0;  ///< mean over the cells; the variance is that of codes like the cell's own

  double typical() const { return 255 * std::exp(logVariance / 2); }  ///< of codes from 0 to 255
};

/// Codes are what was measured, so that curves can be compared by how well they explain them: the logarithm of the likelihood is
/// - n / 2 times the logarithm of their variance.
std::optional<CodesLeft> codesLeft(const std::vector<PixelPatch>& patches, const CameraResponse& response, const PixelFit& fit) {
  std::map<int, std::vector<const PixelPatch*>> byFrame;
  for (const PixelPatch& p : patches) byFrame[p.frame].push_back(&p);
  struct Shade {
    double cells = 0, squares = 0;
  };
  std::array<Shade, kShades> shades{};
  for (const auto& [frame, own] : byFrame) {
    const Outcome<std::vector<PatchSolution>> solved = solvePatches(own, fit.model, fit.background);
    if (!solved) return std::nullopt;
    for (std::size_t k = 0; k < own.size(); ++k)
      for (std::size_t i = 0; i < own[k]->size(); ++i) {
        if (!own[k]->used[i]) continue;
        const PatchSolution& s = (*solved)[k];
        const double code = response.codeOf(own[k]->value[i], 0);
        const double left = response.codeOf(s.strength * s.lobe[i] + s.background[i], 0) - code;
        Shade& shade = shades[static_cast<std::size_t>(std::clamp(static_cast<int>(kShades * code), 0, kShades - 1))];
        shade.cells += 1;
        shade.squares += left * left;
      }
  }
  CodesLeft left;
  double cells = 0;
  for (const Shade& s : shades) {
    if (s.cells == 0) continue;
    left.logVariance += s.cells * std::log(s.squares / s.cells + kFinestCode * kFinestCode / 12);
    cells += s.cells;
  }
  left.logVariance /= cells;
  return left;
}

/// How well pixels are explained if a curve is behind their codes.
struct TriedCurve {
  CameraResponse response;
  PixelFit fit;
  CodesLeft left;
};

/// The power that a curve is at half of the codes: a highlight is as much wider as its square root.
double powerOf(const CameraResponse& response) { return -std::log2(response.lightOf(0.5, 0)); }

/// Fits the pixels of views as they were read, with other curves.
class CurveTrials {
 public:
  CurveTrials(std::vector<PixelPatch> asRead, LobeModel start, const ProgressFn& progress)
      : asRead_(std::move(asRead)), start_(std::move(start)), progress_(progress) {}

  std::optional<TriedCurve> with(const CameraResponse& response) const {
    std::vector<Lobe> lobes{start_.lobe};
    for (const Lobe other : {Lobe::TorranceSparrow, Lobe::Ggx})
      if (other != start_.lobe) lobes.push_back(other);
    LobeModel start = start_;
    start.roughness.mean *= std::sqrt(powerOf(CameraResponse()) / powerOf(response));
    return fitted(response, lobes, start, {});
  }
  /// The contrast of the S-curve that explains most: halving steps from one that was tried.
  TriedCurve bestContrast(TriedCurve best) const {
    double contrast = best.response.number();
    for (double step = kFirstStep; step > kFinestContrast / 2; step /= 2)
      for (const double sign : {1.0, -1.0}) {
        const double moved = contrast + sign * step;
        const std::string text = formatted("s-curve:%.3f", moved);
        if (!(moved < CameraResponse::kMostContrast)) continue;
        const std::optional<TriedCurve> tried =
            fitted(*CameraResponse::named(text, "", ""), {best.fit.model.lobe}, best.fit.model, best.fit.background);
        if (!tried || !(tried->left.logVariance < best.left.logVariance)) continue;
        best = *tried;
        contrast = moved;
        break;
      }
    return best;
  }

 private:
  std::optional<TriedCurve> fitted(const CameraResponse& response, const std::vector<Lobe>& lobes, const LobeModel& start,
                                   const std::optional<BackgroundKind>& background) const {
    std::vector<PixelPatch> patches;
    for (const PixelPatch& patch : asRead_) patches.push_back(throughCurve(patch, response));
    std::vector<const PixelPatch*> all;
    for (const PixelPatch& patch : patches) all.push_back(&patch);
    PixelFitOptions options;
    options.background = background;
    options.maxIterations = kMostIterations;
    options.blur = start_.blurVariance != 0;
    options.progress = progress_;
    const Outcome<PixelFit> fit = fitPixels(lobes, all, start.lamp, start.roughness, options);
    if (!fit) return std::nullopt;
    const std::optional<CodesLeft> left = codesLeft(patches, response, *fit);
    return left ? std::optional(TriedCurve{response, *fit, *left}) : std::nullopt;
  }

  std::vector<PixelPatch> asRead_;
  LobeModel start_;
  const ProgressFn& progress_;
};

}  // namespace

bool asksForResponse(const PixelFit& fit) { return fit.poor || fit.independentCells < kTogether * fit.cells; }

std::string responseDoubt(const Scene& scene, FrameSource source, const std::vector<TrainingView>& views, const LobeModel& start,
                          const ProgressFn& progress) {
  std::vector<const TrainingView*> seen;
  for (const TrainingView& view : views) {
    if (!isAssumed(scene.frames[static_cast<std::size_t>(view.frame)], source)) return "";
    if (view.pixels) seen.push_back(&view);
  }
  std::vector<PixelPatch> asRead;
  for (const TrainingView* view : evenly(seen, kAskedViews)) asRead.push_back(*view->pixels);
  if (asRead.empty()) return "";
  const CurveTrials trials(std::move(asRead), start, progress);
  const std::optional<TriedCurve> given = trials.with(CameraResponse());
  if (!given) return "";
  std::optional<TriedCurve> best;
  for (const char* text : kOthers) {
    const std::optional<TriedCurve> tried = trials.with(*CameraResponse::named(text, "", ""));
    if (tried && !tried->fit.poor && (!best || tried->left.logVariance < best->left.logVariance)) best = tried;
  }
  if (!best) return "";
  if (best->response.kind() == CameraResponse::Kind::SCurve) best = trials.bestContrast(*best);
  const double independent = best->fit.independentCells;
  const double gain = given->left.logVariance - best->left.logVariance;
  const double least = independent > kExplains * best->fit.cells ? kClearlyLess
                       : best->left.typical() < kHardlyACode     ? kLessOfLittle
                                                                 : kFarLess;
  if (!(gain > least && gain / 2 * independent > kBeyondChance)) return "";
  const std::string text = best->response.text();
  return formatted(
      "no response of the camera is stated, and the pixels of the highlights do not follow the sRGB curve: read as %s, the fit "
      "leaves %.2g of 255 codes instead of %.2g (state it: \"response\": \"%s\" in the camera, or --response %s for a capture)",
      text.c_str(), best->left.typical(), given->left.typical(), text.c_str(), text.c_str());
}

}  // namespace glint
