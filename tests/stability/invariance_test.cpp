// SPDX-License-Identifier: BSD-3-Clause
// What must not change an answer, on random scenes: motion and unit of the world, unit and origin of the pixels, order and
// repeats of views, order and start of contour points, order of lights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "core/geometry/plane.h"
#include "core/light/estimate.h"
#include "core/model/reconstruct.h"
#include "core/model/walk.h"
#include "core/pipeline/inspection.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/stability/scene.h"

namespace glint {
namespace {

using stability::Bent;
using stability::Lamp;
using stability::RealView;
using Real = long double;

/// A part in 1e9 of the answer's own size: what the method asks of every invariance.
constexpr double kSame = 1e-9;

/// The bundle stops reweighting its points when a round moves light and limit angle by less than 1e-9 of their unit sphere; the
/// next round, which it does not take, would move them by about as much.
constexpr double kSameBundle = 5e-9;

/// One observed highlight.
struct View {
  Camera camera;
  std::vector<Pixel> contour;
  Pixel peak;
};
struct Scene {
  AnalyticSpec surface;
  Light light;
  std::vector<View> views;
};

/// A random bent sheet or sphere under a random light, seen by six cameras; contours are level sets of the incident angle, off by
/// `noisePx`.
Scene randomScene(unsigned seed, double noisePx) {
  std::mt19937 rng(seed);
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng); };
  const bool round = seed % 2 == 0;
  const double k = uniform(0.1, 1.5), limit = uniform(0.05, 0.12);
  const Eigen::Vector3d towards = Eigen::Vector3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1).normalized();
  Scene scene{stability::specOf(k, round), Light::at(uniform(1, 3) * towards), {}};
  const Bent<Real> bent{Real(k), round};
  const Lamp<Real> lamp = stability::lampOf<Real>(scene.light);
  std::normal_distribution<double> noise;  // zero is no legal standard deviation
  for (int i = 0; i < 6; ++i) {
    const RealView<Real> view =
        stability::mirrorView(bent, lamp, uniform(-0.25, 0.25), uniform(-0.25, 0.25), uniform(1.2, 1.8), 800);
    View v{view.camera, stability::exactContour(bent, lamp, view, Real(limit), 60, 0.02), {}};
    const auto [x, y] = view.real.pixel(bent.point(view.u0, view.v0));
    v.peak = Pixel(static_cast<double>(x), static_cast<double>(y));
    if (noisePx > 0) {
      for (Pixel& p : v.contour) p += noisePx * Pixel(noise(rng), noise(rng));
      v.peak += noisePx * Pixel(noise(rng), noise(rng));
    }
    scene.views.push_back(std::move(v));
  }
  return scene;
}

/// x -> scale (motion x) of everything.
Scene moved(Scene s, const Eigen::Isometry3d& motion, double scale) {
  if (s.surface.type == "quadric") s.surface.matrix.diagonal() /= scale;
  s.surface.curvature /= scale;
  s.surface.worldFromSurface = motion * s.surface.worldFromSurface;
  s.surface.worldFromSurface.translation() *= scale;
  for (View& v : s.views) {
    v.camera.camFromWorld = v.camera.camFromWorld * motion.inverse();
    v.camera.camFromWorld.translation() *= scale;
  }
  s.light = Light::at(scale * (motion * s.light.position()));
  return s;
}

/// p -> zoom p + shift of all pixels.
Scene rescaled(Scene s, double zoom, const Pixel& shift) {
  Eigen::Matrix3d a;
  a << zoom, 0, shift.x(), 0, zoom, shift.y(), 0, 0, 1;
  for (View& v : s.views) {
    v.camera.pixelFromRay = a * v.camera.pixelFromRay;
    for (Pixel& p : v.contour) p = zoom * p + shift;
    v.peak = zoom * v.peak + shift;
  }
  return s;
}

