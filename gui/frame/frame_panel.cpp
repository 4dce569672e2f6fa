// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/frame_panel.h"

#include <QAction>
#include <QEvent>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QSplitter>
#include <QToolBar>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "core/draw/selection.h"
#include "core/geometry/polyline.h"
#include "core/pipeline/what_if_knobs.h"
#include "gui/base/flow_layout.h"
#include "gui/base/panel_scroll.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/document/frame_roles.h"
#include "gui/frame/develop_bar.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_captions.h"
#include "gui/frame/hand_tool.h"
#include "gui/frame/highlight_edits.h"
#include "gui/frame/lobe_layer.h"
#include "gui/frame/pair_bar.h"
#include "gui/frame/retexture_bar.h"
#include "viz/frame_pick.h"
#include "viz/walk_story.h"

namespace glint::gui {
namespace {
// px of height: below, the switches of the overlays are behind one button, so that the photograph keeps its room.
constexpr int kRoomForOverlays = 440, kRoomBesidePair = 560;
}  // namespace

FramePanel::FramePanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  canvas_ = new FrameCanvas;
  canvas_->setObjectName(QStringLiteral("frameCanvas"));
  second_ = new FrameCanvas;
  second_->setObjectName(QStringLiteral("secondCanvas"));
  second_->hide();
  buildToolbar(column);
  auto* both = new QSplitter(Qt::Horizontal);
  both->addWidget(canvas_);
  both->addWidget(second_);
  both->setChildrenCollapsible(false);
  both->setMinimumHeight(90);
  column->addWidget(both, 1);
  captions_ = new QLabel;
  captions_->setObjectName(QStringLiteral("frameCaptions"));
  captions_->setTextFormat(Qt::RichText);
  captions_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::LinksAccessibleByMouse);
  captions_->setMargin(5);
  captions_->setWordWrap(true);
  connect(captions_, &QLabel::linkActivated, this, &FramePanel::followLink);
  captionsScroll_ = new PanelScroll(captions_, {150, 40}, PanelScroll::Height::Hugs);
  captionsScroll_->setAccessibleName(tr("Errors of this frame"));
  column->addWidget(captionsScroll_);

  connect(canvas_, &FrameCanvas::zoomChanged, this,
          [this](double z) { zoom_->setText(QStringLiteral("%1 %").arg(z * 100, 0, 'f', z < 0.1 ? 1 : 0)); });
  connect(canvas_, &FrameCanvas::clicked, this, &FramePanel::selectAt);
  connect(second_, &FrameCanvas::clicked, this, &FramePanel::selectModelAt);
  for (FrameCanvas* canvas : {canvas_, second_}) {
    connect(canvas, &FrameCanvas::viewMoved, this, [this] { zoomedByLook_ = follows_ = false; });
    connect(canvas, &FrameCanvas::probed, this, [this](const QString& text) {
      probe_.forget();
      emit probed(text);
    });
    connect(canvas, &FrameCanvas::hovered, this, [this, canvas](double x, double y) {
      probe_.want(document_.sharedScene(), document_.inspection(), frameOn(canvas), {x, y});
    });
    PhotoLoader* loader = canvas == canvas_ ? &loader_ : &secondLoader_;
    int& pictured = pictured_[canvas != canvas_];
    connect(loader, &PhotoLoader::loaded, this, [this, canvas, &pictured](int frame, const FramePicture& picture) {
      if (frame == frameOn(canvas)) canvas->setPicture(picture), pictured = frame;
    });
    connect(loader, &PhotoLoader::failed, this, [this, canvas, &pictured](int frame, const QString& reason) {
      emit photographFailed(frame, reason);
      if (frame == frameOn(canvas)) canvas->setMessage(unreadableText(*document_.scene(), frame, reason)), pictured = -1;
    });
  }
  connect(&probe_, &PixelProbeWorker::probed, this, &FramePanel::probed);

  connectDocument();
  showScene();
}

