// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "core/base/permitted.h"
#include "core/scene/capture.h"
#include "core/scene/scene_reader.h"
#include "tests/core/scene/png_fixture.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/tolerances.h"

namespace glint::bop_tests {
namespace {
using namespace testing_support;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

constexpr const char* kBopK = "[600, 0, 320, 0, 610, 240, 0, 0, 1]";
constexpr const char* kBopUnit = "[1, 0, 0, 0, 1, 0, 0, 0, 1]";
/// By 90 degrees about z, row by row: x becomes y.
constexpr const char* kBopTurned = "[0, -1, 0, 1, 0, 0, 0, 0, 1]";

/// A data set of one scene: image 3 shows objects 2 and 5, image 12 object 5 alone.
struct BopSet : TemporaryFolder {
  BopSet() {
    write("test/000001/scene_camera.json", std::string(R"({"3": {"cam_K": )") + kBopK +
                                               R"(, "depth_scale": 0.1}, "12": {"cam_K": )" + kBopK +
                                               R"(, "depth_scale": 0.1}})");
    write("test/000001/scene_gt.json", std::string(R"({"3": [{"obj_id": 2, "cam_R_m2c": )") + kBopUnit +
                                           R"(, "cam_t_m2c": [0, 0, 400]}, {"obj_id": 5, "cam_R_m2c": )" + kBopTurned +
                                           R"(, "cam_t_m2c": [10, 20, 500]}], "12": [{"obj_id": 5, "cam_R_m2c": )" + kBopUnit +
                                           R"(, "cam_t_m2c": [0, 0, 700]}]})");
    write("test/000001/rgb/000003.png", pngOfSize(640, 480));
    write("test/000001/rgb/000012.png", pngOfSize(640, 480));
    write("test/000001/depth/000003.png", "");
    write("test/000001/mask_visib/000003_000000.png", "");
    write("test/000001/mask_visib/000003_000001.png", "");
    write("models/obj_000005.ply", "ply\n");
  }
  fs::path scene() const { return *this / "test/000001"; }
  std::string text(const std::string& name) const { return contentOf(scene() / name); }
  void change(const std::string& name, const std::string& from, const std::string& to) const {
    write("test/000001/" + name, with(text(name), from, to));
  }
};

CaptureOptions forObject(const std::string& object) {
  CaptureOptions options;
  options.object = object;
  return options;
}

Capture readBop(const fs::path& scene, const CaptureOptions& options = forObject("5")) {
  const auto reader = makeBopReader();
  return reader->read(reader->recognise(scene), options);
}

std::string bopError(const fs::path& scene, const CaptureOptions& options = forObject("5")) {
  return inputErrorOf([&] { makeBopReader()->read(scene / "scene_camera.json", options); });
}

TEST(BopCapture, TheObjectsFrameIsTheWorldAndMatricesStandRowByRow) {
  const BopSet set;
  const Capture capture = readBop(set.scene());
  ASSERT_EQ(capture.views.size(), 2u);
  const Camera& camera = capture.views[0].camera;
  // R (1, 0, 0) + t = (0, 1, 0) + (10, 20, 500), by hand; column by column it would be (10, 19, 500).
  EXPECT_LT((camera.camFromWorld * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(10, 21, 500)).norm(), tolerance::kExact);
  // P_m2i = K [R | t]: u = 600 * 10 / 500 + 320, v = 610 * 21 / 500 + 240.
  const Eigen::Vector3d p = camera.pixelFromRay * (camera.camFromWorld * Eigen::Vector3d(1, 0, 0));
  EXPECT_NEAR(p.x() / p.z(), 332, tolerance::kPixel);
  EXPECT_NEAR(p.y() / p.z(), 265.62, tolerance::kPixel);
}

TEST(BopCapture, LengthsAreMillimetres) {
  const BopSet set;
  const Capture capture = readBop(set.scene());
  EXPECT_EQ(capture.metresPerUnit, 0.001);
  EXPECT_TRUE(capture.hasScale);
  ASSERT_TRUE(capture.mesh);
  EXPECT_EQ(capture.mesh->metresPerUnit, 0.001);
  EXPECT_EQ(capture.views[1].camera.camFromWorld.translation().z(), 700);
}

TEST(BopCapture, KIsOfTheCentreOfTheFirstPixelAndKeepsItsSkew) {
  const BopSet set;
  set.change("scene_camera.json", kBopK, "[600, 0.5, 320, 0, 610, 240, 0, 0, 1]");
  const Capture capture = readBop(set.scene());
  Eigen::Matrix3d k;
  k << 600, 0.5, 320, 0, 610, 240, 0, 0, 1;
  EXPECT_EQ(capture.views[0].camera.pixelFromRay, k);
  EXPECT_EQ(capture.views[1].camera.pixelFromRay(0, 1), 0);
  EXPECT_EQ(capture.views[0].camera.width, 640);
  EXPECT_EQ(capture.views[0].camera.height, 480);
  EXPECT_FALSE(capture.views[0].camera.lens.parameters[0]);
}

TEST(BopCapture, DepthScaleIsMillimetresPerUnitOfEachImage) {
  const BopSet set;
  set.change("scene_camera.json", R"(, "depth_scale": 0.1}, "12")", R"(}, "12")");
  const Capture capture = readBop(set.scene());
  EXPECT_DOUBLE_EQ(1000 * capture.views[0].depthScale, 1);  // where nothing is said, a unit is a millimetre
  EXPECT_DOUBLE_EQ(10000 * capture.views[1].depthScale, 1);
  EXPECT_THAT(capture.facts, Contains(HasSubstr("0.1 .. 1 mm per unit")));
}

TEST(BopCapture, ImagesDepthAndMasksAreFoundByNumber) {
  const BopSet set;
  const Capture capture = readBop(set.scene());
  EXPECT_EQ(capture.kind, "bop");
  EXPECT_EQ(capture.folder, set.scene());
  EXPECT_THAT(capture.sources, ElementsAre(set.scene() / "scene_camera.json", set.scene() / "scene_gt.json"));
  EXPECT_EQ(capture.views[0].name, "000003.png");
  EXPECT_EQ(capture.views[0].image, set.scene() / "rgb/000003.png");
  EXPECT_EQ(capture.views[0].depth, set.scene() / "depth/000003.png");
  EXPECT_EQ(capture.views[0].mask, set.scene() / "mask_visib/000003_000001.png");  // the second entry of the image
  EXPECT_EQ(capture.views[1].depth, "");
  EXPECT_EQ(capture.views[1].mask, "");
}

TEST(BopCapture, GreyImagesAndOtherEndings) {
  const BopSet set;
  fs::remove_all(set.scene() / "rgb");
  set.write("test/000001/gray/000003.tif", pngOfSize(64, 48));
  set.write("test/000001/rgb/000012.jpg", pngOfSize(32, 24));
  set.write("test/000001/depth/000012.tif", "");
  const Capture capture = readBop(set.scene());
  EXPECT_EQ(capture.views[0].name, "000003.tif");
  EXPECT_EQ(capture.views[0].image, set.scene() / "gray/000003.tif");
  EXPECT_EQ(capture.views[0].camera.width, 64);
  EXPECT_EQ(capture.views[1].name, "000012.jpg");
  EXPECT_EQ(capture.views[1].camera.width, 32);
  EXPECT_EQ(capture.views[1].depth, set.scene() / "depth/000012.tif");
}

TEST(BopCapture, ViewsAreOrderedByNumber) {
  const BopSet set;
  set.change("scene_camera.json", "\"3\"", "\"1000000\"");
  set.change("scene_gt.json", "\"3\"", "\"1000000\"");
  set.write("test/000001/rgb/1000000.png", pngOfSize(64, 48));
  set.change("scene_camera.json", "\"12\"", "\"999999\"");
  set.change("scene_gt.json", "\"12\"", "\"999999\"");
  set.write("test/000001/rgb/999999.png", pngOfSize(64, 48));
  const Capture capture = readBop(set.scene());
  EXPECT_EQ(capture.views[0].name, "999999.png");
  EXPECT_EQ(capture.views[1].name, "1000000.png");
}

TEST(BopCapture, TheObjectIsChosenByNumber) {
  const BopSet set;
  EXPECT_THAT(bopError(set.scene(), {}), HasSubstr("names several objects (2, 5); choose one by --object"));
  EXPECT_THAT(bopError(set.scene(), forObject("7")), AllOf(HasSubstr("'7'"), HasSubstr("2, 5")));
  EXPECT_THAT(bopError(set.scene(), forObject("5x")), HasSubstr("'5x' is not the number"));
  EXPECT_THAT(bopError(set.scene(), forObject("-5")), HasSubstr("'-5' is not the number"));
  EXPECT_THAT(bopError(set.scene(), forObject("99999999999999999999")), HasSubstr("is not the number"));
  const Capture capture = readBop(set.scene(), forObject("2"));
  ASSERT_EQ(capture.views.size(), 1u);
  EXPECT_EQ(capture.views[0].camera.camFromWorld.translation().z(), 400);
  EXPECT_EQ(capture.views[0].mask, set.scene() / "mask_visib/000003_000000.png");
  EXPECT_THAT(capture.warnings, ElementsAre("1 image does not show object 2 and is left out"));
}

TEST(BopCapture, SeveralObjectsAreAQuestionWithItsAnswers) {
  const BopSet set;
  try {
    readBop(set.scene(), {});
    FAIL() << "nothing thrown";
  } catch (const UndecidedInput& undecided) {
    EXPECT_EQ(undecided.question(), UndecidedInput::Question::Object);
    ASSERT_EQ(undecided.answers().size(), 2u);
    EXPECT_EQ(undecided.answers()[0].value, "2");
    EXPECT_EQ(undecided.answers()[1].value, "5");
  }
}

TEST(BopCapture, APoseThatIsNotFiniteCostsItsImage) {
  const BopSet whole, set;
  set.change("scene_gt.json", "[10, 20, 500]", "[10, 20, Infinity]");
  const Capture capture = readBop(set.scene());
  EXPECT_EQ(capture.views.size() + 1, readBop(whole.scene()).views.size());
  EXPECT_THAT(capture.warnings, Contains(HasSubstr("scene_gt.json: 3[1]: no finite pose")));
}

TEST(BopCapture, TheOnlyObjectNeedsNoChoice) {
  const BopSet set;
  set.change("scene_gt.json", "\"obj_id\": 2", "\"obj_id\": 5");
  EXPECT_THAT(bopError(set.scene(), {}),
              AllOf(HasSubstr("scene_gt.json: an image shows object 5 2 times"), HasSubstr("choose one by --object 5:N")));
  set.write("test/000001/scene_gt.json",
            std::string(R"({"3": [{"obj_id": 5, "cam_R_m2c": )") + kBopUnit + R"(, "cam_t_m2c": [0, 0, 400]}], "12": []})");
  EXPECT_EQ(readBop(set.scene(), {}).views.size(), 1u);
}

TEST(BopCapture, ImagesWithoutAnyObjectAreLeftOut) {
  const BopSet set;
  set.change("scene_camera.json", "{\"3\"",
             std::string("{\"40\": {\"cam_K\": ") + kBopK + "}, \"3\"");  // of a test set: no poses
  const Capture capture = readBop(set.scene());
  EXPECT_EQ(capture.views.size(), 2u);
  EXPECT_THAT(capture.warnings, ElementsAre("1 image does not show object 5 and is left out"));
  EXPECT_THAT(capture.facts, Contains(HasSubstr("object 5 in 2 of 3 images")));
}

/// Where the cameras stand, and the object of image 12 so that in the world it lies `x` mm beside and turned by `degrees` about
/// z against that of image 3. World to camera is R90 X + (0, 0, 600) in image 3 and X + (0, 0, 700) in image 12; in image 3 the
/// object lies at (20, -10, -100), unturned: R90 (20, -10, -100) + (0, 0, 600) = (10, 20, 500).
void placeCameras(const BopSet& set, double x, double degrees) {
  set.change("scene_camera.json", "\"depth_scale\": 0.1}, \"12\"",
             std::string("\"cam_R_w2c\": ") + kBopTurned + ", \"cam_t_w2c\": [0, 0, 600]}, \"12\"");
  set.change("scene_camera.json", "\"depth_scale\": 0.1}}",
             std::string("\"cam_R_w2c\": ") + kBopUnit + ", \"cam_t_w2c\": [0, 0, 700]}}");
  const double c = std::cos(degrees * 3.14159265358979323846 / 180), s = std::sin(degrees * 3.14159265358979323846 / 180);
  std::ostringstream pose;
  pose.precision(17);
  pose << "\"cam_R_m2c\": [" << c << ", " << -s << ", 0, " << s << ", " << c << ", 0, 0, 0, 1], \"cam_t_m2c\": [" << 20 + x
       << ", -10, 600]";
  set.change("scene_gt.json", std::string("\"cam_R_m2c\": ") + kBopUnit + ", \"cam_t_m2c\": [0, 0, 700]", pose.str());
}

TEST(BopCapture, AnObjectThatStandsStillInTheWorldIsAFact) {
  const BopSet set;
  placeCameras(set, 0.5, 0.05);
  const Capture capture = readBop(set.scene());
  EXPECT_THAT(capture.warnings, IsEmpty());
  EXPECT_THAT(capture.facts, Contains(HasSubstr("stands still in the world: within 0.5 mm and 0.05 degrees over 2 images")));
}

TEST(BopCapture, AnObjectThatMovesStandsWhereTheCamerasWorldHasIt) {
  const BopSet shifted;
  placeCameras(shifted, -1.5, 0);
  const Capture capture = readBop(shifted.scene());
  EXPECT_THAT(capture.warnings, IsEmpty());
  EXPECT_THAT(capture.facts, Contains(AllOf(HasSubstr("the object moves: up to 1.5 mm"), HasSubstr("000003.png"))));
  // The cameras are those of cam_R_w2c, in mm, and the object lies where placeCameras() has it.
  EXPECT_LT((capture.views[0].camera.camFromWorld * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 1, 600)).norm(), 1e-9);
  EXPECT_LT((capture.views[0].worldFromObject.translation() - Eigen::Vector3d(20, -10, -100)).norm(), 1e-9);
  EXPECT_LT((capture.views[1].worldFromObject.translation() - Eigen::Vector3d(18.5, -10, -100)).norm(), 1e-9);
  EXPECT_TRUE(capture.views[1].worldFromObject.linear().isApprox(Eigen::Matrix3d::Identity()));
  const BopSet turned;
  placeCameras(turned, 0, 0.2);
  EXPECT_THAT(readBop(turned.scene()).facts, Contains(HasSubstr("and 0.2 degrees")));
}

TEST(BopCapture, WithoutCamerasInTheWorldMotionIsNotKnown) {
  const BopSet set;
  EXPECT_THAT(readBop(set.scene()).facts, Contains(HasSubstr("whether the object stands still is not known")));
  set.change("scene_camera.json", "\"depth_scale\"", std::string("\"cam_R_w2c\": ") + kBopUnit + ", \"depth_scale\"");
  EXPECT_THAT(bopError(set.scene()), HasSubstr("3.cam_t_w2c: is missing"));
}

TEST(BopCapture, TheMeshIsFoundBesideTheSplits) {
  const BopSet set;
  set.write("models_cad/obj_000005.ply", "ply\n");
  set.write("models_eval/obj_000005.ply", "ply\n");
  Capture capture = readBop(set.scene());
  ASSERT_TRUE(capture.mesh);
  EXPECT_EQ(capture.mesh->file, set / "models/obj_000005.ply");
  EXPECT_THAT(capture.facts, Contains(AllOf(HasSubstr("models/obj_000005.ply"), HasSubstr("also in models_cad, models_eval"))));
  fs::remove(set / "models/obj_000005.ply");
  capture = readBop(set.scene());
  EXPECT_EQ(capture.mesh->file, set / "models_cad/obj_000005.ply");
  EXPECT_FALSE(readBop(set.scene(), forObject("2")).mesh);  // obj_000002.ply is nowhere
}

TEST(BopCapture, AMeshThatIsALinkOutOfItsFolderIsNotTaken) {
  const BopSet set;
  const TemporaryFolder elsewhere;
  fs::remove(set / "models/obj_000005.ply");
  fs::create_symlink(elsewhere.write("secret.ply", "ply\n"), set / "models/obj_000005.ply");
  EXPECT_THROW(makeBopReader()->read(set.scene() / "scene_camera.json", forObject("5")), OutsidePath);
}

TEST(BopCapture, AFolderOfModelsThatIsALinkOutOfTheDataSetCountsAsOutside) {
  const BopSet set;
  const TemporaryFolder elsewhere;
  fs::rename(set / "models", elsewhere / "models");
  EXPECT_THAT(foldersOfCapture(set.scene() / "scene_camera.json"), IsEmpty());
  fs::create_directory_symlink(elsewhere / "models", set / "models");
  EXPECT_THAT(foldersOfCapture(set.scene() / "scene_camera.json"), IsEmpty());
  const Capture capture = makeBopReader()->read(set.scene() / "scene_camera.json", forObject("5"));
  ReadOptions options;
  EXPECT_THROW(sceneOfCapture(capture, options), OutsidePath);
  options.allowOutsidePaths = true;
  EXPECT_NO_THROW(sceneOfCapture(capture, options));
}

TEST(BopCapture, PhotographsMayLieElsewhere) {
  const BopSet set;
  const TemporaryFolder elsewhere;
  elsewhere.write("000012.png", pngOfSize(320, 240));
  CaptureOptions options = forObject("5");
  options.photographs = {elsewhere.path()};
  const Capture capture = readBop(set.scene(), options);
  EXPECT_EQ(capture.views[0].image, set.scene() / "rgb/000003.png");
  EXPECT_EQ(capture.views[1].image, elsewhere / "000012.png");
  EXPECT_EQ(capture.views[1].camera.width, 320);
}

TEST(BopCapture, AMissingImageSaysHowToNameItsFolder) {
  const BopSet set;
  fs::remove(set.scene() / "rgb/000012.png");
  EXPECT_THAT(bopError(set.scene()),
              AllOf(HasSubstr("scene_camera.json: 12"), HasSubstr("000012.png"), HasSubstr("--photographs")));
}

TEST(BopCapture, RotationsWithFewDigitsAreRepairedAndCounted) {
  const BopSet set;
  // 30 degrees about z with four digits.
  set.change("scene_gt.json", kBopTurned, "[0.8660, -0.5, 0, 0.5, 0.8660, 0, 0, 0, 1]");
  const Capture capture = readBop(set.scene());
  const Eigen::Matrix3d r = capture.views[0].camera.camFromWorld.linear();
  EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), tolerance::kExact);
  EXPECT_NEAR(r(0, 0), 0.8660 / std::hypot(0.8660, 0.5),
              tolerance::kExact);  // in the plane the nearest rotation is the scaled one
  EXPECT_THAT(capture.warnings, ElementsAre(HasSubstr("3[1].cam_R_m2c: not exactly a rotation")));
}

