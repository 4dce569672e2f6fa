// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/diagnosis_panel.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QProgressBar>
#include <QPushButton>
#include <QTimer>
#include <QTreeWidget>
#include <QUndoStack>
#include <QVBoxLayout>
#include <algorithm>
#include <set>

#include "core/advise/highlight_evidence.h"
#include "core/choice/selection.h"
#include "core/pipeline/summary.h"
#include "gui/base/eliding_delegate.h"
#include "gui/base/text.h"
#include "viz/solver_runs.h"

namespace glint::gui {
namespace {

constexpr int kFrame = Qt::UserRole, kLight = Qt::UserRole + 1, kModel = Qt::UserRole + 2, kHighlight = Qt::UserRole + 3,
              kShared = Qt::UserRole + 4, kPredicted = Qt::UserRole + 5, kPlace = Qt::UserRole + 6, kGood = Qt::UserRole + 7;
constexpr std::size_t kMostFrames = 12;      // of a model: more are in the table of errors
constexpr std::size_t kMostHighlights = 12;  // that contradict a model

/// A frame where a model misses or invents highlights, or is far off.
struct WrongFrame {
  int frame = -1;
  std::string light;
  int missed = 0, spurious = 0;
  double pct = 0;  ///< largest error of a matched highlight
  std::string reason;
  /// What is missed or spurious, and why.
  struct Part {
    int observed = -1, predicted = -1;
    QString cause;
  };
  std::vector<Part> parts;
};

std::vector<WrongFrame> wrongFrames(const Inspection& inspection, const ModelResult& result) {
  std::vector<WrongFrame> wrong;
  for (const FrameComparison& c : result.frames) {
    if (!inspection.isTraining(c.frame) && !inspection.isHeldOut(c.frame)) continue;
    WrongFrame w;
    w.frame = c.frame;
    w.light = c.light;
    for (const FrameComparison::Row& row : c.rows) {
      w.missed += row.observed >= 0 && row.predicted < 0;
      w.spurious += row.observed < 0 && row.predicted >= 0;
      if (row.metrics) w.pct = std::max(w.pct, row.metrics->contourErrorPct);
    }
    if (const Failure* const failure = c.prediction.failure()) w.reason = failure->message();
    // A depth map would have to be read here, on the interface's thread.
    const bool quick = inspection.scene->frames[std::size_t(c.frame)].depth.empty() && !c.prediction.failure();
    for (const FrameComparison::Row& row : c.rows)
      if (!row.metrics && (row.observed >= 0 || row.predicted >= 0))
        w.parts.push_back({row.observed, row.observed < 0 ? row.predicted : -1,
                           quick ? toQString(whyUnmatched(inspection, c, row)) : QString()});
    if (w.missed > 0 || w.spurious > 0 || w.pct > kLargestExpectedPct) wrong.push_back(std::move(w));
  }
  std::stable_sort(wrong.begin(), wrong.end(), [](const WrongFrame& a, const WrongFrame& b) {
    return std::tuple(-a.missed, -a.pct, -a.spurious) < std::tuple(-b.missed, -b.pct, -b.spurious);
  });
  return wrong;
}

/// Places of lines below their model, top to bottom: why it is so, what goes together, and the evidence one by one.
enum class ProblemLine { Cause, Shared, Against, Course, Wrong };

/// Adds an item below those of its own place and of earlier ones, whenever it is found.
void append(QTreeWidgetItem* parent, QTreeWidgetItem* item, ProblemLine place) {
  item->setData(0, kPlace, int(place));
  int at = parent->childCount();
  while (at > 0 && parent->child(at - 1)->data(0, kPlace).toInt() > int(place)) --at;
  parent->insertChild(at, item);
}

bool hasLine(const QTreeWidgetItem* parent, const QString& text) {
  for (int i = 0; i < parent->childCount(); ++i)
    if (parent->child(i)->text(0) == text) return true;
  return false;
}

QTreeWidgetItem* addLine(QTreeWidgetItem* parent, const QString& text, ProblemLine place) {
  auto* item = new QTreeWidgetItem({text});
  item->setToolTip(0, text);
  append(parent, item, place);
  return item;
}

/// @param open  whether the list shows its lines: not where causes and remedies are known.
void addWrongFrames(QTreeWidgetItem* top, const Inspection& inspection, const std::vector<WrongFrame>& wrong, bool open) {
  auto* list =
      addLine(top,
              wrong.size() == 1 ? QObject::tr("what is wrong")
                                : QObject::tr("what is wrong in each frame and light, worst first (%1)").arg(wrong.size()),
              ProblemLine::Wrong);
  for (std::size_t i = 0; i < wrong.size() && i < kMostFrames; ++i) {
    const WrongFrame& w = wrong[i];
    QStringList words;
    if (w.missed) words << QObject::tr(w.missed == 1 ? "%1 highlight missed" : "%1 highlights missed").arg(w.missed);
    if (w.spurious) words << QObject::tr("%1 predicted where none is seen").arg(w.spurious);
    if (!w.reason.empty()) words << toQString(w.reason);
    if (w.parts.size() == 1 && !w.parts.front().cause.isEmpty()) words << w.parts.front().cause;
    if (w.pct > kLargestExpectedPct) words.prepend(QObject::tr("off by %1 %").arg(numberText(w.pct, 3)));
    auto* line = addLine(list,
                         QObject::tr("frame %1, %2: %3")
                             .arg(nameText(inspection.scene->frames[std::size_t(w.frame)].id), lightText(w.light),
                                  words.join(QStringLiteral("; "))),
                         ProblemLine::Wrong);
    const auto select = [&w](QTreeWidgetItem* item, int highlight, int predicted) {
      item->setData(0, kFrame, w.frame);
      item->setData(0, kLight, toQString(w.light));
      item->setData(0, kHighlight, highlight);
      item->setData(0, kPredicted, predicted);
    };
    const bool one = w.parts.size() == 1;
    select(line, one ? w.parts.front().observed : -1, one ? w.parts.front().predicted : -1);
    for (std::size_t k = 0; !one && k < w.parts.size(); ++k) {
      const WrongFrame::Part& part = w.parts[k];
      const QString what = part.observed >= 0 ? QObject::tr("□ highlight %1 missed").arg(part.observed + 1)
                                              : QObject::tr("△ predicted highlight %1 spurious").arg(part.predicted + 1);
      select(addLine(line, part.cause.isEmpty() ? what : QObject::tr("%1: %2").arg(what, part.cause), ProblemLine::Wrong),
             part.observed, part.predicted);
    }
  }
  if (wrong.size() > kMostFrames)
    addLine(list, QObject::tr("and %1 more: see Errors").arg(wrong.size() - kMostFrames), ProblemLine::Wrong);
  list->setExpanded(open);
}

bool hasProblem(const Inspection& inspection, const ModelResult& result) {
  return !summarise(inspection, result).answered || !wrongFrames(inspection, result).empty();
}

/// "limit-angle: no problem found in 24 held-out frames, median error 0.8 %"
QString goodWords(const Inspection& inspection, const ModelResult& result) {
  const HeldOutFrames frames = heldOutFrames(inspection);
  const int n = frames.all - frames.unreadable;
  const QString which = inspection.train.perSurface ? QObject::tr(n == 1 ? "%1 frame" : "%1 frames")
                                                    : QObject::tr(n == 1 ? "%1 held-out frame" : "%1 held-out frames");
  return QObject::tr("%1: no problem found in %2, median error %3 %")
      .arg(toQString(result.model), which.arg(n), numberText(summarise(inspection, result).contourErrorPct.median, 2));
}

}  // namespace

DiagnosisPanel::DiagnosisPanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 4, 6, 2);
  column->setSpacing(4);
  auto* row = new QHBoxLayout;
  ask_ = new QPushButton(tr("Find out why"));
  ask_->setObjectName(QStringLiteral("diagnose"));
  ask_->setToolTip(
      tr("Says which model and which settings predict best, and why the others fail. Compares the models first, then measures\n"
         "settings, training frames, exclusions and filters; what is found appears at once. A second click stops"));
  state_ = new QLabel;
  state_->setObjectName(QStringLiteral("diagnoseState"));
  state_->setProperty("role", "faded");
  state_->setWordWrap(true);
  bar_ = new QProgressBar;
  bar_->setObjectName(QStringLiteral("diagnoseProgress"));
  bar_->setMaximumWidth(120);
  bar_->setFormat(QStringLiteral("%v / %m"));
  row->addWidget(ask_);
  row->addWidget(bar_);
  row->addWidget(state_, 1);
  column->addLayout(row);
  list_ = new QTreeWidget;
  list_->setObjectName(QStringLiteral("problems"));
  list_->setAccessibleName(tr("Problems and remedies"));
  list_->setHeaderHidden(true);
  list_->setWordWrap(true);
  list_->setUniformRowHeights(false);
  list_->setVerticalScrollMode(QAbstractItemView::ScrollPerPixel);  // lines are tall: one may be half in sight
  list_->setItemDelegate(new WrappingDelegate(list_));
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  list_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
  // Lines wrap at another place then.
  connect(list_->header(), &QHeaderView::sectionResized, list_, [this] { list_->doItemsLayout(); });
  column->addWidget(list_, 1);
  connect(ask_, &QPushButton::clicked, this, [this] { queue_.busy() ? stop() : diagnose(); });
  connect(list_, &QTreeWidget::itemClicked, this, [this](QTreeWidgetItem* item) { choose(item); });
  connect(list_, &QTreeWidget::itemActivated, this, [this](QTreeWidgetItem* item) { choose(item); });
  follow();
  refresh();
}

