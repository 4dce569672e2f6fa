// SPDX-License-Identifier: BSD-3-Clause
// The step of the light says whose light it is, from which rays, and when its sigma is no measure of its error.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "core/advise/explain.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr double kCopied = 1e-12;  // m: numbers that are handed on, not computed

const Eigen::Vector3d kLamp(0.1, 0.2, 1.4);  // of litScene

ExplainStep stepOf(const Inspection& inspection, int frame, const std::string& model, const std::string& id) {
  for (const ExplainStep& s : explain(inspection, frame, 0, model).steps)
    if (s.id == id) return s;
  throw std::runtime_error("no step " + id);
}

/// The first number with this symbol or, where that is "", this name.
std::vector<double> number(const ExplainStep& s, const std::string& symbol, const std::string& name = "") {
  for (const ExplainNumber& n : s.numbers)
    if (symbol.empty() ? n.name == name : n.symbol == symbol) return n.values;
  ADD_FAILURE() << s.id << " has no number " << symbol << name;
  return {0, 0, 0};
}

const BrokenAssumption* broken(const ExplainStep& s, const std::string& id) {
  const auto it = std::find_if(s.broken.begin(), s.broken.end(), [&](const BrokenAssumption& b) { return b.id == id; });
  return it == s.broken.end() ? nullptr : &*it;
}

Inspection inspected(std::shared_ptr<Scene> scene, const std::string& train) {
  InspectionRequest q;
  q.models = {"canonical"};
  q.train = train;
  return inspect(std::move(scene), q);
}

TEST(ExplainLight, AModelWithALightOfItsOwnShowsThatOne) {
  Inspection inspection = inspected(litScene(sphere(0.5), 6), "first:4");
  const Eigen::Vector3d common = inspection.lightFor(0, "lamp")->light.position(),
                        own = kLamp + Eigen::Vector3d(0.03, -0.02, 0.05);
  ModelResult other = inspection.models.at("canonical");  // found a light of its own from the same views
  other.model = "reflectance";
  other.fits.at(0).fit->model = "reflectance";
  other.fits.at(0).fit->lightEstimate = Light::at(own);
  other.fits.at(0).fit->lightCovariance = 4e-6 * Eigen::Matrix3d::Identity();
  inspection.models["reflectance"] = other;

  const ExplainStep light = stepOf(inspection, 1, "reflectance", "light");
  const std::vector<double> shown = number(light, "L"), shared = number(light, "L\u2080");
  EXPECT_LT((Eigen::Vector3d(shown[0], shown[1], shown[2]) - own).norm(), kCopied);
  EXPECT_LT((Eigen::Vector3d(shared[0], shared[1], shared[2]) - common).norm(), kCopied);
  EXPECT_NEAR(number(light, "σ")[0], 2e-3, kCopied) << "that of the light that is shown";
  EXPECT_NEAR(number(light, "", "distance from the true light")[0], (own - kLamp).norm(), kCopied);
  // The walk is one of the common light: said where it is shown.
  for (const char* id : {"limit-angles", "canonical-ellipse"}) {
    const ExplainStep walk = stepOf(inspection, 1, "reflectance", id);
    const BrokenAssumption* said = broken(walk, "other-light");
    ASSERT_TRUE(said) << id;
    EXPECT_NEAR(said->numbers.at(0).values.at(0), (own - common).norm(), kCopied);
    EXPECT_FALSE(broken(stepOf(inspection, 1, "canonical", id), "other-light")) << id << ": it took the common one over";
  }
  const ExplainStep plain = stepOf(inspection, 1, "canonical", "light");
  EXPECT_TRUE(std::none_of(plain.numbers.begin(), plain.numbers.end(), [](const auto& n) { return n.symbol == "L\u2080"; }));
  const std::vector<double> l = number(plain, "L");
  EXPECT_LT((Eigen::Vector3d(l[0], l[1], l[2]) - common).norm(), kCopied);
}

TEST(ExplainLight, WithAModelForEachSurfaceTheRaysAreThoseOfTheSurfaceConcerned) {
  const auto scene = litScene(sphere(0.5), 8);
  scene->surfaces["other"] = sphere(0.8);
  for (int i = 5; i < 8; ++i) {  // five frames see the one body, three the other
    Frame& f = scene->frames[std::size_t(i)];
    f.surface = "other";
    f.highlights = exactContours(sphere(0.8), f.camera, {"lamp", kLamp});
  }
  const Inspection inspection = inspected(scene, "per-surface");
  ASSERT_EQ(inspection.lights.size(), 2u);
  for (const auto& [frame, rays] : {std::pair(0, 5), std::pair(7, 3)}) {
    const ExplainStep light = stepOf(inspection, frame, "canonical", "light");
    ASSERT_FALSE(light.failure) << frame;
    EXPECT_EQ(number(light, "", "reflected rays")[0], rays) << frame;
    EXPECT_TRUE(std::any_of(light.numbers.begin(), light.numbers.end(), [](const auto& n) { return n.symbol == "σ"; })) << frame;
  }
  // With one model for all of them the rays of all count.
  EXPECT_EQ(number(stepOf(inspected(scene, "0-7"), 0, "canonical", "light"), "", "reflected rays")[0], 8);
}

TEST(ExplainLight, AnErrorOfManySigmaIsSaid) {
  Inspection inspection = inspected(litScene(sphere(0.5), 6), "first:4");
  LightEstimate& estimate = *inspection.lights.at({"lamp", {}});
  estimate.covariance = 1e-6 * Eigen::Matrix3d::Identity();  // 1 mm
  for (const double sigmas : {35.0, 3.0}) {
    estimate.light = Light::at(kLamp + Eigen::Vector3d(0, 1e-3 * sigmas, 0));
    for (ModelResult::Fit& fit : inspection.models.at("canonical").fits) fit.fit->lightEstimate = estimate.light;
    const ExplainStep light = stepOf(inspection, 1, "canonical", "light");
    const BrokenAssumption* said = broken(light, "light-beyond-sigma");
    ASSERT_EQ(said != nullptr, sigmas > 30) << sigmas;
    if (said) {
      EXPECT_NEAR(said->numbers.at(0).values.at(0), sigmas, 1e-6);
    }
  }
}

}  // namespace
}  // namespace glint