void FramePanel::connectDocument() {
  lobes_ = new LobeLayer(document_, this);
  connect(lobes_, &LobeLayer::changed, &refresh_, QOverload<>::of(&QTimer::start));
  refresh_.setSingleShot(true);
  refresh_.setInterval(0);
  connect(&refresh_, &QTimer::timeout, this, &FramePanel::showFrame);
  connect(&document_, &Document::sceneOpened, this, &FramePanel::showScene);
  connect(&document_, &Document::selectionChanged, this, [this] {
    canvas_->setHeld({}, {});
    followHighlight(document_.selection().frame);
    refresh_.start();  // the heading with the numbers: they are of one frame
  });
  connect(&document_, &Document::layersChanged, this, &FramePanel::showOverlay);
  connect(&document_, &Document::optionsChanged, this, [this] {
    showLook();
    foldOverlays();
    refresh_.start();
  });
  connect(&document_, &Document::requestChanged, this, [this] {
    const bool what = !document_.request().whatIf.none();
    if (std::exchange(whatIf_, what) && !what) fewerLines_ = true;
  });
  for (const auto signal : {&Document::requestChanged, &Document::pinnedChanged})  // the roles of frames
    connect(&document_, signal, this, &FramePanel::showFrame);
  for (const auto signal : {&Document::inspectionChanged, &Document::frameInspectionChanged})
    connect(&document_, signal, this, [this] {
      if (!document_.frameStale()) canvas_->setHeld({}, {});  // the contour is there now
      loader_.setInspection(document_.results());
      secondLoader_.setInspection(document_.inspection());  // as its contours
      markStale();
      showOverlay();
      for (FrameCanvas* canvas : {canvas_, second_})
        if (canvas->isVisible()) canvas->repaint();  // what the user tunes for is seen before the other panels follow
    });
  connect(&document_, &Document::staleChanged, this, &FramePanel::markStale);
  for (PhotoLoader* loader : {&loader_, &secondLoader_})
    connect(loader, &PhotoLoader::behindChanged, this, &FramePanel::markStale);
  connect(&canvas_->staleBadge(), &StaleBadge::marked, this, &FramePanel::showOverlay);
}

/// A photograph that is drawn anew for a what-if comes after the contours: until then the old one is not up to date either.
void FramePanel::markStale() {
  canvas_->setStale(document_.frameStale() || loader_.behind());
  second_->setStale(document_.stale() || secondLoader_.behind());
}

void FramePanel::buildToolbar(QVBoxLayout* column) {
  auto* bar = new QToolBar;  // what a narrow view has no room for is behind its arrow
  bar->setObjectName(QStringLiteral("frameBar"));
  bar->setIconSize({16, 16});
  bar->addWidget(buildHeading());
  buildTools(*bar);
  column->addWidget(bar);
  auto* content = new QWidget;
  auto* rows = new QVBoxLayout(content);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(0);
  develop_ = new DevelopBar(document_);
  rows->addWidget(develop_);
  rows->addWidget(buildSwitches());
  switches_ = new PanelScroll(content, {150, 30}, PanelScroll::Height::Hugs);
  switches_->setAccessibleName(tr("Overlays"));
  column->addWidget(switches_);
  // Not in what scrolls: in a low panel its row would be cut, and with it what the lines are.
  pair_ = new PairBar(document_);
  column->addWidget(pair_);
  column->addWidget(pair_->sentence());
  retexture_ = new RetextureBar(document_, *canvas_, loader_);
  column->addWidget(retexture_);
  column->addWidget(retexture_->words());
}

QWidget* FramePanel::buildHeading() {
  auto* heading = new QWidget;
  auto* row = new QHBoxLayout(heading);
  row->setContentsMargins(4, 0, 0, 0);
  row->setSpacing(2);
  title_ = new QLabel;
  title_->setObjectName(QStringLiteral("frameTitle"));
  title_->setTextFormat(Qt::RichText);
  row->addWidget(title_);
  role_ = new QLabel;
  role_->setObjectName(QStringLiteral("frameRole"));
  role_->setSizePolicy(QSizePolicy::Maximum, QSizePolicy::Maximum);
  row->addSpacing(6);
  row->addWidget(role_);
  row->addStretch(1);
  zoom_ = new QLabel;
  zoom_->setProperty("role", "faded");
  zoom_->setMinimumWidth(fontMetrics().horizontalAdvance(QStringLiteral("51200 %")));
  zoom_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  row->addWidget(zoom_);
  heading->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Preferred);
  return heading;
}