/// The document, and the work that was asked for.
void DiagnosisPanel::follow() {
  connect(&document_, &Document::inspectionChanged, this, &DiagnosisPanel::refresh);
  connect(&document_, &Document::selectionChanged, this, [this] {
    // A click on a line of the list does not move the lines under the mouse.
    const bool another = advised() && document_.selection().model != advisedFor_;
    if (!choosing_ && !document_.stale() && (another || goodModel() != good_)) return refresh();
    if (another) delete list_->takeTopLevelItem(0), fillAdvice();
  });
  connect(&document_, &Document::staleChanged, this, [this](bool stale) {
    if (stale) queue_.stop();  // of a state that is no more; the new one's results wait for the processor
    enableTries();
    showState();
  });
  connect(&document_, &Document::requestChanged, this,
          [this] { queue_.stop(); });  // results of the new state may be there already
  connect(&document_, &Document::sceneOpened, this, [this] {
    queue_.drop();
    queue_.stop();
    of_ = nullptr;
    diagnosis_.reset();
    refresh();
  });
  connect(&queue_, &JobQueue::busyChanged, this, [this](bool busy) {
    if (busy) stopping_ = false, bar_->setRange(0, 0);
    showState();
  });
}

void DiagnosisPanel::addActions(Actions& actions, QMenu* menu, std::function<void()> show) {
  actions.add("plots.diagnose", menu, tr("Find out &why models fail"), [this, show] {
    show();
    diagnose();
  });
  actions.add("plots.try-remedy", menu, tr("&Try first remedy"),
              [this, show] {
                show();
                tryFirst();
              },
              {{}, {}, tr("The first remedy in Problems for the selected model, else the first of all; undo takes it back")});
}

