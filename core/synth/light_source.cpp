// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/light_source.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/numeric.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr int kAlong = 24, kAcross = 3;  // tube

/// A cone of directions: `rings` nodes of the cosine times equal steps around.
std::vector<LightSample> sampleSphere(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& point,
                                      const std::vector<QuadratureNode>& rings, int spokes) {
  const Eigen::Vector3d offset = centre - point;
  const double distance = offset.norm();
  if (distance <= radius) return {};
  const Eigen::Vector3d axis = offset / distance;
  const Eigen::Vector3d side = axis.unitOrthogonal(), up = axis.cross(side);
  const double sine = radius / distance, cap = sine * sine / (1 + std::sqrt(1 - sine * sine));  // 1 - cos of the cone
  const double intensity =
      2 * cap / (radius * radius);  // cone's solid angle over the sphere's cross-section: radiance 1 / (pi r^2)
  std::vector<LightSample> samples;
  for (std::size_t ring = 0; ring < rings.size(); ++ring) {
    const double rise = cap * 0.5 * (1 + rings[ring].x), cosine = 1 - rise, across = std::sqrt(rise * (2 - rise));
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double t = 2 * M_PI * (spoke + 0.5 * static_cast<double>(ring % 2)) / spokes;
      LightSample s;
      s.direction = (cosine * axis + across * (std::cos(t) * side + std::sin(t) * up)).normalized();
      s.weight = intensity * 0.5 * rings[ring].weight / spokes;
      s.target = point + (distance - radius) * s.direction;
      samples.push_back(s);
    }
  }
  return samples;
}

/// A rule whose errors of log I are below 1e-7 down to a thousandth of the peak, for lamps of up to three lobe widths.
std::vector<LightSample> samplesOf(const SphereShape<>& sphere, const Eigen::Vector3d& centre, const Eigen::Vector3d& point,
                                   double lobeWidth) {
  const double radius = sphere.reach();
  const double ratio = std::atan2(radius, (centre - point).norm()) / lobeWidth;
  struct Rung {
    double ratio;  // largest that the rule serves
    std::vector<QuadratureNode> rings;
    int spokes;
  };
  static const std::vector<Rung> ladder{{0.05, gaussLegendre(2), 6}, {0.5, gaussLegendre(4), 12}, {1, gaussLegendre(8), 20},
                                        {2, gaussLegendre(12), 40},  {4, gaussLegendre(24), 60},  {0, gaussLegendre(36), 96}};
  const auto rung = std::find_if(ladder.begin(), ladder.end() - 1, [&](const Rung& r) { return ratio <= r.ratio; });
  return sampleSphere(centre, radius, point, rung->rings, rung->spokes);
}

std::vector<LightSample> samplesOf(const PointShape<>&, const Eigen::Vector3d& centre, const Eigen::Vector3d& point, double) {
  const Eigen::Vector3d offset = centre - point;
  if (!(offset.squaredNorm() > 0)) return {};
  return {{offset.normalized(), 1 / offset.squaredNorm(), centre}};
}

std::vector<LightSample> samplesOf(const SegmentShape<>& tube, const Eigen::Vector3d& middle, const Eigen::Vector3d& point,
                                   double) {
  const double radius = tube.radius;
  const std::array<Eigen::Vector3d, 2> ends{middle - tube.halfAxis, middle + tube.halfAxis};
  static const std::vector<QuadratureNode> along = gaussLegendre(kAlong), across = gaussLegendre(kAcross);
  const Eigen::Vector3d axis = (ends[1] - ends[0]).normalized();
  std::vector<LightSample> samples;
  for (std::size_t i = 0; i < kAlong; ++i) {
    const double t = 0.5 * (1 + along[i].x);
    const Eigen::Vector3d centre = ends[0] + t * (ends[1] - ends[0]);
    const Eigen::Vector3d offset = centre - point;
    const Eigen::Vector3d side = axis.cross(offset);
    const double distance = offset.norm(), sine = side.norm() / distance;
    if (!(distance > radius) || !(sine > 0)) continue;  // seen end on, a thin tube sends nothing
    for (std::size_t j = 0; j < (radius > 0 ? kAcross : 1); ++j) {
      const double shift = radius > 0 ? radius * across[j].x : 0;
      LightSample s;
      const Eigen::Vector3d target = centre + shift * side.normalized(), to = target - point;
      s.target = target;
      s.direction = to.normalized();
      // Intensity of a thin cylinder, (4 / pi) sin(psi) averaged over all directions to 1.
      s.weight = 4 / M_PI * sine * 0.5 * along[i].weight * (radius > 0 ? 0.5 * across[j].weight : 1.0) / to.squaredNorm();
      samples.push_back(s);
    }
  }
  return samples;
}

