// SPDX-License-Identifier: BSD-3-Clause
// What a plugin adds gives the answers of our own kinds where the two are the same thing: Student's t with gamma = 2 is GGX
// without masking, a superellipsoid of exponent 2 an ellipsoid.
#include <gmock/gmock.h>

#include <random>
#include <set>

#include "core/diagnose/candidates.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/lobe_width.h"
#include "core/reflectance/radiance_bound.h"
#include "core/surface/analytic.h"
#include "plugins/example/student_lobe.h"
#include "plugins/example/superellipsoid.h"

namespace glint::plugin_tests {
namespace {

constexpr double kSameLobe = 1e-12;   // a dozen operations on logarithms of up to 30
constexpr double kSamePoint = 1e-12;  // m, of a surface of 0.5 m: bisection to neighbouring doubles

Eigen::Vector3d unit(std::mt19937& random) {
  std::normal_distribution<double> n;
  return Eigen::Vector3d(n(random), n(random), std::abs(n(random)) + 0.2).normalized();
}

TEST(AddedLobe, StudentOfGammaTwoIsGgx) {
  const Lobe lobe = addLobe(std::make_unique<example::StudentLobe>(2, "ggx-again"));
  std::mt19937 random(1);
  const Eigen::Vector3d n(0, 0, 1);
  for (const double m : {0.03, 0.2, 0.7})
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d l = unit(random), v = unit(random);
      const auto own = logRadiance(Lobe::Ggx, m, n, l, v), added = logRadiance(lobe, m, n, l, v);
      ASSERT_TRUE(own && added);
      EXPECT_NEAR(added->lobe, own->lobe, kSameLobe * (1 + std::abs(own->lobe)));
      EXPECT_NEAR(added->cosines, own->cosines, kSameLobe * (1 + std::abs(own->cosines)));
      EXPECT_EQ(added->masking, 0);
      // The sum over points of a lamp takes another way to the same value.
      lobe::LobeAt<double> at(lobe, m, n, v);
      const auto value = at.towards(l);
      EXPECT_NEAR(at.constant() + std::log(value.over / value.under) + value.exponent, added->total(),
                  kSameLobe * (1 + std::abs(added->total())));
    }
  for (const double level : {0.1, 0.5, 0.9}) {
    EXPECT_NEAR(widthOf(lobe, 0.2, level), widthOf(Lobe::Ggx, 0.2, level), 1e-12);
    EXPECT_NEAR(roughnessOf(lobe, 0.15, level), roughnessOf(Lobe::Ggx, 0.15, level), 1e-12);
  }
}

struct Dual {  // as ceres::Jet: a value `a` and a derivative
  double a, v;
  explicit Dual(double value) : a(value), v(0) {}
  Dual(double value, double derivative) : a(value), v(derivative) {}
  Dual operator+(const Dual& o) const { return {a + o.a, v + o.v}; }
  Dual operator-(const Dual& o) const { return {a - o.a, v - o.v}; }
  friend Dual operator*(double f, const Dual& x) { return {f * x.a, f * x.v}; }
};

TEST(AddedLobe, DerivativesOfADualNumberAreThoseOfDifferences) {
  const example::StudentLobe student(4);
  const double m = 0.3, t = 0.05, step = 1e-6;
  const double byM = (student.logDistribution(m + step, t).value - student.logDistribution(m - step, t).value) / (2 * step);
  const double byT = (student.logDistribution(m, t + step).value - student.logDistribution(m, t - step).value) / (2 * step);
  EXPECT_NEAR(lobe::addedDistribution(student, Dual(m, 1), Dual(t)).v, byM, 1e-6 * std::abs(byM));
  EXPECT_NEAR(lobe::addedDistribution(student, Dual(m), Dual(t, 1)).v, byT, 1e-6 * std::abs(byT));
}

TEST(AddedLobe, BoundIsAboveTheRadiance) {
  const Lobe lobe = addLobe(std::make_unique<example::StudentLobe>());
  std::mt19937 random(2);
  const Eigen::Vector3d n(0, 0, 1);
  for (const double m : {0.05, 0.3, 0.79, 1.5})  // the last is beyond what was checked when the lobe was added
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d l = unit(random), v = unit(random), h = (l + v).normalized();
      PartBounds part;
      part.tanSquared = Eight::Constant(float(1 / std::pow(h.dot(n), 2) - 1) * (1 - 1e-5f));
      part.cosView = Eight::Constant(float(v.dot(n)) * (1 - 1e-5f));
      part.cosHalf = Eight::Constant(float(std::sqrt(0.5 * (1 + l.dot(v)))) * (1 - 1e-5f));
      part.lightSquared = Eight::Constant(1);
      EXPECT_GE(largestLogRadiance(lobe, m, part)[0], logRadiance(lobe, m, n, l, v)->total()) << m;
    }
}

