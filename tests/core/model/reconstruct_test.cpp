// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/reconstruct.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "core/geometry/plane.h"
#include "core/model/fit_ellipsoid.h"
#include "core/model/reconstruct_detail.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint {
namespace {
Camera lookAt(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double scale = 1) {
  Camera c;
  c.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  const Eigen::Vector3d z = (to - from).normalized(), x = z.cross(Eigen::Vector3d(0.1, 0.05, 1)).normalized(), y = z.cross(x);
  Eigen::Matrix3d r;
  r << x.transpose(), y.transpose(), z.transpose();
  c.camFromWorld.linear() = r;
  c.camFromWorld.translation() = -scale * (r * from);
  c.width = 640;
  c.height = 480;
  return c;
}
Ellipsoid truth(double scale = 1) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  pose.pretranslate(scale * Eigen::Vector3d(0.3, -0.2, 0.4));
  return Ellipsoid(pose, scale * Eigen::Vector3d(0.3, 0.2, 0.12));
}
std::vector<ConicView> viewsOf(const Ellipsoid& e, const std::vector<Projection>& projections) {
  std::vector<ConicView> views;
  for (const Projection& p : projections) {
    const Outcome<Ellipse> ellipse = outlineEllipse(e, p);
    EXPECT_TRUE(ellipse);
    if (ellipse) views.push_back({p, *ellipse, ellipse->sample(72)});
  }
  return views;
}
std::vector<Projection> ring(int n, double scale = 1) {
  std::vector<Projection> p;
  for (int i = 0; i < n; ++i) {
    const double a = 0.3 + 2 * std::numbers::pi * i / n;
    p.push_back(lookAt({2 * std::cos(a), 2 * std::sin(a), 0.9 + 0.5 * std::sin(3 * a)}, {0.3, -0.2, 0.4}, scale).projection());
  }
  return p;
}
/// Relative difference of centre and shape.
double difference(const Ellipsoid& a, const Ellipsoid& b) {
  const double size = b.semiAxes().x();
  return std::max((a.centre() - b.centre()).norm() / size, (a.shape() - b.shape()).norm() / (size * size));
}
void addNoise(std::vector<ConicView>& views, double sigma, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> g(0, sigma);
  for (ConicView& v : views) {
    for (Pixel& p : v.points) p += Pixel(g(rng), g(rng));
    v.ellipse = *fitEllipse(v.points);
  }
}
/// The reason of a failure; nothing if there was an answer.
std::optional<Reason> reasonOf(const Outcome<Reconstruction>& r) { return r ? std::nullopt : std::optional(r.failure().reason); }
double medianOf(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

TEST(ReconstructLinear, NominalRecoversTheEllipsoid) {
  for (const int n : {3, 6, 40}) {
    const auto r = reconstructLinear(viewsOf(truth(), ring(n)));
    ASSERT_TRUE(r) << n << " " << r.failure().message();
    ASSERT_TRUE(r->ellipsoid) << describe(r->quadric);
    EXPECT_LT(difference(*r->ellipsoid, truth()), tolerance::kSolve) << n;
    EXPECT_NEAR(r->quadric.matrix(3, 3), 1, 1e-12);
    EXPECT_LT(r->gapRatio, 1e-9);
    EXPECT_EQ(r->residualPx.size(), std::size_t(n));
    for (const double px : r->residualPx) EXPECT_LT(px, tolerance::kPixel);
    EXPECT_NE(r->brief().find(std::to_string(n) + " views, gap"), std::string::npos);
  }
}

TEST(ReconstructAnchored, NominalFromTwoViewsOn) {
  for (const int n : {2, 3, 6}) {
    const auto views = viewsOf(truth(), ring(n == 2 ? 5 : n));
    const auto r = reconstructAnchored({views.begin(), views.begin() + n}, truth().centre());
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_LT(difference(*r->ellipsoid, truth()), tolerance::kSolve) << n;
  }
}

TEST(ReconstructRefined, NominalFromAPoorStart) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.35, -0.15, 0.37;
  const auto r = reconstructRefined(viewsOf(truth(), ring(4)), Ellipsoid(pose, {0.25, 0.2, 0.2}));
  ASSERT_TRUE(r) << r.failure().message();
  EXPECT_LT(difference(*r->ellipsoid, truth()), tolerance::kSolve);
  EXPECT_GT(r->iterations, 1);
}

