// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numbers>

#include "core/base/number_text.h"
#include "core/model/reconstruct.h"
#include "tests/stability/cases.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/scene.h"

namespace glint::stability {
namespace {

/// An ellipsoid by centre and axes as doubles.
Ellipsoid truth(const Eigen::Vector3d& axes, double scale, const Eigen::Vector3d& centre = {0.3, -0.2, 0.4}) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized()));
  pose.pretranslate(scale * centre);
  return Ellipsoid(pose, scale * axes);
}
const Eigen::Vector3d kAxes(0.3, 0.2, 0.12);

/// Outline by h h^T - G G^T in fifty digits, its ellipse and its points rounded to double once.
ConicView viewOf(const Ellipsoid& e, const Projection& projection) {
  const auto& p = projection.matrix;
  const auto times = [&](const Vec<Real>& v, const Real& w) {
    Vec<Real> out;
    out.x = p(0, 0) * v.x + p(0, 1) * v.y + p(0, 2) * v.z + p(0, 3) * w;
    out.y = p(1, 0) * v.x + p(1, 1) * v.y + p(1, 2) * v.z + p(1, 3) * w;
    out.z = p(2, 0) * v.x + p(2, 1) * v.y + p(2, 2) * v.z + p(2, 3) * w;
    return out;
  };
  const Vec<Real> h = times(exactly<Real>(e.centre()), Real(1));
  Real d[6] = {h.x * h.x, h.x * h.y, h.x * h.z, h.y * h.y, h.y * h.z, h.z * h.z};
  for (int i = 0; i < 3; ++i) {
    const Vec<Real> g = times(Real(e.semiAxes()(i)) * exactly<Real>(Eigen::Vector3d(e.worldFromBody().linear().col(i))), Real(0));
    d[0] -= g.x * g.x, d[1] -= g.x * g.y, d[2] -= g.x * g.z, d[3] -= g.y * g.y, d[4] -= g.y * g.z, d[5] -= g.z * g.z;
  }
  const Real x = d[2] / d[5], y = d[4] / d[5], a = x * x - d[0] / d[5], b = x * y - d[1] / d[5], c = y * y - d[3] / d[5];
  const Real large = (a + c) / 2 + sqrt((a - c) * (a - c) / 4 + b * b), small = (a * c - b * b) / large;
  ConicView view{projection, {}, {}};
  view.ellipse.centre = {static_cast<double>(x), static_cast<double>(y)};
  view.ellipse.semiAxes = {static_cast<double>(sqrt(large)), static_cast<double>(sqrt(small))};
  view.ellipse.angle = static_cast<double>(atan2(2 * b, a - c) / 2);
  const Real l00 = sqrt(a), l10 = b / l00, l11 = sqrt(c - l10 * l10);
  for (int i = 0; i < 36; ++i) {
    const double t = 2 * std::numbers::pi * i / 36;
    view.points.emplace_back(static_cast<double>(x + l00 * std::cos(t)),
                             static_cast<double>(y + l10 * std::cos(t) + l11 * std::sin(t)));
  }
  return view;
}

struct Ring {
  double scale = 1, focal = 800, spread = 1, distance = 2;
  int distinct = 0;
  bool oneCentre = false, flat = false;  ///< `flat`: cameras and centre in one plane
};
std::vector<ConicView> viewsOf(const Ellipsoid& e, int n, const Ring& ring) {
  std::vector<ConicView> views;
  const Eigen::Vector3d centre = e.centre() / ring.scale;
  for (int i = 0; i < n; ++i) {
    if (ring.distinct > 0 && i >= ring.distinct) {
      views.push_back(views[i % ring.distinct]);
      continue;
    }
    const double a = ring.spread * 2.4 * i;
    Eigen::Vector3d eye =
        centre + ring.distance * Eigen::Vector3d(std::cos(a), std::sin(a), 0.45 + 0.25 * ring.spread * std::sin(3.1 * i));
    if (ring.flat) eye.z() = centre.z();
    if (ring.oneCentre) eye = centre + ring.distance * Eigen::Vector3d(1, 0, 0.45);
    const Eigen::Vector3d target = centre + Eigen::Vector3d(0.05 * std::sin(1.0 * i), 0.04 * std::cos(2.0 * i), 0);
    views.push_back(viewOf(e, cameraTowards(ring.scale * eye, ring.scale * target, ring.focal).projection()));
  }
  return views;
}

/// Worst of centre over the longest axis and shape over its largest eigenvalue.
double errorOf(const Ellipsoid& found, const Ellipsoid& e) {
  const Real size = e.semiAxes().x();
  const auto at = [](const Vec<Real>& v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; };
  Real sum = 0;
  Vec<Real> a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = Real(found.semiAxes()(i)) * exactly<Real>(Eigen::Vector3d(found.worldFromBody().linear().col(i)));
    b[i] = Real(e.semiAxes()(i)) * exactly<Real>(Eigen::Vector3d(e.worldFromBody().linear().col(i)));
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Real difference = 0;
      for (int k = 0; k < 3; ++k) difference += at(a[k], i) * at(a[k], j) - at(b[k], i) * at(b[k], j);
      sum += difference * difference;
    }
  return worstOf(
      {apart(found.centre(), exactly<Real>(e.centre())) / e.semiAxes().x(), static_cast<double>(sqrt(sum) / (size * size))});
}

