// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/geometry/polyline.h"
#include "core/model/model.h"
#include "core/surface/level_set.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real_walk.h"

namespace glint::stability {
namespace {

struct PredictionScene {
  double curvature = 0.8;
  bool round = true;
  double scale = 1, distance = 1.5, focal = 800, limit = 0.1, condition = 1, skew = 0;
};
struct Stage {
  std::shared_ptr<const Surface> surface;
  Camera camera;
  RealWalk<Real> real;  ///< at the exact mirror point of the scene's light
};
Stage stageOf(const PredictionScene& p, const Light& light) {
  const double k = p.curvature / p.scale;
  const Bent<Real> bent{Real(k), p.round};
  const double u = p.curvature > 10 ? 1e-4 : 0.05 * p.scale;
  const RealView<Real> view = mirrorView(bent, lampOf<Real>(light), u, 0.6 * u, p.distance * p.scale, p.focal, p.skew);
  const Vec<Real> at = bent.point(view.u0, view.v0), n = bent.normal(view.u0, view.v0);
  return {makeAnalytic(specOf(k, p.round)), view.camera, {Real(k), p.round, at, n, view.real, view.eye, lampOf<Real>(light)}};
}

/// Level set of alpha: every vertex of the answer lies on it (its alpha in fifty digits), and every direction from the mirror
/// point meets the outline where it should, to the chords' sagitta.
Outcome<Measured> limitAngleCase(const PredictionScene& p, const Light& light) {
  const Stage s = stageOf(p, light);
  ModelFit fit;
  fit.lightEstimate = light;
  fit.family = LimitAngleFit{p.limit};
  const Prediction prediction = modelByName("limit-angle").predict(fit, s.camera, s.surface.get(), Settings());
  if (prediction.highlights().empty()) return *prediction.failure();
  const PredictedHighlight& h = prediction.highlights().front();
  if (h.coverage < 0.999) return Failure{Reason::SurfaceEnded, "coverage below 1"};
  double worst = 0;
  const std::size_t stride = std::max<std::size_t>(1, h.contour.points.size() / 40);
  for (std::size_t i = 0; i < h.contour.points.size(); i += stride) {
    const Pixel& q = h.contour.points[i];
    // First hit of the pixel's ray: the root of the quadratic nearer to the eye.
    const Vec<Real> o = s.real.eye, d = s.real.camera.ray(Real(q.x()), Real(q.y()));
    const Vec<Real> ad{s.real.k * d.x, s.real.round ? Real(s.real.k * d.y) : Real(0), s.real.k * d.z};
    const Real a = dot(d, ad), b = dot(s.real.gradient(o), d), c = dot(o, s.real.gradient(o)) + o.z;
    Real t = -c / (b + (b > 0 ? 1 : -1) * sqrt(Real(b * b - a * c)));
    if (a != 0) {
      const Real other = -(b + (b > 0 ? 1 : -1) * sqrt(Real(b * b - a * c))) / a;
      if (other > 0 && (other < t || t <= 0)) t = other;
    }
    worst = worstOf({worst, static_cast<double>(abs(s.real.alphaOnSurface(o + t * d) / Real(p.limit) - 1))});
  }
  return Measured{worst, p.condition};
}

/// A conic as the six entries of its matrix, and its value for x^T C y.
struct RealConic {
  Real m[3][3];
  Real form(const Vec<Real>& x, const Vec<Real>& y) const {
    const Real a[3] = {x.x, x.y, x.z}, b[3] = {y.x, y.y, y.z};
    Real sum = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum += a[i] * m[i][j] * b[j];
    return sum;
  }
};
/// Outline of the ellipsoid in the virtual camera: the ellipsoid itself is mirrored, and P h h^T - G G^T inverted by cofactors.
RealConic mirroredOutline(const Ellipsoid& e, const RealWalk<Real>& walk) {
  const auto mirror = [&](const Vec<Real>& v) { return v - Real(2 * dot(walk.normal, v)) * walk.normal; };
  const Vec<Real> c = walk.origin + mirror(exactly<Real>(e.centre()) - walk.origin);
  const Vec<Real> h = walk.camera.homogeneous(c);
  Real d[3][3];
  const auto at = [](const Vec<Real>& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) d[i][j] = at(h, i) * at(h, j);
  for (int k = 0; k < 3; ++k) {
    const Vec<Real> axis = mirror(Real(e.semiAxes()(k)) * exactly<Real>(Eigen::Vector3d(e.worldFromBody().linear().col(k))));
    const Vec<Real> g = walk.camera.homogeneous(c + axis) - h;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) d[i][j] -= at(g, i) * at(g, j);
  }
  RealConic out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, e1 = (j + 1) % 3, f = (j + 2) % 3;
      out.m[i][j] = d[a][e1] * d[b][f] - d[a][f] * d[b][e1];
    }
  return out;
}

