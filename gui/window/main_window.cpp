// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/main_window.h"

#include <QApplication>
#include <QCloseEvent>
#include <QDir>
#include <QDockWidget>
#include <QFileInfo>
#include <QLabel>
#include <QLocale>
#include <QMenuBar>
#include <QMimeData>
#include <QPlainTextEdit>
#include <QScrollArea>
#include <QSplitter>
#include <QStackedWidget>
#include <QStandardPaths>
#include <QStatusBar>
#include <QTime>
#include <QTimer>
#include <QToolBar>
#include <QUndoView>
#include <QVBoxLayout>
#include <utility>

#include "gui/base/text.h"
#include "gui/explain/explain_panel.h"
#include "gui/export/export_actions.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/ladder_panel.h"
#include "gui/panels/error_table.h"
#include "gui/panels/numbers_panel.h"
#include "gui/panels/parameter_panel.h"
#include "gui/panels/setup_panel.h"
#include "gui/panels/tradeoff_panel.h"
#include "gui/plots/conditioning_panel.h"
#include "gui/plots/plots_panel.h"
#include "gui/scene/layer_list.h"
#include "gui/scene/scene_panel.h"
#include "gui/timeline/timeline.h"
#include "gui/whatif/what_if_panel.h"
#include "gui/window/autosave.h"
#include "gui/window/file_actions.h"
#include "gui/window/job_status.h"
#include "gui/window/layouts.h"
#include "gui/window/message_bar.h"
#include "gui/window/palette.h"
#include "gui/window/palette_items.h"
#include "gui/window/shortcut_dialog.h"
#include "gui/window/start_page.h"

