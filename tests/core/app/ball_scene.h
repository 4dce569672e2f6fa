// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Mirror balls before a camera, in 64-bit long doubles and by Fermat's principle: the light takes the shortest way. It shares
// nothing with the reflection law that the program solves.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "core/app/lamp_fit.h"

namespace glint::ball_scene {

using Real = long double;
using Vector = Eigen::Matrix<Real, 3, 1>;

/// From the ball's centre: a place, or a direction (distant).
struct Target {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  bool distant = false;
};

/// Point of the ball at which the way from eye to lamp is stationary. Bisection of the way's derivative over the angle in their
/// plane.
inline Eigen::Vector3d mirrorPoint(const Eigen::Vector3d& centre, double radius, const Target& eye, const Target& lamp) {
  const Vector c = centre.cast<Real>();
  const auto towards = [&](const Target& t) { return Vector(t.distant ? t.at.cast<Real>() : Vector(t.at.cast<Real>() - c)); };
  const Vector e = towards(eye), l = towards(lamp), x = e.normalized(), y = (l - l.dot(x) * x).normalized();
  const Real full = std::acos(l.normalized().dot(x));
  const auto slope = [&](Real t) {
    const Vector p = Real(radius) * (std::cos(t) * x + std::sin(t) * y), d = Real(radius) * (-std::sin(t) * x + std::cos(t) * y);
    const auto part = [&](const Target& target, const Vector& v) {
      return target.distant ? Real(-d.dot(v.normalized())) : Real((p - v).normalized().dot(d));
    };
    return part(eye, e) + part(lamp, l);
  };
  Real low = 0, high = full;
  for (int i = 0; i < 80; ++i) ((slope((low + high) / 2) > 0) ? high : low) = (low + high) / 2;
  const Real t = (low + high) / 2;
  return (c + Real(radius) * (std::cos(t) * x + std::sin(t) * y)).cast<double>();
}

inline Camera camera() {
  Camera c;
  c.pixelFromRay << 1500, 0, 959.5, 0, 1500, 539.5, 0, 0, 1;
  c.width = 1920;
  c.height = 1080;
  return c;
}

inline Pixel seenBy(const Camera& c, const Eigen::Vector3d& p) { return Eigen::Vector3d(c.pixelFromRay * p).hnormalized(); }

/// The exact outline under perspective: rays that touch the ball. Its circle is a rough one; the covariance is that of
/// independent points.
inline RefinedOutline outlineOf(const Camera& c, const Eigen::Vector3d& centre, double radius, double sigmaPx, int points = 120) {
  RefinedOutline o;
  const Eigen::Vector3d axis = centre.normalized(), u = axis.unitOrthogonal(), v = axis.cross(u);
  const double half = std::asin(radius / centre.norm());
  o.outline.centre = seenBy(c, centre);
  for (int k = 0; k < points; ++k) {
    const double t = 2 * std::numbers::pi * k / points;
    o.edge.push_back({seenBy(c, std::cos(half) * axis + std::sin(half) * (std::cos(t) * u + std::sin(t) * v)), sigmaPx});
    o.outline.radius += (o.edge.back().place - o.outline.centre).norm() / points;
  }
  o.covariance = Eigen::Vector3d(2.0, 2.0, 1.0).asDiagonal() * (sigmaPx * sigmaPx / points);
  return o;
}

/// One lamp a photograph, every ball sees it.
inline LampObservation seenOn(std::size_t ball, const std::string& frame, const Pixel& peak, double sigmaPx) {
  LampObservation o;
  o.frame = frame;
  o.object = ball;
  o.peak = peak;
  o.covariance = sigmaPx * sigmaPx * Eigen::Matrix2d::Identity();
  return o;
}

struct Arrangement {
  double radius = 0.05;  // m
  std::vector<Eigen::Vector3d> balls{{-0.4, 0.02, 1.3}, {0.35, -0.1, 1.5}};
  std::vector<Target> lamps{{{-0.9, -0.8, 0.2}}, {{0.2, -1.3, 0.6}}, {{1.1, 0.3, 0.1}}, {{0.4, -0.5, -1.2}}};
  double peakPx = 0.1, edgePx = 0.1;

  BallPhotographs photographs() const {
    BallPhotographs p;
    p.camera = camera();
    p.ballRadius = radius;
    for (const Eigen::Vector3d& b : balls) p.balls.push_back(outlineOf(camera(), b, radius, edgePx));
    for (std::size_t i = 0; i < lamps.size(); ++i)
      for (std::size_t k = 0; k < balls.size(); ++k)
        p.seen.push_back(
            seenOn(k, "shot" + std::to_string(i), seenBy(camera(), mirrorPoint(balls[k], radius, {}, lamps[i])), peakPx));
    return p;
  }
  /// The same with normal noise of the stated size on every peak and edge point.
  BallPhotographs noisy(unsigned seed) const {
    BallPhotographs p = photographs();
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (LampObservation& o : p.seen) o.peak += peakPx * Pixel(normal(random), normal(random));
    for (RefinedOutline& o : p.balls)
      for (EdgePoint& e : o.edge) e.place += edgePx * Pixel(normal(random), normal(random));
    return p;
  }
};

}  // namespace glint::ball_scene