/// All that the views of one light give, by every solver.
struct Answers {
  std::optional<Eigen::Vector3d> triangulated, bundled;  ///< world
  double limit = 0;
  std::vector<Ellipse> outlines;  ///< of the linear, anchored and refined ellipsoid in every view's virtual camera
  std::vector<std::vector<Pixel>> canonical;
};
Answers solve(const Scene& scene, double robustPx = 1) {
  Answers answers;
  const auto surface = makeAnalytic(scene.surface);
  std::vector<ReflectedRay> rays;
  std::vector<BundleView> bundleViews;
  std::vector<ConicView> conics;
  for (const View& v : scene.views) {
    const Outcome<BrightestPoint> b = observedBrightestPoint(*surface, v.camera, v.peak);
    if (!b) throw std::runtime_error(b.failure().message());
    rays.push_back(reflectedRay(*b, v.camera));
    bundleViews.push_back({v.camera, surface.get(), v.contour, *b});
    const Plane plane = Plane::through(b->point.position, b->point.normal);
    const Outcome<Ellipse> e = fitEllipse(v.contour);
    if (!e) throw std::runtime_error(e.failure().message());
    conics.push_back({virtualCamera(v.camera, plane), *e, v.contour});
    // Walks use the true light: they are measured here, not the light's estimate.
    const TangentWalk walk(*surface, v.camera, *b, scene.light, {1e-15, 60});
    answers.canonical.push_back(canonicalContour(walk, v.camera, Polyline{v.contour, true}, 12).pixels);
  }
  const Outcome<Triangulation> t = triangulateLight(rays);
  if (t && !t->light.atInfinity()) answers.triangulated = t->light.position();
  BundleOptions options;
  options.robustPx = robustPx;
  const Outcome<Bundle> bundle = bundleLight(bundleViews, t ? t->light : scene.light, options);
  if (bundle) {
    answers.bundled = bundle->light.position();
    answers.limit = bundle->limitAngle;
  }
  const Eigen::Vector3d centre = scene.light.position();
  std::vector<Outcome<Reconstruction>> fits{reconstructLinear(conics, centre), reconstructAnchored(conics, centre)};
  if (fits[1]) fits.push_back(reconstructRefined(conics, *fits[1]->ellipsoid));
  for (const Outcome<Reconstruction>& fit : fits) {
    if (!fit || !fit->ellipsoid) continue;
    for (const ConicView& c : conics)
      if (const Outcome<Ellipse> e = outlineEllipse(*fit->ellipsoid, c.projection)) answers.outlines.push_back(*e);
  }
  return answers;
}

/// Largest relative difference, per part. The world of `b` is mapped back by the caller; pixels by zoom and shift.
struct Differences {
  double triangulated = 0, bundled = 0, limit = 0, outlines = 0, canonical = 0;
  int compared = 0;
  void merge(const Differences& d) {
    triangulated = std::max(triangulated, d.triangulated);
    bundled = std::max(bundled, d.bundled);
    limit = std::max(limit, d.limit);
    outlines = std::max(outlines, d.outlines);
    canonical = std::max(canonical, d.canonical);
    compared += d.compared;
  }
};
Differences between(const Answers& a, const Answers& b, double zoom = 1, const Pixel& shift = {0, 0}) {
  Differences d;
  EXPECT_EQ(a.triangulated.has_value(), b.triangulated.has_value());
  EXPECT_EQ(a.bundled.has_value(), b.bundled.has_value());
  EXPECT_EQ(a.outlines.size(), b.outlines.size());
  if (a.triangulated && b.triangulated) d.triangulated = (*a.triangulated - *b.triangulated).norm() / a.triangulated->norm();
  if (a.bundled && b.bundled) {
    d.bundled = (*a.bundled - *b.bundled).norm() / a.bundled->norm();
    d.limit = std::abs(a.limit / b.limit - 1);
    ++d.compared;
  }
  for (std::size_t i = 0; i < std::min(a.outlines.size(), b.outlines.size()); ++i) {
    const Ellipse &p = a.outlines[i], &q = b.outlines[i];
    d.outlines = std::max({d.outlines, (zoom * p.centre + shift - q.centre).norm() / (zoom * p.semiAxes.x()),
                           (zoom * p.semiAxes - q.semiAxes).norm() / (zoom * p.semiAxes.x())});
    ++d.compared;
  }
  for (std::size_t i = 0; i < std::min(a.canonical.size(), b.canonical.size()); ++i) {
    EXPECT_EQ(a.canonical[i].size(), b.canonical[i].size());
    for (std::size_t k = 0; k < std::min(a.canonical[i].size(), b.canonical[i].size()); ++k)
      d.canonical = std::max(d.canonical, (zoom * a.canonical[i][k] + shift - b.canonical[i][k]).norm() / (zoom * 40));
  }
  return d;
}
void expectSame(const Differences& d, const char* what) {
  EXPECT_LT(d.triangulated, kSame) << what;
  EXPECT_LT(d.bundled, kSameBundle) << what;
  EXPECT_LT(d.limit, kSameBundle) << what;
  EXPECT_LT(d.outlines, kSame) << what;
  EXPECT_LT(d.canonical, kSame) << what;
  EXPECT_GT(d.compared, 50) << what;  // or nothing was compared
}

constexpr unsigned kScenes = 8;
constexpr double kNoisePx = 0.2;

TEST(Invariance, RigidMotionOfTheWorld) {
  Differences worst;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const Scene scene = randomScene(seed, kNoisePx);
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.rotate(Eigen::AngleAxisd(0.4 + seed, Eigen::Vector3d(1, 2, -0.5 * seed).normalized()));
    motion.pretranslate(Eigen::Vector3d(0.7, -1.1, 0.4));
    Answers there = solve(moved(scene, motion, 1));
    if (there.triangulated) there.triangulated = motion.inverse() * *there.triangulated;
    if (there.bundled) there.bundled = motion.inverse() * *there.bundled;
    // Azimuth 0 is that of the image's x axis, which moves along: the same twelve directions.
    worst.merge(between(solve(scene), there));
  }
  expectSame(worst, "rigid motion");
}

