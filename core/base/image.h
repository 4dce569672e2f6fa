// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace glint {

/// Row-major float image, interleaved channels. Pixel (0, 0) is the centre of the top-left pixel.
struct Image {
  int width = 0, height = 0, channels = 1;
  std::vector<float> data;

  Image() = default;
  Image(int w, int h, int c, float value = 0.f)
      : width(w), height(h), channels(c), data(static_cast<std::size_t>(w) * h * c, value) {}
  bool empty() const { return data.empty(); }
  float& at(int x, int y, int c = 0) { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
  float at(int x, int y, int c = 0) const { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
};

/// IEC 61966-2-1, codes and linear light in [0, 1].
inline double linearFromSrgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
inline double srgbFromLinear(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

}  // namespace glint
