// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/timeline_strip.h"

#include <QContextMenuEvent>
#include <QHelpEvent>
#include <QMenu>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "gui/base/focus_frame.h"
#include "gui/base/picture_access.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/document/frame_roles.h"
#include "gui/timeline/light_switches.h"
#include "viz/style.h"

namespace glint::gui {

namespace {
constexpr double kLeft = 56, kRight = 10, kTop = 4, kMarkRow = 17;  // px; the axis has more where its texts are larger
constexpr double kBesideAxis = 9;                                   // px: left and right of a text of the axis
constexpr double kThumbnailHeight = 34, kRoomForThumbnails = 112;   // below this height only errors and roles are shown
constexpr double kMinFramesInView = 4;
constexpr double kSmall = 0.85;           // its texts, of those of the window
constexpr double kNamedRow = 10;          // height of a light's row with its name, at the usual size of texts
const QColor kLightOn(0xf0, 0xe4, 0x42);  // draw::kLightColour
QPointF positionOf(const QMouseEvent& e) {
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  return e.position();
#else
  return e.localPos();
#endif
}
}  // namespace

TimelineStrip::TimelineStrip(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  setFocusPolicy(Qt::StrongFocus);
  new FocusFrame(this);
  setMouseTracking(true);
  setAttribute(Qt::WA_OpaquePaintEvent);
  connect(&document_, &Document::sceneOpened, this, [this] {
    thumbnails_.setScene(document_.sharedScene());
    first_ = 0;
    inView_ = std::max(1, document_.frameCount());
    readData();
    emit viewChanged();
  });
  connect(&document_, &Document::inspectionChanged, this, &TimelineStrip::readData);
  connect(&document_, &Document::requestChanged, this, [this] {  // a slider of the detection changes nothing that is drawn
    const InspectionRequest& q = document_.request();
    if (q.train != drawn_.train || q.excluded != drawn_.excluded || q.whatIf != drawn_.whatIf) readView();
  });
  connect(&document_, &Document::optionsChanged, this, &TimelineStrip::readView);
  badge_ = new StaleBadge(this);
  connect(&document_, &Document::staleChanged, badge_, &StaleBadge::setStale);
  connect(badge_, &StaleBadge::marked, this, &TimelineStrip::repaintAll);
  connect(&document_, &Document::selectionChanged, this, &TimelineStrip::showSelection);
  connect(&thumbnails_, &Thumbnails::arrived, this, &TimelineStrip::repaintAll);
  describe();
}

void TimelineStrip::readData() {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (inspection) thumbnails_.setInspection(inspection);
  data_ = document_.scene() ? viz::timelineData(*document_.scene(), inspection.get()) : viz::TimelineData();
  readView();
}

void TimelineStrip::readView() {
  bars_ = document_.option("timeline/chart", std::string("lines")) == "bars";
  thumbnailsOn_ = document_.option("timeline/thumbnails", std::string("on")) == "on";
  plotted_ = document_.plottedModel();
  drawn_ = {document_.request().train, document_.request().excluded, document_.request().whatIf};
  axis_ = viz::errorAxis(data_, bars_ ? plotted_ : std::string(), shownExcluded(document_));
  measure();
  repaintAll();
}

QFont TimelineStrip::smallFont() const {
  QFont small = font();
  small.setPointSizeF(font().pointSizeF() * kSmall);
  return small;
}

/// In large print (a presentation) its texts need more room.
void TimelineStrip::measure() {
  const QFontMetricsF metrics(smallFont());
  scale_ = std::max(1.0, metrics.height() / kLine);
  left_ = kLeft;
  for (const QString& text : axisTexts()) left_ = std::max(left_, metrics.horizontalAdvance(text) + kBesideAxis);
}

void TimelineStrip::setUnreadable(const QMap<int, QString>& reasons) {
  if (reasons == unreadable_) return;
  unreadable_ = reasons;
  repaintAll();
}

void TimelineStrip::describe() {
  const auto words = [this] {
    if (!document_.scene()) return tr("No frames");
    return tr("%1 frames. Selected: %2").arg(document_.frameCount()).arg(toolTip(document_.selection().frame));
  };
  describePicture(this, tr("Frames of the sequence"), words,
                  {[this] { return document_.frameCount(); }, [this](int frame) { return toolTip(frame); },
                   [this](int frame) { return cell(frame).toAlignedRect().intersected(rect()); },
                   [this] { return document_.selection().frame; }, [this](int frame) { document_.selectFrame(frame); }});
}

void TimelineStrip::showSelection() {
  announceSelection(this);
  const double frame = document_.selection().frame;
  if (frame < first_ || frame + 1 > first_ + inView_) setView(frame < first_ ? frame : frame + 1 - inView_, inView_);
  if (document_.plottedModel() != plotted_) readView();
  update();
}

void TimelineStrip::repaintAll() {
  background_ = QPixmap();
  update();
}

void TimelineStrip::setView(double first, double inView) {
  const double n = std::max(1, document_.frameCount());
  inView = std::clamp(inView, std::min(kMinFramesInView, n), n);
  first = std::clamp(first, 0.0, n - inView);
  if (first == first_ && inView == inView_) return;
  first_ = first;
  inView_ = inView;
  repaintAll();
  emit viewChanged();
}

void TimelineStrip::zoomAt(double frame, double factor) {
  const double share = (frame - first_) / inView_, n = std::max(1, document_.frameCount());
  const double inView = std::clamp(inView_ / factor, std::min(kMinFramesInView, n), n);
  setView(frame - share * inView, inView);
}

void TimelineStrip::zoom(double factor) { zoomAt(document_.selection().frame + 0.5, factor); }

QRectF TimelineStrip::thumbnailRow() const {
  const bool on = thumbnailsOn_ && height() >= kRoomForThumbnails;
  return QRectF(left_, kTop, width() - left_ - kRight, on ? kThumbnailHeight : 0);
}

double TimelineStrip::lightRowHeight() const {
  return data_.lights.empty() ? 0 : namesLights() ? kNamedRow * scale_ : std::clamp(24.0 / double(data_.lights.size()), 2.0, 7.0);
}

bool TimelineStrip::namesLights() const {
  const double leastChart = 24 * scale_;  // its two numbers
  const double rest = height() - kMarkRow - lineHeight() - thumbnailRow().bottom() - 6 * scale_;
  return rest - kNamedRow * scale_ * double(data_.lights.size()) >= leastChart;
}

int TimelineStrip::lightAt(double y) const {
  const double row = (y - chart().bottom() - 1) / std::max(1.0, lightRowHeight());
  return row >= 0 && row < double(data_.lights.size()) ? int(row) : -1;
}

QRectF TimelineStrip::chart() const {
  const double top = thumbnailRow().bottom() + 6 * scale_;
  const double bottom = height() - kMarkRow - lineHeight() - lightRowHeight() * double(data_.lights.size());
  return QRectF(left_, top, width() - left_ - kRight, std::max(8.0, bottom - top));
}

double TimelineStrip::frameX(double frame) const { return left_ + (frame - first_) / inView_ * (width() - left_ - kRight); }

QRectF TimelineStrip::cell(int frame) const {
  return QRectF(frameX(frame), kTop, (width() - left_ - kRight) / inView_, chart().bottom() - kTop);
}

QRectF TimelineStrip::roleMark(int frame) const {
  const QRectF c = cell(frame);
  return QRectF(c.left(), height() - lineHeight() - kMarkRow, c.width(), kMarkRow);
}

QRectF TimelineStrip::lightMark(int light, int frame) const {
  const QRectF c = cell(frame);
  return QRectF(c.left(), chart().bottom() + 1 + light * lightRowHeight(), c.width(), lightRowHeight() - 1);
}

int TimelineStrip::frameAt(const QPointF& position) const {
  const int n = document_.frameCount();
  if (n == 0 || position.x() < left_ || position.x() >= width() - kRight) return -1;
  return std::clamp(int(first_ + (position.x() - left_) / (width() - left_ - kRight) * inView_), 0, n - 1);
}

void TimelineStrip::paintEvent(QPaintEvent*) {
  if (background_.isNull()) paintBackground();
  QPainter painter(this);
  painter.drawPixmap(0, 0, background_);
  const int n = document_.frameCount(), frame = document_.selection().frame;
  if (n == 0) return;
  QRectF current = cell(frame);
  current.setBottom(height() - 1);
  if (current.width() < 3) current = QRectF(current.center().x() - 1.5, current.top(), 3, current.height());
  QColor accent = accentColour();
  accent.setAlpha(70);
  painter.fillRect(current, accent);
  painter.setPen(QPen(accentColour(), 1));
  painter.drawRect(current.adjusted(0, 0, -1, 0));
  painter.setFont(smallFont());
  const QString number = idText(frame);
  QRectF label(0, 0, painter.fontMetrics().horizontalAdvance(number) + 8, lineHeight());
  label.moveCenter({std::clamp(current.center().x(), left_, width() - kRight), height() - lineHeight() / 2 - 1});
  painter.fillRect(label, accentColour());
  painter.setPen(Qt::white);
  painter.drawText(label, Qt::AlignCenter, number);
}

void TimelineStrip::paintBackground() {
  ++backgroundsPainted_;
  background_ = QPixmap(size() * devicePixelRatioF());
  background_.setDevicePixelRatio(devicePixelRatioF());
  background_.fill(palette().color(QPalette::Base));
  QPainter painter(&background_);
  painter.setFont(smallFont());
  if (document_.frameCount() == 0) {
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(rect(), Qt::AlignCenter, tr("No frames"));
    return;
  }
  paintThumbnails(painter);
  paintErrors(painter);
  paintLights(painter);
  paintRoles(painter);
  paintUnreadable(painter);
}

void TimelineStrip::paintThumbnails(QPainter& painter) {
  const QRectF row = thumbnailRow();
  if (row.height() <= 0) return;
  const Camera& camera = document_.scene()->frames.front().camera;
  const double wide = row.height() * camera.width / std::max(1, camera.height);
  const double cellWidth = cell(0).width();
  const int every = std::max(1, int(std::ceil((wide + 2) / cellWidth)));
  QList<int> wanted;
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.setClipRect(row);
  // Multiples of `every`, so that scrolling shows the same frames again.
  for (int i = int(first_) / every * every; i < document_.frameCount() && i < first_ + inView_; i += every) {
    wanted << i;
    const QImage picture = thumbnails_.find(i);
    const double x = every == 1 ? frameX(i + 0.5) - wide / 2 : frameX(i) + 1;
    const QRectF box(x, row.top(), wide, row.height());
    if (picture.isNull() || unreadable_.contains(i))
      painter.fillRect(box, palette().color(QPalette::AlternateBase));
    else
      painter.drawImage(box, picture);
    if (document_.role(i) == FrameRole::Excluded) painter.fillRect(box, QColor(0, 0, 0, 150));
  }
  painter.setClipping(false);
  painter.setRenderHint(QPainter::Antialiasing);
  for (auto it = unreadable_.begin(); it != unreadable_.end(); ++it) {
    if (it.key() + 1 <= first_ || it.key() >= first_ + inView_) continue;
    if (every == 1) {
      const QRectF box(frameX(it.key() + 0.5) - wide / 2, row.top(), wide, row.height());
      painter.setPen(QPen(warningColour(), 1));
      painter.drawRect(box.adjusted(0.5, 0.5, -0.5, -0.5));
      painter.drawLine(box.topLeft(), box.bottomRight());
      painter.drawLine(box.topRight(), box.bottomLeft());
    }
  }
  thumbnails_.want(wanted, int(std::ceil(row.height() * devicePixelRatioF())));
}

void TimelineStrip::paintLights(QPainter& painter) {
  painter.setRenderHint(QPainter::Antialiasing, false);
  const double rowHeight = lightRowHeight(), wide = cell(0).width();
  double top = chart().bottom() + 1;
  for (const viz::LightRow& row : data_.lights) {
    for (int i = firstInView(); i < endOfView(); ++i) {
      const QRectF box(frameX(i), top, std::max(1.0, wide - (wide > 4 ? 1 : 0)), rowHeight - 1);
      const viz::LightState state = viz::lightState(row, *document_.scene(), document_.request().whatIf, i);
      if (state == viz::LightState::NotStated) continue;
      painter.fillRect(box, viz::isLit(state) ? kLightOn : palette().color(QPalette::Midlight));
      if (state != viz::LightState::SwitchedOff && state != viz::LightState::SwitchedOn) continue;
      // A line through it: not as captured.
      painter.fillRect(QRectF(box.left(), box.center().y() - 1, box.width(), 2),
                       state == viz::LightState::SwitchedOff ? errorColour() : accentColour());
    }
    top += rowHeight;
  }
  painter.setPen(palette().color(QPalette::PlaceholderText));
  if (!data_.lights.empty() && namesLights()) {
    const QFont usual = painter.font();
    QFont tiny = usual;
    tiny.setPixelSize(int((kNamedRow - 1) * scale_));
    painter.setFont(tiny);
    for (std::size_t i = 0; i < data_.lights.size(); ++i) {
      const QRectF place(0, top - rowHeight * double(data_.lights.size() - i) - 1, left_ - 5, rowHeight);
      painter.drawText(place, Qt::AlignRight | Qt::AlignVCenter,
                       painter.fontMetrics().elidedText(nameText(data_.lights[i].light), Qt::ElideMiddle, int(left_) - 7));
    }
    painter.setFont(usual);
  } else if (!data_.lights.empty()) {
    painter.drawText(QRectF(0, top - rowHeight * double(data_.lights.size()) / 2 - lineHeight() / 2, left_ - 5, lineHeight()),
                     Qt::AlignRight | Qt::AlignVCenter, tr("lights"));
  }
}

void TimelineStrip::paintRoles(QPainter& painter) {
  painter.setRenderHint(QPainter::Antialiasing);
  const int from = firstInView(), to = endOfView();
  const double wide = cell(0).width();
  int widest = 0;
  for (int i = from; i < to; i += std::max(1, (to - from) / 16))
    widest = std::max(widest, painter.fontMetrics().horizontalAdvance(idText(i)));
  const int labelEvery = std::max(1, int(std::ceil((widest + 10) / wide)));
  for (int i = from; i < to; ++i) {
    paintRole(painter, i, wide);
    if (i % labelEvery != 0) continue;
    painter.setPen(palette().color(QPalette::PlaceholderText));
    painter.drawText(QRectF(frameX(i + 0.5) - 40 * scale_, height() - lineHeight() - 1, 80 * scale_, lineHeight()),
                     Qt::AlignCenter, idText(i));
  }
}

/// @param wide  px, of a frame
void TimelineStrip::paintRole(QPainter& painter, int frame, double wide) {
  const double r = std::clamp(wide / 2 - 1, 0.75, 4.5);
  const FrameRole role = document_.role(frame);
  const QPointF mark = roleMark(frame).center();
  if (role == FrameRole::Training) {
    painter.fillRect(QRectF(mark - QPointF(r, 4.5), mark + QPointF(r, 4.5)), toQColor(draw::kTraining).lighter(130));
  } else if (role == FrameRole::HeldOut) {
    painter.setPen(QPen(toQColor(draw::kHeldOut), 1.3));
    if (wide > 6)
      painter.drawEllipse(mark, r - 0.5, r - 0.5);
    else
      painter.drawPoint(mark);
  } else {
    painter.setPen(QPen(toQColor(draw::kExcluded).lighter(130), 1.5));
    painter.drawLine(mark - QPointF(r, 4), mark + QPointF(r, 4));
    painter.drawLine(mark + QPointF(-r, 4), mark + QPointF(r, -4));
  }
}

void TimelineStrip::paintUnreadable(QPainter& painter) {
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(warningColour());
  const double y = chart().top() - 6, r = 4;  // between thumbnails and errors, which also a narrow strip has
  for (auto it = unreadable_.begin(); it != unreadable_.end(); ++it) {
    const double x = frameX(it.key() + 0.5);
    if (x < left_ || x > width() - kRight) continue;
    painter.drawPolygon(QPolygonF({{x - r, y + 2 * r - 2}, {x + r, y + 2 * r - 2}, {x, y - 2}}));
  }
}

void TimelineStrip::resizeEvent(QResizeEvent*) { repaintAll(); }

void TimelineStrip::changeEvent(QEvent* e) {
  if (e->type() == QEvent::FontChange || e->type() == QEvent::StyleChange) measure();
  if (e->type() == QEvent::PaletteChange || e->type() == QEvent::FontChange || e->type() == QEvent::StyleChange) repaintAll();
  QWidget::changeEvent(e);
}

void TimelineStrip::wheelEvent(QWheelEvent* e) {
  const QPoint turn = e->angleDelta();
  if (e->modifiers() & Qt::ShiftModifier || turn.x() != 0) {
    const int by = turn.x() != 0 ? turn.x() : turn.y();
    setView(first_ - by / 120.0 * inView_ / 10, inView_);
  } else {
    zoomAt(first_ + (e->position().x() - left_) / (width() - left_ - kRight) * inView_, std::pow(2.0, turn.y() / 240.0));
  }
  e->accept();
}

void TimelineStrip::step(int by) {
  const int n = document_.frameCount();
  if (n <= 0) return;
  document_.selectFrame(std::clamp(document_.selection().frame + by, 0, n - 1), steps_.gesture(document_));
}

void TimelineStrip::mousePressEvent(QMouseEvent* e) {
  scrubbing_ = false;
  const int frame = frameAt(positionOf(*e));
  if (e->button() != Qt::LeftButton || frame < 0) return;
  if (const int light = lightAt(positionOf(*e).y()); light >= 0) {
    const viz::LightRow& row = data_.lights[std::size_t(light)];
    if (canSwitch(document_, viz::lightState(row, *document_.scene(), document_.request().whatIf, frame)))
      switchLight(document_, row, frame);
    else
      showTip(e->globalPos(), lightTip(light, frame), this);
    return;
  }
  if (e->modifiers() & Qt::ControlModifier) {  // a plain click selects: looking at a frame must not exclude it
    const FrameRole next[] = {FrameRole::HeldOut, FrameRole::Excluded,
                              FrameRole::Training};  // after training, held out, excluded
    document_.setRole(frame, next[int(document_.role(frame))]);
    return;
  }
  scrubbing_ = true;
  gesture_ = document_.newGesture();
  document_.selectFrame(frame, gesture_);
}

void TimelineStrip::mouseMoveEvent(QMouseEvent* e) {
  const int frame = frameAt(positionOf(*e));
  if (!(e->buttons() & Qt::LeftButton)) {
    const bool clickable = frame >= 0 && lightAt(positionOf(*e).y()) >= 0;
    setCursor(clickable ? Qt::PointingHandCursor : Qt::ArrowCursor);
    return;
  }
  if (scrubbing_ && frame >= 0) document_.selectFrame(frame, gesture_);
}

void TimelineStrip::contextMenuEvent(QContextMenuEvent* e) {
  const int frame = frameAt(e->pos());
  if (frame < 0) return;
  QMenu menu(this);
  const QString id = nameText(document_.scene()->frames[std::size_t(frame)].id);
  menu.addSection(tr("Frame %1").arg(menuText(id)));
  addRoles(menu, document_, frame);
  if (!data_.lights.empty()) {
    menu.addSeparator();
    addLights(menu, document_, data_.lights, frame);
  }
  if (const int light = lightAt(e->pos().y()); light >= 0) {
    const viz::LightRow row = data_.lights[std::size_t(light)];
    const QString name = menuText(lightText(row.light));
    menu.addAction(tr("Switch %1 off in every frame").arg(name), this,
                   [this, row] { switchLightEverywhere(document_, row, false); });
    menu.addAction(tr("Restore %1 in every frame").arg(name), this, [this, row] { switchLightEverywhere(document_, row, true); });
  }
  menu.addSeparator();
  menu.addAction(tr("Show beside selected frame"), this, [this, frame, id] {
    document_.undoStack()->beginMacro(tr("Show frame %1 beside").arg(id));
    document_.setOption("frame/second", double(frame), QString());
    document_.setOption("frame/side-by-side", "on", QString());
    document_.undoStack()->endMacro();
  });
  menu.exec(e->globalPos());
}

void TimelineStrip::keyPressEvent(QKeyEvent* e) {
  const int n = document_.frameCount();
  switch (e->key()) {
    case Qt::Key_Left: return step(-1);
    case Qt::Key_Right: return step(1);
    case Qt::Key_Home: return step(-n);
    case Qt::Key_End: return step(n);
    case Qt::Key_T: return document_.setRole(document_.selection().frame, FrameRole::Training);
    case Qt::Key_O: return document_.setRole(document_.selection().frame, FrameRole::HeldOut);
    case Qt::Key_X: return document_.setRole(document_.selection().frame, FrameRole::Excluded);
    default: QWidget::keyPressEvent(e);
  }
}

QString TimelineStrip::idText(int frame) const {
  constexpr int kMost = 10;  // characters
  const QString id = nameText(document_.scene()->frames[std::size_t(frame)].id);
  return id.size() <= kMost ? id : QChar(0x2026) + id.right(kMost - 1);
}

QString TimelineStrip::lightTip(int row, int frame) const {
  const viz::LightRow& light = data_.lights[std::size_t(row)];
  const QString name = lightTitle(light.light);
  if (frame < 0)
    return tr("%1 (row %2 of %3): on in frames where its row is yellow. Click to switch it in a frame; a line through "
              "it marks a change from what was captured")
        .arg(name)
        .arg(row + 1)
        .arg(data_.lights.size());
  const viz::LightState state = viz::lightState(light, *document_.scene(), document_.request().whatIf, frame);
  return tr("%1: %2\n%3").arg(name, lightStateText(state), lightClickText(document_, state));
}

QString TimelineStrip::toolTip(int frame) const {
  const Frame& f = document_.scene()->frames[std::size_t(frame)];
  QString text = tr("Frame %1, %2").arg(nameText(f.id), roleName(document_.role(frame)));
  if (unreadable_.contains(frame)) text += tr("\nno photograph: %1").arg(unreadable_.value(frame));
  if (!data_.lights.empty()) {
    std::vector<std::string> on;
    for (const viz::LightRow& row : data_.lights)
      if (viz::isLit(viz::lightState(row, *document_.scene(), document_.request().whatIf, frame))) on.push_back(row.light);
    text += tr("\nlights on: %1").arg(on.empty() ? tr("none") : joined(on));
  }
  const bool excluded = document_.role(frame) == FrameRole::Excluded;
  if (excluded && !data_.series.empty()) text += tr("\nnot evaluated");
  for (const viz::TimelineData::Series& series : data_.series) {
    if (excluded) break;
    const std::optional<double>& pct = series.errorPct[std::size_t(frame)];
    text += QStringLiteral("\n%1: ").arg(toQString(series.model) + (series.poor ? tr(", poor") : QString())) +
            (pct ? numberText(*pct, 3) + QStringLiteral(" %") : toQString(series.reason[std::size_t(frame)]));
    if (const std::string& spurious = series.spuriousWords[std::size_t(frame)]; !spurious.empty())
      text += (series.reason[std::size_t(frame)].empty() && !pct ? QString() : QStringLiteral("; ")) + toQString(spurious);
  }
  if (document_.stale() && !data_.series.empty()) text += tr("\n(errors of an earlier state)");
  text += tr("\nCtrl+click gives the next role");
  return text;
}

QString TimelineStrip::tipAt(const QPoint& position) const {
  const int frame = frameAt(position), light = lightAt(position.y());
  const bool beside = position.x() < left_;  // the column of the rows' names
  if (light >= 0 && (frame >= 0 || beside))
    return frame < 0 ? lightTip(light, frame) : lightTip(light, frame) + QLatin1Char('\n') + toolTip(frame);
  return frame < 0 ? QString() : toolTip(frame);
}

bool TimelineStrip::event(QEvent* e) {
  if (e->type() != QEvent::ToolTip) return QWidget::event(e);
  const auto* help = static_cast<QHelpEvent*>(e);
  const QString tip = tipAt(help->pos());
  if (tip.isEmpty())
    QToolTip::hideText();
  else
    showTip(help->globalPos(), tip, this);
  return true;
}

}  // namespace glint::gui