// Stopped on the way, where the next step is many times the ellipsoid: no answer, since round-off would decide where it lies.
TEST(ReconstructRefined, APlaceOnTheWayIsNoAnswer) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.35, -0.15, 0.37;
  const Ellipsoid start(pose, {0.012, 0.01, 0.01});  // a twentieth of the truth
  const auto views = viewsOf(truth(), ring(4));
  const auto once = reconstructRefined(views, start, {}, 1);
  ASSERT_EQ(reasonOf(once), Reason::NotConverged);
  EXPECT_NE(once.failure().detail.find("times the size of the ellipsoid"), std::string::npos) << once.failure().detail;
  const auto whole = reconstructRefined(views, start);
  ASSERT_TRUE(whole) << whole.failure().message();
  EXPECT_LT(difference(*whole->ellipsoid, truth()), tolerance::kSolve);
}

TEST(Reconstruct, ScaleGivesTheSameRelativeError) {
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    const auto views = viewsOf(truth(scale), ring(5, scale));
    const auto linear = reconstructLinear(views);
    ASSERT_TRUE(linear && linear->ellipsoid) << scale;
    EXPECT_LT(difference(*linear->ellipsoid, truth(scale)), tolerance::kSolve) << scale;
    const auto anchored = reconstructAnchored(views, truth(scale).centre());
    ASSERT_TRUE(anchored) << scale;
    EXPECT_LT(difference(*anchored->ellipsoid, truth(scale)), tolerance::kSolve) << scale;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = scale * Eigen::Vector3d(0.32, -0.2, 0.4);
    const auto refined = reconstructRefined(views, Ellipsoid(pose, scale * Eigen::Vector3d(0.25, 0.2, 0.2)));
    ASSERT_TRUE(refined) << scale << refined.failure().message();
    EXPECT_LT(difference(*refined->ellipsoid, truth(scale)), tolerance::kSolve) << scale;
  }
}

TEST(Reconstruct, ScaleOfTheImageAndOfTheProjectionsDoesNotMatter) {
  for (const double zoom : {1.0 / 16, 64.0}) {  // focal lengths 50 and 51200 px
    std::vector<Projection> projections = ring(5);
    for (Projection& p : projections) p.matrix.topRows<2>() *= zoom;
    projections[1].matrix *= 1e5;
    const auto r = reconstructLinear(viewsOf(truth(), projections));
    ASSERT_TRUE(r && r->ellipsoid);
    EXPECT_LT(difference(*r->ellipsoid, truth()), tolerance::kSolve) << zoom;
  }
}

// Measured, 200 seeds, 6 views, 72 points, 0.5 px per coordinate, object of 0.3 m at 2 m: median relative difference (of the
// longest semi-axis) linear 0.0037, anchored 0.0017 (true centre), refined 0.0018.
TEST(Reconstruct, Noise) {
  std::vector<double> linear, anchored, refined;
  for (unsigned seed = 0; seed < 200; ++seed) {
    auto views = viewsOf(truth(), ring(6));
    addNoise(views, 0.5, seed);
    const auto a = reconstructLinear(views);
    ASSERT_TRUE(a && a->ellipsoid) << seed;
    const auto b = reconstructAnchored(views, truth().centre());
    ASSERT_TRUE(b) << seed;
    const auto c = reconstructRefined(views, *a->ellipsoid);
    ASSERT_TRUE(c) << seed << c.failure().message();
    linear.push_back(difference(*a->ellipsoid, truth()));
    anchored.push_back(difference(*b->ellipsoid, truth()));
    refined.push_back(difference(*c->ellipsoid, truth()));
    double before = 0, after = 0;
    for (int i = 0; i < 6; ++i) {
      before += std::pow(a->residualPx[i], 2);
      after += std::pow(c->residualPx[i], 2);
    }
    EXPECT_LE(after, before * (1 + 1e-9)) << seed;
  }
  RecordProperty("linear", std::to_string(medianOf(linear)));
  RecordProperty("anchored", std::to_string(medianOf(anchored)));
  RecordProperty("refined", std::to_string(medianOf(refined)));
  EXPECT_LT(medianOf(linear), 0.003);
  EXPECT_LT(medianOf(anchored), 0.003);
  EXPECT_LT(medianOf(refined), 0.0025);
}

