// SPDX-License-Identifier: BSD-3-Clause
// What the lessons claim, on their own sessions, against values from elsewhere: the mirror equation, closed-form surfaces, true
// lights.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/geometry/epipolar.h"
#include "tests/sessions/taught.h"

namespace glint {
namespace {

using namespace taught;

constexpr double kContour = 2e-3;  // px: contours and peaks of the lessons are stored to 0.001 px

bool breaks(const ExplainStep& s, const std::string& id) {
  for (const BrokenAssumption& b : s.broken)
    if (b.id == id) return true;
  return false;
}

const Ellipsoid& ellipsoidOf(const Inspection& in, const std::string& model) {
  return *in.models.at(model).fits.at(0).fit->ellipsoid();
}

/// Contour errors of the held-out frames of a model, %.
std::vector<double> errors(const Inspection& in, const std::string& model) {
  std::vector<double> all;
  for (const FrameComparison& c : in.models.at(model).frames)
    for (const FrameComparison::Row& row : c.rows)
      if (in.isHeldOut(c.frame) && row.metrics) all.push_back(row.metrics->contourErrorPct);
  return all;
}

TEST(Lessons, EachOpensInTheExplainLayoutWithItsTexts) {
  std::ifstream file(GLINT_SOURCE_DIR "/resources/explain/lessons.json");
  const nlohmann::json texts = nlohmann::json::parse(file);
  ASSERT_EQ(texts["lessons"].size(), 8u);
  const std::set<std::string> steps(explainSteps().begin(), explainSteps().end());
  for (const auto& text : texts["lessons"]) {
    const std::string id = text["id"];
    const Session session = readSession(std::string(GLINT_SOURCE_DIR "/sessions/lessons/") + id + "/" + id + ".glint");
    EXPECT_EQ(session.view.layout, "explain") << id;
    EXPECT_EQ(session.view.options.at("explain/lesson"), id);
    for (const char* key : {"title", "see"}) EXPECT_FALSE(text.at(key).get<std::string>().empty()) << id << key;
    EXPECT_GE(text.at("questions").size(), 3u) << id;
    for (const auto& question : text.at("questions"))
      for (const char* key : {"ask", "answer"}) EXPECT_FALSE(question.at(key).get<std::string>().empty()) << id << key;
    for (const std::string step : text.at("steps")) {
      EXPECT_TRUE(steps.count(step)) << id << ": " << step;
      EXPECT_TRUE(text.at("remarks").contains(step)) << id << ": " << step;
    }
    EXPECT_EQ(text.at("remarks").size(), text.at("steps").size()) << id;
  }
}

TEST(Lessons, MirrorTheVirtualCameraSeesTheLampAtThePeak) {
  const Inspection& in = lesson("mirror").inspection;
  const Eigen::Vector3d lamp = in.scene->lights.at(0).lamp.position();
  for (int frame = 0; frame < 5; ++frame) {
    const Explanation e = explain(in, frame, 0, "canonical");
    const Eigen::Vector3d eye = in.scene->frames[std::size_t(frame)].camera.centreInWorld();
    EXPECT_NEAR(number(stepOf(e, "virtual-camera"), "centre of the virtual camera", 2), -eye.z(), 1e-9) << "the table is z = 0";
    ASSERT_TRUE(e.view && e.view->seen);
    const Eigen::Vector3d seen = e.view->seen->virtualCamera.matrix * lamp.homogeneous();
    EXPECT_LT((Pixel(seen.head<2>() / seen.z()) - e.view->highlight.peak).norm(), kContour);
    for (const std::string way : {"in", "across"})
      EXPECT_NEAR(number(stepOf(e, "virtual-camera"), "field of view " + way + " the plane of incidence, this mirror"),
                  number(stepOf(e, "virtual-camera"), "field of view " + way + " the plane of incidence, flat mirror"), 1e-9);
  }
}

TEST(Lessons, PlanePrimalIsTheMirrorImageOfDual) {
  const Inspection& in = lesson("plane").inspection;
  const Ellipsoid &primal = ellipsoidOf(in, "primal"), &dual = ellipsoidOf(in, "dual");
  const Eigen::Vector3d mirrored(dual.centre().x(), dual.centre().y(), -dual.centre().z());
  EXPECT_LT((primal.centre() - mirrored).norm(), 1e-4) << "m; the contours are known to 0.001 px";
  EXPECT_LT((primal.semiAxes() - dual.semiAxes()).norm(), 1e-4);
  for (const char* model : {"primal", "dual", "canonical", "limit-angle"})
    for (const double e : errors(in, model)) EXPECT_LT(e, 0.03) << model << ", %: a hundredth of a pixel";
  EXPECT_TRUE(stepOf(explain(in, 4, 0, "primal"), "virtual-camera").broken.empty());
}

TEST(Lessons, SphereEpipolarTangentsMissForRealCamerasAndNearlyMeetForVirtualOnes) {
  const Inspection& in = lesson("sphere").inspection;
  const Explanation a = explain(in, 0, 0, "primal"), b = explain(in, 3, 0, "primal");
  ASSERT_TRUE(a.view && b.view);
  const auto missPx = [&](const Projection& p, const Projection& q) {
    const Outcome<EpipolarTangents> t = epipolarTangents(p, *a.view->highlight.ellipse, q, *b.view->highlight.ellipse);
    return t ? t->rmsPx() : std::nan("");
  };
  const double real = missPx(a.view->camera.projection(), b.view->camera.projection());
  const double mirrored = missPx(a.view->seen->virtualCamera, b.view->seen->virtualCamera);
  RecordProperty("real_px", std::to_string(real));
  RecordProperty("virtual_px", std::to_string(mirrored));
  EXPECT_GT(real, 10 * mirrored) << real << " px for real cameras, " << mirrored << " px for virtual ones";
  EXPECT_TRUE(breaks(stepOf(a, "virtual-camera"), "primal-off-plane"));
  EXPECT_FALSE(breaks(stepOf(a, "virtual-camera"), "dual-curvature-varies")) << "every place of a sphere bends alike";
  EXPECT_NEAR(number(stepOf(a, "tangent-plane"), "principal curvature"), 2, 1e-9) << "1 / 0.5 m";
  for (const double e : errors(in, "primal")) EXPECT_GT(e, 4) << "%";
  for (const double e : errors(in, "limit-angle")) EXPECT_LT(e, 0.01) << "%";
}

TEST(Lessons, BentMirrorItsFieldOfViewFollowsTheMirrorEquation) {
  const Inspection& in = lesson("bent-mirror").inspection;
  const double curvatures[] = {-0.2, 0, 0.5, 1, 2};
  const Eigen::Vector3d lamp = in.scene->lights.at(0).lamp.position();
  double before = 0;
  for (int k = 0; k < 5; ++k) {
    const int frame = 3 * k + 1;  // camera and lamp in the plane x = 0, square to the bend
    const Explanation e = explain(in, frame, 0, "canonical");
    ASSERT_TRUE(e.view && e.view->seen && e.view->surface);
    const Eigen::Vector3d eye = e.view->camera.centreInWorld(), at = e.view->seen->brightest.point.position;
    EXPECT_LT(std::abs(at.x()), 1e-4);
    const double d = (eye - at).norm(), r = (lamp - at).norm(), cosine = (eye - at).normalized().z(), kappa = curvatures[k];
    // Across the bend (sagittal): alpha(w) = w (kappa + (1/d + 1/r) / (2 cos theta)), and rays a distance 2 w apart leave as if
    // from an image of the camera at d' behind the mirror: 1/d' = 1/d + 2 kappa cos theta.
    const double limit = 0.07 * std::sqrt(std::numbers::ln2);
    const double half = limit / (kappa + (1 / d + 1 / r) / (2 * cosine)), field = 2 * half * (1 / d + 2 * kappa * cosine);
    double widest = 0;
    Eigen::Vector3d left{0, 0, 0}, right{0, 0, 0};
    for (const Pixel& p : e.view->highlight.contour.points) {
      const Outcome<SurfacePoint> hit = e.view->surface->firstHit(e.view->camera.ray(p));
      ASSERT_TRUE(hit);
      widest = std::max(widest, hit->position.x());
      const Eigen::Vector3d reflected = reflect((eye - hit->position).normalized(), facing(*hit, eye).normal);
      if (hit->position.x() == widest) right = reflected;
      if (std::abs(hit->position.x() + widest) < 1e-3) left = reflected;
    }
    constexpr double kParaxial = 0.03;  // third-order terms: the highlight spans up to a sixth of the distance
    EXPECT_NEAR(widest / half, 1, kParaxial) << "curvature " << kappa;
    EXPECT_NEAR(std::acos(left.dot(right)) / field, 1, kParaxial) << "curvature " << kappa;
    const ExplainStep& step = stepOf(e, "virtual-camera");
    const std::string across = kappa == 0 ? "across the plane of incidence" : "in the most bent direction";
    const double told = number(step, "field of view " + across + ", this mirror"),
                 flat = number(step, "field of view " + across + ", flat mirror");
    EXPECT_NEAR(told * std::numbers::pi / 180 / field, 1, kParaxial);
    EXPECT_NEAR(flat * std::numbers::pi / 180 / (2 * half / d), 1, kParaxial) << "the same direction as the bent mirror's";
    EXPECT_NEAR(number(step, "distance of the camera from P_B"), d, 1e-9);
    EXPECT_NEAR(number(step, "distance of the light from P_B"), r, 1e-3) << "that light is found, not given";
    EXPECT_NEAR(std::cos(number(step, "angle between N and the view ray") * std::numbers::pi / 180), cosine, 1e-6);
    if (kappa == 1) {  // the numbers of the text
      EXPECT_NEAR(flat, 2.7, 0.05);
      EXPECT_NEAR(told, 10.2, 0.05);
      EXPECT_NEAR(d * (1 / d + 2 * kappa * cosine), 3.8, 0.05);
    }
    EXPECT_GT(told, before) << "more curvature, wider field";
    before = told;
  }
}

TEST(Lessons, PlaneToCylinderOnlyTheWalkFollowsTheBend) {
  const Inspection& in = lesson("plane-to-cylinder").inspection;
  double worstDual = 0, worstCanonical = 0;
  for (const double e : errors(in, "dual")) worstDual = std::max(worstDual, e);
  for (const double e : errors(in, "canonical")) worstCanonical = std::max(worstCanonical, e);
  EXPECT_EQ(errors(in, "canonical").size(), 16u);
  EXPECT_GT(worstDual, 40) << "%";
  EXPECT_LT(worstCanonical, 0.5) << "%";
  EXPECT_FALSE(breaks(stepOf(explain(in, 3, 0, "canonical"), "virtual-camera"), "primal-off-plane"));
  EXPECT_TRUE(breaks(stepOf(explain(in, 4, 0, "canonical"), "virtual-camera"), "primal-off-plane"));
}

/// Mirror points of the turned vase in closed form: local minima of alpha that reach 0, on a grid of height and azimuth.
int mirrorPoints(const Eigen::Vector3d& eye, const Eigen::Vector3d& lamp) {
  constexpr int kRows = 321, kColumns = 161;
  std::vector<double> alpha(kRows * kColumns, 9);
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < kColumns; ++j) {
      const double z = -0.36 + 0.64 * i / (kRows - 1), a = (-140 + 90.0 * j / (kColumns - 1)) * std::numbers::pi / 180;
      const double t = 2 * std::numbers::pi / 0.6, radius = 0.22 - 0.05 * std::cos(t * z), slope = 0.05 * t * std::sin(t * z);
      const Eigen::Vector3d p(radius * std::cos(a), radius * std::sin(a), z);
      const Eigen::Vector3d n = Eigen::Vector3d(std::cos(a), std::sin(a), -slope).normalized();
      const Eigen::Vector3d v = (eye - p).normalized(), l = (lamp - p).normalized();
      if (n.dot(v) > 0 && n.dot(l) > 0)
        alpha[std::size_t(i * kColumns + j)] = std::acos(std::min(1.0, n.dot((v + l).normalized())));
    }
  int count = 0;
  for (int i = 1; i + 1 < kRows; ++i)
    for (int j = 1; j + 1 < kColumns; ++j) {
      const double here = alpha[std::size_t(i * kColumns + j)];
      bool least = here < 0.012;  // rad: half a cell of the grid turns the normal by up to 0.01
      for (int k = 0; k < 9 && least; ++k)
        if (k != 4) least = here < alpha[std::size_t((i + k / 3 - 1) * kColumns + j + k % 3 - 1)];
      count += least;
    }
  return count;
}

TEST(Lessons, WaistTheHighlightSplitsAfterItsMirrorPoint) {
  const Inspection& in = lesson("waist").inspection;
  const Eigen::Vector3d lamp = in.scene->lights.at(0).lamp.position();
  const std::size_t highlights[] = {1, 1, 1, 1, 1, 1, 2, 2, 2, 2};
  std::vector<int> points;
  for (int frame = 0; frame < 10; ++frame) {
    EXPECT_EQ(in.evidence[std::size_t(frame)].highlights.size(), highlights[frame]) << "frame " << frame;
    points.push_back(mirrorPoints(in.scene->frames[std::size_t(frame)].camera.centreInWorld(), lamp));
    std::size_t predicted = 0;
    for (const FrameComparison& c : in.models.at("canonical").frames)
      if (c.frame == frame) predicted = c.prediction.highlights().size();
    EXPECT_EQ(predicted > 0, points.back() > 0) << "frame " << frame << ": a walk starts at a mirror point";
    EXPECT_LE(predicted, std::size_t(points.back())) << "frame " << frame;
    if (frame >= 6) {
      EXPECT_EQ(predicted, 2u) << "frame " << frame;
    }
  }
  EXPECT_EQ(points.front(), 0) << "a highlight without a mirror point";
  EXPECT_EQ(points[4], 2) << "two mirror points in one highlight";
  EXPECT_EQ(points.back(), 2);
  EXPECT_EQ(in.evidence[4].highlights.size(), 1u);
  for (const double e : errors(in, "limit-angle")) EXPECT_LT(e, 0.05) << "%";
  EXPECT_EQ(errors(in, "limit-angle").size(), 7u) << "frames 0, 2, 4, and both halves of 6 and 8";
  // Opposite curvatures at the waist, equal signs on the belly.
  const Explanation belly = explain(in, 9, 0, "canonical"), waist = explain(in, 9, 1, "canonical");
  const auto gaussian = [&](const Explanation& e) {
    const std::vector<ExplainNumber>& n = stepOf(e, "tangent-plane").numbers;
    double product = 1;
    for (const ExplainNumber& k : n)
      if (k.name == "principal curvature") product *= k.values[0];
    return product;
  };
  EXPECT_LT(gaussian(belly) * gaussian(waist), 0);
}

}  // namespace
}  // namespace glint
