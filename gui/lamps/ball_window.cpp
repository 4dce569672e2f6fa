// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/ball_window.h"

#include <QApplication>
#include <QClipboard>
#include <QDir>
#include <QFileInfo>
#include <QFormLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QListWidget>
#include <QRegularExpression>
#include <QShortcut>
#include <QSlider>
#include <QSplitter>
#include <QVBoxLayout>
#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/image_header.h"
#include "core/draw/lamp_drawings.h"
#include "core/report/measured_lamps.h"
#include "gui/base/panel_scroll.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/lamps/ball_controls.h"
#include "gui/lamps/ball_results.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/lamps/save_lamps.h"

namespace glint::gui {

namespace {

constexpr int kMostStops = 6;  // 64 times: the noise of 8 bits fills the picture
constexpr QSize kWindow(1280, 860);
constexpr int kListWidth = 190, kControlsWidth = 330, kPhotographHeight = 540, kResultsHeight = 260;  // px, where there is room

/// The photographs of one folder; `name` "" = the input itself.
BallShots shotsOf(const QString& input, const QString& name) {
  NamedBall any;
  any.text = name.toStdString();
  any.folder = any.text;
  any.outline.radius = BallOutlines::kLeastRadius;
  return ballShotsIn(input.toStdString(), {any}, "");
}

bool hasPhotographs(const QString& input, const QString& name) {
  try {
    return !shotsOf(input, name).shots.empty();
  } catch (const InputError&) {
    return false;
  }
}

/// What the core refuses by the options of the command line: here a person drew. The place of a ball tells which one.
QString withoutBallOptions(const QString& line) {
  static const QRegularExpression ball(QStringLiteral("--ball (?:\\S*:)?([-+.e\\d]+,[-+.e\\d]+),[-+.e\\d]+(?:@\\S+)?"));
  return QString(line).replace(ball, BallWindow::tr("the ball at \\1"));
}

/// The size of a photograph, by its header; nothing if that cannot be read: decoding it reports why.
QSize sizeOf(const std::filesystem::path& file) {
  try {
    const ImageHeader header = readImageHeader(readFile(file, Limit::ImageMegabytes));
    if (header.problem.empty()) return {int(header.width), int(header.height)};
  } catch (const InputError&) {
  }
  return {};
}

}  // namespace

BallWindow::BallWindow(const Engine& engine, QWidget* parent)
    : QWidget(parent, Qt::Window),
      engine_(engine),
      outlines_(new BallOutlines(this)),
      photographs_(new QListWidget),
      canvas_(new FrameCanvas),
      controls_(new BallControls(*outlines_)),
      results_(new BallResults),
      status_(new QLabel),
      loader_(new PhotoLoader(this)) {
  setObjectName(QStringLiteral("ballWindow"));
  setWindowTitle(tr("Lamps from photographs of mirror balls"));
  resize(kWindow);
  photographs_->setObjectName(QStringLiteral("ballPhotographs"));
  photographs_->setAccessibleName(tr("Photographs; those with a tick are measured"));
  canvas_->setObjectName(QStringLiteral("ballCanvas"));
  canvas_->setAccessibleName(tr("Photograph with the outlines of balls"));
  canvas_->setDragTool(outlines_);
  status_->setObjectName(QStringLiteral("ballStatus"));
  status_->setTextFormat(Qt::PlainText);
  status_->setWordWrap(true);
  status_->setContentsMargins(6, 2, 6, 2);
  auto* top = new QSplitter(Qt::Horizontal);
  top->addWidget(photographColumn());
  top->addWidget(canvas_);
  auto* controls = new PanelScroll(controls_, {200, 150});
  controls->setAccessibleName(tr("Balls and camera"));
  top->addWidget(controls);
  top->setStretchFactor(1, 1);
  top->setSizes({kListWidth, kWindow.width() - kListWidth - kControlsWidth, kControlsWidth});
  auto* all = new QSplitter(Qt::Vertical);
  all->addWidget(top);
  all->addWidget(results_);
  all->setStretchFactor(0, 1);
  all->setSizes({kPhotographHeight, kResultsHeight});
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(all, 1);
  column->addWidget(status_);
  connectParts();
  for (const auto& [keys, back] : {std::pair(QKeySequence::Undo, true), std::pair(QKeySequence::Redo, false)})
    connect(new QShortcut(keys, this), &QShortcut::activated, outlines_,
            [this, back = back] { back ? outlines_->undo() : outlines_->redo(); });
}

/// The list, and how bright photographs are shown: rims in a dark room are hard to see.
QWidget* BallWindow::photographColumn() {
  auto* column = new QWidget;
  auto* layout = new QVBoxLayout(column);
  layout->setContentsMargins(0, 0, 0, 4);
  layout->addWidget(photographs_, 1);
  auto* brightness = new QSlider(Qt::Horizontal);
  brightness->setObjectName(QStringLiteral("ballBrightness"));
  brightness->setAccessibleName(tr("Brightness"));
  brightness->setToolTip(tr("How bright photographs are shown, in stops. What is measured stays"));
  brightness->setRange(0, kMostStops);
  auto* row = new QFormLayout;
  row->setContentsMargins(6, 0, 6, 0);
  row->addRow(tr("Brightness"), brightness);
  layout->addLayout(row);
  connect(brightness, &QSlider::valueChanged, this, [this](int stops) {
    viz::Development look;
    look.stops = stops;
    loader_->setLook(FrameSource::Image, look);
  });
  return column;
}

void BallWindow::connectParts() {
  connect(loader_, &PhotoLoader::loaded, this, [this](int, const FramePicture& picture) {
    canvas_->setPicture(picture);
    showOverlay();
  });
  connect(loader_, &PhotoLoader::failed, this, [this](int, const QString& why) { canvas_->setMessage(why); });
  connect(canvas_, &FrameCanvas::clicked, this, [this](double x, double y) { outlines_->clickRim({x, y}); });
  connect(outlines_, &BallOutlines::changed, this, [this] {
    if (const QString& shown = outlines_->folder(); !pictures_ || exactQString(pictures_->name) != shown) listPhotographs();
    showOverlay();
  });
  connect(outlines_, &BallOutlines::ballsChanged, this, &BallWindow::markStale);
  connect(outlines_, &BallOutlines::problem, this, [this](const QString& line) { tell(line, true); });
  connect(controls_, &BallControls::questionChanged, this, &BallWindow::markStale);
  connect(controls_, &BallControls::copyRequested, this, [this] {
    BallQuestion q;
    if (!question(q)) return;
    QApplication::clipboard()->setText(exactQString(lightsCommand(q)));
    tell(tr("Copied the command that measures the same"), false);
  });
  connect(photographs_, &QListWidget::currentRowChanged, this, [this] { showCurrent(); });
  connect(photographs_, &QListWidget::itemChanged, this, [this](const QListWidgetItem* item) {
    if (listing_) return;
    const QString name = item->data(Qt::UserRole).toString();
    if (item->checkState() == Qt::Checked)
      left_.erase(name);
    else
      left_.insert(name);
    markStale();
  });
  LampsPanel* lamps = results_->lamps();
  connect(lamps, &LampsPanel::measureRequested, this, &BallWindow::measure);
  connect(lamps, &LampsPanel::stopRequested, this, &BallWindow::cancel);
  connect(lamps, &LampsPanel::saveRequested, this, &BallWindow::save);
  connect(&jobs_, &JobQueue::busyChanged, lamps, &LampsPanel::setBusy);
  connect(results_, &BallResults::lampSelected, this, &BallWindow::selectLamp);
}

BallWindow::~BallWindow() = default;

bool BallWindow::open(const QString& folder) {
  jobs_.close();
  QStringList folders;
  if (hasPhotographs(folder, {}))
    folders << QString();
  else
    for (const QString& name : QDir(folder).entryList(QDir::Dirs | QDir::NoDotAndDotDot | QDir::NoSymLinks, QDir::Name))
      if (hasPhotographs(folder, name)) folders << name;
  if (folders.isEmpty()) {
    emit problem(tr("%1: has no photographs (PNG, JPEG, TIFF, BMP or WebP), nor has a folder in it").arg(shownText(folder)));
    return false;
  }
  folder_ = folder;
  report_.reset();
  left_.clear();
  pictures_.reset();
  outlines_->clear();
  outlines_->setFolder(folders.front());
  controls_->setFolders(folders);
  results_->show(nullptr, tr("Draw the outline of each ball, then measure."));
  setWindowTitle(tr("%1 – lamps from photographs of mirror balls").arg(shownText(QDir(folder).dirName())));
  listPhotographs();
  markStale();
  tell(tr("One lamp in each photograph; untick photographs that show several."), false);
  return true;
}

bool BallWindow::ask(const BallQuestion& q) {
  std::set<std::string> kept;
  for (const Shot& shot : ballShotsIn(q.input, q.balls, q.exclude).shots) kept.insert(shot.name);
  if (!open(exactQString(q.input))) return false;
  for (const Shot& shot : ballShotsIn(q.input, q.balls, "").shots)
    if (!kept.count(shot.name)) left_.insert(exactQString(shot.name));
  for (const NamedBall& ball : q.balls) {
    outlines_->setFolder(exactQString(ball.folder));
    outlines_->setCorner(exactQString(ball.folder), ball.corner);
    outlines_->add({ball.outline.centre - ball.corner, ball.outline.radius});
  }
  outlines_->setDrawing(BallOutlines::Drawing::Nothing);
  outlines_->setFolder(exactQString(q.balls.front().folder));
  outlines_->select(0);
  outlines_->forgetSteps();
  controls_->show(q);
  listPhotographs();
  return true;
}

void BallWindow::showPhotograph(const QString& name) {
  for (int row = 0; row < photographs_->count(); ++row) {
    const QString file = photographs_->item(row)->data(Qt::UserRole).toString();
    if (file == name || QFileInfo(file).completeBaseName() == name) return photographs_->setCurrentRow(row);
  }
}

void BallWindow::listPhotographs() {
  if (folder_.isEmpty()) return;
  auto scene = std::make_shared<Scene>();
  scene->name = outlines_->folder().toStdString();
  const QString before = photographs_->currentItem() ? photographs_->currentItem()->data(Qt::UserRole).toString() : QString();
  try {
    for (const Shot& shot : shotsOf(folder_, outlines_->folder()).shots) {
      Frame& frame = scene->frames.emplace_back();
      frame.id = shot.name;
      frame.image = shot.files.front();
    }
  } catch (const InputError& e) {
    tell(toQString(e.what()), true);
  }
  QSize size;
  for (std::size_t i = 0; i < scene->frames.size() && size.isEmpty(); ++i) size = sizeOf(scene->frames[i].image);
  for (Frame& frame : scene->frames) frame.camera.width = size.width(), frame.camera.height = size.height();
  if (!size.isEmpty()) controls_->setPhotographSize(size);
  pictures_ = scene;
  listing_ = true;
  photographs_->clear();
  int row = 0;
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    const QString name = exactQString(scene->frames[i].id);
    auto* item = new QListWidgetItem(nameText(scene->frames[i].id), photographs_);
    item->setData(Qt::UserRole, name);
    item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable | Qt::ItemIsUserCheckable);
    item->setCheckState(left_.count(name) ? Qt::Unchecked : Qt::Checked);
    if (name == before) row = int(i);
  }
  listing_ = false;
  loader_->setScene(pictures_);
  photographs_->setCurrentRow(-1);
  photographs_->setCurrentRow(row);
}

