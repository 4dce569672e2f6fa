// SPDX-License-Identifier: BSD-3-Clause
// Depth as a depth camera measures it. Truth is analytic: depths and normals of spheres and planes in closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/surface/brightest_point.h"
#include "core/surface/depth_filter.h"
#include "core/surface/depth_fusion.h"
#include "core/surface/depth_images.h"
#include "core/surface/depth_map.h"
#include "tests/core/surface/surfaces.h"

namespace glint::depth_camera_tests {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

Image depthFrom(const Camera& camera, const Vector3d& centre, double radius) {
  Image depth(camera.width, camera.height, 1);
  const Vector3d eye = camera.centreInWorld() - centre;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vector3d d = camera.ray(camera.undistorted(Pixel(x, y))).direction;
      const double b = eye.dot(d), q = b * b - eye.squaredNorm() + radius * radius;
      if (q > 0) depth.at(x, y) = static_cast<float>(camera.depth(centre + eye + (-b - std::sqrt(q)) * d));
    }
  return depth;
}

/// A plane n.X = d in the camera's frame.
Image planeDepth(const Camera& camera, const Vector3d& n, double d) {
  Image depth(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      depth.at(x, y) =
          static_cast<float>(d / n.dot(camera.pixelFromRay.inverse() * camera.undistorted(Pixel(x, y)).homogeneous()));
  return depth;
}

Camera camera200(double scale = 1) { return test::lookAt(scale * Vector3d(0.2, -1.6, 0.5), {0, 0, 0}, 200, 160, 120); }

/// Root mean square angle to the sphere's own normals, deg, where the sphere is seen at less than 45 degrees.
double normalErrorDeg(const std::function<Vector3d(int, int)>& normalAt, const Camera& camera, const Vector3d& centre,
                      double radius) {
  const Image depth = depthFrom(camera, centre, radius);
  double sum = 0;
  int n = 0;
  for (int y = 0; y < camera.height; y += 3)
    for (int x = 0; x < camera.width; x += 3) {
      if (!(depth.at(x, y) > 0)) continue;
      const Ray ray = camera.ray(camera.undistorted(Pixel(x, y)));
      const double t = depth.at(x, y) / (camera.camFromWorld.linear() * ray.direction).z();
      const Vector3d truth = (ray.at(t) - centre).normalized();
      if (!(-truth.dot(ray.direction) > std::cos(45 * kDegree))) continue;
      const Vector3d found = normalAt(x, y);
      if (found.isZero()) continue;
      sum += std::pow(std::atan2(found.cross(truth).norm(), found.dot(truth)) / kDegree, 2);
      ++n;
    }
  EXPECT_GT(n, 100);
  return std::sqrt(sum / n);
}

double fitErrorDeg(const Image& depth, const Camera& camera, double ball, const Vector3d& centre, double radius) {
  const SmoothDepth s = fittedDepth(depth, camera, ball);
  const Eigen::Matrix3d worldFromCam = camera.camFromWorld.linear().transpose();
  return normalErrorDeg([&](int x, int y) { return Vector3d(worldFromCam * s.normals[std::size_t(y * camera.width + x)]); },
                        camera, centre, radius);
}

// The inverse depth of a plane is linear in the image: no error but the single precision of the depth, also slantwise.
TEST(DepthFit, NominalPlaneIsExact) {
  const Camera camera = test::lookAt({0, 0, 0}, {0, 1, 0}, 200, 160, 120);
  const Vector3d n = Vector3d(0.5, -0.3, -1).normalized();
  const SmoothDepth s = fittedDepth(planeDepth(camera, n, -1.2), camera, 0.03);
  for (int y = 0; y < 120; y += 7)
    for (int x = 0; x < 160; x += 7)
      EXPECT_LT((s.normals[std::size_t(y * 160 + x)] - n).norm(), 3e-4)
          << x << " " << y;  // single precision of the depth over 3 cm
}

TEST(DepthFit, NominalSphereWithAndWithoutLens) {
  Camera camera = camera200();
  EXPECT_LT(fitErrorDeg(depthFrom(camera, {0, 0, 0}, 0.4), camera, 0.06, {0, 0, 0}, 0.4), 0.3);  // the third order
  camera.lens.parameters = {-0.2, 0.05, 0.001, -0.001, 0};
  EXPECT_LT(fitErrorDeg(depthFrom(camera, {0, 0, 0}, 0.4), camera, 0.06, {0, 0, 0}, 0.4), 0.3);  // the third order
}

TEST(DepthFit, Scale) {
  const Camera at1 = camera200();
  const double one = fitErrorDeg(depthFrom(at1, {0, 0, 0}, 0.4), at1, 0.06, {0, 0, 0}, 0.4);
  for (const double scale : {1e-5, 1e5}) {
    const Camera camera = camera200(scale);
    EXPECT_NEAR(fitErrorDeg(depthFrom(camera, {0, 0, 0}, 0.4 * scale), camera, 0.06 * scale, {0, 0, 0}, 0.4 * scale), one, 0.01);
  }
}

// Noise: a wider ball has less of it, and the fit much less than the plane through points as measured.
TEST(DepthFit, Noise) {
  const Camera camera = camera200();
  Image depth = depthFrom(camera, {0, 0, 0}, 0.4);
  addKinectNoise(depth, 1, 5);
  const double narrow = fitErrorDeg(depth, camera, 0.03, {0, 0, 0}, 0.4), wide = fitErrorDeg(depth, camera, 0.09, {0, 0, 0}, 0.4);
  EXPECT_LT(wide, 0.5 * narrow);
  EXPECT_LT(wide, 1.5);
  const SmoothDepth b = bilateralDepth(depth, camera, 0.06);
  const Image exact = depthFrom(camera, {0, 0, 0}, 0.4);
  double before = 0, after = 0;
  for (int y = 40; y < 80; ++y)
    for (int x = 60; x < 100; ++x) {
      before += std::pow(depth.at(x, y) - exact.at(x, y), 2);
      after += std::pow(b.depth.at(x, y) - exact.at(x, y), 2);
    }
  EXPECT_LT(after, 0.5 * before);
}

// An edge stays where it is: no point between the near and the far part.
TEST(DepthFit, EdgesStay) {
  const Camera camera = test::lookAt({0, 0, 0}, {0, 1, 0}, 200, 160, 120);
  Image depth(160, 120, 1, 1.f);
  for (int y = 0; y < 120; ++y)
    for (int x = 80; x < 160; ++x) depth.at(x, y) = 1.5f;
  for (const SmoothDepth& s : {fittedDepth(depth, camera, 0.05), bilateralDepth(depth, camera, 0.05)})
    for (int x = 70; x < 90; ++x) EXPECT_NEAR(s.depth.at(x, 60), x < 80 ? 1 : 1.5, 1e-3) << x;
}

TEST(DepthFit, Degenerate) {
  const Camera camera = camera200();
  Image depth(160, 120, 1);
  depth.at(80, 60) = 1;
  const SmoothDepth s = fittedDepth(depth, camera, 0.05);
  EXPECT_EQ(s.depth.at(80, 60), 1.f);
  EXPECT_TRUE(s.normals[60 * 160 + 80].isZero());
  EXPECT_THROW((void)fittedDepth(depth, camera, 0), std::invalid_argument);
  EXPECT_THROW((void)bilateralDepth(Image(160, 120, 3), camera, 1), std::invalid_argument);
  for (const float z : fittedDepth(Image(160, 120, 1), camera, 0.05).depth.data) ASSERT_EQ(z, 0.f);
}

// Three standard deviations and the rounding of the published model: 351.3 / z is whole, and its error a sixth of a pixel before
// rounding: together the variance 1/36 + 1/12.
TEST(DepthNoise, AsPublished) {
  for (const double z : {1.0, 3.0}) {
    Image depth(160, 120, 1, static_cast<float>(z));
    addKinectNoise(depth, 1, 3);
    double sum = 0;
    for (const float v : depth.data) {
      const double d = 351.3 / double(v);
      ASSERT_NEAR(d, std::round(d), 1e-3);
      ASSERT_LT(std::abs(d - 351.3 / z), 0.5 + 6.0 / 6);
      sum += std::pow(d - 351.3 / z, 2);
    }
    // Between a sixth alone and a sixth with the worst place for rounding: 351.3 / 3 = 117.1, 351.3 / 1 = 351.3.
    const double rms = std::sqrt(sum / double(depth.data.size()));
    EXPECT_GT(rms, 0.1);
    EXPECT_LT(rms, 0.5);
  }
}

TEST(DepthNoise, SeedsEdgesAndNothing) {
  const Camera camera = camera200();
  const Image exact = depthFrom(camera, {0, 0, 0}, 0.4);
  Image a = exact, b = exact, c = exact, none = exact;
  addKinectNoise(a, 1, 1), addKinectNoise(b, 1, 1), addKinectNoise(c, 1, 2), addKinectNoise(none, 0, 1);
  EXPECT_EQ(a.data, b.data);
  EXPECT_NE(a.data, c.data);
  EXPECT_EQ(none.data, exact.data);
  int lost = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    EXPECT_TRUE(exact.data[i] > 0 || a.data[i] == 0);
    lost += exact.data[i] > 0 && a.data[i] == 0;
  }
  EXPECT_GT(lost, 50);  // half of two pixels around an outline of about 300
  EXPECT_LT(lost, 600);
  EXPECT_THROW(addKinectNoise(a, -1, 1), std::invalid_argument);
}