void DiagnosisPanel::tryFirst() {
  if (!advised() || diagnosis_->remedies.empty())
    return void(emit problem(tr("There is no remedy to try; \"Find out why models fail\" looks for them")));
  tryRemedy(diagnosis_->remedies.front().change);
}

void DiagnosisPanel::stop() {
  if (!queue_.busy()) return;
  stopping_ = true;  // a fit may take a moment to end
  queue_.stop();
  showState();
}

void DiagnosisPanel::diagnose() {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection || document_.stale()) return;
  of_ = inspection;
  diagnosis_.reset();
  steps_.clear();
  refresh();
  queue_.start(
      [this, inspection, present = document_.selection().model](const JobToken& token) {
        DiagnoseOptions options;
        options.present = present;
        options.soFar = [this, &token](const Diagnosis& diagnosis) { token.deliver([this, diagnosis] { take(diagnosis); }); };
        const ProgressFn progress = token.progress([this](const StageEvent& e) {
          steps_ = tr("%1 of %2").arg(std::min(e.done + 1, e.total)).arg(e.total);
          bar_->setRange(0, e.total);
          bar_->setValue(e.done);
          showState(toQString(e.stage));
        });
        return glint::diagnose(*inspection, options, progress);
      },
      [this](const JobResult<Diagnosis>& result) {
        if (result.overtaken) return;
        if (!result.failure().isEmpty()) emit problem(result.failure());
        if (result.value) take(*result.value);
      },
      Asks::Instead);
}

