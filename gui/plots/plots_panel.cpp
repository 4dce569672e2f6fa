// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/plots_panel.h"

#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QMenu>
#include <QMimeData>
#include <QSplitter>
#include <QTemporaryDir>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>
#include <exception>

#include "core/base/atomic_file.h"
#include "gui/base/draw_turns.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/to_qimage.h"
#include "gui/base/write_png.h"
#include "gui/export/figure_actions.h"
#include "gui/export/figure_caption.h"
#include "gui/plots/plot_canvas.h"
#include "gui/plots/scatter_bar.h"
#include "viz/canvas.h"
#include "viz/plot_export.h"

namespace glint::gui {

namespace {
const char* const kOptions[2] = {"plots/first", "plots/second"};
const char* const kScatter[2] = {"plots/scatter-", "plots/second-scatter-"};
const char* const kDefaults[2] = {"error", "dial"};
constexpr double kPictureScale = 2;  // of saved and copied pictures: sharp on paper and on dense screens

bool isKind(const std::string& id) {
  const auto& kinds = draw::plotKinds();
  return std::any_of(kinds.begin(), kinds.end(), [&](const draw::PlotKind& k) { return id == k.id; });
}
}  // namespace

PlotsPanel::PlotsPanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  setObjectName(QStringLiteral("plots"));
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  splitter_ = new QSplitter(Qt::Horizontal);
  splitter_->setChildrenCollapsible(false);
  layout->addWidget(splitter_);
  for (int i = 0; i < 2; ++i) buildPane(i);
  splitter_->setSizes({500, 500});

  connect(&document_, &Document::staleChanged, new StaleBadge(this, Qt::BottomRightCorner), &StaleBadge::setStale);
  connect(&loader_, &SamplesLoader::loaded, this, [this](const FrameSamplesPtr& samples) {
    samples_ = samples;
    markDirty({"lobe", "lobes", "limit-angle"});
  });
  connect(&document_, &Document::sceneOpened, this, [this] {
    samples_.reset();
    wantsInfluence_ = false;
    showOptions();
    markDirty({});
  });
  connect(&document_, &Document::inspectionChanged, this, [this] {
    wantSamples();
    setDirty({"error", "dial", "axes", "singular", "influence", "scatter"});
    drawInTurn(this, [this] { refresh(); });  // much else is shown at the same time
    if (wantsInfluence_ && !document_.stale()) askForInfluence();
  });
  connect(&document_, &Document::frameInspectionChanged, this, [this] {
    if (!document_.inspection()) markDirty({});
  });
  connect(&document_, &Document::selectionChanged, this, &PlotsPanel::followSelection);
  connect(&document_, &Document::tradeoffChanged, this, [this] { markDirty({"tradeoff"}); });
  connect(&document_, &Document::influenceChanged, this, [this] { markDirty({"influence"}); });
  connect(&document_, &Document::requestChanged, this, [this] { markDirty({"influence"}); });
  connect(&document_, &Document::optionsChanged, this, &PlotsPanel::showOptions);
  connect(&document_, &Document::brushedChanged, this, [this] { markDirty({"scatter"}); });
  showOptions();
}

PlotsPanel::~PlotsPanel() = default;

