// SPDX-License-Identifier: BSD-3-Clause
// Exact predictions are moved, shrunk and turned away; the reason must be the one that was made.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "core/advise/highlight_evidence.h"
#include "core/base/numeric.h"
#include "tests/core/advise/exact_sphere.h"

namespace glint::mismatch_tests {

using namespace testing_support;
using testing::HasSubstr;
using testing::Not;

class Mismatch : public testing_support::ExactSphere {
 protected:
  /// The exact prediction of frame 7, changed, as a spurious row.
  template <class Change>
  std::string whySpurious(const Change& change) const {
    for (const FrameComparison& c : inspection_->models.at("limit-angle").frames) {
      if (c.frame != 7) continue;
      FrameComparison moved = c;
      change(moved.prediction.editable()[0]);
      FrameComparison::Row row;
      row.predicted = 0;
      return whyUnmatched(*inspection_, moved, row);
    }
    return "no frame";
  }
};

TEST_F(Mismatch, OutsideOfTheImage) {
  EXPECT_EQ(whySpurious([](PredictedHighlight& h) {
              for (Pixel& p : h.contour.points) p.y() += 4000;
            }),
            "outside of the image");
}

TEST_F(Mismatch, InItsOwnShadow) {
  Inspection below =
      *inspection_;  // the ball touches z = 0 from below, and the cameras are above: they see no point that this lamp lights
  for (auto& [key, light] : below.lights) light->light = Light::at(Eigen::Vector3d(0, 0, -5));
  FrameComparison::Row row;
  row.predicted = 0;
  EXPECT_EQ(whyUnmatched(below, below.models.at("limit-angle").frames[7], row), "in the shadow of the object itself");
}

TEST_F(Mismatch, APointThatIsNotOfTheSurfaceSaysNothingOfItsShadow) {
  EXPECT_THAT(whySpurious([](PredictedHighlight& h) { h.brightest.point.position = Eigen::Vector3d(0, 0, -1); }),
              HasSubstr("the nearest observed highlight"));
}

TEST_F(Mismatch, SmallerThanDetectionTakes) {
  EXPECT_THAT(whySpurious([](PredictedHighlight& h) {
                const Pixel middle = centroid(h.contour);
                const double scale = std::sqrt(3.0 / std::abs(signedArea(h.contour)));
                for (Pixel& p : h.contour.points) p = middle + scale * (p - middle);
              }),
              HasSubstr("3 of 12 px^2"));
}

TEST_F(Mismatch, DetectionSawItAndDidNotTakeIt) {
  Inspection with = *inspection_;
  const Pixel middle = centroid(with.evidence[7].highlights[0].contour);
  with.evidence[7].rejected.push_back({middle + Pixel(3, 0), 20, "streak"});
  const FrameComparison& c = with.models.at("limit-angle").frames[7];
  ASSERT_EQ(c.frame, 7);
  FrameComparison::Row row;
  row.predicted = 0;
  EXPECT_EQ(whyUnmatched(with, c, row), "detection saw a spot there and did not take it: streak");
}

/// A candidate's place is measured, a contour ideal: a lens that moves that place by 40 px must not part them.
TEST_F(Mismatch, DetectionSawItThroughALensThatBends) {
  Inspection with = *inspection_;
  const auto scene = std::make_shared<Scene>(*with.scene);
  Camera& camera = scene->frames[7].camera;
  camera.lens.model = LensModel::SimpleRadial;
  with.scene = scene;
  FrameComparison c = with.models.at("limit-angle").frames[7];
  Polyline& contour = c.prediction.editable()[0].contour;
  const Pixel far = Pixel(560, 239.5) - centroid(contour);  // 0.3 of the focal length from the axis
  for (Pixel& p : contour.points) p += far;
  const Pixel middle = centroid(contour);
  camera.lens.parameters[0] = -40 / (middle.x() - 319.5) / std::pow((middle.x() - 319.5) / 800, 2);
  ASSERT_NEAR((camera.distorted(middle) - middle).norm(), 40, 1);
  for (Pixel& p : contour.points) p = middle + 0.1 * (p - middle);  // smaller than the lens moves it
  with.evidence[7].rejected.push_back({camera.distorted(middle), 20, "streak"});
  FrameComparison::Row row;
  row.predicted = 0;
  EXPECT_EQ(whyUnmatched(with, c, row), "detection saw a spot there and did not take it: streak");
}

TEST_F(Mismatch, FarFromWhatWasObserved) {
  EXPECT_THAT(whySpurious([](PredictedHighlight& h) {
                for (Pixel& p : h.contour.points) p += Pixel(30, 40);
              }),
              HasSubstr("the nearest observed highlight is 50 px away"));
}

TEST_F(Mismatch, MissedSaysWhereTheNearestPredictionIs) {
  FrameComparison c = inspection_->models.at("limit-angle").frames[7];
  for (Pixel& p : c.prediction.editable()[0].contour.points) p += Pixel(-60, 80);
  FrameComparison::Row row;
  row.observed = 0;
  row.failure = Failure{Reason::NotReached, "no prediction overlaps this highlight"};  // as every missed one has
  EXPECT_EQ(whyUnmatched(*inspection_, c, row), "the nearest predicted highlight is 100 px away");
  row.failure.reset();
  c.prediction = Failure{Reason::NotReached, "no walk ended"};
  EXPECT_THAT(whyUnmatched(*inspection_, c, row), HasSubstr("no walk ended"));
}

/// A point of the ball whose normal leans by a known angle from the view ray, beside the ball's centre in the image. The lamp is
/// where the camera is: what one sees is lit.
TEST_F(Mismatch, AtGrazingIncidenceSaysTheAngle) {
  Inspection lit = *inspection_;
  const Camera& camera = lit.scene->frames[7].camera;
  const Eigen::Vector3d eye = camera.centreInWorld(), centre(0, 0, -0.5), axis = (centre - eye).normalized();
  const Eigen::Vector3d across = axis.cross(Eigen::Vector3d::UnitZ()).normalized();
  for (auto& [key, light] : lit.lights) light->light = Light::at(eye);
  for (const double angle : {70.0, 80.0}) {
    const double off = std::asin(0.5 * std::sin(radians(angle)) / (centre - eye).norm());  // of the ray from the centre
    FrameComparison c = lit.models.at("limit-angle").frames[7];
    Polyline& contour = c.prediction.editable()[0].contour;
    const Pixel shift = *camera.project(eye + std::cos(off) * axis + std::sin(off) * across) - centroid(contour);
    for (Pixel& p : contour.points) p += shift;
    FrameComparison::Row row;
    row.predicted = 0;
    EXPECT_THAT(whyUnmatched(lit, c, row), testing::StartsWith(angle > 75 ? "at grazing incidence: seen 80\u00b0 from the normal"
                                                                          : "the nearest observed highlight"));
  }
}

/// A third of a contour beyond the border is not yet outside.
TEST_F(Mismatch, MostOfItIsInTheImage) {
  EXPECT_THAT(whySpurious([](PredictedHighlight& h) {
                std::vector<double> rows;
                for (const Pixel& p : h.contour.points) rows.push_back(p.y());
                std::sort(rows.begin(), rows.end());
                for (Pixel& p : h.contour.points) p.y() -= rows[rows.size() / 3];
              }),
              Not(HasSubstr("outside")));
}

TEST_F(Mismatch, MissedSaysThatItsPredictionIsFiltered) {
  FrameComparison c = inspection_->models.at("limit-angle").frames[7];
  const PredictedHighlight there = c.prediction.highlights()[0];
  PredictedHighlight elsewhere = there;
  for (Pixel& p : elsewhere.contour.points) p += Pixel(-3000, 0);
  for (Pixel& p : c.prediction.editable()[0].contour.points) p += Pixel(-60, 80);
  FrameComparison::Row row;
  row.observed = 0;
  c.prediction.filtered = {{elsewhere, "too small"}};
  EXPECT_EQ(whyUnmatched(*inspection_, c, row), "the nearest predicted highlight is 100 px away");
  c.prediction.filtered.push_back({there, "too faint"});
  EXPECT_EQ(whyUnmatched(*inspection_, c, row), "its prediction is filtered: too faint");
}

TEST_F(Mismatch, AMatchedRowHasNone) {
  const FrameComparison& c = inspection_->models.at("limit-angle").frames[7];
  ASSERT_TRUE(c.rows[0].metrics);
  EXPECT_EQ(whyUnmatched(*inspection_, c, c.rows[0]), "");
}

}  // namespace glint::mismatch_tests
