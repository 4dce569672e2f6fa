// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/model/model.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/training.h"
#include "core/surface/analytic.h"
#include "core/synth/exact_highlight.h"
#include "tests/core/surface/surfaces.h"

/// Exact training views of analytic surfaces: contours are level sets of the limit angle, peaks are mirror points. Shared by
/// the tests of the models and the benchmarks.
namespace glint::test {

struct Synthetic {
  AnalyticSpec surface;
  std::vector<Camera> cameras;
  TrueLight light;
  double limitAngle = 6 * M_PI / 180;
  std::optional<Material> material;  ///< when set, contours are level sets of its radiance at half of the peak instead
};

inline Light lightOf(const TrueLight& light) { return glint::lightOf(light.lamp); }

inline TrueLight trueLampAt(const Eigen::Vector3d& position) {
  TrueLight light;
  light.id = "lamp";
  light.lamp = lampAt(position);
  return light;
}

/// n cameras on an arc above a gently bent sheet, each looking at where a plane would mirror the lamp.
inline Synthetic sheetScene(double curvature, int n = 6) {
  Synthetic s;
  s.surface = sheet(curvature);
  const Eigen::Vector3d lamp(0.3, 0.2, 2.0);
  for (int i = 0; i < n; ++i) {
    const double a = -0.45 + 0.9 * i / std::max(1, n - 1);
    const Eigen::Vector3d eye(1.7 * std::sin(a), -0.4 + 0.6 * std::cos(5 * a), 1.7 * std::cos(a));
    const Eigen::Vector3d mirror = (lamp.z() * eye + eye.z() * lamp) / (lamp.z() + eye.z());
    s.cameras.push_back(lookAt(eye, {0.7 * mirror.x(), mirror.y(), 0}));
  }
  s.light = trueLampAt(lamp);
  return s;
}

/// n cameras on three eighths of a circle around an ellipsoid of 0.6 x 0.35 x 0.25 m.
inline Synthetic ellipsoidScene(int n = 6) {
  Synthetic s;
  s.surface = ellipsoid(0.6, 0.35, 0.25);
  for (int i = 0; i < n; ++i) {
    const double a = -2.2 + 2.4 * i / std::max(1, n - 1);
    s.cameras.push_back(lookAt({2 * std::cos(a), 2 * std::sin(a), 0.9 + 0.3 * std::sin(a)}, {0, 0, 0}));
  }
  s.light = trueLampAt({1.2, -1.0, 2.2});
  return s;
}

/// The same scene seen after x -> scale (motion x) of everything.
inline Synthetic moved(Synthetic s, const Eigen::Isometry3d& motion, double scale) {
  const auto point = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(scale * (motion * x)); };
  s.surface.semiAxes *= scale;
  s.surface.radius *= scale;
  s.surface.curvature /= scale;
  if (s.surface.length) *s.surface.length *= scale;
  if (s.surface.width) *s.surface.width *= scale;
  s.surface.worldFromSurface = motion * s.surface.worldFromSurface;
  s.surface.worldFromSurface.translation() *= scale;
  for (Camera& c : s.cameras) {
    const Eigen::Vector3d eye = point(c.centreInWorld());
    c.camFromWorld.linear() = c.camFromWorld.linear() * motion.linear().transpose();
    c.camFromWorld.translation() = -c.camFromWorld.linear() * eye;
  }
  s.light.lamp = transformed(s.light.lamp, scale, motion.linear(), scale * motion.translation());
  return s;
}

inline std::vector<Highlight> exactHighlightsOf(const Synthetic& s, const Camera& camera) {
  ExactOptions options;
  options.kind = ContourKind::LimitAngle;
  options.limitAngle = s.limitAngle;
  if (s.material) options.kind = ContourKind::Radiance;
  const Outcome<std::vector<Highlight>> found =
      exactHighlights(*makeAnalytic(s.surface), camera, s.light, s.material.value_or(Material{}), options);
  if (!found) throw std::runtime_error("exact highlight: " + found.failure().message());
  std::vector<Highlight> highlights = *found;
  for (Highlight& h : highlights) {
    h.light = s.light.id;
    if (!h.ellipse)
      if (const Outcome<Ellipse> e = fitEllipse(h.contour.points)) h.ellipse = *e;
  }
  return highlights;
}

/// Views of the cameras, the light from them, and their canonical contours.
inline FitInput fitInput(const Synthetic& s, const Settings& settings) {
  FitInput input;
  const std::shared_ptr<const Surface> surface = makeAnalytic(s.surface);
  for (std::size_t i = 0; i < s.cameras.size(); ++i) {
    FrameEvidence evidence;
    evidence.frame = static_cast<int>(i);
    evidence.highlights = exactHighlightsOf(s, s.cameras[i]);
    input.views.push_back(trainingView(evidence, 0, s.cameras[i], surface));
  }
  const Outcome<LightEstimate> light = estimateLight(input.views, settings);
  if (light) {
    input.light = *light;
    for (TrainingView& v : input.views) addCanonicalContour(v, light->light, settings);
  } else {
    input.lightFailure = light.failure();
  }
  return input;
}

}  // namespace glint::test
