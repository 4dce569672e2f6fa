// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <sstream>

#include "core/geometry/camera.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;
using tolerance::kExact;

/// What the header promises of undistorted(), relative to max(1, |(u, v)|).
constexpr double kInverse = 1e-14;
/// A handful of operations of double precision on numbers below 2, against values of fifty digits.
constexpr double kForward = 2e-15;

constexpr double kDegree = std::numbers::pi / 180;

/// One lens of each model with all of its terms; those of VISUALSFM of either sign.
std::vector<Lens> lenses() {
  return {{LensModel::OpenCv, {-0.21, 0.07, 0.001, -0.0015, 0.01}},
          {LensModel::FullOpenCv, {0.4, -0.1, 0.002, -0.001, 0.03, 0.6, 0.05, 0.01}},
          {LensModel::SimpleRadial, {-0.2}},
          {LensModel::Radial, {-0.2, 0.06}},
          {LensModel::OpenCvFisheye, {0.05, -0.01, 0.004, -0.0008}},
          {LensModel::SimpleRadialFisheye, {-0.03}},
          {LensModel::RadialFisheye, {-0.03, 0.005}},
          {LensModel::Fov, {0.9}},
          {LensModel::ThinPrismFisheye, {0.04, -0.006, 0.002, -0.001, 0.003, -0.0005, 0.0015, -0.0025}},
          {LensModel::VisualSfm, {-0.12}},
          {LensModel::VisualSfm, {0.3}}};
}
constexpr std::size_t kFullOpenCvAt = 1, kFisheyeAt = 4, kSimpleFisheyeAt = 5, kRadialFisheyeAt = 6, kFovAt = 7, kPrismAt = 8;

std::string text(const Lens& lens, const Vector2d& point) {
  std::ostringstream out;
  out << nameOf(lens.model);
  for (const double p : lens.parameters) out << ' ' << p;
  out << " at " << point.transpose();
  return out.str();
}

TEST(LensNames, AreColmapsAndStandForOneModelEach) {
  const std::vector<std::pair<const char*, int>> expected = {{"OPENCV", 5},
                                                             {"FULL_OPENCV", 8},
                                                             {"SIMPLE_RADIAL", 1},
                                                             {"RADIAL", 2},
                                                             {"OPENCV_FISHEYE", 4},
                                                             {"SIMPLE_RADIAL_FISHEYE", 1},
                                                             {"RADIAL_FISHEYE", 2},
                                                             {"FOV", 1},
                                                             {"THIN_PRISM_FISHEYE", 8},
                                                             {"VISUALSFM", 1}};
  ASSERT_EQ(expected.size(), kLensModels.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto& [name, count] = expected[i];
    EXPECT_STREQ(nameOf(kLensModels[i]), name);
    EXPECT_EQ(lensModelNamed(name), kLensModels[i]);
    EXPECT_EQ(parameterCountOf(kLensModels[i]), count) << name;
    std::istringstream words(parametersOf(kLensModels[i]));
    int number = 0;
    for (std::string word; words >> word;) ++number;
    EXPECT_EQ(number, count) << name;
  }
  for (const char* other : {"", "opencv", "OPENCV ", "PINHOLE", "DIVISION"}) EXPECT_FALSE(lensModelNamed(other)) << other;
}

TEST(Lens, IsIdealWithoutParametersUnlessItIsAFisheye) {
  EXPECT_TRUE(Lens{}.isIdeal());
  for (const LensModel model : kLensModels) {
    const bool fisheye = std::string(nameOf(model)).find("FISHEYE") != std::string::npos;
    EXPECT_EQ((Lens{model, {}}.isIdeal()), !fisheye) << nameOf(model);
    EXPECT_FALSE((Lens{model, {1e-9}}.isIdeal())) << nameOf(model);
    const Vector2d point(0.4, -0.3);
    EXPECT_EQ((distorted({model, {}}, point) - point).norm() > 0.01, fisheye) << nameOf(model);
  }
}

struct Expected {
  std::size_t lens;
  Vector2d ideal, measured;
};
class DistortedInFiftyDigits : public testing::TestWithParam<Expected> {};