void FramePanel::buildTools(QToolBar& bar) {
  const auto tool = [&](const char* iconName, const QString& tip) {
    QAction* action = bar.addAction(icon(QLatin1String(iconName)), tip);
    bar.widgetForAction(action)->setObjectName(QLatin1String(iconName));
    return action;
  };
  connect(tool("highlight", tr("Zoom to highlight (F or H)")), &QAction::triggered, this, &FramePanel::goToHighlight);
  connect(tool("pixels", tr("One screen pixel per photograph pixel (1)")), &QAction::triggered, canvas_,
          &FrameCanvas::onePixelPerPixel);
  connect(tool("fit", tr("Whole photograph (0, double-click)")), &QAction::triggered, this, [this] {
    canvas_->fit();
    second_->fit();
  });
  hand_ = new HandTool(document_, this);
  canvas_->setDragTool(hand_);
  edits_ = new HighlightEdits(document_, canvas_, this);
  connect(edits_, &HighlightEdits::problem, this, &FramePanel::problem);
  QAction* byHand = tool("hand", tr("What-if: move highlights, peaks and the camera by hand (E)"));
  byHand->setCheckable(true);
  connect(byHand, &QAction::triggered, hand_, &HandTool::setOn);
  connect(hand_, &HandTool::onChanged, byHand, &QAction::setChecked);
  connect(hand_, &HandTool::carried, canvas_, &FrameCanvas::setHeld);
  sideBySide_ = tool("side-by-side", tr("Two frames side by side, with tangent epipolar lines (D)"));
  sideBySide_->setCheckable(true);
  connect(sideBySide_, &QAction::triggered, this, [this](bool on) {
    document_.setOption("frame/side-by-side", on ? "on" : "off", on ? tr("Two frames side by side") : tr("One frame"));
  });
  retextureTool_ = tool("retexture", tr("Retexture: the predicted highlight over another picture, or the frame without it (R)"));
  retextureTool_->setCheckable(true);
  connect(retextureTool_, &QAction::triggered, this, [this](bool on) { retexture_->setOn(on); });
}

/// One for each overlay, and the menu that has them all where there is no room for a row.
QWidget* FramePanel::buildSwitches() {
  auto* legend = new QWidget;
  auto* flow = new FlowLayout;
  flow->setContentsMargins(4, 0, 4, 3);
  legend->setLayout(flow);
  folded_ = new QToolButton;
  folded_->setObjectName(QStringLiteral("foldedOverlays"));
  folded_->setText(tr("Overlays"));
  folded_->setAutoRaise(true);
  folded_->setPopupMode(QToolButton::InstantPopup);
  auto* menu = new QMenu(folded_);
  connect(menu, &QMenu::aboutToShow, this, [this, menu] {
    menu->clear();
    for (QToolButton* toggle : toggles_) {
      QAction* action = menu->addAction(toggle->text(), toggle, &QToolButton::click);
      action->setCheckable(true);
      action->setChecked(toggle->isChecked());
      action->setToolTip(toggle->toolTip());
    }
  });
  menu->setToolTipsVisible(true);
  folded_->setMenu(menu);
  folded_->hide();
  flow->addWidget(folded_);
  for (const draw::OverlayLayer& layer : draw::overlayLayers()) {
    auto* button = new QToolButton;
    button->setObjectName(QLatin1String(layer.name));
    button->setText(tr(layer.title));
    button->setToolTip(tr(layer.tip));
    button->setCheckable(true);
    button->setAutoRaise(true);
    connect(button, &QToolButton::clicked, this,
            [this, &layer](bool on) { document_.setLayerVisible(layer.name, layer.title, on); });
    flow->addWidget(button);
    toggles_.push_back(button);
  }
  return legend;
}

void FramePanel::foldOverlays() {
  const bool low = height() < (pair_->on() || retexture_->on() ? kRoomBesidePair : kRoomForOverlays);
  if (folded_->isHidden() != low) return;
  folded_->setVisible(low);
  for (QToolButton* toggle : toggles_) toggle->setVisible(!low);
}