TEST(ReconstructRefined, PriorPullsTheCentre) {
  auto views = viewsOf(truth(), ring(3));
  addNoise(views, 0.5, 3);
  const CentrePrior tight{truth().centre(), 1e-12 * Eigen::Matrix3d::Identity()};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.35, -0.15, 0.37;
  const Ellipsoid start(pose, {0.25, 0.2, 0.2});
  const auto with = reconstructRefined(views, start, tight), without = reconstructRefined(views, start);
  ASSERT_TRUE(with && without);
  EXPECT_LT((with->ellipsoid->centre() - truth().centre()).norm(), 1e-6);
  EXPECT_GT((without->ellipsoid->centre() - truth().centre()).norm(), 1e-5);
  // Two views are enough with a prior.
  views.pop_back();
  EXPECT_TRUE(reconstructRefined(views, start, tight));
  EXPECT_EQ(reasonOf(reconstructRefined(views, start)), Reason::TooFewViews);
}

TEST(ReconstructRefined, FlatStartFindsItsThickness) {
  Eigen::Isometry3d pose = truth().worldFromBody();
  const auto r = reconstructRefined(viewsOf(truth(), ring(4)), Ellipsoid(pose, {0.3, 0.2, 0}));
  ASSERT_TRUE(r) << r.failure().message();
  EXPECT_LT(difference(*r->ellipsoid, truth()), tolerance::kSolve);
}

// Expected nullities: 2 views 2, 3 general views 1, 3 views of one centre 5, one camera with three tangent planes 1.
TEST(ReconstructLinear, NullitiesAreNamedOrSolved) {
  const auto two = viewsOf(truth(), ring(2));
  EXPECT_EQ(reasonOf(reconstructLinear(two)), Reason::TooFewViews);

  std::vector<Projection> shared;
  for (const Eigen::Vector3d& to :
       {Eigen::Vector3d(0.3, -0.2, 0.4), Eigen::Vector3d(0.5, 0, 0.4), Eigen::Vector3d(0.2, -0.3, 0.5)})
    shared.push_back(lookAt({2, 0, 1}, to).projection());
  const auto oneCentre = viewsOf(truth(), shared);
  EXPECT_EQ(reasonOf(reconstructLinear(oneCentre)), Reason::RankDeficient);
  EXPECT_EQ(reasonOf(reconstructLinear(oneCentre, truth().centre())), Reason::RankDeficient);
  EXPECT_EQ(reasonOf(reconstructAnchored(oneCentre, truth().centre())), Reason::RankDeficient);

  std::vector<ConicView> same(4, two[0]);
  EXPECT_EQ(reasonOf(reconstructLinear(same)), Reason::RankDeficient);
  EXPECT_EQ(reasonOf(reconstructAnchored(same, truth().centre())), Reason::RankDeficient);
  std::vector<ConicView> pairs{two[0], two[1], two[0], two[1]};
  EXPECT_EQ(reasonOf(reconstructLinear(pairs)), Reason::RankDeficient);

  // One camera, three mirrors: solvable.
  const Camera camera = lookAt({1.5, 0, 1.5}, {0, 0, 0});
  std::vector<Projection> mirrored;
  for (const Eigen::Vector3d& n : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.2, 0.1, 1), Eigen::Vector3d(-0.1, 0.25, 1)})
    mirrored.push_back(virtualCamera(camera, Plane::through({0, 0, 0}, n.normalized())));
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << -1.2, 0.1, 1.4;
  const Ellipsoid light(pose, {0.3, 0.2, 0.1});
  const auto r = reconstructLinear(viewsOf(light, mirrored));
  ASSERT_TRUE(r) << r.failure().message();
  ASSERT_TRUE(r->ellipsoid);
  EXPECT_LT(difference(*r->ellipsoid, light), tolerance::kSolve);
}

