// SPDX-License-Identifier: BSD-3-Clause
// `glint lights` as a user runs it: photographs of balls whose lamps are known from the reflection law, written in closed form or
// solved by Fermat's principle here, and a scene with exact highlights.
#include <gmock/gmock.h>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "tests/cli/small_scene.h"
#include "tests/core/app/ball_scene.h"

namespace glint::lights_tests {
using namespace testing_support;
using ball_scene::mirrorPoint;
using testing::HasSubstr;

constexpr double kPhotograph = 0.25;  // degrees: a tenth of a pixel of a ball of 100 px is 0.06, its outline the rest

struct Disc {
  Eigen::Vector2d centre;
  double radius;
};

/// Dark balls before a bright wall, each with the clipped reflection of a lamp.
void photograph(const std::filesystem::path& file, int width, int height, const std::vector<Disc>& balls,
                const std::vector<Eigen::Vector2d>& spots) {
  cv::Mat m(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double value = 150;
      for (const Disc& b : balls) {
        const double inside = b.radius - (Eigen::Vector2d(x, y) - b.centre).norm();
        value += (40 - 150) / (1 + std::exp(-inside / 0.5));
      }
      for (const Eigen::Vector2d& s : spots) value += 600 * std::exp(-(Eigen::Vector2d(x, y) - s).squaredNorm() / 40);
      const auto grey = static_cast<unsigned char>(std::min(255.0, value));
      m.at<cv::Vec3b>(y, x) = {grey, grey, grey};
    }
  ASSERT_TRUE(cv::imwrite(file.string(), m));
}

double angleDeg(const Json& direction, const Eigen::Vector3d& truth) {
  const Eigen::Vector3d d(direction[0], direction[1], direction[2]);
  return std::atan2(d.cross(truth).norm(), d.dot(truth)) * 180 / M_PI;
}

/// One ball seen from far away under three distant lamps: N halves the angle between lamp and camera.
class OneBall : public testing::Test {
 protected:
  static constexpr double kRadius = 100;
  void SetUp() override {
    lamps_ = {Eigen::Vector3d(0.5, -0.4, -0.8).normalized(), Eigen::Vector3d(-0.6, 0.3, -0.6).normalized(), {0, 0, -1}};
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
      const Eigen::Vector3d n = (lamps_[i] - Eigen::Vector3d::UnitZ()).normalized();
      photograph(folder_ / ("shot " + std::to_string(i) + ".png"), 300, 260, {ball_}, {ball_.centre + kRadius * n.head<2>()});
    }
  }
  ProgramRun lights(const std::string& more) const { return runGlint("lights " + inQuotes(folder_.path()) + " " + more); }
  std::string out(const std::string& name) const { return inQuotes(folder_ / name); }

  TemporaryFolder folder_;
  Disc ball_{{150, 130}, kRadius};
  std::vector<Eigen::Vector3d> lamps_;
};

TEST_F(OneBall, DirectionsAndNullsWithoutAFocalLength) {
  const ProgramRun run = lights("--ball 151,129,101 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("no focal length"));
  EXPECT_EQ(run.errorLines(), 1);
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["glint_lights"], 1);
  EXPECT_TRUE(j["length_unit"].is_null());
  ASSERT_EQ(j["lights"].size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& lamp = j["lights"][i];
    EXPECT_EQ(lamp["id"], "lamp-shot " + std::to_string(i));
    EXPECT_EQ(lamp["frames"], Json::array({"shot " + std::to_string(i)}));
    EXPECT_EQ(lamp["status"], "ok");
    EXPECT_TRUE(lamp["position"].is_null() && lamp["covariance"].is_null() && lamp["from"].is_null());
    EXPECT_THAT(lamp["reason"].get<std::string>(), HasSubstr("focal length"));
    EXPECT_LT(angleDeg(lamp["direction"], lamps_[i]), kPhotograph) << i;
    EXPECT_GT(lamp["direction_sigma_deg"], 0);
    EXPECT_EQ(lamp["highlights"], 1);
  }
}

