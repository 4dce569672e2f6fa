// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr double kStepGrowth = 1.35;    // marching: fast enough for long walks, fine enough not to step over a lobe
constexpr double kFallFraction = 0.02;  // a fall of alpha by more than this share of the limit is not round-off or mesh noise
constexpr int kRootIterations = 60;     // bracketed: bisection alone needs 52

/// Root of f in [a, b] with f(a) < 0 <= f(b): regula falsi with the Anderson-Bjorck weights, bisection when it stalls.
/// `f` returns NaN to give up. Returns the last argument evaluated. (Boost's toms748_solve takes a tenth fewer steps, 2.0 for 2.2
/// on a sphere; other steps end at other last digits, and stored sessions replay with `--exact`.)
template <class F>
double bracketedRoot(F&& f, double a, double fa, double b, double fb, double tolerance) {
  int side = 0;
  double x = b;
  double width = b - a;
  for (int i = 0; i < kRootIterations; ++i) {
    x = (fb - fa) != 0 ? (a * fb - b * fa) / (fb - fa) : 0.5 * (a + b);
    if (!(x > a && x < b) || (i % 4 == 3 && b - a > 0.5 * width)) x = 0.5 * (a + b);
    if (i % 4 == 3) width = b - a;
    const double fx = f(x);
    if (!(std::abs(fx) > tolerance)) return x;  // also leaves on NaN: the caller checks its own state
    if (fx < 0) {
      if (side == -1) {
        const double m = 1 - fx / fa;
        fb *= m > 0 ? m : 0.5;
      }
      a = x;
      fa = fx;
      side = -1;
    } else {
      if (side == 1) {
        const double m = 1 - fx / fb;
        fa *= m > 0 ? m : 0.5;
      }
      b = x;
      fb = fx;
      side = 1;
    }
    if (b - a <= 4e-16 * std::abs(b)) return x;  // two neighbouring doubles
  }
  return x;
}

/// The last three pairs of a search for f(x) = 0, the newest first.
struct Pairs {
  double f[3] = {0, 0, 0}, x[3] = {0, 0, 0};

  /// Inverse interpolation at f = 0: the chord first, then the parabola through three pairs.
  double next(int round) const {
    const double chord = x[0] - f[0] * (x[0] - x[1]) / (f[0] - f[1]);
    if (round == 0) return chord;
    const double second = ((x[0] - x[1]) / (f[0] - f[1]) - (x[1] - x[2]) / (f[1] - f[2])) / (f[0] - f[2]);
    return chord + f[0] * f[1] * second;
  }
  /// f falls: this is not its first crossing.
  bool falls() const { return !((f[0] - f[1]) * (x[0] - x[1]) >= 0); }
  void add(double next) {
    f[2] = f[1], x[2] = x[1];
    f[1] = f[0], x[1] = x[0];
    x[0] = next;
  }
};

/// The first edge of a closed contour that a line between two pixels crosses; edge k starts at point k.
std::optional<std::size_t> firstEdgeCrossed(const std::vector<Pixel>& contour, const Pixel& from, const Pixel& to) {
  double best = 2;
  std::size_t edge = 0;
  for (std::size_t k = 0; k < contour.size(); ++k) {
    const Pixel &p = contour[k], &q = contour[(k + 1) % contour.size()];
    const Pixel r = to - from, s = q - p, w = p - from;
    const double denominator = r.x() * s.y() - r.y() * s.x();
    if (denominator == 0) continue;
    const double t = (w.x() * s.y() - w.y() * s.x()) / denominator, u = (w.x() * r.y() - w.y() * r.x()) / denominator;
    if (t > 0 && t <= 1 && u >= -1e-12 && u <= 1 + 1e-12 && t < best) best = t, edge = k;  // a corner belongs to both edges
  }
  return best <= 1 ? std::optional(edge) : std::nullopt;
}

}  // namespace