void PlotsPanel::buildPane(int index) {
  Pane& pane = panes_[std::size_t(index)];
  pane.widget = new QWidget;
  auto* column = new QVBoxLayout(pane.widget);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  auto* row = new QHBoxLayout;
  row->setContentsMargins(4, 2, 4, 2);
  pane.selector = new QComboBox;
  pane.selector->setObjectName(QStringLiteral("plot%1").arg(index));
  pane.selector->setAccessibleName(index == 0 ? tr("First plot") : tr("Second plot"));
  for (const draw::PlotKind& k : draw::plotKinds()) {
    pane.selector->addItem(tr(k.title), QString::fromLatin1(k.id));
    pane.selector->setItemData(pane.selector->count() - 1, tr(k.help), Qt::ToolTipRole);
  }
  pane.selector->setMaximumWidth(pane.selector->sizeHint().width());
  pane.selector->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);  // narrow plots cut it, its tip explains
  pane.selector->setMinimumContentsLength(7);
  row->addWidget(pane.selector, 1);
  row->addStretch(0);
  if (index == 0) {
    auto* influence = new QToolButton;
    influence->setObjectName(QStringLiteral("askInfluence"));
    influence->setText(tr("Measure"));
    influence->setToolTip(tr("Leaves out each training frame in turn and shows how much the models lose"));
    influence->setAutoRaise(true);
    connect(influence, &QToolButton::clicked, this, &PlotsPanel::askForInfluence);
    row->addWidget(influence);
  }
  auto* save = new QToolButton;
  save->setIcon(icon(QStringLiteral("save")));
  save->setToolTip(tr("Save or copy this plot"));
  save->setAutoRaise(true);
  save->setPopupMode(QToolButton::InstantPopup);
  auto* menu = new QMenu(save);
  for (const char* ending : {"svg", "png", "csv"})
    menu->addAction(tr("Save as %1…").arg(QString::fromLatin1(ending).toUpper()), this, [this, index, ending] {
      current_ = index;
      saveAs(ending);
    });
  menu->addSeparator();
  menu->addAction(tr("Copy as picture"), this, [this, index] {
    current_ = index;
    copyPicture();
  });
  menu->addAction(tr("Copy as SVG"), this, [this, index] {
    current_ = index;
    copySvg();
  });
  menu->addAction(tr("Copy numbers"), this, [this, index] {
    current_ = index;
    copyNumbers();
  });
  save->setMenu(menu);
  row->addWidget(save);
  column->addLayout(row);
  pane.bar = new ScatterBar(document_, kScatter[index]);
  column->addWidget(pane.bar);
  pane.canvas = new PlotCanvas;
  column->addWidget(pane.canvas, 1);
  splitter_->addWidget(pane.widget);

  connect(pane.selector, QOverload<int>::of(&QComboBox::activated), this,
          [this, index](int at) { setKind(index, panes_[std::size_t(index)].selector->itemData(at).toString().toStdString()); });
  connect(pane.canvas, &PlotCanvas::clicked, this, &PlotsPanel::clicked);
  connect(pane.canvas, &PlotCanvas::brushed, this,
          [this, index](const std::vector<draw::PlotSample>& samples) { brush(panes_[std::size_t(index)], samples); });
  connect(pane.canvas, &PlotCanvas::touched, this, [this, index] { current_ = index; });
}

std::string PlotsPanel::kind(int pane) const {
  const std::string id = document_.option(kOptions[pane], std::string(kDefaults[pane]));
  return isKind(id) ? id : kDefaults[pane];
}

void PlotsPanel::setKind(int pane, const std::string& id) {
  if (id == kind(pane)) return;
  for (const draw::PlotKind& k : draw::plotKinds())
    if (id == k.id) document_.setOption(kOptions[pane], id, tr("Plot: %1").arg(tr(k.title)));
}

void PlotsPanel::showOptions() {
  const bool two = document_.option("plots/two", std::string("on")) == "on";
  panes_[1].widget->setVisible(two);
  if (!two) current_ = 0;
  if (two_) two_->setChecked(two);
  for (int i = 0; i < 2; ++i) {
    Pane& pane = panes_[std::size_t(i)];
    const int at = pane.selector->findData(toQString(kind(i)));
    pane.selector->setToolTip(pane.selector->itemData(at, Qt::ToolTipRole).toString());
    if (at != pane.selector->currentIndex()) pane.selector->setCurrentIndex(at);
    const bool scatter = kind(i) == "scatter";
    pane.bar->setVisible(scatter);
    pane.bar->showOptions();
    pane.canvas->setBrushing(scatter);
    if (pane.canvas->plot().id != kind(i) || scatter) pane.dirty = true;
  }
  wantSamples();
  refresh();
}

