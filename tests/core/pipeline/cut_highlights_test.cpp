// SPDX-License-Identifier: BSD-3-Clause
// Photographs whose border cuts every highlight. Truth is the exact contour of the whole highlight; what counts is the part that
// the photograph shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "core/pipeline/inspection.h"
#include "tests/core/pipeline/painted_scene.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

using testing::HasSubstr;
using namespace testing_support;

struct CutScene {
  std::shared_ptr<Scene> scene;
  std::vector<Polyline> truth;  ///< whole, in the pixels of each cropped photograph
};

/// A sphere under a lamp, seen from an arc; each photograph ends where `shown` of the highlight's height is seen.
template <class Shown>
CutScene cutScene(const TemporaryFolder& folder, const Shown& shown, double metres = 1, double noise = 0) {
  Painted p;
  p.surface = sphere(0.5 * metres);
  for (Camera& camera : p.cameras = arc(10, 120)) camera.camFromWorld.translation() *= metres;
  p.lamp.id = "lamp";
  p.lamp.lamp = lampAt(metres * Eigen::Vector3d(0.3, 0.4, 2.0));
  p.noise = noise;
  p.gloss = 0.8;
  CutScene cut{std::make_shared<Scene>(), {}};
  cut.scene->surfaces["body"] = p.surface;
  Material material;
  material.roughness = p.roughness;
  for (std::size_t f = 0; f < p.cameras.size(); ++f) {
    Polyline contour = exactHighlights(*makeAnalytic(p.surface), p.cameras[f], p.lamp, material, {})->front().contour;
    Eigen::AlignedBox2d box;
    for (const Pixel& at : contour.points) box.extend(at);
    const int rows = int(std::lround(box.min().y() + shown(int(f)) * box.sizes().y()));
    Image whole = picture(p, f), part(whole.width, rows, 1);
    std::copy_n(whole.data.begin(), part.data.size(), part.data.begin());
    Frame frame;
    frame.id = std::to_string(f);
    frame.camera = p.cameras[f];
    frame.camera.height = rows;
    frame.surface = "body";
    frame.lightsOn = {"lamp"};
    frame.radiance = folder / (frame.id + ".tiff");
    cv::imwrite(frame.radiance.string(), cv::Mat(part.height, part.width, CV_32F, part.data.data()),
                {cv::IMWRITE_TIFF_COMPRESSION, 1});
    cut.scene->frames.push_back(std::move(frame));
    cut.truth.push_back(std::move(contour));
  }
  return cut;
}

/// Near the middle: the peak is now inside and now beyond.
double nearTheMiddle(int frame) { return 0.5 + 0.15 * std::sin(2.4 * frame); }

Inspection inspected(const CutScene& cut, const std::vector<std::string>& models) {
  InspectionRequest request;
  request.models = models;
  request.train = "spread:6";
  return inspect(cut.scene, request);
}

/// Mean distance of the truth that held-out photographs show from the predicted contours, percent of the diameter of what they
/// show.
double heldOutPct(const CutScene& cut, const Inspection& r, const std::string& model) {
  double sum = 0;
  int frames = 0;
  for (const FrameComparison& c : r.models.at(model).frames) {
    if (!r.isHeldOut(c.frame)) continue;
    EXPECT_EQ(c.prediction.highlights().size(), 1u) << c.frame;
    if (c.prediction.highlights().size() != 1) return std::nan("");
    const Polyline& truth = cut.truth[std::size_t(c.frame)];
    const double last = cut.scene->frames[std::size_t(c.frame)].camera.height - 1.0;
    double distances = 0, points = 0;
    for (const Pixel& at : resample(truth, 500))
      if (at.y() <= last) distances += distance(c.prediction.highlights()[0].contour, at), points += 1;
    const Polyline seen = clippedTo({Pixel(-1e4, -1e4), Pixel(1e4, last)}, truth);
    sum += 100 * distances / points / (2 * std::sqrt(std::abs(signedArea(seen)) / M_PI));
    ++frames;
  }
  EXPECT_GE(frames, 4);
  return sum / frames;
}

/// What the pipeline says of the same.
double scoredPct(const Inspection& r, const std::string& model) {
  double sum = 0, count = 0;
  for (const FrameComparison& c : r.models.at(model).frames)
    for (const FrameComparison::Row& row : c.rows)
      if (r.isHeldOut(c.frame)) {
        EXPECT_TRUE(row.metrics) << c.frame;
        if (row.metrics) sum += row.metrics->contourErrorPct, count += 1;
      }
  return sum / count;
}

