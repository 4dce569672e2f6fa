// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/mesh.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/geometry/plane.h"
#include "core/surface/mesh_rays.h"
#include "core/surface/mesh_topology.h"
#include "core/surface/mirror_places.h"
#include "core/surface/occlusion.h"
#include "core/surface/surface.h"

namespace glint {

using Eigen::AlignedBox3d;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
/// Slack of barycentric weights: a line through an edge must lie inside one of its two triangles despite round-off.
constexpr double kInside = 1e-12;

/// Share of the mesh's size or of the way, whichever is shorter: what lies nearer to a point does not hide it
/// (Surface::occluded).
constexpr double kOcclusionStart = 1e-6;

/// A foot this many triangles away is found sooner by a ray. Measured on a mesh of 1 million triangles: a step over an edge costs
/// about 20 ns, a ray 400 ns and more.
constexpr int kFootTriangles = 32;
constexpr double kFarTriangles = 16;

/// A place on a triangle: weights of its second and third corner, and the line's parameter there.
struct Place {
  int triangle = -1;
  double u = 0, v = 0, t = 0;
};

class MeshSurface : public Surface, public ManyOcclusions, public MirrorPlaces, public BoundedParts, public FilledParts {
 public:
  MeshSurface(TriangleMesh mesh, MeshPolicy policy, bool manySearches, std::vector<char> filled)
      : policy_(policy.normals),
        single_(policy.rays == RayPrecision::Single && policy.normals != NormalPolicy::Curved),
        manySearches_(manySearches),
        mesh_(std::move(mesh)),
        filled_(std::move(filled)) {
    check();
    topology_ = topologyOf(mesh_);
    require(std::find(topology_.alive.begin(), topology_.alive.end(), 1) != topology_.alive.end(),
            "mesh: no triangle with an area");
    if (policy_ != NormalPolicy::Facet) mesh_.normals = vertexNormals(mesh_, topology_);
    build();
  }

  std::string describe() const override { return "mesh of " + std::to_string(mesh_.triangles.size()) + " triangles"; }

  Outcome<SurfacePoint> firstHit(const Ray& ray) const override {
    if (!ray.origin.allFinite() || !ray.direction.allFinite()) return Failure{Reason::NotFinite, "ray"};
    if (const std::optional<Place> place = firstPlace(ray.origin, ray.direction, 0, kInf)) return pointAt(*place);
    return Failure{Reason::NoHit, describe()};
  }

  std::vector<std::optional<SurfacePoint>> approximateHits(const std::vector<Ray>& rays) const override;

  Outcome<SurfacePoint> foot(const Vector3d& point, const Vector3d& direction, const SurfacePoint& previous) const override {
    if (!point.allFinite() || !direction.allFinite() || !previous.position.allFinite()) return Failure{Reason::NotFinite, "foot"};
    const Vector3d d = direction.normalized();
    const Vector3d o = point + (previous.position - point).dot(d) * d;  // the place of the line nearest to `previous`
    if (previous.element >= 0 && previous.element < static_cast<int>(mesh_.triangles.size()) && topology_.alive[previous.element])
      if (const std::optional<Place> place = walk(previous.element, o, d, kFootTriangles, kFarTriangles)) return pointAt(*place);
    std::optional<SurfacePoint> best;
    // Distances to `previous` grow with the distance from o, so that the second ray need not look farther than the first one's
    // hit. Convex surfaces lie behind their tangent plane: that side first.
    double farthest = kInf;
    for (const double sign : {-1.0, 1.0})
      if (const std::optional<Place> place = firstPlace(o, sign * d, -1e-9 * size_, farthest)) {  // o may lie on the mesh
        const SurfacePoint p = pointAt(*place);
        if (best && !((p.position - previous.position).squaredNorm() < (best->position - previous.position).squaredNorm()))
          continue;
        best = p;
        farthest = std::abs(place->t) * (1 + 1e-6) + 1e-9 * size_;  // the single precision of the ray tracer
      }
    if (!best) return Failure{Reason::SurfaceEnded, "the line misses the " + describe()};
    return *best;
  }

  Outcome<Curvature> curvatureAt(const SurfacePoint& p) const override;

