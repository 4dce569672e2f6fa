// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/geometry/camera.h"
#include "core/geometry/ellipsoid.h"
#include "core/highlight/highlight.h"
#include "core/light/estimate.h"
#include "core/model/reconstruct.h"
#include "core/pipeline/metrics.h"
#include "core/surface/depth_map.h"
#include "core/surface/mesh.h"
#include "tests/stability/cases.h"
#include "tests/stability/scene.h"

namespace glint::stability {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kDenormal = 1e-310;

/// A failure of an Outcome; an answer of any kind is wrong.
template <class T>
Outcome<Measured> failureOf(const Outcome<T>& o) {
  if (!o) return o.failure();
  return Measured{0};
}

/// Every one of several poisoned inputs must be refused: the first answer is returned as one.
template <class Try>
Outcome<Measured> all(const Try& attempt) {
  Outcome<Measured> last = Measured{0};
  for (const double bad : {kNan, kInf, -kInf}) {
    last = attempt(bad);
    if (last) return last;
  }
  return last;
}

std::vector<Pixel> circle() { return Ellipse{{320, 240}, {40, 25}, 0.3}.sample(36); }
Camera plainCamera() { return cameraTowards({0.4, 0.3, 1.5}, {0, 0, 0}, 800); }

std::vector<ConicView> threeViews() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.1, 0.2, 0.3;
  const Ellipsoid e(pose, {0.3, 0.2, 0.1});
  std::vector<ConicView> views;
  for (int i = 0; i < 4; ++i) {
    const Projection p =
        cameraTowards({2 * std::cos(1.5 * i), 2 * std::sin(1.5 * i), 1.0 + 0.1 * i}, {0.1, 0.2, 0.3}, 800).projection();
    views.push_back({p, *outlineEllipse(e, p), {}});
  }
  return views;
}

}  // namespace

