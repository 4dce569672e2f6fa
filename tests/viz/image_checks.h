// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <utility>

#include "core/base/image.h"
#include "tests/viz/test_display.h"
#include "viz/offscreen.h"
#include "viz/style.h"

namespace glint::test {

/// Pixels whose colour differs visibly; a few stray ones are what another driver may do to an edge.
inline int countDifferent(const Image& a, const Image& b) {
  int count = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      double most = 0;
      for (int c = 0; c < 3; ++c) most = std::max<double>(most, std::abs(a.at(x, y, c) - b.at(x, y, c)));
      count += most > 0.06;
    }
  }
  return count;
}

inline bool isNear(const Image& image, int x, int y, const draw::Colour& colour, double tolerance) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(image.at(x, y, c) - colour[static_cast<std::size_t>(c)]) > tolerance) return false;
  }
  return true;
}

inline int countNear(const Image& image, const draw::Colour& colour, double tolerance = 0.06) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += isNear(image, x, y, colour, tolerance);
  }
  return count;
}

/// Renders views off screen at one size.
class PictureTest : public testing::Test {
 protected:
  static constexpr int kWidth = 640, kHeight = 480;
  void SetUp() override {
    if (std::system("command -v Xvfb > /dev/null 2>&1") != 0) GTEST_SKIP() << "Xvfb is not installed";
    display_ = std::make_unique<TestDisplay>();
    ASSERT_TRUE(*display_) << display_->failure().message();
    resize(kWidth, kHeight);
  }
  void resize(int width, int height) {
    target_.reset();
    Outcome<std::unique_ptr<viz::Offscreen>> target = viz::Offscreen::onOwnDisplay(width, height);
    ASSERT_TRUE(target) << target.failure().message();
    target_ = std::move(*target);
  }
  Image render(const viz::SceneView& view) { return target_->render(view); }
  std::unique_ptr<TestDisplay> display_;  // declared first: it outlives the window
  std::unique_ptr<viz::Offscreen> target_;
};

}  // namespace glint::test