namespace glint::gui {

MainWindow::MainWindow(Engine engine, QWidget* parent)
    : QMainWindow(parent),
      engine_(std::move(engine)),
      document_(engine_.parseTrain),
      runner_(engine_),
      files_(new FileActions(engine_, document_, runner_, this)),
      exports_(new ExportActions(engine_, document_, this)) {
  setAcceptDrops(true);
  setMinimumSize(1100, 700);
  resize(1600, 1000);
  setDockNestingEnabled(true);
  setWindowIcon(icon(QStringLiteral("glint")));
  buildCentre();
  buildDocks();
  buildMenus();
  buildStatusLine();

  connect(files_, &FileActions::problem, this, &MainWindow::showProblem);
  connect(files_, &FileActions::message, this, [this](const QString& line) {
    log(line);
    statusBar()->showMessage(line, 6000);
  });
  connect(files_, &FileActions::recentChanged, this, [this] { start_->setRecent(files_->recent()); });
  connect(files_, &FileActions::viewOpened, this, [this](const OpenedPtr& opened) {
    if (!opened->layout.empty()) applyLayout(toQString(opened->layout));
    scene_->setViewPoint(opened->viewPoint);
  });
  for (const auto signal : {&ExportActions::problem, &ExportActions::message})
    connect(exports_, signal, this, [this, signal](const QString& line) {
      if (signal == &ExportActions::problem) return showProblem(line);
      log(line);
      statusBar()->showMessage(line, 6000);
    });
  exports_->setSnapshot([this] { return snapshot(); });
  exports_->setLog([this] { return log_->toPlainText(); });
  files_->setViewSource([this](Opened& opened) { addView(opened); });
  connect(&runner_, &Runner::failed, this, [this](const QString& oneLine) {
    runFailed_ = true;
    showProblem(oneLine);
  });
  // Opening stopped what ran for the scene that stays open.
  connect(&runner_, &Runner::openFailed, this, [this] {
    runFailed_ = false;  // the message stays
    if (document_.stale()) recompute();
  });
  connect(&runner_, &Runner::stopped, this, [this] { log(tr("Stopped")); });
  connect(&runner_, &Runner::finished, this, [this](const InspectionPtr& inspection, const OpenedPtr& computedFor) {
    if (runFailed_) messageBar_->hide();  // its reason is gone
    runFailed_ = false;
    document_.setInspection(inspection, computedFor->request);
  });
  connect(&document_, &Document::requestChanged, this, &MainWindow::recompute);
  connect(&document_, &Document::sceneOpened, this, [this] {
    messageBar_->hide();
    if (const auto found = std::exchange(recovering_, {}))
      QTimer::singleShot(0, this, [this, found] {
        autosave_->flush();  // what was recovered is in this program's own file before the other one goes
        Autosave::discard(*found);
      });
    centre_->setCurrentWidget(views_);
    log(tr("Opened %1").arg(document_.inputFile()));
    recompute();
  });
  connect(&document_, &Document::sceneOpened, this, &MainWindow::showTitle);
  connect(&document_, &Document::savedStateChanged, this, &MainWindow::showTitle);
  connect(&runner_, &Runner::sceneMissing, this, [this](const QString& session, const QString& scene) {
    missing_ = {session, scene};  // failed() comes next, and shows it
  });
  autosave_ = new Autosave(
      engine_, document_, [this] { return snapshot(); }, recoveryFolder(), this);
  connect(autosave_, &Autosave::problem, this, &MainWindow::log);
  offerRecovery();
  start_->setRecent(files_->recent());
  showTitle();
  applyLayout(QStringLiteral("debug"));
}

MainWindow::~MainWindow() = default;

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
  centre_->addWidget(start_);
  views_ = new QSplitter(Qt::Horizontal);
  scene_ = new ScenePanel(document_);
  frame_ = new FramePanel(document_);
  views_->addWidget(scene_);
  views_->addWidget(frame_);
  views_->setChildrenCollapsible(false);
  centre_->addWidget(views_);
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

QDockWidget* MainWindow::addDock(const char* name, const QString& title, QWidget* content, Qt::DockWidgetArea area,
                                 const char* behind) {
  auto* dock = new QDockWidget(title);
  dock->setObjectName(QLatin1String(name));
  dock->setWidget(content);
  addDockWidget(area, dock);
  docks_.insert(QLatin1String(name), dock);
  if (QDockWidget* host = docks_.value(QLatin1String(behind))) {
    tabifyDockWidget(host, dock);
    host->raise();
    hosts_.insert(QLatin1String(name), QLatin1String(behind));
  }
  return dock;
}

void MainWindow::buildDocks() {
  setCorner(Qt::BottomLeftCorner, Qt::BottomDockWidgetArea);
  setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
  setup_ = new SetupPanel(document_);
  connect(setup_, &SetupPanel::problem, this, &MainWindow::showProblem);
  connect(setup_, &SetupPanel::autoRequested, this, [this](double goodEnoughPct) {
    if (document_.scene() && engine_.choose)
      runner_.choose(document_.sharedScene(), document_.request(), goodEnoughPct, document_.inspection());
  });
  connect(&runner_, &Runner::chosen, this, [this](const SelectionPtr& selection, const OpenedPtr& computedFor) {
    if (computedFor->scene != document_.sharedScene() || computedFor->request != document_.request()) return;  // too late
    const QString table = toQString(selectionTable(*selection));
    log(tr("Automatic choice of the model\n") + table);
    setup_->showChoice(toQString(selection->why + (selection->patches ? " " + selection->patches->why : "")), table);
    if (!selection->model.empty())
      document_.setRequest(chosenRequest(document_.request(), *selection),
                           tr("Automatic choice: %1").arg(toQString(selection->model)));
    if (document_.stale()) recompute();  // the choice took the place of a run that was under way
  });
  auto* setupScroll = new QScrollArea;  // small windows scroll it instead of squeezing it
  setupScroll->setWidget(setup_);
  setupScroll->setWidgetResizable(true);
  setupScroll->setMinimumWidth(190);
  setupScroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  addDock("setup", tr("Setup"), setupScroll, Qt::LeftDockWidgetArea);
  addDock("layers", tr("Layers"), new LayerList(document_), Qt::LeftDockWidgetArea);
  auto* history = new QUndoView(document_.undoStack());
  history->setEmptyLabel(tr("As opened"));
  addDock("history", tr("History"), history, Qt::LeftDockWidgetArea, "layers");

  parameters_ = new ParameterPanel(document_);
  addDock("parameters", tr("Parameters"), parameters_, Qt::RightDockWidgetArea);
  addDock("what-if", tr("What if"), new WhatIfPanel(document_), Qt::RightDockWidgetArea, "parameters");
  addDock("conditioning", tr("Conditioning"), new ConditioningPanel(document_), Qt::RightDockWidgetArea);
  numbers_ = new NumbersPanel(document_);
  addDock("numbers", tr("Numbers"), numbers_, Qt::RightDockWidgetArea);
  connect(scene_, &ScenePanel::picked, numbers_, &NumbersPanel::showPicked);

  explain_ = new ExplainPanel(document_);
  addDock("explain", tr("Explain"), explain_, Qt::RightDockWidgetArea, "parameters");
  connect(explain_, &ExplainPanel::started, this, [this] {
    docks_["explain"]->show();
    docks_["explain"]->raise();
  });

  timeline_ = new Timeline(document_);
  QDockWidget* timeline = addDock("timeline", tr("Timeline"), timeline_, Qt::BottomDockWidgetArea);
  errors_ = new ErrorTable(document_);
  QDockWidget* errors = addDock("errors", tr("Errors"), errors_, Qt::BottomDockWidgetArea);
  splitDockWidget(timeline, errors, Qt::Vertical);
  plots_ = new PlotsPanel(document_);
  QDockWidget* plots = addDock("plots", tr("Plots"), plots_, Qt::BottomDockWidgetArea);
  splitDockWidget(errors, plots, Qt::Horizontal);  // before anything is a tab: Qt would make the plots one too
  log_ = new QPlainTextEdit;
  log_->setReadOnly(true);
  log_->setMaximumBlockCount(2000);
  addDock("log", tr("Log"), log_, Qt::BottomDockWidgetArea, "errors");
  ladder_ = new LadderPanel(document_, *frame_->loader());
  addDock("ladder", tr("Ladder"), ladder_, Qt::BottomDockWidgetArea, "errors");
  tradeoff_ = new TradeoffPanel(document_);
  addDock("tradeoff", tr("Speed and accuracy"), tradeoff_, Qt::BottomDockWidgetArea, "errors");
  connect(tradeoff_, &TradeoffPanel::measureRequested, this, [this] {
    if (document_.scene() && engine_.tradeoff)
      runner_.measure(document_.sharedScene(), document_.request(),
                      (document_.sessionFile().isEmpty() ? document_.inputFile() : document_.sessionFile()).toStdString());
  });
  connect(&runner_, &Runner::busyChanged, tradeoff_, &TradeoffPanel::setBusy);
  connect(&runner_, &Runner::measured, this, [this](const TradeoffPtr& tradeoff, const OpenedPtr& computedFor) {
    if (computedFor->scene != document_.sharedScene()) return;
    document_.setTradeoff(tradeoff);
    log(tr("Speed and accuracy: %1").arg(toQString(tradeoff->reason)));
    if (document_.stale()) recompute();  // the measurement took the place of a run that was under way
  });
  connect(plots_, &PlotsPanel::problem, this, &MainWindow::showProblem);
  connect(plots_, &PlotsPanel::shown, plots, [plots] {
    plots->show();
    plots->raise();
  });
  connect(plots_, &PlotsPanel::influenceRequested, this, [this] {
    if (document_.inspection() && engine_.influence) runner_.influence(document_.inspection());
  });
  connect(&runner_, &Runner::influenceMeasured, this, [this](const InfluencePtr& influence, const InspectionPtr& inspection) {
    if (inspection->given != document_.sharedScene()) return;
    document_.setInfluence(influence, inspection->request);
    if (document_.stale()) recompute();  // it took the place of a run that was under way
  });
  errors->raise();
}

void MainWindow::buildMenus() {
  QMenu* file = menuBar()->addMenu(tr("&File"));
  files_->addActions(actions_, file);
  file->addSeparator();
  exports_->addActions(actions_, file->addMenu(tr("&Export")));
  file->addSeparator();
  actions_.add("file.quit", file, tr("&Quit"), [this] { close(); }, {QKeySequence::keyBindings(QKeySequence::Quit)});

  QMenu* edit = menuBar()->addMenu(tr("&Edit"));
  QUndoStack* stack = document_.undoStack();
  actions_.adopt("edit.undo", edit, stack->createUndoAction(this, tr("&Undo")), {{QKeySequence::Undo}, "undo"});
  actions_.adopt("edit.redo", edit, stack->createRedoAction(this, tr("&Redo")), {{QKeySequence::Redo}, "redo"});
  edit->addSeparator();
  actions_.add("edit.copy-numbers", edit, tr("Copy &numbers"), [this] { numbers_->copy(); }, {{}, "copy"});
  actions_.add("edit.copy-error-rows", edit, tr("Copy &error rows"), [this] { errors_->copySelection(); });
  actions_.add("edit.stop", edit, tr("&Stop what runs"), [this] { runner_.cancel(); }, {{Qt::Key_Escape}, "stop"});

  edit->addSeparator();
  palette_ = new Palette(
      [this](const QString& typed) {
        return paletteItems(typed, actions_, document_, [this](const std::string& key) {
          docks_["parameters"]->show();
          docks_["parameters"]->raise();
          parameters_->showParameter(key);
        });
      },
      this);
  actions_.add("edit.palette", edit, tr("&Find an action, parameter or frame…"), [this] { palette_->popUp(); },
               {{QKeySequence("Ctrl+Shift+P"), QKeySequence("Ctrl+K")}});
  actions_.add("edit.shortcuts", edit, tr("&Keyboard shortcuts…"), [this] { ShortcutDialog(actions_, this).exec(); });

  QMenu* frame = menuBar()->addMenu(tr("F&rame"));
  timeline_->addActions(actions_, frame);
  frame->addSeparator();
  frame_->addActions(actions_, frame);
  ladder_->addActions(actions_, frame);

  QMenu* plots = menuBar()->addMenu(tr("&Plots"));
  plots_->addActions(actions_, plots);

  QMenu* view = menuBar()->addMenu(tr("&View"));
  scene_->addActions(actions_, view);
  view->addSeparator();
  QMenu* layoutMenu = view->addMenu(tr("&Layout"));
  for (const Layout& layout : layouts()) {
    const QString name = QString::fromLatin1(layout.name);
    actions_.add("view.layout-" + name, layoutMenu, tr(layout.title), [this, name] { applyLayout(name); });
  }
  QMenu* panels = view->addMenu(tr("&Panels"));
  for (auto it = docks_.begin(); it != docks_.end(); ++it) {
    QDockWidget* dock = it.value();
    QAction* action = actions_.addToggle("view.panel-" + it.key(), panels, dock->windowTitle(),
                                         [dock](bool) {
                                           // What lies behind another tab is not seen: it comes to the front instead of going
                                           // away.
                                           if (dock->isVisible() && !dock->visibleRegion().isEmpty()) return dock->hide();
                                           dock->show();
                                           dock->raise();
                                         },
                                         {});
    const auto follow = [action, dock] { action->setChecked(!dock->isHidden()); };
    connect(dock->toggleViewAction(), &QAction::toggled, action, follow);
    connect(action, &QAction::triggered, action, follow);
    follow();
  }
  view->addSeparator();
  actions_.add("view.theme", view, tr("Light or dark &theme"),
               [this] { setTheme(currentTheme() == Theme::Dark ? Theme::Light : Theme::Dark); }, {{}, "theme"});

  explain_->addActions(actions_, menuBar()->addMenu(tr("E&xplain")));

  QToolBar* bar = addToolBar(tr("Tools"));
  bar->setObjectName(QStringLiteral("tools"));
  bar->setMovable(false);
  bar->setIconSize({18, 18});
  for (const char* id : {"file.open", "file.save", "", "edit.undo", "edit.redo", "", "view.frame-all", "view.look-through",
                         "frame.highlight", "", "view.theme"}) {
    if (QAction* action = actions_.find(QLatin1String(id)))
      bar->addAction(action);
    else
      bar->addSeparator();
  }
  actions_.loadShortcuts();
}

void MainWindow::buildStatusLine() {
  probe_ = new QLabel;
  probe_->setObjectName(QStringLiteral("probe"));
  statusBar()->addWidget(probe_);
  connect(frame_, &FramePanel::probed, probe_, &QLabel::setText);
  statusBar()->addPermanentWidget(new JobStatus(document_, runner_));
}

void MainWindow::open(const QString& input, const QString& frame) {
  files_->setFrameToSelect(frame);
  files_->open(input);
}

void MainWindow::applyLayout(const QString& name) {
  const Layout& layout = layoutByName(name);
  layout_ = QLatin1String(layout.name);
  for (auto dock = docks_.begin(); dock != docks_.end(); ++dock) {
    // What is a tab behind another dock follows it, unless the layout names it itself.
    const QString host = hosts_.value(dock.key(), dock.key());
    dock.value()->setVisible(layout.docks.contains(dock.key()) || layout.docks.contains(host));
  }
  for (const char* front : {"errors", "layers", "parameters"}) docks_[QLatin1String(front)]->raise();
  for (const QString& front : layout.front) docks_[front]->raise();
  resizeDocks({docks_["setup"], docks_["parameters"]}, {230, 380}, Qt::Horizontal);
  resizeDocks({docks_["timeline"], docks_["errors"]}, {150, height() * 3 / 10}, Qt::Vertical);
  resizeDocks({docks_["setup"], docks_["layers"]}, {284, 264}, Qt::Vertical);
  resizeDocks({docks_["parameters"], docks_["conditioning"], docks_["numbers"]}, {400, 290, 210}, Qt::Vertical);
  resizeDocks({docks_["errors"], docks_["plots"]}, {1, 1}, Qt::Horizontal);
  views_->setSizes({layout.sceneShare * 10, (100 - layout.sceneShare) * 10});
}

void MainWindow::runActions(const QStringList& ids) {
  constexpr int kLookMs = 30;
  QStringList known;
  for (const QAction* action : actions_.all()) known << Actions::id(action);
  for (const QString& id : ids)
    if (!known.contains(id))
      throw InputError("", "--run", "'" + id.toStdString() + "' is none of: " + known.join(QStringLiteral(", ")).toStdString());
  toRun_ += ids;
  auto* clock = new QTimer(this);
  connect(clock, &QTimer::timeout, this, [this, clock] {
    if (!quiet() || (!document_.scene() && !document_.inputFile().isEmpty())) return;
    actions_.find(toRun_.takeFirst())->trigger();
    if (toRun_.isEmpty()) clock->deleteLater();
  });
  clock->start(kLookMs);
}

void MainWindow::setTheme(Theme theme) {
  if (auto* app = qobject_cast<QApplication*>(QCoreApplication::instance())) applyTheme(*app, theme);
  scene_->setDark(theme == Theme::Dark);
  start_->setRecent(files_->recent());  // its colours are part of the text
}

void MainWindow::addView(Opened& opened) const {
  opened.layout = layout_.toStdString();
  opened.viewPoint = scene_->viewPoint();
}

Opened MainWindow::snapshot() const {
  Opened opened = document_.toSave();
  opened.isSession = !opened.path.empty();
  addView(opened);
  return opened;
}

QString MainWindow::recoveryFolder() {
  return QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + QStringLiteral("/recovery");
}

void MainWindow::offerRecovery() {
  const std::optional<Autosave::Found> found = autosave_->leftBehind();
  if (!found) return;
  messageBar_->showOffer(tr("The program ended without saving what was changed on %1 (%2).")
                             .arg(QDir::toNativeSeparators(found->of), QLocale().toString(found->when, QLocale::ShortFormat)),
                         {{tr("Recover"),
                           [this, found = *found] {
                             recovering_ = found;
                             files_->open(found.file);
                           }},
                          {tr("Discard"), [this, found = *found] {
                             Autosave::discard(found);
                             offerRecovery();
                           }}});
}

bool MainWindow::idle() const { return toRun_.isEmpty() && quiet(); }

bool MainWindow::quiet() const {
  return !runner_.busy() && !frame_->busy() && !timeline_->busy() && !scene_->busy() && plots_->idle() && !explain_->busy() &&
         !exports_->busy();
}

QPixmap MainWindow::picture() {
  if (centre_->currentWidget() == views_) scene_->renderNow();
  plots_->renderNow();
  return grab();
}

void MainWindow::recompute() {
  if (document_.scene() && engine_.inspect) runner_.inspect(document_.sharedScene(), document_.request(), document_.inspection());
}

void MainWindow::showProblem(const QString& oneLine) {
  lastError_ = oneLine;
  MessageBar::Answers answers;
  if (const auto [session, scene] = std::exchange(missing_, {}); !session.isEmpty())
    answers.append({tr("Locate…"), [this, session = session, scene = scene] { files_->askForScene(session, scene); }});
  messageBar_->showError(oneLine, answers);
  log(oneLine);
  emit problem(oneLine);
}

void MainWindow::log(const QString& line) {
  log_->appendPlainText(QTime::currentTime().toString(QStringLiteral("HH:mm:ss  ")) + line);
}

void MainWindow::showTitle() {
  if (!document_.scene()) return setWindowTitle(tr("Glint inspector"));
  setWindowTitle(QStringLiteral("%1[*] – %2").arg(QFileInfo(document_.inputFile()).fileName(), tr("Glint inspector")));
  setWindowModified(document_.hasUnsavedChanges());
}

void MainWindow::closeEvent(QCloseEvent* e) {
  if (!files_->mayDiscard()) return e->ignore();
  runner_.cancel();
  e->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* e) {
  if (!FileActions::dropped(e->mimeData()).isEmpty()) e->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* e) { files_->open(FileActions::dropped(e->mimeData())); }

}  // namespace glint::gui