TEST_F(OneBall, SeveralFilesByTheirEndings) {
  const ProgramRun run = lights("--ball 151,129,101 -o " + out("a.lp") + " -o " + out("a.csv") + " -o " + out("a.json"));
  ASSERT_EQ(run.code, 0) << run.err;
  std::istringstream lp(contentOf(folder_ / "a.lp"));
  int count = 0;
  lp >> count;
  ASSERT_EQ(count, 3);
  for (int i = 0; i < count; ++i) {
    std::string name;
    Eigen::Vector3d d;
    lp >> name >> d.x() >> d.y() >> d.z();
    EXPECT_EQ(name, "shot_" + std::to_string(i) + ".png");
    EXPECT_NEAR(d.norm(), 1, 1e-8);
    EXPECT_LT((d.cwiseProduct(Eigen::Vector3d(1, -1, -1)) - lamps_[std::size_t(i)]).norm(), kPhotograph * M_PI / 180);
  }
  EXPECT_EQ(Json::parse(contentOf(folder_ / "a.json"))["lights"].size(), 3U);
  EXPECT_THAT(contentOf(folder_ / "a.csv"), testing::StartsWith("id,status,reason"));
  // Again over its own files, and never over others'.
  EXPECT_EQ(lights("--ball 151,129,101 -o " + out("a.lp")).code, 0);
  for (const char* other : {"not a list\n", "42\n", "3\nmy precious notes of today\n", "2\n1 2\n3 4\n"}) {
    folder_.write("mine.lp", other);
    const ProgramRun refused = lights("--ball 151,129,101 -o " + out("mine.lp"));
    EXPECT_EQ(refused.code, 2) << other;
    EXPECT_THAT(refused.err, HasSubstr("nothing is overwritten"));
  }
}

TEST_F(OneBall, AShotWithoutALampIsLeftOut) {
  photograph(folder_ / "dark.png", 300, 260, {ball_}, {});
  const ProgramRun run = lights("--ball 151,129,101 -o " + out("a.lp") + " -o " + out("a.json"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("1 of 4 lamps have no answer"));
  EXPECT_THAT(contentOf(folder_ / "a.lp"), testing::StartsWith("3\n"));
  const Json lamp = Json::parse(contentOf(folder_ / "a.json"))["lights"][0];
  EXPECT_EQ(lamp["id"], "lamp-dark");
  EXPECT_EQ(lamp["status"], "failed");
  EXPECT_TRUE(lamp["direction"].is_null());
  EXPECT_EQ(lights("--ball 151,129,101 --exclude 'shot 0,shot 1,shot 2'").code, 3);
}

// A tele lens of 2000 mm on 35 mm film: parallel rays, but for a hundredth of a radian.
TEST_F(OneBall, TheFocalLengthOfExifGivesDirections) {
  const TemporaryFolder shots;
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    const std::filesystem::path file = shots / (std::to_string(i) + ".jpg");
    ASSERT_TRUE(cv::imwrite(file.string(), cv::imread((folder_ / ("shot " + std::to_string(i) + ".png")).string()),
                            {cv::IMWRITE_JPEG_QUALITY, 98}));
    std::string jpeg = contentOf(file);
    const std::string tiff(
        "MM\0\x2a\0\0\0\x08"                          // Exif 2.32: header,
        "\0\1\x87\x69\0\4\0\0\0\1\0\0\0\x1a\0\0\0\0"  // a directory that points to another one,
        "\0\1\xa4\x05\0\3\0\0\0\1\x07\xd0\0\0\0\0\0\0",
        44);  // and that with FocalLengthIn35mmFilm = 2000
    jpeg.insert(2, std::string("\xff\xe1\0\x34"
                               "Exif\0\0",
                               10) +
                       tiff);
    shots.write(std::to_string(i) + ".jpg", jpeg);
  }
  const ProgramRun run = runGlint("lights " + inQuotes(shots.path()) + " --ball 151,129,101 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("EXIF, 2000 mm"));
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["length_unit"], "ball radius");
  constexpr double kTele = 0.7;  // degrees: the ball's radius is seen under 0.3
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& lamp = j["lights"][i];
    EXPECT_TRUE(lamp["position"].is_null());
    EXPECT_THAT(lamp["reason"].get<std::string>(), HasSubstr("EXIF"));
    EXPECT_NEAR(lamp["from"][2], 2000 / 43.2666 * std::hypot(300, 260) / kRadius, 5);
    EXPECT_LT(angleDeg(lamp["direction"], lamps_[i]), kTele) << i;
    EXPECT_GT(lamp["direction_sigma_deg"], 0.5);
  }
}