TangentWalk::TangentWalk(const Surface& surface, const Camera& camera, const BrightestPoint& brightest, const Light& light,
                         const WalkOptions& options)
    : surface_(surface), camera_(camera), brightest_(brightest), light_(light), options_(options), eye_(camera.centreInWorld()) {
  brightest_.point = facing(brightest.point, eye_);
  const Eigen::Vector3d& n = brightest_.point.normal;
  plane_ = Plane::through(brightest_.point.position, n);
  const Eigen::Vector3d right = camera.camFromWorld.linear().row(0).transpose();
  Eigen::Vector3d u = right - right.dot(n) * n;
  // Looking along the image's x axis: any direction will do, the image then shows T edge-on.
  u = u.norm() > 1e-8 ? Eigen::Vector3d(u.normalized()) : Eigen::Vector3d(tangentBasis(n).col(0));
  basis_.col(0) = u;
  basis_.col(1) = n.cross(u);
  // Image y points down: keep azimuths turning from +x to +y on the screen.
  const Eigen::Vector3d down = camera.camFromWorld.linear().row(1).transpose();
  if (basis_.col(1).dot(down) < 0) basis_.col(1) = -basis_.col(1);
  if (const auto* patch = dynamic_cast<const LocalQuadric*>(&surface);
      patch && patch->origin().position == brightest_.point.position) {
    const Eigen::Matrix3d& frame = patch->worldFromPatch();
    side_ = n == frame.col(2) ? 1 : -1;
    if (n == side_ * frame.col(2)) {
      patch_ = patch;
      const Eigen::Vector4d& lw = light_.homogeneous();
      eyeOnPatch_ = frame.transpose() * (eye_ - brightest_.point.position);
      lightOnPatch_ = frame.transpose() * (lw.head<3>() - lw.w() * brightest_.point.position);
    }
  }
}

Eigen::Vector3d TangentWalk::direction(double azimuth) const {
  return std::cos(azimuth) * basis_.col(0) + std::sin(azimuth) * basis_.col(1);
}

double TangentWalk::azimuthOf(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d d = basis_.transpose() * (point - brightest_.point.position);
  return std::atan2(d.y(), d.x());
}

Eigen::Matrix2d TangentWalk::angularRate() const {
  const SurfacePoint& p = brightest_.point;
  const Eigen::Vector4d& lw = light_.homogeneous();
  const Eigen::Vector3d toEye = eye_ - p.position, toLight = lw.head<3>() - lw.w() * p.position;
  const double r = toEye.norm(), q = toLight.norm();
  const Eigen::Vector3d v = toEye / r, l = toLight / q, sum = l + v;
  const double length = sum.norm();
  const Eigen::Vector3d h = sum / length;
  const Eigen::Matrix2d vv = basis_.transpose() * v * (v.transpose() * basis_),
                        ll = basis_.transpose() * l * (l.transpose() * basis_);
  const Eigen::Vector2d hb = basis_.transpose() * h;
  const Eigen::Matrix2d id = Eigen::Matrix2d::Identity();
  // At P_B the tangential part of H vanishes (or nearly, for an observed peak), so that B^T (I - H H^T) is B^T up to h_b.
  const Eigen::Matrix2d dSum = -(id - vv) / r - lw.w() / q * (id - ll);
  Eigen::Matrix2d j = (id - hb * hb.transpose()) * dSum / length;
  if (const Outcome<Curvature> c = surface_.curvatureAt(p)) {
    const Eigen::Vector2d d1 = basis_.transpose() * c->direction1, d2 = basis_.transpose() * c->direction2;
    j -= p.normal.dot(h) * (c->k1 * d1 * d1.transpose() + c->k2 * d2 * d2.transpose());
  }
  return j;
}

double TangentWalk::alphaOnPlane(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d l = light_.directionFrom(p), v = (eye_ - p).normalized();
  const Eigen::Vector3d& n = plane_.normal;
  if (!(n.dot(l) > 0) || !(n.dot(v) > 0)) return std::nan("");
  return incidentAngle(n, l, v);
}