/// An ellipsoid about the light whose outline in the mirror spans some tens of pixels.
Ellipsoid ellipsoidAt(const Light& light, double size) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  pose.pretranslate(light.position());
  return Ellipsoid(pose, size * Eigen::Vector3d(1, 0.8, 0.6));
}

/// canonical: intersect the mirrored outline with T, take alpha there, walk on S to the same alpha, project.
Outcome<Measured> canonicalCase(const PredictionScene& p, const Light& light, double size) {
  Stage s = stageOf(p, light);
  const Ellipsoid e = ellipsoidAt(light, size * p.scale);
  ModelFit fit;
  fit.lightEstimate = light;
  fit.family = EllipsoidFit{e.dual(), e};
  Settings settings;
  settings.set("predict.directions", 8);
  settings.set("predict.walk_tolerance", 1e-15);
  const Prediction prediction = modelByName("canonical").predict(fit, s.camera, s.surface.get(), settings);
  if (prediction.highlights().empty()) return *prediction.failure();
  const PredictedHighlight& h = prediction.highlights().front();
  // The reference starts at the true mirror point, not at the one found: the light's foot on the reflected path.
  const RealConic conic = mirroredOutline(e, s.real);
  double worst = 0;
  std::size_t next = 0;
  for (const DirectionResult& r : h.canonical->directions) {
    if (r.failure) return *r.failure;
    // The same direction of T as an image direction: from the answer's own point on T, projected on T of the exact normal.
    Vec<Real> d = exactly<Real>(r.onTangentPlane) - s.real.origin;
    d = d - dot(d, s.real.normal) * s.real.normal;
    d = unit(d);
    const Vec<Real> x0 = s.real.camera.homogeneous(s.real.origin), x1 = s.real.camera.homogeneous(s.real.origin + d) - x0;
    const Real a = conic.form(x1, x1), b = conic.form(x0, x1), c = conic.form(x0, x0), root = sqrt(Real(b * b - a * c));
    Real onPlane = (-b + root) / a;
    if (!(onPlane > 0) || ((-b - root) / a > 0 && (-b - root) / a < onPlane)) onPlane = (-b - root) / a;
    const Real alpha = s.real.alphaOnPlane(onPlane, d);
    const Real onSurface =
        s.real.reachOnSurface(d, alpha, std::min(static_cast<double>(onPlane) / 4, 0.01 / std::abs(p.curvature / p.scale)));
    const auto [x, y] = s.real.camera.pixel(s.real.foot(onSurface, d));
    const auto [px, py] = s.real.camera.pixel(s.real.origin);
    const Pixel& q = h.canonical->pixels[next++];
    const Real dx = Real(q.x()) - x, dy = Real(q.y()) - y, reach = sqrt((x - px) * (x - px) + (y - py) * (y - py));
    worst = worstOf({worst, static_cast<double>(sqrt(dx * dx + dy * dy) / reach)});
  }
  return Measured{worst, p.condition};
}

/// dual: every vertex of the answer on the mirrored outline; distance by the conic's value over its gradient.
Outcome<Measured> dualCase(const PredictionScene& p, const Light& light, double size) {
  const Stage s = stageOf(p, light);
  const Ellipsoid e = ellipsoidAt(light, size * p.scale);
  ModelFit fit;
  fit.family = EllipsoidFit{e.dual(), e};
  const Prediction prediction = modelByName("dual").predict(fit, s.camera, s.surface.get(), Settings());
  if (prediction.highlights().empty()) return *prediction.failure();
  const PredictedHighlight& h = prediction.highlights().front();
  const RealConic conic = mirroredOutline(e, s.real);
  double worst = 0;
  for (std::size_t i = 0; i < h.contour.points.size(); i += 15) {
    const Vec<Real> x{Real(h.contour.points[i].x()), Real(h.contour.points[i].y()), Real(1)};
    const Real gx = conic.form(x, {Real(1), Real(0), Real(0)}), gy = conic.form(x, {Real(0), Real(1), Real(0)});
    worst =
        worstOf({worst, static_cast<double>(abs(conic.form(x, x)) / (2 * sqrt(gx * gx + gy * gy))) / h.ellipse->semiAxes.x()});
  }
  return Measured{worst, p.condition};
}

