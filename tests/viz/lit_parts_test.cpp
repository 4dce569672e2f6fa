// SPDX-License-Identifier: BSD-3-Clause
// What a name lights up, on actors that are never drawn.
#include "viz/lit_parts.h"

#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkPropCollection.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include "viz/glyphs.h"

namespace glint::viz::lit_parts_tests {
namespace {

constexpr Colour kGrey{0.5, 0.5, 0.5}, kRed{1, 0, 0}, kBlue{0, 0, 1};

class LitPartsTest : public testing::Test {
 protected:
  LitPartsTest() : lit_(renderer_) {
    add(arrow_, "normal", "peaks");
    add(point_, "point", "peaks");
    nameLayer(ray_, "rays");
    renderer_->AddViewProp(ray_);
  }
  void add(const vtkSmartPointer<vtkActor>& actor, const char* part, const char* layer) {
    nameLayer(named(actor, part), layer);
    renderer_->AddViewProp(actor);
  }
  static vtkSmartPointer<vtkActor> segment() { return segmentActor({{{0, 0, 0}, {1, 0, 0}}}, kGrey, 2); }
  static bool has(vtkActor* actor, const Colour& colour) {
    const double* const now = actor->GetProperty()->GetColor();
    return now[0] == colour[0] && now[1] == colour[1] && now[2] == colour[2];
  }
  void draw() { renderer_->InvokeEvent(vtkCommand::StartEvent); }

  vtkNew<vtkRenderer> renderer_;
  vtkSmartPointer<vtkActor> arrow_ = segment(), point_ = segment(), ray_ = segment();
  LitParts lit_;
};

TEST_F(LitPartsTest, APartLightsUpAloneAndALayerWhole) {
  lit_.light({"peaks/normal"}, kRed);
  draw();
  EXPECT_TRUE(has(arrow_, kRed));
  EXPECT_TRUE(has(point_, kGrey) && has(ray_, kGrey));
  EXPECT_GT(arrow_->GetProperty()->GetLineWidth(), 2);
  lit_.light({"peaks"}, kRed);
  draw();
  EXPECT_TRUE(has(arrow_, kRed) && has(point_, kRed) && has(ray_, kGrey));
  EXPECT_EQ(lit_.litCount(), 2);
  lit_.light({"pea"}, kRed);  // no name's beginning
  draw();
  EXPECT_EQ(lit_.litCount(), 0);
}

TEST_F(LitPartsTest, WhatWasLitIsAsBefore) {
  arrow_->GetProperty()->SetOpacity(0.2);
  lit_.light({"peaks"}, kRed);
  draw();
  draw();  // lit once, not thicker with every picture
  lit_.light({"peaks"}, kBlue);
  draw();
  EXPECT_TRUE(has(arrow_, kBlue));
  lit_.light({}, kBlue);
  EXPECT_TRUE(has(arrow_, kGrey));
  EXPECT_EQ(arrow_->GetProperty()->GetLineWidth(), 2);
  EXPECT_DOUBLE_EQ(arrow_->GetProperty()->GetOpacity(), 0.2);
}

/// A layer that is built anew while it is lit.
TEST_F(LitPartsTest, WhatComesLaterIsLitToo) {
  lit_.light({"rays"}, kRed);
  draw();
  const vtkSmartPointer<vtkActor> later = segment();
  add(later, "view", "rays");
  EXPECT_TRUE(has(later, kGrey));
  draw();
  EXPECT_TRUE(has(later, kRed));
}

/// The strip holds the apex, the place of touch and points beyond it, all in the plane.
TEST_F(LitPartsTest, ATouchingPlaneGoesThroughApexAndTouch) {
  const int before = renderer_->GetViewProps()->GetNumberOfItems();
  lit_.lightPlane({0, 0, 2}, {1, 0, 2}, Eigen::Vector3d::UnitZ(), 0.1, kRed);
  ASSERT_TRUE(lit_.planeShown());
  EXPECT_EQ(renderer_->GetViewProps()->GetNumberOfItems(), before + 2);
  const double* const box = renderer_->GetViewProps()->GetLastProp()->GetBounds();  // the line
  EXPECT_NEAR(box[0], 0, 1e-6);
  EXPECT_NEAR(box[1], 1, 1e-6);
  EXPECT_NEAR(box[4], 2, 1e-6);
  EXPECT_NEAR(box[5], 2, 1e-6);
  double all[6];
  renderer_->ComputeVisiblePropBounds(all);
  EXPECT_GT(all[1], 1.01);
  EXPECT_LT(all[2], -0.1);
  EXPECT_GT(all[3], 0.1);
  lit_.clearPlane();
  EXPECT_FALSE(lit_.planeShown());
  EXPECT_EQ(renderer_->GetViewProps()->GetNumberOfItems(), before);
  lit_.lightPlane({0, 0, 2}, {0, 0, 2}, Eigen::Vector3d::UnitZ(), 0.1, kRed);  // touches at the eye: there is no strip
  EXPECT_FALSE(lit_.planeShown());
}

}  // namespace
}  // namespace glint::viz::lit_parts_tests
