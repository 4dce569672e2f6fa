// SPDX-License-Identifier: BSD-3-Clause
#include "viz/offscreen.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkWindowToImageFilter.h>

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

namespace {
void requireSize(int width, int height) {
  require(width >= 16 && height >= 16 && width <= 16384 && height <= 16384, "Offscreen: size must be within 16 and 16384 pixels");
}

vtkSmartPointer<vtkRenderWindow> hiddenWindow(int width, int height) {
  vtkSmartPointer<vtkRenderWindow> window = vtkSmartPointer<vtkRenderWindow>::New();
  prepareWindow(window);
  window->SetShowWindow(false);
  window->SetOffScreenRendering(1);
  window->SetSize(width, height);
  return window;
}

/// 4 channels, top row first.
Image pictureWithOpacityOf(vtkRenderWindow* window) {
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->SetInputBufferTypeToRGBA();
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  grab->Update();
  vtkImageData* pixels = grab->GetOutput();
  const int* size = pixels->GetDimensions();
  Image out(size[0], size[1], 4);
  const auto* bytes = static_cast<const unsigned char*>(pixels->GetScalarPointer());
  const std::size_t row = 4 * static_cast<std::size_t>(size[0]);
  for (int y = 0; y < size[1]; ++y)
    for (std::size_t i = 0; i < row; ++i)
      out.data[static_cast<std::size_t>(y) * row + i] = float(bytes[static_cast<std::size_t>(size[1] - 1 - y) * row + i]) / 255.f;
  return out;
}
}  // namespace

std::unique_ptr<Offscreen> Offscreen::onOwnDisplay(int width, int height) {
  requireSize(width, height);
  std::unique_ptr<Offscreen> result(new Offscreen);
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
  result->impl_->window = hiddenWindow(width, height);
  return result;
}

Image Offscreen::render(const SceneView& view, bool transparent) {
  vtkRenderWindow* window = impl_->window;
  const double before = view.renderer()->GetBackgroundAlpha();
  view.renderer()->SetBackgroundAlpha(transparent ? 0 : 1);
  window->AddRenderer(view.renderer());
  window->Render();
  Image image = transparent ? pictureWithOpacityOf(window) : pictureOf(window);
  view.renderer()->SetBackgroundAlpha(before);
  window->RemoveRenderer(view.renderer());
  return image;
}

Outcome<Image> renderOffscreen(const SceneView& view, int width, int height) {
  Outcome<std::unique_ptr<Offscreen>> target = Offscreen::create(width, height);
  if (!target) return target.failure();
  return (*target)->render(view);
}

}  // namespace glint::viz
