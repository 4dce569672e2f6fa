// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/vtk_canvas.h"

#include <QVTKInteractor.h>
#include <QVTKRenderWindowAdapter.h>
#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLState.h>

#include <QBackingStore>
#include <QEvent>
#include <QOpenGLFunctions>
#include <QPaintEngine>
#include <QPainter>

#include "gui/base/draw_turns.h"
#include "gui/base/focus_frame.h"
#include "viz/text_lock.h"

namespace glint::gui {

VtkCanvas::VtkCanvas(QWidget* parent) : QWidget(parent) {
  setAttribute(Qt::WA_OpaquePaintEvent);
  setFocusPolicy(Qt::StrongFocus);
  new FocusFrame(this);
  setMouseTracking(true);
  grabGesture(Qt::PinchGesture);
  window_->SetReadyForRendering(false);  // until there is a context
  vtkNew<QVTKInteractor> interactor;
  window_->SetInteractor(interactor);
  interactor->Initialize();
  onFrame_->SetClientData(this);
  onFrame_->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
    auto* self = static_cast<VtkCanvas*>(data);
    self->drawn_ = true;
    self->drawnFor_ = self->fitted_;
    self->drawnRatio_ = self->fittedRatio_;
    if (!self->painting_) self->update();
  });
  window_->AddObserver(vtkCommand::WindowFrameEvent, onFrame_);
}

VtkCanvas::~VtkCanvas() {
  window_->RemoveObserver(onFrame_);
  if (adapter_ && context_.makeCurrent(&surface_)) {
    adapter_.reset();  // releases VTK's resources in the context that holds them
    context_.doneCurrent();
  }
}

bool VtkCanvas::prepare() {
  if (adapter_) return true;
  if (failed_) return false;
  const QSurfaceFormat format = QVTKRenderWindowAdapter::defaultFormat();
  context_.setFormat(format);
  surface_.setFormat(format);
  surface_.create();
  failed_ = !context_.create() || !context_.makeCurrent(&surface_);
  if (failed_) return false;
  // VTK takes the context's state as it finds it, and what it draws flat over the scene lies at one depth: with OpenGL's own
  // "less", the first of it would hide all that comes after (a photograph its captions).
  context_.functions()->glDepthFunc(GL_LEQUAL);
  adapter_ = std::make_unique<QVTKRenderWindowAdapter>(&context_, window_, this);
  adapter_->setEnableHiDPI(true);
  adapter_->setUnscaledDPI(72);
  fitWindow();
  return true;
}

void VtkCanvas::fitWindow() {
  if (!adapter_ || (fitted_ == size() && fittedRatio_ == devicePixelRatioF())) return;
  fitted_ = size();
  fittedRatio_ = devicePixelRatioF();
  adapter_->resize(width(), height());
}

/// What the window shows, with its first row on top.
void VtkCanvas::fetch() {
  drawn_ = false;
  const QSize size(window_->GetSize()[0], window_->GetSize()[1]);
  vtkOpenGLFramebufferObject* resolved = window_->GetDisplayFramebuffer();
  if (size.isEmpty() || !resolved || !context_.makeCurrent(&surface_)) return;
  window_->GetState()->PushReadFramebufferBinding();
  resolved->Bind(GL_READ_FRAMEBUFFER);
  resolved->ActivateReadBuffer(0);
  if (picture_.size() != size) picture_ = QImage(size, QImage::Format_RGB32);
  QOpenGLFunctions* gl = context_.functions();
  gl->glPixelStorei(GL_PACK_ALIGNMENT, 4);
  gl->glReadPixels(0, 0, size.width(), size.height(), GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, picture_.bits());
  window_->GetState()->PopReadFramebufferBinding();
  picture_ = std::move(picture_).mirrored();
}

bool VtkCanvas::event(QEvent* event) {
  if (adapter_) adapter_->handleEvent(event);
  return QWidget::event(event);
}

void VtkCanvas::resizeEvent(QResizeEvent*) { fitWindow(); }

bool VtkCanvas::upToDate() const { return drawnFor_ == size() && drawnRatio_ == devicePixelRatioF(); }

void VtkCanvas::renderNow() {
  if (prepare()) viz::render(window_);
}

void VtkCanvas::drawNext() {
  if (!isVisible()) return;
  if (!ready()) {
    prepare();  // takes as long as a picture: the first one comes in another turn
    update();
  } else if (!upToDate()) {
    viz::render(window_);
  }
}

void VtkCanvas::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  fitWindow();
  // What is grabbed is wanted now; the screen has time, and other views want to draw as well.
  // A store that was never painted into has no device: Qt reads it all the same where the screen is scaled.
  QBackingStore* store = backingStore();
  const bool onScreen = store && !store->size().isEmpty() && painter.paintEngine()->paintDevice() == store->paintDevice();
  if (onScreen && !failed_ && !upToDate()) {
    drawInTurn(this, [this] { drawNext(); });
  } else if (prepare() && !upToDate()) {
    painting_ = true;
    viz::render(window_);
    painting_ = false;
  }
  if (drawn_) fetch();
  if (picture_.isNull() || failed_)
    painter.fillRect(rect(), palette().window());
  else
    painter.drawImage(rect(), picture_);
  if (failed_)
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap,
                     tr("This view needs OpenGL 3.2, which this display does not support."));
}

}  // namespace glint::gui
