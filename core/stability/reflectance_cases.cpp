// SPDX-License-Identifier: BSD-3-Clause
#include "core/stability/reflectance_cases.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/math/special_functions/erf.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <numbers>

#include "core/model/model.h"
#include "core/reflectance/fit.h"
#include "core/stability/scene.h"

namespace glint::stability {
namespace {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

/// log of the radiance of a microfacet lobe from the textbook forms; terms that cancel in differences along the surface stay out.
Real logOfLobe(Lobe lobe, const Real& m, const Vec<Real>& n, const Vec<Real>& l, const Vec<Real>& v) {
  const Vec<Real> h = unit(l + v);
  const Real c = dot(n, h), tan2 = (1 - c * c) / (c * c);
  const auto tangent = [&](const Vec<Real>& d) { return Real(sqrt(Real(1 - dot(n, d) * dot(n, d))) / dot(n, d)); };
  const auto lambda = [&](const Vec<Real>& d) -> Real {
    const Real t = tangent(d);
    if (t <= 0) return 0;
    if (lobe == Lobe::Ggx) return (sqrt(Real(1 + m * m * t * t)) - 1) / 2;
    const Real a = 1 / (m * t);
    const Real pi = boost::math::constants::pi<Real>();
    return exp(Real(-a * a)) / (2 * a * sqrt(pi)) - boost::math::erfc(a) / 2;
  };
  const Real d = lobe == Lobe::Ggx ? Real(-2 * log(Real(m * m + tan2))) : Real(-tan2 / (m * m));
  return d - 4 * log(c) - log(Real(1 + lambda(l) + lambda(v))) - log(dot(n, v));
}

struct RadianceScene {
  Lobe lobe = Lobe::TorranceSparrow;
  double roughness = 0.1, curvature = 0.8, scale = 1, distance = 1.5, focal = 800;
  bool round = true;
  double spread = 1;  ///< of the views' mirror points
};

/// A surface, a lamp and the radiance on it, in fifty digits.
struct Lit {
  Bent<Real> surface;
  Lamp<Real> lamp;
  Lobe lobe;
  Real m;
  Real at(const Vec<Real>& p, const Vec<Real>& n, const Vec<Real>& eye) const {
    const Vec<Real> to = lamp.l - lamp.w * p;
    return logOfLobe(lobe, m, n, unit(to), unit(eye - p)) - log(dot(to, to));
  }
  Real at(const Real& u, const Real& v, const Vec<Real>& eye) const { return at(surface.point(u, v), surface.normal(u, v), eye); }

