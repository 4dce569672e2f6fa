// SPDX-License-Identifier: BSD-3-Clause
// Laws of the whole pipeline on random scenes: what changes the world, its unit, the photographs' number of pixels, the order of
// frames or how often a frame is given moves the answer along and changes nothing else.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <random>
#include <set>

#include "tests/core/properties/answers.h"
#include "tests/sanitizers/cases.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

int numberFrom(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text && *text ? std::atoi(text) : otherwise;
}

constexpr int kUsualScenes = 10, kSanitizedScenes = 1;

/// The scenes of this run: GLINT_PROPERTY_SCENES of them (nightly: more) from number GLINT_PROPERTY_FIRST on; the seed of number
/// 0 is GLINT_PROPERTY_SEED. One scene alone shows what a law finds there.
const int kScenes = numberFrom("GLINT_PROPERTY_SCENES", kSanitized ? kSanitizedScenes : kUsualScenes),
          kFirst = numberFrom("GLINT_PROPERTY_FIRST", 0);
const unsigned kSeed = static_cast<unsigned>(numberFrom("GLINT_PROPERTY_SEED", 1800));

/// Numbers of this run's scenes; by default also scenes that a law once found something in.
std::vector<int> numbers(const std::vector<int>& once = {}) {
  std::vector<int> all(static_cast<std::size_t>(kScenes));
  std::iota(all.begin(), all.end(), kFirst);
  for (const int n : once)
    if (kFirst == 0 && kScenes > 1 && n >= kScenes) all.push_back(n);
  return all;
}

class Properties : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (fs::path(testing::TempDir()) / "glint-properties-XXXXXX").string();  // tests run beside each other
    folder_ = mkdtemp(pattern.data());
    std::cout << kScenes << " random scenes from number " << kFirst << " on, seed " << kSeed
              << " (GLINT_PROPERTY_SCENES, _FIRST, _SEED)\n";
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
    q.settings.set("fit.most_residual",
                   10.0);  // a plane's model on a sphere is wrong alike in both scenes: what moves along counts
    return q;
  }
  static const Inspection& answer(int number) {
    static std::map<int, Inspection> made;
    const auto found = made.find(number);
    return found != made.end() ? found->second
                               : made.emplace(number, inspect(scene(number).scene, requestFor(scene(number)))).first->second;
  }
  static fs::path folder_;
};
fs::path Properties::folder_;

/// What a law allows, in the units of Differences.
struct Tolerances {
  double light, limitAngle, roughness, centre, shape, contourPx, peakPx, errorPx, ellipsePct, iou;
  double of(Quantity q) const {
    const double all[kQuantities] = {light, limitAngle, roughness, centre, shape, contourPx, peakPx, errorPx, ellipsePct, iou};
    return all[static_cast<int>(q)];
  }
};

/// A part in 1e9 of the answer's own size; of a pixel coordinate: of the picture's width.
constexpr double kSame = 1e-9, kSamePx = 641e-9;
/// The bundle stops reweighting when a round moves light and limit angle by less than 1e-9 of their unit sphere, and the fit of a
/// lobe when a round moves light and log roughness by as much; the round that they do not take would move them by about as much
/// again. Distances of a light that is farther than the scene's size, and the next stages, magnify that a few times.
constexpr double kStopped = 1e-8;
/// What the stopping tolerance of the light leaves in the shape of an ellipsoid about it, whose thin axis the contours hardly
/// see.
constexpr double kStoppedShape = 1e-6;
/// In a picture 641 px wide.
constexpr double kStoppedPx = 641 * kStopped;
/// An extent that the contours hardly show trades with the limit angle: little decides between them, and the round-off of the
/// residuals moves the angle by a few parts in 1e8 (number 97: 1e-8 whatever the solver's tolerance is below 1e-13).
constexpr double kTradedRoundOff = 1e-7;
constexpr Tolerances kMoved{kStopped,   kTradedRoundOff, kStopped,   kStopped,       kStoppedShape,
                            kStoppedPx, kStoppedPx,      kStoppedPx, 100 * kStopped, kStopped};
