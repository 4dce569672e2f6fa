// SPDX-License-Identifier: BSD-3-Clause
#include "viz/offscreen.h"

#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <cstdlib>

#include "viz/convert.h"
#include "viz/scene_view.h"

namespace glint::viz {

struct Offscreen::Impl {
  std::unique_ptr<VirtualDisplay> display;  // declared first: ended after the window
  vtkSmartPointer<vtkRenderWindow> window;
};

Offscreen::Offscreen() : impl_(std::make_unique<Impl>()) {}

Offscreen::~Offscreen() {
  if (impl_->window) impl_->window->Finalize();
  impl_->window = nullptr;
}

Outcome<std::unique_ptr<Offscreen>> Offscreen::create(int width, int height) {
  require(width >= 16 && height >= 16 && width <= 16384 && height <= 16384, "Offscreen: size must be within 16 and 16384 pixels");
  std::unique_ptr<Offscreen> result(new Offscreen);
  Outcome<std::unique_ptr<VirtualDisplay>> display = VirtualDisplay::start(width, height);
  if (display) {
    result->impl_->display = std::move(*display);
  } else {
    const char* users = std::getenv("DISPLAY");
    if (!users || !*users) return display.failure();
  }
  vtkSmartPointer<vtkRenderWindow> window = vtkSmartPointer<vtkRenderWindow>::New();
  prepareWindow(window);
  window->SetShowWindow(false);
  window->SetOffScreenRendering(1);
  window->SetSize(width, height);
  result->impl_->window = window;
  return result;
}

Image Offscreen::render(const SceneView& view) {
  vtkRenderWindow* window = impl_->window;
  window->AddRenderer(view.renderer());
  window->Render();
  Image image = pictureOf(window);
  window->RemoveRenderer(view.renderer());
  return image;
}

Outcome<Image> renderOffscreen(const SceneView& view, int width, int height) {
  Outcome<std::unique_ptr<Offscreen>> target = Offscreen::create(width, height);
  if (!target) return target.failure();
  return (*target)->render(view);
}

}  // namespace glint::viz
