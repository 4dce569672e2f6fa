// SPDX-License-Identifier: BSD-3-Clause
// What of several things lies on top, and what is up, whatever else is shown.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

#include "tests/viz/small_inspection.h"
#include "viz/layers.h"
#include "viz/scene_questions.h"

namespace glint::viz {
namespace {

using test::heldOutInput;
using test::smallInspection;
using test::TemporaryFolder;

/// A step about one frame shows that frame alone, and its camera alone may look down so steeply that the image's upwards is
/// nearly level: what is up must not follow from how many cameras are shown.
TEST(Framing, WhatIsUpDoesNotDependOnHowManyCamerasAreShown) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  const std::optional<Framing> all = highlightFraming(input, 0, HighlightLook::Section, {});
  input.frames = {input.selection.frame};
  input.solo = true;
  const std::optional<Framing> alone = highlightFraming(input, 0, HighlightLook::Section, {});
  ASSERT_TRUE(all && alone);
  EXPECT_LT((all->up - alone->up).norm(), 1e-12);
}

/// "dual" refuses in this scene, so that what "canonical" draws with and without being selected is compared.
TEST(Layers, TheSelectedModelLiesOnTopOfTheOthers) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  const auto nearer = [&](const std::string& selected) {
    input.selection.model = selected;
    double px = 0;
    for (const Drawn& d : predictedContoursLayer(input).drawn)
      if (d.info.model == "canonical") px = std::max(px, d.nearerPx);
    return px;
  };
  const double on = nearer("canonical"), off = nearer("dual");
  EXPECT_GT(off, 0);
  EXPECT_GT(on, off);
}

}  // namespace
}  // namespace glint::viz
