// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/vtk_canvas.h"

#include <QVTKInteractor.h>
#include <QVTKRenderWindowAdapter.h>
#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>

#include <QEvent>
#include <QOpenGLFramebufferObject>
#include <QOpenGLFunctions>
#include <QPainter>

#include "gui/base/focus_frame.h"

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
    if (!self->painting_) self->update();
  });
  window_->AddObserver(vtkCommand::WindowFrameEvent, onFrame_);
}

VtkCanvas::~VtkCanvas() {
  window_->RemoveObserver(onFrame_);
  if (adapter_ && context_.makeCurrent(&surface_)) {
    buffer_.reset();
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
  adapter_->setEnableHiDPI(textScaled_);
  adapter_->setUnscaledDPI(72);
  return true;
}

/// What the window holds, with its first row on top.
void VtkCanvas::fetch() {
  drawn_ = false;
  const QSize size(window_->GetSize()[0], window_->GetSize()[1]);
  if (size.isEmpty() || !context_.makeCurrent(&surface_)) return;
  QOpenGLFunctions* gl = context_.functions();
  GLint before = 0;  // VTK believes that what it has bound stays bound
  gl->glGetIntegerv(GL_FRAMEBUFFER_BINDING, &before);
  if (!buffer_ || buffer_->size() != size) buffer_ = std::make_unique<QOpenGLFramebufferObject>(size);
  adapter_->blit(buffer_->handle(), GL_COLOR_ATTACHMENT0, QRect(QPoint(0, 0), size));
  buffer_->bind();
  if (picture_.size() != size) picture_ = QImage(size, QImage::Format_RGB32);
  gl->glPixelStorei(GL_PACK_ALIGNMENT, 4);
  gl->glReadPixels(0, 0, size.width(), size.height(), GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, picture_.bits());
  gl->glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
  picture_ = std::move(picture_).mirrored();
}

bool VtkCanvas::event(QEvent* event) {
  if (adapter_) adapter_->handleEvent(event);
  return QWidget::event(event);
}

void VtkCanvas::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  if (!prepare()) {
    painter.fillRect(rect(), palette().window());
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap,
                     tr("This view needs OpenGL 3.2, which this display does not offer."));
    return;
  }
  painting_ = true;
  if (drawnFor_ != size() || drawnRatio_ != devicePixelRatioF()) {
    drawnFor_ = size();
    drawnRatio_ = devicePixelRatioF();
    adapter_->resize(width(), height());
    window_->Render();
  }
  if (drawn_) fetch();
  painting_ = false;
  painter.drawImage(rect(), picture_);
}

}  // namespace glint::gui