void DiagnosisPanel::take(Diagnosis diagnosis) {
  adviseFor(diagnosis, document_.selection().model);  // another one may have been selected since
  // Lines do not move under the mouse where nothing new is said.
  const bool news = !diagnosis_ || diagnosis_->verdict != diagnosis.verdict ||
                    diagnosis_->remedies.size() != diagnosis.remedies.size() ||
                    !std::equal(diagnosis.remedies.begin(), diagnosis.remedies.end(), diagnosis_->remedies.begin(),
                                [](const Remedy& a, const Remedy& b) { return a.change == b.change; }) ||
                    diagnosis_->models.size() != diagnosis.models.size() || diagnosis_->notes != diagnosis.notes;
  diagnosis_ = std::move(diagnosis);
  if (news) refresh();
}

bool DiagnosisPanel::advised() const { return diagnosis_ && document_.inspection() && isOf(*document_.inspection()); }

void DiagnosisPanel::refresh() {
  list_->clear();
  if (advised()) fillAdvice();
  fillProblems();
  if (advised())
    for (const ModelDiagnosis& d : diagnosis_->models) fillDiagnosis(d);
  emit problemsChanged(problems_);
  tellRuns();
  showState();
}

/// The same question about the same scene: undo leads back to it.
bool DiagnosisPanel::isOf(const Inspection& inspection) const {
  return of_ && of_->given == inspection.given && of_->request == inspection.request;
}

void DiagnosisPanel::tellRuns() {
  std::shared_ptr<std::vector<viz::DrawnRuns>> runs;
  if (advised()) {
    runs = std::make_shared<std::vector<viz::DrawnRuns>>();
    for (const ModelDiagnosis& d : diagnosis_->models)
      for (const FitTrace& fit : d.fits) runs->push_back({d.model, fit.key.light, fit.runs});
  }
  emit runsChanged(runs);
}

std::string DiagnosisPanel::goodModel() const {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection) return {};
  const auto result = inspection->models.find(document_.selection().model);
  const std::vector<std::string>& asked = inspection->request.models;
  if (result == inspection->models.end() || !std::count(asked.begin(), asked.end(), result->first)) return {};
  return hasProblem(*inspection, result->second) ? std::string() : result->first;
}

void DiagnosisPanel::fillGood() {
  good_ = goodModel();
  if (good_.empty()) return;
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  bool others = advised();
  for (const std::string& name : inspection->request.models)
    if (const auto it = inspection->models.find(name); it != inspection->models.end())
      others = others || hasProblem(*inspection, it->second);
  if (!others) return;  // the line above the list says it of all
  auto* const line = new QTreeWidgetItem(list_, {goodWords(*inspection, inspection->models.at(good_))});
  line->setToolTip(0, tr("The model that is selected. What is wrong with others is folded below"));
  line->setData(0, kModel, toQString(good_));
  line->setData(0, kGood, true);
  line->setExpanded(true);
}

void DiagnosisPanel::fillProblems() {
  problems_ = 0;
  good_.clear();
  shared_.clear();
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection) return;
  fillGood();
  const bool explained = advised();  // the verdict is above, and causes say why
  const bool folded = explained || !good_.empty();
  for (const std::string& name : inspection->request.models) {
    const auto result = inspection->models.find(name);
    if (result == inspection->models.end()) continue;
    const ModelSummary summary = summarise(*inspection, result->second);
    const std::vector<WrongFrame> wrong = wrongFrames(*inspection, result->second);
    if (summary.answered && wrong.empty()) continue;
    ++problems_;
    std::set<int> frames;  // one may be wrong under several lights
    for (const WrongFrame& w : wrong) frames.insert(w.frame);
    auto* top = new QTreeWidgetItem(
        list_,
        {summary.answered
             ? tr(frames.size() == 1 ? "%1: %2 frame wrong" : "%1: %2 frames wrong").arg(toQString(name)).arg(frames.size())
             : tr("%1: no answer").arg(toQString(name))});
    top->setData(0, kModel, toQString(name));
    top->setExpanded(!folded);
    for (const ModelResult::Fit& fit : result->second.fits)
      if (fit.failure() && !explained)
        addLine(top, tr("because %1: %2").arg(lightText(textOf(fit.key())), toQString(fit.failure()->message())),
                ProblemLine::Cause);
    if (const std::string& doubt = inspection->lightFrame.doubt; summary.answered && !explained && !doubt.empty())
      addLine(top, tr("because %1").arg(toQString(doubt)), ProblemLine::Cause);
    if (summary.answered) addShared(top, *inspection, name);
    if (summary.answered && !wrong.empty()) addWrongFrames(top, *inspection, wrong, !explained);
  }
}

