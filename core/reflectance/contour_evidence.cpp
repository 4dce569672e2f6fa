// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/contour_evidence.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/geometry/conic.h"
#include "core/geometry/polyline.h"

namespace glint::lobe {

std::optional<Stencil> look(const RadianceView& view, const Pixel& p, const Eigen::Vector3d& origin, double scale,
                            double stepPx) {
  const Eigen::Vector3d eye = view.camera.centreInWorld();
  const auto seen = [&](const Pixel& q) -> std::optional<Seen> {
    const Outcome<SurfacePoint> hit = view.surface->firstHit(view.camera.ray(q));
    if (!hit || !hit->position.allFinite() || !hit->normal.allFinite()) return std::nullopt;
    Seen s = seenFrom(eye, *view.surface, facing(*hit, eye));
    s.position = (s.position - origin) / scale;
    return s;
  };
  const std::optional<Seen> at = seen(p), left = seen(p - Pixel(stepPx, 0)), right = seen(p + Pixel(stepPx, 0)),
                            up = seen(p - Pixel(0, stepPx)), down = seen(p + Pixel(0, stepPx));
  if (!at || !left || !right || !up || !down) return std::nullopt;
  return Stencil{*at, *left, *right, *up, *down, stepPx};
}

namespace {

/// Curvature of an ellipse in the direction of a pixel from its centre, 1/px.
double curvatureAt(const Ellipse& e, const Pixel& p) {
  const double a = e.semiAxes.x(), b = e.semiAxes.y();
  const Eigen::Vector2d d = Eigen::Rotation2Dd(-e.angle) * (p - e.centre);
  const double t = std::atan2(d.y() / b, d.x() / a);
  return a * b / std::pow(std::hypot(a * std::sin(t), b * std::cos(t)), 3);
}

/// Sides of the contour's box along which the contour runs straight: it was cut there, for example at the end of the image. A
/// level set touches its box in points only. Order: left, right, top, bottom.
std::array<bool, 4> cutSides(const std::vector<Pixel>& contour, const Eigen::AlignedBox2d& box) {
  constexpr double kSamePx = 1e-6, kLeastPx = 2;  // digits of a written contour; a shorter side may be one chord of a level set
  std::array<double, 4> straight{};
  for (std::size_t i = 0; i < contour.size(); ++i) {
    const Pixel &a = contour[i], &b = contour[(i + 1) % contour.size()];
    for (int k = 0; k < 4; ++k) {
      const int axis = k / 2;
      const double side = k % 2 == 0 ? box.min()(axis) : box.max()(axis);
      if (std::abs(a(axis) - side) < kSamePx && std::abs(b(axis) - side) < kSamePx) straight[k] += (b - a).norm();
    }
  }
  std::array<bool, 4> cut{};
  for (int k = 0; k < 4; ++k) cut[k] = straight[k] > kLeastPx;
  return cut;
}

bool onCutSide(const Pixel& p, const Eigen::AlignedBox2d& box, const std::array<bool, 4>& cut) {
  constexpr double kNearPx = 1e-3;  // resampled points lie on the side to round-off; the level set leaves it at once
  const Eigen::Vector2d low = p - box.min(), high = box.max() - p;
  return (cut[0] && low.x() < kNearPx) || (cut[1] && high.x() < kNearPx) || (cut[2] && low.y() < kNearPx) ||
         (cut[3] && high.y() < kNearPx);
}

}  // namespace

Outcome<ContourEvidence> gatherEvidence(const std::vector<RadianceView>& views, int pointsPerView) {
  ContourEvidence all;
  std::map<int, int> frameIndex;
  Eigen::Vector3d& origin = all.origin;
  double& scale = all.scale;
  scale = 0;
  std::size_t offered = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const RadianceView& view = views[v];
    require(view.surface != nullptr, "fitRadiance: a view without surface");
    require(view.level > 0 && view.level < 1, "fitRadiance: the level must lie between 0 and 1");
    for (const Pixel& p : view.contour)
      if (!p.allFinite()) return Failure{Reason::NotFinite, "a contour point of view " + std::to_string(v)};
    const auto [known, isNew] = frameIndex.emplace(view.frame, static_cast<int>(all.frames.size()));
    if (isNew) all.frames.push_back({view.camera, view.surface, {}, {}, {}, {}});
    std::vector<Pixel>& starts = all.frames[known->second].starts;
    if (std::find(starts.begin(), starts.end(), view.peak) == starts.end()) starts.push_back(view.peak);
    const std::vector<Pixel> pixels =
        view.contour.size() > std::size_t(pointsPerView) ? resample(Polyline{view.contour, true}, pointsPerView) : view.contour;
    offered += pixels.size();
    const double radiusPx = std::sqrt(std::abs(signedArea(Polyline{view.contour, true})) / M_PI);
    const double stepPx = radiusPx > 0 ? std::min(kStencilStepPx, kStencilShare * radiusPx) : kStencilStepPx;
    all.radiusPx += radiusPx / double(views.size());
    const Outcome<Ellipse> ellipse = fitEllipse(pixels);
    Eigen::AlignedBox2d box;
    for (const Pixel& p : view.contour) box.extend(p);
    const std::array<bool, 4> cut = cutSides(view.contour, box);
    for (const Pixel& p : pixels) {
      // Where the image or the surface ends, the contour is an edge and not a level set.
      if (onImageBorder(view.camera, p) || onCutSide(p, box, cut)) continue;
      const std::optional<Stencil> at = look(view, p, Eigen::Vector3d::Zero(), 1, stepPx);
      if (!at) continue;
      Evidence e;
      e.view = static_cast<int>(v);
      e.frame = known->second;
      e.level = std::sqrt(-std::log(view.level));
      e.observed = p;
      e.measured = *at;
      if (ellipse) e.curvature = curvatureAt(*ellipse, p);
      origin += at->at.position;
      scale += (view.camera.centreInWorld() - at->at.position).norm();
      all.points.push_back(std::move(e));
    }
  }
  if (offered > 0 && all.points.empty()) return Failure{Reason::PeakOffSurface, "no contour point hits the surface"};
  if (all.points.size() < 5)
    return Failure{Reason::TooFewPoints, "need 5 on the surface, have " + std::to_string(all.points.size())};
  origin /= double(all.points.size());
  scale /= double(all.points.size());
  if (!(scale > 0) || !std::isfinite(scale)) return Failure{Reason::NotFinite, "camera distance"};
  for (Evidence& e : all.points) {
    for (Seen* s : {&e.measured.at, &e.measured.left, &e.measured.right, &e.measured.up, &e.measured.down})
      s->position = (s->position - origin) / scale;
    e.foot = e.measured;
  }
  return all;
}

}  // namespace glint::lobe
