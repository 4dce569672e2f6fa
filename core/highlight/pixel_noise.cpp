// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/pixel_noise.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"

namespace glint {

double pixelNoise(const Image& image, const std::vector<char>& usable) {
  const int w = image.width, h = image.height;
  std::vector<float> response;
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(w) * h / 50000)));
  for (int y = 1; y + 1 < h; y += stride)
    for (int x = 1; x + 1 < w; x += stride) {
      if (!usable[static_cast<std::size_t>(y) * w + x]) continue;
      const auto v = [&](int dx, int dy) { return image.at(x + dx, y + dy); };
      response.push_back(
          std::abs(v(-1, -1) + v(1, -1) + v(-1, 1) + v(1, 1) - 2 * (v(0, -1) + v(0, 1) + v(-1, 0) + v(1, 0)) + 4 * v(0, 0)));
    }
  if (response.empty()) return 0;
  return 1.4826 * upperMedian(std::move(response)) / 6.0;  // the mask's own norm is 6
}

}  // namespace glint
