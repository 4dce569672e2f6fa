// SPDX-License-Identifier: BSD-3-Clause
// Labels: which part of a contour is an edge of the surface, what the image cuts off, and what each format says of it.
#include "core/report/labels.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>

#include "core/pipeline/given_labels.h"
#include "core/report/label_shapes.h"
#include "core/report/masks.h"
#include "core/surface/analytic.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

namespace glint::labels_tests {
namespace {

using Json = nlohmann::json;
using testing_support::contentOf;
using testing_support::TemporaryFolder;

/// Straight down from height h: a pixel is `unit` wide on the plane z = 0, and (0, 0, 0) is at (160, 120).
Camera above(double unit) {
  Camera c;
  c.width = 321;
  c.height = 241;
  const double height = 100 * unit;
  c.pixelFromRay << 100, 0, 160, 0, 100, 120, 0, 0, 1;
  c.camFromWorld.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  c.camFromWorld.translation() = Eigen::Vector3d(0, 0, height);
  return c;
}

/// A flat sheet of 40 x 400 pixels about the middle.
std::shared_ptr<const Surface> strip(double unit) {
  AnalyticSpec spec = testing_support::sheet(0);
  spec.length = 40 * unit;
  spec.width = 400 * unit;
  return makeAnalytic(spec);
}

/// The part left of x = 180, where the strip ends, of a disc about (cx, 120).
Polyline cutDisc(double cx, double radius, double jitter = 0) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> gauss(0, jitter > 0 ? jitter : 1);
  const double angle = std::acos((180 - cx) / radius);
  Polyline line{{}, true};
  for (int i = 0; i <= 400; ++i) {
    const double a = angle + (2 * M_PI - 2 * angle) * i / 400;
    line.points.push_back(Pixel(cx, 120) + (radius + (jitter > 0 ? gauss(rng) : 0)) * Pixel(std::cos(a), std::sin(a)));
  }
  const Pixel from = line.points.back(), to = line.points.front();
  for (int i = 1; i < 60; ++i) line.points.push_back(from + (to - from) * i / 60.0);
  return line;
}
/// Beside the chord's ends the arc's outer side has left the surface, too: some 0.8 px of 54 px at each.
constexpr double kAtTheEnds = 0.04;
/// Chord over chord and arc.
double cutShare(double cx, double radius) {
  const double angle = std::acos((180 - cx) / radius), chord = 2 * std::sin(angle), arc = 2 * M_PI - 2 * angle;
  return chord / (chord + arc);
}

TEST(EdgeShareOf, IsThatOfTheChordWhereTheSurfaceEnds) {
  EXPECT_NEAR(edgeShareOf(cutDisc(172, 10), above(0.01), *strip(0.01)), cutShare(172, 10), kAtTheEnds);
  EXPECT_NEAR(edgeShareOf(cutDisc(178, 10), above(0.01), *strip(0.01)), cutShare(178, 10), kAtTheEnds);
  Polyline back = cutDisc(172, 10);
  std::reverse(back.points.begin(), back.points.end());  // whichever way round it is drawn
  EXPECT_NEAR(edgeShareOf(back, above(0.01), *strip(0.01)), cutShare(172, 10), kAtTheEnds);
}

TEST(EdgeShareOf, InMetresAndMicrometres) {
  for (const double unit : {1e-6, 1.0, 1e3})
    EXPECT_NEAR(edgeShareOf(cutDisc(172, 10), above(unit), *strip(unit)), cutShare(172, 10), kAtTheEnds) << unit;
}

TEST(EdgeShareOf, NoiseOnTheContourMakesNoEdge) {
  EXPECT_NEAR(edgeShareOf(cutDisc(172, 10, 0.02), above(0.01), *strip(0.01)), cutShare(172, 10), 0.1);
}

TEST(EdgeShareOf, NothingOnTheWholeEverythingBesideTheSurface) {
  Polyline whole{{}, true};
  for (int i = 0; i < 90; ++i)
    whole.points.push_back(Pixel(160, 120) + 10 * Pixel(std::cos(i * M_PI / 45), std::sin(i * M_PI / 45)));
  EXPECT_EQ(edgeShareOf(whole, above(0.01), *strip(0.01)), 0);
  for (Pixel& p : whole.points) p.x() += 80;
  EXPECT_EQ(edgeShareOf(whole, above(0.01), *strip(0.01)), 1);
  EXPECT_EQ(edgeShareOf({}, above(0.01), *strip(0.01)), 0);
  EXPECT_EQ(edgeShareOf({{{5, 5}, {5, 5}}, true}, above(0.01), *strip(0.01)), 0);
}

/// A curved surface is no edge, even if it is steep: a sphere's silhouette is one, what lies 5 % of its radius inside is not.
TEST(EdgeShareOf, TheSilhouetteOfASphereIsAnEdgeAndItsSlopeIsNone) {
  AnalyticSpec spec = testing_support::sphere(0.5);
  spec.worldFromSurface.translation().setZero();
  const auto sphere = makeAnalytic(spec);
  const double distance = 1.0, silhouette = 100 * 0.5 / std::sqrt(distance * distance - 0.25);  // px: f r / sqrt(d^2 - r^2)
  const auto circle = [](double radius) {
    Polyline line{{}, true};
    for (int i = 0; i < 360; ++i)
      line.points.push_back(Pixel(160, 120) + radius * Pixel(std::cos(i * M_PI / 180), std::sin(i * M_PI / 180)));
    return line;
  };
  EXPECT_EQ(edgeShareOf(circle(silhouette), above(0.01), *sphere), 1);
  EXPECT_EQ(edgeShareOf(circle(0.95 * silhouette), above(0.01), *sphere), 0);
}

/// Five frames; the first one's image is cut so that it shows the left part of its highlight alone, the last one's shows none of
/// it.
struct Cut {
  Inspection inspection;
  double cutAt = 0;
};
const Cut& cut() {
  static const Cut made = [] {
    InspectionRequest request;
    request.models = {"limit-angle"};
    request.train = "1-4";
    const auto scene = testing_support::exactScene(testing_support::sphere(1.0), 6);
    Cut c;
    c.cutAt = std::round(scene->frames[0].highlights.front().peak.x());
    scene->frames[0].camera.width = static_cast<int>(c.cutAt) + 1;  // pixel centres up to the peak's
    double left = 1e9;
    for (const Pixel& p : scene->frames[5].highlights.front().contour.points) left = std::min(left, p.x());
    scene->frames[5].camera.width = static_cast<int>(left) - 2;  // just beyond the image, where predictions look, too
    for (const int f : {0, 5}) scene->frames[static_cast<std::size_t>(f)].highlights.clear();
    scene->frames[3].id = "a/b: c";
    c.inspection = inspect(scene, request);
    return c;
  }();
  return made;
}

std::vector<int> six() { return {0, 1, 2, 3, 4, 5}; }

double shoelace(const std::vector<double>& xy) {
  double twice = 0;
  for (std::size_t i = 0; i < xy.size(); i += 2) {
    const std::size_t k = (i + 2) % xy.size();
    twice += xy[i] * xy[k + 1] - xy[k] * xy[i + 1];
  }
  return std::abs(twice) / 2;
}

TEST(CocoJson, PolygonsEndWithTheImageAndSayWhatIsMissing) {
  const Json coco = Json::parse(cocoJson(cut().inspection, "limit-angle", six()));
  ASSERT_EQ(coco["images"].size(), 6u);
  ASSERT_EQ(coco["annotations"].size(), 5u);
  EXPECT_EQ(coco["categories"], Json::parse(R"([{"id": 1, "name": "highlight lamp", "supercategory": "specular highlight"}])"));
  EXPECT_THAT(coco["images"][5]["reason"].get<std::string>(), testing::HasSubstr("outside image"));
  EXPECT_FALSE(coco["images"][0].contains("reason"));
  for (const Json& a : coco["annotations"]) {
    const auto xy = a["segmentation"][0].get<std::vector<double>>();
    const Json& image = coco["images"][a["image_id"].get<std::size_t>()];
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    for (std::size_t i = 0; i < xy.size(); ++i) {
      EXPECT_GE(xy[i], 0);
      EXPECT_LE(xy[i], image[i % 2 ? "height" : "width"].get<double>());
      low[i % 2] = std::min(low[i % 2], xy[i]);
      high[i % 2] = std::max(high[i % 2], xy[i]);
    }
    EXPECT_NEAR(a["area"].get<double>(), shoelace(xy), 1e-6);
    const auto box = a["bbox"].get<std::vector<double>>();
    for (int k : {0, 1}) {
      EXPECT_NEAR(box[std::size_t(k)], low[k], 1e-9);
      EXPECT_NEAR(box[std::size_t(k + 2)], high[k] - low[k], 1e-9);
    }
    EXPECT_EQ(a["attributes"]["truncated"], a["image_id"] == 0) << a["image_id"];
    EXPECT_EQ(a["attributes"]["occluded"], false);
    EXPECT_EQ(a["attributes"]["level"], 0.5);
  }
  // The cut one ends exactly at the image's edge, in COCO's pixels its width.
  const auto box = coco["annotations"][0]["bbox"].get<std::vector<double>>();
  EXPECT_NEAR(box[0] + box[2], cut().cutAt + 1, 1e-9);
}

/// The polygons as OpenCV fills them, and the masks: the same pixels but for those whose centre lies on the line.
TEST(CocoJson, PolygonsHoldThePixelsOfTheMasks) {
  const Json coco = Json::parse(cocoJson(cut().inspection, "limit-angle", six()));
  for (const Json& a : coco["annotations"]) {
    const auto f = a["image_id"].get<std::size_t>();
    const Camera& camera = cut().inspection.scene->frames[f].camera;
    std::vector<Polyline> contours;
    for (const FrameComparison& c : cut().inspection.models.at("limit-angle").frames)
      if (c.frame == static_cast<int>(f))
        for (const PredictedHighlight& h : c.prediction.highlights()) contours.push_back(h.contour);
    const Image mask = maskOf(contours, camera);
    std::vector<cv::Point2f> corners;
    const auto xy = a["segmentation"][0].get<std::vector<double>>();
    for (std::size_t i = 0; i < xy.size(); i += 2)
      corners.emplace_back(static_cast<float>(xy[i] - 0.5), static_cast<float>(xy[i + 1] - 0.5));
    int inside = 0, differ = 0;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double d = cv::pointPolygonTest(corners, cv::Point2f(float(x), float(y)), true);
        inside += d > 0;
        differ += std::abs(d) > 1e-2 && (d > 0) != (mask.at(x, y) > 0);
      }
    EXPECT_EQ(differ, 0) << f;
    EXPECT_GT(inside, 100) << f;
  }
}