// A still sphere seen from six places: the mean has less error than one map; one that was moved by 2 cm is found and left out.
TEST(DepthFusion, StillMovedAndUnseen) {
  const Camera camera = camera200();
  const Image exact = depthFrom(camera, {0, 0, 0}, 0.4);
  Image own = exact;
  addKinectNoise(own, 1, 1);
  std::vector<DepthView> others;
  for (int i = 0; i < 6; ++i) {
    const Camera from = test::lookAt({0.1 * i - 0.3, -1.6 + 0.03 * i, 0.4}, {0, 0, 0}, 200, 160, 120);
    others.push_back({"still " + std::to_string(i), depthFrom(from, {0, 0, 0}, 0.4), from});
    addKinectNoise(others.back().depth, 1, 10 + unsigned(i));
  }
  const Camera from = test::lookAt({0, -1.6, 0.3}, {0, 0, 0}, 200, 160, 120);
  others.push_back({"moved", depthFrom(from, {0, 0.02, 0}, 0.4), from});
  addKinectNoise(others.back().depth, 1, 30);
  const Camera away = test::lookAt({0, -1.6, 0.3}, {0, -4, 0}, 200, 160, 120);
  others.push_back({"away", Image(160, 120, 1, 2.f), away});
  const FusedDepth fused = fusedDepth(own, camera, others, 0.06);
  EXPECT_EQ(fused.used.size(), 6u);
  EXPECT_EQ(fused.refused, std::vector<std::string>{"moved"});
  EXPECT_EQ(fused.unseen, std::vector<std::string>{"away"});
  EXPECT_NEAR(fused.disagreementM, 0.02, 0.006);
  double before = 0, after = 0;
  for (int y = 45; y < 75; ++y)
    for (int x = 65; x < 95; ++x) {
      if (!(own.at(x, y) > 0)) continue;
      before += std::pow(own.at(x, y) - exact.at(x, y), 2);
      after += std::pow(fused.depth.at(x, y) - exact.at(x, y), 2);
    }
  EXPECT_LT(after, 0.35 * before);  // a seventh, were the roundings independent
  EXPECT_EQ(fused.depth.at(0, 0), 0.f);
}

