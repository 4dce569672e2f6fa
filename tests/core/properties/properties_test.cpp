// SPDX-License-Identifier: BSD-3-Clause
// Laws of the whole pipeline on random scenes: what changes the world, its unit, the photographs' number of pixels, the order of frames or
// how often a frame is given moves the answer along and changes nothing else.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <numeric>
#include <random>
#include <set>

#include "tests/core/properties/answers.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

int numberFrom(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text && *text ? std::atoi(text) : otherwise;
}

/// The scenes of this run: GLINT_PROPERTY_SCENES of them (nightly: more), from GLINT_PROPERTY_SEED on.
const int kScenes = numberFrom("GLINT_PROPERTY_SCENES", 10);
const unsigned kSeed = static_cast<unsigned>(numberFrom("GLINT_PROPERTY_SEED", 1800));

class Properties : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (fs::path(testing::TempDir()) / "glint-properties-XXXXXX").string();  // tests run beside each other
    folder_ = mkdtemp(pattern.data());
    std::cout << kScenes << " random scenes, seed " << kSeed << " (GLINT_PROPERTY_SCENES, GLINT_PROPERTY_SEED)\n";
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static const RandomScene& scene(int number) {
    static std::map<int, RandomScene> made;
    const auto found = made.find(number);
    return found != made.end() ? found->second : made.emplace(number, randomScene(draw(number, kSeed), folder_)).first->second;
  }
  static InspectionRequest requestFor(const RandomScene& s) {
    InspectionRequest q;
    q.train.clear();
    for (const std::string& id : s.training) q.train += (q.train.empty() ? "" : ",") + id;
    q.settings.set("fit.most_residual", 10.0);  // a plane's model on a sphere is wrong alike in both scenes: what moves along counts
    return q;
  }
  static const Inspection& answer(int number) {
    static std::map<int, Inspection> made;
    const auto found = made.find(number);
    return found != made.end() ? found->second : made.emplace(number, inspect(scene(number).scene, requestFor(scene(number)))).first->second;
  }
  static fs::path folder_;
};
fs::path Properties::folder_;

void print(const std::string& law, const Differences& d) {
  std::cout << law << ": " << d.fits << " fits, " << d.contours << " contours\n";
  for (const auto& [name, worst] : d.worst)
    if (worst > 0) std::cout << "  " << worst << "  " << name << "  (" << d.where.at(name) << ")\n";
}

TEST_F(Properties, Motion) {
  Differences d;
  for (int i = 0; i < kScenes; ++i) {
    std::mt19937 random(kSeed + static_cast<unsigned>(i));
    std::uniform_real_distribution<double> u(-1, 1);
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.rotate(Eigen::AngleAxisd(3 * u(random), Eigen::Vector3d(u(random), u(random), u(random)).normalized()));
    motion.pretranslate(Eigen::Vector3d(u(random), u(random), u(random)));
    const RandomScene other = moved(scene(i), motion, 1, folder_);
    Back back;
    back.linear = motion.linear().transpose();
    back.shift = -back.linear * motion.translation();
    compare(answer(i), inspect(other.scene, requestFor(other)), back, scene(i).what.text(), d);
  }
  print("motion", d);
}

TEST_F(Properties, Scale) {
  for (const double scale : {1e-3, 1e3}) {
    Differences d;
    for (int i = 0; i < kScenes; ++i) {
      const RandomScene other = moved(scene(i), Eigen::Isometry3d::Identity(), scale, folder_);
      Back back;
      back.scale = 1 / scale;
      compare(answer(i), inspect(other.scene, requestFor(other)), back, scene(i).what.text(), d);
    }
    print("scale " + std::to_string(scale), d);
  }
}

TEST_F(Properties, Mirror) {
  Differences d;
  for (int i = 0; i < kScenes; ++i) {
    const RandomScene other = mirrored(scene(i), folder_);
    Back back;
    back.linear(0, 0) = -1;
    back.pixelFactor = {-1, 1};
    back.pixelOffset = {640, 0};
    compare(answer(i), inspect(other.scene, requestFor(other)), back, scene(i).what.text(), d);
  }
  print("mirror", d);
}

TEST_F(Properties, Zoom) {
  Differences d;
  for (int i = 0; i < kScenes; ++i) {
    constexpr int kZoom = 2;
    const RandomScene other = zoomed(scene(i), kZoom);
    InspectionRequest q = requestFor(other);
    for (const char* key : {"light.robust_px", "predict.seed_step", "predict.level_set_step"}) q.settings.set(key, kZoom * q.settings.number(key));
    Back back;
    back.pixelFactor = Pixel::Constant(1.0 / kZoom);
    back.pixelOffset = Pixel::Constant((1.0 / kZoom - 1) / 2);
    compare(answer(i), inspect(other.scene, q), back, scene(i).what.text(), d);
  }
  print("zoom", d);
}

TEST_F(Properties, Order) {
  Differences d;
  for (int i = 0; i < kScenes; ++i) {
    std::vector<int> order(kTraining + kHeldOut);
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 random(kSeed + static_cast<unsigned>(i));
    std::shuffle(order.begin(), order.end(), random);
    const RandomScene other = reordered(scene(i), order);
    compare(answer(i), inspect(other.scene, requestFor(other)), {}, scene(i).what.text(), d);
  }
  print("order", d);
}

TEST_F(Properties, EveryFrameTwice) {
  Differences d;
  for (int i = 0; i < kScenes; ++i) {
    std::vector<int> all(kTraining + kHeldOut);
    std::iota(all.begin(), all.end(), 0);
    const RandomScene other = repeated(scene(i), all);
    compare(answer(i), inspect(other.scene, requestFor(other)), {}, scene(i).what.text(), d);
  }
  print("every frame twice", d);
}

TEST_F(Properties, OneFrameTwice) {
  Differences d;
  for (int i = 0; i < kScenes; ++i) {
    if (scene(i).what.noisy) continue;
    const RandomScene other = repeated(scene(i), {i % kTraining});
    compare(answer(i), inspect(other.scene, requestFor(other)), {}, scene(i).what.text(), d);
  }
  print("one frame twice", d);
}

/// The sampler makes what it says: counted in the scenes themselves.
TEST_F(Properties, ScenesOfEveryKind) {
  std::map<std::string, int> tally;
  for (int i = 0; i < kScenes; ++i) {
    const RandomScene& s = scene(i);
    const SurfaceSource& body = s.scene->surfaces.at("body");
    ++tally[body.mesh ? "mesh" : body.analytic->type];
    std::set<std::string> lights;
    for (const Frame& f : s.scene->frames)
      for (const Highlight& h : f.highlights) lights.insert(h.light);
    ++tally[std::to_string(lights.size()) + " lights"];
    ++tally[s.what.noisy ? "noisy" : "exact"];
    ++tally[s.what.radiance ? "radiance" : "limit angle"];
  }
  for (const auto& [name, count] : tally) std::cout << count << " " << name << "\n";
  for (const char* name : {"plane", "sphere", "cylinder", "ellipsoid", "mesh", "1 lights", "2 lights", "noisy", "exact", "radiance", "limit angle"})
    EXPECT_GT(tally[name], 0) << name;
}

}  // namespace
}  // namespace glint
