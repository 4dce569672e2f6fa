// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/explain_panel.h"

#include <QAction>
#include <QEvent>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QSplitter>
#include <QToolButton>
#include <QUrl>
#include <QVBoxLayout>
#include <QVariant>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gui/base/eliding_delegate.h"
#include "gui/base/flow_layout.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/explain/duality_window.h"
#include "gui/explain/equation_browser.h"
#include "gui/explain/explain_page.h"
#include "gui/explain/explain_texts.h"
#include "gui/explain/lessons.h"
#include "gui/explain/walk_player.h"
#include "gui/explain/walk_view.h"

namespace glint::gui {

namespace {
const char* const kStep = "explain/step";      // option: id of the step that is shown; "" = none
const char* const kSolo = "scene/solo";        // option: the 3D views show what belongs to the selected frame alone
const char* const kLines = "frame/epipolar";   // option: tangent epipolar lines of two frames side by side
const char* const kLesson = "explain/lesson";  // option: id of the lesson that this session is; "" = none
constexpr int kWalkHeight = 290;               // px, where there is room
constexpr int kTextLines = 14;                 // of the text and the buttons, that the list of the steps leaves room for

const Lesson* lessonOf(const Document& document) { return lessonById(toQString(document.option(kLesson, std::string()))); }

bool showsWalk(const ExplainText& text) { return text.layers.contains(QStringLiteral("walk")); }

/// @param value  "" = as nobody has set it.
void set(std::map<std::string, std::string>& options, const char* option, const std::string& value) {
  if (value.empty())
    options.erase(option);
  else
    options[option] = value;
}
}  // namespace

ExplainPanel::ExplainPanel(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      walk_(new WalkPlayer(document, this)),
      walkView_(new WalkView(document, *walk_)),
      steps_(new QListWidget),
      text_(new EquationBrowser),
      place_(new QLabel),
      back_(new QToolButton),
      next_(new QToolButton),
      leave_(new QToolButton) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(8, 6, 8, 6);
  column->setSpacing(6);
  auto* bar = new FlowLayout(4);  // in a narrow panel, or in large print, the last of it goes to a second line
  for (auto* button : {back_, next_}) {
    button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    button->setIconSize({14, 14});
  }
  back_->setObjectName(QStringLiteral("explain.back"));
  back_->setIcon(icon(QStringLiteral("previous")));
  back_->setText(tr("Back"));
  next_->setObjectName(QStringLiteral("explain.next"));
  next_->setIcon(icon(QStringLiteral("next")));
  leave_->setObjectName(QStringLiteral("explain.leave"));
  leave_->setText(tr("Leave"));
  leave_->setToolTip(tr("Restores layers, layout and view as they were"));
  back_->setToolTip(tr("Previous step"));
  text_->setAccessibleName(tr("What this step shows"));
  steps_->setAccessibleName(tr("Steps"));
  place_->setObjectName(QStringLiteral("explain.place"));
  place_->setAlignment(Qt::AlignCenter);
  bar->addWidget(back_);
  bar->addWidget(next_);
  bar->addWidget(place_);
  bar->addWidget(leave_);
  column->addLayout(bar);
  split_ = new QSplitter(Qt::Vertical);
  steps_->setObjectName(QStringLiteral("explain.steps"));
  steps_->setItemDelegate(new ElidingDelegate(steps_));
  text_->setObjectName(QStringLiteral("explain.text"));
  text_->setOpenLinks(false);
  walkView_->hide();
  split_->addWidget(steps_);
  split_->addWidget(walkView_);
  split_->addWidget(text_);
  split_->setStretchFactor(0, 0);
  split_->setStretchFactor(1, 0);
  split_->setStretchFactor(2, 1);
  split_->setChildrenCollapsible(false);
  column->addWidget(split_, 1);
  setMinimumWidth(220);
  auto* const badge = new StaleBadge(text_);  // over its numbers, which the introduction has none of
  const auto markStale = [this, badge] { badge->setStale(document_.stale() && step() >= 0); };
  connect(&document_, &Document::staleChanged, badge, markStale);
  connect(&document_, &Document::optionsChanged, badge, markStale);

  connect(back_, &QToolButton::clicked, this, &ExplainPanel::back);
  connect(next_, &QToolButton::clicked, this, &ExplainPanel::next);
  connect(leave_, &QToolButton::clicked, this, &ExplainPanel::leave);
  connect(text_, &QTextBrowser::anchorClicked, this, &ExplainPanel::follow);
  // Not currentRowChanged: a list that gets the focus makes its first row the current one, without selecting it.
  connect(steps_, &QListWidget::itemSelectionChanged, this, [this] {
    const QList<QListWidgetItem*> chosen = steps_->selectedItems();
    if (const int row = chosen.isEmpty() ? -1 : steps_->row(chosen.front());
        row >= 0 && row < track_.size() && track_[row] != step())
      goTo(track_[row]);
  });
  connect(&document_, &Document::sceneOpened, this, [this] {
    lookedAt_.clear();
    layersBefore_ = document_.state().layers;  // a session that was left in a step has nothing to go back to but its own
    soloBefore_.clear();
    lessonRequest_ = document_.request();
    linesBefore_.clear();
    unfolded_.clear();
  });
  connect(walk_, &WalkPlayer::changed, this, [this] {
    if (walk_->playing()) return;  // it has not changed whether there is one
    showWalk();
    showText();
  });
  connect(&document_, &Document::optionsChanged, this, &ExplainPanel::refresh);
  for (const auto signal : {&Document::inspectionChanged, &Document::selectionChanged, &Document::sceneOpened})
    connect(&document_, signal, this, &ExplainPanel::compute);
  refresh();
}

void ExplainPanel::changeEvent(QEvent* e) {
  QWidget::changeEvent(e);
  if (e->type() == QEvent::PaletteChange) showText();  // the text has colours of the theme
}

int ExplainPanel::step() const {
  const QString id = toQString(document_.option(kStep, std::string()));
  const QList<ExplainText>& steps = explainTexts().steps;
  for (int i = 0; i < steps.size(); ++i)
    if (steps[i].id == id) return i;
  return -1;
}

bool ExplainPanel::busy() const { return job_.busy() || walk_->busy(); }

void ExplainPanel::start() {
  emit started();  // first: a view is fitted to what a step is about in the room that it will have
  if (step() < 0) goTo(track_.front());
}

/// Beside the lesson's own steps: the nearest of them in the order of all steps.
int ExplainPanel::neighbour(int by) const {
  const int now = step(), at = track_.indexOf(now);
  if (at >= 0) return track_.value(at + by, -1);
  int found = -1;
  for (const int i : track_)
    if (by > 0 ? i > now && found < 0 : i < now) found = i;
  return found;
}

void ExplainPanel::next() {
  if (step() < 0) return start();
  if (const int wanted = neighbour(1); wanted >= 0) return goTo(wanted);
  const Lesson* const lesson = lessonOf(document_);
  if (const Lesson* const after = lesson ? lessonAfter(*lesson) : nullptr) openLesson(after->id);
}

void ExplainPanel::back() { goTo(neighbour(-1)); }

void ExplainPanel::openLesson(const QString& id) {
  const QString file = lessonFile(id);
  if (file.isEmpty()) return emit problem(tr("Cannot find the session of lesson %1 beside the program").arg(id));
  emit lessonRequested(file);
}

void ExplainPanel::openDuality() {
  if (!duality_) {
    duality_ = new DualityWindow(document_, window());
    // The keys of the main window go on working beside it: the palette, the frames, undo. It has only arrows and Esc itself.
    for (QAction* action : actions_->all())
      if (!action->shortcuts().contains(QKeySequence(Qt::Key_Escape))) duality_->addAction(action);
  }
  emit dualityOpened(duality_);
  duality_->open();
}

void ExplainPanel::follow(const QUrl& link) {
  const QString scheme = link.scheme(), path = link.path();
  if (scheme == QLatin1String("unfold")) {
    if (const int question = path.toInt(); !unfolded_.remove(question)) unfolded_.insert(question);
    return showText();
  }
  if (scheme == QLatin1String("glossary") || scheme == QLatin1String("method")) return emit readRequested(scheme, path);
  if (scheme == QLatin1String("symbol")) return emit readRequested(QStringLiteral("notation"), {});
  if (!actions_ || scheme != QLatin1String("action")) return;
  if (const QString panel = QStringLiteral("view.panel-"); path.startsWith(panel))
    return emit panelRequested(path.mid(panel.size()));
  QAction* action = actions_->find(path);
  // A link leads to what it names: where that is shown already, it stays.
  if (action && !(action->isCheckable() && action->isChecked() && !action->actionGroup())) action->trigger();
}

void ExplainPanel::goTo(int wanted) {
  const QList<ExplainText>& steps = explainTexts().steps;
  if (!document_.scene() || wanted < 0 || wanted >= steps.size()) return;
  const ExplainText& text = steps[wanted];
  if (step() < 0) {
    layersBefore_ = document_.state().layers;
    soloBefore_ = document_.option(kSolo, std::string());
    linesBefore_ = document_.option(kLines, std::string());
  }
  const ExplainText::Shown shown = text.shown(toQString(document_.selection().model));
  std::map<std::string, bool> layers = document_.state().layers;
  for (const viz::Layer& layer : viz::sceneLayers()) layers[layer.name] = shown.layers.contains(toQString(layer.name));
  // Overlays that no step names (what the user laid over the frame) stay as they are.
  for (const ExplainText& any : steps)
    for (const QString& name : any.frameLayers) layers[name.toStdString()] = shown.frameLayers.contains(name);
  std::map<std::string, std::string> options = document_.state().options;
  options[kStep] = text.id.toStdString();
  set(options, kSolo, text.solo ? "1" : soloBefore_);
  set(options, kLines, text.epipolar ? linesBefore_ : "off");
  lookPending_ = true;
  document_.setView(layers, options, tr("Explain %1: %2").arg(wanted + 1).arg(text.title));
  lookAtStep();
}

/// What the step on screen is about, as far as a view has to go elsewhere when it changes.
QString ExplainPanel::subject() const {
  const QString& at = explainTexts().steps[step()].look;
  QString subject = explainTexts().steps[step()].id;
  if (at == QLatin1String("ellipsoid"))
    subject += QStringLiteral("/%1/%2").arg(toQString(explanation_->model), toQString(explanation_->light));
  else if (at != QLatin1String("scene"))
    subject += QStringLiteral("/%1/%2").arg(explanation_->frame).arg(explanation_->highlight);
  return subject;
}

void ExplainPanel::lookAtStep() {
  if (step() < 0 || !explanation_) return;
  // A session is looked at from where it was left; afterwards the view follows what is selected.
  const QString now = subject();
  const bool left = lookedAt_.isEmpty() && !lookPending_;
  if (now == std::exchange(lookedAt_, now) && !lookPending_) return;
  lookPending_ = false;
  if (!left) emit look(explainTexts().steps[step()].look, explanation_->highlight, toQString(explanation_->model));
}

void ExplainPanel::leave() {
  if (step() < 0) return;
  std::map<std::string, std::string> options = document_.state().options;
  options.erase(kStep);
  set(options, kSolo, soloBefore_);
  set(options, kLines, linesBefore_);
  lookPending_ = false;
  lookedAt_.clear();
  document_.setView(layersBefore_, options, tr("Leave explanation"));
}

void ExplainPanel::compute() {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection || step() < 0) {
    job_.drop();
    explanation_.reset();
    return refresh();
  }
  // Depth maps are read for it: not here.
  job_.run([this, inspection, selection = document_.selection(), model = document_.selection().model] {
    const int frame = std::clamp(selection.frame, 0, int(inspection->scene->frames.size()) - 1);
    auto found = std::make_shared<const Explanation>(explain(*inspection, frame, selection.highlight, model));
    return LatestJob::Deliver([this, found] {
      explanation_ = found;
      refresh();
      lookAtStep();
    });
  });
}

