// SPDX-License-Identifier: BSD-3-Clause
// `glint texture`: a painted ball, rendered here, so that the colour of each of its points is known.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/cli/small_scene.h"

namespace glint::surface_texture_tests {
using namespace testing_support;
using testing::HasSubstr;

constexpr int kWide = 200, kHigh = 150, kViews = 10;
constexpr double kFocal = 270;
const Eigen::Vector3d kLamp(1.4, -2.0, 2.6);  // in radii

double toCode(double v) { return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055); }

/// Squares of two colours, from a unit ball's point; how far it is from their edges.
Eigen::Vector3d paintAt(const Eigen::Vector3d& p) {
  const Eigen::Vector3d cell = (p / 0.4).array().floor();
  return std::lround(cell.sum()) % 2 == 0 ? Eigen::Vector3d(0.5, 0.3, 0.1) : Eigen::Vector3d(0.1, 0.2, 0.3);
}
double edgeAt(const Eigen::Vector3d& p) { return (p / 0.4 - (p / 0.4).array().round().matrix()).cwiseAbs().minCoeff() * 0.4; }
double shadeAt(const Eigen::Vector3d& p) {
  const Eigen::Vector3d to = kLamp - p;
  return 6 * std::max(0.0, p.dot(to.normalized())) / to.squaredNorm();
}
/// The place of a texel, by the formulas of longitude and latitude.
Eigen::Vector3d pointOf(double u, double v) {
  const double longitude = 2 * M_PI * u, latitude = M_PI * (0.5 - v);
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

struct Variant {
  double radius = 1, noise = 0;
  bool turns = false, exposures = false;
};

class PaintedBall : public testing::Test {
 protected:
  void make(const Variant& v, const std::string& surface = "") {
    Json frames = Json::array();
    std::mt19937 engine(7);
    std::filesystem::create_directories(folder_ / "frames");
    for (int i = 0; i < kViews; ++i) {
      const double a = (-120 + 14 * i) * M_PI / 180;
      const Eigen::Vector3d eye(3.2 * std::cos(a), 3.2 * std::sin(a), 1.6);
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // camera from the unit ball
      const Eigen::Vector3d z = -eye.normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized(), y = z.cross(x);
      pose.linear() << x.transpose(), y.transpose(), z.transpose();
      pose.translation() = -(pose.linear() * eye);
      const std::string name = "frames/" + std::to_string(i) + ".png";
      const double exposure = v.exposures && i % 3 == 1 ? 0.6 : 1;
      ASSERT_TRUE(cv::imwrite((folder_ / name).string(), photograph(pose, eye, exposure, v.noise, engine)));
      Eigen::Isometry3d world = Eigen::Isometry3d::Identity();  // from the object
      if (v.turns)
        world = Eigen::Translation3d(0.3 * i, 1, 0) * Eigen::AngleAxisd(0.4 * i, Eigen::Vector3d(1, 2, 3).normalized());
      pose.translation() *= v.radius;
      pose = pose * world.inverse();
      Json frame = {{"id", std::to_string(i)}, {"camera_from_world", rows(pose)}, {"surface", "ball"}, {"image", name}};
      if (v.turns) frame["world_from_object"] = rows(world);
      frames.push_back(frame);
    }
    scene_ = {{"glint_scene", v.turns ? 2 : 1},
              {"name", "painted"},
              {"units", "m"},
              {"camera", {{"width", kWide}, {"height", kHigh}, {"fx", kFocal}, {"fy", kFocal}, {"cx", 99.5}, {"cy", 74.5}}},
              {"surfaces", {{"ball", {{"analytic", {{"type", "sphere"}, {"radius", v.radius}}}}}}},
              {"frames", frames}};
    if (!surface.empty()) scene_["surfaces"]["ball"] = Json::parse(surface);
    folder_.write("scene.json", scene_.dump());
  }
  static Json rows(const Eigen::Isometry3d& pose) {
    Json rows = Json::array();
    for (int r = 0; r < 4; ++r) rows.push_back({pose(r, 0), pose(r, 1), pose(r, 2), pose(r, 3)});
    return rows;
  }
  /// Matt paint under the lamp and a lobe about the mirrored ray; 2 x 2 rays for each pixel.
  static cv::Mat photograph(const Eigen::Isometry3d& pose, const Eigen::Vector3d& eye, double exposure, double noise,
                            std::mt19937& engine) {
    std::normal_distribution<double> gauss(0, 1);
    cv::Mat image(kHigh, kWide, CV_8UC3, cv::Scalar(0, 0, 0));
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (int s = 0; s < 4; ++s) {
          const Eigen::Vector3d ray = (pose.linear().transpose() * Eigen::Vector3d((x + (s % 2 - 0.5) / 2 - 99.5) / kFocal,
                                                                                   (y + (s / 2 - 0.5) / 2 - 74.5) / kFocal, 1))
                                          .normalized();
          const double b = ray.dot(eye), root = b * b - eye.squaredNorm() + 1;
          if (root < 0) continue;
          const Eigen::Vector3d p = eye + (-b - std::sqrt(root)) * ray;
          const double half = std::acos(std::min(1.0, p.dot(((kLamp - p).normalized() - ray).normalized())));
          sum += (paintAt(p) * shadeAt(p) + Eigen::Vector3d::Constant(0.4 * std::exp(-std::pow(half / 0.1, 2)))) / 4;
        }
        for (int c = 0; c < 3; ++c)
          image.at<cv::Vec3b>(y, x)[2 - c] = cv::saturate_cast<unsigned char>(toCode(std::min(1.0, exposure * sum(c))) +
                                                                              (sum(c) > 0 ? noise : 0) * gauss(engine));
      }
    return image;
  }
  ProgramRun texture(const std::string& more = "") const { return on("-o " + inQuotes(folder_ / "t.png") + " " + more); }
  ProgramRun on(const std::string& more) const { return runGlint("texture " + inQuotes(folder_.path()) + " " + more); }
  cv::Mat picture(const std::string& name = "t.png") const { return cv::imread((folder_ / name).string(), cv::IMREAD_UNCHANGED); }

  struct Errors {
    double median = 1e9, most95 = 1e9, seen = 0;
  };
  /// Codes between the texture and the paint under its shading, where the ball is lit, beside the edges of the squares.
  /// @param albedo  the paint alone is expected, up to one factor
  Errors errors(bool albedo = false) const {
    const cv::Mat found = picture();
    if (found.type() != CV_8UC4) return {};
    std::vector<double> off, factor;
    double seen = 0;
    double common = 1;
    for (const bool measure : {true, false}) {
      if (!measure && albedo && !factor.empty()) common = middle(factor);
      for (int y = 0; y < found.rows; ++y)
        for (int x = 0; x < found.cols; ++x) {
          const cv::Vec4b& t = found.at<cv::Vec4b>(y, x);
          const Eigen::Vector3d p = pointOf((x + 0.5) / found.cols, (y + 0.5) / found.rows);
          if (t[3] == 0) continue;
          seen += measure ? 1. / double(found.total()) : 0;
          if (edgeAt(p) < 0.03 || shadeAt(p) < 0.2) continue;
          for (int c = 0; c < 3; ++c) {
            const double truth = paintAt(p)(c) * (albedo ? 1 : shadeAt(p)), code = t[2 - c] / 255.;
            const double linear = code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
            if (measure)
              factor.push_back(linear / truth);
            else
              off.push_back(std::abs(t[2 - c] - toCode(truth * common)));
          }
        }
    }
    if (off.size() < 1000) return {};
    std::sort(off.begin(), off.end());
    return {off[off.size() / 2], off[off.size() * 95 / 100], seen};
  }
  static double middle(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
  }
  void refused(const ProgramRun& run, int code, const std::string& part) const {
    EXPECT_EQ(run.code, code) << run.err;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(part));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "t.png"));
  }
  TemporaryFolder folder_;
  Json scene_;
};