  /// The maximum near (u, v), by Newton's method on differences far smaller than the scene; they keep half of the digits.
  std::pair<Real, Real> peak(Real u, Real v, const Vec<Real>& eye, const Real& size) const {
    const Real h = size * Real("1e-14");
    for (int i = 0; i < 60; ++i) {
      Real f[3][3];
      for (int a = -1; a <= 1; ++a)
        for (int b = -1; b <= 1; ++b) f[a + 1][b + 1] = at(Real(u + a * h), Real(v + b * h), eye);
      const Real gu = (f[2][1] - f[0][1]) / (2 * h), gv = (f[1][2] - f[1][0]) / (2 * h);
      const Real uu = (f[2][1] - 2 * f[1][1] + f[0][1]) / (h * h), vv = (f[1][2] - 2 * f[1][1] + f[1][0]) / (h * h);
      const Real uv = (f[2][2] - f[2][0] - f[0][2] + f[0][0]) / (4 * h * h), det = uu * vv - uv * uv;
      Real du = -(vv * gu - uv * gv) / det, dv = -(uu * gv - uv * gu) / det;
      // Not yet where the field is concave: uphill by a tenth of the size.
      const Real slope = sqrt(Real(gu * gu + gv * gv));
      if (!(uu < 0 && det > 0)) du = size * gu / (10 * slope), dv = size * gv / (10 * slope);
      Real share = 1;
      while (share > Real("1e-6") && at(Real(u + share * du), Real(v + share * dv), eye) < f[1][1]) share /= 2;
      u += share * du;
      v += share * dv;
      if (sqrt(Real(du * du + dv * dv)) < size * Real("1e-20")) break;
    }
    return {u, v};
  }
};

/// Fall of log I from the peak at the contour of level 0.5.
Real fallAtHalf() { return log(Real(2)); }

double sizeOf(const RadianceScene& p) {
  return 0.5 * p.roughness * p.scale * std::min(p.distance, 1 / std::max(p.curvature, 1e-3));
}

/// What the code under test says of a new camera: every vertex lies where the radiance has fallen to half of its maximum.
Outcome<Measured> predictionCase(const RadianceScene& p, const Light& light) {
  const double k = p.curvature / p.scale;
  const Lit lit{{Real(k), p.round}, lampOf<Real>(light), p.lobe, Real(p.roughness)};
  const double u = 0.05 * p.scale;
  const RealView<Real> view = mirrorView(lit.surface, lit.lamp, u, 0.6 * u, p.distance * p.scale, p.focal);
  const auto [pu, pv] = lit.peak(view.u0, view.v0, view.eye, Real(sizeOf(p)));
  const Real top = lit.at(pu, pv, view.eye);
  ModelFit fit;
  fit.lightEstimate = light;
  fit.lobe = nameOf(p.lobe);
  fit.roughness = p.roughness;
  fit.level = 0.5;
  const auto surface = makeAnalytic(specOf(k, p.round));
  const Prediction prediction = modelByName("reflectance").predict(fit, view.camera, surface.get(), Settings());
  if (prediction.highlights.empty()) return prediction.failure.value_or(Failure{Reason::NoHighlight, ""});
  const PredictedHighlight& h = prediction.highlights.front();
  if (h.coverage < 0.999) return Failure{Reason::SurfaceEnded, "coverage below 1"};
  double worst = 0;
  const std::size_t stride = std::max<std::size_t>(1, h.contour.points.size() / 40);
  for (std::size_t i = 0; i < h.contour.points.size(); i += stride) {
    // First hit of the pixel's ray on k |x|^2 + 2 z = 0 (sheet: without y): the root of the quadratic nearer to the eye.
    const Pixel& q = h.contour.points[i];
    const Vec<Real> o = view.eye, d = view.real.ray(Real(q.x()), Real(q.y()));
    const auto flat = [&](const Vec<Real>& x) {
      return Vec<Real>{lit.surface.k * x.x, p.round ? Real(lit.surface.k * x.y) : Real(0), lit.surface.k * x.z};
    };
    const Vec<Real> ad = flat(d), ao = flat(o);
    const Real a = dot(d, ad), b = dot(ao, d) + d.z, c = dot(o, ao) + 2 * o.z;
    const Real root = b + (b > 0 ? 1 : -1) * sqrt(Real(b * b - a * c));
    Real t = -c / root;
    if (a != 0 && -root / a > 0 && (-root / a < t || t <= 0)) t = -root / a;
    const Vec<Real> x = o + t * d, outward = flat(x);
    const Vec<Real> n = unit(Vec<Real>{outward.x, outward.y, outward.z + 1});
    worst = worstOf({worst, static_cast<double>(abs((top - lit.at(x, n, o)) / fallAtHalf() - 1))});
  }
  return Measured{worst};
}

/// Exact contours of several views; light and roughness are to be found from a guess some percent off.
/// @param copies  every view this often
Outcome<Measured> fitCase(const RadianceScene& p, const Light& light, int copies) {
  const double k = p.curvature / p.scale;
  const Lit lit{{Real(k), p.round}, lampOf<Real>(light), p.lobe, Real(p.roughness)};
  const auto surface = makeAnalytic(specOf(k, p.round));
  std::vector<RadianceView> views;
  const double places[][2] = {{0.05, 0.03}, {-0.1, 0.12}, {0.2, -0.15}, {-0.22, -0.1}, {0.02, 0.25}, {0.15, 0.2}};
  for (const auto& place : places) {
    const RealView<Real> view = mirrorView(lit.surface, lit.lamp, place[0] * p.spread * p.scale, place[1] * p.spread * p.scale,
                                           p.distance * p.scale, p.focal);
    const auto [pu, pv] = lit.peak(view.u0, view.v0, view.eye, Real(sizeOf(p)));
    const Real top = lit.at(pu, pv, view.eye);
    RadianceView v;
    v.camera = view.camera;
    v.surface = surface.get();
    const auto pixel = [&](const Real& a, const Real& b) {
      const auto [x, y] = view.real.pixel(lit.surface.point(a, b));
      return Pixel(static_cast<double>(x), static_cast<double>(y));
    };
    v.peak = pixel(pu, pv);
    for (int i = 0; i < 72; ++i) {
      const double azimuth = 2 * std::numbers::pi * i / 72;
      const Real du = Real(std::cos(azimuth)), dv = Real(std::sin(azimuth));
      const auto f = [&](const Real& reach) {
        return Real(top - lit.at(Real(pu + reach * du), Real(pv + reach * dv), view.eye) - fallAtHalf());
      };
      Real low = 0, high = Real(0.2 * sizeOf(p));
      while (f(high) < 0) low = high, high *= Real(1.2);
      const Real reach = rootBetween<Real>(f, low, high);
      v.contour.push_back(pixel(Real(pu + reach * du), Real(pv + reach * dv)));
    }
    for (int c = 0; c < copies; ++c) {
      v.frame = static_cast<int>(views.size());
      views.push_back(v);
    }
  }
  // A guess off by five percent of the distance and by a part of the lobe's width sideways.
  const Eigen::Vector4d l = light.homogeneous();
  const Eigen::Vector3d aside = 0.2 * p.roughness * Eigen::Vector3d(0.7, 0.4, -0.6) * l.head<3>().norm();
  const Light guess = light.atInfinity() ? Light::towards(l.head<3>() + aside)
                                         : Light::at(light.position() + 0.05 * light.position() + aside / std::abs(l.w()));
  RadianceFitOptions options;
  options.lightSize = false;
  const Outcome<RadianceFit> fit = fitRadiance(p.lobe, views, guess, 1.2 * p.roughness, options);
  if (!fit) return fit.failure();
  if (fit->poor) return Failure{Reason::NotConverged, "poor"};
  // Lights compared as points of projective space in units of the scene.
  const auto normalised = [&](const Light& x) {
    Eigen::Vector4d y = x.homogeneous();
    y.head<3>() /= p.scale;
    return Eigen::Vector4d(y.normalized());
  };
  const Eigen::Vector4d a = normalised(fit->light), b = normalised(light);
  return Measured{worstOf({std::min((a - b).norm(), (a + b).norm()), std::abs(fit->roughness / p.roughness - 1)})};
}

}  // namespace

void addReflectanceCases(Cases& cases) {
  const Eigen::Vector3d d = obliqueDirection();
  struct Row {
    const char* name;
    double parameter;
    RadianceScene scene;
    Light light;
  };
  const Row rows[] = {
      {"nominal", 1, {}, Light::at(2 * d)},
      {"ggx", 1, {.lobe = Lobe::Ggx}, Light::at(2 * d)},
      {"scene scale 1e-6", 1e-6, {.scale = 1e-6}, Light::at(2e-6 * d)},
      {"scene scale 1e6", 1e6, {.scale = 1e6}, Light::at(2e6 * d)},
      {"light at 1e9 m", 1e9, {}, Light::at(1e9 * d)},
      {"light at infinity", 0, {}, Light::towards(d)},
      {"curvature 1e-9 per metre", 1e-9, {.curvature = 1e-9, .round = false}, Light::at(2 * d)},
      {"grazing 85 degrees", 85, {.roughness = 0.02, .curvature = 0.5, .spread = 0.2}, grazingLight(85)},
      {"roughness 1e-3", 1e-3, {.roughness = 1e-3}, Light::at(2 * d)},
      {"roughness 1", 1, {.roughness = 1, .curvature = 0, .focal = 100, .round = false}, Light::at(2 * d)},
  };
  const auto add = [&](const char* stage, const char* name, double parameter, double tolerance, const char* note, auto run) {
    cases.push_back(answerCase(stage, name, parameter, tolerance, note, run));
  };
  for (const Row& row : rows)
    add("reflectance", row.name, row.parameter, 1e-8,
        "the peak is found to 1e-4 px, its value to the square of that over the width",
        [row] { return predictionCase(row.scene, row.light); });
  for (const Row& row : rows) {
    const bool slanted = row.parameter == 85, tiny = row.scene.roughness < 0.01;
    const char* note = slanted ? "the fit ends at residuals of 1e-7 px on contours a few pixels across"
                       : tiny  ? "contours one pixel across"
                               : "";
    add("reflectance fit", row.name, row.parameter, slanted ? 1e-6 : 1e-9, note,
        [row] { return fitCase(row.scene, row.light, 1); });
    if (tiny) cases.back().expect = Expect::AnswerOrFailure, cases.back().reasons = {Reason::NotConverged};
  }
  add("reflectance fit", "every frame three times", 3, 1e-9, "as without the copies",
      [rows] { return fitCase(rows[0].scene, rows[0].light, 3); });
}

}  // namespace glint::stability
