// SPDX-License-Identifier: BSD-3-Clause
// Exact predictions are moved, shrunk and turned away; the reason must be the one that was made.
#include "core/diagnose/mismatch.h"

#include <gmock/gmock.h>

#include "tests/core/diagnose/exact_sphere.h"

namespace glint::mismatch_tests {

using namespace testing_support;
using testing::HasSubstr;

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

TEST_F(Mismatch, AMatchedRowHasNone) {
  const FrameComparison& c = inspection_->models.at("limit-angle").frames[7];
  ASSERT_TRUE(c.rows[0].metrics);
  EXPECT_EQ(whyUnmatched(*inspection_, c, c.rows[0]), "");
}

}  // namespace glint::mismatch_tests
