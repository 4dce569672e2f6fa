// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/pair_bar.h"

#include <QAction>
#include <QComboBox>
#include <QLabel>
#include <QMenu>
#include <QSignalBlocker>
#include <QToolButton>
#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "gui/base/flow_layout.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
const char* const kOn = "frame/side-by-side";
const char* const kSecond = "frame/second";
const char* const kLines = "frame/epipolar";
const char* const kEllipse = "frame/epipolar-ellipse";
}  // namespace

PairBar::PairBar(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* row = new FlowLayout(4);
  row->setContentsMargins(8, 0, 4, 2);
  setLayout(row);
  const auto label = [&](const QString& text) {
    auto* l = new QLabel(text);
    l->setProperty("role", "faded");
    row->addWidget(l);
  };
  const auto combo = [&](const char* name, const QString& tip) {
    auto* box = new QComboBox;
    box->setObjectName(QLatin1String(name));
    box->setToolTip(tip);
    box->setFocusPolicy(Qt::NoFocus);  // arrow keys step through the frames
    box->setSizeAdjustPolicy(QComboBox::AdjustToContents);
    row->addWidget(box);
    connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box, name](int i) {
      document_.setOption(name, box->itemData(i).toString().toStdString(),
                          box->toolTip() + QStringLiteral(": ") + box->itemText(i));
    });
    return box;
  };
  label(tr("Beside"));
  second_ = combo(kSecond, tr("Second frame"));
  auto* swap = new QToolButton;
  swap->setText(QStringLiteral("⇄"));
  swap->setToolTip(tr("Swap frames"));
  swap->setAutoRaise(true);
  row->addWidget(swap);
  connect(swap, &QToolButton::clicked, this, &PairBar::swap);
  label(tr("Tangent epipolar lines"));
  lines_ = combo(kLines, tr("Tangent epipolar lines"));
  for (const auto& [name, title] : {std::pair("off", tr("none")), std::pair("real", tr("real cameras")),
                                    std::pair("virtual", tr("virtual cameras")), std::pair("both", tr("both"))})
    lines_->addItem(title, QLatin1String(name));
  label(tr("of"));
  ellipse_ = combo(kEllipse, tr("Ellipses of the epipolar lines"));
  for (const auto& [name, title] :
       {std::pair("observed", tr("observed ellipses")), std::pair("canonical", tr("canonical ellipses"))})
    ellipse_->addItem(title, QLatin1String(name));
  miss_ = new QLabel;
  miss_->setTextFormat(Qt::RichText);
  miss_->setObjectName(QStringLiteral("epipolarMiss"));
  miss_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  miss_->setWordWrap(true);
  miss_->setContentsMargins(8, 0, 4, 2);
  miss_->setParent(this);
  miss_->hide();
  connect(&document_, &Document::optionsChanged, this, &PairBar::refresh);
  connect(&document_, &Document::selectionChanged, this, &PairBar::refresh);
  connect(&document_, &Document::sceneOpened, this, [this] {
    const QSignalBlocker quiet(second_);
    second_->clear();
    for (int i = 0; i < document_.frameCount(); ++i) second_->addItem(nameText(document_.scene()->frames[std::size_t(i)].id), i);
    refresh();
  });
  refresh();
}

bool PairBar::on() const { return document_.option(kOn, std::string("off")) == "on"; }

int PairBar::secondFrame() const {
  const int n = document_.frameCount(), current = document_.selection().frame;
  const int chosen = int(document_.option(kSecond, -1.0));
  if (chosen >= 0 && chosen < n) return chosen;
  // The training frame farthest in the sequence: the pair whose baseline is likely the widest.
  int best = current;
  for (int i = 0; i < n; ++i)
    if (document_.role(i) == FrameRole::Training && std::abs(i - current) > std::abs(best - current)) best = i;
  return best != current || n < 2 ? best : (current + 1) % n;
}

void PairBar::swap() {
  const int first = document_.selection().frame, second = secondFrame();
  if (first == second) return;
  document_.undoStack()->beginMacro(tr("Swap frames"));
  document_.setOption(kSecond, double(first), QString());
  document_.selectFrame(second);
  document_.undoStack()->endMacro();
}

