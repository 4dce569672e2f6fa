// SPDX-License-Identifier: BSD-3-Clause
#include "viz/scene_legend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/viz/small_inspection.h"
#include "viz/layers.h"
#include "viz/scene_questions.h"

namespace glint::viz {
namespace {

using test::smallInspection;
using test::TemporaryFolder;

/// The frame has no prediction because the fit is no ellipsoid, and the layer says that of the fit; every light has its own.
TEST(SceneLegend, AFitThatIsNoEllipsoidIsSaidOnce) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  ModelResult& dual = inspection->models.at("dual");
  const Failure failure{Reason::NotAnEllipsoid, describe(dual.fits[0].fit->as<EllipsoidFit>()->quadric)};
  for (FrameComparison& comparison : dual.frames) {
    comparison.prediction = failure;
    comparison.rows[0].failure = failure;
  }
  dual.fits.push_back(dual.fits[0]);  // another light
  LayerInput input;
  input.inspection = inspection.get();
  input.models = {"dual"};
  input.surfaceKey = inspection->surfaces->keyOf(0);
  input.scale = sceneScale(*inspection, nullptr, {0, 1, 2}, 1);
  const LayerContent ellipsoids = ellipsoidsLayer(input), nothing;
  ASSERT_EQ(ellipsoids.notes.size(), 2u);
  for (const bool drawn : {true, false}) {
    std::vector<ShownLayer> layers;
    for (const Layer& layer : sceneLayers())
      layers.push_back({layer.name == "predicted-contours" || (drawn && layer.name == "ellipsoids"),
                        layer.name == "ellipsoids" ? &ellipsoids : &nothing});
    const SceneLegend legend = legendOf(input, layers);
    ASSERT_EQ(legend.notes.size(), 1u) << drawn;
    EXPECT_NE(legend.notes[0].find("hyperboloid of two sheets"), std::string::npos) << legend.notes[0];
  }
}

/// Known lamps have no estimate in the picture, and are said to move all the same; where both are drawn it is said once.
TEST(SceneLegend, ALampThatMovesWithTheCameraIsSaidToOnce) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  inspection->lightFrame.frame = LightFrame::Camera;
  auto scene = std::make_shared<Scene>(*inspection->scene);
  for (TrueLight& light : scene->lights) light.known = true;
  inspection->scene = scene;
  LayerInput input;
  input.inspection = inspection.get();
  input.surfaceKey = inspection->surfaces->keyOf(0);
  input.scale = sceneScale(*inspection, nullptr, {0, 1, 2}, 1);
  const LayerContent lamps = trueLightLayer(input), nothing;
  ASSERT_FALSE(lamps.drawn.empty());
  EXPECT_NE(lamps.drawn[0].info.text.find("coordinates = of the camera"), std::string::npos) << lamps.drawn[0].info.text;
  for (const bool estimated : {false, true}) {
    std::vector<ShownLayer> layers;
    for (const Layer& layer : sceneLayers()) {
      const bool on = layer.name == "true-light" || (estimated && layer.name == "light");
      layers.push_back({on, on ? &lamps : &nothing});
    }
    std::vector<std::string> words;
    for (const auto& entry : legendOf(input, layers).entries) words.push_back(entry.text);
    const std::string moves = ", moves with the camera";
    EXPECT_EQ(std::count(words.begin(), words.end(), "light (estimate)" + moves), estimated);
    EXPECT_EQ(std::count(words.begin(), words.end(), "light (known)" + (estimated ? "" : moves)), 1);
  }
}

}  // namespace
}  // namespace glint::viz
