// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/reconstruct_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>

#include "core/base/number_text.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint::reconstruct_boxes_tests {

Projection lookAt(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d z = (to - from).normalized(), x = z.cross(Eigen::Vector3d(0.1, 0.05, 1)).normalized();
  Eigen::Matrix3d r, k;
  r << x.transpose(), z.cross(x).transpose(), z.transpose();
  k << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  Projection p;
  p.matrix << k * r, -k * r * from;
  return p;
}
std::vector<Projection> ring(int n, double scale = 1) {
  std::vector<Projection> p;
  for (int i = 0; i < n; ++i) {
    const double a = 0.3 + 2 * std::numbers::pi * i / n;
    p.push_back(lookAt(scale * Eigen::Vector3d(2 * std::cos(a), 2 * std::sin(a), 0.9 + 0.5 * std::sin(3 * a)),
                       scale * Eigen::Vector3d(0.3, -0.2, 0.4)));
  }
  return p;
}
/// Centre (0.3, -0.2, 0.4), tilted about every axis.
Eigen::Isometry3d pose(double scale = 1) {
  Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
  t.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  t.pretranslate(scale * Eigen::Vector3d(0.3, -0.2, 0.4));
  return t;
}
const Eigen::Vector3d kLengths(0.3, 0.2, 0.12);

/// Hartley and Zisserman, result 8.9: C* = P Q* P^T, whose tangents x = u satisfy C00 - 2 u C02 + u^2 C22 = 0.
BoxView boxOfEllipsoid(const Projection& p, double scale = 1) {
  const Eigen::Matrix4d t = pose(scale).matrix();
  const Eigen::Vector3d a = scale * kLengths;
  const Eigen::Matrix3d c = p.matrix * t * Eigen::Vector4d(-a.x() * a.x(), -a.y() * a.y(), -a.z() * a.z(), 1).asDiagonal() *
                            t.transpose() * p.matrix.transpose();
  BoxView view{p, {}, {}, {0, 0}, true};
  for (int i = 0; i < 2; ++i) {
    const double middle = c(i, 2) / c(2, 2), half = std::sqrt(middle * middle - c(i, i) / c(2, 2));
    view.low[i] = middle - half;
    view.high[i] = middle + half;
  }
  return view;
}
BoxView boxOfCuboid(const Projection& p, double scale = 1) {
  BoxView view{p, {1e9, 1e9}, {-1e9, -1e9}, {0, 0}, true};
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Pixel at = p.project(pose(scale) * (scale * kLengths.cwiseProduct(sign)).eval());
    view.low = view.low.cwiseMin(at);
    view.high = view.high.cwiseMax(at);
  }
  return view;
}
std::vector<BoxView> boxes(BoxSolid solid, int n, double scale = 1) {
  std::vector<BoxView> views;
  for (const Projection& p : ring(n, scale))
    views.push_back(solid == BoxSolid::Cuboid ? boxOfCuboid(p, scale) : boxOfEllipsoid(p, scale));
  return views;
}
/// Relative error of centre, lengths and axes against the truth.
double error(const SolidFit& fit, double scale = 1) {
  double worst = (fit.ellipsoid.centre() - pose(scale).translation()).norm() / scale;
  worst = std::max(worst, (fit.halfEdges / scale - kLengths).norm());
  for (int i = 0; i < 3; ++i)
    worst = std::max(worst, fit.ellipsoid.worldFromBody().linear().col(i).cross(pose().linear().col(i)).norm());
  return worst;
}
std::optional<Reason> reasonOf(const Outcome<BoxReconstruction>& r) {
  return r ? std::nullopt : std::optional(r.failure().reason);
}
bool mentions(const BoxReconstruction& r, const std::string& words) {
  return std::any_of(r.remarks.begin(), r.remarks.end(),
                     [&](const std::string& t) { return t.find(words) != std::string::npos; });
}

