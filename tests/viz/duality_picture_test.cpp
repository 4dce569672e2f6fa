// SPDX-License-Identifier: BSD-3-Clause
// Planes and dual points as they are drawn, of outlines that an ellipsoid really has.
#include "viz/duality_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace glint::viz {
namespace duality_picture_tests {

/// Three views of a lens; with `axes` that end in 0 it is flat.
Duality told(const Eigen::Vector3d& axes = {0.3, 0.15, 0.08}) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  Inspection in;
  auto scene = std::make_shared<Scene>();
  ModelFit fit;
  fit.model = "primal";
  fit.light = "lamp";
  const Ellipsoid ellipsoid(pose, axes);
  fit.family = EllipsoidFit{ellipsoid.dual(), ellipsoid};
  for (int i = 0; i < 3; ++i) {
    Frame frame;
    frame.id = "v" + std::to_string(i);
    Eigen::Vector3d back(std::sin(0.5 * i), 0.3 * i, -std::cos(0.5 * i));
    back.normalize();
    Eigen::Matrix3d r;
    const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(-back).normalized();
    r << right.transpose(), (-back).cross(right).transpose(), -back.transpose();
    frame.camera.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
    frame.camera.camFromWorld.linear() = r;
    frame.camera.camFromWorld.translation() = -r * (ellipsoid.centre() + 2 * back);
    frame.camera.width = 640;
    frame.camera.height = 480;
    TrainingView view;
    view.frame = i;
    view.camera = frame.camera;
    view.highlight.light = "lamp";
    view.highlight.ellipse = *outlineEllipse(ellipsoid, frame.camera.projection());
    view.highlight.contour.points = view.highlight.ellipse->sample(90);
    in.views.push_back(view);
    fit.frames.push_back(i);
    fit.residualPx.push_back(0.25);
    scene->frames.push_back(frame);
  }
  in.scene = in.given = scene;
  ModelResult result;
  result.model = "primal";
  result.fits.push_back({"lamp", std::nullopt, fit, {}});
  in.models["primal"] = result;
  const Outcome<Duality> d = dualityOf(in, 0, "lamp", "primal");
  if (!d) throw std::runtime_error(d.failure().message());
  return *d;
}

DualityLook look(double width = 900, double height = 400) {
  DualityLook l;
  l.frame = 1;
  l.width = width;
  l.height = height;
  return l;
}

TEST(DualityPicture, HasEveryPlaneOnceOnEachSide) {
  const Duality d = told();
  const DualityPicture p = dualityPicture(d, look());
  EXPECT_EQ(p.planes.size(), 3u * 24);
  EXPECT_EQ(p.points.size() + std::size_t(p.outside), 3u * 24);
  EXPECT_EQ(p.outside, 0);
  for (const auto& place : p.planes) EXPECT_LT(place.at.x(), 450);
  for (const auto& place : p.points) EXPECT_GT(place.at.x(), 450);
}

/// A place on the line in which a plane touches its cone is nearest to that plane, however far it is from the apex.
TEST(DualityPicture, APlaceOnAConeHasItsPlane) {
  const Duality d = told();
  for (const int i : {0, 7, 23}) {
    const Duality::View& view = d.views[2];
    for (const double far : {0.1, 2.0, 9.0})
      EXPECT_EQ(planeNearest(d, view.frame, view.apex + far * view.planes[std::size_t(i)].cone.along), (DualityPlane{2, i}));
  }
  EXPECT_FALSE(planeNearest(d, 7, {0, 0, 0})) << "no view is of that frame";
  EXPECT_FALSE(planeNearest(d, d.views[1].frame, d.views[1].apex)) << "the apex is on all of them";
}

TEST(DualityPicture, APlanesNormalAndItsDualPointShowInTheSameDirection) {
  const Duality d = told();
  for (const double turn : {0.0, 0.9, -2.0}) {
    DualityLook l = look();
    l.turn = turn;
    l.tilt = 0.3 * turn;
    l.lit = {1, 7};
    const DualityPicture p = dualityPicture(d, l);
    // The two red lines: from the ellipsoid's centre to the plane, and from the chart's centre to the point.
    std::vector<Eigen::Vector2d> found;
    for (const DrawnPicture::Line& line : p.drawn.lines)
      if (!line.filled && line.colour == kFailed && line.points.size() == 2) found.push_back(line.points[1] - line.points[0]);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(found[0].normalized().dot(found[1].normalized()), 1, 1e-9);
  }
}

TEST(DualityPicture, ThePointerFindsWhatIsNearest) {
  const Duality d = told();
  const DualityPicture p = dualityPicture(d, look());
  for (const auto* places : {&p.planes, &p.points}) {
    const DualityPicture::Place& place = (*places)[30];
    const auto found = planeAt(p, place.at + Eigen::Vector2d(0.01, 0));
    ASSERT_TRUE(found);
    // Another may lie in the same place on screen.
    const auto same = [&](const DualityPicture::Place& other) {
      return other.plane == *found && (other.at - place.at).norm() < 0.05;
    };
    EXPECT_TRUE(std::any_of(places->begin(), places->end(), same));
  }
  EXPECT_FALSE(planeAt(p, {-100, -100}));
}

TEST(DualityPicture, IsStackedWhereItIsHigh) {
  const DualityPicture p = dualityPicture(told(), look(300, 800));
  for (const auto& place : p.planes) EXPECT_LT(place.at.y(), 400);
  for (const auto& place : p.points) EXPECT_GT(place.at.y(), 400);
}

TEST(DualityPicture, OfAFlatEllipsoidShowsATubeAndSaysSo) {
  const Duality d = told({0.3, 0.15, 0});
  const DualityPicture p = dualityPicture(d, look());
  EXPECT_EQ(p.points.size() + std::size_t(p.outside), 3u * 24);
  bool said = false;
  for (const DrawnPicture::Text& t : p.drawn.texts) said = said || t.text.find("flat") != std::string::npos;
  EXPECT_TRUE(said);
  for (const DrawnPicture::Line& line : p.drawn.lines)
    for (const Eigen::Vector2d& at : line.points) EXPECT_TRUE(at.allFinite());
}

TEST(DualityPicture, ItsWordsSayHowFarThePlaneIs) {
  Duality d = told();
  EXPECT_NE(dualityWords(d, {}, "v1").find("linear"), std::string::npos);
  Duality::Touch& t = d.views[1].planes[3];
  t.away = 0.1234;
  t.gap = -0.002;
  const std::string words = dualityWords(d, {1, 3}, "v1");
  for (const char* expected : {"v1", "123 mm", "2 mm within", "outside of the dual", "0.25 px"})
    EXPECT_NE(words.find(expected), std::string::npos) << expected << " in: " << words;
  t.dual.reset();
  EXPECT_NE(dualityWords(d, {1, 3}, "v1").find("infinity"), std::string::npos);
}

}  // namespace duality_picture_tests
}  // namespace glint::viz
