// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/explain_panel.h"

#include <QAction>
#include <QEvent>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QSignalBlocker>
#include <QSplitter>
#include <QTextBrowser>
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
#include "gui/base/text.h"
#include "gui/base/theme.h"
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

QString escaped(const std::string& s) { return toQString(s).toHtmlEscaped(); }

QString numbersTable(const std::vector<ExplainNumber>& numbers) {
  if (numbers.empty()) return {};
  QString html = QStringLiteral("<table cellspacing=0 cellpadding=2>");
  for (const ExplainNumber& n : numbers)
    html += QStringLiteral("<tr><td><i>%1</i>&nbsp;&nbsp;</td><td>%2&nbsp;&nbsp;</td><td><b>%3</b></td></tr>")
                .arg(escaped(n.symbol), escaped(n.name), valuesHtml(n));
  return html + QStringLiteral("</table>");
}

/// @param value  "" = as nobody has set it.
void set(std::map<std::string, std::string>& options, const char* option, const std::string& value) {
  if (value.empty())
    options.erase(option);
  else
    options[option] = value;
}

QString box(const QColor& colour, const QString& content) {
  return QStringLiteral(
             "<table width='100%' cellspacing=0 cellpadding=0 style='margin-top:8px'><tr><td width=4 bgcolor='%1'></td>"
             "<td style='padding-left:8px'>%2</td></tr></table>")
      .arg(colour.name(), content);
}
}  // namespace