void PlotsPanel::setDirty(std::initializer_list<const char*> kinds) {
  for (int i = 0; i < 2; ++i) {
    const std::string id = kind(i);
    if (kinds.size() == 0 || std::any_of(kinds.begin(), kinds.end(), [&](const char* k) { return id == k; }))
      panes_[std::size_t(i)].dirty = true;
  }
}

void PlotsPanel::markDirty(std::initializer_list<const char*> kinds) {
  setDirty(kinds);
  refresh();
}

void PlotsPanel::refresh() {
  for (int i = 0; i < 2; ++i) {
    Pane& pane = panes_[std::size_t(i)];
    if (!pane.dirty || !pane.canvas->isVisible()) continue;
    pane.dirty = false;
    draw::PlotData plot = data(kind(i), pane);
    plot.id = kind(i);  // even if there is nothing to show
    pane.canvas->show(plot);
    pane.canvas->setSelection(document_.selection());
  }
}

draw::PlotData PlotsPanel::data(const std::string& id, Pane& pane) {
  draw::PlotData empty;
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  const draw::Selection& s = document_.selection();
  if (id == "tradeoff") {
    if (document_.tradeoff()) return draw::tradeoffPlot(*document_.tradeoff());
    empty.empty = tr("Not measured yet: see the panel \"Speed and accuracy\"").toStdString();
    return empty;
  }
  if (!inspection) {
    // When a scene opens, the selected frame's results come before all others, and the frame view shows them too.
    if (id == "dial" && document_.frameInspection())
      return draw::residualDial(*document_.frameInspection(), s.frame, s.highlight);
    empty.empty = (!document_.scene()            ? tr("No scene")
                   : document_.frameInspection() ? tr("Computing the other frames…")
                                                 : tr("No results yet"))
                      .toStdString();
    return empty;
  }
  if (id == "error") return draw::errorPlot(*inspection);
  if (id == "scatter") return (pane.scatter = draw::scatterPlot(*inspection, *document_.rows(), pane.bar->options())).plot;
  if (id == "axes") return draw::semiAxesPlot(*inspection);
  if (id == "singular") return draw::singularValuePlot(conditioningOf(*inspection));
  if (id == "dial") return draw::residualDial(*inspection, s.frame, s.highlight);
  if (id == "influence") {
    if (document_.influence()) {
      draw::PlotData plot = draw::influencePlot(*inspection, *document_.influence(),
                                                document_.plottedModel());  // one model: a poor one's scale would hide the others
      if (document_.influenceStale()) plot.title += tr("   (out of date)").toStdString();
      return plot;
    }
    empty.empty = tr("Not measured yet: \"Measure\" leaves out each training frame in turn").toStdString();
    return empty;
  }
  if (!samples_ || samples_->frame != s.frame || samples_->model != document_.plottedModel()) {  // those are of another frame
    empty.empty = tr("Reading frame…").toStdString();
    return empty;
  }
  if (id == "lobes") return draw::lobesPlot(*samples_, s.highlight);
  return id == "lobe" ? draw::lobePlot(*samples_, s.highlight) : draw::limitAnglePlot(*samples_, s.highlight);
}

void PlotsPanel::wantSamples() {
  for (int i = 0; i < 2; ++i) {
    if (kind(i) != "lobe" && kind(i) != "lobes" && kind(i) != "limit-angle") continue;
    if (!panes_[std::size_t(i)].canvas->isVisible() || !document_.inspection()) continue;
    return loader_.want(document_.inspection(), document_.selection().frame, document_.plottedModel());
  }
}

void PlotsPanel::followSelection() {
  const draw::Selection& s = document_.selection();
  if (s.frame != shown_.frame || s.model != shown_.model) wantSamples();
  if (s.frame != shown_.frame || s.highlight != shown_.highlight) markDirty({"dial", "lobe", "lobes", "limit-angle"});
  if (s.model != shown_.model) markDirty({"influence", "lobe", "lobes", "limit-angle"});
  shown_ = s;
  for (Pane& pane : panes_)
    if (pane.canvas->isVisible() && !pane.dirty) pane.canvas->setSelection(s);
}

