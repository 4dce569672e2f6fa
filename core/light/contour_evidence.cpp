// SPDX-License-Identifier: BSD-3-Clause
#include "core/light/contour_evidence.h"

#include <cmath>

#include "core/geometry/polyline.h"

namespace glint {

Outcome<std::vector<ContourEvidence>> contoursOnSurfaces(const std::vector<BundleView>& views, int pointsPerView) {
  constexpr double step = ContourEvidence::kStepPx;
  std::vector<ContourEvidence> points;
  std::size_t offered = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const BundleView& view = views[v];
    require(view.surface != nullptr, "bundleLight: a view without surface");
    for (const Pixel& p : view.contour)
      if (!p.allFinite()) return Failure{Reason::NotFinite, "a contour point of view " + std::to_string(v)};
    const std::vector<Pixel> pixels =
        view.contour.size() > std::size_t(pointsPerView) ? resample(Polyline{view.contour, true}, pointsPerView) : view.contour;
    offered += pixels.size();
    const Eigen::Vector3d eye = view.camera.centreInWorld();
    const auto seen = [&](const Pixel& p) -> std::optional<EvidencePoint> {
      const Outcome<SurfacePoint> hit = view.surface->firstHit(view.camera.ray(p));
      if (!hit || !hit->position.allFinite() || !hit->normal.allFinite()) return std::nullopt;
      const SurfacePoint s = facing(*hit, eye);
      return EvidencePoint{s.position, s.normal, (eye - s.position).normalized()};
    };
    for (const Pixel& p : pixels) {
      const std::optional<EvidencePoint> at = seen(p);
      if (!at) continue;
      ContourEvidence e{*at,
                        seen(p - Pixel(step, 0)),
                        seen(p + Pixel(step, 0)),
                        seen(p - Pixel(0, step)),
                        seen(p + Pixel(0, step)),
                        seen(p + Pixel(-step, -step)),
                        seen(p + Pixel(step, -step)),
                        seen(p + Pixel(-step, step)),
                        seen(p + Pixel(step, step)),
                        int(v),
                        p,
                        (eye - at->position).norm()};
      if ((!e.left && !e.right) || (!e.up && !e.down)) continue;
      points.push_back(std::move(e));
    }
  }
  if (offered > 0 && points.empty()) return Failure{Reason::PeakOffSurface, "no contour point hits the surface"};
  return points;
}

Outcome<NormalisedContours> normalised(std::vector<ContourEvidence> points) {
  if (points.size() < 5) return Failure{Reason::TooFewPoints, "need 5 on the surface, have " + std::to_string(points.size())};
  NormalisedContours n;
  n.scale = 0;
  for (const ContourEvidence& e : points) {
    n.origin += e.at.position;
    n.scale += e.cameraDistance;
  }
  n.origin /= double(points.size());
  n.scale /= double(points.size());
  if (!(n.scale > 0) || !std::isfinite(n.scale)) return Failure{Reason::NotFinite, "camera distance"};
  for (ContourEvidence& e : points) {
    e.at.position = (e.at.position - n.origin) / n.scale;
    for (std::optional<EvidencePoint>* s : {&e.left, &e.right, &e.up, &e.down, &e.leftUp, &e.rightUp, &e.leftDown, &e.rightDown})
      if (*s) (*s)->position = ((*s)->position - n.origin) / n.scale;
  }
  n.points = std::move(points);
  return n;
}

}  // namespace glint
