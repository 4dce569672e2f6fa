// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/lamp.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/settings.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/light_radiance.h"

namespace glint {
namespace {

const std::vector<Lobe> kLampLobes{Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};

/// log of (1 / 2) int over t in [-1, 1] of I_point(c + t a) sin(angle(a, direction)) dt at the origin, by Simpson's rule.
double denseSegment(Lobe lobe, double m, const Eigen::Vector3d& n, const Eigen::Vector3d& v, const Eigen::Vector3d& c,
                    const Eigen::Vector3d& a) {
  constexpr int kSteps = 4000;
  double sum = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const Eigen::Vector3d to = c + (2.0 * i / kSteps - 1) * a;
    const std::optional<LogRadiance> log = logRadiance(lobe, m, n, to.normalized(), v);
    if (!log) continue;
    const double simpson = (i == 0 || i == kSteps ? 1 : i % 2 ? 4 : 2) / (3.0 * kSteps);
    sum += simpson * std::exp(log->total()) / to.squaredNorm() * to.cross(a).norm() / (to.norm() * a.norm());
  }
  return std::log(sum);
}

// From lamps far shorter than the lobe is wide to ten times as long; at the middle, at the end and at the highlight's foot; axis
// across and slantwise.
TEST(SegmentLight, AgreesWithADenseQuadrature) {
  const double m = 0.03;
  const Eigen::Vector3d n = Eigen::Vector3d::UnitZ();
  for (const Lobe lobe : kLampLobes)
    for (const double ratio : {0.1, 0.4, 0.9, 2.5, 6.0, 10.0})
      for (const double along : {0.0, 1.0, 1.4})
        for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.6, 0.3, 0.7)}) {
          const double slant = 0.3;
          const Eigen::Vector3d v(std::sin(slant), 0, std::cos(slant));
          const Eigen::Vector3d half = ratio * 2 * m * 2 * std::cos(slant) * axis.normalized();  // a lamp 2 m away
          const Eigen::Vector3d c = 2 * Eigen::Vector3d(-std::sin(slant), 0, std::cos(slant)) - along * half;
          const Lamp lamp = normalised(segmentLamp(c - half, c + half), Eigen::Vector3d::Zero(), 1);
          const lobe::LampRule rule = lobe::lampRuleFor(lamp.shape, lobe::lampRatio(m, Eigen::Vector3d::Zero(), v, lamp));
          const auto value = lobe::logOfLamp<double>(lobe, m, Eigen::Vector3d::Zero(), n, v, lamp, rule);
          ASSERT_TRUE(value);
          // L has |L| = 1 here: distances count in units of sqrt(|c|^2 + 1).
          const double unit = std::log(c.squaredNorm() + 1);
          EXPECT_NEAR(*value - unit, denseSegment(lobe, m, n, v, c, half), 3e-5) << nameOf(lobe) << " " << ratio << " " << along;
        }
}

TEST(SegmentLight, DerivativesAgreeWithDifferences) {
  using Dual = ceres::Jet<double, 8>;
  const Eigen::Vector3d p(0.1, -0.05, 0.02), n = Eigen::Vector3d(0.1, 0, 1).normalized(),
                                             v = Eigen::Vector3d(0.3, 0.2, 1).normalized();
  Eigen::Matrix<double, 8, 1> at;
  at << -0.5, -0.1, 1.4, 0.6, 0.2, 0.25, 0.1, -0.05;  // L, m, half axis
  const lobe::LampRule rule = lobe::lampRuleFor(SegmentShape<>{}, 2);
  const auto value = [&](Lobe lobe, const auto& x) {
    using T = std::decay_t<decltype(x(0))>;
    const LampOf<T> lamp(x.template head<4>(), SegmentShape<T>{x.template tail<3>(), 0});
    return *lobe::logOfLamp<T>(lobe, x(4), p, n, v, lamp, rule);
  };
  for (const Lobe lobe : kLampLobes) {
    Eigen::Matrix<Dual, 8, 1> dual;
    for (int i = 0; i < 8; ++i) dual(i) = Dual(at(i), i);
    const Dual total = value(lobe, dual);
    for (int i = 0; i < 8; ++i) {
      Eigen::Matrix<double, 8, 1> low = at, high = at;
      low(i) -= 1e-6;
      high(i) += 1e-6;
      EXPECT_NEAR(total.v(i), (value(lobe, high) - value(lobe, low)) / 2e-6, 1e-6 * (1 + std::abs(total.v(i))))
          << nameOf(lobe) << i;
    }
  }
}

