// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/document.h"

#include <algorithm>
#include <utility>

#include "core/advise/explain.h"
#include "core/draw/frame_overlay.h"
#include "core/scene/frame_name.h"
#include "gui/base/text.h"
#include "gui/document/selection_words.h"
#include "gui/document/state_command.h"
#include "gui/scene/scene_options.h"

namespace glint::gui {

Document::Document(ParseTrain parseTrain, QObject* parent) : QObject(parent), parseTrain_(std::move(parseTrain)) {}

bool Document::layerVisible(const std::string& name) const {
  if (const auto it = state_.layers.find(name); it != state_.layers.end()) return it->second;
  for (const viz::Layer& layer : viz::sceneLayers())
    if (layer.name == name) return layer.onByDefault;
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    if (layer.name == name) return layer.onByDefault;
  return true;
}

FrameRole Document::role(int frame) const {
  if (!pinnedShown_) return requestedRole(frame);
  return pinned_->isTraining(frame) ? FrameRole::Training : pinned_->isHeldOut(frame) ? FrameRole::HeldOut : FrameRole::Excluded;
}

FrameRole Document::requestedRole(int frame) const {
  const std::vector<int>& excluded = state_.request.excluded;
  if (std::find(excluded.begin(), excluded.end(), frame) != excluded.end()) return FrameRole::Excluded;
  return training_.count(frame) ? FrameRole::Training : FrameRole::HeldOut;
}

std::string Document::plottedModel() const {
  const std::vector<std::string>& models = state_.request.models;
  if (std::find(models.begin(), models.end(), state_.selection.model) != models.end()) return state_.selection.model;
  // Where nothing is selected, the explanation and the plots are about the same one.
  if (results_.complete() && !option("explain/step", std::string()).empty())
    if (const std::string explained = modelToExplain(*results_.complete(), ""); !explained.empty()) return explained;
  return models.empty() ? std::string() : models.back();
}

void Document::setInspection(std::shared_ptr<const Inspection> inspection, const InspectionRequest& computedFor) {
  if (!inspection || inspection->given != scene_) return;  // a late result of a scene that was closed
  const bool show = !results_.complete() || stale_ || computedFor == state_.request;
  results_.take(std::move(inspection), computedFor, show, state_.request,
                [this](const InspectionRequest& r) { return historyLeadsTo(r); });
  if (!show) return;
  setStale(computedFor != state_.request);
  emit inspectionChanged();
}

void Document::setFrameInspection(std::shared_ptr<const Inspection> inspection, int frame) {
  if (!inspection || inspection->given != scene_ || frame != state_.selection.frame) return;
  if (results_.complete() && !stale_ && inspection->request != state_.request) return;  // of a run that was overtaken
  results_.takeAhead(std::move(inspection), state_.request);
  emit frameInspectionChanged();
}

void Document::setObservation(std::shared_ptr<const Observation> observation) {
  if (observation &&
      (observation->given != scene_ || observation->frame != state_.selection.frame || observation->request != state_.request))
    return;
  if (results_.observe(std::move(observation), state_.request)) emit frameInspectionChanged();
}

RowsPtr Document::rowsOf(const std::shared_ptr<const Inspection>& inspection) const {
  if (!inspection) return std::make_shared<const std::vector<HighlightRow>>();
  std::erase_if(rows_, [this](const auto& known) { return known.first != results_.complete() && known.first != pinned_; });
  RowsPtr& rows = rows_[inspection];
  if (!rows) rows = std::make_shared<const std::vector<HighlightRow>>(highlightRows(*inspection));
  return rows;
}

bool Document::pin() {
  if (!results_.complete()) return false;
  pinned_ = results_.complete();
  const bool was = std::exchange(pinnedShown_, false);
  emit pinnedChanged();
  if (was) emit inspectionChanged();
  return true;
}

void Document::unpin() {
  if (!pinned_) return;
  showPinned(false);
  pinned_.reset();
  emit pinnedChanged();
}

void Document::showPinned(bool shown) {
  if (shown == pinnedShown_ || (shown && !pinned_)) return;
  pinnedShown_ = shown;
  emit pinnedChanged();
  emit inspectionChanged();
}

void Document::brush(std::set<RowKey> rows) {
  if (rows == brushed_) return;
  brushed_ = std::move(rows);
  emit brushedChanged();
}

void Document::setTradeoff(std::shared_ptr<const Tradeoff> tradeoff) {
  tradeoff_ = std::move(tradeoff);
  emit tradeoffChanged();
  emit savedStateChanged();
}

bool Document::influenceStale() const { return influence_ && influenceFor_ != state_.request; }

void Document::setInfluence(std::shared_ptr<const Influence> influence, const InspectionRequest& computedFor) {
  influence_ = std::move(influence);
  influenceFor_ = computedFor;
  emit influenceChanged();
}

bool Document::isLoaded(const TradeoffPoint& point) const {
  return state_.request.models == std::vector<std::string>{point.model} && state_.request.settings == point.settings;
}

void Document::setRequest(const InspectionRequest& request, const QString& text) {
  ViewState after = state_;
  after.request = request;
  push(std::move(after), text);
}

void Document::load(const TradeoffPoint& point, const QString& text) {
  InspectionRequest after = state_.request;
  after.models = {point.model};
  after.settings = point.settings;
  setRequest(after, text);
}

void Document::open(const Opened& opened) {
  // Parsed before anything changes, so that a wrong specification leaves the document as it was.
  if (parseTrain_ && opened.scene) parseTrain_(opened.request.train, *opened.scene);
  undo_.clear();
  scene_ = opened.scene;
  state_ = {opened.request, opened.selection, opened.layers, opened.options};
  state_.selection.frame = std::clamp(state_.selection.frame, 0, std::max(0, frameCount() - 1));
  saved_ = state_;
  inputFile_ = exactQString(opened.path);
  session_ = opened.session;
  sessionFile_ = opened.isSession ? inputFile_ : QString();
  results_ = Results(scene_);
  influence_.reset();
  pinned_.reset();
  pinnedShown_ = false;
  brushed_.clear();
  rows_.clear();
  tradeoff_ = savedTradeoff_ = opened.tradeoff;
  unsaved_ = opened.unsaved;
  updateTraining();
  setStale(scene_ != nullptr);
  emit pinnedChanged();
  emit sceneOpened();
  emit brushedChanged();
  emit tradeoffChanged();
  emit influenceChanged();
}

Opened Document::toSave() const {
  Opened o;
  o.path = sessionFile_.toStdString();
  o.isSession = true;
  o.scene = scene_;
  o.request = state_.request;
  o.selection = state_.selection;
  o.layers = state_.layers;
  o.options = state_.options;
  o.session = session_;
  o.tradeoff = tradeoff_;
  return o;
}

void Document::markSaved(const QString& sessionFile, const ViewState& saved, std::shared_ptr<const Tradeoff> tradeoff) {
  sessionFile_ = sessionFile;
  saved_ = saved;
  savedTradeoff_ = std::move(tradeoff);
  unsaved_ = false;
  emit savedStateChanged();
}

namespace {
/// Views that were kept under a name: made on purpose, unlike how things happen to be shown.
std::map<std::string, std::string> keptViews(const std::map<std::string, std::string>& options) {
  std::map<std::string, std::string> kept;
  for (const auto& [name, value] : options)
    if (name.rfind(kSavedView, 0) == 0 && !value.empty()) kept[name] = value;
  return kept;
}
}  // namespace

bool Document::hasUnsavedChanges() const {
  return scene_ && (unsaved_ || saved_.request != state_.request || tradeoff_ != savedTradeoff_ ||
                    keptViews(saved_.options) != keptViews(state_.options));
}

bool Document::looksAsSaved() const { return saved_.layers == state_.layers && saved_.options == state_.options; }

void Document::setSetting(const std::string& key, const SettingValue& value, int gesture) {
  ViewState after = state_;
  after.request.settings.set(key, value);
  const ParamSpec& spec = paramSpec(key);
  push(std::move(after), toQString(spec.title) + QStringLiteral(": ") + valueText(value, spec),
       gesture > 0 ? QStringLiteral("%1#%2").arg(toQString(key)).arg(gesture) : QString());
}

void Document::resetSetting(const std::string& key) {
  ViewState after = state_;
  after.request.settings.reset(key);
  push(std::move(after), tr("Reset %1").arg(toQString(paramSpec(key).title)));
}

void Document::setModels(const std::vector<std::string>& models) {
  ViewState after = state_;
  after.request.models = models;
  push(std::move(after), tr("Models: %1").arg(models.empty() ? tr("none") : joined(models)));
}

bool Document::setTrain(const std::string& specification, QString* error) {
  if (!scene_) return false;
  try {
    if (parseTrain_) parseTrain_(specification, *scene_);
  } catch (const InputError& e) {
    if (error) *error = toQString(e.what());
    return false;
  }
  ViewState after = state_;
  after.request.train = specification;
  push(std::move(after), tr("Train on %1").arg(toQString(specification)));
  return true;
}

void Document::setSource(FrameSource source) {
  ViewState after = state_;
  after.request.source = source;
  push(std::move(after), source == FrameSource::Radiance ? tr("Detect in radiance") : tr("Detect in photographs"));
}

void Document::setWhatIf(const WhatIf& whatIf, const QString& text, const QString& mergeKey) {
  ViewState after = state_;
  after.request.whatIf = whatIf;
  push(std::move(after), text, mergeKey);
}

void Document::setRole(int frame, FrameRole role) {
  showPinned(false);  // a change is of what is computed
  if (frame < 0 || frame >= frameCount() || role == this->role(frame)) return;
  ViewState after = state_;
  std::vector<int>& excluded = after.request.excluded;
  excluded.erase(std::remove(excluded.begin(), excluded.end(), frame), excluded.end());
  const QString id = nameText(scene_->frames[std::size_t(frame)].id);
  if (role == FrameRole::Excluded) {
    excluded.push_back(frame);
    std::sort(excluded.begin(), excluded.end());
    push(std::move(after), tr("Exclude frame %1").arg(id));
    return;
  }
  std::set<int> training = training_;
  if (role == FrameRole::Training)
    training.insert(frame);
  else
    training.erase(frame);
  // The words of the specification ("spread:6") are kept where the set of frames stays the same.
  if (training != training_) {
    const std::string ranges = frameSpec({training.begin(), training.end()}, *scene_);
    if (ranges.empty()) return;  // nothing to learn from is not a specification
    after.request.train = ranges;
  }
  push(std::move(after), role == FrameRole::Training ? tr("Train on frame %1").arg(id) : tr("Hold out frame %1").arg(id));
}

void Document::select(draw::Selection s, int gesture) {
  const draw::Selection& now = state_.selection;
  if (s.highlight >= 0 ||
      (s.predicted == now.predicted && (s.frame != now.frame || s.model != now.model || s.light != now.light)))
    s.predicted = -1;  // it was of the frame and model that were selected
  selectExactly(s, gesture);
}

void Document::selectExactly(const draw::Selection& selection, int gesture) {
  if (!scene_) return;
  ViewState after = state_;
  after.selection = selection;
  after.selection.frame = std::clamp(selection.frame, 0, std::max(0, frameCount() - 1));
  const QString text = selectionWords(state_.selection, after.selection, *scene_);
  push(std::move(after), text, gesture > 0 ? QStringLiteral("select#%1").arg(gesture) : QString());
}

void Document::selectFrame(int frame, int gesture) {
  draw::Selection s = state_.selection;
  if (s.frame == frame) return;
  s.frame = frame;
  s.highlight = -1;
  s.direction.reset();
  select(s, gesture);
}

void Document::showFrame(int frame) {
  if (!scene_ || frame == state_.selection.frame || frame < 0 || frame >= frameCount()) return;
  ViewState after = state_;
  after.selection.frame = frame;
  after.selection.highlight = after.selection.predicted = -1;
  after.selection.direction.reset();
  apply(after);
}

void Document::setLayerVisible(const std::string& name, const std::string& title, bool visible) {
  if (layerVisible(name) == visible) return;
  ViewState after = state_;
  after.layers[name] = visible;
  push(std::move(after), (visible ? tr("Show %1") : tr("Hide %1")).arg(toQString(title).toLower()));
}

void Document::setView(const std::map<std::string, bool>& layers, const std::map<std::string, std::string>& options,
                       const QString& text) {
  ViewState after = state_;
  after.layers = layers;
  after.options = options;
  push(std::move(after), text);
}

namespace {
std::string optionText(double value) { return QString::number(value, 'g', 12).toStdString(); }
}  // namespace

std::string Document::option(const std::string& name, const std::string& otherwise) const {
  const auto it = state_.options.find(name);
  return it == state_.options.end() ? otherwise : it->second;
}

double Document::option(const std::string& name, double otherwise) const {
  const auto it = state_.options.find(name);
  if (it == state_.options.end()) return otherwise;
  bool isNumber = false;
  const double value = toQString(it->second).toDouble(&isNumber);
  return isNumber ? value : otherwise;
}

void Document::setOption(const std::string& name, const std::string& value, const QString& text, int gesture) {
  ViewState after = state_;
  after.options[name] = value;
  push(std::move(after), text, gesture > 0 ? QStringLiteral("%1#%2").arg(toQString(name)).arg(gesture) : QString());
}

void Document::setOption(const std::string& name, double value, const QString& text, int gesture) {
  setOption(name, optionText(value), text, gesture);
}

void Document::showOption(const std::string& name, double value) {
  ViewState after = state_;
  after.options[name] = optionText(value);
  if (after.options != state_.options) apply(after);
}

void Document::push(ViewState after, const QString& text, const QString& mergeKey) {
  if (after.request == state_.request && after.selection == state_.selection && after.layers == state_.layers &&
      after.options == state_.options)
    return;
  undo_.push(new StateCommand(*this, state_, std::move(after), text, mergeKey));
}

void Document::apply(const ViewState& state) {
  const bool request = state.request != state_.request;
  const bool selection = state.selection != state_.selection;
  const bool layers = state.layers != state_.layers;
  const bool options = state.options != state_.options;
  if (state.selection.frame != state_.selection.frame) results_.leaveFrame();
  if (request) showPinned(false);
  state_ = state;
  if (request) {
    updateTraining();
    followRequest();
  }
  if (selection) emit selectionChanged();
  if (layers) emit layersChanged();
  if (options) emit optionsChanged();
  if (request || layers || options) emit savedStateChanged();
}

void Document::followRequest() {
  const bool known = results_.show(state_.request);
  setStale(!known);
  emit requestChanged();
  if (known) emit inspectionChanged();
}

bool Document::historyLeadsTo(const InspectionRequest& request) const {
  if (request == state_.request) return true;
  const auto leads = [&request](const QUndoCommand* step) {
    const auto* state = dynamic_cast<const StateCommand*>(step);
    return state && state->leadsTo(request);
  };
  for (int i = 0; i < undo_.count(); ++i) {
    const QUndoCommand* const step = undo_.command(i);
    if (leads(step)) return true;
    for (int k = 0; k < step->childCount(); ++k)  // of a step that is made of several
      if (leads(step->child(k))) return true;
  }
  return false;
}

void Document::updateTraining() {
  training_.clear();
  if (!scene_ || !parseTrain_) return;
  try {
    const TrainSpec spec = parseTrain_(state_.request.train, *scene_);
    training_.insert(spec.frames.begin(), spec.frames.end());
  } catch (const InputError&) {
    // Cannot happen through the actions, which parse first; an empty set marks nothing as training.
  }
}

void Document::setStale(bool stale) {
  if (stale == stale_) return;
  stale_ = stale;
  emit staleChanged(stale);
}

}  // namespace glint::gui
