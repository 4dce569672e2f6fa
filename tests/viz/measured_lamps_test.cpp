// SPDX-License-Identifier: BSD-3-Clause
// Measured lamps in the 3D view: their regions and cones are where the numbers say.
#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/app/lamp_answer.h"
#include "tests/viz/small_inspection.h"
#include "viz/layers.h"

namespace glint::viz {
namespace measured_lamps_tests {

constexpr double kDrawn = 1e-5;             // single precision, relative
constexpr double kQuantile = 7.8147279033;  // of chi squared, 3 degrees of freedom, 95 % (tables)

LampAnswer placed() {
  LampAnswer lamp;
  lamp.id = "near";
  lamp.position = Eigen::Vector3d(0.9, -0.6, 1.1);
  Eigen::Matrix3d root;
  root << 0.02, 0, 0, 0.01, 0.03, 0, -0.02, 0.05, 0.06;
  lamp.covariance = root * root.transpose();
  lamp.direction = lamp.position->normalized();
  lamp.directionSigma = 0.03;
  return lamp;
}

LampAnswer distant(double sigma) {
  LampAnswer lamp;
  lamp.id = "far";
  lamp.direction = Eigen::Vector3d(0.6, 0, 0.8);
  lamp.directionSigma = sigma;
  lamp.withoutPosition = "one view";
  return lamp;
}

struct Scene {
  test::TemporaryFolder folder;
  std::shared_ptr<Inspection> inspection = test::smallInspection(folder.path());
  LayerContent layer(std::vector<LampAnswer> lamps) {
    LayerInput input;
    input.inspection = inspection.get();
    input.surface = *inspection->surfaces->surfaceOf(0, {});
    input.scale = sceneScale(*inspection, input.surface.get(), {0, 1, 2, 3}, 1);
    input.lamps = std::make_shared<const std::vector<LampAnswer>>(std::move(lamps));
    scale = input.scale;
    return measuredLampsLayer(input);
  }
  SceneScale scale;
};

/// Points of all lines that one actor draws, the largest such actor.
Points linesOf(const LayerContent& content) {
  Points best;
  for (const Drawn& d : content.drawn) {
    vtkPolyData* data = vtkPolyDataMapper::SafeDownCast(vtkActor::SafeDownCast(d.prop)->GetMapper())->GetInput();
    if (data->GetNumberOfLines() == 0 || data->GetNumberOfPoints() <= vtkIdType(best.size())) continue;
    best.clear();
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) best.push_back(toEigen(data->GetPoint(i)));
  }
  return best;
}

TEST(MeasuredLamps, TheRegionIsThatOf95Percent) {
  Scene scene;
  const LampAnswer lamp = placed();
  const Points outline = linesOf(scene.layer({lamp}));
  ASSERT_GT(outline.size(), 200U);
  for (const Eigen::Vector3d& p : outline) {
    const Eigen::Vector3d off = p - *lamp.position;
    EXPECT_NEAR(off.dot(lamp.covariance->inverse() * off), kQuantile, 100 * kDrawn);
  }
}

TEST(MeasuredLamps, ADirectionHasItsConeAboutTheArrow) {
  Scene scene;
  constexpr double kSigma = 0.06;
  const LampAnswer lamp = distant(kSigma);
  const LayerContent content = scene.layer({lamp});
  EXPECT_EQ(content.labels.size(), 1U);
  const Points rim = linesOf(content);
  ASSERT_GT(rim.size(), 50U);
  const Eigen::Vector3d tip = content.labels[0].anchor;
  const double length = 0.6 * scene.scale.surfaceSize, angle = kSigma * std::sqrt(std::log(20.0));
  for (const Eigen::Vector3d& p : rim) {
    EXPECT_NEAR((p - tip).dot(lamp.direction), 0, kDrawn);
    EXPECT_NEAR((p - tip).norm(), length * std::tan(angle), kDrawn);
  }
}

TEST(MeasuredLamps, WhatIsHiddenUnknownOrExactIsSaidOrLeftOut) {
  Scene scene;
  LampAnswer failed;
  failed.failure = Failure{Reason::NoHighlight, ""};
  const LayerContent content = scene.layer({failed, distant(0)});
  ASSERT_EQ(content.remarks.size(), 1U);
  EXPECT_NE(content.remarks[0].find("1 of 2"), std::string::npos);
  EXPECT_EQ(content.drawn.size(), 1U);  // an arrow, and no cone of no width
  EXPECT_TRUE(scene.layer({}).drawn.empty());
  // One so unsure that its cone would cover the scene says how unsure.
  const LayerContent vague = scene.layer({distant(0.5)});
  ASSERT_EQ(vague.remarks.size(), 1U);
  EXPECT_NE(vague.remarks[0].find("degrees only"), std::string::npos);
  LampAnswer broken = placed();
  (*broken.covariance)(0, 0) = std::nan("");
  EXPECT_EQ(scene.layer({broken}).drawn.size(), 1U);  // its place alone
}

TEST(MeasuredLamps, ALampOfOtherCoordinatesIsSaidAndNotDrawn) {
  Scene scene;
  LampAnswer flash = placed(), lamp = placed();
  flash.frame = LightFrame::Camera;
  lamp.frame = LightFrame::World;
  const std::size_t alone = scene.layer({lamp}).drawn.size();
  const LayerContent content = scene.layer({lamp, flash});
  EXPECT_EQ(content.drawn.size(), alone);
  ASSERT_EQ(content.remarks.size(), 1U);
  EXPECT_NE(content.remarks[0].find("other coordinates"), std::string::npos) << content.remarks[0];
  scene.inspection->lightFrame.frame = LightFrame::Camera;
  EXPECT_EQ(scene.layer({flash}).drawn.size(), alone);
}

/// The light of one limit angle stands on the shipped ellipsoid 16 cm from its lamp with a standard deviation of 8 mm: what it
/// leaves out must stand beside it.
TEST(EstimatedLight, SaysThatItsDeviationIsOfNoiseAloneAndHowFarTheLampOfALobeIs) {
  const test::TemporaryFolder folder;
  const auto inspection = test::smallInspection(folder.path());
  LightEstimate& light = *inspection->lights.at({"lamp"});
  light.covariance = 1e-6 * Eigen::Matrix3d::Identity();
  LayerInput input;
  input.inspection = inspection.get();
  input.surfaceKey = inspection->surfaces->keyOf(0);
  input.scale = sceneScale(*inspection, nullptr, {0, 1, 2}, 1);
  const auto text = [&] { return lightLayer(input).drawn.at(0).info.text; };
  EXPECT_NE(text().find("standard deviation, noise alone"), std::string::npos) << text();
  EXPECT_EQ(text().find("lamp by"), std::string::npos) << "no lobe was fitted";
  ModelFit fit;
  fit.model = "reflectance";
  fit.light = "lamp";
  fit.family = ReflectanceFit{};
  fit.lightEstimate = Light::at(light.light.position() + Eigen::Vector3d(0.12, 0, 0.09));  // 0.15 m
  inspection->models["reflectance"].fits = {{"lamp", {}, fit, {}}};
  EXPECT_NE(text().find("0.15 m away from here"), std::string::npos) << text();
}

}  // namespace measured_lamps_tests