TEST_P(DistortedInFiftyDigits, BothWays) {
  const auto& [index, ideal, measured] = GetParam();
  const Lens lens = lenses()[index];
  EXPECT_LT((distorted(lens, ideal) - measured).norm(), kForward) << text(lens, ideal);
  const Outcome<Vector2d> back = undistorted(lens, measured);
  ASSERT_TRUE(back) << back.failure().message();
  // At 89 degrees tan() turns a step of round-off into 57 of its own size.
  EXPECT_LT((*back - ideal).norm(), 4 * kInverse * (1 + ideal.squaredNorm())) << text(lens, ideal);
}

// By a Python script with mpmath (fifty digits), from the formulas of COLMAP's documentation of its camera models and of NVM,
//   OPENCV, FULL_OPENCV     rad = (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3)
//                           u = x rad + 2 p1 x y + p2 (r2 + 2 x^2),  v = y rad + p1 (r2 + 2 y^2) + 2 p2 x y
//   ..._FISHEYE             t = atan(r),  (u, v) = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) (x, y) / r
//   FOV                     (u, v) = atan(2 r tan(omega / 2)) / omega (x, y) / r
//   THIN_PRISM_FISHEYE      (a, b) = t (x, y) / r,  s = a^2 + b^2,  rad = 1 + k1 s + k2 s^2 + k3 s^3 + k4 s^4
//                           u = a rad + 2 p1 a b + p2 (s + 2 a^2) + sx1 s,  v = b rad + 2 p2 a b + p1 (s + 2 b^2) + sy1 s
//   VISUALSFM               (u, v) on the ray of (x, y) with |u| (1 + r |u|^2) = |x|, by bisection
// of the doubles above.
INSTANTIATE_TEST_SUITE_P(Lens, DistortedInFiftyDigits,
                         testing::Values(Expected{0, {0.05, -0.02}, {0.04995572944719450277, -0.019981131778877800415}},
                                         Expected{0, {0.4, -0.3}, {0.37971750000000002122, -0.28481937499999998954}},
                                         Expected{0, {-0.9, 0.7}, {-0.7861830000000000386, 0.61125899999999997627}},
                                         Expected{1, {0.05, -0.02}, {0.049959087443444265663, -0.019978994977377705571}},
                                         Expected{1, {0.4, -0.3}, {0.3784649708711556936, -0.2835362281533667439}},
                                         Expected{1, {-0.9, 0.7}, {-0.6814215952546290526, 0.53158346297582254986}},
                                         Expected{2, {0.05, -0.02}, {0.049971000000000002769, -0.019988400000000000414}},
                                         Expected{2, {0.4, -0.3}, {0.3800000000000000191, -0.28499999999999998795}},
                                         Expected{2, {-0.9, 0.7}, {-0.66600000000000000744, 0.51799999999999996014}},
                                         Expected{3, {0.05, -0.02}, {0.049971025230000002769, -0.019988410092000000414}},
                                         Expected{3, {0.4, -0.3}, {0.38150000000000001926, -0.28612499999999998797}},
                                         Expected{3, {-0.9, 0.7}, {-0.7572600000000000032, 0.58897999999999995059}},
                                         Expected{4, {0.05, -0.02}, {0.049958975444698449897, -0.019983590177879379266}},
                                         Expected{4, {0.4, -0.3}, {0.37474758130789692572, -0.28106068598092266829}},
                                         Expected{4, {-0.9, 0.7}, {-0.69324152470854101385, 0.53918785255108740771}},
                                         Expected{4, {40, -30}, {1.3538940594573447885, -1.0154205445930085913}},
                                         Expected{5, {0.05, -0.02}, {0.049947413173798517465, -0.019978965269519406293}},
                                         Expected{5, {0.4, -0.3}, {0.36852600931993370127, -0.27639450698995025038}},
                                         Expected{5, {-0.9, 0.7}, {-0.65699834836974190108, 0.51099871539868810026}},
                                         Expected{5, {40, -30}, {1.1511279132225781277, -0.86334593491693359579}},
                                         Expected{6, {0.05, -0.02}, {0.049947415266173639253, -0.019978966106469455008}},
                                         Expected{6, {0.4, -0.3}, {0.36861171312691725943, -0.27645878484518791899}},
                                         Expected{6, {-0.9, 0.7}, {-0.65875782345828504652, 0.5123671960231105466}},
                                         Expected{6, {40, -30}, {1.1870066829441371541, -0.89025501220810286557}},
                                         Expected{7, {0.05, -0.02}, {0.053624436945770598641, -0.021449774778308238712}},
                                         Expected{7, {-0.9, 0.7}, {-0.73118162472342367865, 0.56869681922932947773}},
                                         Expected{7, {40, -30}, {1.3778646308240334628, -1.0333984731180250971}},
                                         Expected{8, {0.05, -0.02}, {0.049949995875327741087, -0.019980866671861872816}},
                                         Expected{8, {0.4, -0.3}, {0.37343492137257493956, -0.28010306216759769932}},
                                         Expected{8, {-0.9, 0.7}, {-0.69153165017375020704, 0.53777752081374970641}},
                                         Expected{8, {40, -30}, {1.3414602046170617598, -1.0063957756523134376}},
                                         Expected{9, {0.05, -0.02}, {0.050017418190926919764, -0.020006967276370767211}},
                                         Expected{9, {0.4, -0.3}, {0.41323057148590223794, -0.30992292861442664978}},
                                         Expected{10, {0.05, -0.02}, {0.049956613141466898568, -0.019982645256586758734}},
                                         Expected{10, {0.4, -0.3}, {0.37523438265698774229, -0.28142578699274078068}},
                                         Expected{10, {-0.9, 0.7}, {-0.72016466822827068197, 0.56012807528865492551}}));