/// A plate of 0.04 m inside a highlight of 0.3 m: what is seen is the plate, so that the outline is its four edges.
struct Plate {
  std::shared_ptr<const Surface> surface;
  Camera camera = cameraTowards({0.35, -0.25, 1.4}, {0, 0, 0}, 800);
  Light light = Light::at({-0.4, 0.3, 1.6});
  Plate() {
    AnalyticSpec s = specOf(0, false);
    s.type = "sheet";
    s.length = s.width = 0.04;
    surface = makeAnalytic(s);
  }
};
Outcome<Measured> plateCase() {
  const Plate plate;
  ModelFit fit;
  fit.lightEstimate = plate.light;
  fit.family = LimitAngleFit{0.1};
  const Prediction prediction = modelByName("limit-angle").predict(fit, plate.camera, plate.surface.get(), Settings());
  if (prediction.highlights().empty()) return *prediction.failure();
  const RealCamera<Real> real(plate.camera);
  const Real half = Real(0.04) / 2;
  std::pair<Real, Real> corner[4];
  for (int i = 0; i < 4; ++i)
    corner[i] = real.pixel(Vec<Real>{i == 1 || i == 2 ? half : Real(-half), i >= 2 ? half : Real(-half), Real(0)});
  Real area = 0, longest = 0;
  for (int i = 0; i < 4; ++i) {
    const auto &a = corner[i], &b = corner[(i + 1) % 4];
    area += (a.first * b.second - b.first * a.second) / 2;
    longest =
        std::max(longest, Real(sqrt((b.first - a.first) * (b.first - a.first) + (b.second - a.second) * (b.second - a.second))));
  }
  double worst = 0;
  for (const Pixel& q : prediction.highlights().front().contour.points) {
    Real nearest = Real(1e9);
    for (int i = 0; i < 4; ++i) {
      const auto &a = corner[i], &b = corner[(i + 1) % 4];
      const Real ex = b.first - a.first, ey = b.second - a.second, length = sqrt(ex * ex + ey * ey);
      nearest = std::min(nearest, Real(abs((q.x() - a.first) * ey - (q.y() - a.second) * ex) / length));
    }
    worst = worstOf({worst, static_cast<double>(nearest / longest)});
  }
  // The vertices lie on the edges; that they go all the way round shows in the area, which cut corners change a little.
  const double found = std::abs(signedArea(prediction.highlights().front().contour));
  if (!(std::abs(found / static_cast<double>(abs(area)) - 1) < 1e-3)) return Measured{1};
  return Measured{worst};
}

/// Level sets of a cone |q - centre| < radius, whose outline is a circle.
Outcome<Measured> coneCase(double radius, const Pixel& centre, std::size_t expected) {
  const PixelField field = [&](const Pixel& q) -> std::optional<double> { return (q - centre).norm(); };
  LevelSetOptions options;
  options.seeds = {centre};
  const std::vector<LevelSetComponent> found = traceLevelSets(field, {}, radius, 640, 480, options);
  if (found.size() != expected) return Failure{Reason::NoHighlight, std::to_string(found.size()) + " components"};
  double worst = 0;
  for (const Pixel& q : found[0].outline.points) {
    const Real dx = Real(q.x()) - centre.x(), dy = Real(q.y()) - centre.y();
    worst = worstOf({worst, static_cast<double>(abs(sqrt(dx * dx + dy * dy) / radius - 1))});
  }
  return Measured{worst, centre.norm() / radius};
}

}  // namespace