/// The fit of a lobe also stops where a step gains less than 1e-10 of the cost (radiance_problem.cpp). With 360 noisy points that
/// is 2e-4 of a standard deviation, which is some 1e-3 of the light's distance.
constexpr double kStoppedLobe = 1e-7, kStoppedLobePx = 641 * kStoppedLobe;
constexpr Tolerances kMovedLobe{kStoppedLobe,   kStoppedLobe,   kStoppedLobe,   kStoppedLobe,       kStoppedShape,
                                kStoppedLobePx, kStoppedLobePx, kStoppedLobePx, 100 * kStoppedLobe, kStoppedLobe};

/// Prints the worst of every quantity and checks it. Every model must have been compared; a few scenes may all refuse one. @param
/// ofLobe  the tolerances of `reflectance`
void expectWithin(const Tolerances& tolerances, const Tolerances& ofLobe, const Differences& d, const std::string& law,
                  const std::vector<std::string>& models) {
  std::cout << law << "\n";
  int compared = 0;
  for (const std::string& model : models) {
    const auto count = [&](const std::map<std::string, int>& counts) { return counts.count(model) ? counts.at(model) : 0; };
    std::cout << "  " << model << ": " << count(d.fits) << " fits, " << count(d.contours) << " contours\n";
    if (kScenes >= kUsualScenes) {
      EXPECT_GT(count(d.fits), 0) << law << ": " << model << " was never compared";
      EXPECT_GT(count(d.contours), 0) << law << ": " << model << " was never compared";
    }
    compared += count(d.fits) + count(d.contours);
  }
  for (const auto& [at, worst] : d.worst) {
    std::cout << "  " << worst.difference << "  " << at.first << ": " << nameOf(at.second) << "  (" << worst.where << ")\n";
    EXPECT_LE(worst.difference, (at.first == "reflectance" ? ofLobe : tolerances).of(at.second))
        << law << ": " << at.first << ": " << nameOf(at.second) << " (" << worst.where << ")";
  }
  static std::map<const testing::TestInfo*, int> sums;
  testing::Test::RecordProperty("compared", sums[testing::UnitTest::GetInstance()->current_test_info()] += compared);
}
const std::vector<std::string> kAllModels{"primal", "dual", "canonical", "limit-angle", "reflectance"};