/// The adviser tries what the fit does not have yet: other shapes of the lamp, other lobes and those of plugins.
TEST(AddedLobe, TheAdviserTriesItAndEveryShapeOfTheLamp) {
  addLobe(std::make_unique<example::StudentLobe>());
  Inspection r;
  Scene scene;
  scene.frames.resize(6);
  r.scene = r.given = std::make_shared<const Scene>(std::move(scene));
  r.train = parseTrainSpec("first:3", *r.scene);
  ReflectanceFit sphere;
  sphere.lobe = Lobe::Ggx;
  sphere.shape = SphereShape<>::of(0.1);
  ModelFit fit;
  fit.family = sphere;
  r.models["reflectance"].fits = {{"lamp", {}, fit, {}}};
  std::set<std::string> tried;
  for (const CandidateChange& c : candidateChanges(r, "reflectance")) tried.insert(c.change.set.value_or(""));
  for (const char* other : {"fit.light_size=point", "fit.light_size=segment", "fit.lobe=torrance-sparrow", "fit.lobe=student-t"})
    EXPECT_TRUE(tried.count(other)) << other;
  for (const char* same : {"fit.light_size=sphere", "fit.lobe=ggx"}) EXPECT_FALSE(tried.count(same)) << same;
}

TEST(AddedShape, SuperellipsoidOfExponentTwoIsAnEllipsoid) {
  addShapeKind(std::make_unique<example::SuperellipsoidKind>());
  AnalyticSpec own, added;
  own.type = "ellipsoid";
  own.semiAxes = {0.5, 0.3, 0.2};
  added.type = "superellipsoid";
  added.numbers = {{"a", 0.5}, {"b", 0.3}, {"c", 0.2}, {"exponent", 2}};
  own.worldFromSurface = added.worldFromSurface =
      Eigen::Translation3d(0.1, -0.2, 1) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  const auto a = makeAnalytic(own), b = makeAnalytic(added);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.3, 0.3);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Ray ray{{place(random), place(random), -2}, (Eigen::Vector3d(place(random), place(random), 3)).normalized()};
    const auto x = a->firstHit(ray), y = b->firstHit(ray);
    ASSERT_EQ(bool(x), bool(y)) << i;
    if (!x) continue;
    ++hits;
    EXPECT_LT((x->position - y->position).norm(), 1e3 * kSamePoint)
        << i;  // at a grazing ray a root is worth the square root of a double
    EXPECT_LT((x->normal - y->normal).norm(), 1e-6) << i;
    const auto cx = a->curvatureAt(*x), cy = b->curvatureAt(*x);
    ASSERT_TRUE(cx && cy);
    EXPECT_NEAR(cy->k1, cx->k1, 1e-9 * cx->k1);
    EXPECT_NEAR(cy->k2, cx->k2, 1e-9 * cx->k1);
  }
  EXPECT_GT(hits, 100);
  added.numbers["exponent"] = 9;  // out of its range
  EXPECT_THROW(makeAnalytic(added), std::invalid_argument);
}

}  // namespace
}  // namespace glint::plugin_tests
