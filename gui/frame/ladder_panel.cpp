// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/ladder_panel.h"

#include <QEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QVBoxLayout>
#include <algorithm>

#include "core/draw/frame_overlay.h"
#include "core/pipeline/frame_score.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/photo_loader.h"
#include "viz/frame_pick.h"
#include "viz/pictures.h"

namespace glint::gui {

namespace {
constexpr int kGap = 4;
constexpr QChar kSquare(0x25A0);
}  // namespace

LadderPanel::LadderPanel(Document& document, PhotoLoader& loader, QWidget* parent)
    : QWidget(parent), document_(document), loader_(loader) {
  empty_ = new QLabel(tr("No models computed yet"), this);
  empty_->setAlignment(Qt::AlignCenter);
  refresh_.setSingleShot(true);
  refresh_.setInterval(0);
  connect(&refresh_, &QTimer::timeout, this, &LadderPanel::refresh);
  for (const auto signal : {&Document::sceneOpened, &Document::selectionChanged, &Document::layersChanged,
                            &Document::optionsChanged, &Document::inspectionChanged})
    connect(&document_, signal, this, &LadderPanel::scheduleRefresh);
  connect(&document_, &Document::frameInspectionChanged, this, [this] {
    if (!document_.inspection()) scheduleRefresh();
  });
  connect(&document_, &Document::sceneOpened, this, [this] {
    frame_ = -1;
    moved_ = false;
  });
  connect(&document_, &Document::staleChanged, this, &LadderPanel::markStale);
  connect(&loader_, &PhotoLoader::behindChanged, this, &LadderPanel::markStale);
  connect(&loader_, &PhotoLoader::loaded, this, [this](int frame, const FramePicture& picture) {
    if (frame != document_.selection().frame || !isVisible()) return;
    for (const Tile& tile : tiles_) tile.canvas->setPicture(picture);
    arrange();
  });
  connect(&loader_, &PhotoLoader::failed, this, [this](int frame, const QString& reason) {
    if (frame != document_.selection().frame) return;
    for (const Tile& tile : tiles_) tile.canvas->setMessage(reason);
  });
}

std::vector<FrameCanvas*> LadderPanel::canvases() const {
  std::vector<FrameCanvas*> all;
  for (const Tile& tile : tiles_) all.push_back(tile.canvas);
  return all;
}

/// When a scene opens, the selected frame's results come before all others, and the frame view shows them too.
std::shared_ptr<const Inspection> LadderPanel::inspection() const {
  return document_.inspection() ? document_.inspection() : document_.frameInspection();
}

void LadderPanel::changeEvent(QEvent* e) {
  QWidget::changeEvent(e);
  if (e->type() == QEvent::PaletteChange) scheduleRefresh();  // captions have colours of the theme
}

void LadderPanel::markStale() {
  for (const Tile& tile : tiles_) tile.canvas->setStale(document_.stale() || loader_.behind());
}

void LadderPanel::scheduleRefresh() {
  if (isVisible()) refresh_.start();
}

void LadderPanel::showEvent(QShowEvent*) { refresh(); }
void LadderPanel::resizeEvent(QResizeEvent*) { arrange(); }

void LadderPanel::refresh() {
  const std::shared_ptr<const Inspection> inspection = this->inspection();
  const int frame = document_.selection().frame;
  const bool any = inspection && frame < int(inspection->evidence.size());
  const std::vector<std::string> models = any ? modelsInOrder(*inspection) : std::vector<std::string>();
  std::vector<std::string> shown;
  for (const Tile& tile : tiles_) shown.push_back(tile.model);
  if (models != shown) rebuild(models);
  empty_->setVisible(models.empty());
  for (Tile& tile : tiles_) showTile(tile);
  if (frame != frame_ || whole_) {
    frame_ = frame;
    recentre_ = true;
    const std::optional<draw::Crop> crop = any ? viz::highlightCrop(*inspection, frame, {}, 0) : std::nullopt;
    whole_ = !crop;
    if (crop) crop_ = *crop;
    if (!crop && document_.scene()) {
      const Camera& camera = document_.scene()->frames[std::size_t(frame)].camera;
      crop_ = {-0.5, -0.5, double(camera.width), double(camera.height)};
    }
  }
  arrange();
}

void LadderPanel::rebuild(const std::vector<std::string>& models) {
  for (const Tile& tile : tiles_) tile.box->deleteLater();
  tiles_.clear();
  moved_ = false;  // new canvases have no view yet
  recentre_ = true;
  for (const std::string& model : models) {
    Tile tile{model, new QWidget(this), new FrameCanvas, new QLabel};
    tile.canvas->setObjectName(QStringLiteral("ladder:") + toQString(model));
    tile.canvas->setMinimumSize(24, 24);
    tile.canvas->setStale(document_.stale() || loader_.behind());
    tile.text->setTextFormat(Qt::RichText);
    tile.text->setMargin(2);
    auto* column = new QVBoxLayout(tile.box);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    column->addWidget(tile.canvas, 1);
    column->addWidget(tile.text);
    connect(tile.canvas, &FrameCanvas::clicked, this, [this, model](double x, double y) { selectIn(model, x, y); });
    connect(tile.canvas, &FrameCanvas::viewMoved, this, [this, canvas = tile.canvas] {
      moved_ = true;
      for (const Tile& other : tiles_)
        if (other.canvas != canvas) other.canvas->lookAt(canvas->centre(), canvas->zoom());
    });
    if (loader_.pictureFrame() == document_.selection().frame) tile.canvas->setPicture(loader_.picture());
    tile.box->show();
    tiles_.push_back(tile);
  }
}

void LadderPanel::arrange() {
  empty_->setGeometry(rect());
  if (tiles_.empty() || crop_.width <= 0) return;
  const int count = int(tiles_.size());
  int columns = 1;
  // A narrow tile has its error below the model's name.
  for (lines_ = 1;; ++lines_) {
    columns = viz::ladderColumns(count, width(), height(), captionHeight(lines_) + kGap, crop_.width / crop_.height);
    const int wide = (width() + kGap) / columns - kGap;
    if (lines_ == 2 || std::all_of(tiles_.begin(), tiles_.end(), [&](const Tile& t) { return fitsOneLine(t, wide); })) break;
  }
  const int rows = (count + columns - 1) / columns;
  for (int i = 0; i < count; ++i) {
    const int column = i % columns, row = i / columns;
    const int left = column * (width() + kGap) / columns, right = (column + 1) * (width() + kGap) / columns - kGap;
    const int top = row * (height() + kGap) / rows, bottom = (row + 1) * (height() + kGap) / rows - kGap;
    tiles_[std::size_t(i)].box->setGeometry(left, top, right - left, bottom - top);
    tiles_[std::size_t(i)].text->setFixedHeight(captionHeight(lines_));
    tiles_[std::size_t(i)].box->layout()->activate();
    showCaption(tiles_[std::size_t(i)]);
  }
  const FrameCanvas* first = tiles_.front().canvas;
  // A new frame's highlight comes into the middle; what the user moved to otherwise stays.
  const Pixel centre = moved_ && !recentre_ ? first->centre() : Pixel(crop_.x + crop_.width / 2, crop_.y + crop_.height / 2);
  const double zoom = moved_ ? first->zoom() : std::min(first->width() / crop_.width, first->height() / crop_.height);
  recentre_ = false;
  for (const Tile& tile : tiles_) tile.canvas->lookAt(centre, zoom);
}

void LadderPanel::showTile(Tile& tile) {
  const std::shared_ptr<const Inspection> inspection = this->inspection();
  const int frame = document_.selection().frame;
  draw::OverlayOptions options;
  options.models = {tile.model};
  options.selection = document_.selection();
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    if (!document_.layerVisible(layer.name)) options.hidden.insert(layer.role);
  if (options.hidden.count(draw::OverlayRole::ObservedPeak)) options.hidden.insert(draw::OverlayRole::PredictedPeak);
  options.residualScale = std::clamp(document_.option("frame/residual-scale", 1.0), 1.0, 1000.0);
  const draw::FrameOverlay overlay = draw::frameOverlay(*inspection, frame, options);
  const bool selected = document_.selection().model == tile.model;
  tile.below.clear();
  tile.brief.clear();
  tile.failed = false;
  for (const draw::OverlayCaption& c : overlay.captions) {
    if (c.model != tile.model) continue;
    tile.colour = toQColor(c.colour);
    tile.failed = !wholeErrorPct(c.score);
    const bool some = c.score.missed > 0 && c.score.matched > 0;
    tile.below = some          ? toQString(missedText(c.score))
                 : tile.failed ? toQString(c.score.reason)
                               : tr("%1 %   %2 px").arg(numberText(*c.score.errorPct, 3), numberText(*c.score.errorPx, 3));
    if (!tile.failed && !c.score.reason.empty()) tile.below += tr(", poor");  // the tool tip says why
    tile.brief = tile.failed ? tile.below : tr("%1 %").arg(numberText(*c.score.errorPct, 3));
    tile.text->setToolTip(toQString(c.text));
  }
  // A reason may be longer than the tile: it is cut, the tool tip has it whole.
  tile.text->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  tile.text->setStyleSheet(selected ? QStringLiteral("background: %1; color: white").arg(accentColour().darker(120).name())
                                    : QString());
  showCaption(tile);
  tile.canvas->setOverlay(overlay);
  if (loader_.pictureFrame() == frame)
    tile.canvas->setPicture(loader_.picture());
  else
    tile.canvas->setAwaited(photographAwaited(*inspection->scene, frame));
}

int LadderPanel::captionHeight(int lines) const {
  const QLabel* text = tiles_.front().text;
  return lines * (text->fontMetrics().height() + 1) + 2 * text->margin() + 2;
}

bool LadderPanel::fitsOneLine(const Tile& tile, int width) const {
  if (tile.failed || tile.below.isEmpty()) return true;  // a reason is cut anyway
  QFont bold = tile.text->font();
  bold.setBold(true);
  const QFontMetrics plain(tile.text->font());
  const int marks = plain.horizontalAdvance(kSquare + QString(3, QChar::Nbsp)), edges = 2 * tile.text->margin() + 4;
  return marks + edges + QFontMetrics(bold).horizontalAdvance(toQString(tile.model)) + plain.horizontalAdvance(tile.below) <=
         width;
}

void LadderPanel::showCaption(const Tile& tile) {
  QFont bold = tile.text->font();
  bold.setBold(true);
  const QFontMetrics heading(bold), plain(tile.text->font());
  const QString space(QChar::Nbsp);
  const int room = tile.box->width() - 2 * tile.text->margin() - 4, mark = plain.horizontalAdvance(kSquare + space);
  const QString model = heading.elidedText(toQString(tile.model), Qt::ElideRight, std::max(0, room - mark));
  const int left = lines_ == 2 ? room : room - mark - heading.horizontalAdvance(model) - plain.horizontalAdvance(space + space);
  const QString fitting = plain.horizontalAdvance(tile.below) <= left ? tile.below : tile.brief;
  const QString below = left > 0 ? plain.elidedText(fitting, Qt::ElideRight, left).toHtmlEscaped() : QString();
  tile.text->setText(
      QStringLiteral("<span style='color:%1'>%2</span>%3<b>%4</b>%5%6")
          .arg(tile.colour.name(), QString(kSquare), space, model.toHtmlEscaped(),
               lines_ == 2 ? QStringLiteral("<br>") : space + space,
               tile.failed ? QStringLiteral("<span style='color:%1'>%2</span>").arg(warningColour().name(), below) : below));
}

void LadderPanel::selectIn(const std::string& model, double x, double y) {
  const std::shared_ptr<const Inspection> inspection = this->inspection();
  if (!inspection) return;
  draw::OverlayOptions options;
  options.models = {model};
  draw::Selection s = document_.selection();
  double zoom = 1;
  for (const Tile& tile : tiles_)
    if (tile.model == model) zoom = tile.canvas->zoom();
  const draw::FrameOverlay overlay = draw::frameOverlay(*inspection, s.frame, options);
  s = viz::pickInFrame(*inspection, s, overlay, {x, y}, FrameCanvas::kNearScreenPx / zoom);
  s.model = model;
  document_.select(s);
}

void LadderPanel::lookAtHighlight() {
  moved_ = false;
  arrange();
}

void LadderPanel::addActions(Actions& actions, QMenu* menu) {
  actions.add("ladder.highlight", menu, tr("Ladder: zoom to highlight"), [this] { lookAtHighlight(); });
}

}  // namespace glint::gui