// Without noise nothing is made worse, and a motion of a hundredth of the depth is seen at every scale.
TEST(DepthFusion, ExactAndScale) {
  for (const double scale : {1e-4, 1.0, 1e4}) {
    const Camera camera = camera200(scale), from = test::lookAt(scale * Vector3d(-0.1, -1.6, 0.4), {0, 0, 0}, 200, 160, 120);
    const Image own = depthFrom(camera, {0, 0, 0}, 0.4 * scale);
    const FusedDepth still = fusedDepth(own, camera, {{"b", depthFrom(from, {0, 0, 0}, 0.4 * scale), from}}, 0.03 * scale);
    ASSERT_EQ(still.used.size(), 1u) << scale;
    for (int y = 45; y < 75; ++y)
      for (int x = 65; x < 95; ++x) ASSERT_NEAR(still.depth.at(x, y) / own.at(x, y), 1, 2e-4) << scale;
    const FusedDepth moved =
        fusedDepth(own, camera, {{"b", depthFrom(from, {0, 0.016 * scale, 0}, 0.4 * scale), from}}, 0.03 * scale);
    EXPECT_EQ(moved.refused.size(), 1u) << scale;
  }
}

TEST(DepthFusion, Degenerate) {
  const Camera camera = camera200();
  const Image nothing(160, 120, 1);
  EXPECT_EQ(fusedDepth(nothing, camera, {{"b", nothing, camera}}, 0.03).unseen.size(), 1u);
  EXPECT_THROW((void)fusedDepth(Image(10, 10, 1), camera, {}, 0.03), std::invalid_argument);
  const Image own = depthFrom(camera, {0, 0, 0}, 0.4);
  EXPECT_EQ(fusedDepth(own, camera, {}, 0.03).depth.data, own.data);
}