TEST(SegmentLight, SeenEndOnItSendsNothing) {
  const Lamp lamp = segmentLamp({0, 0, 1}, {0, 0, 2});
  EXPECT_FALSE(lobe::logOfLamp<double>(Lobe::Ggx, 0.1, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(),
                                       Eigen::Vector3d::UnitZ(), lamp, lobe::lampRuleFor(lamp.shape, 1)));
}

TEST(Lamp, KeepsItsInvariant) {
  const Lamp segment = segmentLamp({1, 2, 3}, {1, 2, 5});
  EXPECT_EQ(endsOf(segment)->second, Eigen::Vector3d(1, 2, 5));
  EXPECT_TRUE(Lamp(Light::at({1, 2, 3})).isPoint());
  EXPECT_TRUE(sphereLamp(Light::at({1, 2, 3}), 0).isPoint());
  EXPECT_FALSE(endsOf(sphereLamp(Light::at({1, 2, 3}), 0.1)));
  EXPECT_THROW((void)segmentLamp({1, 2, 3}, {1, 2, 3}), std::invalid_argument);
  EXPECT_THROW((void)sphereLamp(Light::at({1, 2, 3}), -1), std::invalid_argument);
  EXPECT_THROW((void)sphereLamp(Light::towards({1, 2, 3}), 0.1), std::invalid_argument);
}

// The lobe itself, evaluated with N tilted from H by the width, has fallen to the level.
TEST(LobeWidth, IsWhereTheLobeHasFallenToTheLevel) {
  const Eigen::Vector3d h = Eigen::Vector3d::UnitZ();
  for (const Lobe lobe : kLampLobes)
    for (const double m : {0.02, 0.1, 0.3})
      for (const double level : {0.2, 0.5, 0.8}) {
        const double width = widthOf(lobe, m, level);
        ASSERT_LT(width, 0.7);
        const Eigen::Vector3d n(std::sin(width), 0, std::cos(width));
        const double fall = logRadiance(lobe, m, h, h, h)->lobe - logRadiance(lobe, m, n, h, h)->lobe;
        EXPECT_NEAR(fall, -std::log(level), 1e-9) << nameOf(lobe) << " " << m << " " << level;
        EXPECT_NEAR(roughnessOf(lobe, width, level), m, 1e-9 * m) << nameOf(lobe);
      }
  EXPECT_THROW((void)widthOf(Lobe::Ggx, 0, 0.5), std::invalid_argument);
  EXPECT_THROW((void)roughnessOf(Lobe::Ggx, 0.1, 1), std::invalid_argument);
}