  bool occluded(const SurfacePoint& from, const Vector3d& to) const override {
    if (!from.position.allFinite() || !to.allFinite()) return false;
    const Vector3d offset = to - from.position;
    const double length = offset.norm();
    if (!(length > 0)) return false;
    // The end itself hides nothing.
    return firstPlace(from.position, offset / length, kOcclusionStart * std::min(size_, length), length * (1 - 1e-9)).has_value();
  }
  std::vector<char> occludedMany(const std::vector<SurfacePoint>& from, const Vector3d& to) const override {
    return occlusions(from, to, 2, false);
  }
  bool anyOccluded(const std::vector<SurfacePoint>& from, const Vector3d& to) const override {
    const std::vector<char> found = occlusions(from, to, 1, true);
    return std::find(found.begin(), found.end(), 1) != found.end();
  }

  std::optional<std::vector<SurfacePoint>> mirrorPlaces(const MirrorQuery& query) const override;
  std::optional<std::vector<SurfacePart>> partsThatMay(const MirrorQuery& query, double lightReach, const PartTest& test,
                                                       std::size_t most) const override;

  bool filledAt(const SurfacePoint& p) const override {
    if (filled_.empty() || p.element < 0 || p.element >= static_cast<int>(mesh_.triangles.size())) return false;
    const Vector3i& t = mesh_.triangles[p.element];
    return filled_[t.x()] || filled_[t.y()] || filled_[t.z()];
  }

  AlignedBox3d bounds() const override { return bounds_; }

  TriangleMesh tessellate(const AlignedBox3d& region, int) const override {
    TriangleMesh out;
    out.vertices = mesh_.vertices;
    out.normals = mesh_.normals;
    const bool all = region.isEmpty() || !region.sizes().allFinite();
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      if (!topology_.alive[i]) continue;
      Vector3i t = mesh_.triangles[i];
      if (!all) {
        AlignedBox3d box;
        for (int k = 0; k < 3; ++k) box.extend(mesh_.vertices[t[k]]);
        if (!region.intersects(box)) continue;
      }
      if (topology_.turned[i]) std::swap(t.y(), t.z());
      out.triangles.push_back(t);
    }
    return out;
  }