Outcome<double> TangentWalk::alphaOnSurface(const SurfacePoint& p) const {
  const Eigen::Vector3d l = light_.directionFrom(p.position), v = (eye_ - p.position).normalized();
  if (!(p.normal.dot(v) > 0)) return Failure{Reason::Occluded, "the surface turns away from the camera"};
  if (!(p.normal.dot(l) > 0)) return Failure{Reason::LightBehindSurface, ""};
  return incidentAngle(p.normal, l, v);
}

Outcome<SurfacePoint> TangentWalk::foot(const Eigen::Vector3d& onPlane, const SurfacePoint& previous) const {
  Outcome<SurfacePoint> f = surface_.foot(onPlane, plane_.normal, previous);
  if (!f) return f;
  // The side of the normal is carried along the walk: turning it to the eye would hide a fold.
  if (f->normal.dot(previous.normal) < 0) f->normal = -f->normal;
  return f;
}

Outcome<double> TangentWalk::reachOnPlane(const Eigen::Vector3d& d, double limit, double scale) const {
  const Eigen::Vector3d& origin = brightest_.point.position;
  const auto f = [&](double s) { return alphaOnPlane(origin + s * d) - limit; };
  double a = 0, fa = f(0), highest = fa, step = scale;
  bool below = fa < 0;
  for (int i = 0; i < options_.maxSteps; ++i) {
    const double b = a + step, fb = f(b);
    if (std::isnan(fb)) return Failure{Reason::NotReached, "the walk on the tangent plane left the lit side"};
    if (below && fb >= 0) return bracketedRoot(f, a, fa, b, fb, options_.toleranceRad);
    if (fb < 0) below = true;
    if (below && fb < highest - kFallFraction * limit && highest > fa && fb < fa)
      return Failure{Reason::NotMonotonic, "alpha falls before it reaches the limit on the tangent plane"};
    if (below) highest = std::max(highest, fb);
    a = b;
    fa = fb;
    step *= kStepGrowth;
  }
  return Failure{Reason::NotReached, "alpha stays under the limit on the tangent plane"};
}

Outcome<TangentWalk::Reach> TangentWalk::reachOnSurface(const Eigen::Vector3d& d, double limit, double scale) const {
  const Eigen::Vector3d& origin = brightest_.point.position;
  SurfacePoint at = brightest_.point;
  Outcome<double> alpha = alphaOnSurface(at);
  if (!alpha) return alpha.failure();
  double a = 0, fa = *alpha - limit, step = scale;
  bool below = fa < 0;
  double highest = below ? fa : -limit;
  std::optional<Failure> stopped;
  for (int i = 0; i < options_.maxSteps; ++i) {
    double b = a + step;
    Outcome<SurfacePoint> next = foot(origin + b * d, at);
    alpha = next ? alphaOnSurface(*next) : Outcome<double>(next.failure());
    // The border may lie between two steps while the limit is reached before it: approach by halving.
    for (int halving = 0; !alpha && halving < 12; ++halving) {
      stopped = alpha.failure();
      step *= 0.5;
      b = a + step;
      next = foot(origin + b * d, at);
      alpha = next ? alphaOnSurface(*next) : Outcome<double>(next.failure());
    }
    if (!alpha) return *stopped;
    const double fb = *alpha - limit;
    if (below && fb >= 0) {
      SurfacePoint best = *next;
      std::optional<Failure> lost;
      const double s = bracketedRoot(
          [&](double x) {
            const Outcome<SurfacePoint> p = foot(origin + x * d, best);
            const Outcome<double> here = p ? alphaOnSurface(*p) : Outcome<double>(p.failure());
            if (!here) {
              lost = here.failure();
              return std::nan("");
            }
            best = *p;
            return *here - limit;
          },
          a, fa, b, fb, options_.toleranceRad);
      if (lost) return *lost;
      return Reach{s, best};
    }
    if (fb < 0) below = true;
    if (below) {
      if (fb < highest - kFallFraction * limit && i > 0)
        return Failure{Reason::NotMonotonic, "alpha falls before it reaches the limit"};
      highest = std::max(highest, fb);
    }
    a = b;
    fa = fb;
    at = *next;
    if (stopped && step < 1e-6 * scale) return *stopped;  // the edge is found to a millionth of the walk
    if (!stopped) step *= kStepGrowth;
  }
  return stopped ? *stopped : Failure{Reason::NotReached, "alpha stays under the limit"};
}