TEST(ReconstructLinear, AHyperboloidIsReturnedWithoutEllipsoid) {
  // A one-sheet hyperboloid whose outlines from these cameras are ellipses.
  Eigen::Matrix4d q = Eigen::Vector4d(-0.09, -0.04, 0.004, 1).asDiagonal();
  std::vector<ConicView> views;
  for (int i = 0; i < 5; ++i) {
    const Projection p = lookAt({0.3 * std::cos(1.3 * i), 0.3 * std::sin(1.3 * i), 2}, {0, 0, 0}).projection();
    const Outcome<Ellipse> e = toEllipse(outline({q}, p));
    ASSERT_TRUE(e);
    views.push_back({p, *e, {}});
  }
  const auto r = reconstructLinear(views);
  ASSERT_TRUE(r) << r.failure().message();
  EXPECT_FALSE(r->ellipsoid);
  EXPECT_STREQ(describe(r->quadric), "hyperboloid of one sheet");
  EXPECT_LT((r->quadric.matrix - q).norm(), 1e-8);
  EXPECT_NE(r->brief().find("hyperboloid"), std::string::npos);
}

TEST(Reconstruct, NotFiniteIsNamed) {
  const Ellipsoid start = truth();
  auto views = viewsOf(truth(), ring(4));
  views[2].ellipse.angle = NAN;
  EXPECT_EQ(reasonOf(reconstructLinear(views)), Reason::NotFinite);
  EXPECT_EQ(reasonOf(reconstructAnchored(views, start.centre())), Reason::NotFinite);
  EXPECT_EQ(reasonOf(reconstructRefined(views, start)), Reason::NotFinite);
  views = viewsOf(truth(), ring(4));
  views[1].points[5].x() = INFINITY;
  EXPECT_EQ(reasonOf(reconstructRefined(views, start)), Reason::NotFinite);
  views = viewsOf(truth(), ring(4));
  EXPECT_EQ(reasonOf(reconstructAnchored(views, {NAN, 0, 0})), Reason::NotFinite);
  Eigen::Isometry3d behind = Eigen::Isometry3d::Identity();
  behind.translation() << 0, 0, 50;
  EXPECT_EQ(reasonOf(reconstructRefined(views, Ellipsoid(behind, {30, 30, 30}))), Reason::NotAnEllipsoid);
}

TEST(EllipseFoot, AgreesWithDenseSampling) {
  const Ellipse e{{10, -5}, {7, 2}, 0.4};
  for (const Pixel& p : {Pixel(30, 10), Pixel(10, -5), Pixel(12, -4), Pixel(10.1, -4.9), Pixel(9, -3)}) {
    const EllipseFoot foot = footOnEllipse(e, p);
    double best = 1e9;
    for (const Pixel& q : e.sample(200000)) best = std::min(best, (q - p).norm());
    EXPECT_NEAR(std::abs(foot.distance), best, 1e-8);  // sampling error: step^2 over twice the distance
    EXPECT_EQ(foot.distance > 0, p.homogeneous().dot(e.conic().matrix * p.homogeneous()) > 0);
    EXPECT_NEAR((foot.point + foot.distance * foot.normal - p).norm(), 0, 1e-9);
  }
}