TEST(Invariance, UnitOfTheWorld) {
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    Differences worst;
    for (unsigned seed = 0; seed < kScenes; ++seed) {
      const Scene scene = randomScene(seed, kNoisePx);
      Answers there = solve(moved(scene, Eigen::Isometry3d::Identity(), scale));
      if (there.triangulated) *there.triangulated /= scale;
      if (there.bundled) *there.bundled /= scale;
      worst.merge(between(solve(scene), there));
    }
    expectSame(worst, std::to_string(scale).c_str());
  }
}

// Exact contours: under noise the weights of the bundle are differences over half a pixel, which another unit of the pixel
// changes by the square of that step over the highlight's size.
TEST(Invariance, UnitAndOriginOfThePixels) {
  for (const double zoom : {1.0 / 16, 4.0, 64.0})
    for (const Pixel& shift : {Pixel(0, 0), Pixel(3000, -2000)}) {
      Differences worst;
      for (unsigned seed = 0; seed < kScenes; ++seed) {
        const Scene scene = randomScene(seed, 0);
        worst.merge(between(solve(scene), solve(rescaled(scene, zoom, shift), zoom), zoom, shift));
      }
      expectSame(worst, std::to_string(zoom).c_str());
    }
}

TEST(Invariance, OrderOfViews) {
  Differences worst;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const Scene scene = randomScene(seed, kNoisePx);
    const Answers here = solve(scene);
    Scene other = scene;
    const std::vector<int> order{4, 0, 5, 2, 1, 3};
    for (int i = 0; i < 6; ++i) other.views[i] = scene.views[order[i]];
    Answers there = solve(other), sorted = there;
    ASSERT_EQ(there.outlines.size() % 6, 0u);
    for (std::size_t i = 0; i < 6; ++i) sorted.canonical[order[i]] = there.canonical[i];
    for (std::size_t i = 0; i < there.outlines.size(); ++i) sorted.outlines[i / 6 * 6 + order[i % 6]] = there.outlines[i];
    worst.merge(between(here, sorted));
  }
  expectSame(worst, "order of views");
}

TEST(Invariance, OrderAndStartOfContourPoints) {
  Differences worst;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const Scene scene = randomScene(seed, kNoisePx);
    Scene other = scene;
    for (View& v : other.views) {
      std::rotate(v.contour.begin(), v.contour.begin() + 17, v.contour.end());
      if (seed % 2) std::reverse(v.contour.begin(), v.contour.end());
    }
    worst.merge(between(solve(scene), solve(other)));
  }
  expectSame(worst, "order of contour points");
}

TEST(Invariance, DuplicatedFrames) {
  Differences worst;
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const Scene scene = randomScene(seed, kNoisePx);
    Scene twice = scene;
    twice.views.insert(twice.views.end(), scene.views.begin(), scene.views.end());
    const Answers here = solve(scene);
    Answers there = solve(twice);
    ASSERT_EQ(there.outlines.size(), 2 * here.outlines.size());
    std::vector<Ellipse> first;
    for (std::size_t i = 0; i < there.outlines.size(); ++i)
      if (i % 12 < 6) first.push_back(there.outlines[i]);
    there.outlines = first;
    worst.merge(between(here, there));
  }
  expectSame(worst, "duplicated frames");
}

TEST(Invariance, OrderOfLights) {
  using testing_support::NamedLight;
  const std::vector<NamedLight> lights{{"a", {0.1, 0.2, 1.4}}, {"b", {-0.25, 0.3, 1.7}}};
  const auto both = [](int) { return std::vector<std::string>{"a", "b"}; };
  const auto here = testing_support::exactScene(testing_support::sheet(0.4), lights, 6, both);
  const auto there = std::make_shared<glint::Scene>(*here);
  for (Frame& f : there->frames) {
    std::reverse(f.lightsOn.begin(), f.lightsOn.end());
    std::reverse(f.highlights.begin(), f.highlights.end());
  }
  InspectionRequest request;
  request.models = {"primal", "dual", "canonical", "limit-angle"};
  request.train = "0-4";
  request.settings.set("fit.most_residual", 10.0);  // the sheet is no plane: what is compared counts, not how good it is
  const Inspection first = inspect(here, request), second = inspect(there, request);
  ASSERT_EQ(first.lights.size(), 2u);
  for (const auto& [key, light] : first.lights) {
    ASSERT_TRUE(light && second.lightOf(key)) << textOf(key);
    const Eigen::Vector3d a = light->light.position(), b = second.lightOf(key)->light.position();
    EXPECT_LT((a - b).norm() / a.norm(), kSame) << textOf(key);
  }
  int fits = 0;
  for (const auto& [name, model] : first.models)
    for (const ModelResult::Fit& f : model.fits) {
      const auto& others = second.models.at(name).fits;
      const auto twin = std::find_if(others.begin(), others.end(), [&](const ModelResult::Fit& o) { return o.light == f.light; });
      ASSERT_TRUE(twin != others.end() && f.fit && twin->fit) << name;
      if (const Ellipsoid* const e = f.fit->ellipsoid()) {
        EXPECT_LT((e->centre() - twin->fit->ellipsoid()->centre()).norm() / e->semiAxes().x(), kSame) << name;
      }
      ++fits;
    }
  EXPECT_EQ(fits, 8);
}

}  // namespace
}  // namespace glint