 private:
  void check() const {
    require(mesh_.normals.empty() || mesh_.normals.size() == mesh_.vertices.size(), "mesh: as many normals as vertices, or none");
    require(filled_.empty() || filled_.size() == mesh_.vertices.size(), "mesh: as many marks as vertices, or none");
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i)
      if (!mesh_.vertices[i].allFinite()) require(false, "mesh: vertex " + std::to_string(i) + " is not finite");
    const int count = static_cast<int>(mesh_.vertices.size());
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      if (mesh_.triangles[i].minCoeff() < 0 || mesh_.triangles[i].maxCoeff() >= count)
        require(false, "mesh: triangle " + std::to_string(i) + " has a corner out of range");
  }

  void build() {
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      if (!topology_.alive[i]) continue;
      const Vector3i& t = mesh_.triangles[i];
      for (int k = 0; k < 3; ++k) {
        bounds_.extend(mesh_.vertices[t[k]]);
        // A quadratic patch lies in the hull of its control points.
        if (policy_ == NormalPolicy::Curved) bounds_.extend(edgePoint(t[k], t[(k + 1) % 3]));
      }
    }
    centre_ = bounds_.center();
    size_ = bounds_.sizes().norm();
    rays_.emplace(mesh_, topology_.alive, bounds_);
  }

  /// Middle control point of the edge curve: half-way, moved on to both tangent planes with weight 1/2.
  static Vector3d edgePoint(const Vector3d& p, const Vector3d& q, const Vector3d& m, const Vector3d& n) {
    return 0.5 * (p + q) - 0.25 * (m.dot(q - p) * m + n.dot(p - q) * n);
  }
  Vector3d edgePoint(int a, int b) const {
    return edgePoint(mesh_.vertices[a], mesh_.vertices[b], mesh_.normals[a], mesh_.normals[b]);
  }

  /// The quadratic patch of a triangle, from its first corner: differences of neighbouring vertices are exact however far the
  /// mesh is from the origin, so that Newton's method settles as closely there.
  struct Patch {
    Vector3d p0, p1, p2, m01, m12, m20;
    Vector3d at(double u, double v) const {
      const double w = 1 - u - v;
      return w * w * p0 + u * u * p1 + v * v * p2 + 2 * (w * u * m01 + u * v * m12 + v * w * m20);
    }
    Vector3d du(double u, double v) const {
      const double w = 1 - u - v;
      return 2 * (-w * p0 + u * p1 + (w - u) * m01 + v * m12 - v * m20);
    }
    Vector3d dv(double u, double v) const {
      const double w = 1 - u - v;
      return 2 * (-w * p0 + v * p2 - u * m01 + u * m12 + (w - v) * m20);
    }
  };
  Patch patchOf(int triangle) const {
    const Vector3i& t = mesh_.triangles[triangle];
    const Vector3d &a = mesh_.vertices[t.x()], b = mesh_.vertices[t.y()] - a, c = mesh_.vertices[t.z()] - a;
    const Vector3d &l = mesh_.normals[t.x()], &m = mesh_.normals[t.y()], &n = mesh_.normals[t.z()];
    const Vector3d zero = Vector3d::Zero();
    return {zero, b, c, edgePoint(zero, b, l, m), edgePoint(b, c, m, n), edgePoint(c, zero, n, l)};
  }

  /// Line against the plane of a triangle (Moeller and Trumbore), then against its patch by Newton's method. The place may lie
  /// outside the triangle. False when the line is parallel or Newton's method does not settle.
  bool solve(int triangle, const Vector3d& o, const Vector3d& d, Place& place) const {
    const Vector3i& c = mesh_.triangles[triangle];
    const Vector3d& a = mesh_.vertices[c.x()];
    const Vector3d e1 = mesh_.vertices[c.y()] - a, e2 = mesh_.vertices[c.z()] - a, p = d.cross(e2);
    const double determinant = e1.dot(p);
    if (determinant == 0) return false;
    const double inverse = 1 / determinant;
    const Vector3d s = o - a, q = s.cross(e1);
    place = {triangle, s.dot(p) * inverse, d.dot(q) * inverse, e2.dot(q) * inverse};
    if (!std::isfinite(place.u + place.v + place.t)) return false;
    if (policy_ != NormalPolicy::Curved) return true;
    // Far outside, the patch is no approximation of the surface: the flat answer shows the way to the neighbour.
    if (place.u < -0.5 || place.v < -0.5 || place.u + place.v > 1.5) return true;
    const Patch patch = patchOf(triangle);
    double last = kInf;
    for (int i = 0; i < 20; ++i) {
      Matrix3d j;
      j << patch.du(place.u, place.v), patch.dv(place.u, place.v), -d;
      const Vector3d step = j.partialPivLu().solve(patch.at(place.u, place.v) - s - place.t * d);
      if (!step.allFinite()) return false;
      place.u -= step.x();
      place.v -= step.y();
      place.t -= step.z();
      const double size = std::abs(step.x()) + std::abs(step.y());
      if (size < 1e-15 || (size < 1e-11 && size >= last)) return true;  // weights of size 1: round-off
      if (place.u < -1 || place.v < -1 || place.u + place.v > 2) return i > 0 || size < 10;
      last = size;
    }
    return last < 1e-9;  // close enough to be a place
  }

  /// Walks from triangle to neighbour until the line passes through one. Nothing at a border or after `most` triangles.
  /// Gives up at once when the first triangle's weights say that the place is more than `far` triangles away.
  std::optional<Place> walk(int triangle, const Vector3d& o, const Vector3d& d, int most, double far = kInf) const {
    Place best;
    double bestLowest = -kInf;
    for (int i = 0, before = -1; i < most; ++i) {
      Place place;
      if (!solve(triangle, o, d, place)) break;
      const double w = 1 - place.u - place.v;
      const double lowest = std::min({place.u, place.v, w});
      if (i == 0 && !(lowest > -far)) return std::nullopt;
      if (lowest >= -kInside) return place;
      if (lowest > bestLowest) {
        bestLowest = lowest;
        best = place;
      }
      // Weight of corner k negative: out across the edge opposite to it.
      const int edge = lowest == place.v ? 0 : lowest == w ? 1 : 2;
      const int next = topology_.neighbours[triangle][edge];
      if (next < 0 || (next == before && lowest > -1e-7)) break;  // to and fro over an edge: single precision of a start
      before = triangle;
      triangle = next;
    }
    // The walk goes round a corner, or to and fro over an edge: the line meets the mesh there, but round-off (or two patches'
    // different slopes) puts it just outside of each triangle.
    if (bestLowest > (policy_ == NormalPolicy::Curved ? -1e-7 : -1e-9)) {
      best.u = std::clamp(best.u, 0.0, 1.0);
      best.v = std::clamp(best.v, 0.0, 1.0 - best.u);
      return best;
    }
    return std::nullopt;
  }

  /// 1 where a point cannot see `to`; with `oneIsEnough` the points after it stay 0.
  std::vector<char> occlusions(const std::vector<SurfacePoint>& from, const Vector3d& to, int asks, bool oneIsEnough) const;
  /// First place with a parameter in (least, most) of o + t d, |d| = 1. Embree finds triangles, double decides unless `single_`.
  std::optional<Place> firstPlace(const Vector3d& o, const Vector3d& d, double least, double most) const {
    // Start where the ray enters the box: float coordinates are then of order 1 with an error of 1e-7.
    const double margin = 1e-5 * size_;
    double enter = std::max(0.0, least), leave = most;
    for (int k = 0; k < 3; ++k) {
      const double low = bounds_.min()[k] - margin - o[k], high = bounds_.max()[k] + margin - o[k];
      if (d[k] == 0) {
        if (low > 0 || high < 0) return std::nullopt;
        continue;
      }
      const double a = low / d[k], b = high / d[k];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (!(enter <= leave)) return std::nullopt;
    const Vector3d start = o + enter * d;
    MeshRays::Search search(*rays_, start, d, leave - enter);
    constexpr int kMostHits = 64;  // before `least`
    for (int i = 0; i < kMostHits; ++i) {
      const std::optional<MeshRays::Hit> hit = search.next();
      if (!hit) return std::nullopt;
      if (single_) {
        const Place place{hit->triangle, hit->u, hit->v, enter + hit->t};
        if (place.t > least) return place.t < most ? std::optional<Place>(place) : std::nullopt;
      } else if (std::optional<Place> place = walk(hit->triangle, start, d, 8)) {
        place->t += enter;
        if (place->t > least && place->t < most) return place;
        if (place->t >= most && policy_ != NormalPolicy::Curved) return std::nullopt;
      }
      // Before `least`, or over a border in double: look behind this hit.
    }
    return std::nullopt;
  }

  /// Built by the first search; null where normals do not help, or there are too few searches to pay for it.
  const NormalTree* normalTree() const;
  /// Where the reflection law holds on a triangle to first order; false when that is well outside of it.
  bool mirrorPlaceOn(const MirrorQuery& query, Place& place) const;

  SurfacePoint pointAt(const Place& place) const {
    SurfacePoint p;
    const Vector3i& t = mesh_.triangles[place.triangle];
    const double w = 1 - place.u - place.v;
    p.element = place.triangle;
    p.barycentric = {place.u, place.v};
    const Vector3d &a = mesh_.vertices[t.x()], &b = mesh_.vertices[t.y()], &c = mesh_.vertices[t.z()];
    p.position = a + (policy_ == NormalPolicy::Curved ? patchOf(place.triangle).at(place.u, place.v)
                                                      : Vector3d(place.u * (b - a) + place.v * (c - a)));
    if (policy_ != NormalPolicy::Facet) {
      const Vector3d n = w * mesh_.normals[t.x()] + place.u * mesh_.normals[t.y()] + place.v * mesh_.normals[t.z()];
      const double length = n.norm();
      if (length > 1e-6) {  // unit vectors that cancel to this have no mean
        p.normal = n / length;
        return p;
      }
    }
    // Facets, and where opposite vertex normals cancel.
    p.normal = (b - a).cross(c - a).normalized() * (topology_.turned[place.triangle] ? -1 : 1);
    return p;
  }

  NormalPolicy policy_;
  bool single_;  // Embree's own hits serve
  bool manySearches_;
  TriangleMesh mesh_;
  std::vector<char> filled_;  ///< per vertex; empty = no vertex was filled
  MeshTopology topology_;
  AlignedBox3d bounds_;
  Vector3d centre_{0, 0, 0};
  double size_ = 1;
  std::optional<MeshRays> rays_;     ///< always there once built
  mutable std::once_flag treeOnce_;  ///< built by the first search
  mutable std::unique_ptr<const NormalTree> tree_;
  mutable std::once_flag outwardOnce_;  ///< known from the first question about parts on
  mutable std::optional<double> outwardDeviation_;
};