TEST_F(OneBall, WrongRequestsAreNamed) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"--ball 151,129", "expected [DIR:]CX,CY,R[@X0,Y0]"},
      {"--ball 151,129,x", "expected [DIR:]CX,CY,R[@X0,Y0]"},
      {"--ball 151,129,101@5", "expected [DIR:]CX,CY,R[@X0,Y0]"},
      {"--ball 151,129,-3", "the radius must be above 0"},
      {"--ball 151,129,nan", "expected [DIR:]CX,CY,R[@X0,Y0]"},
      {"--ball :1,2,3", "expected [DIR:]CX,CY,R[@X0,Y0]"},
      {"--ball nowhere:151,129,101", "does not exist"},
      {"--ball 900,129,101", "lies outside of its photographs"},
      {"--ball 151,129,101 --ball 150,130,100", "is the same ball"},
      {"--ball 151,129,101 --ball-radius -1", "--ball-radius"},
      {"--ball 151,129,101 -o a.txt", "the ending chooses"},
      {"--ball 151,129,101 -o same.lp -o same.lp", "already used for another output"},
      {"--ball 151,129,101 --surface points", "has no use with --ball"},
      {"--ball 151,129,101 --set detect.level=0.4", "has no use with --ball"},
      {"--ball 151,129,101 --exclude nobody", "--exclude"},
      {"--ball 151,129,101 --camera 1,2", "--camera"},
      {"--ball-radius 1", "give --ball, too"},
  };
  for (const auto& [request, words] : wrong) {
    const ProgramRun run = lights(request);
    EXPECT_EQ(run.code, 2) << request;
    EXPECT_THAT(run.err, HasSubstr(words)) << request;
    EXPECT_EQ(run.errorLines(), 1) << request;
    EXPECT_TRUE(run.out.empty()) << request;
  }
  EXPECT_FALSE(std::filesystem::exists("same.lp"));
}

/// A second spot, larger than the lamp's, at one place of the ball in every photograph.
TEST_F(OneBall, AReflectionThatStaysIsNotTheLamp) {
  const Eigen::Vector2d window = ball_.centre + Eigen::Vector2d(-30, -45);
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    const std::string name = "shot " + std::to_string(i) + ".png";
    cv::Mat m = cv::imread((folder_ / name).string());
    cv::circle(m, {static_cast<int>(window.x()), static_cast<int>(window.y())}, 14, {255, 255, 255}, cv::FILLED);
    ASSERT_TRUE(cv::imwrite((folder_ / name).string(), m));
  }
  const ProgramRun run = lights("--ball 150,130,100 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("does not move between photographs"));
  const Json j = Json::parse(run.out);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(angleDeg(j["lights"][i]["direction"], lamps_[i]), kPhotograph) << i;
}

