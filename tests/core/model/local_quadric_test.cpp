// SPDX-License-Identifier: BSD-3-Clause
// The second-order patch, the walks on it, the star contour and the search from hints: against the exact paths.
#include "core/surface/local_quadric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/model/models.h"
#include "core/model/star.h"
#include "core/pipeline/metrics.h"
#include "core/surface/mesh.h"
#include "tests/core/model/exact_views.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using namespace test;
using Eigen::Vector3d;

Settings with(std::initializer_list<std::pair<const char*, const char*>> values) {
  Settings s;
  for (const auto& [key, value] : values) s.setFromText(key, value);
  return s;
}
const Settings kQuadric = with({{"predict.query", "local-quadric"}});
const Settings kStar = with({{"predict.contour", "star"}});
const Settings kHints = with({{"predict.search", "hints"}});

/// kPatchToleranceRad of a limit of 5 degrees, on contours of some 100 px.
constexpr double kWalkPx = 3e-4;

ModelFit limitAngleFit(const Light& light, double limit) {
  ModelFit fit;
  fit.model = "limit-angle";
  fit.lightEstimate = light;
  fit.family = LimitAngleFit{limit};
  return fit;
}

/// A bump seen from above, lit from a little aside.
struct Scene {
  std::shared_ptr<const Surface> surface;
  Camera camera = lookAt({0.1, -0.3, 2}, {0, 0, 0});
  Light light = Light::at({-0.2, 0.5, 2.2});
  double limit = 5 * M_PI / 180;
  Prediction predicted(const Settings& settings = {}) const {
    return modelByName("limit-angle").predict(limitAngleFit(light, limit), camera, surface.get(), settings);
  }
};

Scene on(const AnalyticSpec& spec) {
  Scene s;
  s.surface = makeAnalytic(spec);
  return s;
}

AnalyticSpec ellipsoidUnderTheOrigin(double a, double b, double c) {
  AnalyticSpec s = ellipsoid(a, b, c);
  s.worldFromSurface.translation() = Vector3d(0, 0, -c);
  return s;
}

/// A torus that touches z = 0 at the origin with the point of its tube at an angle (degrees) from the outer equator.
AnalyticSpec torusAt(double tubeAngle, double minor) {
  AnalyticSpec s = torus(0.5, minor);
  const double a = tubeAngle * M_PI / 180;
  const Vector3d n(std::cos(a), 0, std::sin(a));
  s.worldFromSurface.linear() = Eigen::Quaterniond::FromTwoVectors(n, Vector3d::UnitZ()).toRotationMatrix();
  s.worldFromSurface.translation() = -(s.worldFromSurface.linear() * (Vector3d(0.5, 0, 0) + minor * n));
  return s;
}

double largestDistance(const Polyline& a, const Polyline& b) {
  double worst = 0;
  for (const Pixel& p : a.points) worst = std::max(worst, distance(b, p));
  for (const Pixel& p : b.points) worst = std::max(worst, distance(a, p));
  return worst;
}

double errorPct(const PredictedHighlight& exact, const PredictedHighlight& h) {
  return compareContours(exact.contour, h.contour, {}, h.ellipse, exact.brightest.pixel, h.brightest.pixel).contourErrorPct;
}