double TangentWalk::sineAbove(const SurfacePoint& p, double sineLimit, double cosineLimit) const {
  const Eigen::Vector3d toEye = eye_ - p.position, v = toEye / toEye.norm(), l = light_.directionFrom(p.position);
  if (!(p.normal.dot(v) > 0) || !(p.normal.dot(l) > 0)) return std::nan("");
  const Eigen::Vector3d h = l + v;
  return (p.normal.cross(h).norm() * cosineLimit - p.normal.dot(h) * sineLimit) / h.norm();
}

std::optional<TangentWalk::Reach> TangentWalk::reachOnPatch(const Eigen::Vector3d& d, double limit, double expected) const {
  constexpr double kTrust = 0.25;  // as in reachNear
  constexpr int kMost = 6;
  const Eigen::Matrix3d& frame = patch_->worldFromPatch();
  const Eigen::Vector3d& k = patch_->curvatures();
  const double cx = frame.col(0).dot(d), cy = frame.col(1).dot(d), w = light_.homogeneous().w();
  const double bend = k.x() * cx * cx + k.y() * cy * cy;
  const double sine = std::sin(limit), cosine = std::cos(limit), scale = 1 / (2 * sine * cosine);
  Eigen::Vector3d p, normal;
  // sin(alpha - limit) sin(alpha + limit) / sin(2 limit): its slope at the limit is 1, and it is nearly linear in s^2. The foot
  // of s (cx, cy) is z = -s^2 bend / (1 + r), the gradient there (k1 x, k2 y, r), r = sqrt(1 - c s^2 bend). H = L + V needs no
  // unit vectors.
  const auto above = [&](double squared) {
    const double s = std::sqrt(squared), r = std::sqrt(1 - k.z() * squared * bend);
    p = {s * cx, s * cy, -squared * bend / (1 + r)};
    normal = side_ * Eigen::Vector3d(k.x() * p.x(), k.y() * p.y(), r);
    const Eigen::Vector3d toEye = eyeOnPatch_ - p, toLight = lightOnPatch_ - w * p;
    if (!(normal.dot(toEye) > 0 && normal.dot(toLight) > 0)) return std::nan("");
    const Eigen::Vector3d h = toEye.norm() * toLight + toLight.norm() * toEye;
    const double across = normal.cross(h).squaredNorm(), along = normal.dot(h), alongSquared = along * along;
    return (across * cosine * cosine - alongSquared * sine * sine) / (across + alongSquared) * scale;
  };
  // Over s^2; the oldest pair is P_B itself.
  const double expectedSquared = expected * expected;
  Pairs pairs{{0, above(0), 0}, {expectedSquared, 0, 0}};
  if (!(pairs.f[1] < 0)) return std::nullopt;
  for (int i = 0; i < kMost; ++i) {
    pairs.f[0] = above(pairs.x[0]);
    if (!(std::abs(pairs.f[0]) < kTrust * limit)) return std::nullopt;
    if (std::abs(pairs.f[0]) <= options_.toleranceRad) {
      if (i > 0 && pairs.falls()) return std::nullopt;
      SurfacePoint end;
      end.position = brightest_.point.position + frame * p;
      end.normal = frame * normal.normalized();
      return Reach{std::sqrt(pairs.x[0]), end};
    }
    const double next = pairs.next(i);
    if (!(std::abs(next - expectedSquared) < 2 * kTrust * expectedSquared)) return std::nullopt;
    pairs.add(next);
  }
  return std::nullopt;
}