Vector2d projectedByOpenCv(const std::vector<double>& d, const Vector2d& ideal) {
  std::vector<cv::Point2d> out;
  const std::vector<cv::Point3d> in{{ideal.x(), ideal.y(), 1.0}};
  cv::projectPoints(in, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), cv::Matx33d::eye(), d, out);
  return {out[0].x, out[0].y};
}

Vector2d fisheyeOfOpenCv(const Lens& lens, const Vector2d& ideal) {
  std::vector<cv::Point2d> out;
  const std::vector<cv::Point2d> in{{ideal.x(), ideal.y()}};
  const cv::Vec4d d(lens.parameters[0], lens.parameters[1], lens.parameters[2], lens.parameters[3]);
  cv::fisheye::distortPoints(in, out, cv::Matx33d::eye(), d);
  return {out[0].x, out[0].y};
}

TEST(Distorted, AgreesWithOpenCvsProjection) {
  for (const std::size_t i : {std::size_t(0), kFullOpenCvAt})
    for (double x = -1; x <= 1; x += 0.25)
      for (double y = -0.8; y <= 0.8; y += 0.2) {
        const Lens lens = lenses()[i];
        const std::vector<double> d(lens.parameters.begin(), lens.parameters.begin() + parameterCountOf(lens.model));
        EXPECT_LT((distorted(lens, {x, y}) - projectedByOpenCv(d, {x, y})).norm(), kExact) << text(lens, {x, y});
      }
}

TEST(Distorted, AgreesWithOpenCvsFisheye) {
  // The models with fewer terms are the same with zeros, and without any term OpenCV's is theta itself.
  std::vector<Lens> all = {lenses()[kFisheyeAt],
                           lenses()[kSimpleFisheyeAt],
                           lenses()[kRadialFisheyeAt],
                           {LensModel::OpenCvFisheye, {}},
                           {LensModel::ThinPrismFisheye, {}}};
  for (const Lens& lens : all)
    for (double x = -6; x <= 6; x += 0.75)
      for (double y = -5; y <= 5; y += 0.5) {
        const Vector2d expected = fisheyeOfOpenCv(lens, {x, y});
        EXPECT_LT((distorted(lens, {x, y}) - expected).norm(), kExact) << text(lens, {x, y});
        const Outcome<Vector2d> back = undistorted(lens, expected);
        ASSERT_TRUE(back) << text(lens, {x, y});
        EXPECT_LT((*back - Vector2d(x, y)).norm(), kExact * (1 + x * x + y * y)) << text(lens, {x, y});
      }
}