/// Which steps there are to go through: the lesson's, else all.
void ExplainPanel::layTrack() {
  const Lesson* const lesson = lessonOf(document_);
  const QList<ExplainText>& steps = explainTexts().steps;
  QList<int> track;
  QStringList rows;
  for (int i = 0; i < steps.size(); ++i) {
    if (lesson && !lesson->steps.contains(steps[i].id)) continue;
    track << i;
    rows
        << QStringLiteral("%1  %2").arg(track.size()).arg(lesson ? lesson->titleOf(steps[i].id, steps[i].title) : steps[i].title);
  }
  if (rows == std::exchange(rows_, rows)) return;
  track_ = track;
  steps_->clear();
  steps_->addItems(rows);
  fitted_ = {};
}

void ExplainPanel::refresh() {
  const int now = step();
  if (std::exchange(explaining_, now >= 0) && now < 0) emit left();
  const QSignalBlocker quiet(steps_);
  layTrack();
  const int at = track_.indexOf(now), count = track_.size();
  steps_->setCurrentRow(at);
  if (at >= 0) steps_->scrollToItem(steps_->item(at));
  const Lesson* const lesson = lessonOf(document_);
  const Lesson* const nextLesson = lesson ? lessonAfter(*lesson) : nullptr;
  const bool ends = now >= 0 && neighbour(1) < 0;
  back_->setEnabled(now >= 0 && neighbour(-1) >= 0);
  next_->setEnabled(document_.scene() && (!ends || nextLesson));
  next_->setText(now < 0 ? tr("Start") : ends && nextLesson ? tr("Next lesson") : tr("Next"));
  next_->setToolTip(ends && nextLesson ? numberedTitle(*nextLesson) : tr("Next step"));
  leave_->setEnabled(now >= 0);
  place_->setText(now < 0 ? QString() : at >= 0 ? tr("%1 of %2").arg(at + 1).arg(count) : tr("beside the lesson"));
  showWalk();
  if (now >= 0 && !explanation_ && document_.inspection() && !job_.awaited()) return compute();
  showText();
}