// What files, people and drawings get of every shape, worked out by hand.
TEST(Lamp, SaysItselfInFilesWordsAndLines) {
  struct Row {
    Lamp lamp;
    const char* name;
    std::vector<std::string> keys, facts;
    std::size_t chains;
    double reach;
  };
  const std::vector<Row> rows{{lampAt({0.1, 0.2, 0.3}), "point", {"position"}, {}, 0, 0},
                              {lampTowards({0, 0, 3}), "point", {"direction"}, {}, 0, 0},
                              {sphereLamp(Light::at({1, 2, 3}), 0.25), "sphere", {"position", "radius"}, {"radius"}, 3, 0.25},
                              {withRadius(segmentLamp({0.1, 0.7, 2}, {0.4, 1.1, 2}), 0.01),
                               "segment",
                               {"segment", "radius"},
                               {"radius", "length", "end", "end"},
                               4,
                               0.25}};
  for (const Row& r : rows) {
    EXPECT_STREQ(nameOf(r.lamp.shape), r.name);
    std::vector<std::string> keys, facts;
    for (const LampField& f : fieldsOf(r.lamp)) keys.push_back(f.name);
    for (const LampFact& f : factsOf(r.lamp)) facts.push_back(f.name);
    EXPECT_EQ(keys, r.keys) << r.name;
    EXPECT_EQ(facts, r.facts) << r.name;
    EXPECT_EQ(outlineOf(r.lamp).size(), r.chains) << r.name;
    EXPECT_NEAR(reachOf(r.lamp.shape), r.reach, 1e-15) << r.name;
    EXPECT_EQ(std::size_t(unknownCount(r.lamp.shape)), r.name == std::string("segment")  ? 3
                                                       : r.name == std::string("sphere") ? 1
                                                                                         : 0);
  }
  // As typed: sums leave no round-off behind.
  EXPECT_EQ(fieldsOf(rows[0].lamp)[0].value, Eigen::RowVector3d(0.1, 0.2, 0.3));
  Eigen::Matrix<double, 2, 3> ends;
  ends << 0.1, 0.7, 2, 0.4, 1.1, 2;
  EXPECT_EQ(fieldsOf(rows[3].lamp)[0].value, ends);
}

// What cannot ask for the shapes, because it lies below them or is no program, names the same ones.
TEST(Lamp, SettingsAndSchemaNameEveryShape) {
  const auto choices = [](const char* key) {
    const std::vector<std::string>& all = paramSpec(key).choices;
    return std::set<std::string>(all.begin(), all.end());
  };
  std::set<std::string> shapes{"auto"}, lobes{"auto"};
  for (const LampShape& shape : allLampShapes()) shapes.insert(nameOf(shape));
  for (const Lobe lobe : allLobes())
    if (!profileOf(lobe)) lobes.insert(nameOf(lobe));
  EXPECT_EQ(choices("fit.light_size"), shapes);
  EXPECT_EQ(choices("fit.lobe"), lobes);

  std::ifstream file(GLINT_SOURCE_DIR "/resources/scene.schema.json");
  const auto light = nlohmann::json::parse(file).at("$defs").at("light");
  std::set<std::string> places{"position", "direction"}, keys{"id", "radius", "frame", "known", "sigma_m", "sigma_deg"}, required,
      stated;
  for (const PlacedShape& shape : placedShapes()) {
    places.insert(shape.name);
    const auto& points = light.at("properties").at(shape.name);
    EXPECT_EQ(points.at("minItems"), shape.points) << shape.name;
    EXPECT_EQ(points.at("maxItems"), shape.points) << shape.name;
  }
  keys.insert(places.begin(), places.end());
  for (const auto& one : light.at("oneOf")) required.insert(one.at("required").at(0));
  for (const auto& [key, value] : light.at("properties").items()) stated.insert(key);
  EXPECT_EQ(required, places);
  EXPECT_EQ(stated, keys);
}

TEST(Lamp, MovesWithTheWorld) {
  const Eigen::Matrix3d quarter = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Lamp tube = transformed(withRadius(segmentLamp({1, 0, 0}, {3, 0, 0}), 0.1), 2, quarter, {0, 0, 5});
  EXPECT_LT((endsOf(tube)->first - Eigen::Vector3d(0, 2, 5)).norm(), 1e-15);
  EXPECT_LT((endsOf(tube)->second - Eigen::Vector3d(0, 6, 5)).norm(), 1e-14);
  EXPECT_DOUBLE_EQ(radiusOf(tube), 0.2);
  EXPECT_LT((transformed(lampTowards({1, 0, 0}), 2, quarter, {0, 0, 5}).centre - Eigen::Vector4d(0, 1, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(moved(lampAt({1, 2, 3}), {1, 0, 0}).position(), Eigen::Vector3d(2, 2, 3));
  const Lamp back = fromNormalised(normalised(tube, {1, 2, 3}, 7), {1, 2, 3}, 7);
  EXPECT_LT((endsOf(back)->first - endsOf(tube)->first).norm(), 1e-14);
}

}  // namespace
}  // namespace glint
