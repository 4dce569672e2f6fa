// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/mesh_rays.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>

#include "core/base/memory.h"
#include "core/geometry/plane.h"

namespace glint {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr int kPacket = 8;
/// Embree asserts that no coordinate of a ray exceeds 1.8e18. A ray that far from the mesh never meets it.
constexpr double kRange = 1e18;
// About ten units of single precision: far enough from a vertex, and double decides about the true ray.
constexpr float kAside = 2e-6f;
constexpr float kClear = 1e-3f;  // of the unit: a hit this far from both ends is real, whatever single precision does

void setRay(RTCRayHit8& packet, int k, const Vector3f& o, const Vector3f& d, float from, float to) {
  packet.ray.org_x[k] = o.x();
  packet.ray.org_y[k] = o.y();
  packet.ray.org_z[k] = o.z();
  packet.ray.dir_x[k] = d.x();
  packet.ray.dir_y[k] = d.y();
  packet.ray.dir_z[k] = d.z();
  packet.ray.tnear[k] = from;
  packet.ray.tfar[k] = to;
  packet.ray.time[k] = 0;
  packet.ray.mask[k] = ~0u;
  packet.ray.id[k] = packet.ray.flags[k] = 0;
  packet.hit.geomID[k] = packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
}

RTCDevice newDevice() {
  reserveTaskMemory();
  return rtcNewDevice(std::getenv("GLINT_EMBREE"));  // null: Embree's own defaults
}

}  // namespace

MeshRays::MeshRays(const TriangleMesh& mesh, const std::vector<char>& alive, const Eigen::AlignedBox3d& bounds)
    : centre_(bounds.center()), size_(bounds.sizes().norm()), scale_(2 / size_), device_(newDevice()) {
  if (!device_) {
    if (rtcGetDeviceError(nullptr) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::runtime_error("Embree: no device");
  }
  scene_ = rtcNewScene(device_);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  auto* corners = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  if (!vertices || !corners) {
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
    throw std::bad_alloc();
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int k = 0; k < 3; ++k) vertices[3 * i + k] = static_cast<float>((mesh.vertices[i][k] - centre_[k]) * scale_);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)  // ignored ones collapse to a point, which no ray hits
    for (int k = 0; k < 3; ++k) corners[3 * i + k] = static_cast<unsigned>(mesh.triangles[i][alive[i] ? k : 0]);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);  // without it rays leak through edges
  rtcCommitScene(scene_);
  // A tree that could not be built holds nothing: every ray would miss.
  if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::runtime_error("Embree: error " + std::to_string(static_cast<int>(error)));
  }
}

MeshRays::~MeshRays() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

MeshRays::Search::Search(const MeshRays& rays, const Vector3d& start, const Vector3d& d, double length)
    : rays_(rays), direction_(d) {
  const Vector3d local = (start - rays.centre_) * rays.scale_;
  outside_ = !(local.cwiseAbs().maxCoeff() < kRange);
  if (outside_) return;
  origin_ = local.cast<float>();
  // A little farther than asked: single precision may place the hit in front or behind, and double decides.
  far_ = std::isfinite(length) ? static_cast<float>(length * rays.scale_) * 1.00001f + 1e-5f : INFINITY;
}

std::optional<MeshRays::Hit> MeshRays::Search::next() {
  while (!outside_) {
    RTCRayHit query;
    query.ray.org_x = origin_.x(), query.ray.org_y = origin_.y(), query.ray.org_z = origin_.z();
    query.ray.dir_x = static_cast<float>(direction_.x());
    query.ray.dir_y = static_cast<float>(direction_.y());
    query.ray.dir_z = static_cast<float>(direction_.z());
    query.ray.tnear = near_;
    query.ray.tfar = far_;
    query.ray.time = 0;
    query.ray.mask = ~0u;
    query.ray.id = query.ray.flags = 0;
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(rays_.scene_, &context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
      near_ = std::max(query.ray.tfar, near_) * 1.000001f + 2e-7f;  // behind it by the least that single precision can tell
      return Hit{static_cast<int>(query.hit.primID), query.hit.u, query.hit.v, query.ray.tfar / rays_.scale_};
    }
    // Seen once in 1e4 pixel rays of a depth map, which all meet vertices.
    if (shifted_) break;
    shifted_ = true;
    origin_ += kAside * tangentBasis(direction_).col(0).cast<float>();
  }
  return std::nullopt;
}

