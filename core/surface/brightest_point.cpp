// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/brightest_point.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/number_text.h"
#include "core/geometry/camera.h"
#include "core/geometry/plane.h"
#include "core/surface/mirror_places.h"
#include "core/surface/occlusion.h"
#include "core/surface/surface.h"

namespace glint {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

using Basis = Eigen::Matrix<double, 3, 2>;

/// Below this angle the reflection law holds: two decades above round-off for well-placed cameras, far below any pixel.
constexpr double kZeroAngle = 1e-8;
/// Far from the origin the coordinates themselves are rounded; beyond this angle (a hundredth of a pixel of a long lens) no point
/// can be told.
constexpr double kMostRoundOff = 1e-4;
constexpr double kLeastMarginPx = 1e-3;  // round-off of a projection is far below it
/// Cells of the seed grid along one side: 16 px apart over 7,200 px.
constexpr double kMostCells = 450;
/// More seeds than this mean a surface rougher than the grid; the best ones are polished.
constexpr std::size_t kMaxSeeds = 64;

/// Directions and distances at one surface point (its normal on the camera's side).
struct Shading {
  Vector3d v, l, h;           ///< unit
  double inverseV, inverseL;  ///< 1/distance; 0 for a light at infinity
  double sum;                 ///< |L + V|
  double sine;                ///< |N x H|, the merit that the search lowers
  double cosine;              ///< N.H
  double alpha() const { return std::atan2(sine, cosine); }
  /// Merit that keeps falling over the whole range 0..pi, where the sine alone would turn back at pi/2.
  double merit() const { return cosine > 0 ? sine : 2 - sine; }
};

/// m between neighbouring numbers at these coordinates.
double spacing(const Vector3d& at) { return std::numeric_limits<double>::epsilon() * at.cwiseAbs().maxCoeff(); }

struct Sighting {
  const Surface& surface;
  const Camera& camera;
  const Light& light;
  Vector3d eye;