void FramePanel::resizeEvent(QResizeEvent* e) {
  QWidget::resizeEvent(e);
  foldOverlays();
  // In a low window the photograph keeps the largest share.
  switches_->setMost(std::max(30, height() * 28 / 100));
  captionsScroll_->setMost(std::max(40, height() * 28 / 100));
  retexture_->setMostWords(std::max(40, height() * 12 / 100));
}

void FramePanel::changeEvent(QEvent* e) {
  QWidget::changeEvent(e);
  if (e->type() == QEvent::PaletteChange) refresh_.start();  // the captions have colours of the theme
}

int FramePanel::frameOn(const FrameCanvas* canvas) const {
  return canvas == canvas_ ? document_.selection().frame : pair_->secondFrame();
}

bool FramePanel::busy() const {
  return refresh_.isActive() || loader_.busy() || secondLoader_.busy() || retexture_->busy() || edits_->busy() || lobes_->busy();
}

void FramePanel::showScene() {
  loader_.setScene(document_.sharedScene());
  secondLoader_.setScene(document_.sharedScene());
  pictured_ = {-1, -1};
  for (FrameCanvas* canvas : {canvas_, second_}) {
    canvas->setPhotograph(QImage());
    canvas->setHeld({}, {});
    canvas->fit();
  }
  showLook();
  showFrame();
}

void FramePanel::showLook() {
  const FrameSource source = DevelopBar::source(document_);
  const viz::Development development = DevelopBar::development(document_);
  loader_.setLook(source, development);
  secondLoader_.setLook(source, development);
  for (FrameCanvas* canvas : {canvas_, second_})
    canvas->setScale(development.falseColour ? viz::falseColourTicks(development) : std::vector<viz::ScaleTick>());
}

void FramePanel::showTitle() {
  if (!document_.scene()) {
    title_->clear();
    role_->hide();
    canvas_->setMessage(QString());
    return;
  }
  const int frame = document_.selection().frame;
  const draw::Colour colours[] = {draw::kTraining, {0.38, 0.38, 0.38}, draw::kExcluded};
  const int role = int(document_.role(frame));
  title_->setText(QStringLiteral("<b>%1</b>").arg(nameText(document_.scene()->frames[std::size_t(frame)].id).toHtmlEscaped()));
  role_->setText(roleName(document_.role(frame)));
  role_->setStyleSheet(
      QStringLiteral("background: %1; color: white; border-radius: 3px; padding: 1px 6px").arg(toQColor(colours[role]).name()));
  role_->show();
}

void FramePanel::showFrame() {
  refresh_.stop();
  showTitle();
  const bool two = document_.scene() && pair_->on();
  sideBySide_->setChecked(two);
  retextureTool_->setChecked(retexture_->on());
  if (two != second_->isVisibleTo(this)) {
    second_->setVisible(two);
    second_->fit();
  }
  if (document_.scene()) {
    const auto want = [this](PhotoLoader& loader, FrameCanvas* canvas, int pictured) {
      const int frame = frameOn(canvas);
      if (pictured != frame) canvas->setAwaited(photographAwaited(*document_.scene(), frame));
      loader.want(frame);
    };
    want(loader_, canvas_, pictured_[0]);
    if (two) want(secondLoader_, second_, pictured_[1]);
  }
  showOverlay();
}

draw::OverlayOptions FramePanel::overlayOptions() const {
  draw::OverlayOptions options;
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    if (!document_.layerVisible(layer.name)) options.hidden.insert(layer.role);
  if (options.hidden.count(draw::OverlayRole::ObservedPeak)) options.hidden.insert(draw::OverlayRole::PredictedPeak);
  for (const std::string& model : document_.request().models)
    if (!document_.layerVisible(kModelLayer + model)) options.hiddenModels.insert(model);
  options.colourByRole = document_.option("frame/colour-by", std::string("model")) == "role";
  options.residualScale = std::clamp(document_.option("frame/residual-scale", 1.0), 1.0, 1000.0);
  options.selection = document_.selection();
  options.samples = lobes_->samples();
  return options;
}

void FramePanel::showWalk(std::shared_ptr<const viz::WalkStory> walk, int step) {
  walk_ = std::move(walk);
  walkStep_ = step;
  refresh_.start();
}