void BallWindow::showCurrent() {
  const int row = photographs_->currentRow();
  if (listing_ || row < 0 || !pictures_ || row >= int(pictures_->frames.size())) return;
  canvas_->setAwaited(photographAwaited(*pictures_, row));  // first: the answer may come at once
  loader_->want(row);
  int lamp = -1;
  if (const LampAnswer* shown = lampOf(photographs_->item(row)->data(Qt::UserRole).toString()))
    lamp = int(shown - report_->lamps.data());
  results_->select(lamp);
  showOverlay();
}

void BallWindow::showOverlay() {
  draw::BallOverlayInput in;
  const auto& balls = outlines_->balls();
  for (std::size_t k = 0; k < balls.size(); ++k) {
    if (balls[k].folder != outlines_->folder()) continue;
    if (int(k) == outlines_->selected()) in.selected = int(in.drawn.size());
    in.drawn.push_back(balls[k].outline);
    in.balls.push_back(k);
  }
  in.rim = outlines_->rim();
  draw::FrameOverlay overlay = draw::ballOverlay(in);
  QString caption;
  if (report_ && report_->balls && !changedSince_) {
    draw::BallOverlayInput fitted;
    fitted.fit = &*report_->balls;
    fitted.balls = in.balls;
    fitted.corner = outlines_->cornerOf(outlines_->folder());
    fitted.residualScale = residualScale_;
    if (photographs_->currentItem()) fitted.lamp = lampOf(photographs_->currentItem()->data(Qt::UserRole).toString());
    const draw::FrameOverlay measured = draw::ballOverlay(fitted);
    overlay.lines.insert(overlay.lines.end(), measured.lines.begin(), measured.lines.end());
    overlay.marks.insert(overlay.marks.end(), measured.marks.begin(), measured.marks.end());
    if (balls.size() > 1) caption = tr("residuals × %1").arg(residualScale_);
  }
  canvas_->setCaption(caption);
  canvas_->setOverlay(std::move(overlay));
}