TEST_F(OneBall, LampsOfOneDirectionAreAFinding) {
  for (const char* name : {"shot 1.png", "shot 2.png"}) folder_.write(name, contentOf(folder_ / "shot 0.png"));
  const ProgramRun run = lights("--ball 150,130,100 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("all 3 lamps have one direction"));
  EXPECT_LT(angleDeg(Json::parse(run.out)["lights"][2]["direction"], lamps_[0]), kPhotograph);
}

TEST_F(OneBall, WhatDoesNotMoveIsNotToldFromAWindow) {
  cv::Mat m = cv::imread((folder_ / "shot 0.png").string());
  cv::circle(m, {120, 85}, 14, {255, 255, 255}, cv::FILLED);
  const TemporaryFolder shots;
  for (const char* name : {"a.png", "b.png"}) {  // one photograph, then two of one lamp
    ASSERT_TRUE(cv::imwrite((shots / name).string(), m));
    const ProgramRun run = runGlint("lights " + inQuotes(shots.path()) + " --ball 150,130,100 --all-warnings --json -");
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("Only motion tells"));
    const Json lamp = Json::parse(run.out)["lights"][0];
    ASSERT_EQ(lamp["dropped"].size(), 1);
    EXPECT_LT(angleDeg(lamp["dropped"][0]["direction"], lamps_[0]), 4 * kPhotograph);  // the middle of a spot that is not fitted
    EXPECT_GT(lamp["direction_sigma_deg"], angleDeg(lamp["direction"], lamps_[0]) / 2);
  }
}

/// A window in a wall behind the camera, 0.3 x 0.4 at a distance of 1; the lamp of one photograph is round.
TEST_F(OneBall, ALoneRectangleMayBeAWindow) {
  const TemporaryFolder shots;
  photograph(shots / "shot.png", 300, 260, {ball_}, {});
  cv::Mat m = cv::imread((shots / "shot.png").string());
  for (int y = 0; y < m.rows; ++y)
    for (int x = 0; x < m.cols; ++x) {
      const Eigen::Vector2d n = (Eigen::Vector2d(x, y) - ball_.centre) / kRadius;
      const double z2 = 1 - n.squaredNorm();  // the mirrored ray is (2 z n, -(2 z^2 - 1)), z towards the camera
      const Eigen::Vector2d wall = z2 > 0.5 ? Eigen::Vector2d(2 * std::sqrt(z2) / (2 * z2 - 1) * n) : Eigen::Vector2d(9, 9);
      if (std::abs(wall.x() - 0.4) < 0.15 && std::abs(wall.y() + 0.3) < 0.2) m.at<cv::Vec3b>(y, x) = {255, 255, 255};
    }
  ASSERT_TRUE(cv::imwrite((shots / "shot.png").string(), m));
  const std::string more = " --ball 150,130,100 --all-warnings";
  const ProgramRun window = runGlint("lights " + inQuotes(shots.path()) + more);
  ASSERT_EQ(window.code, 0) << window.err;
  EXPECT_THAT(window.err, HasSubstr("rectangular"));
  ASSERT_TRUE(
      std::filesystem::copy_file(folder_ / "shot 0.png", shots / "shot.png", std::filesystem::copy_options::overwrite_existing));
  EXPECT_THAT(runGlint("lights " + inQuotes(shots.path()) + more).err, testing::Not(HasSubstr("window")));
}

TEST_F(OneBall, WithoutAnyLampTheFilesAreWritten) {
  const TemporaryFolder shots;
  photograph(shots / "dark.png", 300, 260, {ball_}, {});
  const ProgramRun run = runGlint("lights " + inQuotes(shots.path()) + " --ball 150,130,100 --json " + out("j.json") + " -o " +
                                  out("l.lp") + " -o " + out("l.csv"));
  EXPECT_EQ(run.code, 3);
  EXPECT_EQ(run.errorLines(), 1);
  EXPECT_EQ(Json::parse(contentOf(folder_ / "j.json"))["lights"][0]["status"], "failed");
  EXPECT_THAT(contentOf(folder_ / "l.lp"), testing::StartsWith("0\n"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "l.csv"));
}