void FramePanel::showOverlay() {
  const std::vector<draw::OverlayLayer>& layers = draw::overlayLayers();
  for (std::size_t i = 0; i < layers.size(); ++i) toggles_[i]->setChecked(document_.layerVisible(layers[i].name));
  for (const auto& [name, action] : layerActions_) action->setChecked(document_.layerVisible(name));
  draw::OverlayOptions options = overlayOptions();
  if (colourByRole_) colourByRole_->setChecked(options.colourByRole);
  const std::shared_ptr<const Inspection> inspection = document_.frameInspection(), results = document_.results();
  const bool marked = document_.frameStale() && canvas_->staleBadge().marks();
  options.predictionsEarlier = marked && inspection != results;
  const int frame = document_.selection().frame;
  const bool two = document_.scene() && pair_->on();
  shown_ = shownSecond_ = {};
  if (inspection && frame < int(inspection->evidence.size())) shown_ = draw::frameOverlay(*inspection, frame, options);
  if (inspection != results) keepErrors(draw::frameOverlay(*results, frame, options), shown_);
  if (walk_ && walk_->frame == frame) viz::addWalk(*walk_, walkStep_, shown_);
  showCaptions(shown_, marked);
  // What was changed by hand or synthesised would else be taken for what was captured.
  const auto note = [&](int f) { return inspection ? toQString(frameNote(inspection->request.whatIf, f)) : QString(); };
  if (two) {
    const int second = pair_->secondFrame();
    if (const auto all = document_.inspection(); all && second < int(all->evidence.size())) {
      shownSecond_ = draw::frameOverlay(*all, second, options);
      pair_->addLines(shown_, shownSecond_);
    }
    const auto& frames = document_.scene()->frames;
    const auto caption = [&](int f) {
      return QStringList{nameText(frames[std::size_t(f)].id), note(f)}.join(note(f).isEmpty() ? "" : " · ");
    };
    canvas_->setCaption(caption(frame));
    second_->setCaption(caption(second));
    second_->setOverlay(shownSecond_);
  } else {
    canvas_->setCaption(note(frame));
  }
  canvas_->setOverlay(shown_);
}

void FramePanel::showCaptions(const draw::FrameOverlay& overlay, bool earlier) {
  const FrameCaptions captions = frameCaptions(document_, overlay, palette(), earlier);
  // A reason that has gone leaves no empty lines behind.
  const bool noLonger = captions.failures < failuresShown_;
  if (overlay.captions.size() != captionCount_ || noLonger || fewerLines_) captions_->setMinimumHeight(0);
  if (!document_.stale()) fewerLines_ = false;  // until then these are still the lines of the what-if
  captionCount_ = overlay.captions.size();
  failuresShown_ = captions.failures;
  captions_->setText(captions.html);
  setRichTip(captions_, captions.tip);
  // It may grow but not shrink: the pictures above it would jump with every result.
  if (captions_->isVisible())  // else its width is not yet what it will be
    captions_->setMinimumHeight(std::max(captions_->minimumHeight(), captions_->heightForWidth(captions_->width())));
  captions_->setVisible(!captions.html.isEmpty());
}

QList<PairBar::KeyEntry> FramePanel::figureKey() const {
  QList<PairBar::KeyEntry> key = pair_->on() ? pair_->key() : QList<PairBar::KeyEntry>();
  const bool byRole = overlayOptions().colourByRole;
  const auto add = [&key](const QColor& colour, const QString& text) {
    const auto same = [&text](const PairBar::KeyEntry& e) { return e.text == text; };
    if (std::none_of(key.begin(), key.end(), same)) key.append({colour, text});
  };
  const draw::FrameOverlay* const both[] = {&shown_, &shownSecond_};
  for (const draw::FrameOverlay* overlay : both)
    for (const draw::OverlayLine& line : overlay->lines)
      if (line.role == draw::OverlayRole::ObservedContour && line.highlight >= 0) add(toQColor(draw::kObserved), tr("observed"));
  for (const draw::FrameOverlay* overlay : both)
    for (const draw::OverlayLine& line : overlay->lines)
      if (line.role == draw::OverlayRole::PredictedContour && line.highlight >= 0)
        add(toQColor(line.colour),
            byRole ? roleName(document_.role(frameOn(overlay == &shown_ ? canvas_ : second_))) : toQString(line.model));
  return key;
}