TEST_F(PaintedBall, NominalIsThePaintUnderItsShading) {
  make({});
  const ProgramRun run = texture("--sure " + inQuotes(folder_ / "sure.png"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("longitude and latitude, from 10 frames"));
  const Errors e = errors();
  EXPECT_LT(e.median, 1.5);
  EXPECT_LT(e.most95, 6);
  EXPECT_GT(e.seen, 0.4);
  EXPECT_LT(e.seen, 0.9);
  // Green: views differ. Red: their number.
  const cv::Mat sure = picture("sure.png"), found = picture();
  ASSERT_EQ(sure.size(), found.size());
  for (int y = 0; y < sure.rows; ++y)
    for (int x = 0; x < sure.cols; ++x) {
      ASSERT_EQ(sure.at<cv::Vec3b>(y, x)[2] > 0, found.at<cv::Vec4b>(y, x)[3] > 0);
      ASSERT_LE(sure.at<cv::Vec3b>(y, x)[2], kViews);
    }
}

TEST_F(PaintedBall, ABallThousandTimesLargerIsTheSame) {
  make({.radius = 1000});
  ASSERT_EQ(texture().code, 0);
  EXPECT_LT(errors().median, 1.5);
  EXPECT_LT(errors().most95, 6);
}

TEST_F(PaintedBall, NoiseIsAveraged) {
  make({.noise = 6});
  ASSERT_EQ(texture("--size 128").code, 0);
  EXPECT_EQ(picture().cols, 128);
  EXPECT_LT(errors().median, 3);  // of one photograph: 4 codes
}

TEST_F(PaintedBall, AnObjectThatMovesAndOtherExposures) {
  make({.turns = true, .exposures = true});
  const ProgramRun run = texture();
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("brightness differs by a factor of 1.6"));
  EXPECT_LT(errors().median, 2);
}

