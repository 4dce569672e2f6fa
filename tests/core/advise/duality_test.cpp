// SPDX-License-Identifier: BSD-3-Clause
// Cones, their tangent planes and dual points of a fit, on outlines that an ellipsoid really has.
#include "core/advise/duality.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <numbers>

#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace duality_tests {

using namespace testing_support;

constexpr double kExact = 1e-9;  // of the ellipsoid's size: round-off of outlines in px

/// An inspection whose `primal` has this ellipsoid, and whose cameras see exactly its outlines, `wider` px too large.
Inspection seen(const Ellipsoid& ellipsoid, int views, double unit = 1, double wider = 0) {
  auto scene = std::make_shared<Scene>();
  Inspection in;
  ModelFit fit;
  fit.model = "primal";
  fit.light = "lamp";
  fit.family = EllipsoidFit{ellipsoid.dual(), ellipsoid};
  for (int i = 0; i < views; ++i) {
    const double a = 1.1 * i;
    Frame frame;
    frame.id = "v" + std::to_string(i);
    frame.camera =
        lookingAt(unit * Eigen::Vector3d(2 * std::cos(a), 2 * std::sin(a), 1 + 0.4 * std::cos(2.3 * a)), ellipsoid.centre());
    TrainingView view;
    view.frame = i;
    view.camera = frame.camera;
    view.highlight.light = "lamp";
    view.highlight.ellipse = *outlineEllipse(ellipsoid, frame.camera.projection());
    view.highlight.ellipse->semiAxes.array() += wider;
    view.highlight.contour.points = view.highlight.ellipse->sample(90);
    in.views.push_back(std::move(view));
    fit.frames.push_back(i);
    fit.residualPx.push_back(0.1 * i);
    scene->frames.push_back(std::move(frame));
  }
  in.scene = in.given = scene;
  ModelResult result;
  result.model = "primal";
  result.fits.push_back({"lamp", std::nullopt, fit, {}});
  in.models["primal"] = std::move(result);
  return in;
}

Ellipsoid lens(double unit = 1) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = unit * Eigen::Vector3d(0.1, -0.05, 0.2);
  pose.linear() = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, -1, 0.5).normalized()).toRotationMatrix();
  return Ellipsoid(pose, unit * Eigen::Vector3d(0.3, 0.15, 0.08));
}

TEST(Duality, TheConesOfAnEllipsoidTouchItAndTheirDualPointsLieOnItsDual) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const Ellipsoid truth = lens(unit);
    const auto d = dualityOf(seen(truth, 4, unit), 0, "lamp", "primal", 16);
    ASSERT_TRUE(d) << d.failure().message();
    ASSERT_EQ(d->views.size(), 4u);
    EXPECT_LT(d->rmsGap, kExact * unit);
    EXPECT_LT(d->rmsOffDual, kExact);
    ASSERT_TRUE(d->dual);
    EXPECT_EQ(d->atInfinity, 0);
    const double radius = unit * std::cbrt(0.3 * 0.15 * 0.08);
    EXPECT_NEAR(d->chart.radius / radius, 1, kExact);
    const Eigen::Vector3d inverse(radius * radius / (0.08 * unit), radius * radius / (0.15 * unit),
                                  radius * radius / (0.3 * unit));
    EXPECT_LT((d->dual->semiAxes() - inverse).norm(), kExact * unit);
    for (const Duality::View& v : d->views) {
      EXPECT_FALSE(v.mirrored);
      ASSERT_EQ(v.planes.size(), 16u);
      EXPECT_NEAR(*v.fitPx, 0.1 * v.frame, 1e-12);
      for (const Duality::Touch& t : v.planes) {
        const Eigen::Vector3d from = t.at - truth.centre();
        EXPECT_NEAR(from.dot(truth.shape().inverse() * from), 1, 1e-6) << "it touches on the ellipsoid";
        EXPECT_NEAR((t.at - v.apex).normalized().dot(t.cone.along), 1, 1e-6) << "and along the line of the cone";
      }
    }
  }
}

