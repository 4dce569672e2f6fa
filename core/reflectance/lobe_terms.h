// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/reflectance/added_lobe.h"
#include "core/reflectance/lobe.h"
#include "core/surface/part_bounds.h"

namespace glint::lobe {

/// Terms of LogRadiance for any scalar: double, or a dual number that carries derivatives by the light and the roughness.
template <class T>
struct Terms {
  T lobe{0.0}, masking{0.0}, cosines{0.0};
  T total() const { return lobe + masking + cosines; }
};

/// tan^2 of the angle between two vectors of any length, without the cancellation of 1 / cos^2 - 1.
/// Written out without Eigen's cross product: its copies on the stack are read in other pieces than they were written, and the
/// processor waits for each (a third of the time of a fit to pixels).
template <class T, class U, class V>
T tanSquared(const Eigen::MatrixBase<U>& a, const Eigen::MatrixBase<V>& b) {
  const T ax(a(0)), ay(a(1)), az(a(2)), bx(b(0)), by(b(1)), bz(b(2));
  const T x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx, cosine = ax * bx + (ay * by + az * bz);
  return (x * x + (y * y + z * z)) / (cosine * cosine);
}

/// tan^2 of a direction's angle to the normal, with its part along the tangent times `ratio` and that across it over `ratio`.
template <class T>
T stretchedTanSquared(const LobeAxes& axes, const Eigen::Matrix<T, 3, 1>& direction, double ratio) {
  const Eigen::Vector3d aside = axes.normal.cross(axes.tangent);
  const T x = axes.tangent.cast<T>().dot(direction), y = aside.cast<T>().dot(direction), z = axes.normal.cast<T>().dot(direction);
  return (T(ratio) * (x * x) + y * y / T(ratio)) / (z * z);
}

/// Smith's Lambda for Beckmann slopes of width m.
template <class T>
T beckmannLambda(const T& roughness, const T& tan2) {
  using std::erfc;
  using std::exp;
  using std::sqrt;
  const T inverse = roughness * roughness * tan2;  // 1 / a^2
  // Beyond a = 6 both terms cancel to less than 1e-17 of the 1 they are added to.
  if (!(inverse > T(1.0 / 36))) return T(0.0);
  const T a = T(1.0) / sqrt(inverse);
  return T(0.5) * (exp(-a * a) / (a * T(std::sqrt(M_PI))) - erfc(a));
}

/// Smith's Lambda for GGX: (sqrt(1 + s^2) - 1) / 2 without cancellation, s = m tan theta.
template <class T>
T ggxLambda(const T& roughness, const T& tan2) {
  using std::sqrt;
  const T s2 = roughness * roughness * tan2;
  return T(0.5) * s2 / (sqrt(T(1.0) + s2) + T(1.0));
}

/// I of a lobe under one light as over / under * exp(exponent), for sums without a logarithm for each term.
template <class T>
struct Factors {
  T over, under, exponent;
};

// The lobes. A new one is a struct here, a value of Lobe, its case in withLobe(), and its place in allLobes(). t = tan^2 of
// the angle that the lobe falls with; s is t as the two widths stretch it, and t itself for a lobe with one. Each says:
//   isMicrofacet     it has masking and cosines
//   hasTwoWidths     its roughness depends on the direction; for lobes that fall with the angle between N and H
//   reaches          whether light from there is mirrored to the camera's side at all
//   tanSquared       t for unit vectors N, L, V
//   logDistribution  log D(m, t, s), or the log of the cosine power
//   lambda           Smith's Lambda for tan^2 of a direction's angle to N
//   constant         what of log I does not depend on the light; inverse = 1 / m^2, cosView = N.V
//   factors          the rest (m, 1 / m^2, t, s), with masking = 1 + Lambda(V) + Lambda(L) for a microfacet lobe
//   fall             log of the value in the mirror direction over that at theta_h, rad
//   roughnessOf      m of a lobe that has fallen by `depth` at theta_h
//   largest          of log D over parts of a surface, in single precision
//   leastShadowed    below cos theta_V (1 + Lambda(V)), which grows with cos theta_V

inline double squaredTangent(double theta) { return std::pow(std::tan(theta), 2); }
inline double logCosine(double theta) { return std::log(std::cos(theta)); }

/// What the lobes that fall with the angle between N and H share.
struct HalfVectorLobe {
  static constexpr bool hasTwoWidths() { return false; }
  template <class T>
  static bool reaches(const Eigen::Matrix<T, 3, 1>&, const Eigen::Matrix<T, 3, 1>&, const Eigen::Matrix<T, 3, 1>&) {
    return true;
  }
  template <class T>
  static T tanSquared(const Eigen::Matrix<T, 3, 1>& n, const Eigen::Matrix<T, 3, 1>& toLight,
                      const Eigen::Matrix<T, 3, 1>& toCamera) {
    return lobe::tanSquared<T>(n, (toLight + toCamera).eval());
  }
};

/// What the cosine powers share.
struct CosinePower {
  static constexpr bool isMicrofacet() { return false; }
  template <class T>
  static T lambda(const T&, const T&) {
    return T(0.0);
  }
  template <class T>
  static T constant(const T&, const T&) {
    return T(0.0);
  }
  static Eight leastShadowed(float, const Eight& cosView) { return cosView; }
};

struct PhongLobe : CosinePower {
  static constexpr const char* kName = "phong";
  static constexpr bool hasTwoWidths() { return false; }
  template <class T>
  static bool reaches(const Eigen::Matrix<T, 3, 1>& n, const Eigen::Matrix<T, 3, 1>& toLight,
                      const Eigen::Matrix<T, 3, 1>& toCamera) {
    return T(2.0) * n.dot(toLight) * n.dot(toCamera) - toLight.dot(toCamera) > T(0.0);
  }
  template <class T>
  static T tanSquared(const Eigen::Matrix<T, 3, 1>& n, const Eigen::Matrix<T, 3, 1>& toLight,
                      const Eigen::Matrix<T, 3, 1>& toCamera) {
    return lobe::tanSquared<T>((T(2.0) * n.dot(toLight) * n - toLight).eval(), toCamera);
  }
  // log cos through tan keeps the digits near the peak, where cos is 1 to round-off.
  template <class T>
  static T logDistribution(const T& m, const T& t, const T&) {
    using std::log1p;
    return T(-0.25) / (m * m) * log1p(t);
  }
  template <class T>
  static Factors<T> factors(const T&, const T& inverse, const T& t, const T&, const T&) {
    using std::log1p;
    return {T(1.0), T(1.0), T(-0.25) * inverse * log1p(t)};
  }
  static double fall(double m, double theta) {
    return 2 * theta < M_PI / 2 ? -std::log(std::cos(2 * theta)) / (2 * m * m) : HUGE_VAL;
  }
  static double roughnessOf(double theta, double depth) {
    return std::sqrt(-std::log(std::cos(2 * std::min(theta, 0.249 * M_PI))) / (2 * depth));
  }
  // sin^2 of half the angle between R and V is sin^2(theta_h) (cos^2 b + sin^2 b cos^2 f), b half the angle between L and V.
  // log1p: a narrow lobe makes much of the round-off of 1 - x. The log of 0 is not finite.
  static Eight largest(double m, const PartBounds& parts) {
    const float m2 = float(m) * float(m);
    const Eight& t = parts.tanSquared;
    constexpr float kAboveZero = 1e-7f;  // of 1, in single precision
    return 0.5f / m2 * (-2 * t / (1 + t) * parts.cosHalf.square()).max(-1 + kAboveZero).log1p();
  }
};

struct BlinnPhongLobe : HalfVectorLobe, CosinePower {
  static constexpr const char* kName = "blinn-phong";
  template <class T>
  static T logDistribution(const T& m, const T& t, const T&) {
    using std::log1p;
    return T(2.0) / (m * m) * (T(-0.5) * log1p(t));
  }
  template <class T>
  static Factors<T> factors(const T&, const T& inverse, const T& t, const T&, const T&) {
    using std::log1p;
    return {T(1.0), T(1.0), -inverse * log1p(t)};
  }
  static double fall(double m, double theta) { return -2 / (m * m) * logCosine(theta); }
  static double roughnessOf(double theta, double depth) { return std::sqrt(-2 * logCosine(theta) / depth); }
  static Eight largest(double m, const PartBounds& parts) { return -1 / (float(m) * float(m)) * parts.tanSquared.log1p(); }
};

/// log(1 + x). Unlike log1p it is computed eight at a time; what it loses (6e-8, absolute) is below the margin for round-off.
inline Eight ofOneAnd(const Eight& x) { return (1 + x).log(); }

/// What the lobes of slopes share: D = slopes / (pi m^2 cos^4 theta).
struct MicrofacetLobe : HalfVectorLobe {
  static constexpr bool isMicrofacet() { return true; }
  template <class T>
  static T logOverSlopes(const T& logSlopes, const T& m2, const T& t) {
    using std::log;
    using std::log1p;
    return logSlopes - log(T(M_PI) * m2) - T(4.0) * (T(-0.5) * log1p(t));
  }
  template <class T>
  static T constant(const T& inverse, const T& cosView) {
    using std::log;
    return log(inverse) - log(T(4 * M_PI) * cosView);
  }
};

/// Beckmann's distribution.
struct TorranceSparrowLobe : MicrofacetLobe {
  static constexpr const char* kName = "torrance-sparrow";
  template <class T>
  static T logDistribution(const T& m, const T& t, const T& stretched) {
    const T m2 = m * m;
    return logOverSlopes<T>(-stretched / m2, m2, t);
  }
  template <class T>
  static T lambda(const T& m, const T& tan2) {
    return beckmannLambda<T>(m, tan2);
  }
  template <class T>
  static Factors<T> factors(const T&, const T& inverse, const T& t, const T& stretched, const T& masking) {
    const T secant = T(1.0) + t;
    return {secant * secant, masking, -stretched * inverse};
  }
  static double fall(double m, double theta) { return squaredTangent(theta) / (m * m) + 4 * logCosine(theta); }
  static double roughnessOf(double theta, double depth) {
    return std::sqrt(squaredTangent(theta) / (depth - 4 * logCosine(theta)));
  }
  // -t/m^2 + 2 log(1 + t) rises up to t = 2 m^2 - 1 for lobes wider than that.
  static Eight largest(double m, const PartBounds& parts) {
    const float m2 = float(m) * float(m);
    const Eight at = parts.tanSquared.max(2 * m2 - 1);
    return -at / m2 + 2 * ofOneAnd(at) - std::log(float(M_PI) * m2);
  }
  /// m / (2 sqrt(pi)) where V is at the horizon.
  static Eight leastShadowed(float m, const Eight& cosView) { return cosView.max(0.27f * std::min(1.f, m)); }
};

struct GgxLobe : MicrofacetLobe {
  static constexpr const char* kName = "ggx";
  template <class T>
  static T logDistribution(const T& m, const T& t, const T& stretched) {
    using std::log1p;
    const T m2 = m * m;
    return logOverSlopes<T>(T(-2.0) * log1p(stretched / m2), m2, t);
  }
  template <class T>
  static T lambda(const T& m, const T& tan2) {
    return ggxLambda<T>(m, tan2);
  }
  template <class T>
  static Factors<T> factors(const T&, const T& inverse, const T& t, const T& stretched, const T& masking) {
    const T secant = T(1.0) + t, tail = T(1.0) + stretched * inverse;
    return {secant * secant, tail * tail * masking, T(0.0)};
  }
  static double fall(double m, double theta) { return 2 * std::log1p(squaredTangent(theta) / (m * m)) + 4 * logCosine(theta); }
  static double roughnessOf(double theta, double depth) {
    return std::sqrt(squaredTangent(theta) / std::expm1(0.5 * (depth - 4 * logCosine(theta))));
  }
  // Rises with t where m > 1, towards 4 log m.
  static Eight largest(double roughness, const PartBounds& parts) {
    const float m = float(roughness), m2 = m * m;
    const Eight& t = parts.tanSquared;
    return m <= 1 ? Eight(2 * (ofOneAnd(t) - ofOneAnd(t / m2)) - std::log(float(M_PI) * m2))
                  : Eight(Eight::Constant(4 * std::log(m) - std::log(float(M_PI) * m2)));
  }
  /// m / 2 where V is at the horizon.
  static Eight leastShadowed(float m, const Eight& cosView) {
    const float m2 = std::min(1.f, m * m);
    return 0.5f * (cosView + (cosView.square() * (1 - m2) + m2).sqrt());
  }
};

/// A lobe that a plugin brought.
struct ProfileLobe : HalfVectorLobe {
  static constexpr const char* kName = "";  ///< addedLobeName() tells it
  const LobeProfile& profile;
  explicit ProfileLobe(const LobeProfile& p) : profile(p) {}
  bool isMicrofacet() const { return profile.isMicrofacet(); }
  bool hasTwoWidths() const { return profile.hasTwoWidths(); }
  template <class T>
  T logDistribution(const T& m, const T& t, const T& stretched) const {
    using std::log1p;
    const T log = addedDistribution<T>(profile, m, stretched);
    return hasTwoWidths() ? T(log + T(2.0) * log1p(t)) : log;
  }
  template <class T>
  T lambda(const T& m, const T& tan2) const {
    return addedLambda<T>(profile, m, tan2);
  }
  template <class T>
  T constant(const T&, const T& cosView) const {
    using std::log;
    return isMicrofacet() ? T(-log(T(4.0) * cosView)) : T(0.0);
  }
  template <class T>
  Factors<T> factors(const T& m, const T&, const T& t, const T& stretched, const T& masking) const {
    return {T(1.0), masking, logDistribution<T>(m, t, stretched)};
  }
  double fall(double m, double theta) const {
    const double t = squaredTangent(theta);
    return logDistribution<double>(m, 0, 0) - logDistribution<double>(m, t, t);
  }
  /// A wider lobe falls less at one angle: bisection in log m.
  double roughnessOf(double theta, double depth) const {
    double low = std::log(1e-5), high = std::log(10.0);  // a mirror's, and a lobe that is wider than any hemisphere
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (fall(std::exp(middle), theta) > depth ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
  }
  Eight largest(double m, const PartBounds& parts) const {
    if (m > kCheckedRoughness || hasTwoWidths()) return Eight::Constant(1e30f);  // no part is ruled out
    Eight log;
    for (Eigen::Index i = 0; i < log.size(); ++i)
      log[i] = float(profile.logDistribution(m, std::max(0.f, parts.tanSquared[i])).value);
    return log;
  }
  static Eight leastShadowed(float, const Eight& cosView) { return cosView.max(1e-6f); }  // a Lambda that is not known may be 0
};

/// @param f  takes every lobe
template <class F>
decltype(auto) withLobe(Lobe lobe, F&& f) {
  switch (lobe) {
    case Lobe::Phong: return f(PhongLobe());
    case Lobe::BlinnPhong: return f(BlinnPhongLobe());
    case Lobe::TorranceSparrow: return f(TorranceSparrowLobe());
    case Lobe::Ggx: return f(GgxLobe());
    default: return f(ProfileLobe(*profileOf(lobe)));
  }
}

/// The terms for unit vectors on the lit and visible side (N.L > 0, N.V > 0; the lobe reaches the camera), which the caller has
/// checked.
template <class T>
Terms<T> terms(Lobe lobe, const RoughnessOf<T>& roughness, const LobeAxes& axes, const Eigen::Matrix<T, 3, 1>& toLight,
               const Eigen::Vector3d& toCamera) {
  using std::log;
  using std::log1p;
  const T& m = roughness.mean;
  const double ratio = roughness.ratio;
  const Eigen::Matrix<T, 3, 1> normal = axes.normal.cast<T>(), view = toCamera.cast<T>();
  return withLobe(lobe, [&](const auto& l) {
    const bool two = l.hasTwoWidths() && ratio != 1;
    const auto masked = [&](const Eigen::Matrix<T, 3, 1>& v) {
      return l.template lambda<T>(m, two ? stretchedTanSquared<T>(axes, v, 1 / ratio) : tanSquared<T>(normal, v));
    };
    Terms<T> out;
    const T t = l.template tanSquared<T>(normal, toLight, view);
    out.lobe = l.template logDistribution<T>(m, t, two ? stretchedTanSquared<T>(axes, toLight + view, ratio) : t);
    if (!l.isMicrofacet()) return out;
    out.masking = -log1p(masked(toLight) + masked(view));
    out.cosines = -log(T(4.0) * normal.dot(view));
    return out;
  });
}

/// One lobe at one point seen from one side, under many lights: log I = constant() + log(over / under) + exponent. What does not
/// depend on the light is computed once, and a sum of radiances needs one exponential per light and no logarithm. The terms are
/// those of terms().
template <class T>
class LobeAt {
 public:
  using Value = Factors<T>;
  LobeAt(Lobe lobe, const RoughnessOf<T>& roughness, const LobeAxes& axes, const Eigen::Vector3d& toCamera)
      : lobe_(lobe),
        ratio_(roughness.ratio),
        axes_(axes),
        roughness_(roughness.mean),
        inverse_(T(1.0) / (roughness_ * roughness_)),
        normal_(axes.normal.cast<T>()),
        view_(toCamera.cast<T>()) {
    withLobe(lobe_, [&](const auto& l) {
      if (l.isMicrofacet())
        masking_ = T(1.0) + l.template lambda<T>(roughness_, l.hasTwoWidths() && ratio_ != 1
                                                                 ? stretchedTanSquared<T>(axes_, view_, 1 / ratio_)
                                                                 : tanSquared<T>(normal_, view_));
      constant_ = l.template constant<T>(inverse_, normal_.dot(view_));
    });
  }
  /// False where the exponent is always 0.
  bool hasExponent() const { return lobe_ != Lobe::Ggx; }
  const T& constant() const { return constant_; }