TEST_F(OneBall, FoldersOfOneShotAreAskedAbout) {
  for (const char* side : {"left", "right"}) {
    std::filesystem::create_directories(folder_ / side);
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
      const std::string name = "shot " + std::to_string(i) + ".png";
      folder_.write(side + ("/" + name), contentOf(folder_ / name));
    }
  }
  const ProgramRun one = lights("--ball left:150,130,100 --json -");
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_THAT(one.err, HasSubstr("the folder 'right' has photographs of the same shots"));
  const std::string both = "--ball left:150,130,100 --ball right:150,130,100 --camera 2000,2000,500,400";
  const ProgramRun same = lights(both + " --json -");
  EXPECT_EQ(same.code, 2);
  EXPECT_THAT(same.err, HasSubstr("the same corner in the shot"));
  EXPECT_THAT(lights("--ball left:150,130,100 --ball right:150,130,100@600,0 --json -").err,
              testing::Not(HasSubstr("has photographs of the same shots")));
}

TEST_F(OneBall, ADamagedPhotographIsOneLampLess) {
  folder_.write("shot 1.png", contentOf(folder_ / "shot 1.png").substr(0, 700));
  const ProgramRun run = lights("--ball 151,129,101 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["lights"][1]["status"], "failed");
  EXPECT_THAT(j["lights"][1]["reason"].get<std::string>(), HasSubstr("shot 1.png"));
  EXPECT_EQ(j["lights"][2]["status"], "ok");
}

/// Two balls of 5 cm before a camera, lamps within arm's reach; the second ball's photographs are cut out of the shot.
TEST(TwoBalls, PositionsWithAFocalLength) {
  const Eigen::Matrix3d k = (Eigen::Matrix3d() << 2000, 0, 499.5, 0, 2000, 299.5, 0, 0, 1).finished();
  const std::vector<Eigen::Vector3d> balls{{-0.16, 0.01, 1.2}, {0.15, -0.02, 1.3}};
  const std::vector<Eigen::Vector3d> lamps{{-0.3, -0.4, 0.5}, {0.35, -0.3, 0.4}, {0.05, 0.4, 0.5}, {0.1, -0.5, 0.9}};
  constexpr double kRadius = 0.05;
  const auto seen = [&](const Eigen::Vector3d& p) { return Eigen::Vector2d(Eigen::Vector3d(k * p).hnormalized()); };
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "left");
  std::filesystem::create_directories(folder / "right");
  const Eigen::Vector2d corner(600, 100);
  std::vector<Disc> discs;
  for (const Eigen::Vector3d& b : balls) {
    const auto o = ball_scene::outlineOf(
        [&] {
          Camera c;
          c.pixelFromRay = k;
          return c;
        }(),
        b, kRadius, 1);
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const EdgePoint& e : o.edge) middle += e.place / double(o.edge.size());
    double radius = 0;
    for (const EdgePoint& e : o.edge) radius += (e.place - middle).norm() / double(o.edge.size());
    discs.push_back({middle, radius});
  }
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const std::string name = "s" + std::to_string(i) + ".png";
    std::vector<Eigen::Vector2d> spots;
    for (const Eigen::Vector3d& b : balls) spots.push_back(seen(mirrorPoint(b, kRadius, {}, {lamps[i]})));
    photograph(folder / ("left/" + name), 1000, 600, discs, spots);
    for (Eigen::Vector2d& s : spots) s -= corner;
    photograph(folder / ("right/" + name), 300, 300, {{discs[1].centre - corner, discs[1].radius}}, spots);
  }
  const auto text = [](const Disc& d, const Eigen::Vector2d& from) {
    std::ostringstream t;
    t << d.centre.x() - from.x() + 0.7 << "," << d.centre.y() - from.y() - 0.6 << "," << d.radius + 0.8;
    return t.str();
  };
  const ProgramRun run =
      runGlint("lights " + inQuotes(folder.path()) + " --ball left:" + text(discs[0], {0, 0}) +
               " --ball right:" + text(discs[1], corner) + "@600,100 --camera 2000,2000,499.5,299.5 --ball-radius 0.05 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["length_unit"], "m");
  ASSERT_EQ(j["lights"].size(), lamps.size());
  const Eigen::Vector3d middle = (balls[0] + balls[1]) / 2;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const Json& lamp = j["lights"][i];
    ASSERT_EQ(lamp["status"], "ok") << lamp["reason"];
    EXPECT_EQ(lamp["highlights"], 2);
    EXPECT_LT(angleDeg(lamp["direction"], (lamps[i] - middle).normalized()), 4 * lamp["direction_sigma_deg"].get<double>() + 0.1);
    ASSERT_FALSE(lamp["position"].is_null()) << lamp["reason"];
    const Eigen::Vector3d at(lamp["position"][0], lamp["position"][1], lamp["position"][2]);
    EXPECT_LT((at - lamps[i]).norm(), 0.05 * (lamps[i] - middle).norm());
    Eigen::Matrix3d covariance;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) covariance(r, c) = lamp["covariance"][std::size_t(r)][std::size_t(c)];
    EXPECT_LT((at - lamps[i]).dot(covariance.inverse() * (at - lamps[i])), 25);
    EXPECT_LT((Eigen::Vector3d(lamp["from"][0], lamp["from"][1], lamp["from"][2]) - middle).norm(), 0.02);
  }
}