TEST(Undistorted, AgreesWithOpenCvsFisheye) {
  const Lens lens = lenses()[kFisheyeAt];
  for (double u = -0.8; u <= 0.8; u += 0.2) {
    std::vector<cv::Point2d> out;
    const std::vector<cv::Point2d> in{{u, 0.5 * u + 0.1}};
    const cv::Vec4d d(lens.parameters[0], lens.parameters[1], lens.parameters[2], lens.parameters[3]);
    cv::fisheye::undistortPoints(in, out, cv::Matx33d::eye(), d);
    const Outcome<Vector2d> x = undistorted(lens, {in[0].x, in[0].y});
    ASSERT_TRUE(x);
    EXPECT_LT((*x - Vector2d(out[0].x, out[0].y)).norm(), 1e-7) << u;  // where OpenCV stops: 1e-8 of theta
  }
}

TEST(Lens, ModelsWithFewerTermsAreTheLargeOnesWithZeros) {
  const Vector2d point(0.35, -0.6);
  const auto same = [&](const Lens& a, const Lens& b) {
    EXPECT_EQ(distorted(a, point), distorted(b, point)) << nameOf(a.model);
    EXPECT_EQ(*undistorted(a, point), *undistorted(b, point)) << nameOf(a.model);
  };
  same({LensModel::SimpleRadial, {-0.2}}, {LensModel::OpenCv, {-0.2, 0, 0, 0, 0}});
  same({LensModel::Radial, {-0.2, 0.06}}, {LensModel::OpenCv, {-0.2, 0.06, 0, 0, 0}});
  same({LensModel::SimpleRadialFisheye, {0.1}}, {LensModel::OpenCvFisheye, {0.1, 0, 0, 0}});
  same({LensModel::RadialFisheye, {0.1, 0.02}}, {LensModel::OpenCvFisheye, {0.1, 0.02, 0, 0}});
}

/// Radius up to which the lenses above are of one branch, as ideal points: polynomials to 45 degrees, fisheyes to 89.
double widestOf(const Lens& lens) {
  switch (lens.model) {
    case LensModel::OpenCvFisheye:
    case LensModel::SimpleRadialFisheye:
    case LensModel::RadialFisheye:
    case LensModel::Fov:
    case LensModel::ThinPrismFisheye: return std::tan(89 * kDegree);
    case LensModel::VisualSfm: return lens.parameters[0] < 0 ? 1.0 : 30.0;  // it folds at (2/3) sqrt(1 / 0.36) = 1.11
    case LensModel::FullOpenCv: return 3.0;
    default: return 1.0;
  }
}

TEST(Undistorted, GoesBackOverTheWholeImage) {
  for (const Lens& lens : lenses()) {
    double worst = 0;
    for (int ring = 0; ring <= 60; ++ring)
      for (int i = 0; i < 24; ++i) {
        const double r = std::tan(std::atan(widestOf(lens)) * ring / 60), angle = 2 * std::numbers::pi * (i + 0.37) / 24;
        const Vector2d ideal(r * std::cos(angle), r * std::sin(angle)), measured = distorted(lens, ideal);
        ASSERT_TRUE(measured.allFinite());
        const Outcome<Vector2d> back = undistorted(lens, measured);
        ASSERT_TRUE(back) << text(lens, ideal) << ": " << back.failure().message();
        worst = std::max(worst, (distorted(lens, *back) - measured).norm() / std::max(1.0, measured.norm()));
        // It is the point itself, not another one that looks the same: a branch would be far away.
        EXPECT_LT((*back - ideal).norm(), 1e-10 * (1 + ideal.squaredNorm())) << text(lens, ideal);
      }
    EXPECT_LE(worst, kInverse) << nameOf(lens.model);
  }
}