ExplainPanel::ExplainPanel(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      walk_(new WalkPlayer(document, this)),
      walkView_(new WalkView(document, *walk_)),
      steps_(new QListWidget),
      text_(new QTextBrowser),
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
  leave_->setToolTip(tr("Restores the previous layers"));
  place_->setAlignment(Qt::AlignCenter);
  bar->addWidget(back_);
  bar->addWidget(next_);
  bar->addWidget(place_);
  bar->addWidget(leave_);
  column->addLayout(bar);
  split_ = new QSplitter(Qt::Vertical);
  steps_->setObjectName(QStringLiteral("explain.steps"));
  for (const ExplainText& t : explainTexts().steps)
    steps_->addItem(QStringLiteral("%1  %2").arg(steps_->count() + 1).arg(t.title));
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

  connect(back_, &QToolButton::clicked, this, &ExplainPanel::back);
  connect(next_, &QToolButton::clicked, this, &ExplainPanel::next);
  connect(leave_, &QToolButton::clicked, this, &ExplainPanel::leave);
  connect(text_, &QTextBrowser::anchorClicked, this, &ExplainPanel::follow);
  // Not currentRowChanged: a list that gets the focus makes its first row the current one, without selecting it.
  connect(steps_, &QListWidget::itemSelectionChanged, this, [this] {
    const QList<QListWidgetItem*> chosen = steps_->selectedItems();
    if (!chosen.isEmpty() && steps_->row(chosen.front()) != step()) goTo(steps_->row(chosen.front()));
  });
  connect(&document_, &Document::sceneOpened, this, [this] {
    lookedAt_.clear();
    soloBefore_.clear();
    lessonRequest_ = document_.request();
    linesBefore_.clear();
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
  if (step() < 0) {
    const Lesson* lesson = lessonOf(document_);
    int first = 0;
    for (int i = explainTexts().steps.size() - 1; lesson && i >= 0; --i)
      if (lesson->steps.contains(explainTexts().steps[i].id)) first = i;
    goTo(first);
  }
}

void ExplainPanel::next() { step() < 0 ? start() : goTo(step() + 1); }
void ExplainPanel::back() { goTo(step() - 1); }

void ExplainPanel::openLesson(const QString& id) {
  const QString file = lessonFile(id);
  if (file.isEmpty()) return emit problem(tr("Cannot find the session of lesson %1 beside the program").arg(id));
  emit lessonRequested(file);
}

void ExplainPanel::follow(const QUrl& link) {
  if (!actions_ || link.scheme() != QLatin1String("action")) return;
  if (QAction* action = actions_->find(link.path())) action->trigger();
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
  std::map<std::string, bool> layers = document_.state().layers;
  for (const viz::Layer& layer : viz::sceneLayers()) layers[layer.name] = text.layers.contains(toQString(layer.name));
  // Overlays that no step names (what the user laid over the frame) stay as they are.
  for (const ExplainText& any : steps)
    for (const QString& name : any.frameLayers) layers[name.toStdString()] = text.frameLayers.contains(name);
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
  emit look(QStringLiteral("scene"), -1, QString());
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

void ExplainPanel::refresh() {
  const int now = step(), count = explainTexts().steps.size();
  if (std::exchange(explaining_, now >= 0) && now < 0) emit left();
  const QSignalBlocker quiet(steps_);
  steps_->setCurrentRow(now);
  if (now >= 0) steps_->scrollToItem(steps_->item(now));
  back_->setEnabled(now > 0);
  next_->setEnabled(document_.scene() && now < count - 1);
  next_->setText(now < 0 ? tr("Start") : tr("Next"));
  leave_->setEnabled(now >= 0);
  const Lesson* lesson = lessonOf(document_);
  place_->setText(now < 0 ? QString() : tr("%1 of %2").arg(now + 1).arg(count));
  for (int i = 0; i < count; ++i) {
    QFont font = steps_->font();  // those that the lesson is about
    font.setBold(lesson && lesson->steps.contains(explainTexts().steps[i].id));
    steps_->item(i)->setFont(font);
  }
  showWalk();
  if (now >= 0 && !explanation_ && document_.inspection() && !job_.awaited()) return compute();
  showText();
}

void ExplainPanel::showText() {
  if (const QString now = html(); now != std::exchange(shown_, now)) text_->setHtml(now);  // else it would scroll back
}

/// Where there is none the text says why, and has the room.
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
  if (step() >= 0) steps_->scrollToItem(steps_->item(step()), QAbstractItemView::PositionAtCenter);
}

void ExplainPanel::resizeEvent(QResizeEvent* e) {
  QWidget::resizeEvent(e);
  fitSteps();
}

QString ExplainPanel::overview() const {
  const Lesson* lesson = lessonOf(document_);
  if (!lesson) {
    QString html = tr(
        "<p>Eleven steps from the photograph to the predicted highlight of the open scene, each with its picture, equation and "
        "numbers, and the assumptions that break here.</p><h4>Lessons</h4>");
    for (const Lesson& l : lessons())
      html += QStringLiteral("<p><a href='action:lesson.%1'>%2</a></p>").arg(l.id, l.title.toHtmlEscaped());
    return html;
  }
  QString html = QStringLiteral("<h3>%1</h3><p>%2</p><h4>%3</h4>")
                     .arg(tr("Lesson %1: %2").arg(lessons().indexOf(*lesson) + 1).arg(lesson->title.toHtmlEscaped()), lesson->see,
                          tr("Steps"));
  for (int i = 0; i < explainTexts().steps.size(); ++i) {  // numbered as in the list of all steps
    const ExplainText& t = explainTexts().steps[i];
    if (lesson->steps.contains(t.id))
      html += QStringLiteral("<p style='margin:3px 0 3px 12px'>%1. <a href='action:explain.step-%2'>%3</a></p>")
                  .arg(i + 1)
                  .arg(t.id, t.title.toHtmlEscaped());
  }
  html += QStringLiteral("<h4>%1</h4><ul>").arg(tr("Try"));
  for (const QString& question : lesson->questions) html += QStringLiteral("<li>%1</li>").arg(question);
  return html + QStringLiteral("</ul>");
}

QString ExplainPanel::html() const {
  const int now = step();
  if (now < 0) return overview();
  const ExplainText& text = explainTexts().steps[now];
  const ExplainText::Words words = text.words(explanation_ ? toQString(explanation_->model) : QString());
  QString html =
      QStringLiteral("<h3>%1</h3><p>%2</p><p style='margin-left:8px'><tt>%3</tt><br><span style='color:%4'>%5</span></p>")
          .arg(text.title.toHtmlEscaped(), words.text.toHtmlEscaped(), words.equation.toHtmlEscaped(),
               palette().color(QPalette::PlaceholderText).name(), text.section.toHtmlEscaped());
  if (const Lesson* lesson = lessonOf(document_); lesson && lesson->remarks.contains(text.id))
    html += box(accentColour(),
                (document_.request() == lessonRequest_ ? tr("<b>In this lesson.</b> %1")
                                                       : tr("<b>In this lesson as opened</b> (changed since then). %1"))
                    .arg(lesson->remarks.value(text.id)));
  if (!explanation_ || now >= int(explanation_->steps.size())) return html;
  const ExplainStep& s = explanation_->steps[std::size_t(now)];
  const Scene& scene = *document_.scene();
  const auto inspection = document_.inspection();
  const std::size_t frame = std::size_t(explanation_->frame);
  const std::size_t highlights =
      inspection && frame < inspection->evidence.size() ? inspection->evidence[frame].highlights.size() : 0;
  const QString ofSeveral = highlights > 1 && explanation_->highlight >= 0
                                ? tr(", highlight %1 of %2").arg(explanation_->highlight + 1).arg(highlights)
                                : QString();
  html += QStringLiteral("<p style='color:%1'>%2</p>")
              .arg(palette().color(QPalette::PlaceholderText).name(),
                   tr("Frame %1%2%3%4")
                       .arg(escaped(scene.frames[std::size_t(explanation_->frame)].id), ofSeveral,
                            explanation_->light.empty() ? QString() : tr(", light %1").arg(escaped(explanation_->light)),
                            explanation_->model.empty() ? QString() : tr(", model %1").arg(escaped(explanation_->model))));
  // Whether "any camera" is a new one here.
  if (text.id == QLatin1String("projection") && !s.failure && inspection)
    html += QStringLiteral("<p>%1</p>")
                .arg(inspection->isTraining(explanation_->frame)
                         ? tr("This camera is not new to the model: it was trained on this frame.")
                         : tr("This camera is new to the model: it was not trained on this frame."));
  // A frame that has not trained still has its own contour: what comes from that, and what from the others?
  const bool ofObserved = text.id == QLatin1String("limit-angles") || text.id == QLatin1String("canonical-ellipse");
  if (const auto inspection = document_.inspection();
      ofObserved && !s.failure && inspection && !inspection->isTraining(explanation_->frame))
    html += box(palette().color(QPalette::Highlight),
                tr("<b>Observed here:</b> the contour on which this walk is based. <b>From other frames:</b> the light; "
                   "no model was trained on this frame. <b>Predicted:</b> %1.")
                    .arg(inspection->models.count(canonicalModel().id()) ? tr("only the dotted ellipse in the frame view")
                                                                         : tr("nothing")));
  // What is wrong comes first: a low window shows no more than that.
  if (s.failure) html += box(errorColour(), tr("This scene does not reach this step: %1").arg(escaped(s.failure->message())));
  for (const BrokenAssumption& b : s.broken)
    html += box(warningColour(), explainTexts().broken.value(toQString(b.id)).toHtmlEscaped() + numbersTable(b.numbers));
  if (!s.failure && s.broken.empty() && !walk_->problem().isEmpty() && showsWalk(text))
    html += box(warningColour(), tr("No walk to show: %1").arg(walk_->problem().toHtmlEscaped()));
  return html + (s.broken.empty() && !s.failure ? QString() : QStringLiteral("<br>")) + numbersTable(s.numbers);
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
  QMenu* taught = menu->addMenu(tr("Less&ons"));
  for (const Lesson& lesson : lessons())
    actions.add("lesson." + lesson.id, taught, tr("Lesson %1: %2").arg(taught->actions().size() + 1).arg(lesson.title),
                [this, id = lesson.id] { openLesson(id); });
  QMenu* all = menu->addMenu(tr("&Steps"));
  for (int i = 0; i < explainTexts().steps.size(); ++i)
    actions.add("explain.step-" + explainTexts().steps[i].id, all, explainTexts().steps[i].title, [this, i] {
      emit started();
      goTo(i);
    });
}

}  // namespace glint::gui
