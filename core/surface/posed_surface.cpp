// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/posed_surface.h"

#include <limits>
#include <utility>

#include "core/geometry/transforms.h"
#include "core/surface/mirror_places.h"
#include "core/surface/occlusion.h"
#include "core/surface/part_bounds.h"

namespace glint {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

SurfacePoint carried(const Isometry3d& to, SurfacePoint p) {
  p.position = to * p.position;
  p.normal = to.linear() * p.normal;
  return p;
}

Outcome<SurfacePoint> carried(const Isometry3d& to, Outcome<SurfacePoint> point) {
  return point ? Outcome<SurfacePoint>(carried(to, *std::move(point))) : point;
}

std::vector<SurfacePoint> carried(const Isometry3d& to, const std::vector<SurfacePoint>& points) {
  std::vector<SurfacePoint> result;
  result.reserve(points.size());
  for (const SurfacePoint& p : points) result.push_back(carried(to, p));
  return result;
}

/// The box around a box that turned; an infinite one where it has no end.
Eigen::AlignedBox3d carried(const Isometry3d& to, const Eigen::AlignedBox3d& box) {
  if (box.isEmpty()) return box;
  const double kEndless = std::numeric_limits<double>::infinity();
  if (!box.min().allFinite() || !box.max().allFinite()) return {Vector3d::Constant(-kEndless), Vector3d::Constant(kEndless)};
  return box.transformed(to);
}

class PosedSurface : public Surface {
 public:
  PosedSurface(std::shared_ptr<const Surface> object, const Isometry3d& worldFromObject)
      : object_(std::move(object)), world_(worldFromObject), back_(worldFromObject.inverse()) {}

  const std::shared_ptr<const Surface>& shared() const { return object_; }
  const Isometry3d& pose() const { return world_; }

  std::string describe() const override { return object_->describe(); }
  Outcome<SurfacePoint> firstHit(const Ray& ray) const override { return carried(world_, object_->firstHit(back(ray))); }
  std::vector<std::optional<SurfacePoint>> approximateHits(const std::vector<Ray>& rays) const override {
    std::vector<Ray> there;
    there.reserve(rays.size());
    for (const Ray& ray : rays) there.push_back(back(ray));
    std::vector<std::optional<SurfacePoint>> hits = object_->approximateHits(there);
    for (std::optional<SurfacePoint>& hit : hits)
      if (hit) hit = carried(world_, *hit);
    return hits;
  }
  Outcome<SurfacePoint> foot(const Vector3d& point, const Vector3d& direction, const SurfacePoint& previous) const override {
    return carried(world_, object_->foot(back_ * point, back_.linear() * direction, carried(back_, previous)));
  }
  Outcome<Curvature> curvatureAt(const SurfacePoint& p) const override {
    Outcome<Curvature> found = object_->curvatureAt(carried(back_, p));
    if (!found) return found;
    found->direction1 = world_.linear() * found->direction1;
    found->direction2 = world_.linear() * found->direction2;
    return found;
  }
  Vector3d tangentAt(const SurfacePoint& p) const override { return world_.linear() * object_->tangentAt(carried(back_, p)); }
  bool occluded(const SurfacePoint& from, const Vector3d& to) const override {
    return object_->occluded(carried(back_, from), back_ * to);
  }
  Eigen::AlignedBox3d bounds() const override { return carried(world_, object_->bounds()); }
  TriangleMesh tessellate(const Eigen::AlignedBox3d& region, int resolution) const override {
    TriangleMesh mesh = object_->tessellate(carried(back_, region), resolution);
    for (Vector3d& v : mesh.vertices) v = world_ * v;
    for (Vector3d& n : mesh.normals) n = world_.linear() * n;
    return mesh;
  }

 protected:
  Ray back(const Ray& ray) const { return {back_ * ray.origin, back_.linear() * ray.direction}; }
  std::vector<SurfacePoint> back(const std::vector<SurfacePoint>& points) const { return carried(back_, points); }
  MirrorQuery back(MirrorQuery query) const {
    query.eye = back_ * query.eye;
    query.light = back_.matrix() * query.light;
    for (Vector3d& side : query.sides) side = back_.linear() * side;
    return query;
  }

  std::shared_ptr<const Surface> object_;
  Isometry3d world_, back_;
};

/// A mesh also answers in packets, and bounds its parts.
class PosedMesh final : public PosedSurface, public ManyOcclusions, public MirrorPlaces, public BoundedParts, public FilledParts {
 public:
  using PosedSurface::PosedSurface;
  static bool canMove(const Surface& surface) {
    return dynamic_cast<const ManyOcclusions*>(&surface) && dynamic_cast<const MirrorPlaces*>(&surface) &&
           dynamic_cast<const BoundedParts*>(&surface) && dynamic_cast<const FilledParts*>(&surface);
  }

  std::vector<char> occludedMany(const std::vector<SurfacePoint>& from, const Vector3d& to) const override {
    return as<ManyOcclusions>().occludedMany(back(from), back_ * to);
  }
  bool anyOccluded(const std::vector<SurfacePoint>& from, const Vector3d& to) const override {
    return as<ManyOcclusions>().anyOccluded(back(from), back_ * to);
  }
  std::optional<std::vector<SurfacePoint>> mirrorPlaces(const MirrorQuery& query) const override {
    std::optional<std::vector<SurfacePoint>> places = as<MirrorPlaces>().mirrorPlaces(back(query));
    if (places) *places = carried(world_, *places);
    return places;
  }
  std::optional<std::vector<SurfacePart>> partsThatMay(const MirrorQuery& query, double lightReach, const PartTest& test,
                                                       std::size_t most) const override {
    std::optional<std::vector<SurfacePart>> parts = as<BoundedParts>().partsThatMay(back(query), lightReach, test, most);
    if (parts)
      for (SurfacePart& part : *parts) part.middle = carried(world_, part.middle);
    return parts;
  }
  bool filledAt(const SurfacePoint& p) const override { return as<FilledParts>().filledAt(carried(back_, p)); }

 private:
  template <class T>
  const T& as() const {
    return dynamic_cast<const T&>(*object_);
  }
};

}  // namespace

std::shared_ptr<const Surface> movedTo(const Isometry3d& worldFromObject, std::shared_ptr<const Surface> surface) {
  require(surface != nullptr, "movedTo: no surface");
  require(worldFromObject.matrix().allFinite(), "movedTo: a finite pose");
  if (const auto* const moved = dynamic_cast<const PosedSurface*>(surface.get())) surface = moved->shared();
  if (isIdentity(worldFromObject)) return surface;
  if (PosedMesh::canMove(*surface)) return std::make_shared<PosedMesh>(std::move(surface), worldFromObject);
  return std::make_shared<PosedSurface>(std::move(surface), worldFromObject);
}

const Surface& objectOf(const Surface& surface) {
  const auto* const moved = dynamic_cast<const PosedSurface*>(&surface);
  return moved ? *moved->shared() : surface;
}

Isometry3d poseOf(const Surface& surface) {
  const auto* const moved = dynamic_cast<const PosedSurface*>(&surface);
  return moved ? moved->pose() : Isometry3d::Identity();
}

}  // namespace glint
