// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/scene_panel.h"

#include <QAction>
#include <QHBoxLayout>
#include <QLabel>
#include <QMap>
#include <QMenu>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolBar>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/pipeline/what_if.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/document/frame_roles.h"
#include "gui/scene/axis_views.h"
#include "gui/scene/before_results.h"
#include "gui/scene/camera_glide.h"
#include "gui/scene/scene_views.h"
#include "gui/scene/size_action.h"

namespace glint::gui {

namespace {
constexpr int kGlyphSteps = 20;  // of the slider, for a factor of ten
int sliderOf(double scale) { return int(std::lround(kGlyphSteps * std::log10(scale))); }
double scaleOf(int slider) { return std::pow(10.0, double(slider) / kGlyphSteps); }
}  // namespace

ScenePanel::ScenePanel(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      views_(new SceneViews),
      glide_(new CameraGlide(this)),
      history_(document.undoStack()) {
  buildBars();
  auto* badge = new StaleBadge(views_);
  const auto markStale = [this, badge] { badge->setStale(document_.stale() || views_->behind()); };
  connect(&document_, &Document::staleChanged, badge, markStale);
  connect(views_, &SceneViews::behindChanged, badge, markStale);
  connect(&document_, &Document::sceneOpened, this, &ScenePanel::showScene);
  connect(&document_, &Document::inspectionChanged, this, &ScenePanel::showInspection);
  // The first of what is computed, before the rest is there.
  connect(&document_, &Document::frameInspectionChanged, this, [this] {
    if (!document_.inspection()) showFirst(document_.frameInspection());
  });
  connect(&document_, &Document::layersChanged, this, &ScenePanel::showLayers);
  connect(&document_, &Document::selectionChanged, this, &ScenePanel::showSelection);
  connect(&document_, &Document::optionsChanged, this, &ScenePanel::showOptions);
  connect(&document_, &Document::requestChanged, this, &ScenePanel::showOptions);
  connect(document_.undoStack(), &QUndoStack::indexChanged, this, &ScenePanel::followHistory);
  connect(views_, &SceneViews::taken, glide_, &CameraGlide::stop);
  connect(views_, &SceneViews::picked, this, &ScenePanel::select);
  connect(views_, &SceneViews::emptyClicked, this, [this] {
    draw::Selection s = document_.selection();
    s = {s.frame, "", -1, "", {}};  // a frame is always selected
    document_.select(s);
  });
  connect(views_, &SceneViews::activeChanged, this, [this] {
    showEye();
    emit activeViewChanged(views_->activeView());
  });
  connect(views_, &SceneViews::leaveEye, this, [this] { setEye(viz::Eye::Outside); });
  connect(&document_, &Document::influenceChanged, this, &ScenePanel::showOptions);
  connect(views_, &SceneViews::lampMoved, this, [this](const QString& light, double x, double y, double z) {
    moveLamp(light, {x, y, z});
  });
  connect(views_, &SceneViews::lampReleased, this, [this] {
    lampStart_.reset();
    gesture_ = 0;
  });
  connect(views_, &SceneViews::menuWanted, this, &ScenePanel::showMenu);
  connect(views_, &SceneViews::wipeMoved, this, [this](double share, bool released) {
    if (gesture_ == 0) gesture_ = document_.newGesture();
    document_.setOption("scene/wipe", std::clamp(share, 0.02, 0.98), tr("Move wipe"), gesture_);
    if (released) gesture_ = 0;
  });
}

ScenePanel::~ScenePanel() = default;

void ScenePanel::buildBars() {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  bar_ = new QToolBar;  // what a narrow view has no room for is behind its arrow
  bar_->setObjectName(QStringLiteral("sceneBar"));
  bar_->setIconSize({16, 16});
  auto* heading = new QLabel(QStringLiteral("<b>%1</b>").arg(tr("Scene")));
  heading->setTextFormat(Qt::RichText);
  heading->setContentsMargins(4, 0, 0, 0);
  heading->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  bar_->addWidget(heading);
  column->addWidget(bar_);

  const auto slider = [this](const char* name, int least, int most, const QString& tip) {
    auto* s = new QSlider(Qt::Horizontal);
    s->setObjectName(QLatin1String(name));
    s->setRange(least, most);
    s->setToolTip(tip);
    s->setFocusPolicy(Qt::NoFocus);
    // One drag is one step of undo.
    connect(s, &QSlider::sliderPressed, this, [this] { gesture_ = document_.newGesture(); });
    connect(s, &QSlider::sliderReleased, this, [this] { gesture_ = 0; });
    return s;
  };
  const auto makeSize = [this, slider] {
    QSlider* size = slider("glyphScale", -kGlyphSteps, kGlyphSteps, tr("Size of cameras, points and arrows"));
    size->setValue(sliderOf(sceneOptions(document_).glyphScale));
    sizes_.append(size);
    connect(size, &QSlider::valueChanged, this, [this](int value) {
      document_.setOption("scene/glyph-scale", scaleOf(value), tr("Size of cameras and points"), gesture_);
    });
    return size;
  };
  slider_ = new SizeAction(makeSize, this);
  bar_->addAction(slider_);

  eyeBar_ = new QWidget;
  eyeBar_->setObjectName(QStringLiteral("eyeBar"));
  auto* row = new QHBoxLayout(eyeBar_);
  row->setContentsMargins(8, 2, 4, 2);
  row->setSpacing(6);
  row->addStretch(1);  // the picture names the camera
  row->addWidget(new QLabel(tr("Photograph")));
  opacity_ = slider("photographOpacity", 0, 100, tr("Opacity of the photograph over the scene"));
  opacity_->setFixedWidth(110);
  connect(opacity_, &QSlider::valueChanged, this, [this](int percent) {
    document_.setOption("scene/photograph-opacity", percent / 100.0, tr("Photograph over the scene: %1 %").arg(percent),
                        gesture_);
  });
  row->addWidget(opacity_);
  auto* back = new QToolButton;
  back->setObjectName(QStringLiteral("leaveEye"));
  back->setIcon(icon(QStringLiteral("close")));
  back->setToolTip(tr("Leave camera (Esc)"));
  back->setAutoRaise(true);
  connect(back, &QToolButton::clicked, this, [this] { setEye(viz::Eye::Outside); });
  row->addWidget(back);
  eyeBar_->hide();
  column->addWidget(eyeBar_);
  column->addWidget(views_, 1);
}

viz::SceneView& ScenePanel::view() { return views_->view(); }

std::vector<viz::ViewPoint> ScenePanel::viewPoints() const {
  if (!framed_ && !movedBeforeResults()) return firstViewPoints_;
  std::vector<viz::ViewPoint> places = views_->places();
  places.resize(sceneOptions(document_).linked ? 1 : std::size_t(views_->viewCount()));
  return places;
}

void ScenePanel::renderNow() { views_->renderNow(); }
bool ScenePanel::busy() const { return views_->busy() || glide_->running(); }
void ScenePanel::setDark(bool dark) { views_->setDark(dark); }

// --- from the document --------------------------------------------------------------------------------------------------

void ScenePanel::showScene() {
  mayAskForInfluence_ = true;
  framed_ = false;
  history_.forget();
  arranged_.reset();
  glide_->stop();
  views_->setScene(document_.sharedScene());
  beforeResults_.clear();
  showLayers();
  showSelection();
  showOptions();
  showFirst(knownBeforeResults(document_));
}

void ScenePanel::setViewPoints(const std::vector<viz::ViewPoint>& viewPoints) {
  firstViewPoints_ = viewPoints;
  if (!beforeResults_.empty() && !framed_) frameFirst();
}

void ScenePanel::frameFirst() {
  if (movedBeforeResults()) return;
  for (int i = 0; i < views_->viewCount(); ++i) {
    if (!firstViewPoints_.empty())
      views_->view(i).setViewPoint(firstViewPoints_[std::size_t(i) < firstViewPoints_.size() ? std::size_t(i) : 0]);
    else
      views_->view(i).frameAll();
  }
  beforeResults_ = views_->places();
}

bool ScenePanel::movedBeforeResults() const {
  const std::vector<viz::ViewPoint> now = views_->places();
  return !beforeResults_.empty() && !std::equal(now.begin(), now.end(), beforeResults_.begin(),
                                                [](const auto& a, const auto& b) { return toText(a) == toText(b); });
}

void ScenePanel::showFirst(const std::shared_ptr<const Inspection>& inspection) {
  if (!inspection) return;
  // That there is no virtual camera is not known yet.
  for (const SceneOptions::View& view : sceneOptions(document_).views)
    if (view.eye == viz::Eye::VirtualCamera) return;
  views_->setInspection(inspection);
  frameFirst();
  showOptions();
}

void ScenePanel::showInspection() {
  views_->setInspection(document_.inspection());
  if (!framed_ && document_.inspection()) {
    framed_ = true;
    frameFirst();
  }
  showOptions();
  // Reopened with its cameras coloured by what was measured then, as from a picture: measured again, once.
  if (mayAskForInfluence_ && document_.inspection() && !document_.stale()) {
    mayAskForInfluence_ = false;
    if (document_.option("scene/colour-by", std::string()) == "influence" && !document_.influence()) emit influenceRequested();
  }
}

void ScenePanel::showLayers() {
  for (int i = 0; i < kMostSceneViews; ++i)
    for (const viz::Layer& layer : viz::sceneLayers())
      views_->setLayerVisible(i, layer.name, layerVisibleIn(document_, i, layer.name));
  views_->scheduleRender();
}

void ScenePanel::showSelection() {
  views_->setSelection(document_.selection());
  showOptions();  // whose error colours the cameras follows the selected model
}

void ScenePanel::showOptions() {
  const SceneOptions options = sceneOptions(document_);
  const std::pair<Arrangement, bool> arranged(options.arrangement, options.linked);
  if (arranged_ && *arranged_ != arranged)
    history_.leave(framed_ ? std::optional(views_->places()) : std::nullopt);  // before there are results they have no place
  arranged_ = arranged;
  views_->apply(options);
  showLayers();               // a view may have its own
  sizes_.removeAll(nullptr);  // that of a menu which is gone
  for (const QPointer<QSlider>& size : sizes_) {
    const QSignalBlocker quiet(size.data());
    size->setValue(sliderOf(options.glyphScale));
  }
  const QSignalBlocker quietOpacity(opacity_);
  opacity_->setValue(int(std::lround(100 * options.opacity)));
  showEye();
}

void ScenePanel::followHistory() {
  const std::optional<ViewHistory::Places> places = history_.arrive();
  if (!places) return;
  glide_->stop();
  views_->setPlaces(*places);
}

void ScenePanel::showEye() {
  const QString text = views_->eyeText();
  eyeBar_->setVisible(!text.isEmpty());
  eyeBar_->setToolTip(text);
  checkToggles();
}

// --- to the document ----------------------------------------------------------------------------------------------------

void ScenePanel::select(const viz::Picked& picked) {
  draw::Selection s = document_.selection();
  if (picked.frame >= 0 && picked.frame != s.frame) {
    s.frame = picked.frame;
    s.highlight = -1;
    s.direction.reset();
  }
  if (!picked.model.empty()) s.model = picked.model;
  if (!picked.light.empty()) s.light = picked.light;
  if (picked.highlight >= 0 || picked.predicted >= 0) s.highlight = picked.highlight;
  s.predicted = picked.predicted;
  if (picked.direction) s.direction = picked.direction;
  document_.selectExactly(s);
  emit this->picked(picked);
}

void ScenePanel::moveLamp(const QString& light, const Eigen::Vector3d& by) {
  if (!document_.scene()) return;
  if (!lampStart_) {
    lampStart_ = document_.request().whatIf;
    gesture_ = document_.newGesture();
  }
  for (const TrueLight& lamp : document_.scene()->lights)
    if (lamp.id == light.toStdString())
      document_.setWhatIf(draggedLight(*lampStart_, lamp, by), tr("What-if: %1 moved").arg(lightText(lamp.id)),
                          QStringLiteral("lamp#%1").arg(gesture_));
}

void ScenePanel::showMenu(const viz::Picked& picked, const QPoint& global) {
  if (!document_.scene() || picked.frame < 0 || picked.frame >= document_.frameCount()) return;
  const QString id = nameText(document_.scene()->frames[std::size_t(picked.frame)].id);
  auto* menu = new QMenu(this);
  menu->setObjectName(QStringLiteral("cameraMenu"));
  menu->setAttribute(Qt::WA_DeleteOnClose);
  menu->addSection(tr("Frame %1").arg(menuText(id)));
  addRoles(*menu, document_, picked.frame);
  menu->addSeparator();
  menu->addAction(tr("&Look through its camera"), this, [this, frame = picked.frame] {
    document_.selectFrame(frame);
    setEye(viz::Eye::Camera);
  });
  menu->popup(global);
}

int ScenePanel::eyeView() const { return sceneOptions(document_).linked ? 0 : views_->activeView(); }

void ScenePanel::setEye(viz::Eye eye) {
  const QString text = eye == viz::Eye::Camera          ? tr("Look through the camera")
                       : eye == viz::Eye::VirtualCamera ? tr("Look through the virtual camera")
                                                        : tr("Look from outside");
  document_.setOption(viewOption("look-through", eyeView()), std::string(toText(eye)), text);
}

void ScenePanel::setArrangement(Arrangement arrangement) {
  document_.setOption("scene/views", std::string(toText(arrangement)),
                      tr("3D views: %1").arg(QLatin1String(toText(arrangement))));
}

void ScenePanel::setColourBy(const QString& by) {
  document_.setOption("scene/colour-by", by.toStdString(), tr("Colour cameras by %1").arg(by));
  if (by == QLatin1String("influence") && (!document_.influence() || document_.influenceStale())) emit influenceRequested();
}

void ScenePanel::setSwitch(const char* option, bool on, const QString& text) {
  document_.setOption(option, std::string(on ? "1" : "0"), text);
}

void ScenePanel::scaleGlyphs(double factor) {
  const double scale = std::clamp(sceneOptions(document_).glyphScale * factor, 0.1, 10.0);
  document_.setOption("scene/glyph-scale", scale, tr("Size of cameras and points"));
}

void ScenePanel::nextModels() {
  const int at = views_->activeView();
  const SceneOptions options = sceneOptions(document_);
  const std::vector<std::string>& models = document_.request().models;
  const std::set<std::string>& now = options.views[std::size_t(at)].models;
  std::string next = models.empty() ? "all" : models.front();
  if (!now.empty()) {
    const auto found = std::find(models.begin(), models.end(), *now.begin());
    next = found == models.end() || found + 1 == models.end() ? "all" : *(found + 1);
  }
  document_.setOption(viewOption("models", at), next,
                      next == "all" ? tr("3D view: all models") : tr("3D view: %1").arg(toQString(next)));
}

void ScenePanel::showWalk(const std::shared_ptr<const viz::WalkStory>& walk, int step, bool playing) {
  for (int i = 0; i < kMostSceneViews; ++i) views_->view(i).setWalk(walk, step);
  if (!document_.layerVisible("walk")) return;
  if (playing)
    views_->renderMoving();
  else
    views_->scheduleRender();
}

void ScenePanel::look(const QString& at, int highlight, const QString& model) {
  glide_->stop();
  viz::SceneView& view = views_->active();
  const viz::ViewPoint before = view.viewPoint();
  static const QMap<QString, viz::HighlightLook> looks{{QStringLiteral("tangent"), viz::HighlightLook::Section},
                                                       {QStringLiteral("highlight"), viz::HighlightLook::Camera},
                                                       {QStringLiteral("mirror"), viz::HighlightLook::Mirror}};
  if (at == QLatin1String("ellipsoid"))
    view.frameEllipsoids(model.toStdString());
  else if (!looks.contains(at) || !view.frameHighlight(highlight, looks[at]))
    view.frameAll();
  glide_->start(before, view.viewPoint(), [this, at = views_->activeView()](const viz::ViewPoint& place) {
    views_->view(at).setViewPoint(place);
    if (glide_->running())
      views_->renderMoving();
    else
      views_->scheduleRender();
  });
}

void ScenePanel::lookFrom(const std::vector<viz::ViewPoint>& viewPoints) {
  if (viewPoints.empty()) return;
  glide_->stop();
  for (int i = 0; i < views_->viewCount(); ++i)
    views_->view(i).setViewPoint(viewPoints[std::size_t(i) < viewPoints.size() ? std::size_t(i) : 0]);
  views_->scheduleRender();
}

void ScenePanel::frameAll() {
  glide_->stop();
  views_->active().frameAll();
  views_->scheduleRender();
}

void ScenePanel::frameSelection() {
  glide_->stop();
  views_->active().frameSelection();
  views_->scheduleRender();
}

void ScenePanel::lookAlong(viz::AxisView axis) {
  glide_->stop();
  views_->active().lookAlong(axis);
  views_->scheduleRender();
}

QStringList ScenePanel::savedViews() const {
  QStringList names;
  const std::string prefix = kSavedView;
  for (const auto& [name, value] : document_.state().options)
    if (name.rfind(prefix, 0) == 0 && viewPointFromText(value)) names << exactQString(name.substr(prefix.size()));
  return names;
}

void ScenePanel::saveView() {
  const QStringList taken = savedViews();
  int number = 1;
  while (taken.contains(tr("View %1").arg(number))) ++number;
  const QString name = tr("View %1").arg(number);
  document_.setOption(kSavedView + name.toStdString(), toText(views_->active().viewPoint()), tr("Save %1").arg(name));
}

void ScenePanel::goToView(const QString& name) {
  const auto view = viewPointFromText(document_.option(kSavedView + name.toStdString(), std::string()));
  if (!view) return;
  glide_->stop();
  if (view->parallel != sceneOptions(document_).parallel)
    setSwitch("scene/parallel", view->parallel, view->parallel ? tr("Parallel projection") : tr("Perspective"));
  views_->active().setViewPoint(*view);
  views_->scheduleRender();
}

void ScenePanel::goToNextView() {
  const QStringList names = savedViews();
  if (names.isEmpty()) return;
  const std::string now = toText(views_->active().viewPoint());
  int next = 0;
  for (int i = 0; i < names.size(); ++i)
    if (document_.option(kSavedView + names[i].toStdString(), std::string()) == now) next = (i + 1) % names.size();
  goToView(names[next]);
}

void ScenePanel::removeView(const QString& name) {
  // An option cannot be taken away; an empty one has no effect.
  document_.setOption(kSavedView + name.toStdString(), std::string(), tr("Delete %1").arg(shownText(name)));
}

// --- actions --------------------------------------------------------------------------------------------------------------

void ScenePanel::addActions(Actions& actions, QMenu* menu) {
  actions.add("view.frame-all", menu, tr("Show &everything"), [this] { frameAll(); }, {{Qt::Key_A}, "frame-all"});
  actions.add(
      "view.frame-selection", menu, tr("Show &selection"), [this] { frameSelection(); },
      {{int(Qt::SHIFT) | Qt::Key_A}, "frame-selection", tr("The selected highlight, ellipsoid or camera fills the 3D view")});
  toggles_.camera = addToggle(actions, "view.look-through", menu, tr("Look through &camera"),
                              {{Qt::Key_C}, "camera", tr("With the photograph over the scene; follows the selected frame")},
                              [this](bool on) { setEye(on ? viz::Eye::Camera : viz::Eye::Outside); });
  toggles_.mirrored = addToggle(actions, "view.look-through-virtual", menu, tr("Look through &virtual camera"),
                                {{Qt::Key_V}, "virtual-camera", tr("Mirrored in the tangent plane: shows the side of the light")},
                                [this](bool on) { setEye(on ? viz::Eye::VirtualCamera : viz::Eye::Outside); });
  QMenu* axes = addAxesMenu(actions, menu);
  QMenu* arrange = addArrangeMenu(actions, menu);
  QMenu* colours = addColourMenu(actions, menu);
  toggles_.solo = addToggle(actions, "view.solo", menu, tr("Only selected &frame"),
                            {{int(Qt::SHIFT) | Qt::Key_S}, "solo", tr("Hides the other cameras and their objects")},
                            [this](bool on) { setSwitch("scene/solo", on, on ? tr("Only selected frame") : tr("All frames")); });
  actions.add("view.glyphs-larger", menu, tr("La&rger cameras and points"), [this] { scaleGlyphs(1.25); },
              {{Qt::Key_BracketRight}});
  actions.add("view.glyphs-smaller", menu, tr("S&maller cameras and points"), [this] { scaleGlyphs(0.8); },
              {{Qt::Key_BracketLeft}});
  checkToggles();

  // The toolbar shows the same actions and menus.
  bar_->insertAction(slider_, toggles_.camera);
  bar_->insertAction(slider_, toggles_.mirrored);
  addMenuButton(axes, "axes", tr("Axis views, projection, saved views"));
  addMenuButton(arrange, "views", tr("One, two or four 3D views, or a wipe"));
  addMenuButton(colours, "palette", tr("Camera colours"));
  bar_->insertAction(slider_, toggles_.solo);
  bar_->insertAction(slider_, actions.find("view.frame-selection"));
  bar_->insertAction(slider_, actions.find("view.frame-all"));
}

QAction* ScenePanel::addToggle(Actions& actions, const char* id, QMenu* menu, const QString& title, const Actions::Look& look,
                               const std::function<void(bool)>& run) {
  return actions.addToggle(
      QLatin1String(id), menu, title,
      [this, run](bool on) {
        run(on);
        checkToggles();  // one of a group that was on stays on
      },
      look);
}

QMenu* ScenePanel::addAxesMenu(Actions& actions, QMenu* menu) {
  QMenu* axes = menu->addMenu(tr("Look &along"));
  const struct {
    const char *id, *title;
    viz::AxisView axis;
    int key;
  } directions[] = {{"view.axis-front", QT_TR_NOOP("&Front"), viz::AxisView::Front, Qt::Key_1},
                    {"view.axis-back", QT_TR_NOOP("&Back"), viz::AxisView::Back, Qt::Key_2},
                    {"view.axis-left", QT_TR_NOOP("&Left"), viz::AxisView::Left, Qt::Key_3},
                    {"view.axis-right", QT_TR_NOOP("&Right"), viz::AxisView::Right, Qt::Key_4},
                    {"view.axis-top", QT_TR_NOOP("&Top"), viz::AxisView::Top, Qt::Key_5},
                    {"view.axis-bottom", QT_TR_NOOP("B&ottom"), viz::AxisView::Bottom, Qt::Key_6}};
  for (const auto& d : directions)
    actions.add(QLatin1String(d.id), axes, tr(d.title), [this, axis = d.axis] { lookAlong(axis); }, {{int(Qt::CTRL) | d.key}});
  axes->addSeparator();
  toggles_.parallel =
      addToggle(actions, "view.parallel", axes, tr("&Parallel projection"), {{Qt::Key_5}, {}, tr("Without perspective")},
                [this](bool on) { setSwitch("scene/parallel", on, on ? tr("Parallel projection") : tr("Perspective")); });
  axes->addSeparator();
  actions.add("view.save-view", axes, tr("&Save this view"), [this] { saveView(); },
              {{QKeySequence("Shift+K")}, {}, tr("Stored with the session")});
  savedMenu_ = axes->addMenu(tr("Saved &views"));
  connect(savedMenu_, &QMenu::aboutToShow, this, [this] {
    savedMenu_->clear();
    for (const QString& name : savedViews()) {
      QMenu* one = savedMenu_->addMenu(menuText(shownText(name)));
      one->addAction(tr("Go to view"), this, [this, name] { goToView(name); });
      one->addAction(tr("Delete"), this, [this, name] { removeView(name); });
    }
    if (savedMenu_->isEmpty()) savedMenu_->addAction(tr("none"))->setEnabled(false);
  });
  actions.add("view.next-view", axes, tr("&Next saved view"), [this] { goToNextView(); }, {{Qt::Key_K}});
  return axes;
}

QMenu* ScenePanel::addArrangeMenu(Actions& actions, QMenu* menu) {
  QMenu* arrange = menu->addMenu(tr("&3D views"));
  const struct {
    const char *id, *title;
    Arrangement arrangement;
  } arrangements[] = {{"view.views-1", QT_TR_NOOP("&One view"), Arrangement::One},
                      {"view.views-2", QT_TR_NOOP("&Two views side by side"), Arrangement::SideBySide},
                      {"view.views-4", QT_TR_NOOP("&Four views"), Arrangement::Grid},
                      {"view.views-wipe", QT_TR_NOOP("&Wipe between two views"), Arrangement::Wipe}};
  for (const auto& a : arrangements)
    toggles_.arrangements.append(
        {addToggle(actions, a.id, arrange, tr(a.title), {}, [this, to = a.arrangement](bool) { setArrangement(to); }),
         a.arrangement});
  addAxisViews(actions, arrange, document_, *views_);
  arrange->addSeparator();
  toggles_.linked = addToggle(actions, "view.link-views", arrange, tr("&Linked cameras"),
                              {{int(Qt::CTRL) | Qt::Key_L}, {}, tr("All 3D views move together")}, [this](bool on) {
                                setSwitch("scene/linked", on, on ? tr("Link the 3D views") : tr("Unlink the 3D views"));
                              });
  actions.add("view.next-models", arrange, tr("Next &model in active view"), [this] { nextModels(); },
              {{Qt::Key_M}, {}, tr("Cycles through all models, then each alone")});
  return arrange;
}

QMenu* ScenePanel::addColourMenu(Actions& actions, QMenu* menu) {
  QMenu* colours = menu->addMenu(tr("Colour cameras b&y"));
  for (const auto& [by, title] : {std::pair("role", tr("&Role")), std::pair("model", tr("Best &model")),
                                  std::pair("error", tr("&Error")), std::pair("influence", tr("&Influence"))}) {
    const QString name = QLatin1String(by);
    const std::string id = std::string("view.colour-") + by;
    toggles_.colours.append(
        {addToggle(actions, id.c_str(), colours, title, {}, [this, name](bool) { setColourBy(name); }), name});
  }
  return colours;
}

void ScenePanel::addMenuButton(QMenu* menu, const char* iconName, const QString& tip) {
  QAction* action = menu->menuAction();
  action->setIcon(icon(QLatin1String(iconName)));
  action->setProperty("glintIcon", QLatin1String(iconName));
  action->setToolTip(tip);
  bar_->insertAction(slider_, action);
  qobject_cast<QToolButton*>(bar_->widgetForAction(action))->setPopupMode(QToolButton::InstantPopup);
}

void ScenePanel::checkToggles() {
  if (!toggles_.solo) return;
  const SceneOptions options = sceneOptions(document_);
  const viz::Eye eye = options.views[std::size_t(eyeView())].eye;
  toggles_.camera->setChecked(eye == viz::Eye::Camera);
  toggles_.mirrored->setChecked(eye == viz::Eye::VirtualCamera);
  toggles_.parallel->setChecked(options.parallel);
  toggles_.solo->setChecked(options.solo);
  toggles_.linked->setChecked(options.linked);
  toggles_.linked->setEnabled(options.arrangement != Arrangement::Wipe);
  for (const auto& [action, arrangement] : toggles_.arrangements) action->setChecked(options.arrangement == arrangement);
  const char* by = options.colours.by == viz::CameraColours::By::Error       ? "error"
                   : options.colours.by == viz::CameraColours::By::Model     ? "model"
                   : options.colours.by == viz::CameraColours::By::Influence ? "influence"
                                                                             : "role";
  for (const auto& [action, name] : toggles_.colours) action->setChecked(name == QLatin1String(by));
}

}  // namespace glint::gui