void PairBar::refresh() {
  setVisible(on() && document_.scene());
  miss_->setVisible(on() && document_.scene() && !miss_->text().isEmpty());
  if (toggle_) toggle_->setChecked(on());
  const QSignalBlocker a(second_), b(lines_), c(ellipse_);
  second_->setCurrentIndex(secondFrame());
  lines_->setCurrentIndex(std::max(0, lines_->findData(toQString(document_.option(kLines, std::string("both"))))));
  ellipse_->setCurrentIndex(std::max(0, ellipse_->findData(toQString(document_.option(kEllipse, std::string("observed"))))));
}

void PairBar::addLines(draw::FrameOverlay& first, draw::FrameOverlay& second) {
  miss_->clear();
  miss_->hide();
  key_.clear();
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  const std::string lines = document_.option(kLines, std::string("both"));
  if (!inspection || lines == "off") return;
  draw::PairRequest request;
  request.frames = {document_.selection().frame, secondFrame()};
  request.highlight = document_.selection().highlight;
  request.ellipse = document_.option(kEllipse, std::string("observed")) == "canonical" ? draw::PairEllipse::Canonical
                                                                                       : draw::PairEllipse::Observed;
  QStringList said, reasons;
  for (const auto& [name, title, cameras, colour] :
       {std::tuple("real", tr("real cameras"), draw::PairCameras::Real, draw::kRealEpipolar),
        std::tuple("virtual", tr("virtual cameras"), draw::PairCameras::Virtual, draw::kVirtualCamera)}) {
    if (lines != name && lines != "both") continue;
    request.cameras = cameras;
    const draw::EpipolarPicture picture = draw::epipolarPicture(*inspection, request);
    first.lines.insert(first.lines.end(), picture.frames[0].lines.begin(), picture.frames[0].lines.end());
    first.marks.insert(first.marks.end(), picture.frames[0].marks.begin(), picture.frames[0].marks.end());
    second.lines.insert(second.lines.end(), picture.frames[1].lines.begin(), picture.frames[1].lines.end());
    second.marks.insert(second.marks.end(), picture.frames[1].marks.begin(), picture.frames[1].marks.end());
    // For a failure its name will do; the tool tip says the rest.
    const QString what = picture.tangents ? tr("miss by %1 px").arg(picture.tangents->rmsPx(), 0, 'f', 2)
                                          : QString(QLatin1String(nameOf(picture.failure->reason)));
    if (!picture.tangents) reasons << title + QStringLiteral(": ") + toQString(picture.failure->message());
    key_.append({toQColor(colour), QStringLiteral("%1 %2").arg(title, what)});
    said << QStringLiteral("<span style='color:%1'>■</span> %2").arg(key_.back().colour.name(), key_.back().text.toHtmlEscaped());
  }
  miss_->setText(said.join(QStringLiteral("&nbsp;&nbsp; ")));
  reasons << tr(
      "RMS distance by which the tangents transferred from the other image (dashed) miss the ellipse. "
      "It is 0 if one ellipsoid has both ellipses as outlines.");
  miss_->setToolTip(reasons.join(QStringLiteral("\n")));
  miss_->setVisible(on());
}

void PairBar::addActions(Actions& actions, QMenu* menu) {
  toggle_ = actions.addToggle(
      "frame.side-by-side", menu, tr("&Two frames side by side"),
      [this](bool on) { document_.setOption(kOn, on ? "on" : "off", on ? tr("Two frames side by side") : tr("One frame")); },
      {{Qt::Key_D}, "side-by-side"});
  actions.add("frame.swap", menu, tr("S&wap frames"), [this] { swap(); });
  const auto choose = [&](const char* id, const QString& title, const char* option, const char* value) {
    actions.add(QLatin1String(id), menu, title, [this, title, option, value] {
      if (on()) return document_.setOption(option, value, title);
      document_.undoStack()->beginMacro(title);
      document_.setOption(kOn, "on", title);
      document_.setOption(option, value, title);
      document_.undoStack()->endMacro();
    });
  };
  choose("frame.epipolar-off", tr("Epipolar lines: none"), kLines, "off");
  choose("frame.epipolar-real", tr("Epipolar lines of real cameras"), kLines, "real");
  choose("frame.epipolar-virtual", tr("Epipolar lines of virtual cameras"), kLines, "virtual");
  choose("frame.epipolar-both", tr("Epipolar lines of real and virtual cameras"), kLines, "both");
  choose("frame.epipolar-observed", tr("Epipolar lines of observed ellipses"), kEllipse, "observed");
  choose("frame.epipolar-canonical", tr("Epipolar lines of canonical ellipses"), kEllipse, "canonical");
  refresh();
}

}  // namespace glint::gui
