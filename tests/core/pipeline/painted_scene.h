// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/pipeline/highlight_motion.h"
#include "core/synth/synth.h"
#include "tests/core/pipeline/exact_scene.h"

/// Pictures of a glossy surface with painted spots, from exact radiance: who painted knows which bright spots are paint.
namespace glint::testing_support {

struct Paint {
  Eigen::Vector3d at;    ///< on the surface
  double radius = 0.05;  ///< m: brightness exp(-(distance / radius)^2), from wherever it is seen
  double brightness = 1;
};

struct Painted {
  AnalyticSpec surface;
  std::vector<Camera> cameras;
  TrueLight lamp;
  bool lampOnCamera = false;            ///< the lamp's position is one of the camera frame
  std::vector<Eigen::Vector3d> lampIn;  ///< its position in each frame; empty = it stands still
  std::vector<Paint> paint;
  double roughness = 0.1;
  double gloss = 1.2;  ///< value of the highlight's brightest pixel in every frame
  double noise = 0;    ///< standard deviation per pixel
};

/// 320 x 240 camera.
inline Camera smallLookingAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  Camera c = lookingAt(eye, target);
  c.pixelFromRay << 400, 0, 159.5, 0, 400, 119.5, 0, 0, 1;
  c.width = 320;
  c.height = 240;
  return c;
}

/// Cameras on an arc of `degrees` around the z axis, at `height`.
inline std::vector<Camera> arc(int count, double degrees, double radius = 0.9, double height = 1.2) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double a = (static_cast<double>(i) / std::max(1, count - 1) - 0.5) * degrees * M_PI / 180 - M_PI / 2;
    cameras.push_back(smallLookingAt({radius * std::cos(a), radius * std::sin(a), height}, {0, 0, 0}));
  }
  return cameras;
}

inline Image picture(const Painted& p, std::size_t frame) {
  const std::shared_ptr<const Surface> surface = makeAnalytic(p.surface);
  const Camera& camera = p.cameras[frame];
  TrueLight lamp = p.lamp;
  if (!p.lampIn.empty()) lamp.lamp = lampAt(p.lampIn[frame]);
  if (p.lampOnCamera) lamp.lamp = lampAt(camera.camFromWorld.inverse() * p.lamp.lamp.position());
  Material material;
  material.roughness = p.roughness;
  Image image = renderRadiance(*surface, camera, {lamp}, material).specular;
  const float most = *std::max_element(image.data.begin(), image.data.end());
  for (float& v : image.data) v *= most > 0 ? static_cast<float>(p.gloss / most) : 0.f;
  for (int y = 0; y < image.height && !p.paint.empty(); ++y)
    for (int x = 0; x < image.width; ++x)
      if (const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(Pixel(x, y))))
        for (const Paint& spot : p.paint)
          image.at(x, y) +=
              static_cast<float>(spot.brightness * std::exp(-((hit->position - spot.at) / spot.radius).squaredNorm()));
  if (p.noise > 0) {
    std::mt19937 engine(static_cast<unsigned>(frame) + 1);
    std::normal_distribution<double> gauss(0, p.noise);
    for (float& v : image.data) v = std::max(0.f, v + static_cast<float>(gauss(engine)));
  }
  return image;
}

/// What detection and the judgement by motion say about the pictures.
struct Judged {
  Scene scene;
  std::vector<FrameEvidence> evidence;
  std::vector<std::vector<MotionVerdict>> verdicts;
  std::vector<std::vector<bool>> painted;  ///< truth: the middle of the contour lies on paint

  int count(bool paint, MotionVerdict::Kind kind) const {
    int n = 0;
    for (std::size_t f = 0; f < verdicts.size(); ++f)
      for (std::size_t i = 0; i < verdicts[f].size(); ++i) n += painted[f][i] == paint && verdicts[f][i].kind == kind;
    return n;
  }
  int all(bool paint) const {
    int n = 0;
    for (const std::vector<bool>& frame : painted) n += static_cast<int>(std::count(frame.begin(), frame.end(), paint));
    return n;
  }
};

/// @param asTold  cameras that the judgement is told instead of the true ones; empty = the true ones
inline Judged judged(const Painted& p, const std::vector<Camera>& asTold = {}, const AnalyticSpec* surfaceTold = nullptr) {
  Judged j;
  j.scene.surfaces["body"] = surfaceTold ? *surfaceTold : p.surface;
  const std::shared_ptr<const Surface> truth = makeAnalytic(p.surface);
  for (std::size_t f = 0; f < p.cameras.size(); ++f) {
    Frame frame;
    frame.id = std::to_string(f);
    frame.camera = asTold.empty() ? p.cameras[f] : asTold[f];
    frame.surface = "body";
    j.scene.frames.push_back(frame);
    FrameEvidence e;
    e.frame = static_cast<int>(f);
    DetectOptions options;
    if (Outcome<std::vector<Highlight>> found = detectHighlights(picture(p, f), nullptr, options))
      e.highlights = *std::move(found);
    else
      e.failure = found.failure();
    std::vector<bool> painted;
    for (const Highlight& h : e.highlights) {
      const Outcome<SurfacePoint> on = truth->firstHit(p.cameras[f].ray(centroid(h.contour)));
      painted.push_back(on && std::any_of(p.paint.begin(), p.paint.end(), [&](const Paint& spot) {
                          return (on->position - spot.at).norm() < 0.5 * spot.radius;
                        }));
    }
    j.painted.push_back(painted);
    j.evidence.push_back(std::move(e));
  }
  const SurfaceCache surfaces(j.scene);
  const std::vector<std::vector<int>> panels = motionPanels(j.scene, surfaces);
  const std::shared_ptr<const Surface> told = makeAnalytic(*j.scene.surfaces["body"].analytic());
  for (std::size_t f = 0; f < p.cameras.size(); ++f)
    j.verdicts.push_back(motionVerdicts(j.scene, static_cast<int>(f), panels[f], j.evidence, told.get(), Settings()));
  return j;
}

}  // namespace glint::testing_support
