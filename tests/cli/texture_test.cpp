// SPDX-License-Identifier: BSD-3-Clause
// `glint detect` and bright texture: a glossy ball made by `glint synth`, with two spots painted into its pictures here, so that
// it is known which is which.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <optional>
#include <set>

#include "tests/cli/small_scene.h"

namespace glint::texture_tests {
using namespace testing_support;
using testing::HasSubstr;
using testing::StartsWith;

constexpr int kWide = 240, kHigh = 180;
constexpr double kFocal = 300, kRadius = 0.5;
const Eigen::Vector3d kMiddle(0, 0, -0.5);  // of the ball

Eigen::Vector3d onBall(double x, double y) { return {x, y, std::sqrt(kRadius * kRadius - x * x - y * y) - 0.5}; }
const std::vector<Eigen::Vector3d> kSpots{onBall(-0.12, -0.15), onBall(0.16, -0.05)};
constexpr double kSpotRadius = 0.035;

Eigen::Isometry3d cameraAt(const Eigen::Vector3d& eye) {
  const Eigen::Vector3d z = -eye.normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized(), y = z.cross(x);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << x.transpose(), y.transpose(), z.transpose();
  pose.translation() = -(pose.linear() * eye);
  return pose;
}

/// Where a pixel's ray meets the ball, by the quadratic equation.
std::optional<Eigen::Vector3d> ballUnder(const Eigen::Isometry3d& camFromWorld, double px, double py) {
  const Eigen::Isometry3d worldFromCam = camFromWorld.inverse();
  const Eigen::Vector3d eye = worldFromCam.translation();
  const Eigen::Vector3d ray =
      (worldFromCam.linear() * Eigen::Vector3d((px - 119.5) / kFocal, (py - 89.5) / kFocal, 1)).normalized();
  const double b = ray.dot(eye - kMiddle), c = (eye - kMiddle).squaredNorm() - kRadius * kRadius, root = b * b - c;
  if (root < 0) return std::nullopt;
  return eye + (-b - std::sqrt(root)) * ray;
}

/// A spot of paint about this middle.
bool isPaint(const std::optional<Eigen::Vector3d>& p) {
  return p && std::any_of(kSpots.begin(), kSpots.end(), [&](const auto& s) { return (*p - s).norm() < 0.5 * kSpotRadius; });
}

struct Count {
  int paint = 0, paintFlagged = 0, highlights = 0, highlightsFlagged = 0, rejectedPaint = 0, rejectedOther = 0;
};

class TextureTest : public testing::Test {
 protected:
  /// @param degrees  of the arc on which the cameras stand
  void make(int cameras, double degrees) {
    Json frames = Json::array();
    poses_.clear();
    for (int i = 0; i < cameras; ++i) {
      const double a = (static_cast<double>(i) / std::max(1, cameras - 1) - 0.5) * degrees * M_PI / 180 - M_PI / 2;
      poses_.push_back(cameraAt({0.9 * std::cos(a), 0.9 * std::sin(a), 1.2}));
      Json rows = Json::array();
      for (int r = 0; r < 4; ++r) {
        rows.push_back(Json::array());
        for (int c = 0; c < 4; ++c) rows.back().push_back(poses_.back()(r, c));
      }
      frames.push_back({{"id", std::to_string(i)}, {"camera_from_world", rows}, {"surface", "ball"}, {"lights_on", {"lamp"}}});
    }
    const Json ball = {{"type", "sphere"},
                       {"radius", kRadius},
                       {"world_from_surface", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -0.5}, {0, 0, 0, 1}}}};
    const Json spec = {
        {"glint_scene", 1},
        {"name", "painted"},
        {"units", "m"},
        {"camera", {{"width", kWide}, {"height", kHigh}, {"fx", kFocal}, {"fy", kFocal}, {"cx", 119.5}, {"cy", 89.5}}},
        {"surfaces", {{"ball", {{"analytic", ball}}}}},
        {"lights", {{{"id", "lamp"}, {"position", {0.3, 0.4, 2.0}}}}},
        {"frames", frames},
        {"render", {{"reflectance", "torrance-sparrow"}, {"roughness", 0.1}, {"diffuse", 0.02}, {"bits", 32}, {"samples", 1}}}};
    folder_.write("spec.json", spec.dump());
    std::filesystem::remove_all(folder_ / "scene");
    const ProgramRun made = runGlint("synth " + inQuotes(folder_ / "spec.json") + " -o " + inQuotes(folder_ / "scene"));
    ASSERT_EQ(made.code, 0) << made.err;
    Json bare = Json::parse(contentOf(folder_ / "scene/scene.json"));
    for (std::size_t f = 0; f < poses_.size(); ++f) {
      bare["frames"][f].erase("highlights");
      paint(folder_ / ("scene/" + bare["frames"][f]["radiance"].get<std::string>()), poses_[f]);
    }
    folder_.write("scene/scene.json", bare.dump());
  }

  /// Each frame's own depth map in place of the ball. @param grows  share by which the ball is larger from frame to frame
  void useDepth(double grows) {
    Json scene = Json::parse(contentOf(folder_ / "scene/scene.json"));
    scene.erase("surfaces");
    std::filesystem::create_directories(folder_ / "scene/own");
    for (std::size_t f = 0; f < poses_.size(); ++f) {
      cv::Mat depth(kHigh, kWide, CV_32FC1, cv::Scalar(0));
      for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x)
          if (const auto p = ballUnder(poses_[f], x, y))
            depth.at<float>(y, x) = static_cast<float>((poses_[f] * *p).z() * (1 + grows * static_cast<double>(f)));
      const std::string name = "own/" + std::to_string(f) + ".tiff";
      ASSERT_TRUE(cv::imwrite((folder_ / "scene" / name).string(), depth, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
      scene["frames"][f].erase("surface");
      scene["frames"][f]["depth"] = name;
    }
    folder_.write("scene/scene.json", scene.dump());
  }

  /// Two spots, nearly as bright as the picture's own highlight.
  static void paint(const std::filesystem::path& file, const Eigen::Isometry3d& pose) {
    cv::Mat image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type() & CV_MAT_DEPTH_MASK, CV_32F) << file;
    double most = 0;
    cv::minMaxLoc(image.reshape(1), nullptr, &most);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        if (const auto p = ballUnder(pose, x, y))
          for (const Eigen::Vector3d& s : kSpots)
            for (int c = 0; c < image.channels(); ++c)
              image.ptr<float>(y)[x * image.channels() + c] +=
                  static_cast<float>(0.85 * most * std::exp(-((*p - s) / kSpotRadius).squaredNorm()));
    ASSERT_TRUE(cv::imwrite(file.string(), image, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  }

  Count detect(const std::string& more) {
    const ProgramRun run = runGlint("detect " + inQuotes(folder_ / "scene") + " --json - " + more);
    EXPECT_EQ(run.code, 0) << run.err;
    words_.clear();
    Count n;
    const Json frames = Json::parse(run.out)["frames"];
    for (std::size_t f = 0; f < frames.size(); ++f) {
      for (const Json& h : frames[f]["highlights"]) {
        const bool painted = isPaint(ballUnder(poses_[f], h["peak"][0], h["peak"][1]));
        bool flagged = false;
        for (const std::string flag : h["flags"]) {
          const bool motion = flag.find("its motion cannot tell") != std::string::npos || flag.rfind("texture", 0) == 0;
          flagged = flagged || motion;
          if (motion) words_.insert(flag);
        }
        (painted ? n.paint : n.highlights) += 1;
        (painted ? n.paintFlagged : n.highlightsFlagged) += flagged;
      }
      for (const Json& r : frames[f]["rejected"]) {
        const std::string reason = r["reason"];
        if (reason.rfind("texture", 0) != 0) continue;
        words_.insert(reason);
        (isPaint(ballUnder(poses_[f], r["place"][0], r["place"][1])) ? n.rejectedPaint : n.rejectedOther) += 1;
      }
    }
    return n;
  }

  TemporaryFolder folder_;
  std::vector<Eigen::Isometry3d> poses_;
  std::set<std::string> words_;
};

TEST_F(TextureTest, NominalPaintIsRejectedFlaggedOrLeftAsAsked) {
  make(8, 120);
  const Count off = detect("--set detect.motion=off");
  EXPECT_EQ(off.highlights, 8);
  EXPECT_GE(off.paint, 12);  // of 16: some have grown together with the highlight, or lie edge-on
  EXPECT_EQ(off.paintFlagged + off.highlightsFlagged + off.rejectedPaint + off.rejectedOther, 0);

  const Count rejected = detect("");
  EXPECT_EQ(rejected.highlights, 8);
  EXPECT_EQ(rejected.rejectedOther, 0);
  EXPECT_GE(rejected.rejectedPaint, off.paint - 1);
  EXPECT_EQ(rejected.rejectedPaint + rejected.paint, off.paint);
  ASSERT_FALSE(words_.empty());
  EXPECT_THAT(*words_.begin(), StartsWith("texture: it stays on the surface in "));

  const Count flagged = detect("--set detect.motion=flag");
  EXPECT_EQ(flagged.highlights, 8);
  EXPECT_EQ(flagged.paint, off.paint);
  EXPECT_EQ(flagged.paintFlagged, rejected.rejectedPaint);
  EXPECT_EQ(flagged.highlightsFlagged + flagged.rejectedPaint + flagged.rejectedOther, 0);
}

/// Frames whose surface is their own depth map answer where other depth maps have the same point.
TEST_F(TextureTest, NominalOwnDepthMapsThatAgreeAreAsked) {
  make(8, 120);
  const Count off = detect("--set detect.motion=off");
  useDepth(0);
  const Count rejected = detect("");
  EXPECT_EQ(rejected.highlights, 8);
  EXPECT_EQ(rejected.rejectedOther, 0);
  EXPECT_GE(rejected.rejectedPaint, off.paint - 2);  // two may lie where the depth maps end
  // A model is fitted to the same evidence.
  const ProgramRun run = runGlint("evaluate " + inQuotes(folder_ / "scene") +
                                  " --models limit-angle --train spread:4 --set fit.most_residual=0.5 --json -");
  EXPECT_THAT(run.out + run.err, HasSubstr("no evidence (texture, detect.motion)"));
}

/// The ball is 4 % farther away in each next frame: no depth map has a point of another.
TEST_F(TextureTest, DegenerateDepthMapsThatDisagreeAreSaidByName) {
  make(6, 120);
  useDepth(0.04);
  const Count apart = detect("");
  EXPECT_EQ(apart.rejectedPaint + apart.rejectedOther, 0);
  EXPECT_GT(apart.paintFlagged, 0);
  ASSERT_FALSE(words_.empty());
  EXPECT_THAT(*words_.begin(), HasSubstr("this frame's own depth map"));
}

/// Two views: the spot that stays may be either, and one that leaves is a highlight.
TEST_F(TextureTest, DegenerateTooFewViewsAreSaidInWords) {
  make(2, 40);
  const Count few = detect("");
  EXPECT_EQ(few.rejectedPaint + few.rejectedOther, 0);
  EXPECT_EQ(few.highlights, 2);
  EXPECT_EQ(few.highlightsFlagged, 0);
  EXPECT_GE(few.paint, 3);
  EXPECT_EQ(few.paintFlagged, few.paint);
  ASSERT_FALSE(words_.empty());
  EXPECT_THAT(*words_.begin(), HasSubstr("the only other view"));
  // Eight views from nearly one place.
  make(8, 3);
  const Count close = detect("");
  EXPECT_EQ(close.rejectedPaint + close.rejectedOther, 0);
  EXPECT_GE(close.paintFlagged, 12);
  ASSERT_FALSE(words_.empty());
  EXPECT_THAT(*words_.begin(), HasSubstr("the views are too close"));
  // One view: no other can be asked.
  make(1, 0);
  const Count one = detect("");
  EXPECT_EQ(one.rejectedPaint + one.rejectedOther + one.paintFlagged + one.highlightsFlagged, 0);
}

}  // namespace glint::texture_tests