void FramePanel::followLink(const QString& target) {
  const std::string model = target.section(QLatin1Char(':'), 1).toStdString();
  if (target.startsWith(QStringLiteral("show:"))) {
    const std::string layer = kModelLayer + model;
    document_.setLayerVisible(layer, model, !document_.layerVisible(layer));
  } else {
    draw::Selection s = document_.selection();
    s.model = s.model == model ? std::string() : model;
    document_.select(s);
  }
}

void FramePanel::selectAt(double x, double y) {
  const std::shared_ptr<const Inspection> inspection = document_.frameInspection();
  if (!inspection) return;
  document_.selectExactly(
      viz::pickInFrame(*inspection, document_.selection(), shown_, {x, y}, FrameCanvas::kNearScreenPx / canvas_->zoom()));
}

void FramePanel::selectModelAt(double x, double y) {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection) return;
  draw::Selection there = document_.selection();
  there.frame = pair_->secondFrame();
  draw::Selection s = document_.selection();
  s.model = viz::pickInFrame(*inspection, there, shownSecond_, {x, y}, FrameCanvas::kNearScreenPx / second_->zoom()).model;
  document_.select(s);
}

void FramePanel::look(const QString& at, int highlight) {
  if (at == QLatin1String("tangent") || at == QLatin1String("highlight")) {
    zoomTo(highlight, at == QLatin1String("tangent"));
    zoomedByLook_ = true;
  } else if (std::exchange(zoomedByLook_, false)) {
    canvas_->fit();
    second_->fit();
  }
}

void FramePanel::goToHighlight() {
  zoomTo(document_.selection().highlight);
  follows_ = true;
}

/// Zoomed to the highlight one goes from frame to frame to compare it: it stays in the middle, at the same scale.
void FramePanel::followHighlight(int frame) {
  if (std::exchange(seenFrame_, frame) == frame || !follows_ || canvas_->fitted()) return;
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection || std::size_t(frame) >= inspection->evidence.size()) return;
  const std::vector<Highlight>& highlights = inspection->evidence[std::size_t(frame)].highlights;
  if (highlights.empty()) return;
  const auto same = std::find_if(highlights.begin(), highlights.end(),
                                 [&](const Highlight& h) { return h.light == document_.selection().light; });
  const Highlight& h = same == highlights.end() ? highlights.front() : *same;
  canvas_->lookAt(document_.scene()->frames[std::size_t(frame)].camera.distorted(centroid(h.contour)), canvas_->zoom());
}

void FramePanel::zoomTo(int highlight, bool withCanonical) {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection) return;
  const auto look = [&](FrameCanvas* canvas, int highlight) {
    const int frame = frameOn(canvas);
    if (frame >= int(inspection->evidence.size())) return;
    const std::vector<Highlight>& highlights = inspection->evidence[std::size_t(frame)].scored();
    const draw::Selection& now = document_.selection();
    const PredictedHighlight* const spurious =
        frame == now.frame && highlight < 0 ? draw::selectedSpurious(*inspection, now) : nullptr;
    if (highlights.empty() && !spurious) return;
    const Camera& camera = document_.scene()->frames[std::size_t(frame)].camera;
    Eigen::AlignedBox2d box;
    for (const Pixel& p : spurious ? spurious->contour.points
                                   : highlights[std::size_t(std::clamp(highlight, 0, int(highlights.size()) - 1))].contour.points)
      box.extend(camera.distorted(p));
    if (box.isEmpty()) return;
    // The highlight fills half of the canvas, so that its surroundings show.
    double share = 0.5;
    if (withCanonical) {  // on a bulging mirror several times as large
      const Eigen::AlignedBox2d photograph(Pixel(0, 0), Pixel(camera.width, camera.height));
      const draw::FrameOverlay overlay = draw::frameOverlay(*inspection, frame, overlayOptions());
      const Eigen::AlignedBox2d around =
          draw::extentAround(overlay, draw::OverlayRole::CanonicalEllipse, box.center()).intersection(photograph);
      if (!around.isEmpty() && !box.contains(around)) {
        share = 0.85;
        box.extend(around);
      }
    }
    const Eigen::Vector2d size = box.sizes().cwiseMax(4.0);
    canvas->lookAt(box.center(), share * std::min(canvas->width() / size.x(), canvas->height() / size.y()));
  };
  look(canvas_, highlight);
  if (pair_->on()) look(second_, -1);
}

