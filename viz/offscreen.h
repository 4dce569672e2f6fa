// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "core/base/image.h"
#include "core/base/outcome.h"

namespace glint::viz {

class SceneView;

/// A private X server (Xvfb) for drawing without a screen: VTK as Debian ships it has no other way to draw 3D without a
/// display. Started with the object, ended with it; the server also ends when this process is killed in any way.
/// DISPLAY points to it meanwhile. One at a time; start and end it in the same thread, which must outlive it.
class VirtualDisplay {
 public:
  /// NotSupported if Xvfb is not installed or does not answer within 20 s; the detail says what to install.
  static Outcome<std::unique_ptr<VirtualDisplay>> start(int width, int height);
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
  const std::string& name() const { return name_; }  ///< ":99"
  int processId() const { return pid_; }

 private:
  VirtualDisplay() = default;
  std::string name_, previous_;
  bool hadPrevious_ = false;
  int pid_ = -1;
};

/// A window that is never shown. Uses a private virtual display, or the user's where Xvfb is missing and it can be opened.
/// Views may be rendered one after the other (turntables); a view must outlive its render call only.
class Offscreen {
 public:
  /// NotSupported as VirtualDisplay, or where the display cannot draw in 3D; std::invalid_argument unless 16 <= width, height <=
  /// 16384.
  static Outcome<std::unique_ptr<Offscreen>> create(int width, int height);
  /// The same on the display of this program. NotSupported if it has none that X programs can use. Interface thread only.
  static Outcome<std::unique_ptr<Offscreen>> onOwnDisplay(int width, int height);
  ~Offscreen();
  /// 3 channels, sRGB 0..1; with a transparent background 4, the last one opacity.
  Image render(const SceneView& view, bool transparent = false);

 private:
  Offscreen();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint::viz