  /// Whether the lobe sends light from this unit vector on the lit side to the camera at all.
  bool reaches(const Eigen::Matrix<T, 3, 1>& toLight) const {
    return withLobe(lobe_, [&](const auto& l) { return l.template reaches<T>(normal_, toLight, view_); });
  }
  /// @param toLight  a unit vector on the lit side that reaches the camera, which the caller has checked.
  Value towards(const Eigen::Matrix<T, 3, 1>& toLight) const {
    return withLobe(lobe_, [&](const auto& l) -> Value {
      const T t = l.template tanSquared<T>(normal_, toLight, view_);
      if (l.hasTwoWidths() && ratio_ != 1) return withTwoWidths(l, t, toLight);
      if (!l.isMicrofacet()) return l.template factors<T>(roughness_, inverse_, t, t, T(1.0));
      return l.template factors<T>(roughness_, inverse_, t, t,
                                   T(masking_ + l.template lambda<T>(roughness_, tanSquared<T>(normal_, toLight))));
    });
  }

 private:
  template <class Shape>
  Value withTwoWidths(const Shape& l, const T& t, const Eigen::Matrix<T, 3, 1>& toLight) const {
    const T stretched = stretchedTanSquared<T>(axes_, toLight + view_, ratio_);
    const T lambda =
        l.isMicrofacet() ? l.template lambda<T>(roughness_, stretchedTanSquared<T>(axes_, toLight, 1 / ratio_)) : T(0.0);
    return l.template factors<T>(roughness_, inverse_, t, stretched, T(masking_ + lambda));
  }

  Lobe lobe_;
  double ratio_;
  LobeAxes axes_;
  T roughness_, inverse_;  ///< m, 1 / m^2
  Eigen::Matrix<T, 3, 1> normal_, view_;
  T masking_{1.0}, constant_{0.0};
};

}  // namespace glint::lobe

namespace glint {

/// An upper bound of log I of one lobe under one light (method.md section 7, up to the light's constant) over eight parts of a
/// surface. It holds for an extended light as well when the bounds allow for its points: its radiance is a mean of theirs.
/// @param roughness  m > 0.
Eight largestLogRadiance(Lobe lobe, const Roughness& roughness, const PartBounds& parts);

}  // namespace glint