  Shading shade(const SurfacePoint& p) const {
    Shading s;
    const Vector3d toEye = eye - p.position;
    s.inverseV = 1 / toEye.norm();
    s.v = toEye * s.inverseV;
    const Eigen::Vector4d& lw = light.homogeneous();
    const Vector3d toLight = lw.head<3>() - lw.w() * p.position;
    const double length = toLight.norm();
    s.l = toLight / length;
    s.inverseL = lw.w() / length;
    const Vector3d sum = s.l + s.v;
    s.sum = sum.norm();
    s.h = sum / s.sum;
    s.sine = p.normal.cross(s.h).norm();
    s.cosine = p.normal.dot(s.h);
    return s;
  }
  /// The angle that rounded coordinates make of 0 here: they turn both directions and, on a curved surface, the normal.
  double roundOff(const SurfacePoint& p) const {
    constexpr double kSteps = 4;  // roundings on the way
    const Shading s = shade(p);
    const Outcome<Curvature> c = surface.curvatureAt(p);
    const double turn = c ? std::max(std::abs(c->k1), std::abs(c->k2)) : 0;
    const Eigen::Vector4d& lw = light.homogeneous();
    const double lamp = lw.w() != 0 ? spacing(lw.head<3>() / lw.w()) : 0;
    return kSteps * (spacing(p.position) * (s.inverseV + s.inverseL + turn) + spacing(eye) * s.inverseV + lamp * s.inverseL);
  }
  /// Foot of p + T step along the normal at p, on the camera's side.
  Outcome<SurfacePoint> moved(const SurfacePoint& p, const Vector3d& offset) const {
    Outcome<SurfacePoint> next = surface.foot(p.position + offset, p.normal, p);
    if (next) *next = facing(*next, eye);
    return next;
  }
};

/// Where a search stopped.
struct Search {
  SurfacePoint point;
  double alpha = std::numeric_limits<double>::infinity();
  bool touchedEdge = false;  ///< a step left the surface
  std::optional<Matrix2d> jacobian;
  Basis basis;
};

/// d(T^T H)/d(step) with T fixed: T^T dH T - (N.H) S, dH = (I - H H^T)(dL + dV)/|L + V|, dV = -(I - V V^T)/r, S the shape
/// operator.
Matrix2d jacobianAt(const Shading& s, const SurfacePoint& p, const Basis& t, const Curvature& c) {
  const Matrix3d id = Matrix3d::Identity();
  const Matrix3d dSum = -s.inverseV * (id - s.v * s.v.transpose()) - s.inverseL * (id - s.l * s.l.transpose());
  const Matrix3d dH = (id - s.h * s.h.transpose()) * dSum / s.sum;
  const Vector2d d1 = t.transpose() * c.direction1, d2 = t.transpose() * c.direction2;
  const Matrix2d shape = c.k1 * d1 * d1.transpose() + c.k2 * d2 * d2.transpose();
  return t.transpose() * dH * t - p.normal.dot(s.h) * shape;
}

/// Newton's method on the tangent plane of the current point, damped on |N x H|.
Search newton(const Sighting& sighting, const SurfacePoint& start, int maxIterations) {
  Search search;
  search.point = facing(start, sighting.eye);
  Shading s = sighting.shade(search.point);
  search.alpha = s.alpha();
  if (!std::isfinite(search.alpha)) return search;
  double lastStep = std::numeric_limits<double>::infinity();
  for (int i = 0; i < maxIterations; ++i) {
    const Outcome<Curvature> curvature = sighting.surface.curvatureAt(search.point);
    if (!curvature) return search;
    const Basis t = tangentBasis(search.point.normal);
    const Matrix2d j = jacobianAt(s, search.point, t, *curvature);
    search.jacobian = j;
    search.basis = t;
    const Vector2d g = t.transpose() * s.h;
    const double determinant = j.determinant();
    Vector2d step;
    if (std::abs(determinant) > 1e-12 * j.squaredNorm()) {  // else a direction is free to round-off: damped below
      step = -(Matrix2d() << j(1, 1), -j(0, 1), -j(1, 0), j(0, 0)).finished() * g / determinant;
    } else {
      // Nearly singular (a fold): damped by a part in 1e9 of the larger singular value, on the singular values themselves.
      const Eigen::JacobiSVD<Matrix2d> svd(j, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const Vector2d s2 = svd.singularValues();
      const double damping = 1e-9 * s2.squaredNorm();  // squared: directions below 3e-5 of the largest stay where they are
      if (!(damping > 0)) break;
      step =
          -(svd.matrixV() * (s2.array() / (s2.array().square() + damping)).matrix().asDiagonal() * svd.matrixU().transpose() * g);
    }
    // No step turns the normal by more than half a radian or crosses half of the way to the eye or the light.
    const double turn = std::max(std::abs(curvature->k1), std::abs(curvature->k2));
    const double longest = 0.5 / std::max({turn, s.inverseV, s.inverseL});
    const double length = step.norm();
    if (!std::isfinite(length)) break;
    if (length > longest) step *= longest / length;

    const bool close = s.merit() < 1e-6;  // squared sine of a milliradian: Newton converges quadratically from here
    bool accepted = false;
    double scale = 1;
    for (int halving = 0; halving < (close ? 3 : 24); ++halving, scale *= 0.5) {
      const Outcome<SurfacePoint> next = sighting.moved(search.point, t * (scale * step));
      if (!next) {
        search.touchedEdge = true;
        continue;
      }
      const Shading shading = sighting.shade(*next);
      if (!(shading.merit() < s.merit())) continue;
      search.point = *next;
      s = shading;
      search.alpha = s.alpha();
      accepted = true;
      break;
    }
    if (!accepted) break;
    const double taken = scale * std::min(length, longest);
    // Converged: the step is round-off of the distance to the eye, or it no longer shrinks near the solution.
    if (taken * s.inverseV < 1e-16 || s.merit() == 0 || (close && taken > 0.5 * lastStep && s.merit() < 1e-13)) break;
    lastStep = taken;
  }
  return search;
}

/// Compass search on |N x H| for surfaces without curvature (facets) and where Newton's method stalls at a kink.
Search compass(const Sighting& sighting, const SurfacePoint& start, double firstStep) {
  Search search;
  search.point = facing(start, sighting.eye);
  Shading s = sighting.shade(search.point);
  search.alpha = s.alpha();
  if (!std::isfinite(search.alpha)) return search;
  double step = firstStep;
  const double smallest = 1e-12 / s.inverseV;  // of the distance to the eye: far below a pixel, above round-off
  for (int evaluations = 0; step > smallest && evaluations < 1500;) {
    const Basis t = tangentBasis(search.point.normal);
    bool improved = false;
    for (int k = 0; k < 8; ++k, ++evaluations) {
      const double a = k * std::numbers::pi / 4;
      const Outcome<SurfacePoint> next = sighting.moved(search.point, step * (t * Vector2d(std::cos(a), std::sin(a))));
      if (!next) {
        search.touchedEdge = true;
        continue;
      }
      const Shading shading = sighting.shade(*next);
      if (!(shading.merit() < s.merit())) continue;
      search.point = *next;
      s = shading;
      improved = true;
      break;
    }
    if (!improved) step *= 0.5;
  }
  search.alpha = s.alpha();
  return search;
}

/// Where the plane of a facet mirrors the light to the eye: on the line from the eye to the light's image,
/// (h_L E + h_E (l - 2 h_L n)) / (h_L + w h_E), h = heights over the plane. Nothing with the light behind it.
std::optional<Vector3d> mirrorPointOfPlane(const Sighting& sighting, const SurfacePoint& p) {
  const Eigen::Vector4d& light = sighting.light.homogeneous();
  // Relative to the point, so that a scene far from the origin keeps its digits.
  const Vector3d eye = sighting.eye - p.position, l = light.head<3>() - light.w() * p.position;
  const double eyeHeight = p.normal.dot(eye), lightHeight = p.normal.dot(l);
  if (!(eyeHeight > 0 && lightHeight > 0)) return std::nullopt;
  const Vector3d at = (lightHeight * eye + eyeHeight * (l - 2 * lightHeight * p.normal)) / (lightHeight + light.w() * eyeHeight);
  return at.allFinite() ? std::optional<Vector3d>(at) : std::nullopt;
}

/// Facets: goes from facet to facet, each time to the mirror point of the present facet's plane, until that point lies inside its
/// own facet. Grazing views make a valley of the merit that is far too narrow for a search without derivatives; a plane has its
/// answer in closed form.
void hopOverFacets(const Sighting& sighting, Search& search) {
  constexpr int kMostHops = 20;
  SurfacePoint p = search.point;
  for (int i = 0; i < kMostHops; ++i) {
    const std::optional<Vector3d> offset = mirrorPointOfPlane(sighting, p);
    if (!offset) return;
    const Outcome<SurfacePoint> next = sighting.moved(p, *offset);
    if (!next) return;
    const bool arrived = next->element == p.element;
    p = *next;
    const double alpha = sighting.shade(p).alpha();
    if (alpha < search.alpha) {
      search.point = p;
      search.alpha = alpha;
    }
    if (arrived) return;
  }
}

/// Largest angle between the normal here and those just beside: the dihedral angle at an edge, the largest one at a corner.
double normalJump(const Sighting& sighting, const SurfacePoint& p, double reach) {
  const Basis t = tangentBasis(p.normal);
  double largest = 0;
  for (int k = 0; k < 8; ++k) {
    const double a = k * std::numbers::pi / 4;
    if (const Outcome<SurfacePoint> beside = sighting.moved(p, reach * (t * Vector2d(std::cos(a), std::sin(a)))))
      largest = std::max(largest, std::atan2(p.normal.cross(beside->normal).norm(), p.normal.dot(beside->normal)));
  }
  return largest;
}

struct Seed {
  SurfacePoint point;
  double alpha;
  std::optional<Pixel> zero;  ///< where the linear interpolation vanishes
};

/// The part of the image and its margin that the surface can be seen in.
struct Window {
  Pixel min, max;
  bool empty() const { return !((max - min).minCoeff() > 0); }
};

/// @param window  the image with its margin
Window windowOf(const Surface& surface, const Camera& camera, Window window) {
  const Eigen::AlignedBox3d box = surface.bounds();
  if (!box.sizes().allFinite()) return window;
  Eigen::AlignedBox2d seen;
  for (int c = 0; c < 8; ++c) {
    const std::optional<Pixel> p = camera.project(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)));
    if (!p) return window;  // the box reaches behind the camera: its outline is unbounded
    seen.extend(*p);
  }
  // Round-off and a curved edge's bulge stay inside; a surface seen edge on, thinner than a pixel, still fills its window.
  const Vector2d margin = (0.05 * seen.sizes()).cwiseMin(Vector2d::Ones()).cwiseMax(kLeastMarginPx * Vector2d::Ones());
  window.min = window.min.cwiseMax(seen.min() - margin);
  window.max = window.max.cwiseMin(seen.max() + margin);
  return window;
}

