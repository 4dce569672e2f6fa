// SPDX-License-Identifier: BSD-3-Clause
// What is hidden is gone with all that belongs to it, and nothing else is.
#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>

#include <map>

#include "core/surface/mesh_policy.h"
#include "tests/viz/small_inspection.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

using test::smallInspection;
using test::TemporaryFolder;

class HiddenObjectsTest : public ::testing::Test {
 protected:
  void SetUp() override { inspection_ = smallInspection(folder_.path()); }

  LayerInput input(int selected, const HiddenObjects& hidden) {
    LayerInput in;
    in.inspection = inspection_.get();
    in.selection.frame = selected;
    in.models = {"dual", "canonical"};
    in.surfaceKey = inspection_->surfaces->keyOf(selected);
    in.surface = *inspection_->surfaces->surfaceOf(selected, meshPolicy(inspection_->request.settings));
    in.frames = framesToDraw(*inspection_, in.surfaceKey, selected, hidden.frames);
    in.scale = sceneScale(*inspection_, in.surface.get(), framesToDraw(*inspection_, in.surfaceKey, selected), 1);
    in.cache = &cache_;
    in.hidden = hidden;
    return in;
  }
  /// What the actors of all layers say they are.
  std::vector<Picked> drawn(const LayerInput& in) {
    std::vector<Picked> result;
    for (const LayerRecipe& recipe : layerRecipes()) {
      const LayerContent content = recipe.build(in);
      for (const Drawn& d : content.drawn) {
        if (!d.describe) {
          result.push_back(d.info);
          continue;
        }
        auto* actor = vtkActor::SafeDownCast(d.prop);
        const vtkIdType cells = vtkPolyDataMapper::SafeDownCast(actor->GetMapper())->GetInput()->GetNumberOfCells();
        for (vtkIdType i = 0; i < cells; ++i) result.push_back(d.describe(i));
      }
    }
    return result;
  }
  /// How many actors (or cells) each layer has of each frame.
  static std::map<std::pair<std::string, int>, int> countByFrame(const std::vector<Picked>& drawn) {
    std::map<std::pair<std::string, int>, int> counts;
    for (const Picked& p : drawn) ++counts[{p.layer, p.frame}];
    return counts;
  }

  TemporaryFolder folder_;
  std::shared_ptr<Inspection> inspection_;
  LayerCache cache_;
};

TEST_F(HiddenObjectsTest, ACameraGoesWithAllThatBelongsToItsFrame) {
  for (const int frame : {0, 2}) {  // selected and not
    SCOPED_TRACE(frame);
    auto expected = countByFrame(drawn(input(0, {})));
    HiddenObjects hidden;
    hidden.frames = {frame};
    const auto counts = countByFrame(drawn(input(0, hidden)));
    int layers = 0;
    for (auto it = expected.begin(); it != expected.end();) {
      const bool gone = it->first.second == frame;
      layers += gone ? 1 : 0;
      it = gone ? expected.erase(it) : std::next(it);
    }
    EXPECT_GE(layers, 5);  // camera, photograph, virtual camera, peak, contour at least
    EXPECT_EQ(counts, expected);
  }
}

TEST_F(HiddenObjectsTest, ALabelGoesWithItsCamera) {
  const LayerRecipe& cameras = layerRecipes()[1];
  ASSERT_EQ(cameras.layer.name, "cameras");
  EXPECT_EQ(cameras.build(input(3, {})).labels.size(), 1u);
  HiddenObjects hidden;
  hidden.frames = {3};
  EXPECT_TRUE(cameras.build(input(3, hidden)).labels.empty());
}

TEST_F(HiddenObjectsTest, AFitGoesWithConesAndPredictions) {
  const auto of = [](const std::vector<Picked>& drawn, const std::string& model) {
    return std::count_if(drawn.begin(), drawn.end(), [&](const Picked& p) { return p.model == model; });
  };
  ASSERT_GT(of(drawn(input(4, {})), "canonical"), 0);
  const std::string light = inspection_->models.at("canonical").fits.front().light;
  HiddenObjects hidden;
  hidden.ellipsoids = {{"canonical", light}};
  EXPECT_EQ(of(drawn(input(4, hidden)), "canonical"), 0);
  hidden.ellipsoids = {{"dual", light}};
  EXPECT_GT(of(drawn(input(4, hidden)), "canonical"), 0);
  hidden.ellipsoids = {{"canonical", "another " + light}};
  EXPECT_GT(of(drawn(input(4, hidden)), "canonical"), 0);
}

TEST_F(HiddenObjectsTest, ALightGoesAsEstimateAndTruth) {
  const auto lights = [](const std::vector<Picked>& drawn) {
    return std::count_if(drawn.begin(), drawn.end(),
                         // What a model takes the light for belongs to the model.
                         [](const Picked& p) { return (p.layer == "light" && p.model.empty()) || p.layer == "true-light"; });
  };
  TrueLight truth;
  truth.id = inspection_->lights.begin()->first.light;
  truth.lamp = lampAt(Eigen::Vector3d(0.5, 0, 1));
  auto scene = std::make_shared<Scene>(*inspection_->scene);
  scene->lights = {truth};
  inspection_->scene = scene;
  ASSERT_GE(lights(drawn(input(0, {}))), 2);
  HiddenObjects hidden;
  hidden.lights = {truth.id};
  EXPECT_EQ(lights(drawn(input(0, hidden))), 0);
}

TEST_F(HiddenObjectsTest, ASurfaceGoesAloneAndDepthMapsGoTogether) {
  const auto all = drawn(input(0, {}));
  HiddenObjects hidden;
  hidden.surfaces = {inspection_->surfaces->keyOf(0)};
  EXPECT_EQ(drawn(input(0, hidden)).size(), all.size() - 1);
  EXPECT_FALSE(hidden.hidesSurface("depth:0004"));
  hidden.surfaces = {HiddenObjects::kDepthMaps};
  EXPECT_TRUE(hidden.hidesSurface("depth:0004") && hidden.hidesSurface("depth:0005"));
  EXPECT_FALSE(hidden.hidesSurface("body"));
  // As SurfaceCache names a frame's own depth map.
  auto scene = std::make_shared<Scene>(*inspection_->scene);
  scene->frames[0].surface.clear();
  EXPECT_TRUE(hidden.hidesSurface(SurfaceCache(*scene).keyOf(0)));
}

/// Equal poses are one camera on screen: with one frame hidden, another stands for the pose.
TEST_F(HiddenObjectsTest, AnotherFrameOfThePoseIsDrawnInstead) {
  auto scene = std::make_shared<Scene>(*inspection_->scene);
  for (int i = 0; i < 6; ++i) scene->frames.push_back(scene->frames[static_cast<std::size_t>(i)]);
  inspection_->scene = scene;
  inspection_->surfaces = std::make_shared<SurfaceCache>(*scene);
  const std::vector<int> frames = framesToDraw(*inspection_, inspection_->surfaces->keyOf(0), 8, {8});
  EXPECT_EQ(frames.size(), 6u);
  EXPECT_NE(std::find(frames.begin(), frames.end(), 2), frames.end());
  EXPECT_EQ(framesToDraw(*inspection_, inspection_->surfaces->keyOf(0), 8, {2, 8}).size(), 5u);
}

}  // namespace
}  // namespace glint::viz
