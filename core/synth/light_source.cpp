// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/light_source.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "core/surface/occlusion.h"

namespace glint {
namespace {

// Nodes and weights of Gauss-Legendre quadrature on [-1, 1], computed by Newton's method on the Legendre polynomial.
template <int N>
struct GaussLegendre {
  std::array<double, N> node{}, weight{};
  GaussLegendre() {
    for (int i = 0; i < N; ++i) {
      double x = std::cos(M_PI * (i + 0.75) / (N + 0.5)), slope = 1;
      for (int round = 0; round < 20; ++round) {
        double p0 = 1, p1 = x;
        for (int k = 2; k <= N; ++k) {
          const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
          p0 = p1;
          p1 = p2;
        }
        slope = N * (x * p1 - p0) / (x * x - 1);
        x -= p1 / slope;
      }
      node[static_cast<std::size_t>(i)] = x;
      weight[static_cast<std::size_t>(i)] = 2 / ((1 - x * x) * slope * slope);
    }
  }
};

constexpr int kAlong = 24, kAcross = 3;  // tube

template <int kRings, int kSpokes>
std::vector<LightSample> sampleSphere(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& point) {
  static const GaussLegendre<kRings> rule;
  const Eigen::Vector3d offset = centre - point;
  const double distance = offset.norm();
  if (distance <= radius) return {};
  const Eigen::Vector3d axis = offset / distance;
  const Eigen::Vector3d side = axis.unitOrthogonal(), up = axis.cross(side);
  const double sine = radius / distance, cap = sine * sine / (1 + std::sqrt(1 - sine * sine));  // 1 - cos of the cone
  const double intensity =
      2 * cap / (radius * radius);  // cone's solid angle over the sphere's cross-section: radiance 1 / (pi r^2)
  std::vector<LightSample> samples;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    const double rise = cap * 0.5 * (1 + rule.node[ring]), cosine = 1 - rise, across = std::sqrt(rise * (2 - rise));
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double t = 2 * M_PI * (spoke + 0.5 * static_cast<double>(ring % 2)) / kSpokes;
      LightSample s;
      s.direction = (cosine * axis + across * (std::cos(t) * side + std::sin(t) * up)).normalized();
      s.weight = intensity * 0.5 * rule.weight[ring] / kSpokes;
      s.target = point + (distance - radius) * s.direction;
      samples.push_back(s);
    }
  }
  return samples;
}

/// Errors of log I below 1e-7 down to a thousandth of the peak, to three lobe widths.
std::vector<LightSample> sampleSphere(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& point, double lobeWidth) {
  const double ratio = std::atan2(radius, (centre - point).norm()) / lobeWidth;
  if (ratio <= 0.5) return sampleSphere<4, 12>(centre, radius, point);
  if (ratio <= 1) return sampleSphere<8, 20>(centre, radius, point);
  if (ratio <= 2) return sampleSphere<12, 40>(centre, radius, point);
  return ratio <= 4 ? sampleSphere<24, 60>(centre, radius, point) : sampleSphere<36, 96>(centre, radius, point);
}

std::vector<LightSample> sampleTube(const std::array<Eigen::Vector3d, 2>& ends, double radius, const Eigen::Vector3d& point) {
  static const GaussLegendre<kAlong> along;
  static const GaussLegendre<kAcross> across;
  const Eigen::Vector3d axis = (ends[1] - ends[0]).normalized();
  std::vector<LightSample> samples;
  for (std::size_t i = 0; i < kAlong; ++i) {
    const double t = 0.5 * (1 + along.node[i]);
    const Eigen::Vector3d centre = ends[0] + t * (ends[1] - ends[0]);
    const Eigen::Vector3d offset = centre - point;
    const Eigen::Vector3d side = axis.cross(offset);
    const double distance = offset.norm(), sine = side.norm() / distance;
    if (!(distance > radius) || !(sine > 0)) continue;  // seen end on, a thin tube sends nothing
    for (std::size_t j = 0; j < (radius > 0 ? kAcross : 1); ++j) {
      const double shift = radius > 0 ? radius * across.node[j] : 0;
      LightSample s;
      const Eigen::Vector3d target = centre + shift * side.normalized(), to = target - point;
      s.target = target;
      s.direction = to.normalized();
      // Intensity of a thin cylinder, (4 / pi) sin(psi) averaged over all directions to 1.
      s.weight = 4 / M_PI * sine * 0.5 * along.weight[i] * (radius > 0 ? 0.5 * across.weight[j] : 1.0) / to.squaredNorm();
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
  std::vector<Sampled> result;
  // H turns by half of what L turns, and across the plane of incidence by more at slanted incidence.
  double lobeWidth = 2 * material.roughness;
  if (light.position) lobeWidth *= std::max(0.05, 0.5 * ((*light.position - p.position).normalized() + toCamera).norm());
  for (const LightSample& sample : sampleLight(light, p.position, lobeWidth)) {
    const double cosine = p.normal.dot(sample.direction);
    if (!(cosine > 0)) continue;
    if (surface.occluded(p, sample.target.value_or(beyondSurface(surface, p.position, sample.direction, distance)))) continue;
    result.push_back(
        {std::log(sample.weight), cosine, logRadiance(material.lobe, material.roughness, p.normal, sample.direction, toCamera)});
  }
  return result;
}

}  // namespace

std::vector<LightSample> sampleLight(const TrueLight& light, const Eigen::Vector3d& point, double lobeWidth) {
  if (light.segment) return sampleTube(*light.segment, light.radius, point);
  if (light.direction) return {{light.direction->normalized(), 1.0, std::nullopt}};
  require(light.position.has_value(), "sampleLight: a light needs a position, a direction or a segment");
  if (light.radius > 0) return sampleSphere(*light.position, light.radius, point, lobeWidth);
  const Eigen::Vector3d offset = *light.position - point;
  if (!(offset.squaredNorm() > 0)) return {};
  return {{offset.normalized(), 1 / offset.squaredNorm(), *light.position}};
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