/// A lamp with a size is more than its centre: it is drawn as large as the fit has it, and its size is said.
TEST(EstimatedLight, AFittedSphereOrTubeIsDrawnAndSaid) {
  const test::TemporaryFolder folder;
  const auto inspection = test::smallInspection(folder.path());
  LayerInput input;
  input.inspection = inspection.get();
  input.surfaceKey = inspection->surfaces->keyOf(0);
  input.scale = sceneScale(*inspection, nullptr, {0, 1, 2}, 1);
  input.models = {"reflectance"};
  const Eigen::Vector3d centre = inspection->lights.at({"lamp"})->light.position() + Eigen::Vector3d(0.12, 0, 0.09);
  constexpr double kRadius = 0.3;
  const Eigen::Vector3d half(0.2, 0.1, 0);
  ModelFit fit;
  fit.model = "reflectance";
  fit.light = "lamp";
  fit.lightEstimate = Light::at(centre);
  /// Half the sides of the box around what is drawn of the model, and its words.
  const auto drawn = [&](const ReflectanceFit& lobe) {
    fit.family = lobe;
    inspection->models["reflectance"].fits = {{"lamp", {}, fit, {}}};
    Eigen::Vector3d reach(0, 0, 0);
    std::string text;
    for (const Drawn& d : lightLayer(input).drawn) {
      if (d.info.model != "reflectance") continue;
      text = d.info.text;
      const double* box = d.prop->GetBounds();
      for (int axis = 0; axis < 3; ++axis)
        reach[axis] = std::max({reach[axis], box[2 * axis + 1] - centre[axis], centre[axis] - box[2 * axis]});
    }
    return std::pair(reach, text);
  };
  ReflectanceFit sphere, tube;
  sphere.shape = SphereShape<>::of(kRadius);
  tube.shape = SegmentShape<>{half, 0};
  const double star = drawn({}).first.maxCoeff();
  ASSERT_LT(star, 0.5 * half.y()) << "the size can be seen beside the star";
  EXPECT_EQ(drawn({}).second.find("radius"), std::string::npos);
  EXPECT_LT((drawn(sphere).first - Eigen::Vector3d::Constant(kRadius)).norm(), 0.01 * kRadius);
  EXPECT_NE(drawn(sphere).second.find("0.3 m"), std::string::npos) << drawn(sphere).second;
  EXPECT_LT((drawn(tube).first - Eigen::Vector3d(half.x(), half.y(), star)).norm(), 0.01 * half.norm());
  EXPECT_NE(drawn(tube).second.find("length"), std::string::npos) << drawn(tube).second;
}

}  // namespace glint::viz
