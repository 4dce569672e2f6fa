// SPDX-License-Identifier: BSD-3-Clause
// Exact predictions lose their partner or shrink: the note must count what was done to them.
#include "core/diagnose/spurious_note.h"

#include <gmock/gmock.h>

#include "core/score/metrics.h"
#include "tests/core/diagnose/exact_sphere.h"

namespace glint::spurious_note_tests {

constexpr double kTinyPx = 1;  // radius: 3 px^2, below what detection takes (detect.min_area, 12 px^2)

class SpuriousNote : public testing_support::ExactSphere {
 protected:
  static ModelResult result() { return inspection_->models.at("limit-angle"); }
  static FrameComparison& at(ModelResult& r, int frame) {
    return *std::find_if(r.frames.begin(), r.frames.end(), [&](const auto& c) { return c.frame == frame; });
  }
  /// The frame's prediction has no partner now.
  static PredictedHighlight& alone(ModelResult& r, int frame) {
    FrameComparison& c = at(r, frame);
    c.rows.at(0).observed = -1;
    c.rows.at(0).metrics.reset();
    return c.prediction.editable()[0];
  }
  static void shrink(PredictedHighlight& h) {
    const Pixel middle = centroid(h.contour);
    for (Pixel& p : h.contour.points) p = middle + kTinyPx * (p - middle).normalized();
  }
};

TEST_F(SpuriousNote, NoneWhereAllHaveAPartner) { EXPECT_EQ(spuriousNote(*inspection_, result()), ""); }

TEST_F(SpuriousNote, AFilterThatTakesOnlyThoseIsNamed) {
  ModelResult r = result();
  shrink(alone(r, 7));
  EXPECT_EQ(spuriousNote(*inspection_, r),
            "1 predicted highlight in 1 held-out frame matches no observed one; with predict.filter_area = true, "
            "1 is left out, and none of the 2 that match");
}

TEST_F(SpuriousNote, NoFilterIsNamedWhereItWouldTakeAnObservedOne) {
  ModelResult r = result();
  shrink(alone(r, 7));
  shrink(at(r, 8).prediction.editable()[0]);
  EXPECT_EQ(spuriousNote(*inspection_, r),
            "1 predicted highlight in 1 held-out frame matches no observed one; no filter of predictions takes them alone");
}

TEST_F(SpuriousNote, LargeOnesInTheLightAreOnlyCounted) {
  ModelResult r = result();
  alone(r, 6);
  alone(r, 7);
  EXPECT_EQ(spuriousNote(*inspection_, r),
            "2 predicted highlights in 2 held-out frames match no observed one; no filter of predictions takes them alone");
}

TEST_F(SpuriousNote, InTheShadowOfTheObject) {
  ModelResult r = result();  // the ball touches z = 0 from below, and the cameras are above: no point they see is lit
  for (auto& fit : r.fits) fit.fit->lightEstimate = Light::at(Eigen::Vector3d(0, 0, -5));
  for (const int frame : {6, 7, 8}) alone(r, frame);
  EXPECT_EQ(spuriousNote(*inspection_, r),
            "3 predicted highlights in 3 held-out frames match no observed one; with predict.filter_shadow = true, "
            "3 are left out, and none of the 0 that match");
}

TEST_F(SpuriousNote, TrainingFramesDoNotCount) {
  ModelResult r = result();
  shrink(alone(r, 2));
  EXPECT_EQ(spuriousNote(*inspection_, r), "");
}

}  // namespace glint::spurious_note_tests
