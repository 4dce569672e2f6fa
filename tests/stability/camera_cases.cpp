// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "core/geometry/camera.h"
#include "core/geometry/plane.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real.h"

namespace glint::stability {
namespace {

Camera cameraAt(const Eigen::Vector3d& eye, double focal, double skew = 0.3) {
  Camera c;
  c.pixelFromRay << focal, skew, 319.5, 0, 0.98 * focal, 239.5, 0, 0, 1;
  c.camFromWorld.linear() =
      (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()) * Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  c.camFromWorld.translation() = -(c.camFromWorld.linear() * eye);
  c.width = 640;
  c.height = 480;
  return c;
}

/// Pixel of a point and the ray back through it.
Outcome<Measured> projectAndBack(double focal, const Eigen::Vector3d& eye, const Eigen::Vector3d& inCamera, double condition,
                                 double skew = 0.3) {
  const Camera c = cameraAt(eye, focal, skew);
  const RealCamera<Real> real(c);
  const Eigen::Vector3d world = eye + c.camFromWorld.linear().transpose() * inCamera;
  const std::optional<Pixel> pixel = c.project(world);
  if (!pixel) return Failure{Reason::BehindCamera, ""};
  const auto [x, y] = real.pixel(exactly<Real>(world));
  const Real dx = Real(pixel->x()) - x, dy = Real(pixel->y()) - y;
  const double atPixel = static_cast<double>(sqrt(dx * dx + dy * dy) / (sqrt(x * x + y * y) + 1));
  const double atRay = apart(c.ray(*pixel).direction, real.ray(Real(pixel->x()), Real(pixel->y())));
  return Measured{worstOf({atPixel, atRay}), condition};
}

/// Brown-Conrady in fifty digits, and its inverse by Newton's method with differences, followed outwards from the centre.
struct RealLens {
  Real k1, k2, p1, p2, k3;
  std::pair<Real, Real> distort(const Real& x, const Real& y) const {
    const Real r2 = x * x + y * y, radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  }
  std::pair<Real, Real> ideal(const Real& x, const Real& y, double& condition) const {
    Real u = 0, v = 0;
    const Real h("1e-25");
    for (int step = 1; step <= 64; ++step)
      for (int i = 0; i < (step == 64 ? 40 : 6); ++i) {
        const auto [a, b] = distort(u, v);
        const auto [ax, bx] = distort(u + h, v);
        const auto [ay, by] = distort(u, v + h);
        const Real j00 = (ax - a) / h, j01 = (ay - a) / h, j10 = (bx - b) / h, j11 = (by - b) / h, det = j00 * j11 - j01 * j10;
        const Real ex = x * step / 64 - a, ey = y * step / 64 - b;
        u += (j11 * ex - j01 * ey) / det;
        v += (j00 * ey - j10 * ex) / det;
        condition = std::max(1.0, static_cast<double>(1 / abs(det)));
      }
    return {u, v};
  }
};

/// A fisheye lens in fifty digits: the angle from the axis between 0 and `end`, where the lens rises, then its tangent.
struct RealFisheye {
  Real k1, k2, k3, k4, end;
  std::pair<Real, Real> ideal(const Real& x, const Real& y, double& condition) const {
    const Real radius = sqrt(x * x + y * y);
    const auto seenAt = [&](const Real& t) { return t * (1 + t * t * (k1 + t * t * (k2 + t * t * (k3 + t * t * k4)))); };
    const Real angle = rootBetween<Real>([&](const Real& t) { return seenAt(t) - radius; }, Real(0), end);
    const Real h("1e-25"), slope = (seenAt(angle + h) - seenAt(angle)) / h, r = tan(angle);
    condition = static_cast<double>(radius / slope * (1 + r * r) / r);
    return {x * r / radius, y * r / radius};
  }
};

/// The field-of-view model in fifty digits.
struct RealFieldOfView {
  Real omega;
  std::pair<Real, Real> ideal(const Real& x, const Real& y, double& condition) const {
    const Real radius = sqrt(x * x + y * y), t = tan(radius * omega), r = t / (2 * tan(omega / 2));
    condition = static_cast<double>(radius * omega * (1 + t * t) / t);
    return {x * r / radius, y * r / radius};
  }
};

/// withoutDistortion against a lens of fifty digits.
template <class Reference>
Outcome<Measured> lensCase(const Lens& lens, const Reference& reference, const Eigen::Vector2d& normalised) {
  Camera c;
  c.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  c.width = 640;
  c.height = 480;
  c.lens = lens;
  const Pixel measured(320 + 800 * normalised.x(), 240 + 800 * normalised.y());
  const Outcome<Pixel> ideal = withoutDistortion(c, measured);
  if (!ideal) return ideal.failure();
  double condition = 1;
  const auto [x, y] = reference.ideal((Real(measured.x()) - 320) / 800, (Real(measured.y()) - 240) / 800, condition);
  const Real dx = (Real(ideal->x()) - 320) / 800 - x, dy = (Real(ideal->y()) - 240) / 800 - y;
  return Measured{static_cast<double>(sqrt((dx * dx + dy * dy) / (x * x + y * y))), condition};
}

Outcome<Measured> brownCase(const std::array<double, 5>& d, const Eigen::Vector2d& normalised) {
  return lensCase({LensModel::OpenCv, {d[0], d[1], d[2], d[3], d[4]}}, RealLens{d[0], d[1], d[2], d[3], d[4]}, normalised);
}

Outcome<Measured> fisheyeCase(const std::array<double, 4>& k, const Eigen::Vector2d& normalised, double end = 1.5707963) {
  return lensCase({LensModel::OpenCvFisheye, {k[0], k[1], k[2], k[3]}}, RealFisheye{k[0], k[1], k[2], k[3], end}, normalised);
}

Outcome<Measured> fieldOfViewCase(double omega, const Eigen::Vector2d& normalised) {
  return lensCase({LensModel::Fov, {omega}}, RealFieldOfView{omega}, normalised);
}

/// The mirror image of a point by P M, against the camera's own projection of the mirrored point.
Outcome<Measured> mirrorCase(const Eigen::Vector3d& onPlane, const Eigen::Vector3d& normal, const Eigen::Vector3d& eye,
                             const Eigen::Vector3d& point, double condition) {
  const Camera c = cameraAt(eye, 800);
  const Plane plane = Plane::through(onPlane, normal.normalized());
  const Vec<Real> n = exactly<Real>(plane.normal), p = exactly<Real>(point);
  const Vec<Real> mirrored = p - Real(2 * (dot(n, p) + Real(plane.offset))) * n;
  const auto [x, y] = RealCamera<Real>(c).pixel(mirrored);
  const Pixel pixel = virtualCamera(c, plane).project(point);
  const Real dx = Real(pixel.x()) - x, dy = Real(pixel.y()) - y;
  return Measured{static_cast<double>(sqrt(dx * dx + dy * dy) / (sqrt(x * x + y * y) + 1)), condition};
}

Case lensFailure(const char* name, double parameter, const char* note, Reason reason, std::function<Outcome<Measured>()> run) {
  Case c;
  c.stage = "lens distortion";
  c.name = name;
  c.parameter = parameter;
  c.note = note;
  c.expect = Expect::Failure;
  c.reasons = {reason};
  c.run = std::move(run);
  return c;
}

void addLensCases(Cases& cases) {
  const Eigen::Vector2d aside(0.8, 0.6);
  const auto add = [&](const char* name, double parameter, const char* note, auto run) {
    cases.push_back(answerCase("lens distortion", name, parameter, 1e-9, note, run));
  };
  add("barrel, 0.94 of the way to the fold", 0.94, "", [=] {
    return brownCase({-0.3, 0, 0, 0, 0}, 0.661 * aside);  // the fold shows at (2/3) sqrt(1 / 0.9) = 0.7027
  });
  add("barrel, 4e-7 before the fold", 4e-7, "Newton's method meets a slope of 1e-3 here", [=] {
    return brownCase({-0.3, 0, 0, 0, 0}, 0.702727979 * aside);
  });
  add("wide angle with all five terms", 1.2, "", [=] { return brownCase({-0.32, 0.11, 1e-3, -8e-4, -0.011}, 0.6 * aside); });
  add("pincushion at the corner of a wide angle", 0.4, "", [=] { return brownCase({0.4, 0.1, 0, 0, 0}, 2.5 * aside); });
  add("fisheye, 89 degrees from the axis", 89, "", [=] {
    return fisheyeCase({0.05, -0.01, 0.004, -0.0008}, 1.695471 * aside);  // 1.5533430 times 1.0914985
  });
  add("fisheye, 1e-6 before its fold", 1e-6, "", [=] {
    return fisheyeCase({-0.3, 0, 0, 0}, (0.702728369 - 1e-6) * aside, 1.0540925);  // as a barrel, but of the angle
  });
  for (const auto& [name, omega] : {std::pair("field of view of 1e-8", 1e-8), std::pair("field of view of 3.1", 3.1)})
    add(name, omega, "", [=, omega = omega] { return fieldOfViewCase(omega, 0.4 * aside); });
  cases.push_back(lensFailure("beyond the fold", 0.8, "no ideal pixel is seen there", Reason::NotConverged, [=] {
    return brownCase({-0.3, 0, 0, 0, 0}, 0.8 * aside);
  }));
  cases.push_back(
      lensFailure("fisheye, 93 degrees from the axis", 93, "an ideal pixel is less than 90 from it", Reason::OutsideImage, [=] {
        return fisheyeCase({0, 0, 0, 0}, 1.6231562 * aside);
      }));
}

}  // namespace

void addCameraCases(Cases& cases) {
  const auto add = [&](const char* stage, const char* name, double parameter, double tolerance, const char* note, auto run) {
    cases.push_back(answerCase(stage, name, parameter, tolerance, note, run));
  };
  add("camera", "focal length 50 px", 50, 1e-9, "", [] { return projectAndBack(50, {1, 2, 0.5}, {0.4, -0.3, 0.2}, 1); });
  add("camera", "focal length 50,000 px", 5e4, 1e-9, "", [] {
    return projectAndBack(5e4, {1, 2, 0.5}, {0.003, -0.002, 1.2}, 1);
  });
  for (const auto& [name, focal] :
       {std::pair("focal length 1e4 px at 12.5 m", 1e4), std::pair("focal length 1e5 px at 125 m", 1e5),
        std::pair("focal length 1e6 px at 1,250 m", 1e6)})
    add("camera", name, focal, 1e-9, "", [focal = focal] {
      return projectAndBack(focal, {1, 2, 0.5}, {0.3, -0.2, focal / 800}, focal / 800);
    });
  for (const auto& [name, skew] :
       {std::pair("skew 1 px", 1.0), std::pair("skew 30 px", 30.0), std::pair("skew 1,000 px", 1000.0)})
    add("camera", name, skew, 1e-9, "", [skew = skew] { return projectAndBack(800, {1, 2, 0.5}, {0.4, -0.3, 1.2}, 1, skew); });
  add("camera", "scene scale 1e-6", 1e-6, 1e-9, "", [] {
    return projectAndBack(800, {1e-6, 2e-6, 5e-7}, {1e-7, -2e-7, 1e-6}, 1);
  });
  add("camera", "world origin 1e6 m away, object at 1 m", 1e6, 64 * kRound * 1e6 * 800 / 100,
      "R X + t cancels six digits of the coordinates; over f / 100 px", [] {
        return projectAndBack(800, {1e6, 2e5, 5e5}, {0.1, -0.2, 1}, 1e6);
      });
  addLensCases(cases);
  add("virtual camera", "mirror seen at 89.9 degrees", 89.9, 1e-9, "", [] {
    return mirrorCase({0, 0, 0}, {std::cos(0.001745), 0, std::sin(0.001745)}, {0.3, 0.2, 2}, {-0.1, 0.2, 0.1}, 1);
  });
  add("virtual camera", "scene scale 1e6", 1e6, 1e-9, "", [] {
    return mirrorCase({1e5, 2e5, 0}, {0.2, -0.1, 1}, {3e5, 2e5, 2e6}, {-1e5, 2e5, 1e5}, 1);
  });
  add("virtual camera", "light of 1e9 m in the mirror", 1e9, 1e-9, "", [] {
    return mirrorCase({0.1, 0.2, 0}, {0.2, -0.1, 1}, {0.3, 0.2, 2}, {-2e8, 1e8, 9e8}, 1);
  });
}

}  // namespace glint::stability