void FramePanel::addActions(Actions& actions, QMenu* menu) {
  actions.add("frame.highlight", menu, tr("&Zoom to highlight"), [this] { goToHighlight(); },
              {{Qt::Key_F, Qt::Key_H}, "highlight"});
  actions.add("frame.fit", menu, tr("&Whole photograph"), [this] { canvas_->fit(); }, {{Qt::Key_0}, "fit"});
  actions.add("frame.pixels", menu, tr("&Actual pixels"), [this] { canvas_->onePixelPerPixel(); }, {{Qt::Key_1}, "pixels"});
  const auto zoom = [this](double factor) { canvas_->setZoom(canvas_->zoom() * factor, QRectF(canvas_->rect()).center()); };
  actions.add("frame.zoom-in", menu, tr("Zoom &in"), [zoom] { zoom(2); }, {{QKeySequence("Ctrl+Alt+Up")}});
  actions.add("frame.zoom-out", menu, tr("Zoom &out"), [zoom] { zoom(0.5); }, {{QKeySequence("Ctrl+Alt+Down")}});
  actions.add("frame.values", menu, tr("Zoom to pixel &values"),
              [this] { canvas_->setZoom(1.2 * FrameCanvas::kValuesFromZoom, QRectF(canvas_->rect()).center()); });
  QAction* hand = actions.addToggle(
      "frame.hand", menu, tr("Move by han&d"), [this](bool on) { hand_->setOn(on); },
      {{Qt::Key_E}, "hand", tr("What-if: drag an observed contour (Shift: resize it), its peak or, with Ctrl, the camera")});
  hand->setChecked(hand_->isOn());
  connect(hand_, &HandTool::onChanged, hand, &QAction::setChecked);
  develop_->addActions(actions, menu->addMenu(tr("Photog&raph")));
  QMenu* overlays = menu->addMenu(tr("Ov&erlays"));
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    layerActions_[layer.name] = actions.addToggle(
        QStringLiteral("frame.show-") + QString(QLatin1String(layer.name)).section('/', 1), overlays, tr(layer.title),
        [this, &layer](bool on) { document_.setLayerVisible(layer.name, layer.title, on); }, {{}, {}, tr(layer.tip)});
  for (const auto& model : allModels()) {
    const std::string id = model->id(), layer = kModelLayer + id;
    layerActions_[layer] = actions.addToggle(QStringLiteral("frame.show-model-") + toQString(id), overlays,
                                             tr("Model %1").arg(menuText(toQString(id))),
                                             [this, id, layer](bool on) { document_.setLayerVisible(layer, id, on); }, {});
  }
  colourByRole_ = actions.addToggle("frame.colour-by-role", overlays, tr("Colour predictions by frame &role"),
                                    [this](bool on) {
                                      document_.setOption("frame/colour-by", on ? "role" : "model",
                                                          on ? tr("Colour by role") : tr("Colour by model"));
                                    },
                                    {});
  for (const int scale : {1, 10, 100})
    actions.add(QStringLiteral("frame.residuals-x%1").arg(scale), overlays, tr("Residual arrows × %1").arg(scale), [this, scale] {
      if (document_.layerVisible("frame/residuals"))
        return document_.setOption("frame/residual-scale", double(scale), tr("Residual arrows × %1").arg(scale));
      document_.undoStack()->beginMacro(tr("Residual arrows × %1").arg(scale));
      document_.setOption("frame/residual-scale", double(scale), QString());
      document_.setLayerVisible("frame/residuals", "Residuals", true);
      document_.undoStack()->endMacro();
    });
  edits_->addActions(actions, menu->addMenu(tr("Highlight&s")));
  pair_->addActions(actions, menu->addMenu(tr("Side b&y side")));
  retexture_->addActions(actions, menu->addMenu(tr("Rete&xture")));
  showOverlay();
}

}  // namespace glint::gui