TEST(Undistorted, KeepsTheCentreAndItsSurroundings) {
  const double tiny = 1e-200;
  for (const Lens& lens : lenses()) {
    EXPECT_EQ(distorted(lens, {0, 0}), Vector2d(0, 0)) << nameOf(lens.model);
    EXPECT_EQ(*undistorted(lens, {0, 0}), Vector2d(0, 0)) << nameOf(lens.model);
    // Every model's slope at the centre is 1, but FOV's: 2 tan(omega / 2) / omega.
    const double slope = lens.model == LensModel::Fov ? 2 * std::tan(0.45) / 0.9 : 1;
    const Vector2d near = distorted(lens, {tiny, -2 * tiny});
    EXPECT_NEAR(near.x() / tiny, slope, kExact) << nameOf(lens.model);
    EXPECT_NEAR(near.y() / tiny, -2 * slope, kExact) << nameOf(lens.model);
    const Outcome<Vector2d> back = undistorted(lens, {tiny, -2 * tiny});
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->x() / tiny, 1 / slope, kExact) << nameOf(lens.model);
  }
}

/// Noise of size e moves the answer by e over the slope of the lens, here by differences of distorted().
TEST(Undistorted, NoiseGrowsAsTheSlopeSays) {
  constexpr double kNoise = 1e-6;
  for (const Lens& lens : lenses()) {
    const Vector2d ideal(0.5, 0.3), measured = distorted(lens, ideal);
    Eigen::Matrix2d slope;
    for (int k = 0; k < 2; ++k)
      slope.col(k) =
          (distorted(lens, ideal + 1e-5 * Vector2d::Unit(k)) - distorted(lens, ideal - 1e-5 * Vector2d::Unit(k))) / 2e-5;
    for (int i = 0; i < 16; ++i) {
      const Vector2d noise = kNoise * Vector2d(std::cos(i * 0.4), std::sin(i * 0.4));
      const Vector2d expected = ideal + slope.inverse() * noise;
      EXPECT_LT((*undistorted(lens, measured + noise) - expected).norm(), 1e-11) << text(lens, ideal);  // second order in noise
    }
  }
}

// 1 + 3 k r^2 = 0 at r = sqrt(1 / 0.9), where k = -0.3 measures (2/3) sqrt(1 / 0.9) = 0.702728...; the same of theta.
TEST(Undistorted, SaysWhereABarrelFolds) {
  const double fold = 2.0 / 3 * std::sqrt(1 / 0.9);
  for (const LensModel model :
       {LensModel::OpenCv, LensModel::SimpleRadial, LensModel::Radial, LensModel::FullOpenCv, LensModel::OpenCvFisheye,
        LensModel::SimpleRadialFisheye, LensModel::RadialFisheye, LensModel::ThinPrismFisheye}) {
    const Lens lens{model, {-0.3}};
    for (const double direction : {0.0, 1.1, -2.5}) {
      const Vector2d along(std::cos(direction), std::sin(direction));
      EXPECT_TRUE(undistorted(lens, (fold - 1e-6) * along)) << nameOf(model);
      const Outcome<Vector2d> beyond = undistorted(lens, (fold + 1e-6) * along);
      ASSERT_FALSE(beyond) << nameOf(model);
      EXPECT_EQ(beyond.failure().reason, Reason::NotConverged) << nameOf(model);
      EXPECT_THAT(beyond.failure().detail, HasSubstr("folds back"));
    }
  }
}

// k_n alone: 1 + (2 n + 1) k_n theta^(2 n) = 0 at theta = 1 for k_n = -1 / (2 n + 1), where 1 + k_n is measured.
TEST(Undistorted, EveryTermOfAFisheyeFoldsWhereItsSlopeIsZero) {
  for (std::size_t n = 1; n <= 4; ++n) {
    Lens lens{LensModel::OpenCvFisheye, {}};
    lens.parameters[n - 1] = -1.0 / (2 * double(n) + 1);
    const double fold = 1 + lens.parameters[n - 1];
    const Outcome<Vector2d> before = undistorted(lens, {0, -(fold - 1e-9)});
    ASSERT_TRUE(before) << n;
    EXPECT_NEAR(std::atan(before->norm()), 1, 1e-4) << n;  // the root of 1e-9
    EXPECT_FALSE(undistorted(lens, {0, -(fold + 1e-9)})) << n;
  }
}