std::vector<MeshRays::Hit> MeshRays::hits(const std::vector<Ray>& rays) const {
  std::vector<Hit> found(rays.size());
  alignas(32) RTCRayHit8 packet;
  alignas(32) int valid[kPacket];
  RTCIntersectContext context;
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    for (int k = 0; k < kPacket; ++k) {
      valid[k] = 0;
      if (first + k >= rays.size()) continue;
      const Ray& ray = rays[first + k];
      // Starts near the mesh: at the sphere around its box.
      const double enter = std::max(0.0, (centre_ - ray.origin).dot(ray.direction) - 0.5 * size_);
      const Vector3d o = (ray.origin + enter * ray.direction - centre_) * scale_;
      if (!(o.cwiseAbs().maxCoeff() < kRange) || !ray.direction.allFinite()) continue;
      valid[k] = -1;
      setRay(packet, k, o.cast<float>(), ray.direction.cast<float>(), 0, INFINITY);
    }
    // Without the flag for coherent rays: seeds lie 32 px apart, and with it they take 1.6 times as long (the dense scan of a
    // level set shows no difference).
    rtcInitIntersectContext(&context);
    rtcIntersect8(valid, scene_, &context, &packet);
    for (int k = 0; k < kPacket; ++k)
      if (valid[k] && packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID)
        found[first + k] = {static_cast<int>(packet.hit.primID[k]), packet.hit.u[k], packet.hit.v[k], 0};
  }
  return found;
}

void MeshRays::obstacles(const std::vector<SurfacePoint>& from, const Vector3d& to, double start, int asks,
                         const std::function<bool(std::size_t, bool)>& met) const {
  alignas(32) RTCRayHit8 packet;
  alignas(32) int valid[kPacket];
  RTCIntersectContext context;
  for (std::size_t first = 0; first < from.size(); first += kPacket) {
    bool found[kPacket] = {}, certain[kPacket] = {};
    for (int ask = 0; ask < asks; ++ask) {
      bool any = false;
      float length[kPacket] = {};
      for (int k = 0; k < kPacket; ++k) {
        valid[k] = 0;
        if (first + k >= from.size() || found[k]) continue;
        const Vector3d& p = from[first + k].position;
        const Vector3d offset = to - p;
        const double distance = offset.norm();
        if (!p.allFinite() || !(distance > 0) || !std::isfinite(distance)) continue;
        const Vector3d d = offset / distance, o = (p - centre_) * scale_;
        if (!(o.cwiseAbs().maxCoeff() < kRange)) continue;
        Vector3f origin = o.cast<float>();
        if (ask > 0) origin += kAside * tangentBasis(d).col(0).cast<float>();
        valid[k] = -1;
        any = true;
        length[k] = static_cast<float>(std::min(distance * scale_, kRange));
        setRay(packet, k, origin, d.cast<float>(), static_cast<float>(start * std::min(size_, distance) * scale_), length[k]);
      }
      if (!any) break;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect8(valid, scene_, &context, &packet);
      for (int k = 0; k < kPacket; ++k)
        if (valid[k] && packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID) {
          found[k] = true;
          certain[k] = ask == 0 && packet.ray.tfar[k] > kClear && packet.ray.tfar[k] < length[k] - kClear;
        }
    }
    for (int k = 0; k < kPacket; ++k)
      if (found[k] && !met(first + k, certain[k])) return;
  }
}

}  // namespace glint