// Mean over the sphere by a product of a fine midpoint rule in z and in longitude: the normal equations of the least squares hold
// at the ellipsoid of the closed form.
TEST(EqCuboid, IsTheNearestInSquaredSupportOverAllDirections) {
  const Eigen::Vector3d a(0.4, 1.0, 2.5), m = ellipsoidOfCuboid(a);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double scale = 0;
  const int n = 1200;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double z = (2 * (i + 0.5)) / n - 1, t = 2 * std::numbers::pi * (j + 0.5) / n, r = std::sqrt(1 - z * z);
      const Eigen::Vector3d d(r * std::cos(t), r * std::sin(t), z);
      const double cuboid = std::pow(a.dot(d.cwiseAbs()), 2), ellipsoid = m.cwiseProduct(d).squaredNorm();
      moment += (ellipsoid - cuboid) * d.cwiseAbs2();
      scale += cuboid;
    }
  EXPECT_LT(moment.cwiseAbs().maxCoeff() / scale, 1e-5);  // second order of the step
  EXPECT_NEAR(ellipsoidOfCuboid({1, 1, 1}).x(), std::sqrt(1 + 4 / std::numbers::pi), tolerance::kExact);
}

TEST(ReconstructFromBoxes, NominalFindsTheSolidAndWhichItIs) {
  for (const BoxSolid solid : {BoxSolid::Ellipsoid, BoxSolid::Cuboid})
    for (const int n : {3, 5, 12}) {
      const auto r = reconstructFromBoxes(boxes(solid, n));
      ASSERT_TRUE(r) << r.failure().message();
      EXPECT_EQ(r->best.solid, solid) << n;
      EXPECT_LT(error(r->best), tolerance::kSolve) << nameOf(solid) << " " << n;
      EXPECT_LT(r->best.rmsPx, tolerance::kPixel);
      EXPECT_EQ(r->sides, 4 * n);
      ASSERT_TRUE(r->other) << n;
      EXPECT_GT(r->other->rmsPx, n == 3 ? 0.1 : 1.0) << nameOf(solid) << " " << n;  // of a highlight of 150 px
    }
}

TEST(ReconstructFromBoxes, ScaleOfTheWorldDoesNotMatter) {
  for (const double scale : {1e-3, 1e3})
    for (const BoxSolid solid : {BoxSolid::Ellipsoid, BoxSolid::Cuboid}) {
      auto views = boxes(solid, 5, scale);
      views[1].projection.matrix *= -1e4;  // a projection has no scale and no sign
      const auto r = reconstructFromBoxes(views);
      ASSERT_TRUE(r) << r.failure().message();
      EXPECT_EQ(r->best.solid, solid) << scale;
      EXPECT_LT(error(r->best, scale), tolerance::kSolve) << scale;
    }
}

// Measured, 40 sets each, 8 views, 0.5 px per side, object of 0.3 m at 2 m: median centre error 0.60 mm of either; mean of d^T
// C^-1 d (3 were ideal) 2.9 of the ellipsoid, 2.8 of the cuboid; the solid is right every time.
TEST(ReconstructFromBoxes, Noise) {
  for (const BoxSolid solid : {BoxSolid::Ellipsoid, BoxSolid::Cuboid}) {
    std::vector<double> off;
    double squares = 0;
    for (unsigned seed = 0; seed < 40; ++seed) {
      std::mt19937 rng(seed);
      std::normal_distribution<double> g(0, 0.5);
      auto views = boxes(solid, 8);
      for (BoxView& v : views) {
        v.low += Pixel(g(rng), g(rng));
        v.high += Pixel(g(rng), g(rng));
      }
      const auto r = reconstructFromBoxes(views);
      ASSERT_TRUE(r) << r.failure().message();
      EXPECT_EQ(r->best.solid, solid) << seed;
      const Eigen::Vector3d d = r->best.ellipsoid.centre() - pose().translation();
      off.push_back(d.norm());
      ASSERT_TRUE(r->best.centreCovariance);
      squares += d.dot(r->best.centreCovariance->inverse() * d) / 40;
    }
    std::sort(off.begin(), off.end());
    std::cout << nameOf(solid) << " median " << off[20] << " m, mean squared sigmas " << squares << "\n";
    EXPECT_LT(off[20], 0.0012) << nameOf(solid);
    EXPECT_GT(squares, 2) << nameOf(solid);
    EXPECT_LT(squares, 5) << nameOf(solid);
  }
}

