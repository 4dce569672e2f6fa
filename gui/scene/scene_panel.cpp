// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/scene_panel.h"

#include <QVTKOpenGLNativeWidget.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <QHBoxLayout>
#include <QLabel>
#include <QMouseEvent>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>

#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

ScenePanel::ScenePanel(Document& document, QWidget* parent)
    : QWidget(parent), document_(document), view_(std::make_unique<viz::SceneView>()) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  auto* bar = new QHBoxLayout;
  bar->setContentsMargins(8, 3, 4, 3);
  bar->setSpacing(2);
  auto* title = new QLabel(QStringLiteral("<b>%1</b>").arg(tr("Scene")));
  bar->addWidget(title);
  bar->addStretch(1);
  const auto tool = [&](const char* iconName, const QString& tip, auto slot) {
    auto* button = new QToolButton;
    button->setIcon(icon(QLatin1String(iconName)));
    button->setToolTip(tip);
    button->setAutoRaise(true);
    connect(button, &QToolButton::clicked, this, slot);
    bar->addWidget(button);
  };
  tool("camera", tr("Look through the selected frame's camera (C)"), &ScenePanel::lookThroughSelected);
  tool("frame-all", tr("Show everything (A)"), &ScenePanel::frameAll);
  column->addLayout(bar);

  widget_ = new QVTKOpenGLNativeWidget;
  widget_->setObjectName(QStringLiteral("sceneView"));
  widget_->setMinimumSize(200, 150);
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  viz::prepareWindow(window);
  widget_->setRenderWindow(window);
  window->AddRenderer(view_->renderer());
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  window->GetInteractor()->SetInteractorStyle(style);
  widget_->installEventFilter(this);
  column->addWidget(widget_, 1);

  connect(&document_, &Document::sceneOpened, this, &ScenePanel::showScene);
  connect(&document_, &Document::inspectionChanged, this, &ScenePanel::showInspection);
  connect(&document_, &Document::layersChanged, this, &ScenePanel::showLayers);
  connect(&document_, &Document::selectionChanged, this, &ScenePanel::showSelection);
}

ScenePanel::~ScenePanel() = default;

std::optional<viz::ViewPoint> ScenePanel::viewPoint() const {
  return framed_ ? std::optional(view_->viewPoint()) : firstViewPoint_;
}

void ScenePanel::renderNow() { widget_->renderWindow()->Render(); }

void ScenePanel::scheduleRender() {
  // QWidget::update() would only show VTK's last picture again; several changes in one turn of the event loop make one picture.
  if (renderPending_) return;
  renderPending_ = true;
  QTimer::singleShot(0, this, [this] {
    renderPending_ = false;
    if (widget_->isVisible()) renderNow();
  });
}

void ScenePanel::setDark(bool dark) {
  view_->setDarkBackground(dark);
  scheduleRender();
}

void ScenePanel::frameAll() {
  view_->frameAll();
  scheduleRender();
}

void ScenePanel::lookThroughSelected() {
  if (!document_.inspection()) return;
  view_->lookThrough(document_.selection().frame);
  scheduleRender();
}

void ScenePanel::showScene() {
  framed_ = false;
  view_->setInspection(nullptr);
  showLayers();
  showSelection();
}

void ScenePanel::showInspection() {
  view_->setInspection(document_.inspection());
  if (!framed_ && document_.inspection()) {
    framed_ = true;
    if (firstViewPoint_)
      view_->setViewPoint(*firstViewPoint_);
    else
      view_->frameAll();
  }
  scheduleRender();
}

void ScenePanel::showLayers() {
  for (const viz::Layer& layer : viz::sceneLayers()) view_->setLayerVisible(layer.name, document_.layerVisible(layer.name));
  scheduleRender();
}

void ScenePanel::showSelection() {
  view_->setSelection(document_.selection());
  scheduleRender();
}

bool ScenePanel::eventFilter(QObject* watched, QEvent* event) {
  if (watched == widget_ && (event->type() == QEvent::MouseButtonPress || event->type() == QEvent::MouseButtonRelease)) {
    const auto* mouse = static_cast<QMouseEvent*>(event);
    const QPointF at = mouse->pos();
    if (event->type() == QEvent::MouseButtonPress)
      pressed_ = at;
    else if (mouse->button() == Qt::LeftButton && (at - pressed_).manhattanLength() < 4)
      pickAt(at);
  }
  // VTK's own keys (wireframe, quit, ...) are not ours; the window's shortcuts come before this.
  if (watched == widget_ && (event->type() == QEvent::KeyPress || event->type() == QEvent::KeyRelease)) {
    event->ignore();
    return true;
  }
  return QWidget::eventFilter(watched, event);
}

void ScenePanel::pickAt(const QPointF& position) {
  // VTK's display coordinates are device pixels, y up.
  const double ratio = widget_->devicePixelRatioF();
  const int x = int(position.x() * ratio), y = int((widget_->height() - position.y()) * ratio) - 1;
  const std::optional<viz::Picked> hit = view_->pick(x, y);
  if (!hit) return;
  viz::Selection s = document_.selection();
  if (hit->frame >= 0) {
    if (hit->frame != s.frame) s.highlight = -1;
    s.frame = hit->frame;
  }
  if (!hit->model.empty()) s.model = hit->model;
  document_.select(s);
  emit picked(*hit);
}

void ScenePanel::addActions(Actions& actions, QMenu* menu) {
  actions.add("view.frame-all", menu, tr("Show &everything"), [this] { frameAll(); }, {{Qt::Key_A}, "frame-all"});
  actions.add("view.look-through", menu, tr("Look through the frame's &camera"), [this] { lookThroughSelected(); },
              {{Qt::Key_C}, "camera"});
}

}  // namespace glint::gui