// Slope (1 - z / 0.5) (1 - z / 1.5), z = theta^2: k1 = -8/9, k2 = 4/15. It rises to 0.43997 at theta = 0.7071, falls, and rises
// again to 0.525 at theta = 1.5, so 0.5 is measured, but on another branch.
TEST(Undistorted, AFisheyesSecondBranchIsNoAnswer) {
  for (const LensModel model : {LensModel::RadialFisheye, LensModel::OpenCvFisheye, LensModel::ThinPrismFisheye}) {
    const Lens lens{model, {-8.0 / 9, 4.0 / 15}};
    ASSERT_NEAR(distorted(lens, {std::tan(1.5), 0}).x(), 0.525, kExact);
    const Outcome<Vector2d> other = undistorted(lens, {0.5, 0});
    ASSERT_FALSE(other) << nameOf(model);
    EXPECT_EQ(other.failure().reason, Reason::NotConverged);
    const Outcome<Vector2d> first = undistorted(lens, {0, -0.43});
    ASSERT_TRUE(first) << nameOf(model);
    EXPECT_LT(std::atan(first->norm()), std::sqrt(0.5));
    EXPECT_NEAR(distorted(lens, *first).y(), -0.43, kInverse);
  }
}

// x / (1 - x^2) = 3: x = (sqrt(37) - 1) / 6; the other root, -1.18, lies beyond the pole.
TEST(Undistorted, ARationalLensAnswersBeforeItsPole) {
  const Lens lens{LensModel::FullOpenCv, {0, 0, 0, 0, 0, -1, 0, 0}};
  const Outcome<Vector2d> x = undistorted(lens, {3, 0});
  ASSERT_TRUE(x) << x.failure().message();
  EXPECT_NEAR(x->x(), (std::sqrt(37.0) - 1) / 6, kExact);
  EXPECT_NEAR(x->y(), 0, kExact);
}

// The term of NVM: x = u (1 + r |u|^2). With r = 0.3 (0.6, 0) is (0.6 (1 + 0.108), 0). For r = -0.12 it folds at
// |u| = sqrt(1 / (3 * 0.12)) = 5/3, where |x| = 10/9.
TEST(VisualSfm, UndistortsByItsFormula) {
  EXPECT_NEAR(undistorted({LensModel::VisualSfm, {0.3}}, {0.6, 0})->x(), 0.6648, kExact);
  const Lens lens{LensModel::VisualSfm, {-0.12}};
  EXPECT_TRUE(undistorted(lens, {1.6666, 0}));
  const Outcome<Vector2d> beyond = undistorted(lens, {1.6667, 0});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.failure().reason, Reason::NotConverged);
  EXPECT_NEAR(distorted(lens, {0, 10.0 / 9 - 1e-12}).y(), 5.0 / 3, 1e-5);  // the root of 1e-12, times its factor
  EXPECT_FALSE(distorted(lens, {0, 10.0 / 9 + 1e-9}).allFinite());
}

// Beyond a pole a rational lens may show everything again, turned about. The denominators here first vanish at r^2 near
// 1 / 1849.7 and 1 / 8238.2; the points are such that a search by samples finds an answer at 485 and 260.
TEST(Undistorted, ARationalLensDoesNotJumpOverItsPole) {
  struct Row {
    Lens lens;
    double u, pole;
  };
  for (const Row& row :
       {Row{{LensModel::FullOpenCv, {0, -0.888297, 0, 0, -4.36978, -1849.66589, 40.9980525, -44.948237}}, -47.1257353, 0.0233},
        Row{{LensModel::FullOpenCv, {0, 0, 0, 0, -1557.93, -8238.21838, -0.683153074, 41.8846359}}, -9684.75574, 0.0111}}) {
    const Outcome<Vector2d> x = undistorted(row.lens, {row.u, 0});
    if (!x) continue;  // named: the pole is steep
    EXPECT_LT(x->norm(), row.pole);
    EXPECT_LT(x->x(), 0);
  }
}

struct Wide {
  const char* name;
  Lens lens;
  double radius;
  const char* says;
};
class SeenBeyondARightAngle : public testing::TestWithParam<Wide> {};

