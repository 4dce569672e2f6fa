// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint {

struct Frame;
struct Scene;
struct TrueLight;

/// In what a light stands still (method.md section 16).
enum class LightFrame { World, Camera };
const char* nameOf(LightFrame frame);  ///< "world", "camera"

/// Whether the frame's surface is where the scene file's own coordinates have it.
bool standsStill(const Frame& frame);
bool standsStill(const Scene& scene);

/// The same views in the coordinates of the object: the surface rests, and cameras move around it. For questions that paint
/// answers, which moves with the object.
Scene inObject(const Scene& scene);
/// The same views in the coordinates of each frame's camera: cameras rest, the surface moves. A light that moves with the camera
/// stands still there. Keeps the true lights of that frame alone, as inWorld() does.
Scene inCameras(const Scene& scene);
/// The scene itself with the lights that stand still in the world.
Scene inWorld(Scene scene);
/// The scene in the coordinates in which these lights stand still.
Scene inLightFrame(const Scene& scene, LightFrame frame);

/// A true light in the world of a frame.
TrueLight inWorld(const TrueLight& light, const Frame& frame);

}  // namespace glint