void DiagnosisPanel::addShared(QTreeWidgetItem* top, const Inspection& inspection, const std::string& model) {
  for (SharedCause& cause : sharedCauses(inspection, *document_.rows(), model)) {
    auto* const line = addLine(top, tr("in common: %1").arg(toQString(cause.text)), ProblemLine::Shared);
    line->setToolTip(
        0, tr("%1\nWhat goes together; it need not be the cause. A click brushes these highlights: the table of errors and the "
              "plot \"Any two columns\" show them.")
               .arg(toQString(cause.text)));
    line->setData(0, kShared, int(shared_.size()));
    shared_.push_back({cause.highlights.begin(), cause.highlights.end()});
  }
}

void DiagnosisPanel::fillAdvice() {
  advisedFor_ = document_.selection().model;
  adviseFor(*diagnosis_, advisedFor_);
  auto* const top = new QTreeWidgetItem({toQString(diagnosis_->verdict)});
  list_->insertTopLevelItem(0, top);
  QFont bold = list_->font();
  bold.setBold(true);
  top->setFont(0, bold);
  top->setData(0, kModel, toQString(advisedFor_));
  for (const Remedy& remedy : diagnosis_->remedies) addRemedy(top, remedy);
  auto* const stands = new QTreeWidgetItem(
      top,
      {tr("evidence: %1 of %2 known changes tried").arg(diagnosis_->tried).arg(std::max(diagnosis_->known, diagnosis_->tried))});
  const auto line = [&](const QString& text) { new QTreeWidgetItem(stands, {text}); };
  for (const std::string& note : diagnosis_->notes) line(toQString(note));
  for (const Measured& m : diagnosis_->measured)
    line(tr("%1: error %2").arg(toQString(wordsOf(m.change)), toQString(textOf(m.error))));
  top->setExpanded(true);
  enableTries();
}

void DiagnosisPanel::fillDiagnosis(const ModelDiagnosis& d) {
  std::vector<const HighlightEvidence*> against;
  for (const HighlightEvidence& e : d.evidence)
    if (!e.against.empty()) against.push_back(&e);
  std::stable_sort(against.begin(), against.end(), [](auto* a, auto* b) { return a->weight > b->weight; });
  if (d.causes.empty() && (against.empty() || against.front()->weight < 1)) return;
  QTreeWidgetItem* const top = itemOf(d.model, tr("%1: %2").arg(toQString(d.model), toQString(d.status)));
  for (const std::string& cause : d.causes)
    if (const QString line = tr("because %1").arg(toQString(cause)); !hasLine(top, line)) addLine(top, line, ProblemLine::Cause);
  for (std::size_t i = 0; i < against.size() && i < kMostHighlights; ++i) {
    const HighlightEvidence& e = *against[i];
    QStringList words;
    for (const std::string& a : e.against) words << toQString(a);
    auto* line = addLine(
        top,
        tr("against it: frame %1, %2: %3")
            .arg(nameText(of_->scene->frames[std::size_t(e.frame)].id), lightText(e.light), words.join(QStringLiteral("; "))),
        ProblemLine::Against);
    line->setData(0, kFrame, e.frame);
    line->setData(0, kLight, toQString(e.light));
    line->setData(0, kHighlight, e.highlight);
  }
  for (const FitTrace& fit : d.fits)
    for (const std::string& line : textOf(fit))
      addLine(top, tr("fit of %1: %2").arg(lightText(textOf(fit.key)), toQString(line)), ProblemLine::Course)
          ->setData(0, kLight, toQString(fit.key.light));
}

QTreeWidgetItem* DiagnosisPanel::itemOf(const std::string& model, const QString& otherwise) {
  for (int i = 1; i < list_->topLevelItemCount(); ++i)  // below the verdict
    if (list_->topLevelItem(i)->data(0, kModel).toString() == toQString(model)) return list_->topLevelItem(i);
  auto* top = new QTreeWidgetItem(list_, {otherwise});
  top->setData(0, kModel, toQString(model));
  return top;
}