TEST(CutHighlights, PixelsThatAreSeenTellLampAndLobe) {
  const TemporaryFolder folder;
  const CutScene cut = cutScene(folder, nearTheMiddle);
  const Inspection r = inspected(cut, {"limit-angle", "reflectance", "dual"});
  for (const FrameEvidence& e : r.evidence) {
    ASSERT_EQ(e.highlights.size(), 1u);
    EXPECT_TRUE(e.highlights[0].touchesBorder);
    EXPECT_FALSE(e.highlights[0].peakCut) << "the lobe tells where it lies";
  }
  EXPECT_LT(heldOutPct(cut, r, "reflectance"), 0.05);
  EXPECT_LT(heldOutPct(cut, r, "limit-angle"), 0.3);
  EXPECT_LT(scoredPct(r, "reflectance"), 0.15) << "against contours that were found in the pixels";
  const ModelResult::Fit& dual = r.models.at("dual").fits.at(0);
  ASSERT_FALSE(dual.fit);
  EXPECT_THAT(dual.fit.failure().message(), HasSubstr("the image border cuts the highlight"));
}

TEST(CutHighlights, AtAThousandTimesTheSizeTheSame) {
  const TemporaryFolder here, there;
  const CutScene small = cutScene(here, nearTheMiddle), large = cutScene(there, nearTheMiddle, 1000);
  const double a = heldOutPct(small, inspected(small, {"reflectance"}), "reflectance");
  const double b = heldOutPct(large, inspected(large, {"reflectance"}), "reflectance");
  EXPECT_NEAR(a, b, 2e-3);
}

TEST(CutHighlights, NoiseMovesContoursByLittle) {
  const TemporaryFolder folder;
  const CutScene cut = cutScene(folder, nearTheMiddle, 1, 0.004);  // half a percent of the peak
  EXPECT_LT(heldOutPct(cut, inspected(cut, {"reflectance"}), "reflectance"), 0.3);
}

TEST(CutHighlights, WholeOnesServeAloneWhereThreeOfThemTrain) {
  const TemporaryFolder folder;
  const CutScene cut = cutScene(folder, [](int frame) { return frame % 2 ? 0.5 : 3.0; });
  const Inspection r = inspected(cut, {"limit-angle"});
  for (const TrainingView& v : r.views) EXPECT_EQ(bool(v.seen), !v.highlight.touchesBorder) << v.frame;
  EXPECT_LT(heldOutPct(cut, r, "limit-angle"), 0.3);
}

TEST(CutHighlights, TruthMayReferToThePlaceThatItsFileNames) {
  // Whoever made this truth saw one row more than the photograph shows, and took half of the brightest place there.
  const TemporaryFolder folder, truthFolder;
  const CutScene cut = cutScene(folder, [](int) { return 0.22; });
  const std::shared_ptr<const Surface> surface = makeAnalytic(*cut.scene->surfaces["body"].analytic());
  TrueLight lamp;
  lamp.id = "lamp";
  lamp.lamp = lampAt(Eigen::Vector3d(0.3, 0.4, 2.0));
  Material material;
  CutScene there = cut;
  for (std::size_t f = 0; f < cut.truth.size(); ++f) {
    Camera camera = cut.scene->frames[f].camera;
    const int row = camera.height;
    camera.height = 240;
    const Image whole = renderRadiance(*surface, camera, {lamp}, material).specular;
    int column = 0;
    for (int x = 1; x < whole.width; ++x)
      if (whole.at(x, row) > whole.at(column, row)) column = x;
    ExactOptions options;
    options.level = 0.5 * whole.at(column, row) / *std::max_element(whole.data.begin(), whole.data.end());
    there.truth[f] = exactHighlights(*surface, camera, lamp, material, options)->front().contour;
    std::ofstream file(truthFolder / (cut.scene->frames[f].id + ".json"));
    file << R"({"peak_subpixel": [)" << column << "," << row << R"(], "levels": {"0.50": [{"edge_fraction": 0.1, "points": [)";
    for (std::size_t i = 0; i < there.truth[f].points.size(); ++i)
      file << (i ? "," : "") << "[" << there.truth[f].points[i].x() << "," << there.truth[f].points[i].y() << "]";
    file << "]}]}}";
  }
  InspectionRequest request;
  request.models = {"reflectance"};
  request.train = "spread:6";
  request.truthFolder = truthFolder.path().string();
  const Inspection r = inspect(there.scene, request);
  EXPECT_LT(scoredPct(r, "reflectance"), 0.3);
  EXPECT_LT(heldOutPct(there, r, "reflectance"), 0.3);
  EXPECT_GT(heldOutPct(cut, r, "reflectance"), 1) << "half of the peak is elsewhere";
}

TEST(CutHighlights, ASliverIsRefusedByName) {
  const TemporaryFolder folder;
  const CutScene cut = cutScene(folder, [](int) { return -0.25; });  // the tail alone: no photograph shows the contour
  const Inspection r = inspected(cut, {"limit-angle", "dual"});
  for (const auto& [name, result] : r.models) {
    ASSERT_EQ(result.fits.size(), 1u) << name;
    ASSERT_FALSE(result.fits[0].fit) << name;
    EXPECT_THAT(result.fits[0].fit.failure().message(), HasSubstr("the image border cuts")) << name;
  }
}

}  // namespace
}  // namespace glint
