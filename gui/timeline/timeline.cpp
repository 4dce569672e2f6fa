// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/timeline.h"

#include <QAction>
#include <QComboBox>
#include <QHBoxLayout>
#include <QMenu>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/timeline/light_switches.h"
#include "viz/style.h"

namespace glint::gui {

namespace {
constexpr int kSpeeds[] = {1, 2, 4, 8, 15, 30};  // frames per second
constexpr double kUsualSpeed = 8;
constexpr int kScrollSteps = 1000;  // of the scroll bar per frame in view
}  // namespace

Timeline::Timeline(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(6, 2, 0, 2);
  row->setSpacing(6);
  auto* controls = new QVBoxLayout;
  controls->setSpacing(3);
  auto* buttons = new QHBoxLayout;
  buttons->setSpacing(2);
  const auto button = [&](const char* iconName, const QString& tip, const char* name) {
    auto* b = new QToolButton;
    b->setObjectName(QLatin1String(name));
    b->setIcon(icon(QLatin1String(iconName)));
    b->setToolTip(tip);
    b->setAutoRaise(true);
    return b;
  };
  auto* back = button("previous", tr("Previous frame (Left)"), "previousFrame");
  auto* play = button("play", tr("Play (P)"), "play");
  auto* next = button("next", tr("Next frame (Right)"), "nextFrame");
  for (QToolButton* b : {back, play, next}) buttons->addWidget(b);
  speed_ = new QComboBox;
  speed_->setObjectName(QStringLiteral("playSpeed"));
  speed_->setToolTip(tr("Playback speed, frames per second"));
  speed_->setAccessibleName(tr("Playback speed"));
  for (const int s : kSpeeds) speed_->addItem(tr("%1/s").arg(s), s);
  buttons->addWidget(speed_, 1);
  auto* plotted = new QHBoxLayout;
  plotted->setSpacing(2);
  model_ = new QComboBox;
  model_->setObjectName(QStringLiteral("plottedModel"));
  model_->setIconSize({11, 11});
  model_->setToolTip(tr("Selected model: thick line or bars"));
  model_->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  bars_ = button("bars", tr("Errors of the selected model as bars instead of lines of all models"), "timelineBars");
  bars_->setCheckable(true);
  plotted->addWidget(model_, 1);
  plotted->addWidget(bars_);
  controls->addStretch(1);
  controls->addLayout(buttons);
  controls->addLayout(plotted);
  controls->addStretch(1);
  row->addLayout(controls);
  auto* column = new QVBoxLayout;
  column->setSpacing(0);
  strip_ = new TimelineStrip(document);
  strip_->setObjectName(QStringLiteral("timelineStrip"));
  column->addWidget(strip_, 1);
  scroll_ = new QScrollBar(Qt::Horizontal);
  scroll_->setObjectName(QStringLiteral("timelineScroll"));
  scroll_->hide();
  column->addWidget(scroll_);
  row->addLayout(column, 1);

  connect(back, &QToolButton::clicked, strip_, [this] { strip_->step(-1); });
  connect(next, &QToolButton::clicked, strip_, [this] { strip_->step(1); });
  connect(play, &QToolButton::clicked, this, [this] { setPlaying(!playing()); });
  connect(this, &Timeline::playingChanged, play,
          [play](bool on) { play->setIcon(icon(on ? QStringLiteral("pause") : QStringLiteral("play"))); });
  connect(&clock_, &QTimer::timeout, this, [this] {
    const int n = document_.frameCount();
    if (n > 0) document_.showFrame((document_.selection().frame + 1) % n);
  });
  connect(speed_, QOverload<int>::of(&QComboBox::activated), this, [this](int i) {
    document_.setOption("timeline/speed", double(kSpeeds[i]), tr("Play at %1 frames per second").arg(kSpeeds[i]));
  });
  connect(bars_, &QToolButton::clicked, this, &Timeline::setBars);
  connect(model_, QOverload<int>::of(&QComboBox::activated), this, [this](int i) {
    draw::Selection s = document_.selection();
    s.model = model_->itemText(i).toStdString();
    document_.select(s);
  });
  connect(strip_, &TimelineStrip::viewChanged, this, &Timeline::showView);
  connect(scroll_, &QScrollBar::valueChanged, this,
          [this](int v) { strip_->setView(double(v) / kScrollSteps * strip_->framesInView(), strip_->framesInView()); });
  connect(&document_, &Document::sceneOpened, this, &Timeline::refresh);
  connect(&document_, &Document::requestChanged, this, &Timeline::refresh);
  connect(&document_, &Document::optionsChanged, this, &Timeline::refresh);
  connect(&document_, &Document::selectionChanged, this, [this] {
    if (model_->currentText() != toQString(document_.plottedModel())) refresh();
  });
  refresh();
}

void Timeline::refresh() {
  const QSignalBlocker a(model_), b(speed_);
  model_->clear();
  for (const std::string& m : document_.request().models)
    model_->addItem(colourSwatch(toQColor(draw::modelColour(m))), toQString(m));
  model_->setCurrentIndex(model_->findText(toQString(document_.plottedModel())));
  const double speed = std::clamp(document_.option("timeline/speed", kUsualSpeed), 0.1, 60.0);
  const auto* nearest = std::min_element(std::begin(kSpeeds), std::end(kSpeeds),
                                         [&](int p, int q) { return std::abs(p - speed) < std::abs(q - speed); });
  speed_->setCurrentIndex(int(nearest - std::begin(kSpeeds)));
  clock_.setInterval(int(std::lround(1000 / speed)));
  const bool bars = document_.option("timeline/chart", std::string("lines")) == "bars";
  bars_->setChecked(bars);
  if (barsAction_) barsAction_->setChecked(bars);
  if (thumbnailsAction_) thumbnailsAction_->setChecked(document_.option("timeline/thumbnails", std::string("on")) == "on");
}

void Timeline::showView() {
  const QSignalBlocker quiet(scroll_);
  const double n = document_.frameCount(), inView = strip_->framesInView();
  scroll_->setVisible(inView < n);
  scroll_->setRange(0, int(std::lround((n - inView) / inView * kScrollSteps)));
  scroll_->setPageStep(kScrollSteps);
  scroll_->setSingleStep(kScrollSteps / 10);
  scroll_->setValue(int(std::lround(strip_->firstFrame() / inView * kScrollSteps)));
}

void Timeline::setBars(bool bars) {
  document_.setOption("timeline/chart", bars ? "bars" : "lines", bars ? tr("Errors as bars") : tr("Errors as lines"));
}

void Timeline::setPlaying(bool playing) {
  if (playing == this->playing()) return;
  if (playing)
    clock_.start();
  else
    clock_.stop();
  emit playingChanged(playing);
}

void Timeline::changeSpeed(int steps) {
  const int index = std::clamp(speed_->currentIndex() + steps, 0, int(std::size(kSpeeds)) - 1);
  document_.setOption("timeline/speed", double(kSpeeds[index]), tr("Play at %1 frames per second").arg(kSpeeds[index]));
}

void Timeline::stepToRole(FrameRole role, int by) {
  const int n = document_.frameCount();
  for (int i = document_.selection().frame + by; i >= 0 && i < n; i += by)
    if (document_.role(i) == role) return document_.selectFrame(i);
}

void Timeline::addActions(Actions& actions, QMenu* menu) {
  actions.add("frame.previous", menu, tr("&Previous"), [this] { strip_->step(-1); }, {{QKeySequence("Alt+Left")}, "previous"});
  actions.add("frame.next", menu, tr("&Next"), [this] { strip_->step(1); }, {{QKeySequence("Alt+Right")}, "next"});
  actions.add("frame.play", menu, tr("P&lay"), [this] { setPlaying(!playing()); }, {{Qt::Key_P}, "play"});
  QMenu* timeline = menu->addMenu(tr("Ti&meline"));
  actions.add("frame.first", timeline, tr("&First frame"), [this] { strip_->step(-document_.frameCount()); },
              {{QKeySequence("Alt+Home")}});
  actions.add("frame.last", timeline, tr("&Last frame"), [this] { strip_->step(document_.frameCount()); },
              {{QKeySequence("Alt+End")}});
  actions.add("frame.next-training", timeline, tr("Next &training frame"), [this] { stepToRole(FrameRole::Training, 1); },
              {{QKeySequence("Alt+Shift+Right")}});
  actions.add("frame.previous-training", timeline, tr("P&revious training frame"),
              [this] { stepToRole(FrameRole::Training, -1); }, {{QKeySequence("Alt+Shift+Left")}});
  actions.add("timeline.faster", timeline, tr("Play f&aster"), [this] { changeSpeed(1); });
  actions.add("timeline.slower", timeline, tr("Play &slower"), [this] { changeSpeed(-1); });
  actions.add("timeline.zoom-in", timeline, tr("Zoom &in"), [this] { strip_->zoom(2); });
  actions.add("timeline.zoom-out", timeline, tr("Zoom &out"), [this] { strip_->zoom(0.5); });
  actions.add("timeline.show-all", timeline, tr("Show all fra&mes"), [this] { strip_->showAll(); });
  barsAction_ =
      actions.addToggle("timeline.bars", timeline, tr("Errors of selected model as &bars"), [this](bool on) { setBars(on); }, {});
  thumbnailsAction_ = actions.addToggle("timeline.thumbnails", timeline, tr("T&humbnails"),
                                        [this](bool on) {
                                          document_.setOption("timeline/thumbnails", on ? "on" : "off",
                                                              on ? tr("Show thumbnails") : tr("Hide thumbnails"));
                                        },
                                        {});
  menu->addSeparator();
  const auto role = [&](const char* id, const QString& text, FrameRole r) {
    actions.add(QLatin1String(id), menu, text, [this, r] { document_.setRole(document_.selection().frame, r); });
  };
  role("frame.train", tr("&Train on this frame"), FrameRole::Training);
  role("frame.hold-out", tr("&Hold out this frame"), FrameRole::HeldOut);
  role("frame.exclude", tr("E&xclude this frame"), FrameRole::Excluded);
  QMenu* lights = menu->addMenu(tr("Li&ghts of this frame"));
  lights->setToolTipsVisible(true);
  connect(lights, &QMenu::aboutToShow, this, [this, lights] {
    lights->clear();
    addLights(*lights, document_, strip_->lights(), document_.selection().frame);
  });
  refresh();
}

}  // namespace glint::gui