bool MeshSurface::mirrorPlaceOn(const MirrorQuery& query, Place& place) const {
  constexpr double kSlack = 0.5;  // of the triangle's size: neither H nor a patch is quite linear over it
  const Vector3i& t = mesh_.triangles[place.triangle];
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(pointAt(place).normal);
  Vector2d g[3];  // tangential part of H - N at the corners: both scaled to the same length along the middle normal
  const Vector3d middle = basis.col(0).cross(basis.col(1));
  for (int k = 0; k < 3; ++k) {
    const Vector3d &p = mesh_.vertices[t[k]], &n = mesh_.normals[t[k]];
    const Vector3d h = (query.light.head<3>() - query.light.w() * p).normalized() + (query.eye - p).normalized();
    const double alongH = h.dot(middle), alongN = n.dot(middle);
    if (alongH == 0 || !(alongN > 0.1)) return true;  // too coarse to tell
    g[k] = basis.transpose() * (h / alongH - n / alongN);
  }
  Matrix2d m;
  m << g[1] - g[0], g[2] - g[0];
  const double determinant = m.determinant();
  if (!(std::abs(determinant) > 1e-6 * m.squaredNorm())) return true;  // a fold
  const double u = (-g[0].x() * m(1, 1) + g[0].y() * m(0, 1)) / determinant,
               v = (-g[0].y() * m(0, 0) + g[0].x() * m(1, 0)) / determinant;
  if (std::min({u, v, 1 - u - v}) < -kSlack) return false;
  place.u = std::clamp(u, 0.0, 1.0);
  place.v = std::clamp(v, 0.0, 1 - place.u);
  return true;
}