void ExplainPanel::showText() {
  const Lesson* const lesson = lessonOf(document_);
  const QString ends = walk_->story() ? toQString(viz::walkEnds(*walk_->story())) : QString();
  const ExplainPage page{document_,        lesson, step(),    explanation_.get(), document_.request() == lessonRequest_,
                         walk_->problem(), ends,   unfolded_, palette()};
  const QString now = page.html();
  if (now == std::exchange(shown_, now)) return;  // else it would scroll back
  const QString place = QStringLiteral("%1/%2").arg(lesson ? lesson->id : QString()).arg(step());
  const int at = place == std::exchange(shownPlace_, place) ? text_->verticalScrollBar()->value() : 0;
  text_->showPage(now);
  text_->verticalScrollBar()->setValue(at);
}

/// Without a walk the text says why, and takes its room.
void ExplainPanel::showWalk() {
  walkView_->setVisible(step() >= 0 && showsWalk(explainTexts().steps[step()]) && walk_->problem().isEmpty());
  fitSteps();
}

/// In a low panel the list of the steps and the walk give way to what the step says.
void ExplainPanel::fitSteps() {
  const int row = std::max(1, steps_->sizeHintForRow(0)), frame = 2 * steps_->frameWidth();
  const int walk = walkView_->isVisibleTo(this) ? walkView_->minimumSizeHint().height() : 0;
  const int room = height() - kTextLines * fontMetrics().lineSpacing();
  const int rows = std::clamp((room - walk) / row, 3, std::max(3, steps_->count()));
  const int list = rows * row + frame;
  const std::array<int, 3> now{height(), list, walk};
  if (now == std::exchange(fitted_, now)) return;  // else it would undo what the user has drawn larger
  const int wanted = walk > 0 ? std::max(walk, std::min(kWalkHeight, room - list)) : kWalkHeight;
  split_->setSizes({list, wanted, std::max(1, height() - list - (walk > 0 ? wanted : 0))});
  if (const int at = track_.indexOf(step()); at >= 0) steps_->scrollToItem(steps_->item(at), QAbstractItemView::PositionAtCenter);
}

