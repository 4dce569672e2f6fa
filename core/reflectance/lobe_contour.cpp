// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/geometry/camera.h"
#include "core/highlight/clipped_flank.h"
#include "core/reflectance/other_lamps.h"
#include "core/reflectance/pixel_fit.h"
#include "core/reflectance/radiance_field.h"

namespace glint {
namespace {

constexpr double kUnexplained = 0.1;  // of the top: beyond it the lobe says nothing of this frame
constexpr double kTrusted = 0.02;     // of the top: below it the lobe's own peak is the level's reference, else the observed one
constexpr double kSharpPx = 0.3;      // a stronger blur lowers the observed peak, and the level belongs to the blurred peak
constexpr int kEvidenceCells = 3000;
// A lobe that is off by a tenth over the radius then moves the contour by less than 0.02 % of the diameter.
constexpr double kWindowShare = 1.0 / 30;  // of the radius: standard deviation of the window in which noise is averaged
constexpr double kLargestWindowPx = 1.5, kLeastWindowPx = 0.25;
constexpr double kShownShare = 0.05;  // of the top: below it the lobe shows no factor

/// Bilinear between the cells' centres; nothing beyond them.
std::optional<double> between(const PixelPatch& p, const std::vector<double>& cells, double x, double y) {
  const double u = (x - p.firstCell.x()) / p.cellPx, v = (y - p.firstCell.y()) / p.cellPx;
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  if (column < 0 || row < 0 || column + 1 >= p.columns || row + 1 >= p.rows) return std::nullopt;
  const std::size_t i = static_cast<std::size_t>(row) * p.columns + column, below = i + static_cast<std::size_t>(p.columns);
  if (!p.onSurface[i] || !p.onSurface[i + 1] || !p.onSurface[below] || !p.onSurface[below + 1]) return std::nullopt;
  const double a = u - column, b = v - row;
  return (1 - b) * ((1 - a) * cells[i] + a * cells[i + 1]) + b * ((1 - a) * cells[below] + a * cells[below + 1]);
}

/// Between the cells' centres by cubic convolution (Keys 1981), which follows a lobe's bend; bilinear at the border.
std::optional<double> smoothlyBetween(const PixelPatch& p, const std::vector<double>& cells, double x, double y) {
  const double u = (x - p.firstCell.x()) / p.cellPx, v = (y - p.firstCell.y()) / p.cellPx;
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  if (column < 1 || row < 1 || column + 2 >= p.columns || row + 2 >= p.rows) return between(p, cells, x, y);
  const auto taps = [](double t) {
    return std::array<double, 4>{t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)),
                                 t * t * (-0.5 + 0.5 * t)};
  };
  const std::array<double, 4> across = taps(u - column), down = taps(v - row);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const std::size_t cell = static_cast<std::size_t>(row - 1 + j) * p.columns + static_cast<std::size_t>(column - 1 + i);
      if (!p.onSurface[cell]) return between(p, cells, x, y);
      sum += across[static_cast<std::size_t>(i)] * down[static_cast<std::size_t>(j)] * cells[cell];
    }
  return sum;
}

/// I - b on the pixels of a patch; the mask is 1 where b is known.
struct Corrected {
  Image value, mask;
  Pixel origin{0, 0};  ///< measured pixel of its first pixel
};
Corrected corrected(const LinearPixels& pixels, const PixelPatch& patch, const std::vector<double>& background) {
  const int x0 = std::max(0, static_cast<int>(std::ceil(patch.firstCell.x()))),
            y0 = std::max(0, static_cast<int>(std::ceil(patch.firstCell.y())));
  const int x1 = std::min(pixels.value.width - 1, static_cast<int>(patch.firstCell.x() + (patch.columns - 1) * patch.cellPx));
  const int y1 = std::min(pixels.value.height - 1, static_cast<int>(patch.firstCell.y() + (patch.rows - 1) * patch.cellPx));
  Corrected c{Image(std::max(1, x1 - x0 + 1), std::max(1, y1 - y0 + 1), 1),
              Image(std::max(1, x1 - x0 + 1), std::max(1, y1 - y0 + 1), 1), Pixel(x0, y0)};
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const std::optional<double> b = between(patch, background, x, y);
      const std::size_t i = static_cast<std::size_t>(y) * pixels.value.width + x;
      if (!b || !(pixels.usable[i] || pixels.clipped[i])) continue;
      // A pixel that noise puts below the background is not broken.
      c.value.at(x - x0, y - y0) = static_cast<float>(std::max(0.0, pixels.value.data[i] - *b));
      c.mask.at(x - x0, y - y0) = 1;
    }
  return c;
}