// The patch is the surface itself on planes, spheres and cylinders.
TEST(LocalQuadricSurface, IsExactOnPlaneSphereAndCylinder) {
  for (const AnalyticSpec& spec : {plane(), sphere(0.7), cylinder(0.4)}) {
    AnalyticSpec placed = spec;
    placed.worldFromSurface = pose(0.8, {0.2, -0.1, 0.3});
    const auto surface = makeAnalytic(placed);
    const Vector3d eye = placed.worldFromSurface * Vector3d(0.3, 0.4, 2);
    const Vector3d aim = placed.worldFromSurface * Vector3d(0.05, 0.1, 0);
    const Outcome<SurfacePoint> hit = surface->firstHit({eye, (aim - eye).normalized()});
    ASSERT_TRUE(hit);
    const SurfacePoint at = facing(*hit, eye);
    const Outcome<LocalQuadric> patch = LocalQuadric::of(*surface, at);
    ASSERT_TRUE(patch);
    const Eigen::Matrix<double, 3, 2> t = tangentBasis(at.normal);
    for (int k = 0; k < 12; ++k) {
      const Vector3d on = at.position + 0.2 * (t * Eigen::Vector2d(std::cos(k), std::sin(k)));
      const Outcome<SurfacePoint> a = surface->foot(on, at.normal, at), b = patch->foot(on, at.normal, at);
      ASSERT_TRUE(a && b) << spec.type;
      EXPECT_LT((a->position - b->position).norm(), tolerance::kExact) << spec.type;
      EXPECT_LT(a->normal.cross(b->normal).norm(), tolerance::kExact) << spec.type;
      const Outcome<SurfacePoint> seen = patch->firstHit({eye, (a->position - eye).normalized()});
      ASSERT_TRUE(seen) << spec.type;
      EXPECT_LT((a->position - seen->position).norm(), 1e-11) << spec.type;  // a slanted ray magnifies round-off
      const Outcome<Curvature> exact = surface->curvatureAt(facing(*a, eye)), own = patch->curvatureAt(*b);
      ASSERT_TRUE(exact && own);
      EXPECT_NEAR(exact->k1, own->k1, 1e-10);
      EXPECT_NEAR(exact->k2, own->k2, 1e-10);
    }
  }
}

/// A patch that walks cannot know as one: they ask it as any surface.
class AnySurface final : public Surface {
 public:
  explicit AnySurface(const LocalQuadric& patch) : patch_(patch) {}
  std::string describe() const override { return "any"; }
  Outcome<SurfacePoint> firstHit(const Ray& ray) const override { return patch_.firstHit(ray); }
  Outcome<SurfacePoint> foot(const Vector3d& p, const Vector3d& d, const SurfacePoint& previous) const override {
    return patch_.foot(p, d, previous);
  }
  Outcome<Curvature> curvatureAt(const SurfacePoint& p) const override { return patch_.curvatureAt(p); }
  bool occluded(const SurfacePoint&, const Vector3d&) const override { return false; }
  Eigen::AlignedBox3d bounds() const override { return patch_.bounds(); }
  TriangleMesh tessellate(const Eigen::AlignedBox3d& region, int n) const override { return patch_.tessellate(region, n); }

 private:
  const LocalQuadric& patch_;
};

// The closed forms of a walk on a patch against the general walk on the same surface: to the walk's tolerance, directions that
// end nowhere (a plane lit from far away, steep saddles) included.
TEST(LocalQuadricWalk, ClosedFormsEndWhereTheGeneralWalkEnds) {
  const Camera camera = lookAt({0.1, -0.3, 2}, {0, 0, 0});
  int walked = 0;
  for (const auto& [k1, k2] : {std::pair{2.0, 1.0}, {0.0, 0.0}, {3.0, 0.0}, {1.5, -1.0}, {-0.3, -2.0}, {40.0, 0.1}})
    for (const Light& light : {Light::at({-0.2, 0.5, 2.2}), Light::towards({0.1, -0.1, 1}), Light::at({1.5, 1, 0.6})})
      for (const double limit : {0.01, 0.1, 0.4}) {
        SurfacePoint at;
        at.position = {0.02, 0.01, 0.03};
        at.normal = (light.directionFrom(at.position) + (camera.centreInWorld() - at.position).normalized()).normalized();
        const Eigen::Matrix<double, 3, 2> t = tangentBasis(at.normal);
        const Vector3d d1 = (t * Eigen::Vector2d(0.8, 0.6)).normalized();
        const LocalQuadric patch(at, {k1, k2, d1, at.normal.cross(d1)});
        const AnySurface any(patch);
        const BrightestPoint b{at, *camera.project(at.position), 0};
        WalkOptions options;
        options.toleranceRad = 1e-13;
        const TangentWalk own(patch, camera, b, light, options), general(any, camera, b, light, options);
        const CanonicalContour a = starContour(own, patch, camera, limit, 24), g = starContour(general, any, camera, limit, 24);
        for (int i = 0; i < 24; ++i) {
          ASSERT_EQ(a.directions[i].failure.has_value(), g.directions[i].failure.has_value()) << k1 << " " << k2 << " " << limit;
          if (a.directions[i].failure) continue;
          ++walked;
          const double reach = (g.directions[i].onTangentPlane - at.position).norm();
          // Where alpha hardly rises along the direction the tolerance leaves some more of the reach open.
          EXPECT_NEAR((a.directions[i].onSurface - g.directions[i].onSurface).norm() / reach, 0, 1e-9)
              << k1 << " " << k2 << " " << limit;
        }
      }
  EXPECT_GT(walked, 800);
}