TEST_F(PaintedBall, DegenerateOneViewLeavesWhatItDoesNotSee) {
  make({});
  const ProgramRun run = texture("--frames 4");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("fewer than three views see 100 % of the texels"));
  const Errors e = errors();
  EXPECT_LT(e.median, 1.5);
  EXPECT_LT(e.seen, 0.45);
  // The place that mirrors the lamp is nobody's: half vectors of the eye and the lamp.
  const double a = (-120 + 14 * 4) * M_PI / 180;
  const Eigen::Vector3d eye(3.2 * std::cos(a), 3.2 * std::sin(a), 1.6);
  Eigen::Vector3d p = (eye.normalized() + kLamp.normalized()).normalized();
  for (int k = 0; k < 20; ++k) p = ((eye - p).normalized() + (kLamp - p).normalized()).normalized();
  const cv::Mat found = picture();
  const double u = std::atan2(p.y(), p.x()) / (2 * M_PI), v = 0.5 - std::asin(p.z()) / M_PI;
  const cv::Vec4b there = found.at<cv::Vec4b>(int(v * found.rows), int((u < 0 ? u + 1 : u) * found.cols));
  EXPECT_EQ(there[3], 0);
  // What nobody sees has the mean colour, so that the picture's mean is that of what is seen.
  EXPECT_GT(there[0] + there[1] + there[2], 30);
}

TEST_F(PaintedBall, ShadingIsDividedOut) {
  make({});
  const ProgramRun run = texture("--shading remove --train spread:6");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("--shading lambert --albedo 0."));
  EXPECT_LT(errors(true).median, 5);
  EXPECT_GT(errors(false).median, 10);
}

TEST_F(PaintedBall, RetexturePutsItBack) {
  make({});
  ASSERT_EQ(texture().code, 0);
  const std::string session = inQuotes(folder_ / "s.glint");
  const ProgramRun fit =
      runGlint("reconstruct " + inQuotes(folder_.path()) + " --model limit-angle --train spread:6 -o " + session);
  ASSERT_EQ(fit.code, 0) << fit.err;
  const ProgramRun run =
      runGlint("retexture " + session + " --frame 5 --all-warnings --shading none --texture " + inQuotes(folder_ / "t.png") +
               " -o " + inQuotes(folder_ / "back.png") + " --marks " + inQuotes(folder_ / "marks.png"));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the light that the surface sends"));
  const cv::Mat back = picture("back.png"), marks = picture("marks.png"), photograph = picture("frames/5.png");
  std::vector<double> off;
  for (int y = 0; y < kHigh; ++y)
    for (int x = 0; x < kWide; ++x)
      if (marks.at<cv::Vec3b>(y, x)[0] == 0 && photograph.at<cv::Vec3b>(y, x) != cv::Vec3b(0, 0, 0))
        for (int c = 0; c < 3; ++c) off.push_back(std::abs(back.at<cv::Vec3b>(y, x)[c] - photograph.at<cv::Vec3b>(y, x)[c]));
  ASSERT_GT(off.size(), 3000u);
  EXPECT_LE(middle(off), 2);
}

TEST_F(PaintedBall, WhatCannotBeMadeIsOneLine) {
  make({});
  refused(texture("--size 5000"), 2, "--size");
  refused(texture("--repeat 0"), 2, "--repeat");
  refused(texture("--frames 99"), 2, "--frames");
  refused(on("-o " + inQuotes(folder_ / "frames/1.png")), 2, "is an input file");
  refused(on("-o " + inQuotes(folder_ / "t.svg")), 2, "t.svg");
  for (Json& frame : scene_["frames"]) frame.erase("image");
  folder_.write("scene.json", scene_.dump());
  refused(texture(), 3, "has no photograph");
}

TEST_F(PaintedBall, MeshesThatDifferAreRefusedByName) {
  folder_.write("a.ply",
                "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
                "property list uchar int vertex_indices\nend_header\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n3 0 1 2\n3 0 2 3\n");
  make({}, R"({"mesh": "a.ply"})");
  scene_["surfaces"]["other"] = {{"mesh", "a.ply"}};
  scene_["frames"][3]["surface"] = "other";
  folder_.write("scene.json", scene_.dump());
  refused(texture(), 3, "frames 0 and 3 show different surfaces (ball, other)");
}

}  // namespace glint::surface_texture_tests
