// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/directed_limit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace glint {
namespace {
using Eigen::Vector3d;
constexpr double kLeast = 0.01;  // of a^2: an extent may come out slightly negative where the views do not support it

/// The half vector's frame at a surface point, and the map that carries the extent into it.
struct HalfFrame {
  Vector3d l, h, t, p;  ///< towards the light; half vector; across it towards N; h x t
  Vector3d u, v;        ///< A^T t and A^T p
  double sign = 1, distance = 0, length = 0, sine = 0, k = 0;
};

/// False where there is no such frame: the light on the point, L = -V, H = N.
bool halfFrame(const Vector3d& point, const Vector3d& n, const Vector3d& toCamera, const Eigen::Vector4d& light, HalfFrame& f) {
  const Vector3d plain = light.head<3>() - light.w() * point;
  f.distance = plain.norm();
  if (!(f.distance > 0)) return false;
  f.sign = n.dot(plain) < 0 ? -1 : 1;
  f.l = f.sign * plain / f.distance;
  const Vector3d half = f.l + toCamera;
  f.length = half.norm();
  if (!(f.length > 0)) return false;
  f.h = half / f.length;
  const Vector3d across = n - n.dot(f.h) * f.h;
  f.sine = across.norm();
  if (!(f.sine > 0)) return false;
  f.t = across / f.sine;
  f.p = f.h.cross(f.t);
  f.k = (light.w() != 0 ? std::abs(light.w()) / f.distance : 1.0) / f.length;
  f.u = f.k * (f.t - f.l * f.l.dot(f.t));
  f.v = f.k * (f.p - f.l * f.l.dot(f.p));
  return true;
}

/// Derivatives by the light (l, w) of a function whose derivatives by u and v are given: the chain rule backwards through
/// halfFrame().
Eigen::Vector4d byLight(const HalfFrame& f, const Vector3d& byU, const Vector3d& byV, const Vector3d& point, const Vector3d& n,
                        const Eigen::Vector4d& light) {
  const Vector3d byP = f.k * (byV - f.l * f.l.dot(byV));
  const Vector3d byT = f.k * (byU - f.l * f.l.dot(byU)) + byP.cross(f.h);
  const double byK = (byU.dot(f.u) + byV.dot(f.v)) / f.k;
  const Vector3d byAcross = (byT - f.t * f.t.dot(byT)) / f.sine;
  const Vector3d byH = f.t.cross(byP) - n * f.h.dot(byAcross) - n.dot(f.h) * byAcross;
  const Vector3d byHalf = (byH - f.h * f.h.dot(byH)) / f.length - byK * f.k / f.length * f.h;
  const Vector3d byL = byHalf - f.k * (byU * f.l.dot(f.t) + f.t * f.l.dot(byU) + byV * f.l.dot(f.p) + f.p * f.l.dot(byV));
  Vector3d byPlain = f.sign * (byL - f.l * f.l.dot(byL)) / f.distance;
  double byW = 0;
  if (light.w() != 0) {
    byPlain -= byK * f.k / f.distance * f.sign * f.l;
    byW = byK * f.k / light.w();
  }
  Eigen::Vector4d result;
  result << byPlain, byW - point.dot(byPlain);
  return result;
}

/// d (x^T E y) / d (xx yy zz xy xz yz).
Vector6 byEntries(const Vector3d& x, const Vector3d& y) {
  Vector6 e;
  e << x.x() * y.x(), x.y() * y.y(), x.z() * y.z(), x.x() * y.y() + x.y() * y.x(), x.x() * y.z() + x.z() * y.x(),
      x.y() * y.z() + x.z() * y.y();
  return e;
}

}  // namespace

double directedLimit(double limitAngle, const Eigen::Matrix3d& extent, const Eigen::Vector3d& point, const Eigen::Vector3d& n,
                     const Eigen::Vector3d& toCamera, const Eigen::Vector4d& light) {
  HalfFrame f;
  if (!halfFrame(point, n, toCamera, light, f)) return limitAngle;
  const double a2 = limitAngle * limitAngle, tt = a2 + f.u.dot(extent * f.u), pp = a2 + f.v.dot(extent * f.v),
               tp = f.u.dot(extent * f.v);
  const double radius2 = tt - tp * tp / std::max(pp, kLeast * a2);
  return std::sqrt(std::max(radius2, kLeast * a2));
}

DirectedLimit directedLimitWithDerivatives(double limitAngle, const Eigen::Matrix3d& extent, const Eigen::Vector3d& point,
                                           const Eigen::Vector3d& n, const Eigen::Vector3d& toCamera,
                                           const Eigen::Vector4d& light) {
  DirectedLimit result;
  result.angle = limitAngle;
  HalfFrame f;
  if (!halfFrame(point, n, toCamera, light, f)) return result;
  const Vector3d eu = extent * f.u, ev = extent * f.v;
  const double a2 = limitAngle * limitAngle, tt = a2 + f.u.dot(eu), pp = a2 + f.v.dot(ev), tp = f.u.dot(ev);
  const bool held = !(pp > kLeast * a2);  // pp is not what divides
  const double by = held ? kLeast * a2 : pp, ratio = tp / by, radius2 = tt - tp * ratio;
  if (!(radius2 > kLeast * a2)) {
    result.byLimit = std::sqrt(kLeast);
    result.angle = result.byLimit * limitAngle;
    return result;
  }
  result.angle = std::sqrt(radius2);
  // d radius^2 = d tt - 2 ratio d tp + ratio^2 d (what divides)
  const double half = 0.5 / result.angle, square = ratio * ratio, ofPp = held ? 0 : square;
  result.byLimit = half * 2 * limitAngle * (1 + (held ? kLeast * square : square));
  result.byExtent = half * (byEntries(f.u, f.u) - 2 * ratio * byEntries(f.u, f.v) + ofPp * byEntries(f.v, f.v));
  result.byLight = byLight(f, half * 2 * (eu - ratio * ev), half * 2 * (ofPp * ev - ratio * eu), point, n, light);
  return result;
}

}  // namespace glint
