// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/number_text.h"
#include "core/surface/brightest_point.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/scene.h"

namespace glint::stability {
namespace {

/// Fermat's principle: the mirror point is where the path eye - surface - light is stationary. Newton's method on its gradient
/// over (u, v), by differences of the path's length; a light at infinity counts its wave front.
std::optional<Vec<Real>> stationary(const Bent<Real>& s, const Lamp<Real>& lamp, const Vec<Real>& eye, Real u, Real v,
                                    const Real& unitLength) {
  const auto path = [&](const Real& a, const Real& b) {
    const Vec<Real> p = s.point(a, b);
    const Real toLight = lamp.w == 0 ? Real(-dot(unit(lamp.l), p)) : length(Real(1 / lamp.w) * lamp.l - p);
    return length(eye - p) + toLight;
  };
  const Real h = unitLength * Real("1e-11");  // differences: truncation 1e-22, round-off of the second ones 1e-48 / 1e-22
  for (int i = 0; i < 60; ++i) {
    const Real f = path(u, v), right = path(u + h, v), left = path(u - h, v), up = path(u, v + h), down = path(u, v - h);
    const Real gu = (right - left) / (2 * h), gv = (up - down) / (2 * h);
    const Real huu = (right - 2 * f + left) / (h * h), hvv = (up - 2 * f + down) / (h * h);
    const Real huv = (path(u + h, v + h) - path(u + h, v - h) - path(u - h, v + h) + path(u - h, v - h)) / (4 * h * h);
    const Real det = huu * hvv - huv * huv;
    if (det == 0) return std::nullopt;
    const Real du = (huv * gv - hvv * gu) / det, dv = (huv * gu - huu * gv) / det;
    u += du;
    v += dv;
    if (abs(du) + abs(dv) < unitLength * Real("1e-19")) return s.point(u, v);
  }
  return std::nullopt;
}

/// The code's brightest points against the stationary point near (u, v), which must be among them.
Outcome<Measured> pointCase(double k, bool round, const Light& light, double u, double v, double distance, double focal,
                            double unitLength, double condition, double skew = 0) {
  const Bent<Real> s{Real(k), round};
  const Lamp<Real> lamp = lampOf<Real>(light);
  const RealView<Real> view = mirrorView(s, lamp, u, v, distance, focal, skew);
  // The camera looks a little aside, so that neither the pixel's centre nor a seed is the answer.
  const Camera camera = cameraTowards(
      view.camera.centreInWorld(),
      rounded(s.point(Real(u), Real(v))) + Eigen::Vector3d(0.05, -0.03, 0.01) * distance * 100 / focal, focal, skew);
  const std::optional<Vec<Real>> reference =
      stationary(s, lamp, RealCamera<Real>(camera).eye(), Real(u), Real(v), Real(unitLength));
  if (!reference) return Failure{Reason::NotConverged, "reference"};
  const Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(*makeAnalytic(specOf(k, round)), camera, light);
  if (!found) return found.failure();
  double best = std::numeric_limits<double>::infinity();
  for (const BrightestPoint& b : *found) best = std::min(best, apart(b.point.position, *reference) / distance);
  return Measured{best, condition};
}

/// z = (k / 2)(x^2 - y^2) as a height field, the same principle.
Outcome<Measured> saddleCase(double k, const Eigen::Vector3d& eye, const Eigen::Vector3d& lightAt) {
  AnalyticSpec spec;
  spec.type = "quadric";
  spec.matrix.diagonal() << k, -k, 0, 0;
  spec.matrix(2, 3) = spec.matrix(3, 2) = -1;
  const Camera camera = cameraTowards(eye, {0.05, 0.02, 0}, 500);
  const Light light = Light::at(lightAt);
  const Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(*makeAnalytic(spec), camera, light);
  if (!found) return found.failure();
  const Vec<Real> e = RealCamera<Real>(camera).eye(), l = exactly<Real>(lightAt);
  const auto point = [&](const Real& x, const Real& y) { return Vec<Real>{x, y, Real(k) / 2 * (x * x - y * y)}; };
  const auto path = [&](const Real& x, const Real& y) { return length(e - point(x, y)) + length(l - point(x, y)); };
  double worst = 0;
  for (const BrightestPoint& b : *found) {  // every answer must be a stationary path
    Real x = b.point.position.x(), y = b.point.position.y();
    const Real h("1e-11"), x0 = x, y0 = y;
    for (int i = 0; i < 5; ++i) {
      const Real f = path(x, y), r = path(x + h, y), q = path(x - h, y), u = path(x, y + h), d = path(x, y - h);
      const Real gx = (r - q) / (2 * h), gy = (u - d) / (2 * h), xx = (r - 2 * f + q) / (h * h), yy = (u - 2 * f + d) / (h * h);
      const Real xy = (path(x + h, y + h) - path(x + h, y - h) - path(x - h, y + h) + path(x - h, y - h)) / (4 * h * h);
      const Real det = xx * yy - xy * xy;
      x += (xy * gy - yy * gx) / det;
      y += (xy * gx - xx * gy) / det;
    }
    worst = worstOf({worst, static_cast<double>(sqrt((x - x0) * (x - x0) + (y - y0) * (y - y0))) / 2});
  }
  return Measured{worst};
}

}  // namespace

void addBrightestCases(Cases& cases) {
  const auto add = [&](const std::string& name, double parameter, double tolerance, const char* note, auto run) {
    cases.push_back(answerCase("brightest point", name, parameter, tolerance, note, run));
  };
  const Eigen::Vector3d d = obliqueDirection();
  add("plane, light at 1e-2 m", 1e-2, 1e-9, "",
      [d] { return pointCase(0, false, Light::at(1e-2 * d), 0.003, 0.002, 1, 800, 1e-2, 1); });
  add("sphere, light at 1e9 m", 1e9, 1e-9, "",
      [d] { return pointCase(2, true, Light::at(1e9 * d), 0.03, 0.02, 1, 800, 0.1, 1); });
  add("sphere, light at infinity", 0, 1e-9, "",
      [d] { return pointCase(2, true, Light::towards(d), 0.03, 0.02, 1, 800, 0.1, 1); });
  add("sheet of curvature 1e-9 per metre", 1e-9, 1e-9, "",
      [d] { return pointCase(1e-9, false, Light::at(2 * d), 0.03, 0.02, 1, 800, 0.1, 1); });
  add("sphere of curvature 1e3 per metre", 1e3, 1e-9, "",
      [d] { return pointCase(1e3, true, Light::at(2 * d), 1e-4, 2e-4, 0.1, 5000, 1e-4, 1); });
  add("concave sphere", -0.8, 1e-9, "", [d] { return pointCase(-0.8, true, Light::at(0.5 * d), 0.05, 0.03, 0.4, 400, 0.1, 1); });
  for (const double degrees : {80.0, 85.0, 89.0, 89.9, 89.99})
    for (const double k : {0.5, 0.0}) {
      const double a = degrees * std::numbers::pi / 180;
      const std::string name = formatted("%s, grazing %g degrees", k > 0 ? "sphere" : "plane", degrees);
      const Light light = grazingLight(degrees);
      add(name, degrees, 1e-9, "", [light, a, k] { return pointCase(k, k > 0, light, 0, 0, 1, 800, 0.1, 1 / std::cos(a)); });
    }
  // The camera stands so far that the object is seen as large as by a lens of 800 px from 1 m; the error is over the object's
  // metre.
  for (const auto& [focal, words] :
       {std::pair(1e4, "1e4 px at 12.5 m"), std::pair(1e5, "1e5 px at 125 m"), std::pair(1e6, "1e6 px at 1,250 m")})
    for (const double k : {2.0, 0.0}) {
      add(std::string(k > 0 ? "sphere" : "plane") + ", focal length " + words, focal, 1e-9, "",
          [d, focal = focal, k]() -> Outcome<Measured> {
            Outcome<Measured> m = pointCase(k, k > 0, Light::at(2 * d), 0.03, 0.02, focal / 800, focal, 0.1, focal / 800);
            if (m) m->error *= focal / 800;
            return m;
          });
    }
  for (const auto& [skew, words] : {std::pair(1.0, "1 px"), std::pair(30.0, "30 px"), std::pair(1000.0, "1,000 px")}) {
    add(std::string("sphere, skew ") + words, skew, 1e-9, "",
        [d, skew = skew] { return pointCase(2, true, Light::at(2 * d), 0.03, 0.02, 1, 800, 0.1, 1, skew); });
  }
  for (const double scale : {1e-6, 1e6})
    add(scale < 1 ? "sphere, scene scale 1e-6" : "sphere, scene scale 1e6", scale, 1e-9, "", [scale, d] {
      return pointCase(2 / scale, true, Light::at(2 * scale * d), 0.03 * scale, 0.02 * scale, scale, 800, 0.1 * scale, 1);
    });
  add("saddle", 0.8, 1e-9, "", [] { return saddleCase(0.8, {-0.6, 0.3, 1.5}, {0.7, -0.2, 1.8}); });
  {
    Case c;
    c.stage = "brightest point";
    c.name = "light below the plane";
    c.note = "nothing is lit";
    c.expect = Expect::Failure;
    c.reasons = {Reason::NoBrightestPoint};
    c.run = []() -> Outcome<Measured> {
      const auto found = predictedBrightestPoints(*makeAnalytic(specOf(0, false)), cameraTowards({0.2, 0.1, 1}, {0, 0, 0}, 800),
                                                  Light::at({0.3, 0.2, -2}));
      if (!found) return found.failure();
      return Measured{0};
    };
    cases.push_back(c);
  }
}

}  // namespace glint::stability