struct Sampled {
  double logWeight;  // log of the irradiance weight
  double cosine;     // N.L
  std::optional<LogRadiance> lobe;
};

/// The samples of a light that reach the point.
std::vector<Sampled> reaching(const Surface& surface, const SurfacePoint& p, const Eigen::Vector3d& eye, const TrueLight& light,
                              const Material& material) {
  const double distance = (eye - p.position).norm();
  const Eigen::Vector3d toCamera = (eye - p.position) / distance;
  const LobeAxes axes = axesAt(material.lobe, surface, p);
  std::vector<Sampled> result;
  // H turns by half as much as L, and by more across the plane of incidence at slanted incidence.
  double lobeWidth = 2 * material.roughness;
  if (!light.lamp.atInfinity())
    lobeWidth *= std::max(0.05, 0.5 * ((light.lamp.position() - p.position).normalized() + toCamera).norm());
  for (const LightSample& sample : sampleLight(light.lamp, p.position, lobeWidth)) {
    const double cosine = p.normal.dot(sample.direction);
    if (!(cosine > 0)) continue;
    if (surface.occluded(p, sample.target.value_or(beyondSurface(surface, p.position, sample.direction, distance)))) continue;
    result.push_back(
        {std::log(sample.weight), cosine, logRadiance(material.lobe, material.roughness, axes, sample.direction, toCamera)});
  }
  return result;
}

}  // namespace

std::vector<LightSample> sampleLight(const Lamp& lamp, const Eigen::Vector3d& point, double lobeWidth) {
  if (lamp.atInfinity()) return {{lamp.centre.head<3>(), 1.0, std::nullopt}};
  const Eigen::Vector3d centre = lamp.position();
  return std::visit([&](const auto& shape) { return samplesOf(shape, centre, point, lobeWidth); }, lamp.shape);
}

Shading shade(const Surface& surface, const SurfacePoint& point, const Eigen::Vector3d& eye, const TrueLight& light,
              const Material& material) {
  const SurfacePoint p = facing(point, eye);
  Shading shading;
  for (const Sampled& s : reaching(surface, p, eye, light, material)) {
    shading.diffuse += std::exp(s.logWeight) * s.cosine / M_PI;
    if (s.lobe) shading.specular += material.specular * std::exp(s.logWeight + s.lobe->total());
  }
  return shading;
}

std::optional<double> logSpecular(const Surface& surface, const Camera& camera, const Pixel& pixel, const TrueLight& light,
                                  const Material& material) {
  const Ray ray = camera.ray(pixel);
  const Outcome<SurfacePoint> hit = surface.firstHit(ray);
  if (!hit) return std::nullopt;
  const SurfacePoint p = facing(*hit, ray.origin);
  double top = -std::numeric_limits<double>::infinity();
  std::vector<double> logs;
  for (const Sampled& s : reaching(surface, p, ray.origin, light, material)) {
    if (!s.lobe) continue;
    logs.push_back(s.logWeight + s.lobe->total());
    top = std::max(top, logs.back());
  }
  if (logs.empty()) return std::nullopt;
  double sum = 0;
  for (const double v : logs) sum += std::exp(v - top);
  return std::log(material.specular) + top + std::log(sum);
}

}  // namespace glint
