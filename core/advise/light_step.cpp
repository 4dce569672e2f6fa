// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/advise/conditioning.h"
#include "core/advise/explain_case.h"
#include "core/base/numeric.h"
#include "core/light/estimate.h"

namespace glint::explain_steps {
namespace {

constexpr double kRoundOff = 1e-9;   // of a vector's length: coordinates are known to 1e-7 at best, so this is a zero
constexpr double kNarrowDeg = 2;     // between reflected rays: below, the light's distance is a guess
constexpr double kSameLight = 1e-9;  // of homogeneous coordinates of length 1: a model that took over the common light
constexpr double kManySigma = 4;     // noise alone throws a light this far from the truth once in 900 times (three coordinates)
constexpr double kRounding = 1e-6;   // of the distance to what is seen: a smaller error is one of the arithmetic

double largestSigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(covariance.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
}

/// Distance of two lights, m; if both are at infinity, the angle between their directions, deg.
ExplainNumber between(const std::string& name, const Light& a, const Light& b) {
  if (!a.atInfinity() && !b.atInfinity()) return one("", name, (a.position() - b.position()).norm(), "m");
  const Eigen::Vector3d u = a.homogeneous().head<3>().normalized(), v = b.homogeneous().head<3>().normalized();
  return one("", name, degrees(std::atan2(u.cross(v).norm(), u.dot(v))), "deg");
}

}  // namespace

ExplainNumber one(const std::string& symbol, const std::string& name, double value, const std::string& unit) {
  return {symbol, name, {value}, unit};
}
ExplainNumber point(const std::string& symbol, const std::string& name, const Eigen::Vector3d& p, const std::string& unit) {
  ExplainNumber n{symbol, name, {p.x(), p.y(), p.z()}, unit};
  for (double& v : n.values)
    if (std::abs(v) < kRoundOff * p.norm()) v = 0;
  return n;
}
ExplainNumber pixel(const std::string& symbol, const std::string& name, const Pixel& p) {
  return {symbol, name, {p.x(), p.y()}, "px"};
}

const PredictedHighlight* Case::predicted() const {
  if (!row) return nullptr;
  int index = row->predicted;
  if (index < 0)
    for (const FrameComparison::Row& other : comparison->rows)
      if (other.observed < 0 && other.predicted >= 0) index = other.predicted;
  return index >= 0 ? &comparison->prediction.highlights()[std::size_t(index)] : nullptr;
}

bool Case::sharesModel(int frame) const { return inspection.keyFor(frame, out.light) == inspection.keyFor(out.frame, out.light); }

const LightEstimate* Case::common() const { return inspection.lightFor(out.frame, out.light); }

const Light* Case::own() const {
  if (!fit || !fit->fit || !fit->fit->lightEstimate) return nullptr;
  const LightEstimate* shared = common();
  const Light& light = *fit->fit->lightEstimate;
  if (!shared) return &light;
  const Eigen::Vector4d a = light.homogeneous().normalized(), b = shared->light.homogeneous().normalized();
  return std::min((a - b).norm(), (a + b).norm()) < kSameLight ? nullptr : &light;
}

void addOtherLight(const Case& c, ExplainStep& step) {
  const LightEstimate* shared = c.common();
  if (const Light* own = c.own(); own && shared)
    step.broken.push_back({"other-light", {between("from this light to the model's own", *own, shared->light)}});
}

void lightStep(const Case& c, ExplainStep& step) {
  const LightEstimate* shared = c.common();
  const Light* own = c.own();
  if (!shared && !own) {
    const Failure* const why = c.inspection.lightFailureFor(c.out.frame, c.out.light);
    step.failure = why ? *why : Failure{Reason::NoLight, "no computed model needs one"};
    return;
  }
  const auto show = [&](const std::string& symbol, const std::string& whose, const Light& light) {
    if (light.atInfinity())
      step.numbers.push_back(point(symbol, "direction of a light at infinity" + whose, light.homogeneous().head<3>(), ""));
    else
      step.numbers.push_back(point(symbol, "light" + whose, light.position()));
  };
  const Light& light = own ? *own : shared->light;
  show("L", own ? ", as found by " + c.out.model : std::string(), light);
  if (own && shared) show("L\u2080", ", from all contours together", shared->light);
  // Those that this light was found from.
  std::vector<Eigen::Vector3d> rays;
  for (const TrainingView& v : c.inspection.views)
    if (v.seen && v.highlight.light == c.out.light && c.sharesModel(v.frame))
      rays.push_back(reflectedRay(v.seen->brightest, v.camera).direction);
  const double widest = widestAngle(rays);
  step.numbers.push_back(one("", "reflected rays", double(rays.size())));
  step.numbers.push_back(one("", "widest angle between them", degrees(widest), "deg"));
  const std::optional<Eigen::Matrix3d>& covariance = own ? c.fit->fit->lightCovariance : shared->covariance;
  const double sigma = covariance && covariance->allFinite() ? largestSigma(*covariance) : std::nan("");
  if (std::isfinite(sigma)) step.numbers.push_back(one("σ", "of L, largest axis: noise only", sigma, "m"));
  if (widest < radians(kNarrowDeg)) step.broken.push_back({"rays-parallel", {one("", "widest angle", degrees(widest), "deg")}});
  for (const TrueLight& truth : c.inspection.scene->lights) {
    if (truth.id != c.out.light || truth.lamp.atInfinity() || !extremesOf(truth.lamp).empty() || light.atInfinity()) continue;
    const double away = (light.position() - truth.lamp.position()).norm();
    step.numbers.push_back(one("", "distance from the true light", away, "m"));
    if (away > kManySigma * sigma && away > kRounding * workingDistance(*c.inspection.scene))
      step.broken.push_back({"light-beyond-sigma", {one("", "distance from the true light, in σ", away / sigma)}});
  }
}

}  // namespace glint::explain_steps
