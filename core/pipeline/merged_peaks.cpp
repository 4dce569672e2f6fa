// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/merged_peaks.h"

#include <algorithm>
#include <numeric>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/model/models.h"

namespace glint {
namespace {

constexpr double kValleyShare = 0.2;   // of a peak's height above the contour: grain and JPEG blocks make shallower valleys
constexpr double kLeastRise = 0.1;     // of the highest peak's height: what noise makes at the contour stays below
constexpr double kMostShow = 2.0 / 3;  // of the views: a spot of paint shows in a few
constexpr std::size_t kLeastShow = 2;  // views
constexpr int kCertainPeaks = 2;       // more than one lamp makes: two may be a long lamp's ends or one bump

/// Means over three by three cells that lie inside; negative elsewhere.
std::vector<double> smoothedInside(const PixelPatch& patch, const Polyline& contour) {
  std::vector<double> smooth(patch.size(), -1);
  for (int row = 0; row < patch.rows; ++row)
    for (int column = 0; column < patch.columns; ++column) {
      const std::size_t cell = std::size_t(row) * patch.columns + column;
      if (!patch.used[cell] || !contains(contour, patch.camera.undistorted(patch.firstCell + patch.cellPx * Pixel(column, row))))
        continue;
      double sum = 0, count = 0;
      for (int r = std::max(0, row - 1); r <= std::min(patch.rows - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(patch.columns - 1, column + 1); ++c)
          if (const std::size_t at = std::size_t(r) * patch.columns + c; patch.used[at]) sum += patch.value[at], ++count;
      smooth[cell] = sum / count;
    }
  return smooth;
}

}  // namespace

int peaksInside(const PixelPatch& patch, const Polyline& contour) {
  const std::vector<double> value = smoothedInside(patch, contour);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (value[i] >= 0) order.push_back(i);
  if (order.empty()) return 0;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return value[a] > value[b]; });
  const double foot = value[order.back()], height = value[order.front()] - foot;
  // Cells join in falling order. Where two hills meet, the lower one counts if the way down from its top is long enough.
  std::vector<std::size_t> hill(value.size(), value.size());
  const auto topOf = [&](std::size_t cell) {
    while (hill[cell] != cell) cell = hill[cell] = hill[hill[cell]];
    return cell;
  };
  int peaks = 1;
  for (const std::size_t cell : order) {
    hill[cell] = cell;
    const int row = int(cell) / patch.columns, column = int(cell) % patch.columns;
    for (int r = std::max(0, row - 1); r <= std::min(patch.rows - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(patch.columns - 1, column + 1); ++c) {
        const std::size_t other = std::size_t(r) * patch.columns + c;
        if (hill[other] == value.size()) continue;
        std::size_t a = topOf(cell), b = topOf(other);
        if (a == b) continue;
        if (value[a] < value[b]) std::swap(a, b);
        if (value[b] - value[cell] > std::max(kValleyShare * (value[b] - foot), kLeastRise * height)) ++peaks;
        hill[b] = a;
      }
  }
  return peaks;
}

std::optional<MergedPeaks> mergedPeaks(const std::vector<TrainingView>& views, const std::optional<Light>& light,
                                       const Settings& settings) {
  std::vector<int> peaks, more;
  std::size_t asked = 0;
  for (const TrainingView& v : views) {
    if (!v.pixels || v.highlight.clipped || !v.surface) continue;
    ++asked;
    const int seen = peaksInside(*v.pixels, v.highlight.contour);
    if (seen < 2) continue;
    int made = 1;
    if (light)
      if (const auto points = brightestPointsFor(*v.surface, v.camera, *light, settings))
        made = std::max<int>(1, int(points->size()));
    if (seen <= made) continue;
    peaks.push_back(seen);
    more.push_back(seen - made);
  }
  if (more.size() < kLeastShow || double(more.size()) < kMostShow * double(asked)) return std::nullopt;
  MergedPeaks found;
  found.certain = upperMedian(more) >= kCertainPeaks;
  found.text = formatted(
      "up to %d peaks lie inside one contour in %zu of %zu training frames, and one lamp makes fewer there: several lamps whose "
      "highlights merge, or one in several parts (photograph with fewer lamps on, and state them in lights_on)",
      *std::max_element(peaks.begin(), peaks.end()), more.size(), asked);
  return found;
}

}  // namespace glint