void PlotsPanel::clicked(const draw::PlotTarget& target) {
  if (target.setting >= 0) {
    const std::shared_ptr<const Tradeoff> t = document_.tradeoff();
    if (!t || target.setting >= int(t->points.size())) return;
    const TradeoffPoint& point = t->points[std::size_t(target.setting)];
    return document_.load(point, tr("Load %1").arg(toQString(describe(*t, point))));
  }
  document_.select(draw::selectionOf(target, document_.selection()));
}

void PlotsPanel::brush(const Pane& pane, const std::vector<draw::PlotSample>& samples) {
  const RowsPtr rows = document_.rows();
  std::set<RowKey> chosen;
  for (const draw::PlotSample& sample : samples)
    if (const int row = pane.scatter.rowOf(sample); row >= 0 && row < int(rows->size()))
      chosen.insert(keyOf((*rows)[std::size_t(row)]));
  document_.brush(std::move(chosen));
}

void PlotsPanel::askForInfluence() {
  if (!document_.scene()) return;
  wantsInfluence_ = !document_.inspection() || document_.stale();
  if (kind(0) != "influence" && !(panes_[1].canvas->isVisible() && kind(1) == "influence")) setKind(0, "influence");
  emit shown();
  if (!wantsInfluence_) emit influenceRequested();
}

void PlotsPanel::showEvent(QShowEvent* e) {
  QWidget::showEvent(e);
  wantSamples();
  refresh();
}

void PlotsPanel::renderNow() {
  refresh();
  for (Pane& pane : panes_)
    if (pane.canvas->isVisible()) pane.canvas->renderNow();
}

namespace {
/// The line and the rings of what is selected are of the window, not of a figure.
draw::Selection nothingSelected() {
  draw::Selection none;
  none.frame = -1;
  return none;
}
}  // namespace

bool PlotsPanel::saveTo(const QString& file, QString* problem, const std::optional<FigureLook>& look) {
  const PlotCanvas* canvas = panes_[std::size_t(current_)].canvas;
  const QString ending = QFileInfo(file).suffix().toLower();
  const int w = std::max(320, canvas->width()), h = std::max(200, canvas->height());
  draw::PlotStyle style{look ? look->dark : canvas->style().dark, 1};
  // Texts and strokes grow with the picture, so that it looks as on screen at any size.
  const double scale = look ? double(look->size.width()) / w : kPictureScale;
  const QSize size = look ? look->size : QSize(int(w * scale), int(h * scale));
  viz::PlotCaption caption;
  if (look) caption = {look->caption.trimmed().toStdString(), captionPx(*look)};
  try {
    if (ending == QStringLiteral("csv")) {
      viz::writePlotCsv(canvas->plot(), file.toStdString());
    } else if (ending == QStringLiteral("svg")) {
      caption.sizePx /= scale;  // its units are px of the screen
      viz::writePlotSvg(canvas->plot(), style, nothingSelected(), int(std::lround(size.width() / scale)),
                        int(std::lround(size.height() / scale)), file.toStdString(), caption);
    } else if (ending == QStringLiteral("png")) {
      style.scale = scale;
      QImage picture = toQImage(viz::plotImage(canvas->plot(), style, nothingSelected(), size.width(), size.height(), caption));
      if (look) setDpi(picture, look->dpi);
      writePng(picture, file);
    } else {
      throw InputError(file.toStdString(), "", "a plot can only be saved as .svg, .png or .csv");
    }
  } catch (const std::exception& e) {
    if (problem) *problem = toQString(e.what());
    return false;
  }
  return true;
}