TEST(ReconstructFromBoxes, DegenerateViewsAreNamed) {
  auto views = boxes(BoxSolid::Ellipsoid, 5);
  EXPECT_EQ(reasonOf(reconstructFromBoxes({views[0], views[1]})), Reason::TooFewViews);
  EXPECT_EQ(reasonOf(reconstructFromBoxes({views[0], views[1], views[0], views[1]})), Reason::RankDeficient);
  std::vector<BoxView> shared;
  for (const Eigen::Vector3d& to :
       {Eigen::Vector3d(0.3, -0.2, 0.4), Eigen::Vector3d(0.5, 0, 0.4), Eigen::Vector3d(0.2, -0.3, 0.5)})
    shared.push_back(boxOfEllipsoid(lookAt({2, 0, 1}, to)));
  EXPECT_EQ(reasonOf(reconstructFromBoxes(shared)), Reason::RankDeficient);
  views[2].high.x() = NAN;
  EXPECT_EQ(reasonOf(reconstructFromBoxes(views)), Reason::NotFinite);
  views[2].visible = false;  // what is not seen is not read
  EXPECT_TRUE(reconstructFromBoxes(views));
  views[2] = views[1];
  views[2].high.y() = views[2].low.y();
  EXPECT_EQ(reasonOf(reconstructFromBoxes(views)), Reason::NotAnEllipse);
  // Cameras that look away: the rays meet behind them.
  std::vector<BoxView> away = boxes(BoxSolid::Ellipsoid, 5);
  for (BoxView& v : away) {
    Eigen::Matrix3d turn = Eigen::Vector3d(-1, 1, -1).asDiagonal();  // about y: right-handed still
    const Eigen::Matrix3d k{{800, 0, 320}, {0, 800, 240}, {0, 0, 1}};
    v.projection.matrix = k * turn * k.inverse() * v.projection.matrix;
    const double low = 640 - v.high.x(), high = 640 - v.low.x();
    v.low = {640 - high, 480 - v.high.y()};
    v.high = {640 - low, 480 - v.low.y()};
  }
  EXPECT_EQ(reasonOf(reconstructFromBoxes(away)), Reason::BehindCamera);
}

TEST(ReconstructFromBoxes, SidesAtTheBorderAreLeftOut) {
  auto views = boxes(BoxSolid::Cuboid, 5);
  for (BoxView& v : views) v.imageSize = {640, 480};
  views[0].low.x() = 0;       // cut by the left border
  views[3].high.y() = 480.0;  // by the lower one; some detectors count corners
  const auto r = reconstructFromBoxes(views);
  ASSERT_TRUE(r) << r.failure().message();
  EXPECT_EQ(r->sides, 18);
  EXPECT_LT(error(r->best), tolerance::kSolve);
  for (BoxView& v : views) v.low = {0, 0};
  EXPECT_EQ(reconstructFromBoxes(views)->sides, 9);
  EXPECT_TRUE(mentions(*reconstructFromBoxes(views), "nine sides"));
  for (BoxView& v : views) v.high = {639, 479};
  EXPECT_EQ(reasonOf(reconstructFromBoxes(views)), Reason::TooFewViews);
}

TEST(ReconstructFromBoxes, WhatIsDoubtfulIsSaid) {
  auto views = boxes(BoxSolid::Ellipsoid, 12);
  EXPECT_TRUE(reconstructFromBoxes(views)->remarks.empty());
  views[4].high.x() -= 15;  // something stands before the object's right end
  const auto occluded = reconstructFromBoxes(views);
  ASSERT_TRUE(occluded);
  EXPECT_TRUE(mentions(*occluded, "the right side of view 4"));
  // Boxes so rough that either solid will do.
  std::mt19937 rng(7);
  std::normal_distribution<double> g(0, 12);
  views = boxes(BoxSolid::Ellipsoid, 8);
  for (BoxView& v : views) {
    v.low += Pixel(g(rng), g(rng));
    v.high += Pixel(g(rng), g(rng));
  }
  const auto rough = reconstructFromBoxes(views);
  ASSERT_TRUE(rough);
  EXPECT_TRUE(mentions(*rough, "hardly tell"));
}

std::vector<std::vector<std::string>> table(const std::string& name, char separator) {
  std::ifstream in(std::string(GLINT_SHARED_DIR) + "/data/lfd_aldoma/" + name);
  EXPECT_TRUE(in) << name;
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::stringstream fields(line);
    rows.emplace_back();
    for (std::string f; std::getline(fields, f, separator);) rows.back().push_back(f);
  }
  return rows;
}