TEST(WriteYolo, SaysTheSamePolygonsFromEdgeToEdge) {
  const TemporaryFolder folder;
  writeYolo(cut().inspection, "limit-angle", six(), folder.path());
  const Json coco = Json::parse(cocoJson(cut().inspection, "limit-angle", six()));
  const Json notes = Json::parse(contentOf(folder / "notes.json"));
  EXPECT_EQ(contentOf(folder / "classes.txt"), "highlight lamp\n");
  ASSERT_EQ(notes["files"].size(), 6u);
  std::size_t annotation = 0;
  for (std::size_t f = 0; f < 6; ++f) {
    const Json& note = notes["files"][f];
    const std::string text = contentOf(folder / note["file"].get<std::string>());
    EXPECT_EQ(text.empty(), f == 5);
    EXPECT_EQ(note["reason"].get<std::string>().empty(), f != 5);
    if (text.empty()) continue;
    std::istringstream words(text);
    int lamp = -1;
    words >> lamp;
    EXPECT_EQ(lamp, 0);
    const Json& a = coco["annotations"][annotation++];
    for (std::size_t i = 0; i < a["segmentation"][0].size(); ++i) {
      double v = -1;
      ASSERT_TRUE(words >> v);
      EXPECT_NEAR(v * note[i % 2 ? "height" : "width"].get<double>(), a["segmentation"][0][i].get<double>(), 1e-6);
    }
    std::string more;
    EXPECT_FALSE(words >> more);
    EXPECT_EQ(note["highlights"][0]["truncated"], f == 0);
  }
  EXPECT_EQ(notes["files"][3]["id"], "a/b: c");
  EXPECT_EQ(notes["files"][3]["file"], "labels/a%2Fb: c.txt");
}