TEST_P(SeenBeyondARightAngle, IsRefusedWithItsAngle) {
  const Outcome<Vector2d> x = undistorted(GetParam().lens, GetParam().radius * Vector2d(0.6, -0.8));
  ASSERT_FALSE(x) << GetParam().name;
  EXPECT_EQ(x.failure().reason, Reason::OutsideImage) << GetParam().name;
  EXPECT_EQ(x.failure().detail,
            "is seen " + std::string(GetParam().says) + " degrees from the optical axis; only less than 90 are supported");
}

// 93 degrees are 1.6231562 rad; with k1 = 0.1 they are measured at 1.6231562 (1 + 0.1 * 1.6231562^2) = 2.0507988.
// FOV with omega 1: the angle whose tangent is tan(1.6) / (2 tan(0.5)), continued: 90 + atan(0.0319035 / 0.9995736) degrees.
INSTANTIATE_TEST_SUITE_P(Lens, SeenBeyondARightAngle,
                         testing::Values(Wide{"fisheye", {LensModel::OpenCvFisheye, {}}, 93 * kDegree, "93"},
                                         Wide{"one term", {LensModel::SimpleRadialFisheye, {0.1}}, 2.0507988, "93"},
                                         Wide{"two terms", {LensModel::RadialFisheye, {}}, 179 * kDegree, "179"},
                                         Wide{"thin prism", {LensModel::ThinPrismFisheye, {}}, 120 * kDegree, "120"},
                                         Wide{"field of view", {LensModel::Fov, {1}}, 1.6, "91.83"}));

TEST(Undistorted, JustBelowARightAngleIsSeen) {
  for (const LensModel model : {LensModel::OpenCvFisheye, LensModel::ThinPrismFisheye}) {
    const Outcome<Vector2d> x = undistorted({model, {}}, {0, 89.999 * kDegree});
    ASSERT_TRUE(x) << nameOf(model);
    // Round-off of the angle, 1e-16, over that of 0.001 degree to the right angle.
    EXPECT_NEAR(x->y() / std::tan(89.999 * kDegree), 1, 1e-10) << nameOf(model);
    EXPECT_FALSE(undistorted({model, {}}, {0, 90.001 * kDegree})) << nameOf(model);
  }
}

TEST(Undistorted, NothingIsSeenBeyondAHalfTurn) {
  for (const Lens& lens :
       {Lens{LensModel::OpenCvFisheye, {}}, Lens{LensModel::ThinPrismFisheye, {}}, Lens{LensModel::Fov, {1}}}) {
    const Outcome<Vector2d> x = undistorted(lens, {3.2, 0});
    ASSERT_FALSE(x) << nameOf(lens.model);
    EXPECT_EQ(x.failure().reason, Reason::OutsideImage) << nameOf(lens.model);
    EXPECT_THAT(x.failure().detail, HasSubstr("beyond 180 degrees")) << nameOf(lens.model);
  }
}

// By the same script of fifty digits. As omega goes to 0 the model goes to the identity, and r omega decides how fast.
TEST(Fov, IsStableAsOmegaVanishes) {
  struct Row {
    double omega;
    Vector2d ideal, measured;
  };
  for (const double sign : {1.0, -1.0})  // the formula is even in omega
    for (const Row& row :
         {Row{1e-3, {40, -30}, {39.966719902575322318, -29.975039926931491738}}, Row{1e-8, {0.4, -0.3}, {0.4, -0.3}},
          Row{1e-8, {40, -30}, {39.999999999996667, -29.99999999999750025}}, Row{1e-100, {40, -30}, {40, -30}},
          Row{std::numeric_limits<double>::denorm_min(), {40, -30}, {40, -30}}, Row{0, {40, -30}, {40, -30}}}) {
      const Lens lens{LensModel::Fov, {sign * row.omega}};
      EXPECT_LT((distorted(lens, row.ideal) - row.measured).norm(), 1e-15 * 50) << row.omega;  // relative to its length
      const Outcome<Vector2d> back = undistorted(lens, row.measured);
      ASSERT_TRUE(back) << row.omega;
      EXPECT_LT((*back - row.ideal).norm(), 1e-15 * 100) << row.omega;
    }
}