// Elsewhere position is off by the third order and the normal by the second: halving the distance divides by 8 and 4.
TEST(LocalQuadricSurface, AgreesToSecondOrder) {
  const auto surface = makeAnalytic(ellipsoid(0.6, 0.35, 0.25));
  const SurfacePoint at = facing(*surface->firstHit({{0.3, 0.2, 2}, {0, 0, -1}}), {0, 0, 9});
  const LocalQuadric patch = *LocalQuadric::of(*surface, at);
  const Eigen::Matrix<double, 3, 2> t = tangentBasis(at.normal);
  const auto miss = [&](double s) {
    const Vector3d on = at.position + s * t.col(0);
    const SurfacePoint a = *surface->foot(on, at.normal, at), b = *patch.foot(on, at.normal, at);
    return std::pair((a.position - b.position).norm(), a.normal.cross(b.normal).norm());
  };
  const auto coarse = miss(4e-3), fine = miss(2e-3);
  EXPECT_GT(fine.second, 1e-7);  // the point is no vertex of the ellipsoid: there is a third order
  EXPECT_NEAR(coarse.first / fine.first, 8, 0.3);
  EXPECT_NEAR(coarse.second / fine.second, 4, 0.15);
}

TEST(LocalQuadricSurface, EndsBeyondItsEquator) {
  const LocalQuadric patch({{0, 0, 0}, {0, 0, 1}}, {2, 2, {1, 0, 0}, {0, 1, 0}});
  const SurfacePoint at = patch.origin();
  EXPECT_TRUE(patch.foot({0.49, 0, 0}, {0, 0, 1}, at));
  const Outcome<SurfacePoint> beyond = patch.foot({0.51, 0, 0}, {0, 0, 1}, at);
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.failure().reason, Reason::SurfaceEnded);
  EXPECT_EQ(patch.firstHit({{0.51, 0, 1}, {0, 0, -1}}).failure().reason, Reason::NoHit);
  EXPECT_THROW(LocalQuadric({{0, 0, 0}, {0, 0, 1}}, {std::nan(""), 2, {1, 0, 0}, {0, 1, 0}}), std::invalid_argument);
}

// Nominal: where the patch is exact, so are the predictions of both models that walk.
TEST(LocalQuadricPrediction, Nominal) {
  for (const AnalyticSpec& spec : {sheet(0.0), sheet(1.5), ellipsoidUnderTheOrigin(0.5, 0.5, 0.5)}) {
    const Scene s = on(spec);
    const Prediction exact = s.predicted(kStar), patch = s.predicted(kQuadric);
    ASSERT_EQ(exact.highlights().size(), 1u) << spec.type;
    ASSERT_EQ(patch.highlights().size(), 1u) << spec.type;
    EXPECT_LT(largestDistance(exact.highlights()[0].contour, patch.highlights()[0].contour), kWalkPx) << spec.type;
    ASSERT_TRUE(patch.highlights()[0].curvatureVariation);
    EXPECT_LT(*patch.highlights()[0].curvatureVariation, 1e-9) << spec.type;
    EXPECT_FALSE(exact.highlights()[0].curvatureVariation);
  }
  const Synthetic scene = sheetScene(0.8);
  const FitInput input = fitInput(scene, {});
  const HighlightModel& canonical = modelByName("canonical");
  const Outcome<ModelFit> fit = canonical.fit(input, {});
  ASSERT_TRUE(fit);
  const auto surface = makeAnalytic(scene.surface);
  for (const Camera& camera : scene.cameras) {
    const Prediction exact = canonical.predict(*fit, camera, surface.get(), {}),
                     patch = canonical.predict(*fit, camera, surface.get(), kQuadric);
    ASSERT_EQ(exact.highlights().size(), 1u);
    ASSERT_EQ(patch.highlights().size(), 1u);
    EXPECT_LT(largestDistance(exact.highlights()[0].contour, patch.highlights()[0].contour), kWalkPx);
    EXPECT_EQ(patch.highlights()[0].coverage, 1);
  }
}

