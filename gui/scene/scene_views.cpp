// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/scene_views.h"

#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <QKeyEvent>
#include <QMouseEvent>
#include <QVBoxLayout>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/pipeline/frame_score.h"
#include "gui/base/draw_turns.h"
#include "gui/base/picture_access.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "viz/text_lock.h"
#include "viz/view_camera.h"
#include "viz/view_motion.h"

namespace glint::gui {

namespace {
constexpr int kStillMs = 300;                           // after the last movement everything is drawn in full
constexpr int kCaughtUpMs = 250;                        // without another picture that was late
constexpr int kQuickMs = 40;                            // where that took longer, what changes is first drawn the quick way
constexpr int kPhotographPx = 4096;                     // widest photograph while looking through a camera
constexpr double kGrabPx = 6;                           // about the wipe's line
constexpr double kZoomStep = 1.2;                       // of a notch of the wheel: twelve notches are a factor of nine
constexpr int kOneZoomMs = 500;                         // notches that follow one another zoom to the same point
constexpr double kTurn = 200 * std::numbers::pi / 180;  // of a drag across the whole view, as in other VTK programs

/// left, bottom, right, top of each view, shares of the window.
std::array<double, 4> viewport(const SceneOptions& o, int view) {
  switch (o.arrangement) {
    case Arrangement::One: return {0, 0, 1, 1};
    case Arrangement::SideBySide: return {0.5 * view, 0, 0.5 * (view + 1), 1};
    case Arrangement::Grid: return {0.5 * (view % 2), view < 2 ? 0.5 : 0, 0.5 * (view % 2 + 1), view < 2 ? 1 : 0.5};
    case Arrangement::Wipe: return view == 0 ? std::array<double, 4>{0, 0, o.wipe, 1} : std::array<double, 4>{o.wipe, 0, 1, 1};
  }
  return {0, 0, 1, 1};
}

/// What is drawn, for users who do not see it.
QString sceneWords(const Inspection* inspection, const draw::Selection& selection, int views) {
  if (!inspection || !inspection->scene || inspection->scene->frames.empty()) return QObject::tr("No results are drawn yet");
  const Scene& scene = *inspection->scene;
  const auto frame = std::size_t(std::clamp(selection.frame, 0, int(scene.frames.size()) - 1));
  QString words = QObject::tr("%1: %2 cameras, models %3; frame %4 is selected")
                      .arg(nameText(scene.name))
                      .arg(scene.frames.size())
                      .arg(joined(modelsInOrder(*inspection)), nameText(scene.frames[frame].id));
  if (!selection.model.empty()) words += QObject::tr(", model %1").arg(toQString(selection.model));
  if (views > 1) words += QObject::tr("; %1 views side by side").arg(views);
  return words;
}
}  // namespace

SceneViews::SceneViews(QWidget* parent)
    : QWidget(parent), cache_(std::make_shared<viz::LayerCache>()), photographs_(new PhotographStore(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  widget_ = new VtkCanvas;
  widget_->setObjectName(QStringLiteral("sceneView"));
  describePicture(widget_, tr("3D view of the scene"), [this] { return sceneWords(inspection_.get(), selection_, shown_); });
  widget_->setMinimumSize(140, 110);
  vtkGenericOpenGLRenderWindow* window = widget_->renderWindow();
  viz::prepareWindow(window);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  window->GetInteractor()->SetInteractorStyle(style);
  widget_->installEventFilter(this);
  column->addWidget(widget_);

  cache_->setPhotographSource([this](int frame, int maxWidth) { return photograph(frame, maxWidth); });
  connect(photographs_, &PhotographStore::arrived, this, [this] {
    for (auto& view : views_) view->photographsArrived();
    fetchPhotograph();
    scheduleRender();
  });
  for (auto& view : views_) view = std::make_unique<viz::SceneView>(cache_);

  onRender_->SetClientData(this);
  onRender_->SetCallback([](vtkObject*, unsigned long event, void* data, void*) {
    auto* self = static_cast<SceneViews*>(data);
    if (event == vtkCommand::StartEvent)
      self->syncCameras();
    else if (self->behind_)  // one that came before the mark ends it at once
      self->caughtUp_.start(self->behindSince_.elapsed() < StaleBadge::kAfterMs ? 0 : kCaughtUpMs);
  });
  window->AddObserver(vtkCommand::StartEvent, onRender_);
  window->AddObserver(vtkCommand::EndEvent, onRender_);
  onInteraction_->SetClientData(this);
  onInteraction_->SetCallback([](vtkObject*, unsigned long event, void* data, void*) {
    auto* self = static_cast<SceneViews*>(data);
    if (event == vtkCommand::StartInteractionEvent) {
      self->full_.stop();
      self->setMoving(true);
    } else {
      self->full_.start();
    }
  });
  style->AddObserver(vtkCommand::StartInteractionEvent, onInteraction_);
  style->AddObserver(vtkCommand::EndInteractionEvent, onInteraction_);
  full_.setSingleShot(true);
  full_.setInterval(kStillMs);
  connect(&full_, &QTimer::timeout, this, [this] {
    if (widget_->isVisible()) renderFull();
  });
  caughtUp_.setSingleShot(true);
  connect(&caughtUp_, &QTimer::timeout, this, &SceneViews::endBehind);
  arrange();
}

SceneViews::~SceneViews() {
  widget_->renderWindow()->RemoveObserver(onRender_);
  for (int i = 0; i < shown_; ++i) widget_->renderWindow()->RemoveRenderer(view(i).renderer());
}

void SceneViews::setScene(std::shared_ptr<const Scene> scene) {
  photographs_->setScene(std::move(scene));
  loaded_.clear();
  toLoad_.clear();
  inspection_.reset();
  own_.fill(false);
  for (auto& view : views_) view->setInspection(nullptr);
}

void SceneViews::setInspection(const std::shared_ptr<const Inspection>& inspection) {
  inspection_ = inspection;
  if (inspection) photographs_->setInspection(inspection);
  for (int i = 0; i < shown_; ++i) view(i).setInspection(inspection);
  fetchPhotograph();
  setBehind();
  scheduleRender();
}

void SceneViews::setSelection(const draw::Selection& selection) {
  selection_ = selection;
  for (int i = 0; i < shown_; ++i) view(i).setSelection(selection);
  fetchPhotograph();
  setBehind();
  scheduleRender();
}

void SceneViews::setLayerVisible(int view, const std::string& name, bool visible) {
  this->view(view).setLayerVisible(name, visible);
  showLegends();
}

void SceneViews::setLamps(const std::shared_ptr<const std::vector<LampAnswer>>& lamps) {
  lamps_ = lamps;
  for (auto& view : views_) view->setLamps(lamps);
  scheduleRender();
}

void SceneViews::setRuns(const std::shared_ptr<const std::vector<viz::DrawnRuns>>& runs) {
  runs_ = runs;
  for (auto& view : views_) view->setRuns(runs);
  scheduleRender();
}

std::array<double, 4> SceneViews::placeOf(int view) const { return viewport(options_, view); }

void SceneViews::setDark(bool dark) {
  dark_ = dark;
  for (auto& view : views_) view->setDarkBackground(dark);
  scheduleRender();
}

void SceneViews::setTextScale(double scale) {
  for (auto& view : views_) view->setTextScale(scale);
  if (widget_->isVisible()) renderFull();
}

void SceneViews::apply(const SceneOptions& options) {
  for (int i = options.viewCount(); i < shown_; ++i) own_[std::size_t(i)] = !options_.linked && inspection_;
  options_ = options;
  arrange();
  for (int i = 0; i < kMostSceneViews; ++i) {
    viz::SceneView& v = view(i);
    const SceneOptions::View& o = options.views[std::size_t(i)];
    v.setModels(o.models);
    v.setGlyphScale(options.glyphScale);
    v.setSolo(options.solo);
    v.setHidden(options.hidden);
    v.setCameraColours(options.colours);
    v.setPhotographOpacity(options.opacity);
    if (i >= shown_) continue;  // the others follow when they are shown
    v.setParallel(o.parallel);
    v.setEye(o.eye);
  }
  fetchPhotograph();
  scheduleRender();
}

std::unique_ptr<viz::SceneView> SceneViews::copyOf(int at) {
  auto copy = std::make_unique<viz::SceneView>(cache_);
  const SceneOptions::View& o = options_.views[std::size_t(at)];
  copy->setDarkBackground(dark_);
  copy->setInspection(inspection_);
  copy->setLamps(lamps_);
  copy->setRuns(runs_);
  copy->setSelection(selection_);
  for (const viz::Layer& layer : viz::sceneLayers()) copy->setLayerVisible(layer.name, view(at).layerVisible(layer.name));
  copy->setModels(o.models);
  copy->setGlyphScale(options_.glyphScale);
  copy->setSolo(options_.solo);
  copy->setHidden(options_.hidden);
  copy->setCameraColours(options_.colours);
  copy->setPhotographOpacity(options_.opacity);
  copy->setParallel(o.parallel);
  copy->setViewPoint(view(at).viewPoint());
  copy->setEye(o.eye);
  if (copy->looksThrough()) copy->setPhotograph(selection_.frame, photographs_->get(selection_.frame, kPhotographPx).texture);
  return copy;
}

void SceneViews::arrange() {
  vtkRenderWindow* window = widget_->renderWindow();
  const int count = options_.viewCount();
  for (int i = shown_; i < count; ++i) {
    // A new view starts where the active one looks from; one that was moved by itself comes back there.
    view(i).setInspection(inspection_);
    view(i).setSelection(selection_);
    if (shown_ > 0 && (options_.linked || !own_[std::size_t(i)])) view(i).setViewPoint(active().viewPoint());
    window->AddRenderer(view(i).renderer());
  }
  for (int i = count; i < shown_; ++i) window->RemoveRenderer(view(i).renderer());
  shown_ = count;
  if (active_ >= count) activate(0);
  const bool wipe = options_.arrangement == Arrangement::Wipe;
  for (int i = 0; i < count; ++i) {
    const std::array<double, 4> v = viewport(options_, i);
    view(i).renderer()->SetViewport(v[0], v[1], v[2], v[3]);
    view(i).setPartOfWindow(wipe);
    view(i).setFrame(count > 1 && !(wipe && i == 0), i == active_, options_.views[std::size_t(i)].name);
  }
  showLegends();
}

void SceneViews::showLegends() {
  for (int i = 0; i < shown_; ++i) view(i).setLegendVisible(hasLegend(i), i == 0);
}

bool SceneViews::hasLegend(int view) const {
  if (view == 0) return true;
  const viz::SceneView &first = *views_.front(), &other = *views_[std::size_t(view)];
  const std::vector<viz::Layer>& layers = viz::sceneLayers();
  return options_.views[std::size_t(view)].models != options_.views.front().models ||
         std::any_of(layers.begin(), layers.end(),
                     [&](const viz::Layer& layer) { return first.layerVisible(layer.name) != other.layerVisible(layer.name); });
}

void SceneViews::fetchPhotograph() {
  for (int i = 0; i < shown_; ++i) {
    if (!view(i).looksThrough()) continue;
    const viz::LayerCache::Photograph photograph = photographs_->get(selection_.frame, kPhotographPx);
    view(i).setPhotograph(selection_.frame, photograph.texture);
  }
}

/// Only what the graphics card has already: bringing a photograph there (without one: making it ready at every size) takes some
/// 20 ms, and two dozen may arrive at once. Each gets a turn of its own.
viz::LayerCache::Photograph SceneViews::photograph(int frame, int maxWidth) {
  const viz::LayerCache::Photograph found = photographs_->get(frame, maxWidth);
  if (!found.texture || allPhotographs_ || !widget_->ready() || loaded_.count(found.texture)) return found;
  if (std::find(toLoad_.begin(), toLoad_.end(), found.texture) == toLoad_.end()) toLoad_.push_back(found.texture);
  drawInTurn(photographs_, [this] { loadPhotograph(); });
  return {nullptr, true};
}

void SceneViews::loadPhotograph() {
  if (toLoad_.empty()) return;
  widget_->renderWindow()->MakeCurrent();
  const vtkSmartPointer<vtkTexture> texture = cache_->textureOf(toLoad_.front());
  texture->Render(view(0).renderer());
  texture->PostRender(view(0).renderer());
  loaded_.insert(toLoad_.front());
  toLoad_.pop_front();
  if (!toLoad_.empty()) return drawInTurn(photographs_, [this] { loadPhotograph(); });
  for (auto& view : views_) view->photographsArrived();
  scheduleRender();
}

void SceneViews::scheduleRender() {
  // QWidget::update() would only show VTK's last picture again.
  if (full_.isActive()) full_.start();  // not still yet
  if (renderPending_) return;
  renderPending_ = true;
  // While results arrive one after the other, drawing them takes a third of the interface thread's time at most.
  const qint64 due = 2 * lastRenderMs_, passed = sinceRender_.isValid() ? sinceRender_.elapsed() : due;
  QTimer::singleShot(int(std::clamp<qint64>(due - passed, 0, kStillMs)), this,
                     [this] { drawInTurn(this, [this] { renderInTurn(); }); });
}

void SceneViews::renderInTurn() {
  renderPending_ = false;
  if (!widget_->isVisible()) return;
  bool quick = fullMs_ > kQuickMs;
  for (int i = 0; i < shown_; ++i) quick = quick || view(i).hasCoarseSurface();
  if (!quick) return renderFull();
  setMoving(true);
  full_.start();
  sinceRender_.start();
  viz::render(widget_->renderWindow());
  lastRenderMs_ = sinceRender_.restart();
}

void SceneViews::renderFull() {
  setMoving(false);
  sinceRender_.start();
  viz::render(widget_->renderWindow());
  fullMs_ = lastRenderMs_ = sinceRender_.restart();
}

void SceneViews::renderNow() {
  setMoving(false);
  allPhotographs_ = true;
  if (!toLoad_.empty())
    for (auto& view : views_) view->photographsArrived();
  widget_->renderNow();
  allPhotographs_ = false;
  endBehind();
}

void SceneViews::renderMoving() {
  if (!widget_->isVisible()) return;
  setMoving(true);
  full_.start();
  viz::render(widget_->renderWindow());
}

void SceneViews::setBehind() {
  caughtUp_.stop();
  if (behind_ || !inspection_) return;
  behind_ = true;
  behindSince_.start();
  emit behindChanged(true);
}

void SceneViews::endBehind() {
  caughtUp_.stop();
  if (std::exchange(behind_, false)) emit behindChanged(false);
}

void SceneViews::setMoving(bool moving) {
  for (auto& view : views_) view->setMoving(moving);
}

QString SceneViews::eyeText() const {
  const std::size_t shown = options_.linked ? 0 : std::size_t(active_);
  return toQString(views_[shown]->eyeText());
}

void SceneViews::syncCameras() {
  if (!options_.linked) return;
  const viz::ViewPoint seen = active().viewPoint();
  for (int i = 0; i < shown_; ++i)
    if (i != active_) view(i).setViewPoint(seen);
}

std::vector<viz::ViewPoint> SceneViews::places() const {
  std::vector<viz::ViewPoint> places;
  for (int i = 0; i < kMostSceneViews; ++i) {
    const bool follows = options_.linked && i < shown_;  // it does when the next picture is drawn
    places.push_back(views_[std::size_t(follows ? active_ : i)]->viewPoint());
  }
  return places;
}

void SceneViews::setPlaces(const std::vector<viz::ViewPoint>& places) {
  for (int i = 0; i < kMostSceneViews; ++i) {
    view(i).setViewPoint(places[std::size_t(i)]);
    view(i).setParallel(options_.views[std::size_t(i)].parallel);
  }
  scheduleRender();
}

int SceneViews::viewAt(const QPointF& position) const {
  const double x = position.x() / std::max(1, widget_->width()), y = 1 - position.y() / std::max(1, widget_->height());
  for (int i = 0; i < shown_; ++i) {
    const std::array<double, 4> v = viewport(options_, i);
    if (x >= v[0] && x < v[2] && y >= v[1] && y < v[3]) return i;
  }
  return 0;
}

void SceneViews::activate(int view) {
  if (view == active_) return;
  active_ = view;
  for (int i = 0; i < shown_; ++i)
    this->view(i).setFrame(shown_ > 1 && !(options_.arrangement == Arrangement::Wipe && i == 0), i == active_,
                           options_.views[std::size_t(i)].name);
  emit activeChanged();
  scheduleRender();
}

bool SceneViews::onWipe(const QPointF& position) const {
  return options_.arrangement == Arrangement::Wipe && std::abs(position.x() - options_.wipe * widget_->width()) <= kGrabPx;
}

QPointF SceneViews::toDisplay(const QPointF& position) const {
  return {position.x() * widget_->devicePixelRatioF(), (widget_->height() - position.y()) * widget_->devicePixelRatioF()};
}

Eigen::Vector3d SceneViews::underPointer(const QPointF& position) const {
  const QPointF display = toDisplay(position);
  const viz::SceneView& view = *views_[std::size_t(active_)];
  if (const auto hit = view.pick(int(display.x()), int(display.y()) - 1)) return hit->position;
  return viz::worldAt(view.renderer(), display.x(), display.y(), view.viewPoint().focalPoint);
}

bool SceneViews::wheel(const QWheelEvent& event) {
  const int at = viewAt(event.position());
  activate(at);
  const double factor = std::pow(kZoomStep, event.angleDelta().y() / 120.0);
  const QPointF display = toDisplay(event.position());
  if (view(at).looksThrough()) {
    for (int i = 0; i < shown_; ++i)
      if (i == at || options_.arrangement == Arrangement::Wipe) view(i).zoomPhotograph(factor, display.x(), display.y());
  } else {
    if (!sinceWheel_.isValid() || sinceWheel_.elapsed() > kOneZoomMs || wheelAt_ != event.position())
      zoomedAt_ = underPointer(event.position());
    wheelAt_ = event.position();
    sinceWheel_.start();
    active().setViewPoint(viz::zoomedAbout(active().viewPoint(), zoomedAt_, factor));
    full_.start();
    setMoving(true);
  }
  scheduleRender();
  return true;
}

void SceneViews::turn(const QPointF& from, const QPointF& to) {
  if (!pivot_) pivot_ = underPointer(pressed_);
  const std::array<double, 4> v = viewport(options_, active_);
  const double width = std::max(1.0, (v[2] - v[0]) * widget_->width()), height = std::max(1.0, (v[3] - v[1]) * widget_->height());
  active().setViewPoint(
      viz::turnedAbout(active().viewPoint(), *pivot_, kTurn * (to.x() - from.x()) / width, kTurn * (from.y() - to.y()) / height));
  scheduleRender();
}

bool SceneViews::mouse(QEvent* event) {
  switch (event->type()) {
    case QEvent::Wheel: return wheel(*static_cast<QWheelEvent*>(event));
    case QEvent::MouseButtonPress: return press(*static_cast<QMouseEvent*>(event));
    case QEvent::MouseMove: return drag(*static_cast<QMouseEvent*>(event));
    default: return release(*static_cast<QMouseEvent*>(event));
  }
}

bool SceneViews::press(const QMouseEvent& event) {
  const QPointF at = pressed_ = last_ = event.localPos();
  const bool left = event.button() == Qt::LeftButton;
  if (left && onWipe(at)) {
    drag_ = Drag::Wipe;
    return true;
  }
  activate(viewAt(at));
  drag_ = active().looksThrough() ? Drag::Photograph : Drag::Vtk;
  turns_ = drag_ == Drag::Vtk && left && event.modifiers() == Qt::NoModifier;
  pivot_.reset();
  if (options_.lampsMove && left && drag_ == Drag::Vtk) {
    const QPointF display = toDisplay(at);
    if (const auto hit = active().pickLamp(int(display.x()), int(display.y()) - 1)) {
      drag_ = Drag::Lamp;
      lamp_ = *hit;
    }
  }
  return drag_ == Drag::Photograph || drag_ == Drag::Lamp;
}

bool SceneViews::drag(const QMouseEvent& event) {
  const QPointF at = event.localPos();
  if (event.buttons() == Qt::NoButton) {
    widget_->setCursor(onWipe(at) ? Qt::SplitHCursor : Qt::ArrowCursor);
    return false;
  }
  if (drag_ == Drag::Wipe) emit wipeMoved(at.x() / std::max(1, widget_->width()), false);
  if (drag_ == Drag::Photograph) {
    const QPointF by = toDisplay(at) - toDisplay(last_);
    for (int i = 0; i < shown_; ++i)
      if (i == active_ || options_.arrangement == Arrangement::Wipe) view(i).movePhotograph(by.x(), by.y());
    scheduleRender();
  }
  if (drag_ == Drag::Lamp) {
    const QPointF from = toDisplay(pressed_), to = toDisplay(at);
    vtkRenderer* renderer = active().renderer();
    const Eigen::Vector3d by =
        viz::worldAt(renderer, to.x(), to.y(), lamp_.position) - viz::worldAt(renderer, from.x(), from.y(), lamp_.position);
    emit lampMoved(exactQString(lamp_.light), by.x(), by.y(), by.z());
  }
  const bool turns = drag_ == Drag::Vtk && turns_ && (event.buttons() & Qt::LeftButton);
  if (turns) turn(last_, at);
  last_ = at;
  return turns || drag_ != Drag::Vtk;
}

bool SceneViews::release(const QMouseEvent& event) {
  const QPointF at = event.localPos();
  const Drag was = std::exchange(drag_, Drag::None);
  if (was == Drag::Wipe) {
    emit wipeMoved(at.x() / std::max(1, widget_->width()), true);
    return true;
  }
  if (was == Drag::Lamp) emit lampReleased();
  if ((at - pressed_).manhattanLength() < 4) click(event);
  return was == Drag::Photograph || was == Drag::Lamp;
}

void SceneViews::click(const QMouseEvent& event) {
  const QPointF display = toDisplay(event.localPos());
  const int x = int(display.x()), y = int(display.y()) - 1;
  if (event.button() == Qt::RightButton) {
    // The menu is a camera's: what lies behind one, or before it, does not count.
    std::optional<viz::Picked> hit = active().pickCamera(x, y);
    if (!hit) hit = active().pick(x, y);
    if (hit) emit menuWanted(*hit, event.globalPos());
  }
  if (event.button() == Qt::LeftButton) {
    if (const auto hit = active().pick(x, y))
      emit picked(*hit);
    else
      emit emptyClicked();
  }
}

bool SceneViews::eventFilter(QObject* watched, QEvent* event) {
  if (watched != widget_) return QWidget::eventFilter(watched, event);
  switch (event->type()) {
    case QEvent::MouseButtonPress:
    case QEvent::Wheel:
      emit taken();
      if (mouse(event)) return true;
      break;
    case QEvent::MouseButtonRelease:
    case QEvent::MouseMove:
      if (mouse(event)) return true;
      break;
    case QEvent::ShortcutOverride:
      // Escape leaves the camera here; elsewhere it stops what runs.
      if (static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape && !eyeText().isEmpty()) {
        event->accept();
        return true;
      }
      break;
    case QEvent::KeyPress:
      if (static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape && !eyeText().isEmpty()) {
        emit leaveEye();
        return true;
      }
      [[fallthrough]];
    case QEvent::KeyRelease:  // VTK's own keys (wireframe, quit, ...) are not ours; the window's shortcuts come before this
      event->ignore();
      return true;
    default: break;
  }
  return QWidget::eventFilter(watched, event);
}

}  // namespace glint::gui
