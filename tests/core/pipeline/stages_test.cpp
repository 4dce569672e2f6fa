// SPDX-License-Identifier: BSD-3-Clause
// Nothing is computed that neither the models nor a changed setting ask for, and memory does not grow with the number of frames.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "core/pipeline/inspection.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr int kFrames = 6, kTraining = 3;

InspectionRequest request(const std::vector<std::string>& models) {
  InspectionRequest q;
  q.models = models;
  q.train = "first:3";
  q.settings.set("fit.most_residual", 10.0);  // what is computed counts, not how good it is
  return q;
}

/// The counts as one line, for comparing all of them at once: detected, views, lights, canonical, fits, predictions, comparisons,
/// surfaces asked for.
std::string counts(const WorkCounts& w) {
  std::string text;
  for (const int n :
       {w.framesDetected, w.trainingViews, w.lights, w.canonicalContours, w.fits, w.predictions, w.comparisons, w.surfacesAsked})
    text += std::to_string(n) + " ";
  return text;
}

TEST(LazyStages, AModelComputesOnlyWhatItNeeds) {
  const auto scene = exactScene(sheet(0.4), kFrames);
  EXPECT_EQ(counts(inspect(scene, request({"primal"})).work), "6 3 0 0 1 6 6 0 ");
  EXPECT_EQ(counts(inspect(scene, request({"limit-angle"})).work), "6 3 1 0 1 6 6 6 ");
  EXPECT_EQ(counts(inspect(scene, request({"dual"})).work), "6 3 1 0 1 6 6 6 ");
  EXPECT_EQ(counts(inspect(scene, request({"reflectance"})).work), "6 3 1 0 1 6 6 6 ");
  EXPECT_EQ(counts(inspect(scene, request({"canonical"})).work), "6 3 1 3 1 6 6 6 ");
  EXPECT_EQ(counts(inspect(scene, request({"primal", "canonical"})).work), "6 3 1 3 2 12 12 6 ");
}

TEST(LazyStages, AChangedSettingComputesOnlyWhatFollows) {
  const auto scene = exactScene(sheet(0.4), kFrames);
  const InspectionRequest before = request({"canonical"});
  const Inspection first = inspect(scene, before);
  const auto after = [&](const char* key, const char* value, std::vector<std::string> models = {"canonical"}) {
    InspectionRequest q = request(models);
    if (*key) q.settings.setFromText(key, value);
    return counts(inspect(scene, q, {}, &first).work);
  };
  EXPECT_EQ(after("", ""), "0 0 0 0 0 0 0 0 ");
  EXPECT_EQ(after("predict.seed_step", "24"), "0 0 0 0 0 6 6 6 ");
  EXPECT_EQ(after("fit.solver", "anchored"), "0 0 0 3 1 6 6 6 ");
  EXPECT_EQ(after("light.solver", "triangulated"), "0 0 1 3 1 6 6 6 ");
  EXPECT_EQ(after("surface.normals", "facet"), "0 3 1 3 1 6 6 6 ");
  EXPECT_EQ(after("detect.min_area", "20"), "6 3 1 3 1 6 6 6 ");
  EXPECT_EQ(after("", "", {"canonical", "limit-angle"}), "0 0 0 0 1 6 6 6 ") << "a model added: the others stay";
}

/// Frames that each have their own depth map of the plane z = 0, seen from above.
class DepthFrames : public testing::Test {
 protected:
  std::shared_ptr<const Scene> scene(int frames) {
    auto scene = exactScene(sheet(0.0), frames);
    for (std::size_t i = 0; i < scene->frames.size(); ++i) {
      Frame& f = scene->frames[i];
      f.surface.clear();
      f.depth = folder_.path() / (f.id + ".tiff");
      cv::Mat depth(f.camera.height, f.camera.width, CV_32F);
      const Eigen::Vector3d eye = f.camera.centreInWorld(), axis = f.camera.camFromWorld.linear().row(2).transpose();
      for (int y = 0; y < depth.rows; ++y)
        for (int x = 0; x < depth.cols; ++x) {
          const Ray ray = f.camera.ray({double(x), double(y)});
          depth.at<float>(y, x) = static_cast<float>(-eye.z() / ray.direction.z() * ray.direction.dot(axis));
        }
      EXPECT_TRUE(cv::imwrite(f.depth.string(), depth, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
    }
    return scene;
  }
  TemporaryFolder folder_;
};

TEST_F(DepthFrames, TheCacheHoldsAFewWhateverTheirNumber) {
  const auto frames = scene(kFrames);
  const Inspection result = inspect(frames, request({"limit-angle"}));
  const SurfaceCache::Statistics s = result.surfaces->statistics();
  EXPECT_LE(s.mostDepthMaps, SurfaceCache::kDepthMapsKept);
  // Those of training, some of them before to see whether the lamp moves with the camera, then one per frame: a depth map that
  // was dropped is built again, none is built for nothing.
  EXPECT_GE(s.loads, kFrames);
  EXPECT_LE(s.loads, 2 * kTraining + kFrames);
  ASSERT_TRUE(result.models.at("limit-angle").fits[0].fit);
  for (const FrameComparison& c : result.models.at("limit-angle").frames) EXPECT_FALSE(c.prediction.failure()) << c.frame;
}

TEST_F(DepthFrames, AModelWithoutASurfaceLoadsNoneForItsPredictions) {
  const auto frames = scene(kFrames);
  InspectionRequest stated = request({"primal"});
  stated.settings.set("light.frame", std::string("world"));  // auto would look at some of them before
  EXPECT_EQ(inspect(frames, stated).surfaces->statistics().loads, kTraining);
}

TEST(Streaming, AsManyImagesInMemoryAsThreads) {
  const auto scene = exactScene(sheet(0.4), kFrames);
  const int threads = std::clamp<int>(static_cast<int>(std::thread::hardware_concurrency()), 1, 8);
  const WorkCounts work = inspect(scene, request({"primal"})).work;
  EXPECT_GE(work.framesHeldAtOnce, 1);
  EXPECT_LE(work.framesHeldAtOnce, threads);
}

}  // namespace
}  // namespace glint