// The number and the contour do not depend on the unit of length.
TEST(LocalQuadricPrediction, Scale) {
  const Scene s = on(ellipsoidUnderTheOrigin(0.4, 0.3, 0.2));
  const Prediction here = s.predicted(kQuadric);
  ASSERT_EQ(here.highlights().size(), 1u);
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    Scene there = on([&] {
      AnalyticSpec spec = ellipsoidUnderTheOrigin(0.4 * scale, 0.3 * scale, 0.2 * scale);
      return spec;
    }());
    there.camera.camFromWorld.translation() *= scale;
    there.light = Light::at(scale * s.light.position());
    const Prediction p = there.predicted(kQuadric);
    ASSERT_EQ(p.highlights().size(), 1u) << scale;
    EXPECT_LT(largestDistance(here.highlights()[0].contour, p.highlights()[0].contour), kWalkPx) << scale;
    EXPECT_NEAR(*here.highlights()[0].curvatureVariation, *p.highlights()[0].curvatureVariation, 1e-6) << scale;
  }
}

// The criterion: the error against the exact contour is about half of the variation (as a share of the diameter), over families
// whose curvature varies more and more. The factor 0.6 leaves room for what lies between the four samples.
TEST(LocalQuadricPrediction, VariationBoundsTheError) {
  std::vector<AnalyticSpec> family;
  for (const double a : {0.95, 0.7, 0.5, 0.35, 0.25}) {
    AnalyticSpec s = ellipsoid(0.6, 0.6 * a, 0.6 * a);
    s.worldFromSurface = Eigen::Translation3d(-0.4, 0, -0.6 * a * std::sqrt(1 - 4.0 / 9)) * Eigen::Isometry3d::Identity();
    family.push_back(s);
  }
  for (const double minor : {0.45, 0.3, 0.2, 0.1, 0.06}) family.push_back(torusAt(40, minor));
  double smallest = 1, largest = 0;
  for (const AnalyticSpec& spec : family) {
    const Scene s = on(spec);
    const Prediction exact = s.predicted(), patch = s.predicted(kQuadric);
    // A torus shows one on its inner wall as well: the one at the origin counts.
    const auto atOrigin = [&](const Prediction& p) {
      const Pixel middle = *s.camera.project(Vector3d::Zero());
      return *std::min_element(p.highlights().begin(), p.highlights().end(),
                               [&](const PredictedHighlight& a, const PredictedHighlight& b) {
                                 return (a.brightest.pixel - middle).norm() < (b.brightest.pixel - middle).norm();
                               });
    };
    ASSERT_FALSE(exact.highlights().empty() || patch.highlights().empty()) << spec.type;
    const PredictedHighlight whole = atOrigin(exact), walked = atOrigin(patch);
    ASSERT_LT((whole.brightest.pixel - walked.brightest.pixel).norm(), 1e-6);
    const double variation = *walked.curvatureVariation, error = errorPct(whole, walked);
    smallest = std::min(smallest, variation);
    largest = std::max(largest, variation);
    EXPECT_LT(error, 60 * variation) << spec.type;
  }
  EXPECT_LT(smallest, 0.002);
  EXPECT_GT(largest, 0.02);
}

// Noisy normals make the curvature of one triangle worthless, and the number says so: it rises above any use.
TEST(LocalQuadricPrediction, Noise) {
  const AnalyticSpec spec = ellipsoidUnderTheOrigin(0.5, 0.45, 0.4);
  TriangleMesh mesh = makeAnalytic(spec)->tessellate(Eigen::AlignedBox3d(), 120);
  Scene clean = on(spec), noisy = on(spec);
  clean.surface = makeMesh(mesh, NormalPolicy::Interpolated);
  std::mt19937 rng(5);
  std::normal_distribution<double> gauss(0, 0.001);
  for (Vector3d& n : mesh.normals) n = (n + Vector3d(gauss(rng), gauss(rng), gauss(rng))).normalized();
  noisy.surface = makeMesh(mesh, NormalPolicy::Interpolated);
  const Prediction a = clean.predicted(kQuadric), b = noisy.predicted(kQuadric);
  ASSERT_EQ(a.highlights().size(), 1u);
  EXPECT_LT(*a.highlights()[0].curvatureVariation, 0.05);
  ASSERT_GE(b.highlights().size(), 1u);
  EXPECT_GT(*b.highlights()[0].curvatureVariation, 3 * *a.highlights()[0].curvatureVariation);
}