// Around its axis a hyperboloid of one sheet has elliptic outlines, so the views are perfect evidence for a quadric that is no
// ellipsoid: it is returned for those who draw it, and no model predicts with it.
TEST(FitEllipsoid, DegenerateALinearQuadricThatIsNoEllipsoidIsReturnedAndNamed) {
  DualQuadric truth;
  truth.matrix = Eigen::Vector4d(-0.04, -0.0225, 0.01, 1).asDiagonal();
  std::vector<ConicView> views;
  for (int i = 0; i < 6; ++i) {
    const double a = 2 * std::numbers::pi * i / 6;
    const Projection p = lookAt({0.1 * std::cos(a), 0.1 * std::sin(a), 2 + 0.2 * i}, {0, 0, 0}).projection();
    const Outcome<Ellipse> ellipse = toEllipse(outline(truth, p));
    ASSERT_TRUE(ellipse) << ellipse.failure().message();
    views.push_back({p, *ellipse, ellipse->sample(72)});
  }
  for (const char* solver : {"linear", "refined"}) {  // without an anchor, `refined` has nothing to start from
    Settings settings;
    settings.set("fit.solver", std::string(solver));
    const Outcome<Reconstruction> r = fitEllipsoid(views, std::nullopt, settings);
    ASSERT_TRUE(r) << r.failure().message();
    EXPECT_FALSE(r->ellipsoid);
    EXPECT_STREQ(describe(r->quadric), "hyperboloid of one sheet");
    EXPECT_LT((r->quadric.matrix / r->quadric.matrix(3, 3) - truth.matrix).norm(), tolerance::kSolve);
  }
  ModelFit fit;
  fit.family = EllipsoidFit{truth};
  const Prediction p = modelByName("primal").predict(fit, lookAt({0.1, 0, 2}, {0, 0, 0}), nullptr, Settings());
  ASSERT_TRUE(p.failure());
  EXPECT_EQ(p.failure()->reason, Reason::NotAnEllipsoid);
  EXPECT_EQ(p.failure()->detail, "hyperboloid of one sheet");
}

// Another program's linear reconstruction (72 contour points per view, algebraic fit). The level sets are not exactly conics and
// the weights of the two least-squares problems differ, so the quadrics agree only as far as the data are consistent.
TEST(ReconstructLinear, PlaneOfTheReference) {
  GLINT_NEEDS_SHARED_DATA();
  std::ifstream in(std::string(GLINT_SHARED_DIR) + "/reference/plane_to_cylinder.json");
  ASSERT_TRUE(in);
  const nlohmann::json file = nlohmann::json::parse(in);
  std::vector<ConicView> views;
  for (const auto& frame : file["steps"][0]["frames"]) {
    ConicView v;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) v.projection.matrix(i, j) = frame["virtual_projection"][i][j];
    for (const auto& p : frame["contour"]) v.points.emplace_back(double(p[0]), double(p[1]));
    v.ellipse = *fitEllipse(v.points);
    views.push_back(v);
  }
  const auto r = reconstructLinear(views, Eigen::Vector3d(0.3, 0.2, 2.0));
  ASSERT_TRUE(r) << r.failure().message();
  ASSERT_TRUE(r->ellipsoid) << describe(r->quadric);
  const auto& expected = file["plane_reconstruction"];
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(r->ellipsoid->centre()(i), double(expected["centre"][i]), 0.02) << i;
    EXPECT_NEAR(std::pow(r->ellipsoid->semiAxes()(2 - i), 2), double(expected["squared_semi_axes"][i]), 0.02) << i;
  }
  for (const double px : r->residualPx) EXPECT_LT(px, 0.5);
  const auto refined = reconstructRefined(views, *r->ellipsoid);
  ASSERT_TRUE(refined);
  RecordProperty("linear_worst_px", std::to_string(*std::max_element(r->residualPx.begin(), r->residualPx.end())));
  RecordProperty("refined_worst_px", std::to_string(*std::max_element(refined->residualPx.begin(), refined->residualPx.end())));
}

}  // namespace
}  // namespace glint
