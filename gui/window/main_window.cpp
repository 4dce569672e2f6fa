// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/main_window.h"

#include <QApplication>
#include <QCloseEvent>
#include <QDockWidget>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QMimeData>
#include <QScreen>
#include <QSplitter>
#include <QStackedWidget>
#include <QStatusBar>
#include <QTableView>
#include <QTimer>
#include <QUndoView>
#include <QVBoxLayout>
#include <initializer_list>
#include <utility>

#include "gui/base/draw_turns.h"
#include "gui/base/eliding_delegate.h"
#include "gui/base/job_queue.h"
#include "gui/base/panel_scroll.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/undo_keys.h"
#include "gui/document/own_files.h"
#include "gui/explain/explain_panel.h"
#include "gui/export/export_actions.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/ladder_panel.h"
#include "gui/lamps/lamps_in_window.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/panels/comparison_panel.h"
#include "gui/panels/diagnosis_panel.h"
#include "gui/panels/error_table.h"
#include "gui/panels/log_panel.h"
#include "gui/panels/numbers_panel.h"
#include "gui/panels/parameter_panel.h"
#include "gui/panels/setup_panel.h"
#include "gui/panels/tradeoff_panel.h"
#include "gui/plots/conditioning_panel.h"
#include "gui/plots/plots_panel.h"
#include "gui/scene/layer_list.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_tree.h"
#include "gui/scene/scene_views.h"
#include "gui/timeline/timeline.h"
#include "gui/whatif/what_if_panel.h"
#include "gui/window/changed_inputs.h"
#include "gui/window/file_actions.h"
#include "gui/window/input_report.h"
#include "gui/window/job_status.h"
#include "gui/window/message_bar.h"
#include "gui/window/recovery.h"
#include "gui/window/scripted_actions.h"
#include "gui/window/start_page.h"
#include "gui/window/teaching.h"
#include "gui/window/undecided.h"
#include "gui/window/unreadable_files.h"
#include "gui/window/window_layout.h"
#include "gui/window/window_title.h"