TEST(Fov, WithoutAFieldOfViewShowsNothing) {
  for (const double omega : {std::numbers::pi, 4.0, -3.5, 1e15, std::numeric_limits<double>::quiet_NaN()}) {
    const Lens lens{LensModel::Fov, {omega}};
    EXPECT_FALSE(distorted(lens, {0.1, 0.2}).allFinite()) << omega;
    const Outcome<Vector2d> x = undistorted(lens, {0.1, 0.2});
    ASSERT_FALSE(x) << omega;
    EXPECT_EQ(x.failure().reason, Reason::NotConverged) << omega;
  }
}

/// Whatever the parameters: a finite answer that is measured where it was asked for, or a named failure.
TEST(Undistorted, NoParametersBreakIt) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> sizes = {1, 1e15, -1e15, 1e300, -1e300, 1e-320, inf, -inf, nan};
  int answers = 0;
  for (const LensModel model : kLensModels)
    for (const double size : sizes)
      for (unsigned which = 1; which < 1u << parameterCountOf(model); ++which) {
        Lens lens{model, {}};
        for (int i = 0; i < parameterCountOf(model); ++i)
          if (which >> i & 1) lens.parameters[std::size_t(i)] = i % 2 ? -size : size;
        for (const double r : {0.0, 1e-300, 1e-9, 0.3, 2.0, 1e9, 1e200}) {
          const Outcome<Vector2d> x = undistorted(lens, {0.6 * r, -0.8 * r});
          if (!x) {
            EXPECT_TRUE(x.failure().reason == Reason::NotConverged || x.failure().reason == Reason::OutsideImage);
            continue;
          }
          ++answers;
          ASSERT_TRUE(x->allFinite()) << text(lens, {r, 0});
          if (model == LensModel::VisualSfm) continue;  // its undistorted() is the definition
          // From a fisheye's angle to (x, y) and back costs round-off of the angle, which its terms multiply: up to 1.6^9 of
          // their size.
          const bool fisheye = std::string(nameOf(model)).find("FISHEYE") != std::string::npos;
          const double terms = fisheye ? 100 * std::numeric_limits<double>::epsilon() * std::abs(size) : 0;
          const Vector2d off = distorted(lens, *x) - Vector2d(0.6 * r, -0.8 * r);
          EXPECT_LE(off.lpNorm<Eigen::Infinity>(), 2 * kInverse * std::max(1.0, r) + terms) << text(lens, {r, 0});
        }
      }
  EXPECT_GT(answers, 1000);
}

TEST(Undistorted, NotFiniteIsNamed) {
  for (const LensModel model : kLensModels)
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      const Outcome<Vector2d> x = undistorted({model, {0.1}}, {bad, 0.1});
      ASSERT_FALSE(x) << nameOf(model);
      EXPECT_EQ(x.failure().reason, Reason::NotFinite) << nameOf(model);
    }
}

// K = [500 0 640; 0 500 480; 0 0 1], an ideal fisheye: 60 degrees to the right are measured at 640 + 500 * 1.0471976 and are
// ideally at 640 + 500 sqrt(3).
TEST(CameraWithAFisheye, MeasuresAnglesInPixels) {
  Camera c;
  c.pixelFromRay << 500, 0, 640, 0, 500, 480, 0, 0, 1;
  c.width = 1280;
  c.height = 960;
  c.lens.model = LensModel::OpenCvFisheye;
  ASSERT_TRUE(c.hasDistortion());
  const Pixel ideal(640 + 500 * std::sqrt(3.0), 480), measured(640 + 500 * std::numbers::pi / 3, 480);
  EXPECT_LT((c.distorted(ideal) - measured).norm(), 1e-9);
  EXPECT_LT((*withoutDistortion(c, measured) - ideal).norm(), 1e-9);
  const Pixel behind(640 + 500 * 1.6, 480);
  const Outcome<Pixel> none = withoutDistortion(c, behind);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::OutsideImage);
  EXPECT_FALSE(c.undistorted(behind).allFinite());
}

}  // namespace
}  // namespace glint
