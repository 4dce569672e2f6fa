// SPDX-License-Identifier: BSD-3-Clause
// The walk that is drawn, on surfaces where every place of it is known in closed form.
#include "viz/walk_story.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "core/advise/explain.h"
#include "core/base/number_text.h"
#include "core/geometry/polyline.h"
#include "tests/core/pipeline/exact_scene.h"
#include "viz/walk_picture.h"

namespace glint::viz {
namespace {

using namespace testing_support;

constexpr double kPlace = 1e-6;  // m at 1.5 m: peaks of exact contours are found to 1e-7 px
constexpr double kRadius = 0.5;
const Eigen::Vector3d kLamp(0.1, 0.2, 1.4);  // of the exact scene

struct Told {
  Inspection inspection;
  WalkStory story;
};

Told told(const AnalyticSpec& surface, bool inverse = false, std::optional<double> direction = {}) {
  InspectionRequest q;
  q.models = {"canonical"};
  q.train = "first:4";
  Told t{inspect(exactScene(surface, 6), q), {}};
  const Outcome<WalkStory> story = walkStory(t.inspection, explain(t.inspection, 5, 0, "canonical"), inverse, direction);
  if (story)
    t.story = *story;
  else
    ADD_FAILURE() << story.failure().message();
  return t;
}

double degreesOf(double rad) { return rad * 180 / std::numbers::pi; }

/// alpha of a place from the three directions at it.
double alphaAt(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, const Eigen::Vector3d& eye) {
  const Eigen::Vector3d half = ((eye - p).normalized() + (kLamp - p).normalized()).normalized();
  return std::atan2(half.cross(normal).norm(), half.dot(normal));
}

TEST(WalkStory, ItsDirectionsAreThoseOfThePlace) {
  const Told t = told(sheet(0));
  const WalkStory& s = t.story;
  const Eigen::Vector3d eye = t.inspection.scene->frames[5].camera.centreInWorld();
  EXPECT_LT((s.normal - Eigen::Vector3d::UnitZ()).norm(), kPlace) << "the table is z = 0, the camera above it";
  EXPECT_NEAR(s.along.z(), 0, kPlace);
  EXPECT_NEAR(s.along.norm(), 1, 1e-12);
  ASSERT_GT(s.steps(), 20);
  for (const WalkPlace& p : s.trace.onPlane) {
    EXPECT_LT((p.position - s.trace.onPlane.front().position - p.distance * s.along).norm(), kPlace);
    EXPECT_LT((s.toEye(p) - (eye - p.position).normalized()).norm(), 1e-9);
    EXPECT_LT((s.toLight(p) - (kLamp - p.position).normalized()).norm(), 1e-5);  // the light is estimated from exact contours
    EXPECT_NEAR(p.alpha, alphaAt(p.position, Eigen::Vector3d::UnitZ(), eye), 1e-5);
  }
}

TEST(WalkStory, OnABallTheWalkOnSFallsBelowTheOneOnT) {
  const Told t = told(sphere(kRadius));
  const WalkStory& s = t.story;
  const Eigen::Vector3d centre(0, 0, -kRadius), eye = t.inspection.scene->frames[5].camera.centreInWorld();
  for (const WalkPlace& p : s.trace.onSurface) {
    EXPECT_NEAR((p.position - centre).norm(), kRadius, 1e-9);
    EXPECT_LT((p.normal - (p.position - centre) / kRadius).norm(), 1e-9);
    EXPECT_NEAR(p.alpha, alphaAt(p.position, p.normal, eye), 1e-4);
  }
  for (const WalkPlace& p : s.trace.onPlane) {
    EXPECT_NEAR((p.position - s.trace.onPlane.front().position).dot(s.normal), 0, 1e-9);
    EXPECT_LT((p.normal - s.normal).norm(), 1e-12);
  }
  EXPECT_LT((s.trace.onPlane.front().position - s.trace.onSurface.front().position).norm(), 1e-9) << "both begin at P_B";
}

TEST(WalkStory, ForwardsItGoesOnSAndThenOnTInverseTheOtherWayRound) {
  WalkStory s = told(sphere(kRadius)).story;
  const int places = static_cast<int>(s.trace.onSurface.size());
  ASSERT_EQ(s.steps(), 2 * places);
  for (const bool inverse : {false, true}) {
    SCOPED_TRACE(inverse);
    s.inverse = inverse;
    for (int step = -1; step <= s.steps(); ++step) {
      const int at = std::clamp(step, 0, s.steps() - 1);
      const bool first = at < places;
      const WalkStory::Moment m = s.at(step);
      EXPECT_EQ(m.onSurface, first != inverse) << step;
      EXPECT_EQ(m.place, at % places) << step;
      EXPECT_EQ(inverse ? m.visitedOnPlane : m.visitedOnSurface, first ? at + 1 : places) << step;
      EXPECT_EQ(inverse ? m.visitedOnSurface : m.visitedOnPlane, first ? 0 : at + 1 - places) << step;
      EXPECT_EQ(s.reached(m), at % places == places - 1) << step;
      const WalkPlace& p = (m.onSurface ? s.trace.onSurface : s.trace.onPlane)[static_cast<std::size_t>(at % places)];
      EXPECT_EQ(walkText(s, step),
                formatted("on %s: α %.2f° of %.2f°", first != inverse ? "S" : "T", degreesOf(p.alpha), degreesOf(kLimitAngle)));
    }
  }
}

TEST(WalkStory, EndsOnTheContourInTheSelectedDirection) {
  for (const double direction : {0.0, 1.2, -2.5}) {
    SCOPED_TRACE(direction);
    const Told t = told(sphere(kRadius), false, direction);
    const Highlight& h = t.inspection.evidence[5].highlights[0];
    const std::optional<Pixel> end = t.inspection.scene->frames[5].camera.project(t.story.trace.onSurface.back().position);
    ASSERT_TRUE(end && t.story.direction);
    EXPECT_LT(distance(h.contour, *end), 0.05) << "px: chords are 5e-3 px off their curve, and a limit of 3.4 deg is 100 px";
    const Pixel out = *end - centroid(h.contour);
    EXPECT_LT(std::abs(std::remainder(std::atan2(out.y(), out.x()) - direction, 2 * std::numbers::pi)), 0.1);
    EXPECT_NEAR(std::remainder(std::atan2(out.y(), out.x()) - *t.story.direction, 2 * std::numbers::pi), 0, 1e-6);
  }
  const Told back = told(sphere(kRadius), true);
  EXPECT_TRUE(back.story.inverse);
  EXPECT_EQ(back.story.model, "canonical");
}

/// What the section says of a place: N where the normal points, H where the half vector does.
TEST(WalkPicture, NAndHPointWhereTheNormalAndTheHalfVectorDo) {
  const WalkStory s = told(sphere(kRadius)).story;
  const int places = static_cast<int>(s.trace.onSurface.size());
  constexpr double kWidth = 400, kHeight = 300, kText = 12;
  for (const bool onSurface : {true, false}) {
    SCOPED_TRACE(onSurface);
    const int step = (onSurface ? 0 : places) + places - 3;
    const WalkPicture picture = walkPicture(s, step, kWidth, kHeight, kText, true);
    const WalkPlace& p = s.place(s.at(step));
    const WalkPicture::Dot* here = nullptr;
    for (const WalkPicture::Dot& d : picture.dots)
      if (d.radius == 4.5) here = &d;
    ASSERT_TRUE(here);
    EXPECT_EQ(here->at.x() < kWidth / 2, onSurface) << "S stands left, T right";
    double stretch = 1;
    const WalkPicture::Text *n = nullptr, *h = nullptr;
    bool ends = false;
    for (const WalkPicture::Text& t : picture.texts) {
      if (const std::string before = "heights × "; t.text.starts_with(before))
        stretch = numberFrom(std::string_view(t.text).substr(before.size())).value();
      if ((t.at.x() < kWidth / 2) == onSurface && t.text == "N") n = &t;
      if ((t.at.x() < kWidth / 2) == onSurface && t.text == "H") h = &t;
      ends |= t.text == formatted("ends at %.1f mm on %s", 1000 * (onSurface ? s.trace.reachOnSurface : s.trace.reachOnPlane),
                                  onSurface ? "S" : "T");
    }
    EXPECT_TRUE(ends);
    ASSERT_TRUE(n && h);
    // Heights are stretched, so vectors lean by as much more: slope along the section times the stretch.
    const auto slope = [&](const Eigen::Vector3d& v) { return stretch * v.dot(s.along) / v.dot(s.normal); };
    const auto drawn = [&](const WalkPicture::Text& t) { return (t.at.x() - here->at.x()) / (here->at.y() - t.at.y()); };
    EXPECT_NEAR(drawn(*n), slope(p.normal), 0.02);  // the stretch is written with one digit
    EXPECT_NEAR(drawn(*h), slope(s.half(p)), 0.02);
    EXPECT_GT(std::abs(drawn(*n) - drawn(*h)), 0.2);
  }
}

/// The angle over each section is that of the place that the step has reached there; before a section is reached it has none.
TEST(WalkPicture, EachSectionSaysTheAngleOfItsStep) {
  const Told t = told(sphere(kRadius));
  const WalkStory& s = t.story;
  const Eigen::Vector3d eye = t.inspection.scene->frames[5].camera.centreInWorld(), centre(0, 0, -kRadius);
  const int places = static_cast<int>(s.trace.onSurface.size());
  constexpr double kText = 12;
  const auto angleOn = [&](bool onSurface, int place) {
    const Eigen::Vector3d p = (onSurface ? s.trace.onSurface : s.trace.onPlane)[static_cast<std::size_t>(place)].position;
    return formatted("α %.2f°", degreesOf(alphaAt(p, onSurface ? (p - centre) / kRadius : s.normal, eye)));
  };
  for (const double width : {400.0, 170.0}) {  // in the narrow one angles stand below the titles
    for (const int step : {0, 9, places - 1, places + 4, 2 * places - 1}) {
      SCOPED_TRACE(testing::Message() << "width " << width << ", step " << step);
      const WalkPicture picture = walkPicture(s, step, width, 300, kText, true);
      const auto find = [&](const std::string& text, bool left) {
        for (const WalkPicture::Text& one : picture.texts)
          if (one.text == text && (one.at.x() < width / 2) == left) return std::optional(one);
        return std::optional<WalkPicture::Text>();
      };
      const auto onS = find(angleOn(true, std::min(step, places - 1)), true);
      const auto onT = find(step < places ? "not yet" : angleOn(false, step - places), false);
      ASSERT_TRUE(onS && onT);
      const auto title = find("Surface S", true);
      ASSERT_TRUE(title);
      EXPECT_EQ(onS->at.y() > title->at.y(), width < 200);
      if (width < 200) {
        EXPECT_GE(onS->at.y() - title->at.y(), kText);
      }
    }
  }
}

TEST(WalkPicture, TheLettersOnTheArrowsStayBelowTheWordsAboveThem) {
  const WalkStory s = told(sphere(kRadius)).story;
  constexpr double kText = 14;
  for (const auto& [width, height] : {std::pair(250.0, 190.0), {420.0, 190.0}, {180.0, 140.0}})
    for (int step = 0; step < s.steps(); ++step) {
      double words = 0, letters = 1e9;  // the lowest baseline, the highest top
      for (const WalkPicture::Text& t : walkPicture(s, step, width, height, kText, true).texts) {
        if (t.text == "Surface S" || t.text == "Plane T" || t.text.rfind("α ", 0) == 0) words = std::max(words, t.at.y());
        if (t.text == "N" || t.text == "H") letters = std::min(letters, t.at.y() - 0.75 * kText);
      }
      EXPECT_GT(letters, words) << "step " << step << ", width " << width;
    }
}

TEST(WalkPicture, InANarrowPictureTheWordsBelowTheChartDoNotMeet) {
  const WalkStory s = told(sphere(kRadius)).story;
  constexpr double kText = 14, kLetter = 0.6 * kText;  // px, width of a letter on average
  for (const double width : {180.0, 250.0, 420.0}) {
    double left = 0, right = width;
    bool end = false;
    for (const WalkPicture::Text& t : walkPicture(s, s.steps() - 1, width, 140, kText, true).texts) {
      if (t.text == "distance on T") left = t.at.x() + kLetter * static_cast<double>(t.text.size());
      if (t.text.rfind("ends at", 0) != 0) continue;
      right = t.at.x() - kLetter * static_cast<double>(t.text.size());
      end = true;
    }
    EXPECT_TRUE(end);
    EXPECT_LE(left, right) << width;
  }
}

}  // namespace
}  // namespace glint::viz