Outcome<TangentWalk::Reach> TangentWalk::reachNear(const Eigen::Vector3d& d, double limit, double expected,
                                                   const SurfacePoint& neighbour, double scale) const {
  constexpr double kTrust = 0.25;  // of the limit and of the expected distance: beyond it another branch may be in between
  constexpr int kMost = 12;        // three or four are usual; kinks of a coarse mesh take some more
  if (patch_)
    if (std::optional<Reach> reach = reachOnPatch(d, limit, expected)) return *reach;
  const Eigen::Vector3d& origin = brightest_.point.position;
  const double sine = std::sin(limit), cosine = std::cos(limit);
  // Over s; the oldest pair is P_B itself.
  Pairs pairs{{0, sineAbove(brightest_.point, sine, cosine), 0}, {expected, 0, 0}};
  SurfacePoint at = neighbour;
  if (pairs.f[1] < 0)
    for (int i = 0; i < kMost; ++i) {
      Outcome<SurfacePoint> p = foot(origin + pairs.x[0] * d, at);
      if (!p) break;
      pairs.f[0] = sineAbove(*p, sine, cosine);
      if (!(std::abs(pairs.f[0]) < kTrust * limit)) break;
      if (std::abs(pairs.f[0]) <= options_.toleranceRad) {
        if (i > 0 && pairs.falls()) break;
        return Reach{pairs.x[0], std::move(*p)};
      }
      at = std::move(*p);
      const double next = pairs.next(i);
      if (!(std::abs(next - expected) < kTrust * expected)) break;
      pairs.add(next);
    }
  return reachOnSurface(d, limit, scale);
}

Outcome<TangentWalk::Reach> TangentWalk::reachContour(const Eigen::Vector3d& d, const Polyline& contour, double scale) const {
  const Eigen::Vector3d& origin = brightest_.point.position;
  std::optional<Pixel> from = camera_.project(origin);
  if (!from) return Failure{Reason::BehindCamera, ""};
  if (!contains(contour, *from)) return Failure{Reason::NotReached, "the brightest point lies outside the contour"};
  SurfacePoint at = brightest_.point;
  double a = 0, step = scale;
  for (int i = 0; i < options_.maxSteps; ++i) {
    double b = a + step;
    Outcome<SurfacePoint> next = foot(origin + b * d, at);
    for (int halving = 0; !next && halving < 12; ++halving) {
      step *= 0.5;
      b = a + step;
      next = foot(origin + b * d, at);
    }
    if (!next) return next.failure();
    const std::optional<Pixel> to = camera_.project(next->position);
    if (!to) return Failure{Reason::BehindCamera, ""};
    if (const std::optional<std::size_t> edge = firstEdgeCrossed(contour.points, *from, *to))
      return reachOnEdge(d, contour, *edge, {a, b, *from, *to, *next});
    a = b;
    at = *next;
    from = to;
    step *= kStepGrowth;
  }
  return Failure{Reason::NotReached, "the walk did not meet the contour"};
}

