// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "core/reflectance/added_lobe.h"
#include "core/reflectance/lobe.h"

namespace glint::lobe {

/// Terms of LogRadiance for any scalar: double, or a dual number that carries derivatives by the light and the roughness.
template <class T>
struct Terms {
  T lobe{0.0}, masking{0.0}, cosines{0.0};
  T total() const { return lobe + masking + cosines; }
};

/// tan^2 of the angle between two vectors of any length, without the cancellation of 1 / cos^2 - 1.
/// Written out: with Eigen's cross product, copies on the stack are read in other pieces than they were written, and the processor waits
/// for each (a third of the time of a fit to pixels).
template <class T, class U, class V>
T tanSquared(const Eigen::MatrixBase<U>& a, const Eigen::MatrixBase<V>& b) {
  const T ax(a(0)), ay(a(1)), az(a(2)), bx(b(0)), by(b(1)), bz(b(2));
  const T x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx, cosine = ax * bx + (ay * by + az * bz);
  return (x * x + (y * y + z * z)) / (cosine * cosine);
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

/// The terms for unit vectors on the lit and visible side (N.L > 0, N.V > 0; phong: R.V > 0), which the caller has checked.
template <class T>
Terms<T> terms(Lobe lobe, const T& m, const Eigen::Vector3d& n, const Eigen::Matrix<T, 3, 1>& toLight,
               const Eigen::Vector3d& toCamera) {
  using std::log;
  using std::log1p;
  Terms<T> out;
  const Eigen::Matrix<T, 3, 1> normal = n.cast<T>(), view = toCamera.cast<T>();
  const T m2 = m * m;
  if (lobe == Lobe::Phong) {
    // log cos through tan keeps the digits near the peak, where cos is 1 to round-off.
    const Eigen::Matrix<T, 3, 1> mirrored = T(2.0) * normal.dot(toLight) * normal - toLight;
    out.lobe = T(-0.25) / m2 * log1p(tanSquared<T>(mirrored, view));
    return out;
  }
  const T tan2 = tanSquared<T>(normal, (toLight + view).eval());
  const T logCosH = T(-0.5) * log1p(tan2);
  if (lobe == Lobe::BlinnPhong) {
    out.lobe = T(2.0) / m2 * logCosH;
    return out;
  }
  const T tan2L = tanSquared<T>(normal, toLight), tan2V = tanSquared<T>(normal, view);
  if (lobe == Lobe::TorranceSparrow) {
    out.lobe = -tan2 / m2 - log(T(M_PI) * m2) - T(4.0) * logCosH;
    out.masking = -log1p(beckmannLambda<T>(m, tan2L) + beckmannLambda<T>(m, tan2V));
  } else if (lobe == Lobe::Ggx) {
    out.lobe = T(-2.0) * log1p(tan2 / m2) - log(T(M_PI) * m2) - T(4.0) * logCosH;
    out.masking = -log1p(ggxLambda<T>(m, tan2L) + ggxLambda<T>(m, tan2V));
  } else {
    const LobeProfile& added = *profileOf(lobe);
    out.lobe = addedDistribution<T>(added, m, tan2);
    if (!added.isMicrofacet()) return out;
    out.masking = -log1p(addedLambda<T>(added, m, tan2L) + addedLambda<T>(added, m, tan2V));
  }
  out.cosines = -log(T(4.0) * normal.dot(view));
  return out;
}

/// One lobe at one point seen from one side, under many lights: log I = constant() + log(over / under) + exponent. What does not
/// depend on the light is found once, and a sum of radiances needs an exponential per light and no logarithm. The same terms as
/// terms().
template <class T>
class LobeAt {
 public:
  struct Value {
    T over, under, exponent;
  };
  LobeAt(Lobe lobe, const T& roughness, const Eigen::Vector3d& normal, const Eigen::Vector3d& toCamera)
      : lobe_(lobe),
        roughness_(roughness),
        inverse_(T(1.0) / (roughness * roughness)),
        normal_(normal.cast<T>()),
        view_(toCamera.cast<T>()) {
    using std::log;
    if (lobe_ != Lobe::TorranceSparrow && lobe_ != Lobe::Ggx) {
      added_ = profileOf(lobe_);
      if (!added_ || !added_->isMicrofacet()) return;
      masking_ = T(1.0) + lambda(tanSquared<T>(normal_, view_));
      constant_ = -log(T(4.0) * normal_.dot(view_));
      return;
    }
    masking_ = T(1.0) + lambda(tanSquared<T>(normal_, view_));
    constant_ = log(inverse_) - log(T(4 * M_PI) * normal_.dot(view_));
  }
  /// False where the exponent is always 0.
  bool hasExponent() const { return lobe_ != Lobe::Ggx; }
  const T& constant() const { return constant_; }

  /// @param toLight  a unit vector on the lit side (phong: R.V > 0), which the caller has checked.
  Value towards(const Eigen::Matrix<T, 3, 1>& toLight) const {
    using std::log1p;
    if (lobe_ == Lobe::Phong)
      return {T(1.0), T(1.0),
              T(-0.25) * inverse_ * log1p(tanSquared<T>((T(2.0) * normal_.dot(toLight) * normal_ - toLight).eval(), view_))};
    const T tan2 = tanSquared<T>(normal_, (toLight + view_).eval());
    if (lobe_ == Lobe::BlinnPhong) return {T(1.0), T(1.0), -inverse_ * log1p(tan2)};
    if (added_)
      return {T(1.0), added_->isMicrofacet() ? T(masking_ + lambda(tanSquared<T>(normal_, toLight))) : T(1.0),
              addedDistribution<T>(*added_, roughness_, tan2)};
    const T secant = T(1.0) + tan2;
    const T masking = masking_ + lambda(tanSquared<T>(normal_, toLight));
    if (lobe_ == Lobe::TorranceSparrow) return {secant * secant, masking, -tan2 * inverse_};
    const T tail = T(1.0) + tan2 * inverse_;
    return {secant * secant, tail * tail * masking, T(0.0)};
  }

 private:
  T lambda(const T& tan2) const {
    if (added_) return addedLambda<T>(*added_, roughness_, tan2);
    return lobe_ == Lobe::Ggx ? ggxLambda<T>(roughness_, tan2) : beckmannLambda<T>(roughness_, tan2);
  }

  Lobe lobe_;
  const LobeProfile* added_ = nullptr;
  T roughness_, inverse_;  ///< m, 1 / m^2
  Eigen::Matrix<T, 3, 1> normal_, view_;
  T masking_{1.0}, constant_{0.0};
};

}  // namespace glint::lobe