void addBadNumberCases(Cases& cases) {
  const auto add = [&](const char* name, std::vector<Reason> reasons, std::function<Outcome<Measured>()> run,
                       const char* note = "not a number, so no answer") -> Case& {
    Case c;
    c.stage = "bad numbers";
    c.name = name;
    c.note = note;
    c.expect = Expect::Failure;
    c.reasons = std::move(reasons);
    c.run = std::move(run);
    cases.push_back(c);
    return cases.back();
  };
  add("conic with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      Conic c = Ellipse{{320, 240}, {40, 25}, 0.3}.conic();
      c.matrix(0, 1) = bad;
      return failureOf(toEllipse(c));
    });
  });
  add("ellipse fit: one point NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      std::vector<Pixel> p = circle();
      p[7].y() = bad;
      return failureOf(fitEllipse(p));
    });
  });
  add(
      "ellipse fit: coordinates up to 1e308", {Reason::NotFinite, Reason::RankDeficient},
      [] {
        std::vector<Pixel> p = circle();
        for (Pixel& q : p) q = (q - Pixel(320, 240)) * 4e306;
        p[0].x() = 1.7e308;
        p[1].x() = -1.7e308;
        return failureOf(fitEllipse(p));
      },
      "the extent of the points overflows");
  add("dual quadric with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      DualQuadric q = Ellipsoid(Eigen::Isometry3d::Identity(), {0.3, 0.2, 0.1}).dual();
      q.matrix(1, 1) = bad;
      return failureOf(Ellipsoid::fromDual(q));
    });
  });
  add("pixel with lens distortion: NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      Camera c = plainCamera();
      c.lens.parameters = {-0.2, 0.05, 0, 0, 0};
      return failureOf(withoutDistortion(c, Pixel(bad, 3)));
    });
  });
  add("ray with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) { return failureOf(makeAnalytic(specOf(0.5, true))->firstHit({{0.1, bad, 2}, {0, 0, -1}})); });
  });
  add("ray on a mesh with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      TriangleMesh m;
      m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
      m.triangles = {{0, 1, 2}};
      return failureOf(makeMesh(m, NormalPolicy::Facet)->firstHit({{0.1, bad, 2}, {0, 0, -1}}));
    });
  });
  add("observed peak NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      return failureOf(observedBrightestPoint(*makeAnalytic(specOf(0.5, true)), plainCamera(), {bad, 1}));
    });
  });
  add("camera pose with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      Camera c = plainCamera();
      c.camFromWorld.translation().y() = bad;
      return failureOf(predictedBrightestPoints(*makeAnalytic(specOf(0.5, true)), c, Light::at({0, 0, 2})));
    });
  });
  add("reflected ray with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      return failureOf(triangulateLight({{{0, 0, 0}, {0, 0, 1}, {0, 0, 1}}, {{1, bad, 0}, {-0.5, 0, 1}, {0, 0, 1}}}));
    });
  });
  add("bundle: one contour point NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      const auto surface = makeAnalytic(specOf(0.5, true));
      BundleView v{plainCamera(), surface.get(), circle(), {}};
      v.contour[3].x() = bad;
      return failureOf(bundleLight({v, v}, Light::at({0, 0, 2})));
    });
  });
  add("reconstruction: an ellipse with NaN, inf, -inf", {Reason::NotFinite}, [] {
    return all([](double bad) {
      std::vector<ConicView> v = threeViews();
      v[1].ellipse.centre.x() = bad;
      const Outcome<Measured> a = failureOf(reconstructLinear(v)), b = failureOf(reconstructAnchored(v, {0.1, 0.2, 0.3}));
      if (a || b) return a ? a : b;
      return failureOf(reconstructRefined(v, Ellipsoid(Eigen::Isometry3d::Identity(), {0.3, 0.2, 0.1})));
    });
  });
  add("detection: every pixel NaN, inf, -inf", {Reason::NotFinite, Reason::NoHighlight}, [] {
    return all([](double bad) {
      Image image(32, 32, 1);
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) image.at(x, y) = static_cast<float>(bad);
      return failureOf(detectHighlights(image, nullptr, {}));
    });
  });
  add("depth map without a finite depth", {Reason::NoSurface}, [] {
    return all([](double bad) {
      Camera c = plainCamera();
      c.width = c.height = 16;
      Image depth(16, 16, 1);
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) depth.at(x, y) = static_cast<float>(bad);
      return failureOf(makeDepthMap(depth, c));
    });
  });
  add(
      "all contour points the same", {Reason::TooFewPoints, Reason::RankDeficient},
      [] { return failureOf(fitEllipse(std::vector<Pixel>(36, Pixel(320.5, 240.25)))); }, "a point is not an ellipse");
  add(
      "contour points on a line", {Reason::RankDeficient},
      [] {
        std::vector<Pixel> p;
        for (int i = 0; i < 36; ++i) p.emplace_back(300 + i, 200 + 0.5 * i);
        return failureOf(fitEllipse(p));
      },
      "a line is not an ellipse");

  const auto answer = [&](const char* name, double tolerance, std::function<Outcome<Measured>()> run, const char* note = "") {
    Case c;
    c.stage = "bad numbers";
    c.name = name;
    c.parameter = kDenormal;
    c.tolerance = tolerance;
    c.note = note;
    c.run = std::move(run);
    cases.push_back(c);
  };
  answer("ellipse fit: denormals added to the pixels", 1e-9, []() -> Outcome<Measured> {
    std::vector<Pixel> p = circle();
    for (Pixel& q : p) q -= Pixel(320, 240);
    p[0].y() += kDenormal;
    p[9].x() = kDenormal;
    const Outcome<Ellipse> e = fitEllipse(p);
    if (!e) return e.failure();
    // p[9] was moved on to the y axis: compare with the same point exactly there.
    p[9].x() = 0;
    const Outcome<Ellipse> plain = fitEllipse(p);
    if (!plain) return plain.failure();
    return Measured{(e->centre - plain->centre).norm() / 40 + (e->semiAxes - plain->semiAxes).norm() / 40};
  });
  answer("ray whose direction has a denormal component", 1e-9, []() -> Outcome<Measured> {
    const Outcome<SurfacePoint> hit = makeAnalytic(specOf(0.5, true))->firstHit({{0.1, 0.2, 2}, {kDenormal, 0, -1}});
    if (!hit) return hit.failure();
    // k r^2 + k z^2 + 2 z = 0 with r^2 = 0.05: z = (-1 + sqrt(1 - k^2 r^2)) / k.
    const long double z = (-1 + std::sqrt(1 - 0.25L * 0.05L)) / 0.5L;
    return Measured{static_cast<double>(std::abs(hit->position.z() - z))};
  });
  answer("sheet of curvature 1e-310 per metre", 1e-9, []() -> Outcome<Measured> {
    const Outcome<SurfacePoint> hit =
        makeAnalytic(specOf(kDenormal, false))->firstHit({{0.1, 0.2, 2}, Eigen::Vector3d(0.3, 0, -1).normalized()});
    if (!hit) return hit.failure();
    return Measured{(hit->position - Eigen::Vector3d(0.7, 0.2, 0)).norm() / 2};
  });
  answer(
      "light at a denormal homogeneous vector", 1e-9,
      []() -> Outcome<Measured> {
        const Light light = Light::homogeneous(Eigen::Vector4d(3e-310, 4e-310, 0, 1e-310));
        return Measured{(light.position() - Eigen::Vector3d(3, 4, 0)).norm() / 5};
      },
      "denormals have only 13 digits here");
}

}  // namespace glint::stability