/// The zero of a linear interpolation of g over a triangle: barycentric weights, accepted a little outside as well.
std::optional<Vector3d> linearZero(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  constexpr double kSlack = 0.35;  // the field is not linear over a cell; Newton decides
  Matrix2d m;
  m << b - a, c - a;
  const double determinant = m.determinant();
  if (!(std::abs(determinant) > 1e-14 * m.squaredNorm())) return std::nullopt;  // round-off of the two differences
  const Vector2d uv = m.partialPivLu().solve(-a);
  const Vector3d w(1 - uv.sum(), uv.x(), uv.y());
  if (!(w.minCoeff() > -kSlack)) return std::nullopt;
  return w;
}

/// The tangential part of H over a grid of rays, in the camera's x and y axes: continuous, zero only where H is along N.
class SeedGrid {
 public:
  SeedGrid(const Sighting& sighting, const Window& window, double step) : min_(window.min) {
    // Fine across a surface that is seen edge on, but not as fine along it.
    const auto nodesAlong = [&](double length) { return 1 + static_cast<int>(std::min(std::ceil(length / step), kMostCells)); };
    nx_ = nodesAlong(window.max.x() - window.min.x()), ny_ = nodesAlong(window.max.y() - window.min.y());
    cell_ = {(window.max.x() - window.min.x()) / (nx_ - 1), (window.max.y() - window.min.y()) / (ny_ - 1)};
    const Matrix3d worldFromPixel = sighting.camera.camFromWorld.linear().transpose() *
                                    sighting.camera.pixelFromRay.triangularView<Eigen::Upper>().solve(Matrix3d::Identity());
    std::vector<Ray> rays;
    for (int n = 0; n < nx_ * ny_; ++n) rays.push_back({sighting.eye, (worldFromPixel * pixelOf(n).homogeneous()).normalized()});
    found_ = sighting.surface.approximateHits(rays);
    nodes_.resize(rays.size());
    const Vector3d axisX = sighting.camera.camFromWorld.linear().row(0), axisY = sighting.camera.camFromWorld.linear().row(1);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (!found_[n]) continue;
      const SurfacePoint p = facing(*found_[n], sighting.eye);
      const Shading s = sighting.shade(p);
      const double alpha = s.alpha();
      if (!std::isfinite(alpha)) continue;
      const Vector3d tangential = s.h - s.cosine * p.normal;
      nodes_[n] = {{tangential.dot(axisX), tangential.dot(axisY)}, alpha};
    }
  }

  bool hits() const {
    return std::any_of(found_.begin(), found_.end(), [](const auto& p) { return p.has_value(); });
  }

  /// Nodes next to a zero of the part's linear interpolation, and those lower than their neighbours; the lowest first.
  std::vector<Seed> seeds() const {
    std::vector<Seed> seeds;
    std::vector<char> taken(nodes_.size(), 0);
    addZeros(seeds, taken);
    for (int n = 0; n < nx_ * ny_; ++n)
      if (!taken[n] && isLowest(n % nx_, n / nx_)) seeds.push_back({*found_[n], nodes_[n].alpha, std::nullopt});
    std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.alpha < b.alpha; });
    if (seeds.size() > kMaxSeeds) seeds.resize(kMaxSeeds);
    return seeds;
  }

 private:
  struct Node {
    Vector2d g;
    double alpha = std::numeric_limits<double>::infinity();
  };
  Pixel pixelOf(int n) const { return {min_.x() + (n % nx_) * cell_.x(), min_.y() + (n / nx_) * cell_.y()}; }

  void addZeros(std::vector<Seed>& seeds, std::vector<char>& taken) const {
    for (int j = 0; j + 1 < ny_; ++j)
      for (int i = 0; i + 1 < nx_; ++i) {
        const int n = j * nx_ + i;
        for (const auto& corner : {std::array<int, 3>{n, n + 1, n + nx_ + 1}, std::array<int, 3>{n, n + nx_ + 1, n + nx_}}) {
          const Node &a = nodes_[corner[0]], &b = nodes_[corner[1]], &c = nodes_[corner[2]];
          if (!std::isfinite(a.alpha + b.alpha + c.alpha)) continue;
          const std::optional<Vector3d> w = linearZero(a.g, b.g, c.g);
          if (!w) continue;
          Pixel zero(0, 0);
          for (int k = 0; k < 3; ++k) zero += (*w)[k] * pixelOf(corner[k]);
          Eigen::Index best = 0;
          w->maxCoeff(&best);
          taken[corner[best]] = 1;
          seeds.push_back({*found_[corner[best]], nodes_[corner[best]].alpha, zero});
        }
      }
  }

  bool isLowest(int i, int j) const {
    const double here = nodes_[j * nx_ + i].alpha;
    if (!std::isfinite(here)) return false;
    for (int y = std::max(0, j - 1); y <= std::min(ny_ - 1, j + 1); ++y)
      for (int x = std::max(0, i - 1); x <= std::min(nx_ - 1, i + 1); ++x)
        if (nodes_[y * nx_ + x].alpha < here) return false;
    return true;
  }

  Pixel min_, cell_;
  int nx_, ny_;
  std::vector<std::optional<SurfacePoint>> found_;
  std::vector<Node> nodes_;
};
/// Why candidates were turned down, for the detail of the failure.
struct Rejected {
  int notVisible = 0, notLit = 0, outside = 0, edge = 0;
  double rounded = 0;  ///< m, of coordinates that hide the law
  std::string text() const {
    if (notVisible)
      return "not visible: the mirror point faces away from the camera or another part of the surface is in front of it";
    if (notLit) return "not lit: the light is behind the surface or hidden by it at the mirror point";
    if (outside) return "outside the image and its margin";
    if (edge) return "off the surface: the mirror point lies beyond its edge";
    if (rounded > 0)
      return formatted(
          "no stationary point can be told: this far from the origin coordinates are %.2g m apart; move the origin to "
          "the object",
          rounded);
    return "no stationary point: the reflection law holds nowhere on the visible surface";
  }
};