TEST(YoloNames, AreThoseOfThePhotographsUnlessTwoAreTheSame) {
  Scene scene;
  for (const char* id : {"left/1", "right/1"}) {
    scene.frames.emplace_back();
    scene.frames.back().id = id;
    scene.frames.back().image = std::string("/pictures/") + id + ".png";
  }
  EXPECT_EQ(yoloNames(scene, {0}), (std::vector<std::string>{"1"}));
  EXPECT_EQ(yoloNames(scene, {0, 1}), (std::vector<std::string>{"left%2F1", "right%2F1"}));
}

TEST(LabelFormatsFrom, NamesWhatItDoesNotKnow) {
  const LabelFormats two = labelFormatsFrom("yolo,coco");
  EXPECT_TRUE(two.yolo && two.coco && !two.masks);
  for (const char* wrong : {"", ",", "coco,png"})
    EXPECT_THAT(testing_support::inputErrorOf([&] { labelFormatsFrom(wrong); }), testing::HasSubstr("--labels")) << wrong;
}

/// Written, and read back as the highlights of a scene: the same contours, through the lens and back.
TEST(WithLabels, GivesBackTheContoursThatWereWritten) {
  Inspection inspection = cut().inspection;
  Scene scene = *inspection.scene;
  for (const int f : {1, 2, 3, 4}) scene.frames[std::size_t(f)].camera.lens.parameters = {0.05, -0.02, 1e-3, -1e-3, 0};
  inspection.scene = std::make_shared<const Scene>(scene);
  const std::string coco = cocoJson(inspection, "limit-angle", {1, 2, 3, 4});
  const LabelledScene read = withLabels(scene, coco, "labels.json", {});
  EXPECT_EQ(read.frames, 4);
  EXPECT_EQ(read.highlights, 4);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
  int compared = 0;
  for (const FrameComparison& c : inspection.models.at("limit-angle").frames) {
    if (c.frame < 1 || c.frame > 4) continue;
    const std::vector<Highlight>& highlights = read.scene.frames[std::size_t(c.frame)].highlights;
    ASSERT_EQ(highlights.size(), 1u);
    EXPECT_EQ(highlights[0].light, "lamp");
    // The peak of the scene's own highlight, which lies inside.
    EXPECT_EQ(highlights[0].peak, scene.frames[std::size_t(c.frame)].highlights[0].peak);
    for (const Pixel& p : c.prediction.highlights()[0].contour.points) {
      double nearest = 1e9;
      for (const Pixel& q : highlights[0].contour.points) nearest = std::min(nearest, (p - q).norm());
      EXPECT_LT(nearest, 1e-7);  // a lens is undone to 1e-14 of the focal length's unit
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

/// What people draw by hand: a triangle, two parts, another light, and nothing to find a peak in.
TEST(WithLabels, ReadsWhatIsDrawnByHand) {
  Scene scene = *cut().inspection.scene;
  for (Frame& f : scene.frames) f.highlights.clear();
  const std::string start = R"({"images": [{"id": 3, "file_name": "v1.png", "width": 640, "height": 480}],
    "categories": [{"id": 1, "name": "lamp"}, {"id": 2, "name": "glare"}], "annotations": [)";
  const auto label = [](int category, const std::string& polygons) {
    return R"({"image_id": 3, "category_id": )" + std::to_string(category) + R"(, "segmentation": [)" + polygons + "]}";
  };
  const LabelledScene read =
      withLabels(scene,
                 start + label(1, "[10.5, 10.5, 16.5, 10.5, 10.5, 16.5]") + "," +
                     label(2, "[0, 0, 2, 0, 2, 2], [100, 100, 140, 100, 140, 120, 120, 130, 100, 120]") + "]}",
                 "drawn.json", {});
  const std::vector<Highlight>& found = read.scene.frames[1].highlights;
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].light, "lamp");
  EXPECT_GE(found[0].contour.points.size(), 5u);  // as many as a scene file needs
  EXPECT_NEAR(found[0].areaPx2, 18, tolerance::kExact);
  EXPECT_LT((found[0].peak - Pixel(12, 12)).norm(), 1e-9);  // a third of the way: the triangle's centroid
  EXPECT_EQ(found[1].light, "");
  EXPECT_NEAR(found[1].areaPx2, 40 * 20 + 40 * 10 / 2, tolerance::kExact);  // the larger of the two parts
  EXPECT_EQ(read.warnings.size(), 3u);
}

}  // namespace
}  // namespace glint::labels_tests