TEST_F(Properties, RigidMotionOfTheWorld) {
  Differences d;
  for (const int i : numbers({56, 97})) {
    std::mt19937 random(scene(i).what.seed);
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
  expectWithin(kMoved, kMovedLobe, d, "rigid motion of the world", kAllModels);
}

TEST_F(Properties, UnitOfTheWorld) {
  for (const double scale : {1e-3, 1e3}) {
    Differences d;
    for (const int i : numbers()) {
      const RandomScene other = moved(scene(i), Eigen::Isometry3d::Identity(), scale, folder_);
      Back back;
      back.scale = 1 / scale;
      compare(answer(i), inspect(other.scene, requestFor(other)), back, scene(i).what.text(), d);
    }
    expectWithin(kMoved, kMovedLobe, d, "world times " + std::to_string(scale), kAllModels);
  }
}

/// A mean over a contour is taken at samples half a pixel apart from its first vertex on. In the mirror the walks start at
/// another direction and go the other way round, so other points are sampled; what that does falls with the square of the
/// distance.
constexpr double kSampledPx = 2e-3, kSampledPct = 2e-3;
TEST_F(Properties, Mirror) {
  Differences d;
  for (const int i : numbers({17, 59})) {
    const RandomScene other = mirrored(scene(i), folder_);
    Back back;
    back.linear(0, 0) = -1;
    back.pixelFactor = {-1, 1};
    back.pixelOffset = {640, 0};
    compare(answer(i), inspect(other.scene, requestFor(other)), back, scene(i).what.text(), d);
  }
  Tolerances tolerances = kMoved, ofLobe = kMovedLobe;
  tolerances.errorPx = ofLobe.errorPx = kSampledPx;
  tolerances.ellipsePct = ofLobe.ellipsePct = kSampledPct;
  expectWithin(tolerances, ofLobe, d, "mirror", kAllModels);
}

/// What is stated in pixels does not change with their number: the half pixel over which angles are turned into pixels, the
/// chords of a level set (their distance from the curve, 2e-3 px, a ten-thousandth of a highlight's half width), the hundredth of
/// a pixel that a contour point is worth at best, the samples of means and of the IoU.
constexpr Tolerances kZoomed{2e-6, 2e-6, 2e-6, 2e-4, 1e-2, 2e-3, 2e-4, 2e-3, 1e-2, 1e-3};
/// Between an extent that the contours hardly show and the limit angle little decides: the half pixel moves them a few times as
/// much.
constexpr double kTradedAngle = 1e-5;
/// On a mesh the slope of the radiance jumps at the edges of triangles. The stencil of a brightest pixel is 0.05 px
/// (radiance_field.cpp): across an edge the maximum is known to a fifth of that (7e-3 px in one of 100 scenes).
constexpr double kOverAnEdgePx = 1e-2;

/// Whether a light gets an extent is decided by residuals that can be seen, 0.05 px (training.cpp), so that photographs with more
/// pixels can ask for one. True where the two answers decided differently for that reason; any other difference is a failure.
bool onlyOneSeesAnExtent(const Inspection& a, const Inspection& b, int zoom, const std::string& scene) {
  constexpr double kVisiblePx = 0.05;
  bool differ = false;
  for (const auto& [key, light] : a.lights) {
    const LightEstimate* const other = b.lightOf(key);
    if (!light || !other || light->extent.has_value() == other->extent.has_value()) continue;
    differ = true;
    EXPECT_FALSE(light->extent) << scene;
    EXPECT_TRUE(light->rmsPx <= kVisiblePx && zoom * light->rmsPx > kVisiblePx) << scene << ": " << light->rmsPx << " px";
  }
  return differ;
}

TEST_F(Properties, NumberOfPixels) {
  Differences d, withExtents, onMeshes;
  for (const int i : numbers({17, 21, 26})) {
    constexpr int kZoom = 2;
    const RandomScene other = zoomed(scene(i), kZoom);
    InspectionRequest q = requestFor(other);
    for (const char* key : {"light.robust_px", "predict.seed_step", "predict.level_set_step"})
      q.settings.set(key, kZoom * q.settings.number(key));
    Back back;
    back.pixelFactor = Pixel::Constant(1.0 / kZoom);
    back.pixelOffset = Pixel::Constant((1.0 / kZoom - 1) / 2);
    const Inspection larger = inspect(other.scene, q);
    if (!onlyOneSeesAnExtent(answer(i), larger, kZoom, scene(i).what.text())) {
      compare(answer(i), larger, back, scene(i).what.text(), scene(i).what.kind == Kind::Mesh ? onMeshes : d);
      continue;
    }
    InspectionRequest p = requestFor(scene(i));
    p.settings.set("light.limit_orders", 1);
    q.settings.set("light.limit_orders", 1);
    compare(inspect(scene(i).scene, p), inspect(other.scene, q), back, scene(i).what.text(), withExtents);
  }
  const std::string law = "photographs with twice as many pixels";
  expectWithin(kZoomed, kZoomed, d, law, kAllModels);
  Tolerances overEdges = kZoomed, traded = kZoomed;
  overEdges.peakPx = kOverAnEdgePx;
  expectWithin(kZoomed, overEdges, onMeshes, law + ", meshes", kAllModels);
  traded.limitAngle = kTradedAngle;
  if (!withExtents.fits.empty()) expectWithin(traded, traded, withExtents, law + ", extents asked for", kAllModels);
}

TEST_F(Properties, OrderOfFrames) {
  Differences d;
  for (const int i : numbers()) {
    std::vector<int> order(kTraining + kHeldOut);
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 random(scene(i).what.seed);
    std::shuffle(order.begin(), order.end(), random);
    const RandomScene other = reordered(scene(i), order);
    compare(answer(i), inspect(other.scene, requestFor(other)), {}, scene(i).what.text(), d);
  }
  expectWithin(kMoved, kMovedLobe, d, "order of frames", kAllModels);
}

std::vector<int> allFrames() {
  std::vector<int> all(kTraining + kHeldOut);
  std::iota(all.begin(), all.end(), 0);
  return all;
}
/// One photograph given twice is one observation, so nothing at all changes.
constexpr Tolerances kNothing{};

TEST_F(Properties, EveryFrameTwice) {
  Differences d;
  for (const int i : numbers()) {
    const RandomScene other = repeated(scene(i), allFrames());
    compare(answer(i), inspect(other.scene, requestFor(other)), {}, scene(i).what.text(), d);
  }
  expectWithin(kNothing, kNothing, d, "every frame twice", kAllModels);
}

TEST_F(Properties, OneFrameTwice) {
  Differences d;
  for (const int i : numbers()) {
    const RandomScene other = repeated(scene(i), {i % kTraining});
    compare(answer(i), inspect(other.scene, requestFor(other)), {}, scene(i).what.text(), d);
  }
  expectWithin(kNothing, kNothing, d, "one frame twice", kAllModels);
}

bool hasExtent(const Inspection& inspection) {
  return std::any_of(inspection.lights.begin(), inspection.lights.end(),
                     [](const auto& light) { return light.second && light.second->extent; });
}

/// Equal evidence in other numbers (contours that start elsewhere) has weight. All of it twice leaves a least-squares answer
/// where it is, and on contours that a model explains exactly any weights do. The ellipsoids hold a prior, against which twice
/// the evidence counts more; so does the extent of a light, and where an answer has one, the law is asked of the answer without.
TEST_F(Properties, WeightsOfFrames) {
  Differences all, one;
  for (const int i : numbers({62})) {
    const RandomScene& s = scene(i);
    const RandomScene twice = repeated(s, allFrames(), true);
    InspectionRequest q = requestFor(twice);
    q.models = {"limit-angle"};
    if (hasExtent(answer(i))) {
      InspectionRequest p = requestFor(s);
      p.models = q.models;
      for (InspectionRequest* r : {&p, &q}) r->settings.set("light.limit_orders", 0);
      compare(inspect(s.scene, p), inspect(twice.scene, q), {}, s.what.text() + ", without an extent", all, q.models);
    } else {
      compare(answer(i), inspect(twice.scene, q), {}, s.what.text(), all, q.models);
    }
    if (s.what.noisy || s.what.radiance) continue;
    const RandomScene other = repeated(s, {i % kTraining}, true);
    q.train = requestFor(other).train;
    compare(answer(i), inspect(other.scene, q), {}, s.what.text(), one, q.models);
  }
  expectWithin(kMoved, kMovedLobe, all, "every frame twice, contours started elsewhere", {"limit-angle"});
  expectWithin(kMoved, kMovedLobe, one, "one frame twice, exact contours, started elsewhere", {"limit-angle"});
}

/// What a contour point is worth is found from a fit that counts with it. Where no value agreed with itself, the shape depended
/// on the number of rounds (five of sixty scenes).
TEST_F(Properties, WorthOfAContourPointSettles) {
  int ellipsoids = 0;
  for (const int i : numbers({18, 19, 26}))
    for (const auto& [key, model] : answer(i).models)
      for (const ModelResult::Fit& f : model.fits) {
        if (!f.fit || !f.fit->as<EllipsoidFit>()) continue;
        ++ellipsoids;
        for (const std::string& remark : f.fit->remarks)
          EXPECT_EQ(remark.find("did not settle"), std::string::npos) << key << " " << scene(i).what.text() << ": " << remark;
      }
  EXPECT_GT(ellipsoids, 0);
}

/// The sampler makes what it says: counted in the scenes themselves.
TEST_F(Properties, ScenesOfEveryKind) {
  std::map<std::string, int> tally;
  for (int i = kFirst; i < kFirst + std::max(kScenes, kUsualScenes); ++i) {
    const RandomScene& s = scene(i);
    const SurfaceSource& body = s.scene->surfaces.at("body");
    ++tally[body.shape()];
    std::set<std::string> lights;
    for (const Frame& f : s.scene->frames)
      for (const Highlight& h : f.highlights) lights.insert(h.light);
    ++tally[std::to_string(lights.size()) + " lights"];
    ++tally[s.what.noisy ? "noisy" : "exact"];
    ++tally[s.what.radiance ? "radiance" : "limit angle"];
  }
  for (const auto& [name, count] : tally) std::cout << count << " " << name << "\n";
  for (const char* name :
       {"plane", "sphere", "cylinder", "ellipsoid", "mesh", "1 lights", "2 lights", "noisy", "exact", "radiance", "limit angle"})
    EXPECT_GT(tally[name], 0) << name;
}

}  // namespace
}  // namespace glint