TEST(BopCapture, RenderedSetsAreWarnedOf) {
  const BopSet set;
  fs::rename(set / "test", set / "train_pbr");
  EXPECT_THAT(readBop(set / "train_pbr/000001").warnings, ElementsAre(HasSubstr("half a pixel")));
}

TEST(BopCapture, DamagedEntriesAreNamed) {
  struct Row {
    const char *file, *from, *to, *message;
  };
  for (const Row& row : {
           Row{"scene_camera.json", kBopK, "[600, 0, 320, 1, 610, 240, 0, 0, 1]", "3.cam_K: its fourth number must be 0"},
           Row{"scene_camera.json", kBopK, "[600, 0, 320, 0, 610, 240, 0, 0, 2]", "3.cam_K: its last three numbers"},
           Row{"scene_camera.json", kBopK, "[600, 0, 0, 0, 610, 0, 320, 240, 1]", "3.cam_K: its last three numbers"},
           Row{"scene_camera.json", kBopK, "[-600, 0, 320, 0, 610, 240, 0, 0, 1]", "3.cam_K: the focal length must be positive"},
           Row{"scene_camera.json", kBopK, "[600, 0, 1e300, 0, 610, 240, 0, 0, 1]", "3.cam_K[2]: is larger than 1e9"},
           Row{"scene_camera.json", kBopK, "[600, 0, NaN, 0, 610, 240, 0, 0, 1]", "3.cam_K[2]: must be a finite number"},
           Row{"scene_camera.json", kBopK, "[600, 0, 320, 0, 610, 240]", "3.cam_K: must have 9 numbers, has 6"},
           Row{"scene_camera.json", "cam_K", "cam_k", "3.cam_K: is missing"},
           Row{"scene_camera.json", "\"depth_scale\": 0.1", "\"depth_scale\": 0", "3.depth_scale: must be positive"},
           Row{"scene_camera.json", "\"3\"", "\"three\"", "three: is not the number of an image"},
           Row{"scene_camera.json", "\"3\"", "\"-3\"", "-3: is not the number of an image"},
           Row{"scene_camera.json", "\"3\"", "\"012\"", "image 12 is in the file twice"},
           Row{"scene_camera.json", "\"3\"", "\"4\"", "scene_gt.json: 3: has no camera in scene_camera.json"},
           Row{"scene_camera.json", "{\"3\"", "{{\"3\"", "scene_camera.json"},
           Row{"scene_gt.json", kBopTurned, "[0, -1, 0, 1, 0, 0, 0, 0, 1.01]", "3[1].cam_R_m2c: is not a rotation"},
           Row{"scene_gt.json", kBopTurned, "[0, 1, 0, 1, 0, 0, 0, 0, 1]", "3[1].cam_R_m2c: is mirrored"},
           Row{"scene_gt.json", kBopTurned, "[0, 0, 0, 0, 0, 0, 0, 0, 0]", "3[1].cam_R_m2c: is not a rotation"},
           Row{"scene_gt.json", kBopTurned, "[1e300, 0, 0, 0, 0, 0, 0, 0, 0]", "3[1].cam_R_m2c[0]: is larger than"},
           Row{"scene_gt.json", kBopTurned, "[[0, -1, 0], [1, 0, 0], [0, 0, 1]]", "3[1].cam_R_m2c[0]: must be a finite number"},
           Row{"scene_gt.json", "[10, 20, 500]", "[10, 20]", "3[1].cam_t_m2c: must have 3 numbers"},
           Row{"scene_gt.json", "[10, 20, 500]", "[10, 20, \"far\"]", "3[1].cam_t_m2c[2]: must be a finite number"},
           Row{"scene_gt.json", "\"obj_id\": 5", "\"obj_id\": 5.5", "3[1].obj_id: must be a whole number"},
           Row{"scene_gt.json", "\"obj_id\": 5", "\"obj_id\": -5", "3[1].obj_id: must not be negative"},
           Row{"scene_gt.json", "{\"3\": [", "{\"7\": {}, \"3\": [", "7: must be a list"},
           Row{"scene_gt.json", "{\"3\": [", "{\"3\": [3, ", "3[0]: must be an object"},
       }) {
    const BopSet set;
    set.change(row.file, row.from, row.to);
    EXPECT_THAT(bopError(set.scene()), HasSubstr(row.message)) << row.to;
  }
}