Outcome<Measured> judged(const Outcome<Reconstruction>& r, const Ellipsoid& e) {
  if (!r) return r.failure();
  if (!r->ellipsoid) return Failure{Reason::NotAnEllipsoid, describe(r->quadric)};
  return Measured{errorOf(*r->ellipsoid, e), r->condition};
}
/// A start off by a tenth of everything.
Ellipsoid poorStart(const Ellipsoid& e) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = e.centre() + e.semiAxes().x() * Eigen::Vector3d(0.15, 0.2, -0.1);
  return Ellipsoid(pose, e.semiAxes().x() * Eigen::Vector3d(0.8, 0.7, 0.7));
}
Outcome<Measured> linear(const Ellipsoid& e, int n, const Ring& ring = {}) {
  return judged(reconstructLinear(viewsOf(e, n, ring)), e);
}
Outcome<Measured> anchored(const Ellipsoid& e, int n, const Ring& ring = {}) {
  return judged(reconstructAnchored(viewsOf(e, n, ring), e.centre()), e);
}
Outcome<Measured> refined(const Ellipsoid& e, int n, const Ring& ring = {}) {
  const std::vector<ConicView> views = viewsOf(e, n, ring);
  Outcome<Reconstruction> r = reconstructRefined(views, poorStart(e));
  if (r && r->condition == 0) r->condition = 1;
  return judged(r, e);
}

}  // namespace

void addReconstructionCases(Cases& cases) {
  using Solver = Outcome<Measured> (*)(const Ellipsoid&, int, const Ring&);
  const std::pair<const char*, Solver> solvers[] = {{"linear", linear}, {"anchored", anchored}, {"refined", refined}};
  const auto add = [&](const char* stage, const char* name, double parameter,
                       const std::function<Outcome<Measured>()>& run) -> Case& {
    Case c;
    c.stage = stage;
    c.name = name;
    c.parameter = parameter;
    c.run = run;
    cases.push_back(c);
    return cases.back();
  };
  for (const auto& [stage, solve] : solvers) {
    add(stage, "scene scale 1e-6", 1e-6, [solve = solve] { return solve(truth(kAxes, 1e-6), 5, {.scale = 1e-6}); });
    add(stage, "scene scale 1e6", 1e6, [solve = solve] { return solve(truth(kAxes, 1e6), 5, {.scale = 1e6}); });
    add(stage, "focal length 50 px", 50, [solve = solve] { return solve(truth(kAxes, 1), 5, {.focal = 50}); });
    add(stage, "focal length 50,000 px", 5e4, [solve = solve] { return solve(truth(kAxes, 1), 5, {.focal = 5e4}); });
    add(stage, "1,000 views", 1000, [solve = solve] { return solve(truth(kAxes, 1), 1000, {}); });
    add(stage, "5 views, each 40 times", 40, [solve = solve] { return solve(truth(kAxes, 1), 200, {.distinct = 5}); });
    add(stage, "one zero axis", 0, [solve = solve] { return solve(truth({0.3, 0.2, 0}, 1), 6, {}); });
    add(stage, "axis ratio 1e-3", 1e-3, [solve = solve] { return solve(truth({0.3, 0.2, 3e-4}, 1), 6, {}); });
    Case& coplanar =
        add(stage, "cameras and centre in one plane", 0, [solve = solve] { return solve(truth(kAxes, 1), 6, {.flat = true}); });
    (void)coplanar;
    Case& one =
        add(stage, "all cameras in one centre", 0, [solve = solve] { return solve(truth(kAxes, 1), 6, {.oneCentre = true}); });
    one.note = "one tangent cone holds a family of ellipsoids";
    one.expect = Expect::Failure;
    one.reasons = {Reason::RankDeficient};
  }
  const char* const l = "linear";
  // The depth of an ellipsoid shows in its outlines by the square of the parallax, here 12 times the spread: that much of the
  // contours' round-off is left in the answer, until no digit is.
  for (const double spread : {1e-3, 1e-6, 1e-8}) {
    const std::string name = formatted("cameras within %.0e rad of each other", 12 * spread);
    const double condition = 1 / (144 * spread * spread);
    Case& c = add(l, name.c_str(), 12 * spread, [spread, condition]() -> Outcome<Measured> {
      const Outcome<Measured> m = linear(truth(kAxes, 1), 6, {.spread = spread});
      if (!m) return m;
      return Measured{m->error, condition};
    });
    if (64 * kRound * condition > 1e-9) {
      c.note = "outlines show depth through the squared parallax: their round-off over it leaves fewer than nine digits";
      c.expect = Expect::Failure;
      c.reasons = {Reason::RankDeficient};
    }
  }
  {
    Case& c = add(l, "2 views", 2, [] { return linear(truth(kAxes, 1), 2); });
    c.note = "10 unknowns and 2 scales against 12 equations of rank 10: a family";
    c.expect = Expect::Failure;
    c.reasons = {Reason::TooFewViews};
  }
  add("anchored", "2 views", 2, [] { return anchored(truth(kAxes, 1), 2); });
  add("anchored", "ellipsoid of 1e8 m at 1e9 m, cameras around", 1e9,
      [] { return anchored(truth(kAxes, 1e9), 5, {.scale = 1e9}); });
  {
    Case& c = add("refined", "2 views without a prior", 2, [] { return refined(truth(kAxes, 1), 2); });
    c.note = "a family fits exactly";
    c.expect = Expect::Failure;
    c.reasons = {Reason::TooFewViews};
  }
}

}  // namespace glint::stability
