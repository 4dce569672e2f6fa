// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/scene_lamps.h"

#include <QFileInfo>
#include <QMenu>
#include <algorithm>
#include <utility>

#include "gui/base/text.h"
#include "gui/document/own_files.h"
#include "gui/lamps/lamp_table.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/lamps/save_lamps.h"

namespace glint::gui {
namespace {
constexpr const char* kMeasured = "lamps/measured";
}  // namespace

SceneLamps::SceneLamps(const Engine& engine, Document& document, QWidget* window)
    : QObject(window), engine_(engine), document_(document), window_(window), panel_(new LampsPanel) {
  connect(&document_, &Document::sceneOpened, this, &SceneLamps::forget);
  connect(&document_, &Document::requestChanged, this, &SceneLamps::markStale);
  connect(&document_, &Document::selectionChanged, this, &SceneLamps::selectFromDocument);
  connect(&document_, &Document::optionsChanged, this, &SceneLamps::remember);
  connect(&document_, &Document::inspectionChanged, this, &SceneLamps::measureAgain);
  connect(panel_->table(), &LampTable::lampSelected, this, &SceneLamps::selectFromTable);
  connect(panel_, &LampsPanel::measureRequested, this, &SceneLamps::measure);
  connect(panel_, &LampsPanel::stopRequested, this, &SceneLamps::cancel);
  connect(panel_, &LampsPanel::saveRequested, this, &SceneLamps::save);
  connect(&jobs_, &JobQueue::busyChanged, panel_, &LampsPanel::setBusy);
}

void SceneLamps::addActions(Actions& actions, QMenu* menu) {
  actions.add("lamps.measure", menu, tr("Measure &lamps"),
              [this] {
                emit shown();
                measure();
              },
              {{}, {}, tr("Where the lamps of this scene are, from the highlights of its frames, with their uncertainty")});
  actions.add("lamps.save", menu, tr("Save measured la&mps…"), [this] { save(); },
              {{}, {}, tr("As JSON, as a table (CSV) or as light positions for RTI programs (.lp)")});
}

void SceneLamps::forget() {
  jobs_.close();
  lamps_.reset();
  scene_ = document_.sharedScene();
  panel_->setPossible(scene_ && engine_.lamps);
  panel_->setStale(false);
  panel_->show(nullptr, tr("Not measured yet."));
  emit changed(nullptr);
  again_ = scene_ && engine_.lamps && document_.option(kMeasured, 0.0) > 0;
  if (again_)
    panel_->show(nullptr, tr("This session was saved with measured lamps. They are measured again once its results are there."));
}

/// An option of the view that an undone step does not take back.
void SceneLamps::remember() {
  if (lamps_) document_.showOption(kMeasured, 1);
}

void SceneLamps::measureAgain() {
  if (!again_ || !document_.inspection()) return;
  again_ = false;
  measure();
}

void SceneLamps::measure() {
  if (!document_.scene() || !engine_.lamps || jobs_.busy()) return;
  again_ = false;
  const auto show = [this](const StageEvent& e) { panel_->setProgress(toQString(e.stage), e.done, e.total); };
  jobs_.start(
      [measure = engine_.lamps, scene = document_.sharedScene(), request = document_.request(), previous = document_.inspection(),
       input = document_.inputFile().toStdString(), show](const JobToken& token) {
        LampsPtr lamps =
            std::make_shared<const LampsReport>(measure(scene, request, input, token.progress(show), previous.get()));
        if (token.stopped()) throw Stopped{};
        return lamps;
      },
      [this, scene = document_.sharedScene(), request = document_.request()](const JobResult<LampsPtr>& result) {
        if (scene != document_.sharedScene()) return;
        if (result.stopped) return void(emit message(tr("Measuring lamps: stopped")));
        if (!result.failure().isEmpty()) return void(emit problem(tr("Lamps: %1").arg(result.failure())));
        take(*result.value, request);
      });
}

void SceneLamps::take(const LampsPtr& lamps, const InspectionRequest& measuredFor) {
  lamps_ = lamps;
  measuredFor_ = measuredFor;
  panel_->show(lamps_.get(), {});
  markStale();
  emit changed(std::shared_ptr<const std::vector<LampAnswer>>(lamps_, &lamps_->lamps));
  const std::optional<Failure> nothing = nothingMeasured(*lamps_);
  emit message(nothing ? tr("Lamps: %1").arg(toQString(nothing->message())) : tr("Lamps measured: %1").arg(lamps_->lamps.size()));
  selectFromDocument();
  remember();
}

/// Models and training frames make no difference to lamps.
void SceneLamps::markStale() {
  if (!lamps_ || !document_.scene()) return;
  panel_->setStale(lampsRequest(document_.request(), *document_.scene()) != lampsRequest(measuredFor_, *document_.scene()));
}

void SceneLamps::selectFromDocument() {
  if (!lamps_ || selecting_ || !document_.scene()) return;
  const draw::Selection& s = document_.selection();
  const std::string& frame = document_.scene()->frames[std::size_t(s.frame)].id;
  int found = -1, inFrame = 0;
  for (int i = 0; i < int(lamps_->lamps.size()); ++i) {
    const LampAnswer& lamp = lamps_->lamps[std::size_t(i)];
    if (std::count(lamp.frames.begin(), lamp.frames.end(), frame) == 0) continue;
    ++inFrame;
    if (s.light.empty() || s.light == lamp.id) found = i;
  }
  if (s.light.empty() && inFrame > 1) found = -1;
  for (int i = 0; i < int(lamps_->lamps.size()); ++i)
    if (!s.light.empty() && lamps_->lamps[std::size_t(i)].id == s.light) found = i;
  panel_->table()->setCurrentLamp(found);
}

void SceneLamps::selectFromTable(int index) {
  if (!lamps_ || index < 0 || !document_.scene()) return;
  const LampAnswer& lamp = lamps_->lamps[std::size_t(index)];
  draw::Selection s = document_.selection();
  const std::vector<Frame>& frames = document_.scene()->frames;
  const auto shows = [&](const std::string& id) { return std::count(lamp.frames.begin(), lamp.frames.end(), id) > 0; };
  if (!shows(frames[std::size_t(s.frame)].id)) {
    const auto first = std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return shows(f.id); });
    if (first != frames.end()) s = draw::Selection{int(first - frames.begin()), s.model, -1, {}, {}};
  }
  s.light = lamp.id;
  selecting_ = true;
  document_.select(s);
  selecting_ = false;
}

void SceneLamps::save() {
  if (!lamps_ || !document_.scene()) return void(emit problem(tr("No lamps are measured yet (Plots > Measure lamps)")));
  LampsReport report = *lamps_;
  std::vector<std::string> warnings;
  report.lines = lampLinesOf(*document_.scene(), report.lamps, warnings);
  try {
    const QString file = saveLamps(window_, report, QFileInfo(document_.inputFile()).absolutePath(), filesOfInput(document_));
    if (file.isEmpty()) return;
    emit message(tr("Wrote %1").arg(shownText(file)));
    if (QFileInfo(file).suffix() != QLatin1String("lp")) return;
    for (const std::string& w : warnings) emit message(toQString(w));
  } catch (const InputError& e) {
    emit problem(toQString(e.what()));
  }
}

}  // namespace glint::gui