const LampAnswer* BallWindow::lampOf(const QString& photograph) const {
  if (!report_) return nullptr;
  // An id is a name without its ending, or with it where two would be the same.
  const std::string name = photograph.toStdString(), stem = std::filesystem::path(name).stem().string();
  for (const LampAnswer& lamp : report_->lamps)
    if (!lamp.frames.empty() && (lamp.frames.front() == name || lamp.frames.front() == stem)) return &lamp;
  return nullptr;
}

bool BallWindow::question(BallQuestion& q) {
  q.input = folder_.toStdString();
  q.balls = outlines_->named();
  if (const QString wrong = controls_->fill(q); !wrong.isEmpty()) {
    tell(wrong, true);
    return false;
  }
  if (q.balls.empty()) {
    tell(tr("Draw the outline of a ball first."), true);
    return false;
  }
  try {
    const std::vector<Shot> shots = ballShotsIn(q.input, q.balls, "").shots;
    for (std::size_t i = 0; i < shots.size(); ++i)
      if (left_.count(exactQString(shots[i].name))) q.exclude += (q.exclude.empty() ? "" : ",") + std::to_string(i);
    if (std::all_of(shots.begin(), shots.end(), [this](const Shot& s) { return left_.count(exactQString(s.name)) > 0; })) {
      tell(tr("No photograph is ticked."), true);
      return false;
    }
  } catch (const InputError& e) {
    tell(toQString(e.what()), true);
    return false;
  }
  return true;
}