TEST(LocalQuadricPrediction, Degenerate) {
  Scene facets = on(sphere(0.5));
  facets.surface = makeMesh(facets.surface->tessellate(Eigen::AlignedBox3d(), 60), NormalPolicy::Facet);
  const Prediction p = facets.predicted(kQuadric);
  EXPECT_TRUE(p.highlights().empty());
  ASSERT_TRUE(p.failure());
  EXPECT_EQ(p.failure()->reason, Reason::NotSupported);
  // The patch goes on where the sheet has ended, and the number says so.
  Scene edge = on(sheet(0.5, 0.1, 2.0));
  edge.limit = 8 * M_PI / 180;
  const Prediction over = edge.predicted(kQuadric);
  ASSERT_EQ(over.highlights().size(), 1u);
  EXPECT_EQ(*over.highlights()[0].curvatureVariation, 1);
}

// The star is the level set where that is a star, and the level set itself where it is not.
TEST(StarContour, IsTheLevelSetOfAConvexComponent) {
  for (const AnalyticSpec& spec : {sheet(0.6), ellipsoidUnderTheOrigin(0.5, 0.4, 0.3)}) {
    const Scene s = on(spec);
    const Prediction whole = s.predicted(), star = s.predicted(kStar);
    ASSERT_EQ(star.highlights().size(), 1u);
    EXPECT_TRUE(star.highlights()[0].gaps.empty());
    // Chords of the level set leave 5e-4 px, the interpolation between 36 directions about as much.
    EXPECT_LT(largestDistance(whole.highlights()[0].contour, star.highlights()[0].contour), 5e-3) << spec.type;
    EXPECT_NE(whole.highlights()[0].contour.points.size(), star.highlights()[0].contour.points.size()) << "the star was not used";
  }
}

TEST(StarContour, FallsBackToTheLevelSet) {
  Scene edge = on(sheet(0.5, 0.1, 2.0));  // cut by the sheet's edge
  edge.limit = 8 * M_PI / 180;
  const Prediction a = edge.predicted(), b = edge.predicted(kStar);
  ASSERT_EQ(a.highlights().size(), b.highlights().size());
  ASSERT_EQ(a.highlights()[0].contour.points.size(), b.highlights()[0].contour.points.size());
  EXPECT_EQ(a.highlights()[0].contour.points[0], b.highlights()[0].contour.points[0]);
}

TEST(SearchFromHints, FindsTheSamePointsAsTheGrid) {
  const Synthetic all = ellipsoidScene(12);
  Synthetic training = all;
  training.cameras = {all.cameras[0], all.cameras[4], all.cameras[8]};
  const FitInput input = fitInput(training, {});
  const auto surface = makeAnalytic(all.surface);
  Settings poor;
  poor.set("fit.most_residual", 0.5);  // dual is not made for an ellipsoid
  for (const std::string model : {"dual", "canonical", "limit-angle"}) {
    const Outcome<ModelFit> fit = modelByName(model).fit(input, poor);
    ASSERT_TRUE(fit) << model;
    EXPECT_EQ(fit->hints.size(), 3u) << model;
    for (const Camera& camera : all.cameras) {
      const Prediction grid = modelByName(model).predict(*fit, camera, surface.get(), {});
      const Prediction hints = modelByName(model).predict(*fit, camera, surface.get(), kHints);
      ASSERT_EQ(grid.highlights().size(), hints.highlights().size()) << model;
      if (grid.highlights().empty()) continue;
      EXPECT_LT((grid.highlights()[0].brightest.pixel - hints.highlights()[0].brightest.pixel).norm(), tolerance::kSolve)
          << model;
    }
  }
  // Two highlights in one training frame: no hints, so the grid is used.
  FitInput twice = input;
  twice.views.push_back(twice.views.front());
  EXPECT_TRUE(hintsOf(twice).empty());
  // A hint that leads nowhere: the grid answers.
  ModelFit lost = *modelByName("limit-angle").fit(input, {});
  lost.hints = {SurfacePoint{{50, 50, 50}, {0, 0, 1}}};
  EXPECT_EQ(modelByName("limit-angle").predict(lost, all.cameras[5], surface.get(), kHints).highlights().size(), 1u);
}

}  // namespace
}  // namespace glint