namespace glint::gui {

namespace {
constexpr QSize kLeastStart(150, 100);  // px of the start page; the rest scrolls
}

MainWindow::MainWindow(Engine engine, QWidget* parent)
    : QMainWindow(parent),
      engine_(std::move(engine)),
      document_(engine_.parseTrain),
      runner_(engine_),
      observer_(engine_, document_),
      files_(new FileActions(engine_, document_, runner_, this)),
      exports_(new ExportActions(engine_, document_, this)) {
  setAcceptDrops(true);
  new UndoKeys(this);
  connect(&document_, &Document::sceneOpened, this, [this] { layout_->showAgain(); });  // before the views fit what they show
  resize(QSize(1600, 1000).boundedTo(screen()->availableSize()));
  setDockNestingEnabled(true);
  setWindowIcon(icon(QStringLiteral("glint")));
  buildCentre();
  unreadable_ = new UnreadableFiles(
      document_, *messageBar_, [this](const OpenedPtr& opened) { files_->reopen(opened); }, this);
  auto* changedInputs = new ChangedInputs(document_, *messageBar_, this);
  connect(changedInputs, &ChangedInputs::message, this, &MainWindow::log);
  buildDocks();
  buildMenus();
  buildStatusLine();
  // The scene may still be on its way.
  script_ = new ScriptedActions(
      actions_, [this] { return quiet() && (document_.scene() || document_.inputFile().isEmpty()); }, this);

  connectFiles();
  connectRunner();
  connectDocument();
  offerRecovery();
  start_->setRecent(files_->recent());
  showTitle();
  applyLayout(QStringLiteral("debug"));
}

MainWindow::~MainWindow() = default;

void MainWindow::connectFiles() {
  connect(files_, &FileActions::problem, this, &MainWindow::showProblem);
  connect(files_, &FileActions::message, this, &MainWindow::tell);
  connect(files_, &FileActions::recentChanged, this, [this] { start_->setRecent(files_->recent()); });
  connect(files_, &FileActions::viewOpened, this, [this](const OpenedPtr& opened) {
    if (!opened->layout.empty()) applyLayout(exactQString(opened->layout));
    scene_->setViewPoints(opened->viewPoints);
  });
  connect(exports_, &ExportActions::problem, this, &MainWindow::showProblem);
  connect(exports_, &ExportActions::message, this, [this](const QString& line) {
    messageBar_->overtakeError();  // it would read as if this had failed too
    tell(line);
  });
  connect(exports_, &ExportActions::sessionWritten, this, [this](const QString& line, const QString& session) {
    log(line);
    messageBar_->showOffer(line, {{tr("Open"), [this, session] { files_->open(session); }}});
  });
  exports_->setSnapshot([this] { return snapshot(); });
  exports_->setLog([this] { return log_->text(); });
  files_->setViewSource([this](Opened& opened) { addView(opened); });
  connect(files_, &FileActions::notice, this, [this](const QString& line) {
    log(line);
    messageBar_->showNotice(line);
  });
  connect(unreadable_, &UnreadableFiles::problem, this, &MainWindow::showProblem);
  connect(unreadable_, &UnreadableFiles::message, this, &MainWindow::log);
  connect(unreadable_, &UnreadableFiles::changed, this, [this] { timeline_->strip()->setUnreadable(unreadable_->all()); });
  connect(frame_, &FramePanel::photographFailed, unreadable_, &UnreadableFiles::note);
  connect(frame_, &FramePanel::problem, this, &MainWindow::showProblem);
}

void MainWindow::connectRunner() {
  connect(&runner_, &Runner::failed, this, [this](const QString& oneLine) {
    runFailed_ = true;
    if (const MissingPtr located = std::exchange(located_, {}); !missing_) missing_ = located;  // it was not the right file
    showProblem(oneLine);
    report_->start();
  });
  // Opening stopped what ran for the scene that stays open.
  connect(&runner_, &Runner::openFailed, this, [this] {
    runFailed_ = false;  // the message stays
    if (document_.stale()) recompute();
  });
  connect(&runner_, &Runner::timed, this, &MainWindow::log);
  connect(&runner_, &Runner::stopped, this, [this] { log(tr("Computation stopped")); });
  connect(&runner_, &Runner::finished, this, [this](const InspectionPtr& inspection, const OpenedPtr& computedFor) {
    if (runFailed_) messageBar_->hide();  // its reason is gone
    runFailed_ = false;
    document_.setInspection(inspection, computedFor->request);
    report_->start();
  });
  connect(&runner_, &Runner::frameFinished, &document_, &Document::setFrameInspection);
  // failed() comes next, and shows these.
  connect(&runner_, &Runner::inputMissing, this, [this](const MissingPtr& missing) { missing_ = missing; });
  connect(&runner_, &Runner::outsideNamed, this, [this](const OutsidePtr& outside) { outside_ = outside; });
  connect(&runner_, &Runner::inputUndecided, this, [this](const UndecidedPtr& undecided) { undecided_ = undecided; });
}

void MainWindow::connectDocument() {
  connect(&document_, &Document::requestChanged, this, &MainWindow::recompute);
  connect(&unexpected(), &Unexpected::problem, this,
          [this](const QString& line) { tell(tr("Unexpected failure: %1").arg(line)); });
  connect(&document_, &Document::sceneOpened, this, [this] {
    unexpected().forget();
    located_.reset();
    messageBar_->hide();
    centre_->setCurrentWidget(views_);
    log(tr("Opened %1").arg(shownText(document_.inputFile())));
    recompute();
  });
  connect(&document_, &Document::sceneOpened, this, &MainWindow::showTitle);
  connect(&document_, &Document::savedStateChanged, this, &MainWindow::showTitle);
}

void MainWindow::offerRecovery() {
  auto* recovery = new Recovery(
      engine_, document_, [this] { return snapshot(); }, *files_, *messageBar_, this);
  connect(recovery, &Recovery::problem, this, &MainWindow::log);
  auto* history = findChild<QUndoView*>(QStringLiteral("historyList"));
  connect(recovery, &Recovery::opened, history, [history](bool recovered) {
    history->setEmptyLabel(recovered ? tr("As recovered; earlier steps are lost") : tr("As opened"));
  });
  recovery->offer();
}

void MainWindow::buildCentre() {
  auto* middle = new QWidget;
  auto* column = new QVBoxLayout(middle);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  messageBar_ = new MessageBar;
  column->addWidget(messageBar_);
  centre_ = new QStackedWidget;
  start_ = new StartPage;
  connect(start_, &StartPage::openFile, files_, &FileActions::openDialog);
  connect(start_, &StartPage::openFolder, files_, &FileActions::openFolderDialog);
  connect(start_, &StartPage::openRecent, files_, &FileActions::open);
  fillStartPage(*start_);
  auto* startScroll =
      new PanelScroll(start_, kLeastStart);  // hidden pages of a stack count for its least height, and this one is long
  startScroll->setAccessibleName(tr("Start page"));
  centre_->addWidget(startScroll);
  views_ = new QSplitter(Qt::Horizontal);
  frame_ = new FramePanel(document_);  // first: it shows new results before the others take their time
  scene_ = new ScenePanel(document_);
  views_->addWidget(scene_);
  views_->addWidget(frame_);
  views_->setChildrenCollapsible(false);
  centre_->addWidget(views_);
  layout_ = new WindowLayout(this, docks_, views_);
  // Plain arrow keys step where they mean nothing else; sliders and tables keep theirs.
  for (const auto& [key, by] : {std::pair(Qt::Key_Left, -1), std::pair(Qt::Key_Right, 1)}) {
    auto* step = new QAction(views_);
    step->setShortcut(key);
    step->setShortcutContext(Qt::WidgetWithChildrenShortcut);
    connect(step, &QAction::triggered, this, [this, by = by] { timeline_->strip()->step(by); });
    views_->addAction(step);
  }
  column->addWidget(centre_, 1);
  setCentralWidget(middle);
}

void MainWindow::buildDocks() {
  setCorner(Qt::BottomLeftCorner, Qt::BottomDockWidgetArea);
  setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
  buildLeftDocks();
  buildRightDocks();
  buildResultDocks();
  buildWorkDocks();
}

void MainWindow::buildLeftDocks() {
  setup_ = new SetupPanel(document_);
  connect(setup_, &SetupPanel::autoRequested, this, [this](double goodEnoughPct) {
    if (document_.scene() && engine_.choose)
      runner_.choose(document_.sharedScene(), document_.request(), goodEnoughPct, document_.computed());
  });
  connect(&runner_, &Runner::chosen, this, &MainWindow::takeChoice);
  docks_.add("setup", tr("Setup"), setup_, Qt::LeftDockWidgetArea);
  auto* layers = new LayerPanel(document_);
  docks_.add("layers", tr("Layers"), layers, Qt::LeftDockWidgetArea);
  connect(scene_, &ScenePanel::activeViewChanged, layers, &LayerPanel::setActiveView);
  tree_ = new SceneTree(document_);
  docks_.add("tree", tr("Scene tree"), tree_, Qt::LeftDockWidgetArea, "layers");
  connect(scene_, &ScenePanel::activeViewChanged, tree_, &SceneTree::setActiveView);
  connect(tree_, &SceneTree::frameSelectionRequested, scene_, &ScenePanel::frameSelection);
  connect(tree_, &SceneTree::lookThroughRequested, scene_, [this] { scene_->setEye(viz::Eye::Camera); });
  auto* history = new QUndoView(document_.undoStack());
  history->setObjectName(QStringLiteral("historyList"));
  history->setAccessibleName(tr("History"));
  history->setEmptyLabel(tr("As opened"));
  history->setItemDelegate(new ElidingDelegate(history));
  docks_.add("history", tr("History"), history, Qt::LeftDockWidgetArea, "layers");
}

void MainWindow::buildRightDocks() {
  parameters_ = new ParameterPanel(document_);
  docks_.add("parameters", tr("Settings"), parameters_, Qt::RightDockWidgetArea);
  whatIf_ = new WhatIfPanel(document_);
  docks_.add("what-if", tr("What-if"), whatIf_, Qt::RightDockWidgetArea, "parameters");
  docks_.add("conditioning", tr("Conditioning"), new ConditioningPanel(document_), Qt::RightDockWidgetArea);
  numbers_ = new NumbersPanel(document_);
  docks_.add("numbers", tr("Numbers"), numbers_, Qt::RightDockWidgetArea);
  connect(scene_, &ScenePanel::picked, numbers_, &NumbersPanel::showPicked);

  explain_ = new ExplainPanel(document_);
  docks_.add("explain", tr("Explain"), explain_, Qt::RightDockWidgetArea, "parameters");
  connect(explain_, &ExplainPanel::lessonRequested, files_, &FileActions::open);
  connect(explain_, &ExplainPanel::problem, this, &MainWindow::showProblem);
  teaching_ = new Teaching({this, document_, docks_, *layout_, *explain_, *scene_, *frame_});
}

/// At the bottom: what the results are.
void MainWindow::buildResultDocks() {
  timeline_ = new Timeline(document_);
  docks_.add("timeline", tr("Timeline"), timeline_, Qt::BottomDockWidgetArea);
  errors_ = new ErrorTable(document_);
  docks_.add("errors", tr("Errors"), errors_, Qt::BottomDockWidgetArea);
  diagnosis_ = new DiagnosisPanel(document_);
  QDockWidget* const problems = docks_.add("problems", tr("Problems"), diagnosis_, Qt::BottomDockWidgetArea, "errors");
  connect(&document_, &Document::staleChanged, new StaleBadge(diagnosis_), &StaleBadge::setStale);
  connect(diagnosis_, &DiagnosisPanel::problem, this, &MainWindow::showProblem);
  connect(diagnosis_, &DiagnosisPanel::message, this, &MainWindow::tell);
  connect(diagnosis_, &DiagnosisPanel::runsChanged, scene_, [this](const auto& runs) { scene_->views().setRuns(runs); });
  connect(diagnosis_, &DiagnosisPanel::problemsChanged, problems,
          [problems](int count) { problems->setWindowTitle(count == 0 ? tr("Problems") : tr("Problems (%1)").arg(count)); });
  plots_ = new PlotsPanel(document_);
  docks_.add("plots", tr("Plots"), plots_, Qt::BottomDockWidgetArea);
  log_ = new LogPanel;
  docks_.add("log", tr("Log"), log_, Qt::BottomDockWidgetArea, "errors");
  report_ = new InputReport(engine_, document_, *files_, *messageBar_, this);
  docks_.add("report", tr("Input report"), report_->panel(), Qt::BottomDockWidgetArea, "errors");
  connect(report_, &InputReport::problem, this, &MainWindow::showProblem);
  connect(report_, &InputReport::message, this, &MainWindow::log);
  connect(report_, &InputReport::shown, this, [this] { docks_.bring(QStringLiteral("report")); });
}

/// At the bottom: what is measured or compared when somebody asks for it.
void MainWindow::buildWorkDocks() {
  ladder_ = new LadderPanel(document_, *frame_->loader());
  docks_.add("ladder", tr("Ladder"), ladder_, Qt::BottomDockWidgetArea, "errors");
  tradeoff_ = new TradeoffPanel(document_);
  docks_.add("tradeoff", tr("Speed and accuracy"), tradeoff_, Qt::BottomDockWidgetArea, "errors");
  connect(tradeoff_, &TradeoffPanel::measureRequested, this, [this] {
    if (document_.scene() && engine_.tradeoff)
      runner_.measure(document_.sharedScene(), document_.request(),
                      (document_.sessionFile().isEmpty() ? document_.inputFile() : document_.sessionFile()).toStdString());
  });
  connect(&runner_, &Runner::busyChanged, tradeoff_, &TradeoffPanel::setBusy);
  connect(&runner_, &Runner::measured, this, &MainWindow::takeTradeoff);
  comparison_ = new ComparisonPanel(engine_, document_, *exports_->longJob());
  docks_.add("comparison", tr("Comparison"), comparison_, Qt::BottomDockWidgetArea, "errors");
  connect(comparison_, &ComparisonPanel::problem, this, &MainWindow::showProblem);
  connect(comparison_, &ComparisonPanel::shown, this, [this] { docks_.bring(QStringLiteral("comparison")); });
  lamps_ = new LampsInWindow(engine_, document_, *scene_, this);
  docks_.add("lamps", tr("Lamps"), lamps_->panel(), Qt::BottomDockWidgetArea, "errors");
  connect(lamps_, &LampsInWindow::problem, this, &MainWindow::showProblem);
  connect(lamps_, &LampsInWindow::message, this, &MainWindow::tell);
  connect(lamps_, &LampsInWindow::shown, this, [this] { docks_.bring(QStringLiteral("lamps")); });
  connect(plots_, &PlotsPanel::problem, this, &MainWindow::showProblem);
  connect(plots_, &PlotsPanel::shown, this, [this] { docks_.bring(QStringLiteral("plots")); });
  connect(plots_, &PlotsPanel::influenceRequested, this, &MainWindow::measureInfluence);
  connect(scene_, &ScenePanel::influenceRequested, this, &MainWindow::measureInfluence);
  connect(tree_, &SceneTree::influenceRequested, this, &MainWindow::measureInfluence);
  connect(&runner_, &Runner::influenceMeasured, this, &MainWindow::takeInfluence);
}

void MainWindow::takeChoice(const SelectionPtr& selection, const OpenedPtr& computedFor) {
  if (computedFor->scene != document_.sharedScene() || computedFor->request != document_.request()) return;  // too late
  const QString table = toQString(selectionTable(*selection));
  log(tr("Automatic choice of model\n") + table);
  setup_->showChoice(toQString(selection->why + (selection->patches ? " " + selection->patches->why : "")), table);
  if (!selection->best.empty())
    document_.setRequest(chosenRequest(document_.request(), *selection),
                         (selection->model.empty() ? tr("Best of those refused: %1") : tr("Automatic choice: %1"))
                             .arg(toQString(selection->best)));
  if (document_.stale()) recompute();  // the choice took the place of a run that was under way
}

void MainWindow::takeTradeoff(const TradeoffPtr& tradeoff, const OpenedPtr& computedFor) {
  if (computedFor->scene != document_.sharedScene()) return;
  document_.setTradeoff(tradeoff);
  log(tr("Speed and accuracy: %1").arg(toQString(tradeoff->reason)));
  if (document_.stale()) recompute();  // the measurement took the place of a run that was under way
}

void MainWindow::measureInfluence() {
  if (document_.inspection() && engine_.influence) runner_.influence(document_.inspection());
}

void MainWindow::takeInfluence(const InfluencePtr& influence, const InspectionPtr& inspection) {
  if (inspection->given != document_.sharedScene()) return;
  document_.setInfluence(influence, inspection->request);
  if (document_.stale()) recompute();  // it took the place of a run that was under way
}

void MainWindow::buildStatusLine() {
  probe_ = new QLabel;
  probe_->setObjectName(QStringLiteral("probe"));
  statusBar()->addWidget(probe_);
  connect(frame_, &FramePanel::probed, probe_, &QLabel::setText);
  statusBar()->addPermanentWidget(new JobStatus(document_, runner_));
}

void MainWindow::open(const QString& input, const QString& frame, const InputChoices& choices) {
  files_->setFrameToSelect(frame);
  if (choices.none()) return files_->drop(input);  // as if it were dropped: a photograph selects its frame
  Relinked how;
  how.choices = choices;
  files_->openRelinked(input, how);
}

void MainWindow::applyLayout(const QString& name) {
  layout_->apply(name);
  if (!document_.scene()) layout_->hideUntilOpen();
}

void MainWindow::resizeEvent(QResizeEvent* e) {
  QMainWindow::resizeEvent(e);
  if (layout_) layout_->followSize();
}

bool MainWindow::event(QEvent* e) {
  const bool done = QMainWindow::event(e);
  // Else Qt holds a window that shrinks at what its docks need now, also once they need less.
  if (e->type() == QEvent::LayoutRequest && isVisible()) setMinimumSize(layout_->leastSize(minimumSizeHint()));
  return done;
}

void MainWindow::runActions(const QStringList& ids) { script_->run(ids); }

void MainWindow::setTheme(Theme theme) {
  if (auto* app = qobject_cast<QApplication*>(QCoreApplication::instance())) applyTheme(*app, theme);
  scene_->setDark(theme == Theme::Dark);
  start_->setRecent(files_->recent());  // its colours are part of the text
}

void MainWindow::addView(Opened& opened) const {
  opened.layout = layout_->name().toStdString();
  opened.viewPoints = scene_->viewPoints();
}

Opened MainWindow::snapshot() const {
  Opened opened = document_.toSave();
  opened.isSession = !opened.path.empty();
  addView(opened);
  return opened;
}

bool MainWindow::idle() const { return script_->done() && quiet(); }

bool MainWindow::quiet() const {
  return !runner_.busy() && !frame_->busy() && !timeline_->busy() && !scene_->busy() && plots_->idle() && !diagnosis_->busy() &&
         !explain_->busy() && !exports_->busy() && !unreadable_->busy() && !lamps_->busy() && !observer_.busy() &&
         !drawingsWait();
}

QPixmap MainWindow::picture() {
  if (QWidget* balls = lamps_->shownBalls()) return balls->grab();
  if (centre_->currentWidget() == views_) scene_->renderNow();
  plots_->renderNow();
  return grab();
}

void MainWindow::recompute() {
  if (document_.inspection() && !document_.stale()) {  // undo, redo, a setting that is flipped back
    runner_.drop();
    if (std::exchange(runFailed_, false)) messageBar_->hide();
    return log(tr("Taken from before: the results of these settings were still there"));
  }
  if (document_.scene() && engine_.ask) runner_.inspect(document_.pipeline(), document_.request(), document_.selection().frame);
}

void MainWindow::showProblem(const QString& oneLine) {
  lastError_ = oneLine;
  if (const MissingPtr missing = std::exchange(missing_, {}))
    offerToLocate(oneLine, missing);
  else if (const OutsidePtr outside = std::exchange(outside_, {}))
    messageBar_->showError(tr("%1. Open it anyway and let it use files in %2? Do this only if you trust its author.")
                               .arg(oneLine, shownText(exactQString(outside->folder))),
                           {{tr("Allow and open"), [this, outside] { files_->allow(outside); }}});
  else if (const UndecidedPtr undecided = std::exchange(undecided_, {}))
    askIn(*messageBar_, oneLine, undecided, this,
          [this](const QString& path, const Relinked& with) { files_->openRelinked(path, with); });
  else if (!unreadable_->offerMesh(oneLine))
    messageBar_->showError(oneLine);
  log(oneLine);
  emit problem(oneLine);
}

void MainWindow::offerToLocate(const QString& oneLine, const MissingPtr& missing) {
  messageBar_->showError(oneLine, {{tr("Locate…"), [this, oneLine, missing] {
                                      if (files_->locate(missing))
                                        located_ = missing;
                                      else
                                        offerToLocate(oneLine, missing);
                                    }}});
}

void MainWindow::log(const QString& line) { log_->add(line); }

/// Writes a line to the log and, for a while, to the status line.
void MainWindow::tell(const QString& line) {
  log(line);
  // A menu that closes clears the line of status tips: after that.
  QTimer::singleShot(0, this, [this, line] { statusBar()->showMessage(shownText(line), 6000); });
}

void MainWindow::showTitle() {
  if (!document_.scene()) return setWindowTitle(tr("Glint inspector"));
  // "[*]" is where Qt puts the mark of unsaved changes; twice it stands for itself.
  const QString name = titleOf(document_).replace(QStringLiteral("[*]"), QStringLiteral("[*][*]"));
  setWindowTitle(QStringLiteral("%1[*] – %2").arg(name, tr("Glint inspector")));
  setWindowModified(document_.hasUnsavedChanges() && !isOpenLesson(document_));
}

bool MainWindow::focusNextPrevChild(bool next) {
  QWidget* from = focusWidget() ? focusWidget() : this;
  const auto after = [next](const QWidget* w) { return next ? w->nextInFocusChain() : w->previousInFocusChain(); };
  for (QWidget* w = after(from); w && w != from; w = after(w)) {
    if (w == this || !(w->focusPolicy() & Qt::TabFocus) || w->focusProxy() || !w->isVisibleTo(this) || !w->isEnabled() ||
        w->window() != this || Docks::isBehind(w))
      continue;
    w->setFocus(next ? Qt::TabFocusReason : Qt::BacktabFocusReason);
    return true;
  }
  return false;
}

void MainWindow::closeEvent(QCloseEvent* e) {
  if (!files_->mayDiscard()) return e->ignore();
  runner_.cancel();
  e->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* e) {
  if (!FileActions::dropped(e->mimeData()).isEmpty()) e->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* e) { files_->drop(FileActions::dropped(e->mimeData())); }

}  // namespace glint::gui