Outcome<TangentWalk::Reach> TangentWalk::reachOnEdge(const Eigen::Vector3d& d, const Polyline& contour, std::size_t edge,
                                                     const Step& step) const {
  const std::vector<Pixel>& points = contour.points;
  const std::size_t n = points.size();
  // The end of the walk is known to the round-off of pixel coordinates, whatever the size of the highlight.
  double largest = 1;
  for (const Pixel& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const double roundOffPx = 4 * std::numeric_limits<double>::epsilon() * largest;
  SurfacePoint hit = step.end;
  double s = step.b;
  for (int move = 0; move < 4; ++move) {
    const Pixel p = points[edge], q = points[(edge + 1) % n];
    const Pixel normal(q.y() - p.y(), p.x() - q.x());
    const double size = normal.norm();
    if (!(size > 0)) return Failure{Reason::NotConverged, "repeated contour point"};
    const double sign = normal.dot(step.from - p) > 0 ? -1.0 : 1.0;
    std::optional<Failure> lost;
    Pixel pixel = step.to;
    const auto f = [&](double x) {
      const Outcome<SurfacePoint> foot_ = foot(brightest_.point.position + x * d, hit);
      const std::optional<Pixel> here = foot_ ? camera_.project(foot_->position) : std::nullopt;
      if (!here) {
        lost = foot_ ? Failure{Reason::BehindCamera, ""} : foot_.failure();
        return std::nan("");
      }
      hit = *foot_;
      pixel = *here;
      return sign * normal.dot(pixel - p) / size;
    };
    const double fa = f(step.a), fb = f(step.b);
    if (lost) return *lost;
    if (!(fa <= 0 && fb >= 0)) break;  // the line is not crossed within the step: keep the last solution
    s = bracketedRoot(f, step.a, fa, step.b, fb, roundOffPx);
    if (lost) return *lost;
    const double u = (pixel - p).dot(q - p) / (q - p).squaredNorm();
    if (!(u < 0 || u > 1)) break;
    edge = (edge + (u < 0 ? n - 1 : 1)) % n;
  }
  return Reach{s, hit};
}
double TangentWalk::metresPerPixel() const {
  const double f = std::max(camera_.pixelFromRay(0, 0), camera_.pixelFromRay(1, 1));
  return std::abs(camera_.depth(brightest_.point.position)) / f;
}

Eigen::Matrix3d TangentWalk::pixelFromPlane() const {
  Eigen::Matrix<double, 3, 3> world;
  const Eigen::Matrix3d& r = camera_.camFromWorld.linear();
  world.leftCols<2>() = r * basis_;
  world.col(2) = camera_.camFromWorld * brightest_.point.position;
  return camera_.pixelFromRay * world;
}

namespace {

void fitPixels(CanonicalContour& c) {
  if (c.pixels.size() < 5) return;
  if (const Outcome<Ellipse> e = fitEllipse(c.pixels)) c.ellipse = *e;
}

}  // namespace

CanonicalContour canonicalContour(const TangentWalk& walk, const Camera& camera, const Polyline& contour, int n) {
  require(n >= 1, "canonicalContour: needs directions");
  CanonicalContour result;
  result.directions.resize(n);
  const Pixel peak = walk.brightest().pixel;
  double radius = 0;
  for (const Pixel& p : contour.points) radius += (p - peak).norm();
  radius /= std::max<std::size_t>(1, contour.points.size());
  double scale = 0.25 * radius * walk.metresPerPixel();
  for (int i = 0; i < n; ++i) {
    DirectionResult& r = result.directions[i];
    r.azimuth = 2 * std::numbers::pi * i / n;
    const Eigen::Vector3d v = walk.direction(r.azimuth);
    const Outcome<TangentWalk::Reach> reach = walk.reachContour(v, contour, scale);
    if (!reach) {
      r.failure = reach.failure();
      continue;
    }
    const Outcome<double> alpha = walk.alphaOnSurface(reach->point);
    if (!alpha) {
      r.failure = alpha.failure();
      continue;
    }
    r.onSurface = reach->point.position;
    const Outcome<double> distance = walk.reachOnPlane(v, *alpha, 0.25 * reach->distance);
    if (!distance) {
      r.failure = distance.failure();
      continue;
    }
    r.onTangentPlane = walk.brightest().point.position + *distance * v;
    const std::optional<Pixel> pixel = camera.project(r.onTangentPlane);
    if (!pixel) {
      r.failure = Failure{Reason::BehindCamera, "the canonical point"};
      continue;
    }
    r.limitAngle = *alpha;
    result.pixels.push_back(*pixel);
  }
  fitPixels(result);
  return result;
}

void keepVisible(CanonicalContour& c, const std::vector<SurfacePoint>& ends, const Surface& surface, const Camera& camera) {
  std::vector<SurfacePoint> reached;
  for (std::size_t i = 0; i < ends.size(); ++i)
    if (!c.directions[i].failure) reached.push_back(ends[i]);
  const std::vector<char> hidden = occludedMany(surface, reached, camera.centreInWorld());
  for (std::size_t i = 0, k = 0; i < ends.size(); ++i) {
    DirectionResult& r = c.directions[i];
    if (r.failure) continue;
    const std::optional<Pixel> pixel = camera.project(ends[i].position);
    if (hidden[k++])
      r.failure = Failure{Reason::Occluded, "another part of the surface is in front"};
    else if (!pixel)
      r.failure = Failure{Reason::BehindCamera, ""};
    if (r.failure) {
      r.limitAngle.reset();
      continue;
    }
    r.onSurface = ends[i].position;
    c.pixels.push_back(*pixel);
  }
}

CanonicalContour predictFromEllipse(const TangentWalk& walk, const Surface& surface, const Camera& camera, const Ellipse& ellipse,
                                    int n) {
  require(n >= 1, "predictFromEllipse: needs directions");
  CanonicalContour result;
  result.directions.resize(n);
  // The ellipse in plane coordinates: x^T H^T C H x = 0; along (a, b) = s (cos, sin) a quadratic in s.
  const Eigen::Matrix3d h = walk.pixelFromPlane();
  const Eigen::Matrix3d c = h.transpose() * ellipse.conic().matrix * h;
  const Eigen::Vector3d origin = walk.brightest().point.position;
  ReachGuess guess;  // reach on S over reach on T
  SurfacePoint neighbour;
  std::vector<SurfacePoint> ends(n);
  for (int i = 0; i < n; ++i) {
    DirectionResult& r = result.directions[i];
    r.azimuth = 2 * std::numbers::pi * i / n;
    const Eigen::Vector3d x(std::cos(r.azimuth), std::sin(r.azimuth), 0);
    const double qa = x.dot(c * x), qb = c.row(2).dot(x), qc = c(2, 2);
    const double discriminant = qb * qb - qa * qc;
    double s = -1;
    if (discriminant >= 0) {
      const double root = std::sqrt(discriminant), q = -(qb + std::copysign(root, qb));
      const double s1 = qa != 0 ? q / qa : -1, s2 = q != 0 ? qc / q : -1;
      // Inside (qc < 0) the nearest positive root is the exit: there is a second one where the outline crosses the horizon of T.
      // Outside, the farther of two positive ones closes the ellipse.
      const double low = std::min(s1, s2), high = std::max(s1, s2);
      s = qc < 0 && low > 0 ? low : high;
    }
    if (!(s > 0) || !std::isfinite(s)) {
      r.failure = Failure{Reason::NotReached, "the direction misses the ellipsoid's outline"};
      continue;
    }
    const Eigen::Vector3d v = walk.direction(x.x(), x.y());
    r.onTangentPlane = origin + s * v;
    const double limit = walk.alphaOnPlane(r.onTangentPlane);
    if (!std::isfinite(limit)) {
      r.failure = Failure{Reason::LightBehindSurface, "at the outline on the tangent plane"};
      continue;
    }
    const double ratio = guess.next();
    const bool follow = guess.known() && ratio > 0.02 && ratio < 50;
    const Outcome<TangentWalk::Reach> reach = follow ? walk.reachNear(v, limit, ratio * s, neighbour, 0.45 * ratio * s)
                                                     : walk.reachOnSurface(v, limit, 0.45 * std::clamp(ratio, 0.02, 50.0) * s);
    if (!reach) {
      r.failure = reach.failure();
      guess.interrupt();
      continue;
    }
    guess.add(reach->distance / s);
    neighbour = reach->point;
    r.limitAngle = limit;
    ends[i] = reach->point;
  }
  keepVisible(result, ends, surface, camera);
  fitPixels(result);
  return result;
}

}  // namespace glint