/// Removes noise and quantisation of single pixels. The factor I / S is constant where the lobe is right and as smooth as the
/// highlight where it is not; it is averaged over a few pixels (least squares, Gaussian window), while S keeps the shape. Clipped
/// pixels stay out.
void evenOut(Corrected& c, const LinearPixels& pixels, const PixelPatch& patch, const std::vector<double>& lobe) {
  const double sigma = std::min(kLargestWindowPx, kWindowShare * patch.radiusPx);
  if (!(sigma > kLeastWindowPx)) return;
  const double top = *std::max_element(lobe.begin(), lobe.end());
  const int w = c.value.width, h = c.value.height, reach = static_cast<int>(std::ceil(2.5 * sigma));
  std::vector<double> shape(static_cast<std::size_t>(w) * h, 0);  // S where it counts
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const Pixel at = c.origin + Pixel(x, y);
      const std::size_t i = static_cast<std::size_t>(at.y()) * pixels.value.width + static_cast<std::size_t>(at.x());
      if (c.mask.at(x, y) == 0 || pixels.clipped[i]) continue;
      const std::optional<double> s = smoothlyBetween(patch, lobe, at.x(), at.y());
      if (s && *s > kShownShare * top) shape[static_cast<std::size_t>(y) * w + x] = *s;
    }
  std::vector<double> taps;
  for (int k = -reach; k <= reach; ++k) taps.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  // Separable: sums of w I S and of w S^2, along rows, then along columns.
  std::vector<double> products(shape.size()), squares(shape.size());
  for (std::size_t i = 0; i < shape.size(); ++i) {
    products[i] = shape[i] * c.value.data[i];
    squares[i] = shape[i] * shape[i];
  }
  const auto along = [&](std::vector<double>& of, bool rows) {
    std::vector<double> sums(of.size(), 0);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int k = -reach; k <= reach; ++k) {
          const int u = rows ? x + k : x, v = rows ? y : y + k;
          if (u < 0 || v < 0 || u >= w || v >= h) continue;
          sums[static_cast<std::size_t>(y) * w + x] +=
              taps[static_cast<std::size_t>(k + reach)] * of[static_cast<std::size_t>(v) * w + u];
        }
    of = std::move(sums);
  };
  for (std::vector<double>* of : {&products, &squares}) {
    along(*of, true);
    along(*of, false);
  }
  for (std::size_t i = 0; i < shape.size(); ++i)
    if (shape[i] > 0) c.value.data[i] = static_cast<float>(shape[i] * products[i] / squares[i]);
}

/// The contour that belongs to a highlight found before: the one that overlaps it most, in ideal pixels.
std::optional<Highlight> sameHighlight(std::vector<Highlight> traced, const Pixel& origin, const Highlight& before,
                                       const Camera& camera) {
  std::optional<Highlight> best;
  double largest = 0;
  for (Highlight& h : traced) {
    bool valid = true;
    const auto ideal = [&](Pixel& p) {
      const Outcome<Pixel> undistorted = withoutDistortion(camera, p + origin);
      valid = valid && undistorted;
      if (undistorted) p = *undistorted;
    };
    for (Pixel& p : h.contour.points) ideal(p);
    ideal(h.peak);
    if (!valid) continue;
    const bool overlaps = contains(h.contour, centroid(before.contour)) || contains(before.contour, centroid(h.contour));
    h.areaPx2 = std::abs(signedArea(h.contour));
    if (!overlaps || !(h.areaPx2 > largest)) continue;
    largest = h.areaPx2;
    h.ellipse.reset();
    if (const Outcome<Ellipse> e = fitEllipse(h.contour.points)) h.ellipse = *e;
    best = std::move(h);
  }
  return best;
}

bool anyClipped(const LinearPixels& pixels, const Polyline& measured) {
  Eigen::AlignedBox2d box;
  for (const Pixel& p : measured.points) box.extend(p);
  const int x0 = std::max(0, int(box.min().x())), x1 = std::min(pixels.value.width - 1, int(box.max().x()) + 1);
  const int y0 = std::max(0, int(box.min().y())), y1 = std::min(pixels.value.height - 1, int(box.max().y()) + 1);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      if (pixels.clipped[static_cast<std::size_t>(y) * pixels.value.width + x] && contains(measured, Pixel(x, y))) return true;
  return false;
}

/// A highlight whose peak the image's border cuts off has the lobe's, which the pixels that are seen determine.
void placeBeyond(Highlight& h, const std::vector<RadiancePeak>& peaks, double value) {
  const auto nearest = std::min_element(peaks.begin(), peaks.end(), [&](const RadiancePeak& a, const RadiancePeak& b) {
    return (a.pixel - h.peak).norm() < (b.pixel - h.peak).norm();
  });
  if (nearest == peaks.end() || nearest->cut) return;
  h.peakCut = false;
  h.peak = nearest->pixel;
  h.peakValue = value;
}

}  // namespace

