// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/on_surface.h"

#include <algorithm>
#include <cmath>

namespace glint::draw {
namespace {

constexpr int kMostContourPoints = 720;  ///< per contour on screen

bool isFiniteBox(const Eigen::AlignedBox3d& box) { return !box.isEmpty() && box.min().allFinite() && box.max().allFinite(); }

/// What the cameras see of a surface without bounds: hits of a coarse grid of rays.
Eigen::AlignedBox3d seenBy(const Inspection& inspection, const Surface& surface, const std::vector<int>& frames) {
  constexpr int kGrid = 7;
  constexpr std::size_t kMostCameras = 12;
  Eigen::AlignedBox3d box;
  const std::size_t step = std::max<std::size_t>(1, frames.size() / kMostCameras);
  for (std::size_t i = 0; i < frames.size(); i += step) {
    const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frames[i])].camera;
    for (int y = 0; y < kGrid; ++y) {
      for (int x = 0; x < kGrid; ++x) {
        const Pixel pixel((camera.width - 1.0) * x / (kGrid - 1), (camera.height - 1.0) * y / (kGrid - 1));
        const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(pixel));
        if (hit && hit->position.allFinite()) box.extend(hit->position);
      }
    }
  }
  return box;
}

}  // namespace

std::optional<Eigen::Vector3d> intersection(const Ray& ray, const Plane& plane) {
  const double along = plane.normal.dot(ray.direction);
  const double t = -plane.signedDistance(ray.origin) / along;
  if (!(t > 0) || !std::isfinite(t)) return {};
  return ray.at(t);
}

std::optional<Eigen::Vector3d> castPixel(const Camera& camera, const Surface& surface, const Pixel& pixel, double lift) {
  if (!pixel.allFinite()) return {};
  const Ray ray = camera.ray(pixel);
  const Outcome<SurfacePoint> hit = surface.firstHit(ray);
  if (!hit) return {};
  // Along the view ray, so that it still covers its own pixel; further at slanted incidence, to come as far off the surface.
  const double slant = std::max(0.3, std::abs(hit->normal.dot(ray.direction)));
  return hit->position - (lift / slant) * ray.direction;
}

std::vector<WorldChain> castContour(const Camera& camera, const Surface& surface, const Polyline& contour, double surfaceSize,
                                    double lift) {
  std::vector<WorldChain> chains(1);
  if (contour.points.size() < 2) return chains;
  std::vector<Pixel> pixels = contour.points;
  if (static_cast<int>(pixels.size()) > kMostContourPoints) pixels = resample(contour, kMostContourPoints);
  if (contour.closed) pixels.push_back(pixels.front());
  const double jump = 0.1 * surfaceSize;
  for (const Pixel& pixel : pixels) {
    const std::optional<Eigen::Vector3d> p = castPixel(camera, surface, pixel, lift);
    const bool breaks = !p || (!chains.back().empty() && (*p - chains.back().back()).norm() > jump);
    if (breaks && !chains.back().empty()) chains.emplace_back();
    if (p) chains.back().push_back(*p);
  }
  return chains;
}

std::vector<WorldChain> ellipseOnPlane(const Camera& camera, const Plane& plane, const Ellipse& ellipse, double lift) {
  std::vector<WorldChain> chains(1);
  std::vector<Pixel> pixels = ellipse.sample(96);
  pixels.push_back(pixels.front());
  for (const Pixel& pixel : pixels) {
    const Ray ray = camera.ray(pixel);
    const std::optional<Eigen::Vector3d> p = intersection(ray, plane);
    if (p) {
      chains.back().push_back(*p - lift / std::max(0.3, std::abs(plane.normal.dot(ray.direction))) * ray.direction);
    } else if (!chains.back().empty()) {
      chains.emplace_back();
    }
  }
  return chains;
}

double planeRadius(const Camera& camera, const Plane& plane, const Eigen::Vector3d& at, const std::vector<Pixel>& contour,
                   double surfaceSize, double times) {
  double radius = 0;
  for (const Pixel& pixel : contour) {
    if (!pixel.allFinite()) continue;
    const std::optional<Eigen::Vector3d> p = intersection(camera.ray(pixel), plane);
    if (p) radius = std::max(radius, (*p - at).norm());
  }
  return std::clamp(times * radius, 0.03 * surfaceSize, 0.35 * surfaceSize);
}

Eigen::AlignedBox3d shownRegion(const Inspection& inspection, const Surface& surface, const std::vector<int>& frames) {
  const Eigen::AlignedBox3d box = surface.bounds();
  return isFiniteBox(box) ? box : seenBy(inspection, surface, frames);
}

}  // namespace glint::draw