/// All searches of one call, and what they found.
class Finder {
 public:
  Finder(const Sighting& sighting, const BrightestPointOptions& options, const Window& image, double cellPx)
      : sighting_(sighting), options_(options), image_(image), cellPx_(cellPx) {}

  void polish(const SurfacePoint& seed) {
    const Outcome<Curvature> curvature = sighting_.surface.curvatureAt(seed);
    if (!curvature && curvature.failure().reason == Reason::NotSupported) return polishFacets(seed);
    Search search = newton(sighting_, seed, options_.maxIterations);
    if (!holds(search) && search.alpha < 0.1 && seed.element >= 0 && !search.touchedEdge) {
      // A kink of a piecewise smooth normal field stopped Newton's method: go on without derivatives, then polish again.
      search = compass(sighting_, search.point, footprint(search.point) * 0.5);
      search = newton(sighting_, search.point, options_.maxIterations);
    }
    if (!holds(search)) {
      if (search.touchedEdge) ++rejected_.edge;
      if (search.alpha <= sighting_.roundOff(search.point)) rejected_.rounded = spacing(search.point.position);
      return;
    }
    solved_.push_back(search);
    if (!accept(search)) return;
    if (search.jacobian) lookForTwin(search);
  }

  /// Searches from the best place on, without places that an earlier solution explains: they would lead to it again.
  void polishPlaces(std::vector<SurfacePoint> places) {
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = facing(places[i], sighting_.eye);
      const double merit = sighting_.shade(places[i]).merit();
      if (std::isfinite(merit)) order.emplace_back(merit, i);
    }
    std::sort(order.begin(), order.end());
    std::size_t polished = 0;
    for (const auto& [merit, i] : order) {
      if (explained(places[i])) continue;
      if (++polished > kMaxSeeds) break;
      polish(places[i]);
    }
  }

  bool found() const { return !found_.empty(); }

  bool alreadyFoundNear(const Pixel& p, double px) const {
    return std::any_of(found_.begin(), found_.end(), [&](const BrightestPoint& b) { return (b.pixel - p).norm() < px; });
  }

  Outcome<std::vector<BrightestPoint>> result(bool anyHit) && {
    if (found_.empty())
      return Failure{
          Reason::NoBrightestPoint,
          anyHit ? rejected_.text() : "off the surface: no ray of the search meets it; it is out of view or seen edge-on"};
    const Pixel centre(0.5 * (sighting_.camera.width - 1), 0.5 * (sighting_.camera.height - 1));
    std::sort(found_.begin(), found_.end(), [&](const BrightestPoint& a, const BrightestPoint& b) {
      // Angles below kZeroAngle are round-off and must not decide the order.
      const double x = a.alpha <= kZeroAngle ? 0 : a.alpha, y = b.alpha <= kZeroAngle ? 0 : b.alpha;
      if (x != y) return x < y;
      return (a.pixel - centre).squaredNorm() < (b.pixel - centre).squaredNorm();
    });
    return std::move(found_);
  }

 private:
  /// Whether the reflection law holds there, as well as the coordinates can say.
  bool holds(const Search& search) const {
    return search.alpha <= kZeroAngle || (search.alpha <= kMostRoundOff && search.alpha <= sighting_.roundOff(search.point));
  }

  /// Whether the tangential part of H here is what the Jacobian at a solution says, to half of its length: a second solution
  /// close to this point would need it to point elsewhere. Hidden solutions count as well.
  bool explained(const SurfacePoint& p) const {
    const Shading s = sighting_.shade(p);
    const Vector3d tangential = s.h - s.cosine * p.normal;
    return std::any_of(solved_.begin(), solved_.end(), [&](const Search& z) {
      if (!z.jacobian || !(z.point.normal.dot(p.normal) > 0)) return false;
      const Vector2d here = z.basis.transpose() * tangential,
                     linear = *z.jacobian * (z.basis.transpose() * (p.position - z.point.position));
      return (here - linear).squaredNorm() <= 0.25 * here.squaredNorm();
    });
  }

  /// Length on the tangent plane that one grid cell covers, without foreshortening.
  double footprint(const SurfacePoint& p) const {
    return cellPx_ * (sighting_.eye - p.position).norm() /
           std::max(sighting_.camera.pixelFromRay(0, 0), sighting_.camera.pixelFromRay(1, 1));
  }

  void polishFacets(const SurfacePoint& seed) {
    Search search = compass(sighting_, seed, 0.5 * footprint(seed));
    hopOverFacets(sighting_, search);
    if (!holds(search)) {
      // A ten-millionth of the distance is below a pixel and above round-off.
      const double jump = normalJump(sighting_, search.point, 1e-7 * (sighting_.eye - search.point.position).norm());
      if (!(search.alpha <= jump)) {
        if (search.touchedEdge) ++rejected_.edge;
        return;
      }
    }
    accept(search);
  }

  /// Near a fold two solutions lie close together, along the weak direction of the Jacobian: look on both sides.
  void lookForTwin(const Search& search) {
    const Eigen::JacobiSVD<Matrix2d> svd(*search.jacobian, Eigen::ComputeFullV);
    if (!(svd.singularValues()(1) < 0.2 * svd.singularValues()(0))) return;
    const Vector2d direction = svd.matrixV().col(1);
    for (const double reach : {-1.0, -0.25, 0.25, 1.0}) {
      const Outcome<SurfacePoint> start =
          sighting_.moved(search.point, search.basis * (reach * footprint(search.point) * direction));
      if (!start) continue;
      const Search twin = newton(sighting_, *start, options_.maxIterations);
      if (holds(twin)) accept(twin);
    }
  }

  bool accept(const Search& search) {
    const SurfacePoint& p = search.point;
    const std::optional<Pixel> pixel = sighting_.camera.project(p.position);
    const double distance = (sighting_.eye - p.position).norm();
    for (const BrightestPoint& b : found_)
      // A ten-millionth of the distance is below a pixel: the same point was found twice.
      if ((b.point.position - p.position).norm() < 1e-7 * distance || (pixel && (b.pixel - *pixel).norm() < mergePx(search)))
        return false;
    if (!pixel || !(p.normal.dot(sighting_.eye - p.position) > 0) || sighting_.surface.occluded(p, sighting_.eye))
      return ++rejected_.notVisible, false;
    const Vector3d toLight = sighting_.light.directionFrom(p.position);
    if (!(p.normal.dot(toLight) > 0) ||
        sighting_.surface.occluded(p, occlusionTarget(sighting_.surface, p.position, sighting_.light, distance)))
      return ++rejected_.notLit, false;
    if ((image_.min - *pixel).maxCoeff() > 0 || (*pixel - image_.max).maxCoeff() > 0) return ++rejected_.outside, false;
    found_.push_back({p, *pixel, search.alpha});
    return true;
  }

  /// Local minima on the same or neighbouring facets are one highlight.
  double mergePx(const Search& search) const { return search.alpha > kZeroAngle ? 2.0 : 1e-4; }

  const Sighting& sighting_;
  const BrightestPointOptions& options_;
  Window image_;
  double cellPx_;
  std::vector<BrightestPoint> found_;
  std::vector<Search> solved_;  ///< also those that were turned down
  Rejected rejected_;
};

}  // namespace