Outcome<std::vector<Highlight>> contourWithLobe(const LinearPixels& pixels, const Camera& camera, const Surface& surface,
                                                int frame, const std::vector<Highlight>& found,
                                                const std::vector<Highlight>& others, const LobeModel& model,
                                                BackgroundKind background, const DetectOptions& options,
                                                const std::vector<LampLight>& alsoLit) {
  std::vector<PixelPatch> patches;
  std::vector<std::vector<double>> ofOthers;
  PatchOptions around;
  around.cells = kEvidenceCells;
  around.blurPx = model.blurPx();
  for (const Highlight& h : found) {
    Outcome<PixelPatch> patch = pixelPatch(pixels, camera, surface, frame, h, others, around);
    if (!patch) return patch.failure();
    ofOthers.push_back(lightOn(*patch, alsoLit, surface, camera));
    patches.push_back(alsoLit.empty() ? *std::move(patch) : withoutLight(*std::move(patch), ofOthers.back()));
  }
  std::vector<const PixelPatch*> pointers;
  for (const PixelPatch& p : patches) pointers.push_back(&p);
  const Outcome<std::vector<PatchSolution>> solved = solvePatches(pointers, model, background);
  if (!solved) return solved.failure();
  double worst = 0;
  for (const PatchSolution& s : *solved) worst = std::max(worst, std::isfinite(s.relativeRms) ? s.relativeRms : 1);
  if (worst > kUnexplained) return Failure{Reason::NotConverged, "the lobe leaves more than a tenth of the peak unexplained"};

  const RadianceField field(surface, camera, model.lobe, model.roughness, model.lamp);
  std::vector<Pixel> starts;
  for (const Highlight& h : found) starts.push_back(h.peak);
  const std::vector<RadiancePeak> peaks = field.peaks(starts, 0);
  const PatchSolution& strongest = solved->front();
  std::optional<double> reference;
  const bool beyond = std::any_of(found.begin(), found.end(), [](const Highlight& h) { return h.peakCut; });
  if (!peaks.empty() && !peaks.front().cut && (beyond || model.blurPx() < kSharpPx) && worst < kTrusted) {
    const std::optional<double> top = field.at(strongest.topPoint, std::numeric_limits<double>::infinity());
    if (top) reference = strongest.strength * std::exp(peaks.front().logRadiance - *top);
  }

  DetectOptions again = options;
  again.removeBackground = false;
  again.separatePeaks = false;
  again.references.clear();
  again.minRelativePeak = 0;
  again.clipValue = 0;  // the values have lost their background
  const auto trace = [&](std::size_t k) -> std::optional<Highlight> {
    std::vector<double> under = (*solved)[k].background;
    for (std::size_t i = 0; i < under.size(); ++i) under[i] += ofOthers[k][i];
    Corrected c = corrected(pixels, patches[k], under);
    evenOut(c, pixels, patches[k], (*solved)[k].lobe);
    again.reference = reference;
    Outcome<std::vector<Highlight>> traced = detectHighlights(c.value, &c.mask, again);
    return traced ? sameHighlight(*std::move(traced), c.origin, found[k], camera) : std::nullopt;
  };
  const bool byLobe = reference.has_value();
  if (!reference) {  // the strongest observed peak of all the light's highlights
    double top = 0;
    for (std::size_t k = 0; k < found.size(); ++k)
      if (const std::optional<Highlight> h = trace(k)) top = std::max(top, h->peakValue);
    if (!(top > 0)) return Failure{Reason::NoHighlight, "nothing rises above the lobe's background"};
    reference = top;
  }
  std::vector<Highlight> result;
  for (std::size_t k = 0; k < found.size(); ++k) {
    Highlight h = found[k];
    const double clipLevel = options.clipValue > 0 ? options.clipValue : std::numeric_limits<double>::infinity();
    const std::optional<Highlight> traced = trace(k);
    const bool hidden = h.clipped && options.level * *reference >= clipLevel - patches[k].top * kUnexplained;
    if (traced && !hidden) {
      h.level = options.level;
      h.contour = traced->contour;
      h.areaPx2 = traced->areaPx2;
      h.ellipse = traced->ellipse;
      h.touchesBorder = found[k].touchesBorder;
      h.peakValue = traced->peakValue;
      h.peak = traced->peak;
      if (h.peakCut && byLobe) placeBeyond(h, peaks, *reference);
      Polyline measured = h.contour;
      for (Pixel& p : measured.points) p = camera.distorted(p);
      h.clipped = anyClipped(pixels, measured);
    } else if (h.clipped) {
      // It was contoured at `level` of the clip value, or of the peak that its slope continues.
      const double taken = h.flank && h.flank->outsideCore ? h.flank->contourValue / options.level : clipLevel;
      h.trueLevel = options.level * std::min(1.0, taken / *reference);
    }
    if (h.clipped) {
      // The lobe knows its peak where the pixels do not.
      double nearest = std::numeric_limits<double>::infinity();
      for (const RadiancePeak& p : peaks)
        if (contains(h.contour, p.pixel) && (p.pixel - h.peak).norm() < nearest) {
          nearest = (p.pixel - h.peak).norm();
          h.peak = p.pixel;
        }
    }
    result.push_back(std::move(h));
  }
  return result;
}

}  // namespace glint