/// Intersection over union of two ellipsoids on a grid.
double iou(const Ellipsoid& a, const Ellipsoid& b) {
  const Eigen::Matrix3d wa = a.shape().inverse(), wb = b.shape().inverse();
  const double reach = std::max(a.semiAxes().x(), b.semiAxes().x()) + (a.centre() - b.centre()).norm();
  int both = 0, either = 0;
  const int n = 100;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Eigen::Vector3d x = a.centre() + reach * (2 * (Eigen::Vector3d(i, j, k).array() + 0.5) / n - 1).matrix();
        const bool inA = (x - a.centre()).dot(wa * (x - a.centre())) <= 1, inB = (x - b.centre()).dot(wb * (x - b.centre())) <= 1;
        both += inA && inB;
        either += inA || inB;
      }
  return double(both) / either;
}

/// What the file says of an object: the given ellipsoid, and the published code's figures.
struct Published {
  Ellipsoid truth;
  double iou = 0, centre = 0;
};
Published published(int object) {
  Published p{Ellipsoid(Eigen::Isometry3d::Identity(), {1, 1, 1}), 0, 0};
  for (const auto& row : table("ellipsoids.csv", ',')) {
    if (row[0] != std::to_string(object)) continue;
    if (row[1] == "gt") {
      DualQuadric q;  // scaled to (3,3) = -1 there
      std::stringstream numbers(row[10]);
      for (int i = 0; i < 16; ++i) numbers >> q.matrix(i / 4, i % 4);
      const auto e = Ellipsoid::fromDual(q);
      EXPECT_TRUE(e);
      if (e) p.truth = *e;
    } else {
      p.iou = numberFrom(row[8]).value();
      p.centre = numberFrom(row[9]).value();
    }
  }
  return p;
}
std::vector<BoxView> realBoxes(int object) {
  const auto k = table("K.txt", ' '), poses = table("poses.txt", ' '), rows = table("bounding_boxes.txt", ' ');
  std::vector<BoxView> views;
  for (std::size_t f = 0; f < rows.size(); ++f) {
    Eigen::Matrix3d intrinsics;
    Eigen::Matrix<double, 3, 4> rt;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        if (j < 3) intrinsics(Eigen::Index(i), Eigen::Index(j)) = numberFrom(k[i][j]).value();
        rt(Eigen::Index(i), Eigen::Index(j)) = numberFrom(poses[3 * f + i][j]).value();
      }
    double b[4];
    for (int i = 0; i < 4; ++i) b[i] = numberFrom(rows[f][std::size_t(4 * object + i)]).value();
    views.push_back({{intrinsics * rt}, {b[0], b[1]}, {b[2], b[3]}, {640, 480}, true});  // visibility.npy: all seen
  }
  return views;
}

// Objects 0 to 3 are packs that lie tilted: an ellipsoid leaves 1.8 to 2.9 px of their boxes, a cuboid 0.3 to 0.6. Objects 4 and
// 5 are upright bottles; the centre of the given ellipsoids lies 14 to 16 mm below what their boxes show (4 px in every view, the
// published code's too), because those ellipsoids enclose the points of a model whose neck is narrower than its body.
TEST(ReconstructFromBoxes, RealBoxesBeatThePublishedOverlap) {
  GLINT_NEEDS_SHARED_DATA();
  for (int object = 0; object < 6; ++object) {
    const Published other = published(object);
    const auto r = reconstructFromBoxes(realBoxes(object));
    ASSERT_TRUE(r) << r.failure().message();
    ASSERT_TRUE(r->other && r->best.centreCovariance);
    const double overlap = iou(other.truth, r->best.ellipsoid),
                 centre = (other.truth.centre() - r->best.ellipsoid.centre()).norm();
    const std::string row = formatted(
        "object %d: %s, %.2f px (%s %.2f px), IoU %.3f, published %.3f, centre %.1f mm, published %.1f mm, sigma %.1f mm", object,
        nameOf(r->best.solid), r->best.rmsPx, nameOf(r->other->solid), r->other->rmsPx, overlap, other.iou, 1e3 * centre,
        1e3 * other.centre, 1e3 * std::sqrt(r->best.centreCovariance->trace()));
    std::cout << row << "\n";
    for (const std::string& remark : r->remarks) std::cout << "  remark: " << remark << "\n";
    EXPECT_EQ(r->best.solid, object < 4 ? BoxSolid::Cuboid : BoxSolid::Ellipsoid);
    EXPECT_EQ(r->sides, 32);
    EXPECT_GT(overlap, other.iou) << row;
    // What the boxes know of the centre, twice, is allowed beside the published error.
    EXPECT_LT(centre, other.centre + 2 * std::sqrt(r->best.centreCovariance->trace())) << row;
  }
}

}  // namespace glint::reconstruct_boxes_tests