// The same sphere from a depth camera beside the colour camera, coarser and turned: what is registered is what the colour camera
// would measure.
TEST(DepthRegistration, NominalAndScale) {
  for (const double scale : {1e-4, 1.0, 1e4}) {
    Camera colour = camera200(scale);
    colour.lens.parameters = {-0.1, 0.02, 0, 0, 0};
    const Camera depthInWorld = test::lookAt(scale * Vector3d(0.25, -1.6, 0.5), {0, 0, 0}, 150, 120, 100);
    Camera depthCamera = depthInWorld;
    depthCamera.camFromWorld = depthInWorld.camFromWorld * colour.camFromWorld.inverse();
    const Image registered = registeredDepth(depthFrom(depthInWorld, {0, 0, 0}, 0.4 * scale), depthCamera, colour);
    const Image truth = depthFrom(colour, {0, 0, 0}, 0.4 * scale);
    ASSERT_EQ(registered.width, 160);
    int n = 0;
    for (int y = 40; y < 80; ++y)
      for (int x = 60; x < 100; ++x, ++n)
        // Facets of a cell of 1 cm on a radius of 40 cm: (0.01)^2 / (8 * 0.4) = 0.03 mm, seen slantwise.
        EXPECT_NEAR(registered.at(x, y) / truth.at(x, y), 1, 2e-4) << x << " " << y;
    EXPECT_EQ(registered.at(0, 0), 0.f);
  }
}

// The depth camera sees the wall beside the near square; from the colour camera a part of it is hidden, and a part that nobody
// saw stays empty.
TEST(DepthRegistration, HiddenPartsAndEdges) {
  const Camera colour = test::lookAt({0, 0, 0}, {0, 1, 0}, 200, 160, 120);
  Camera depthCamera = colour;
  depthCamera.camFromWorld = Eigen::Isometry3d(Eigen::Translation3d(-0.1, 0, 0));  // 10 cm to the right of the colour camera
  Image depth(160, 120, 1, 2.f);
  for (int y = 40; y < 80; ++y)
    for (int x = 60; x < 100; ++x) depth.at(x, y) = 1.f;
  const Image registered = registeredDepth(depth, depthCamera, colour);
  // The square moves by 200 * 0.1 / 1 = 20 px, the wall by 10 px.
  EXPECT_EQ(registered.at(69, 60), 2.f);
  EXPECT_EQ(registered.at(75, 60), 0.f);  // hidden from the depth camera by the square
  EXPECT_EQ(registered.at(85, 60), 1.f);
  EXPECT_EQ(registered.at(115, 60), 1.f);
  EXPECT_EQ(registered.at(125, 60), 2.f);
  EXPECT_EQ(registered.at(5, 60), 0.f);  // left of all that was seen
  for (const float z : registered.data) EXPECT_TRUE(z == 0 || std::abs(z - 1) < 1e-5 || std::abs(z - 2) < 1e-5) << z;
  EXPECT_THROW((void)registeredDepth(Image(3, 3, 1), depthCamera, colour), std::invalid_argument);
}

