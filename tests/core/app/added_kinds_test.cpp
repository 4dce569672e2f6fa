// SPDX-License-Identifier: BSD-3-Clause
// What a plugin adds gives the answers of our own kinds where the two are the same thing: Student's t with gamma = 2 is GGX
// without masking, a superellipsoid of exponent 2 an ellipsoid.
#include <gmock/gmock.h>

#include <random>
#include <set>

#include "core/advise/diagnosis_parts.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/lobe_terms.h"
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

/// GGX without masking and without 1 / cos^4, as a lobe with two widths states it.
class TwoWidths final : public LobeProfile {
 public:
  std::string name() const override { return "two-widths"; }
  bool hasTwoWidths() const override { return true; }
  bool isMicrofacet() const override { return false; }
  ProfileValue logDistribution(double m, double t) const override {
    const double base = m * m + t;
    return {2 * std::log(m) - 2 * std::log(base) - std::log(M_PI), 2 / m - 4 * m / base, -2 / base};
  }
};

// D of GGX with slopes of two widths (Walter, Heitz), about a turned tangent:
// 1 / (pi a b cos^4 (1 + tan^2 (cos^2 phi / a^2 + sin^2 phi / b^2))^2).
TEST(AddedLobe, HasTwoWidthsAboutTheTangent) {
  const Lobe lobe = addLobe(std::make_unique<TwoWidths>());
  const double along = 0.1, across = 0.3, turned = 0.4;
  const Roughness roughness(std::sqrt(along * across), across / along);
  const Eigen::Vector3d n(0, 0, 1), tangent(std::cos(turned), std::sin(turned), 0);
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d l = unit(random), v = unit(random), h = (l + v).normalized();
    const double phi = std::atan2(h.y(), h.x()) - turned, tan2 = (1 - h.z() * h.z()) / (h.z() * h.z());
    const double tail = 1 + tan2 * (std::pow(std::cos(phi) / along, 2) + std::pow(std::sin(phi) / across, 2));
    const double expected = -std::log(M_PI * along * across * std::pow(h.z(), 4) * tail * tail);
    const auto got = logRadiance(lobe, roughness, {n, tangent}, l, v);
    ASSERT_TRUE(got);
    EXPECT_NEAR(got->lobe, expected, 1e-11 * (1 + std::abs(expected)));
    const auto value = lobe::LobeAt<double>(lobe, roughness, {n, tangent}, v).towards(l);
    EXPECT_NEAR(std::log(value.over / value.under) + value.exponent, expected, 1e-11 * (1 + std::abs(expected)));
    // Where both widths are one, it is the isotropic lobe, whatever the tangent.
    EXPECT_NEAR(logRadiance(lobe, along, n, l, v)->lobe, logRadiance(Lobe::Ggx, along, n, l, v)->lobe,
                1e-11 * (1 + std::abs(expected)));
  }
}

// The tangent of an analytic surface turns with it; others have the world's direction around y.
TEST(AddedLobe, TangentTurnsWithTheSurface) {
  AnalyticSpec spec;
  spec.type = "cylinder";
  spec.radius = 1;
  spec.worldFromSurface.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const auto surface = makeAnalytic(spec);
  const Eigen::Vector3d axis = spec.worldFromSurface.linear().col(1), out = spec.worldFromSurface.linear().col(0);
  const auto hit = surface->firstHit(Ray{3 * out, -out});
  ASSERT_TRUE(hit);
  const Eigen::Vector3d tangent = surface->tangentAt(*hit);
  EXPECT_NEAR(std::abs(tangent.dot(axis.cross(out))), 1, 1e-12);  // around the axis
  AnalyticSpec plane;
  plane.type = "plane";
  const auto flat = makeAnalytic(plane);
  EXPECT_LT((flat->tangentAt({{0, 0, 0}, {0, 0, 1}}) - Eigen::Vector3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((flat->tangentAt({{0, 0, 0}, {0, 1, 0}}) - Eigen::Vector3d::UnitX()).norm(), 1e-15);
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