TEST(Duality, EachOfTwoHighlightsInAFrameHasItsOwnResidual) {
  Inspection in = seen(lens(), 4);
  ModelFit& fit = *in.models["primal"].fits[0].fit;
  fit.frames = {0, 1, 1, 3};
  in.views[2].frame = 1;
  const auto d = dualityOf(in, 0, "lamp", "primal");
  ASSERT_TRUE(d) << d.failure().message();
  ASSERT_EQ(d->views.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(d->views[i].fitPx, fit.residualPx[i]) << i;
}

TEST(Duality, OneViewIsOneSliceOfTheDual) {
  const auto d = dualityOf(seen(lens(), 3), 0, "lamp", "primal");
  ASSERT_TRUE(d);
  for (const Duality::View& v : d->views)
    for (const Duality::Touch& t : v.planes)
      EXPECT_NEAR(t.dual->dot(v.apex - d->chart.centre), d->chart.radius * d->chart.radius, 1e-9);
}

/// What the words in the window claim of the equations pi^T Q* pi = 0: five from one view; any two share two planes, so eight
/// from two; the nine that an ellipsoid needs from three.
TEST(Duality, ThreeViewsDetermineTheQuadric) {
  const int expected[] = {0, 5, 8, 9, 9};
  for (int views = 1; views <= 4; ++views) {
    const auto d = dualityOf(seen(lens(), views), 0, "lamp", "primal", 20);
    ASSERT_TRUE(d);
    Eigen::MatrixXd rows(20 * views, 10);
    int row = 0;
    for (const Duality::View& v : d->views)
      for (const Duality::Touch& t : v.planes) {
        // About the ellipsoid and in its size: the rank is that of the geometry, not of far origins.
        Eigen::Vector4d pi;
        pi << t.dual->normalized(), -t.away / d->chart.radius;
        int at = 0;
        for (int i = 0; i < 4; ++i)
          for (int j = i; j < 4; ++j) rows(row, at++) = (i == j ? 1 : 2) * pi(i) * pi(j);
        ++row;
      }
    const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(rows).singularValues();
    EXPECT_EQ((s.array() > 1e-9 * s(0)).count(), expected[views]) << views << " views";
  }
}

TEST(Duality, TheGapIsWhatAnOutlineThatIsTooLargeLeaves) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double r = 0.3, wider = 0.05;
  const auto d = dualityOf(seen(Ellipsoid(pose, Eigen::Vector3d::Constant(r)), 3, 1, wider), 0, "", "");
  ASSERT_TRUE(d);
  for (const Duality::View& v : d->views) {
    const double distance = v.apex.norm(), cosine = std::sqrt(1 - r * r / (distance * distance));
    // The half angle t of the cone grows by cos^2 t e / f, and the distance of its planes by D cos t times that.
    const double expected = distance * std::pow(cosine, 3) * wider / 800;
    EXPECT_NEAR(v.rmsGap, expected, 0.002 * expected);
    // A plane that is farther has a nearer point: relatively the same, to first order.
    for (const Duality::Touch& t : v.planes) EXPECT_GT(t.gap, 0) << "beside the ball, not within it";
    for (const Duality::Touch& t : v.planes)
      EXPECT_NEAR(t.dual->norm(), d->chart.radius * d->chart.radius / (r + expected), 1e-6);
  }
  EXPECT_NEAR(d->rmsOffDual, d->rmsGap / r, 0.01 * d->rmsGap / r);
}

TEST(Duality, MirrorsTheCamerasWhereTheModelDoes) {
  InspectionRequest q;
  q.models = {"primal", "canonical", "limit-angle"};
  q.train = "first:4";
  const Inspection inspection = inspect(exactScene(sphere(0.5), 6), q);
  const auto canonical = dualityOf(inspection, 5, "lamp", "canonical");
  ASSERT_TRUE(canonical) << canonical.failure().message();
  ASSERT_EQ(canonical->views.size(), 4u);
  for (const Duality::View& v : canonical->views) {
    EXPECT_TRUE(v.mirrored);
    // The mirror lies on the ball, so that the virtual camera is inside of it or behind.
    const Eigen::Vector3d eye = inspection.scene->frames[std::size_t(v.frame)].camera.centreInWorld(),
                          half = 0.5 * (eye + v.apex);
    EXPECT_LT(v.apex.z(), 0);
    EXPECT_NEAR((half - Eigen::Vector3d(0, 0, -0.5)).cross(eye - v.apex).norm() / (eye - v.apex).norm(), 0, 0.5)
        << "halfway to it lies the tangent plane";
  }
  const auto primal = dualityOf(inspection, 5, "lamp", "primal");
  ASSERT_TRUE(primal) << primal.failure().message();
  EXPECT_FALSE(primal->views.front().mirrored);
  const auto onPlane = dualityOf(inspect(exactScene(sheet(0), 6), q), 5, "lamp", "primal");
  ASSERT_TRUE(onPlane) << onPlane.failure().message();
  EXPECT_GT(primal->rmsOffDual, 3 * onPlane->rmsOffDual) << "off the plane the cameras themselves see no one ellipsoid";
  const auto other = dualityOf(inspection, 5, "lamp", "limit-angle");
  ASSERT_TRUE(other);
  EXPECT_EQ(other->model, "canonical") << "limit-angle has no ellipsoid: the richest that has one";
}

TEST(Duality, OfAFlatEllipsoidIsATube) {
  const auto d = dualityOf(seen(Ellipsoid(Eigen::Isometry3d::Identity(), {0.3, 0.2, 0}), 3), 0, "lamp", "primal");
  ASSERT_TRUE(d) << d.failure().message();
  EXPECT_FALSE(d->dual);
  EXPECT_NEAR(d->chart.radius, std::sqrt(0.06), 1e-12);
  EXPECT_LT(d->rmsOffDual, kExact);
  for (const Duality::View& v : d->views)
    for (const Duality::Touch& t : v.planes)  // (a n_x)^2 + (b n_y)^2 = h^2, whatever n_z is
      EXPECT_NEAR(std::hypot(0.3 * t.dual->x(), 0.2 * t.dual->y()), 0.06, 1e-9);
}

TEST(Duality, SaysWhyThereIsNone) {
  Inspection hyperboloid = seen(lens(), 3);
  Eigen::Matrix4d q = Eigen::Matrix4d::Identity();
  q(0, 0) = -1;
  hyperboloid.models["primal"].fits[0].fit->family = EllipsoidFit{{q}, std::nullopt};
  const auto none = dualityOf(hyperboloid, 0, "lamp", "primal");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::NotAnEllipsoid);
  EXPECT_NE(none.failure().message().find("hyperboloid"), std::string::npos) << none.failure().message();

  Inspection unseen = seen(lens(), 3);
  for (TrainingView& v : unseen.views) v.highlight.ellipse.reset();
  EXPECT_EQ(dualityOf(unseen, 0, "lamp", "primal").failure().reason, Reason::TooFewViews);
  Inspection empty = seen(lens(), 2);
  empty.models.clear();
  EXPECT_EQ(dualityOf(empty, 0, "lamp", "").failure().reason, Reason::NotAnEllipsoid);
}

}  // namespace duality_tests
}  // namespace glint