Outcome<BrightestPoint> observedBrightestPoint(const Surface& surface, const Camera& camera, const Pixel& peak) {
  if (!peak.allFinite()) return Failure{Reason::NotFinite, "peak"};
  const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(peak));
  if (!hit) return Failure{Reason::PeakOffSurface, hit.failure().message()};
  if (const auto* parts = dynamic_cast<const FilledParts*>(&surface); parts && parts->filledAt(*hit))
    return Failure{Reason::PeakOffSurface, "the depth map has a hole there: its depth was filled in, not measured"};
  return BrightestPoint{facing(*hit, camera.centreInWorld()), peak, 0.0};
}

Outcome<std::vector<BrightestPoint>> predictedBrightestPoints(const Surface& surface, const Camera& camera, const Light& light,
                                                              const BrightestPointOptions& options) {
  require(options.seedStepPx > 0 && options.marginFraction >= 0 && options.maxIterations > 0,
          "predictedBrightestPoints: seedStepPx and maxIterations must be positive, marginFraction not negative");
  const Sighting sighting{surface, camera, light, camera.centreInWorld()};
  if (!sighting.eye.allFinite()) return Failure{Reason::NotFinite, "camera pose"};
  const Eigen::AlignedBox2d photograph = seenWindow(camera);
  const Vector2d size = photograph.sizes();
  const Window image{photograph.min() - options.marginFraction * size, photograph.max() + options.marginFraction * size};
  const Window window = windowOf(surface, camera, image);
  if (window.empty()) return Failure{Reason::NoBrightestPoint, "off the surface: it is outside the image and its margin"};
  // A surface that is small in the picture still gets a grid of about 8 cells across.
  const double step = std::clamp((window.max - window.min).minCoeff() / 8, 1e-3, options.seedStepPx);

  Finder finder(sighting, options, image, step);
  bool anyHit = false;
  for (const Vector3d& hint : options.hints) {
    if (!hint.allFinite() || hint == sighting.eye) continue;
    if (const Outcome<SurfacePoint> hit = surface.firstHit({sighting.eye, (hint - sighting.eye).normalized()})) {
      anyHit = true;
      finder.polish(*hit);
    }
  }
  if (!options.hintsOnly) {
    // A surface that can rule out most of itself is asked first. Where that finds nothing the grid decides, and says why.
    if (const auto* mirror = dynamic_cast<const MirrorPlaces*>(&surface))
      if (std::optional<std::vector<SurfacePoint>> places =
              mirror->mirrorPlaces({sighting.eye, light.homogeneous(), sidesOf(camera, image.min, image.max)})) {
        finder.polishPlaces(std::move(*places));
        if (finder.found()) return std::move(finder).result(true);
      }
    const SeedGrid grid(sighting, window, step);
    for (const Seed& seed : grid.seeds()) {
      // Another seed has led to where this one points: solutions closer than a third of a cell are the twin search's work.
      if (seed.zero && finder.alreadyFoundNear(*seed.zero, 0.34 * step)) continue;
      finder.polish(seed.point);
    }
    anyHit = anyHit || grid.hits();
  }
  return std::move(finder).result(anyHit);
}

}  // namespace glint