// A rough ball: the middle of a wide highlight is not its mirror point, but the fit of its lobe finds that point. Photographs by
// `glint synth`, truth from its specification.
TEST(RoughBall, ItsLobeIsFitted) {
  const TemporaryFolder folder;
  const std::vector<Eigen::Vector3d> lamps{Eigen::Vector3d(0.2, -0.3, -1).normalized(),
                                           Eigen::Vector3d(-0.8, 0.2, -0.7).normalized(),
                                           Eigen::Vector3d(0.5, 0.7, -0.5).normalized()};
  Json spec = Json::parse(R"({"glint_scene": 1, "name": "ball",
    "camera": {"width": 300, "height": 300, "fx": 3000, "fy": 3000, "cx": 149.5, "cy": 149.5},
    "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.05,
                                       "world_from_surface": [[1,0,0,0],[0,1,0,0],[0,0,1,1.2],[0,0,0,1]]}}},
    "render": {"reflectance": "torrance-sparrow", "roughness": 0.15, "diffuse": 0.1, "bits": 8, "noise": 0.003, "seed": 1}})");
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const std::string id = "l" + std::to_string(i);
    spec["frames"].push_back({{"id", "f" + std::to_string(i)},
                              {"surface", "ball"},
                              {"lights_on", {id}},
                              {"camera_from_world", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}});
    spec["lights"].push_back({{"id", id}, {"direction", {lamps[i].x(), lamps[i].y(), lamps[i].z()}}});
  }
  ASSERT_EQ(runGlint("synth " + inQuotes(folder.write("spec.json", spec.dump())) + " -o " + inQuotes(folder / "made")).code, 0);
  const ProgramRun run =
      runGlint("lights " + inQuotes(folder / "made/frames") + " --ball 150,149,124 --camera 3000,3000,149.5,149.5 --json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json j = Json::parse(run.out);
  constexpr double kRough = 0.1;  // degrees; the middle of the highlight alone leaves 0.1 to 0.4
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    EXPECT_EQ(j["lights"][i]["solver"], "pixels");
    EXPECT_LT(angleDeg(j["lights"][i]["direction"], lamps[i]), kRough) << i;
  }
}

using LightsOfAScene = SmallScene;

