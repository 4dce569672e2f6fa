// SPDX-License-Identifier: BSD-3-Clause
#include "viz/offscreen.h"

#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "viz/convert.h"
#include "viz/display_connection.h"
#include "viz/scene_view.h"
#include "viz/text_lock.h"

namespace glint::viz {

void prepareWindow(vtkRenderWindow* window) {
  window->SetAlphaBitPlanes(1);
  window->SetMultiSamples(0);
}

struct Offscreen::Impl {
  std::unique_ptr<VirtualDisplay> display;  // declared first: ended after the window
  std::unique_ptr<DisplayConnection> connection;
  vtkSmartPointer<vtkRenderWindow> window;
};

Offscreen::Offscreen() : impl_(std::make_unique<Impl>()) {}

Offscreen::~Offscreen() {
  if (impl_->window) impl_->window->Finalize();
  impl_->window = nullptr;
}

namespace {
void requireSize(int width, int height) {
  require(width >= 16 && height >= 16 && width <= 16384 && height <= 16384,
          "Offscreen: size must be between 16 and 16384 pixels");
}

vtkSmartPointer<vtkRenderWindow> hiddenWindow(int width, int height) {
  vtkSmartPointer<vtkRenderWindow> window = vtkSmartPointer<vtkRenderWindow>::New();
  prepareWindow(window);
  window->SetShowWindow(false);
  window->SetOffScreenRendering(1);
  window->SetSize(width, height);
  return window;
}

/// VTK itself would end the program where it finds no display or no GLX.
Outcome<std::unique_ptr<DisplayConnection>> displayFor3D() {
  Outcome<std::unique_ptr<DisplayConnection>> connection = DisplayConnection::open();
  if (connection && !(*connection)->has("GLX"))
    return Failure{Reason::NotSupported,
                   "the display '" + std::string(std::getenv("DISPLAY")) + "' cannot draw 3D: it has no GLX"};
  return connection;
}

/// The picture over one background.
Image pictureOver(vtkRenderer* renderer, vtkRenderWindow* window, double grey) {
  renderer->SetBackground(grey, grey, grey);
  viz::render(window);
  return pictureOf(window);
}

/// Opacity and colour from the same picture over black and over white: c a and c a + (1 - a). What the graphics card leaves in
/// its own opacity channel is wrong where translucent things overlap.
Image withOpacity(const Image& black, const Image& white) {
  Image out(black.width, black.height, 4);
  for (int y = 0; y < black.height; ++y)
    for (int x = 0; x < black.width; ++x) {
      float through = 0;
      for (int c = 0; c < 3; ++c) through += (white.at(x, y, c) - black.at(x, y, c)) / 3;
      const float opacity = std::clamp(1 - through, 0.f, 1.f);
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = opacity > 0 ? std::min(1.f, black.at(x, y, c) / opacity) : 0.f;
      out.at(x, y, 3) = opacity;
    }
  return out;
}
}  // namespace

Outcome<std::unique_ptr<Offscreen>> Offscreen::onOwnDisplay(int width, int height) {
  requireSize(width, height);
  Outcome<std::unique_ptr<DisplayConnection>> connection = displayFor3D();
  if (!connection) return connection.failure();
  std::unique_ptr<Offscreen> result(new Offscreen);
  result->impl_->connection = std::move(*connection);
  result->impl_->window = hiddenWindow(width, height);
  return result;
}

Outcome<std::unique_ptr<Offscreen>> Offscreen::create(int width, int height) {
  requireSize(width, height);
  std::unique_ptr<Offscreen> result(new Offscreen);
  Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(width, height);
  if (display) {
    result->impl_->display = std::move(*display);
  } else {
    const char* users = std::getenv("DISPLAY");
    if (!users || !*users) return display.failure();
  }
  Outcome<std::unique_ptr<DisplayConnection>> connection = displayFor3D();
  if (!connection) {
    if (display) return connection.failure();
    return Failure{Reason::NotSupported, connection.failure().detail + ", and " + display.failure().detail};
  }
  result->impl_->connection = std::move(*connection);
  result->impl_->window = hiddenWindow(width, height);
  return result;
}

Image Offscreen::render(const SceneView& view, bool transparent) {
  vtkRenderWindow* window = impl_->window;
  vtkRenderer* renderer = view.renderer();
  window->AddRenderer(renderer);
  Image image;
  if (transparent) {
    std::array<double, 3> before{};
    renderer->GetBackground(before.data());
    const Image black = pictureOver(renderer, window, 0);
    image = withOpacity(black, pictureOver(renderer, window, 1));
    renderer->SetBackground(before.data());
  } else {
    viz::render(window);
    image = pictureOf(window);
  }
  window->RemoveRenderer(view.renderer());
  return image;
}

}  // namespace glint::viz