const NormalTree* MeshSurface::normalTree() const {
  if (policy_ == NormalPolicy::Facet || !manySearches_) return nullptr;
  std::call_once(treeOnce_, [&] {
    std::function<Vector3d(int, int)> middle;
    if (policy_ == NormalPolicy::Curved) middle = [this](int a, int b) { return edgePoint(a, b); };
    tree_ = std::make_unique<const NormalTree>(mesh_, topology_, bounds_, middle);
  });
  return tree_.get();
}

std::optional<std::vector<SurfacePart>> MeshSurface::partsThatMay(const MirrorQuery& query, double lightReach,
                                                                  const PartTest& test, std::size_t most) const {
  const NormalTree* tree = normalTree();
  if (!tree) return std::nullopt;
  std::call_once(outwardOnce_, [this] { outwardDeviation_ = outwardDeviation(mesh_, topology_, mesh_.normals); });
  const std::optional<std::vector<std::pair<int, double>>> found =
      tree->partsThatMay(query, lightReach, test, most, bounds_.contains(query.eye) ? std::nullopt : outwardDeviation_);
  if (!found) return std::nullopt;
  std::vector<SurfacePart> parts;
  parts.reserve(found->size());
  for (const auto& [triangle, radius] : *found) __builtin_prefetch(&mesh_.triangles[triangle]);  // as in mirrorPlaces
  for (const auto& [triangle, radius] : *found)
    for (const int v : mesh_.triangles[triangle]) {
      __builtin_prefetch(&mesh_.vertices[v]);
      __builtin_prefetch(&mesh_.normals[v]);
    }
  for (const auto& [triangle, radius] : *found) parts.push_back({pointAt({triangle, 1.0 / 3, 1.0 / 3, 0}), radius});
  return parts;
}

std::optional<std::vector<SurfacePoint>> MeshSurface::mirrorPlaces(const MirrorQuery& query) const {
  // A smooth highlight leaves about ten parts; with more than this, normals vary within parts as much as between them.
  constexpr std::size_t kMostPlaces = 256;
  const NormalTree* tree = normalTree();
  if (!tree) return std::nullopt;
  const std::optional<std::vector<int>> triangles = tree->candidates(query, kMostPlaces);
  if (!triangles) return std::nullopt;
  std::vector<SurfacePoint> places;
  places.reserve(triangles->size());
  // Triangles far apart are in no cache: ask for all before waiting for one.
  for (const int t : *triangles) __builtin_prefetch(&mesh_.triangles[t]);
  for (const int t : *triangles)
    for (const int v : mesh_.triangles[t]) {
      __builtin_prefetch(&mesh_.vertices[v]);
      __builtin_prefetch(&mesh_.normals[v]);
    }
  for (const int t : *triangles) {
    Place place{t, 1.0 / 3, 1.0 / 3, 0};
    if (!tree->finest() || mirrorPlaceOn(query, place)) places.push_back(pointAt(place));
  }
  return places;
}