// Holes at a highlight are what a depth camera makes: what fills them is no evidence of a peak.
TEST(DepthMapHoles, PeakOnFilledDepthIsRefusedByName) {
  const Camera camera = camera200();
  Image depth = depthFrom(camera, {0, 0, 0}, 0.4);
  for (int y = 55; y < 61; ++y)
    for (int x = 70; x < 76; ++x) depth.at(x, y) = 0;
  const auto map = makeDepthMap(depth, camera);
  ASSERT_TRUE(map);
  const Outcome<BrightestPoint> in = observedBrightestPoint(**map, camera, {72.5, 57.5});
  ASSERT_FALSE(in);
  EXPECT_EQ(in.failure().reason, Reason::PeakOffSurface);
  EXPECT_NE(in.failure().detail.find("filled in, not measured"), std::string::npos) << in.failure().detail;
  EXPECT_TRUE(observedBrightestPoint(**map, camera, {90.5, 57.5}));
  const Outcome<SurfacePoint> inside = (*map)->firstHit(camera.ray({72.5, 57.5}));  // contours may cross it
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->position.norm(), 0.4, 5e-3);  // the depth of the sphere changes by 5 mm and more across the hole
  DepthMapOptions open;
  open.mesh.depth.largestHolePx = 0;
  EXPECT_FALSE((*makeDepthMap(depth, camera, open))->firstHit(camera.ray({72.5, 57.5})));
}

TEST(DepthMapNormals, IntegralAndPlaneAgreeOnTheSphere) {
  const Camera camera = camera200();
  const Image depth = depthFrom(camera, {0, 0, 0}, 0.4);
  for (const DepthNormals normals : {DepthNormals::Plane, DepthNormals::Integral}) {
    DepthMapOptions options;
    options.mesh.depth.normals = normals;
    options.mesh.depth.radius = 0.03;
    const auto map = makeDepthMap(depth, camera, options);
    ASSERT_TRUE(map);
    const double error = normalErrorDeg(
        [&](int x, int y) {
          const Outcome<SurfacePoint> hit = (*map)->firstHit(camera.ray(Pixel(x, y)));
          return hit ? hit->normal : Vector3d::Zero().eval();
        },
        camera, {0, 0, 0}, 0.4);
    EXPECT_LT(error, 1) << static_cast<int>(normals);  // a square of pixels is long on a slanted part
  }
}

// Still frames: the normal under a pixel moves from frame to frame by the noise alone; smoothing makes it still.
TEST(DepthMapNormals, JitterOverStillFrames) {
  const Camera camera = camera200();
  const Image exact = depthFrom(camera, {0, 0, 0}, 0.4);
  const auto jitter = [&](DepthSmoothing smoothing, double radius) {
    std::vector<Vector3d> normals;
    Vector3d mean = Vector3d::Zero();
    for (unsigned seed = 1; seed <= 6; ++seed) {
      Image depth = exact;
      addKinectNoise(depth, 1, seed);
      DepthMapOptions options;
      options.mesh.depth.smoothing = smoothing;
      options.mesh.depth.radius = radius;
      const auto map = makeDepthMap(depth, camera, options);
      const Outcome<SurfacePoint> hit = (*map)->firstHit(camera.ray({80.3, 60.2}));
      if (!hit) return 180.0;
      normals.push_back(hit->normal);
      mean += hit->normal / 6;
    }
    double sum = 0;
    for (const Vector3d& n : normals) sum += (n - mean).squaredNorm() / 5;
    return std::sqrt(sum) / kDegree;
  };
  const double raw = jitter(DepthSmoothing::None, 0.03), still = jitter(DepthSmoothing::Fit, 0.09);
  EXPECT_LT(still, 0.4 * raw);
  EXPECT_LT(still, 0.6);
}

}  // namespace glint::depth_camera_tests
