// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/synth/exact_highlight.h"

namespace glint::testing_support {

/// 640 x 480 camera at `eye`, looking at `target`; image up is world +z.
inline Camera lookingAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  Camera c;
  c.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
  c.width = 640;
  c.height = 480;
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d r;
  r << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  c.camFromWorld.linear() = r;
  c.camFromWorld.translation() = -r * eye;
  return c;
}

struct NamedLight {
  std::string id;
  Eigen::Vector3d position;
};

constexpr double kLimitAngle = 0.06;  // rad: contours of about 100 px at these distances, whole inside the image

inline AnalyticSpec sheet(double curvature) {
  AnalyticSpec spec;
  spec.type = "sheet";
  spec.curvature = curvature;
  return spec;
}

inline AnalyticSpec sphere(double radius) {
  AnalyticSpec spec;
  spec.type = "sphere";
  spec.radius = radius;
  spec.worldFromSurface.translation() = Eigen::Vector3d(0, 0, -radius);
  return spec;
}

inline std::vector<Highlight> exactContours(const AnalyticSpec& spec, const Camera& camera, const NamedLight& light,
                                            double limitAngle = kLimitAngle) {
  TrueLight truth;
  truth.id = light.id;
  truth.lamp = lampAt(light.position);
  ExactOptions options;
  options.kind = ContourKind::LimitAngle;
  options.limitAngle = limitAngle;
  options.sagittaPx = 5e-3;
  options.marginPx = 300;  // whole contours, even beyond the image
  const Outcome<std::vector<Highlight>> found = exactHighlights(*makeAnalytic(spec), camera, truth, Material{}, options);
  if (!found) return {};
  std::vector<Highlight> highlights = *found;
  for (Highlight& h : highlights) {
    h.light = light.id;
    h.fromScene = true;
  }
  return highlights;
}

/// Touches the plane z = 0 from below.
inline AnalyticSpec cylinder(double radius) {
  AnalyticSpec spec;
  spec.type = "cylinder";
  spec.radius = radius;
  spec.worldFromSurface.translation() = Eigen::Vector3d(0, 0, -radius);
  return spec;
}

/// Cameras on an arc above a surface that touches the plane z = 0 at the origin, exact contours of alpha = kLimitAngle given
/// with every frame. `on(frame)` lists the lights that are on; those alone have contours.
template <class On>
std::shared_ptr<Scene> exactScene(const AnalyticSpec& spec, const std::vector<NamedLight>& lights, int frames, const On& on) {
  auto scene = std::make_shared<Scene>();
  scene->name = "exact";
  scene->surfaces["body"] = spec;
  for (int i = 0; i < frames; ++i) {
    Frame f;
    f.id = "v" + std::to_string(i);
    const double a = 2.0 * std::numbers::pi * i / frames;
    f.camera = lookingAt({0.5 * std::cos(a), 0.5 * std::sin(a) - 0.3, 1.5 + 0.2 * std::cos(3 * a)}, {0, 0, 0});
    f.surface = "body";
    f.lightsOn = on(i);
    for (const NamedLight& light : lights)
      if (std::find(f.lightsOn.begin(), f.lightsOn.end(), light.id) != f.lightsOn.end())
        for (Highlight& h : exactContours(spec, f.camera, light)) f.highlights.push_back(std::move(h));
    scene->frames.push_back(std::move(f));
  }
  return scene;
}

inline std::shared_ptr<Scene> exactScene(const AnalyticSpec& spec, int frames) {
  return exactScene(spec, {{"lamp", {0.1, 0.2, 1.4}}}, frames, [](int) { return std::vector<std::string>{"lamp"}; });
}

/// The place of a flash, in the coordinates of its camera.
const Eigen::Vector3d kFlashInCamera(0.05, -0.02, 0.01);

/// exactScene whose lamp is on the camera: its place in the world is another one for every frame.
inline std::shared_ptr<Scene> flashLitScene(const AnalyticSpec& spec, int frames) {
  const auto scene = exactScene(spec, frames);
  for (Frame& f : scene->frames)
    f.highlights = exactContours(spec, f.camera, {"lamp", f.camera.camFromWorld.inverse() * kFlashInCamera});
  return scene;
}

/// exactScene with a lamp that the scene states; the contours are of the lights of exactScene.
inline std::shared_ptr<Scene> litScene(const AnalyticSpec& surface, int frames) {
  const auto scene = exactScene(surface, frames);
  TrueLight light;
  light.id = "lamp";
  light.lamp = lampAt(Eigen::Vector3d(0.1, 0.2, 1.4));
  scene->lights = {light};
  return scene;
}

}  // namespace glint::testing_support