// The scene's own lamp at (1.5, -1, 2.2) is the truth that the fit never sees.
TEST_F(LightsOfAScene, PositionFromGivenHighlights) {
  withHighlights();
  scene_.erase("lights");
  writeScene();
  const ProgramRun run = on("lights", "--json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["length_unit"], "m");
  ASSERT_EQ(j["lights"].size(), 1U);
  const Json& lamp = j["lights"][0];
  EXPECT_EQ(lamp["id"], "lamp");
  EXPECT_EQ(lamp["highlights"], kFrames);
  EXPECT_EQ(lamp["frames"].size(), std::size_t(kFrames));
  const Eigen::Vector3d truth(1.5, -1.0, 2.2), at(lamp["position"][0], lamp["position"][1], lamp["position"][2]);
  // The promised accuracy: the given points are exact to 1e-9 px, and chords between them would leave 2e-5.
  constexpr double kExactData = 1e-6;
  EXPECT_LT((at - truth).norm(), kExactData * truth.norm());
  EXPECT_LT(angleDeg(lamp["direction"], truth.normalized()) * M_PI / 180, kExactData);
  EXPECT_EQ(lamp["from"], Json::array({0.0, 0.0, 0.0}));
}

TEST_F(LightsOfAScene, ExactPixelsGiveAnExactPosition) {
  const ProgramRun run = on("lights", "--json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json lamp = Json::parse(run.out)["lights"][0];
  const Eigen::Vector3d truth(1.5, -1.0, 2.2), at(lamp["position"][0], lamp["position"][1], lamp["position"][2]);
  EXPECT_LT((at - truth).norm(), 1e-6 * truth.norm());
  EXPECT_LT(angleDeg(lamp["direction"], truth.normalized()) * M_PI / 180, 1e-6);
}

TEST_F(LightsOfAScene, AWrongDetectionIsDroppedByName) {
  withHighlights();
  Json& wrong = scene_["frames"][3]["highlights"][0];
  const auto moved = [](Json& p) { p = {p[0].get<double>() + 9, p[1].get<double>() + 12}; };
  moved(wrong["peak"]);
  for (Json& p : wrong["contour"]) moved(p);
  writeScene();
  const ProgramRun run = on("lights", "--json -");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json lamp = Json::parse(run.out)["lights"][0];
  ASSERT_EQ(lamp["dropped"].size(), 1U);
  EXPECT_EQ(lamp["dropped"][0]["frame"], scene_["frames"][3]["id"]);
  EXPECT_EQ(lamp["highlights"], kFrames - 1);
  const Eigen::Vector3d truth(1.5, -1.0, 2.2), at(lamp["position"][0], lamp["position"][1], lamp["position"][2]);
  EXPECT_LT((at - truth).norm(), 1e-4 * truth.norm());
}

// One frame alone: its direction is that of a distant lamp, and no distance is given. The lamp is 2.8 m away from a body
// of 0.6 m.
TEST_F(LightsOfAScene, OneViewGivesNoPosition) {
  const ProgramRun run = on("lights", "--exclude 1-7 --json - ");
  ASSERT_EQ(run.code, 0) << run.err;
  const Json lamp = Json::parse(run.out)["lights"][0];
  EXPECT_TRUE(lamp["position"].is_null());
  EXPECT_THAT(lamp["reason"].get<std::string>(), HasSubstr("one view leaves the distance open"));
}

TEST_F(LightsOfAScene, NoLampIsExitCode3) {
  for (int i = 0; i < kFrames; ++i) writeRadiance(i, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.05)));
  const ProgramRun run = on("lights", "-o " + out("lamps.json"));
  EXPECT_EQ(run.code, 3) << run.err;
  EXPECT_EQ(run.errorLines(), 1);
}

TEST_F(LightsOfAScene, BallsAreNotForScenes) {
  const ProgramRun run = runGlint("lights " + inQuotes(folder_ / "scene.json") + " --ball 1,2,3");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("INPUT is a folder of photographs"));
}

}  // namespace glint::lights_tests
