// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <stdexcept>

#include "core/geometry/polyline.h"
#include "core/reflectance/fit.h"
#include "tests/core/model/exact_views.h"

/// Contours of known light and roughness: level sets of the radiance itself, traced on analytic surfaces.
namespace glint::test {

/// Contours are chords within 2e-3 px of the level set (their sagitta); on highlights some 50 px wide that leaves a few 1e-5 of
/// the roughness, and of the light's position over its distance.
inline constexpr double kRecovered = 3e-4;

inline const std::vector<Lobe> kMicrofacets{Lobe::TorranceSparrow, Lobe::Ggx};

struct RadianceScene {
  Synthetic geometry;
  Material material;
  double level = 0.5;
  std::shared_ptr<const Surface> surface;
};

inline RadianceScene radianceScene(Synthetic geometry, Lobe lobe, double roughness) {
  RadianceScene s;
  s.surface = makeAnalytic(geometry.surface);
  s.geometry = std::move(geometry);
  s.material.lobe = lobe;
  s.material.roughness = roughness;
  return s;
}

/// @param noisePx  independent Gaussian noise per coordinate on 72 points, as --noise-px adds it.
inline std::vector<RadianceView> radianceViews(const RadianceScene& s, double noisePx = 0, unsigned seed = 1) {
  std::vector<RadianceView> views;
  for (std::size_t i = 0; i < s.geometry.cameras.size(); ++i) {
    ExactOptions options;
    options.level = s.level;
    const auto found = exactHighlights(*s.surface, s.geometry.cameras[i], s.geometry.light, s.material, options);
    if (!found) throw std::runtime_error("exact highlight: " + found.failure().message());
    const Highlight& h = found->front();
    RadianceView v{static_cast<int>(i), s.geometry.cameras[i], s.surface.get(), h.contour.points, h.peak, s.level};
    if (noisePx > 0) {
      std::mt19937_64 engine(1000 * seed + static_cast<unsigned>(i));
      std::normal_distribution<double> gauss(0, noisePx);
      v.contour = resample(h.contour, 72);
      for (Pixel& p : v.contour) p += Pixel(gauss(engine), gauss(engine));
    }
    views.push_back(std::move(v));
  }
  return views;
}

/// Distance of the light from the true one, over that one's distance from the origin.
inline double lightError(const RadianceFit& fit, const RadianceScene& s) {
  const Eigen::Vector3d truth = s.geometry.light.lamp.position();
  return (fit.light().position() - truth).norm() / truth.norm();
}

}  // namespace glint::test