void BallWindow::measure() {
  BallQuestion q;
  if (jobs_.busy() || !engine_.ballLamps || !question(q)) return;
  const auto show = [this](const StageEvent& e) { results_->lamps()->setProgress(toQString(e.stage), e.done, e.total); };
  changedSince_ = false;
  jobs_.start(
      [measure = engine_.ballLamps, q, show](const JobToken& token) {
        Outcome<LampsReport> report = measure(q, token.progress(show));
        if (token.stopped()) throw Stopped{};
        return report;
      },
      [this](const JobResult<Outcome<LampsReport>>& result) {
        if (result.stopped) {
          changedSince_ = true;
          return tell(tr("Stopped; what was measured before stays"), false);
        }
        if (!result.failure().isEmpty()) {
          changedSince_ = true;
          return tell(result.failure(), true);
        }
        takeReport(*result.value);
      });
}

void BallWindow::takeReport(const Outcome<LampsReport>& report) {
  report_.reset();
  if (report) {
    report_ = std::make_shared<const LampsReport>(*report);
    residualScale_ = report_->balls ? draw::ballResidualScale(report_->balls->balls, report_->lamps) : 1;
    results_->show(report_.get(), {});
    const std::optional<Failure> nothing = nothingMeasured(*report_);
    tell(nothing ? toQString(nothing->message()) : tr("Measured %1 photographs").arg(report_->lamps.size()), nothing.has_value());
  } else {
    results_->show(nullptr, tr("No answer: %1").arg(toQString(report.failure().message())));
    tell(toQString(report.failure().message()), true);
  }
  results_->lamps()->setStale(report_ && changedSince_);
  showCurrent();
}

/// Outlines that were measured belong to what was asked: they go from the photograph once something else would be.
void BallWindow::markStale() {
  changedSince_ = true;
  results_->lamps()->setPossible(!outlines_->balls().empty() && engine_.ballLamps);
  results_->lamps()->setStale(report_ != nullptr);
  showOverlay();
}

void BallWindow::selectLamp(int lamp) {
  if (!report_ || lamp < 0 || lamp >= int(report_->lamps.size())) return;
  for (int row = 0; row < photographs_->count(); ++row)
    if (lampOf(photographs_->item(row)->data(Qt::UserRole).toString()) == &report_->lamps[std::size_t(lamp)])
      return photographs_->setCurrentRow(row);
}

void BallWindow::save() {
  if (!report_) return;
  try {
    std::vector<std::filesystem::path> inputs;
    for (const QString& name :
         outlines_->folder().isEmpty() ? QStringList{QString()} : QDir(folder_).entryList(QDir::Dirs | QDir::NoDotAndDotDot))
      if (hasPhotographs(folder_, name))
        for (const std::filesystem::path& file : shotsOf(folder_, name).files()) inputs.push_back(file);
    if (const QString file = saveLamps(this, *report_, folder_, inputs); !file.isEmpty())
      tell(tr("Wrote %1").arg(shownText(file)), false);
  } catch (const InputError& e) {
    tell(toQString(e.what()), true);
  }
}

void BallWindow::tell(const QString& words, bool wrong) {
  const QString line = withoutBallOptions(words);
  status_->setText(line);
  status_->setStyleSheet(wrong ? QStringLiteral("color: %1").arg(warningColour().name()) : QString());
  if (wrong)
    emit problem(line);
  else
    emit message(line);
}

void BallWindow::keyPressEvent(QKeyEvent* e) {
  if (e->key() == Qt::Key_Escape && jobs_.busy()) return cancel();
  QWidget::keyPressEvent(e);
}

}  // namespace glint::gui