TEST(BopCapture, EmptyAndForeignFilesAreRefused) {
  const BopSet set;
  const std::string cameras = set.text("scene_camera.json");
  for (const char* text : {"{}", "[]", "", "null", "{\"3\": []}"}) {
    set.write("test/000001/scene_gt.json", text);
    EXPECT_THAT(bopError(set.scene()), HasSubstr("scene_gt.json")) << text;
  }
  fs::remove(set.scene() / "scene_gt.json");
  EXPECT_THAT(bopError(set.scene()), HasSubstr("scene_gt.json"));
}

TEST(BopCapture, OneSceneIsRecognisedAndASetIsNot) {
  const auto reader = makeBopReader();
  const BopSet set;
  EXPECT_EQ(reader->name(), "bop");
  const fs::path file = set.scene() / "scene_camera.json";
  EXPECT_EQ(reader->recognise(set.scene()), file);
  EXPECT_EQ(reader->recognise(file), file);
  EXPECT_EQ(reader->recognise(set.scene() / "scene_gt.json"), file);
  for (const fs::path& other :
       {set.path(), set / "test", set.scene() / "rgb", set.scene() / "rgb/000003.png", set / "missing", fs::path()})
    EXPECT_EQ(reader->recognise(other), "") << other;
  set.write("test/000001/scene_camera.json", "{\"glint_scene\": 1}");
  EXPECT_EQ(reader->recognise(set.scene()), "");
  const BopSet half;
  fs::remove(half.scene() / "scene_gt.json");
  EXPECT_EQ(reader->recognise(half.scene()), "");
}

}  // namespace
}  // namespace glint::bop_tests
