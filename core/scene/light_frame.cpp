// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/light_frame.h"

#include <algorithm>
#include <utility>

#include "core/geometry/transforms.h"
#include "core/scene/scene.h"

namespace glint {
namespace {

void keepLightsOf(Scene& scene, LightFrame frame) {
  std::erase_if(scene.lights, [&](const TrueLight& light) { return light.frame != frame; });
}

}  // namespace

const char* nameOf(LightFrame frame) { return frame == LightFrame::World ? "world" : "camera"; }

bool standsStill(const Frame& frame) { return isIdentity(frame.worldFromObject); }

bool standsStill(const Scene& scene) {
  return std::all_of(scene.frames.begin(), scene.frames.end(), [](const Frame& f) { return standsStill(f); });
}

Scene inObject(const Scene& scene) {
  Scene there = inWorld(scene);
  for (Frame& frame : there.frames) {
    frame.camera.camFromWorld = frame.camera.camFromWorld * frame.worldFromObject;
    frame.worldFromObject.setIdentity();
  }
  return there;
}

Scene inCameras(const Scene& scene) {
  Scene there = scene;
  keepLightsOf(there, LightFrame::Camera);
  for (Frame& frame : there.frames) {
    frame.worldFromObject = frame.camera.camFromWorld * frame.worldFromObject;
    frame.camera.camFromWorld.setIdentity();
  }
  return there;
}

Scene inWorld(Scene scene) {
  keepLightsOf(scene, LightFrame::World);
  return scene;
}

Scene inLightFrame(const Scene& scene, LightFrame frame) {
  return frame == LightFrame::Camera ? inCameras(scene) : inWorld(scene);
}

TrueLight inWorld(const TrueLight& light, const Frame& frame) {
  if (light.frame == LightFrame::World) return light;
  const Eigen::Isometry3d worldFromCamera = frame.camera.camFromWorld.inverse();
  return {light.id, transformed(light.lamp, 1, worldFromCamera.linear(), worldFromCamera.translation()), LightFrame::World};
}

}  // namespace glint