void PlotsPanel::saveAs(const char* ending) {
  if (document_.shownStale() && kind(current_) != "tradeoff") return void(emit problem(notUpToDate()));
  const QString type = QString::fromLatin1(ending);
  std::optional<FigureLook> look;
  if (type != QLatin1String("csv")) {  // numbers have no size; pictures go to light pages unless the user asks for something else
    const PlotCanvas* canvas = panes_[std::size_t(current_)].canvas;
    const QSize shown = QSize(std::max(320, canvas->width()), std::max(200, canvas->height())) * devicePixelRatioF();
    FigureDialog dialog(tr("Plot as picture"), QStringLiteral("plot"), shown, this);
    dialog.setOpaque();
    dialog.proposeCaption(proposedCaption(document_, toQString(canvas->plot().title)));
    if (dialog.exec() != QDialog::Accepted) return;
    look = dialog.look();
  }
  const QString file =
      askForFile(this, document_, tr("Save plot"), suggestedFile(document_, toQString(kind(current_)), QLatin1Char('.') + type),
                 QStringLiteral("%1 (*.%2)").arg(type.toUpper(), type));
  if (file.isEmpty()) return;
  QString line;
  if (!saveTo(file, &line, look)) emit problem(line);
}

void PlotsPanel::copyPicture() {
  const PlotCanvas* canvas = panes_[std::size_t(current_)].canvas;
  const draw::PlotStyle style{canvas->style().dark, kPictureScale};
  QApplication::clipboard()->setImage(
      toQImage(viz::plotImage(canvas->plot(), style, nothingSelected(), int(std::max(320, canvas->width()) * kPictureScale),
                              int(std::max(200, canvas->height()) * kPictureScale))));
}

void PlotsPanel::copyNumbers() {
  QApplication::clipboard()->setText(exactQString(draw::plotCsv(panes_[std::size_t(current_)].canvas->plot())));
}

void PlotsPanel::copySvg() {
  const QTemporaryDir folder;
  const QString file = folder.filePath(QStringLiteral("plot.svg"));
  QString line;
  if (!saveTo(file, &line)) return emit problem(line);
  const QByteArray svg = QByteArray::fromStdString(readFile(file.toStdString()));
  auto* content = new QMimeData;
  content->setData(QStringLiteral("image/svg+xml"), svg);
  content->setText(QString::fromUtf8(svg));
  QApplication::clipboard()->setMimeData(content);
}

void PlotsPanel::addActions(Actions& actions, QMenu* menu) {
  for (const draw::PlotKind& k : draw::plotKinds())
    actions.add(QStringLiteral("plots.show-") + QString::fromLatin1(k.id), menu, tr(k.title),
                [this, id = std::string(k.id)] {
                  setKind(current_, id);
                  emit shown();
                },
                {{}, {}, tr(k.help)});
  menu->addSeparator();
  two_ = actions.addToggle(
      QStringLiteral("plots.two"), menu, tr("&Two plots side by side"),
      [this](bool on) { document_.setOption("plots/two", on ? "on" : "off", on ? tr("Two plots") : tr("One plot")); }, {});
  two_->setChecked(document_.option("plots/two", std::string("on")) == "on");
  actions.add(QStringLiteral("plots.show-all"), menu, tr("Show &whole plot"),
              [this] { panes_[std::size_t(current_)].canvas->showAll(); });
  menu->addSeparator();
  actions.add(QStringLiteral("plots.influence"), menu, tr("&Measure influence of frames"), [this] { askForInfluence(); },
              {{}, {}, tr("Leaves out each training frame in turn and shows how much the models lose")});
  menu->addSeparator();
  for (const char* ending : {"svg", "png", "csv"})
    actions.add(QStringLiteral("plots.save-") + QString::fromLatin1(ending), menu,
                tr("Save plot as %1…").arg(QString::fromLatin1(ending).toUpper()), [this, ending] { saveAs(ending); });
  actions.add(QStringLiteral("plots.copy-png"), menu, tr("Copy &plot as picture"), [this] { copyPicture(); },
              {{}, QStringLiteral("copy")});
  actions.add(QStringLiteral("plots.copy-svg"), menu, tr("Copy plot as &SVG"), [this] { copySvg(); });
  actions.add(QStringLiteral("plots.copy-csv"), menu, tr("Copy plot &numbers (CSV)"), [this] { copyNumbers(); });
}

}  // namespace glint::gui