void DiagnosisPanel::addRemedy(QTreeWidgetItem* top, const Remedy& remedy) {
  auto* line = new QTreeWidgetItem(top);
  auto* holder = new QWidget;
  auto* row = new QHBoxLayout(holder);
  row->setContentsMargins(0, 1, 4, 1);
  const QString flags = toQString(flagsOf(remedy.change));
  auto* button = new QPushButton(tr("Try"));
  button->setObjectName(QStringLiteral("try"));
  button->setAccessibleName(tr("Try %1").arg(flags));
  button->setToolTip(tr("Makes this change; undo takes it back"));
  row->addWidget(button);
  const QString effect = toQString(effectText(remedy)).replace(QStringLiteral("->"), QStringLiteral("\u2192"));
  auto* label = new QLabel(tr("%1: error %2").arg(toQString(wordsOf(remedy.change)), effect));
  label->setTextFormat(Qt::PlainText);
  label->setToolTip(tr("%1\n%2\nThe error is the mean over views that the fit did not see.").arg(flags, toQString(remedy.why)));
  row->addWidget(label, 1);
  list_->setItemWidget(line, 0, holder);
  connect(button, &QPushButton::clicked, this, [this, change = remedy.change] { tryRemedy(change); });
}

/// While a change is computed, the remedies are of the state before.
void DiagnosisPanel::enableTries() {
  for (QPushButton* const button : list_->findChildren<QPushButton*>(QStringLiteral("try")))
    button->setEnabled(!document_.stale() && advised());
}

void DiagnosisPanel::tryRemedy(const Change& change) {
  if (!document_.scene()) return;
  InspectionRequest request = document_.request();
  const std::string use = change.model.value_or(diagnosis_->present);
  Change other = change;
  other.model = std::nullopt;
  try {
    request = with(request, other, *document_.scene());
  } catch (const InputError& e) {
    emit problem(toQString(e.what()));
    return;
  }
  if (!std::count(request.models.begin(), request.models.end(), use)) request.models.push_back(use);
  const QString text = tr("Try: %1").arg(toQString(wordsOf(change)));
  draw::Selection selection = document_.selection();
  if (request == document_.request() && selection.model == use) return;
  selection.model = use;
  document_.undoStack()->beginMacro(text);  // one intention, one step
  if (request != document_.request()) document_.setRequest(request, text);
  document_.select(selection);
  document_.undoStack()->endMacro();
  emit message(tr("%1. Undo takes it back").arg(text));
}

void DiagnosisPanel::choose(QTreeWidgetItem* item) {
  draw::Selection selection = document_.selection();
  const QTreeWidgetItem* top = item;
  while (top->parent()) top = top->parent();
  selection.model = top->data(0, kModel).toString().toStdString();
  if (const QVariant frame = item->data(0, kFrame); frame.isValid()) {
    selection.frame = frame.toInt();
    selection.light = item->data(0, kLight).toString().toStdString();
    const QVariant highlight = item->data(0, kHighlight);
    selection.highlight = highlight.isValid() ? highlight.toInt() : -1;
    const QVariant predicted = item->data(0, kPredicted);
    selection.predicted = predicted.isValid() ? predicted.toInt() : -1;
    selection.direction = std::nullopt;
  }
  const QVariant shared = item->data(0, kShared);
  choosing_ = true;
  document_.selectExactly(selection);
  choosing_ = false;
  if (shared.isValid()) document_.brush(shared_[std::size_t(shared.toInt())]);
}

void DiagnosisPanel::showState(const QString& stage) {
  const bool ready = document_.inspection() && !document_.stale(), busy = queue_.busy();
  ask_->setText(busy ? tr("Stop") : tr("Find out why"));
  ask_->setEnabled(busy ? !stopping_ : ready);
  bar_->setVisible(busy);
  if (busy && stopping_) return state_->setText(tr("Stopping\u2026"));
  if (busy) return state_->setText(stage.isEmpty() ? tr("Comparing the models\u2026") : tr("%1: %2\u2026").arg(steps_, stage));
  if (!document_.inspection()) return state_->setText(document_.scene() ? tr("Computing\u2026") : tr("No scene"));
  if (diagnosis_ && !advised()) return state_->setText(tr("Something has changed since the last answer; ask again"));
  if (advised())
    return state_->setText(stopping_ ? tr("Stopped after %1: what was found so far is listed").arg(steps_)
                                     : tr("Measured in views that the fit did not see"));
  if (problems_ == 0) return state_->setText(tr("Every model answers, and no frame is wrong"));
  if (!good_.empty())
    return state_->setText(tr(problems_ == 1 ? "%1 other model with problems" : "%1 other models with problems").arg(problems_));
  state_->setText(tr(problems_ == 1 ? "%1 model with problems" : "%1 models with problems").arg(problems_));
}

}  // namespace glint::gui