void addPredictionCases(Cases& cases) {
  const Eigen::Vector3d d = obliqueDirection();
  struct Row {
    const char* name;
    double parameter;
    PredictionScene scene;
    Light light;
    double size;  ///< of the ellipsoid, m; 0 = limit-angle only
  };
  const Row rows[] = {
      {"light at 1e-2 m", 1e-2, {.distance = 0.3, .focal = 2000}, Light::at({0.052, 0.028, 0.009}), 2e-3},
      {"light at 1e9 m", 1e9, {}, Light::at(1e9 * d), 5e7},
      {"light at infinity", 0, {}, Light::towards(d), 0},
      {"curvature 1e-9 per metre", 1e-9, {.curvature = 1e-9, .round = false}, Light::at(2 * d), 0.2},
      {"curvature 1e3 per metre", 1e3, {.curvature = 1e3, .distance = 0.1, .focal = 5e4}, Light::at(2 * d), 0.2},
      {"scene scale 1e-6", 1e-6, {.scale = 1e-6}, Light::at(2e-6 * d), 0.2},
      {"scene scale 1e6", 1e6, {.scale = 1e6}, Light::at(2e6 * d), 0.2},
      {"focal length 50 px", 50, {.focal = 50}, Light::at(2 * d), 0.2},
      {"focal length 50,000 px, highlight larger than the image", 5e4, {.focal = 5e4, .limit = 2e-3}, Light::at(2 * d), 0.01},
      {"focal length 1e4 px at 18.75 m", 1e4, {.distance = 18.75, .focal = 1e4}, Light::at(2 * d), 0.2},
      {"focal length 1e5 px at 187.5 m", 1e5, {.distance = 187.5, .focal = 1e5}, Light::at(2 * d), 0.2},
      {"focal length 1e6 px at 1,875 m", 1e6, {.distance = 1875, .focal = 1e6}, Light::at(2 * d), 0.2},
      {"skew 1 px", 1, {.skew = 1}, Light::at(2 * d), 0.2},
      {"skew 30 px", 30, {.skew = 30}, Light::at(2 * d), 0.2},
      {"skew 1,000 px", 1000, {.skew = 1000}, Light::at(2 * d), 0.2},
      {"grazing 80 degrees", 80, {.curvature = 0.5, .limit = 0.04, .condition = 5.8}, grazingLight(80), 0.1},
      {"grazing 85 degrees", 85, {.curvature = 0.5, .limit = 0.02, .condition = 11.5}, grazingLight(85), 0.05},
      {"grazing 89 degrees", 89, {.curvature = 0.5, .focal = 4e3, .limit = 4e-3, .condition = 57}, grazingLight(89), 0.01},
      {"grazing 89.9 degrees", 89.9, {.curvature = 0.5, .focal = 4e4, .limit = 4e-4, .condition = 573}, grazingLight(89.9), 1e-3},
      {"grazing 89.99 degrees",
       89.99,
       {.curvature = 0.5, .focal = 4e5, .limit = 4e-5, .condition = 5730},
       grazingLight(89.99),
       1e-4},
  };
  const auto add = [&](const char* stage, const Row& row, auto run) {
    Case c;
    c.stage = stage;
    c.name = row.name;
    c.parameter = row.parameter;
    c.run = run;
    cases.push_back(c);
  };
  for (const Row& row : rows) add("limit-angle", row, [row] { return limitAngleCase(row.scene, row.light); });
  for (const Row& row : rows)
    if (row.size > 0) add("canonical", row, [row] { return canonicalCase(row.scene, row.light, row.size); });
  for (const Row& row : rows)
    if (row.size > 0) add("dual", row, [row] { return dualCase(row.scene, row.light, row.size); });

  const auto cone = [&](const char* name, double radius, const Pixel& centre, double tolerance, const char* note) {
    Case c;
    c.stage = "level set";
    c.name = name;
    c.parameter = radius;
    c.tolerance = tolerance;
    c.note = note;
    c.run = [=] { return coneCase(radius, centre, 1); };
    cases.push_back(c);
  };
  cone("highlight of 2 px", 1, {320.3, 240.2}, 1e-9, "");
  cone("highlight of 0.02 px", 1e-2, {320.3, 240.2}, 2e-7,
       "vertices are exact to 1e-9 px: a tenth of a millionth of this radius");
  cone("highlight of 400 px", 200, {320.3, 240.2}, 1e-9, "");
  {
    Case plate;
    plate.stage = "limit-angle";
    plate.name = "highlight far larger than the surface";
    plate.parameter = 7;
    plate.run = plateCase;
    cases.push_back(plate);
    plate.stage = "canonical";
    plate.note = "every walk leaves the surface before its limit angle";
    plate.expect = Expect::Failure;
    plate.reasons = {Reason::SurfaceEnded};
    plate.run = []() -> Outcome<Measured> {
      const Plate scene;
      ModelFit fit;
      fit.lightEstimate = scene.light;
      const Ellipsoid e = ellipsoidAt(scene.light, 0.3);
      fit.family = EllipsoidFit{e.dual(), e};
      const Prediction p = modelByName("canonical").predict(fit, scene.camera, scene.surface.get(), Settings());
      if (p.highlights().empty()) return *p.failure();
      return Measured{0};
    };
    cases.push_back(plate);
  }
  Case c;
  c.stage = "limit-angle";
  c.name = "no point of the surface reaches the light's angle";
  c.note = "the light is behind the plane";
  c.expect = Expect::Failure;
  c.reasons = {Reason::NoBrightestPoint, Reason::NoHighlight, Reason::LightBehindSurface};
  c.run = []() -> Outcome<Measured> {
    ModelFit fit;
    fit.lightEstimate = Light::at({0.1, 0.2, -2});
    fit.family = LimitAngleFit{0.1};
    const Prediction p =
        modelByName("limit-angle")
            .predict(fit, cameraTowards({0.2, 0.1, 1}, {0, 0, 0}, 800), makeAnalytic(specOf(0, false)).get(), Settings());
    if (p.highlights().empty()) return *p.failure();
    return Measured{0};
  };
  cases.push_back(c);
}

}  // namespace glint::stability