void ExplainPanel::resizeEvent(QResizeEvent* e) {
  QWidget::resizeEvent(e);
  fitSteps();
}

void ExplainPanel::addActions(Actions& actions, QMenu* menu) {
  actions_ = &actions;
  actions.add("explain.start", menu, tr("&Explain this scene"), [this] { start(); }, {{Qt::Key_F1}});
  actions.add("explain.next", menu, tr("&Next step"), [this] { next(); }, {{QKeySequence("Ctrl+Right")}});
  actions.add("explain.back", menu, tr("Step &back"), [this] { back(); }, {{QKeySequence("Ctrl+Left")}});
  actions.add("explain.leave", menu, tr("&Leave explanation"), [this] { leave(); });
  menu->addSeparator();
  actions.add("explain.play-walk", menu, tr("&Play or pause walk"), [this] { walk_->toggle(); },
              {{Qt::Key_W}, "play", tr("Limit-angle walk of the selected direction, on S and T")});
  actions.add("explain.walk-on", menu, tr("Walk one step &forward"), [this] { walk_->setStep(walk_->step() + 1); },
              {{Qt::Key_Period}});
  actions.add("explain.walk-back", menu, tr("Walk one step bac&k"), [this] { walk_->setStep(walk_->step() - 1); },
              {{Qt::Key_Comma}});
  menu->addSeparator();
  actions.add("explain.duality", menu, tr("Primal and &dual side by side"), [this] { openDuality(); },
              {{}, {}, tr("The planes that touch the cones of the selected model, and their dual points")});
  QMenu* taught = menu->addMenu(tr("Less&ons"));
  for (const Lesson& lesson : lessons())
    actions.add("lesson." + lesson.id, taught, numberedTitle(lesson), [this, id = lesson.id] { openLesson(id); });
  QMenu* all = menu->addMenu(tr("&Steps"));
  for (int i = 0; i < explainTexts().steps.size(); ++i)
    actions.add("explain.step-" + explainTexts().steps[i].id, all, explainTexts().steps[i].title, [this, i] {
      emit started();
      goTo(i);
    });
}

}  // namespace glint::gui