std::vector<std::optional<SurfacePoint>> MeshSurface::approximateHits(const std::vector<Ray>& rays) const {
  std::vector<std::optional<SurfacePoint>> hits(rays.size());
  std::vector<Place> places;
  places.reserve(rays.size());
  for (const MeshRays::Hit& h : rays_->hits(rays)) places.push_back({h.triangle, h.u, h.v, 0});
  // Rays far apart meet triangles that no cache holds: ask for all of them before waiting for one.
  for (const Place& p : places)
    if (p.triangle >= 0) __builtin_prefetch(&mesh_.triangles[p.triangle]);
  for (const Place& p : places)
    if (p.triangle >= 0)
      for (int k = 0; k < 3; ++k) {
        const int vertex = mesh_.triangles[p.triangle][k];
        __builtin_prefetch(&mesh_.vertices[vertex]);
        if (!mesh_.normals.empty()) __builtin_prefetch(&mesh_.normals[vertex]);
      }
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].triangle >= 0) hits[i] = pointAt(places[i]);
  return hits;
}

std::vector<char> MeshSurface::occlusions(const std::vector<SurfacePoint>& from, const Vector3d& to, int asks,
                                          bool oneIsEnough) const {
  std::vector<char> result(from.size(), 0);
  rays_->obstacles(from, to, kOcclusionStart, asks, [&](std::size_t i, bool certain) {
    // Double precision decides where single precision may be wrong, as for a single point.
    result[i] = certain || occluded(from[i], to);
    return !(result[i] && oneIsEnough);
  });
  return result;
}

Outcome<Curvature> MeshSurface::curvatureAt(const SurfacePoint& p) const {
  if (policy_ == NormalPolicy::Facet) return Failure{Reason::NotSupported, "facets have no curvature"};
  if (p.element < 0 || p.element >= static_cast<int>(mesh_.triangles.size()) || !topology_.alive[p.element])
    return Failure{Reason::NotSupported, "not a point of this mesh"};
  const Vector3i& t = mesh_.triangles[p.element];
  const Vector3d &n0 = mesh_.normals[t.x()], &n1 = mesh_.normals[t.y()], &n2 = mesh_.normals[t.z()];
  const double u = p.barycentric.x(), v = p.barycentric.y();
  const Vector3d sum = (1 - u - v) * n0 + u * n1 + v * n2;
  const double length = sum.norm();
  if (!(length > 1e-6)) return Failure{Reason::NotSupported, "vertex normals cancel here"};  // of unit vectors
  const Vector3d n = sum / length;
  Eigen::Matrix<double, 3, 2> dP, dN;
  if (policy_ == NormalPolicy::Curved) {
    const Patch patch = patchOf(p.element);
    dP << patch.du(u, v), patch.dv(u, v);
  } else {
    dP << mesh_.vertices[t.y()] - mesh_.vertices[t.x()], mesh_.vertices[t.z()] - mesh_.vertices[t.x()];
  }
  dN << n1 - n0, n2 - n0;
  dN /= length;  // its part along n drops out below
  // Shape operator S: dN = S dP on the tangent plane; for an interpolated field only nearly symmetric.
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(n);
  const Matrix2d a = basis.transpose() * dP;
  // Thinner than a part in 1e12 (as for triangles without an area) the slopes are round-off.
  if (!(std::abs(a.determinant()) > 1e-12 * a.squaredNorm()))
    return Failure{Reason::NotSupported, "the triangle is seen edge-on from its normal"};
  Matrix2d s = a.transpose().partialPivLu().solve((basis.transpose() * dN).transpose()).transpose();
  s = 0.5 * (s + s.transpose()).eval();
  if (p.normal.dot(n) < 0) s = -s;
  if (!s.allFinite()) return Failure{Reason::NotFinite, "curvature"};
  Eigen::SelfAdjointEigenSolver<Matrix2d> eigen;
  eigen.computeDirect(s);
  Curvature c;
  c.k1 = eigen.eigenvalues()[1];
  c.k2 = eigen.eigenvalues()[0];
  c.direction1 = basis * eigen.eigenvectors().col(1);
  c.direction2 = basis * eigen.eigenvectors().col(0);
  return c;
}

}  // namespace

std::shared_ptr<const Surface> makeMesh(TriangleMesh mesh, MeshPolicy policy, bool manySearches, std::vector<char> filled) {
  return std::make_shared<MeshSurface>(std::move(mesh), policy, manySearches, std::move(filled));
}

}  // namespace glint
