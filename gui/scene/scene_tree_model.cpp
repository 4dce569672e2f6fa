// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/scene_tree_model.h"

#include <QFont>
#include <QGuiApplication>
#include <QPalette>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/advise/highlight_evidence.h"
#include "core/advise/influence.h"
#include "core/geometry/ellipsoid.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/document/frame_roles.h"
#include "gui/scene/hidden_objects_option.h"
#include "gui/scene/scene_options.h"

namespace glint::gui {

using Kind = SceneObject::Kind;

namespace {
constexpr int kSurfaces = 0, kLights = 1, kModels = 2, kCameras = 3;  // place among the groups
constexpr quintptr kGroupId = 0, kObjectId = 1;                       // of an object: kObjectId + its group
constexpr quintptr kHighlightId = 100;                                // of a highlight: kHighlightId + its camera

std::string surfaceKeyOf(const Frame& frame) { return frame.surface.empty() ? viz::HiddenObjects::kDepthMaps : frame.surface; }

template <typename T>
void hideOrShow(std::set<T>& set, const T& value, bool hide) {
  if (hide)
    set.insert(value);
  else
    set.erase(value);
}

void addOnce(std::vector<SceneObject>& objects, SceneObject object) {
  if (std::find(objects.begin(), objects.end(), object) == objects.end()) objects.push_back(std::move(object));
}

SceneObject camera(int frame) { return {Kind::Camera, frame, -1, {}, {}}; }

std::vector<SceneObject> surfacesOf(const Scene& scene) {
  std::vector<SceneObject> objects;
  std::set<std::string> seen;
  for (const Frame& frame : scene.frames)
    if (const std::string key = surfaceKeyOf(frame); seen.insert(key).second) objects.push_back({Kind::Surface, -1, -1, key, {}});
  return objects;
}

std::vector<SceneObject> lightsOf(const Scene& scene, const Inspection* inspection) {
  std::vector<SceneObject> objects;
  for (const TrueLight& light : scene.lights) addOnce(objects, {Kind::Light, -1, -1, light.id, {}});
  if (inspection)
    for (const auto& [key, estimate] : inspection->lights)
      if (estimate) addOnce(objects, {Kind::Light, -1, -1, key.light, {}});
  return objects;
}

std::vector<SceneObject> modelsOf(const InspectionRequest& request, const Inspection* inspection) {
  std::vector<SceneObject> objects;
  if (!inspection) return objects;
  for (const std::string& model : request.models) {
    const auto found = inspection->models.find(model);
    if (found == inspection->models.end()) continue;
    for (const ModelResult::Fit& fit : found->second.fits) addOnce(objects, {Kind::Ellipsoid, -1, -1, model, fit.light});
  }
  return objects;
}

draw::Colour roleColour(FrameRole role) {
  return role == FrameRole::Training ? draw::kTraining : role == FrameRole::HeldOut ? draw::kHeldOut : draw::kExcluded;
}
}  // namespace

void setHiddenIn(viz::HiddenObjects& hidden, const SceneObject& o, bool hide) {
  switch (o.kind) {
    case Kind::Surface: return hideOrShow(hidden.surfaces, o.key, hide);
    case Kind::Camera: return hideOrShow(hidden.frames, o.frame, hide);
    case Kind::Light: return hideOrShow(hidden.lights, o.key, hide);
    case Kind::Ellipsoid: return hideOrShow(hidden.ellipsoids, {o.key, o.light}, hide);
    case Kind::Highlight: return;
  }
}

bool isHiddenIn(const viz::HiddenObjects& hidden, const SceneObject& o) {
  switch (o.kind) {
    case Kind::Surface: return hidden.surfaces.count(o.key) > 0;
    case Kind::Camera:
    case Kind::Highlight: return hidden.frames.count(o.frame) > 0;
    case Kind::Light: return hidden.lights.count(o.key) > 0;
    case Kind::Ellipsoid: return hidden.ellipsoids.count({o.key, o.light}) > 0;
  }
  return false;
}

bool isSelected(const SceneObject& o, const draw::Selection& s) {
  switch (o.kind) {
    case Kind::Surface: return false;
    case Kind::Camera: return s.frame == o.frame;
    case Kind::Highlight:
      if (o.predicted < 0) return s.frame == o.frame && s.highlight == o.highlight;
      return s.frame == o.frame && s.highlight < 0 && s.predicted == o.predicted && s.model == o.key && s.light == o.light;
    case Kind::Light: return s.light == o.key;
    case Kind::Ellipsoid: return s.model == o.key && (s.light.empty() || s.light == o.light);
  }
  return false;
}

SceneTreeModel::SceneTreeModel(Document& document, QObject* parent)
    : QAbstractItemModel(parent),
      document_(document),
      groups_{{{Kind::Surface, tr("Surfaces"), {"surface"}, {}},
               {Kind::Light, tr("Lights"), {"light", "true-light", "measured-lamps"}, {}},
               {Kind::Ellipsoid, tr("Models"), {"ellipsoids", "cones", "predicted-contours"}, {}},
               {Kind::Camera, tr("Cameras"), {"cameras", "photographs", "virtual-cameras"}, {}}}} {
  connect(&document_, &Document::sceneOpened, this, &SceneTreeModel::rebuild);
  connect(&document_, &Document::inspectionChanged, this, &SceneTreeModel::followInspection);
  connect(&document_, &Document::optionsChanged, this, &SceneTreeModel::followView);
  connect(&document_, &Document::layersChanged, this, &SceneTreeModel::emitAllChanged);
  connect(&document_, &Document::selectionChanged, this, &SceneTreeModel::followSelection);
  connect(&document_, &Document::requestChanged, this, &SceneTreeModel::followRoles);
  for (const auto signal : {&Document::influenceChanged, &Document::requestChanged, &Document::selectionChanged})
    connect(&document_, signal, this, &SceneTreeModel::refreshEffects);
  rebuild();
}

// --- from the document ----------------------------------------------------------------------------------------------------

void SceneTreeModel::rebuild() {
  beginResetModel();
  for (Group& group : groups_) group.objects.clear();
  highlights_.clear();
  unmatched_.clear();
  if (const Scene* scene = document_.scene()) {
    groups_[0].objects = surfacesOf(*scene);
    for (int i = 0; i < document_.frameCount(); ++i) groups_[kCameras].objects.push_back(camera(i));
    highlights_.resize(std::size_t(document_.frameCount()));
  }
  hidden_ = hiddenObjects(document_);
  selection_ = document_.selection();
  train_ = document_.request().train;
  excluded_ = document_.request().excluded;
  layersShown_ = layersShown();
  endResetModel();
  followInspection();
}

void SceneTreeModel::followInspection() {
  const Scene* scene = document_.scene();
  if (!scene) return;
  const auto inspection = document_.inspection();
  setObjects(kLights, lightsOf(*scene, inspection.get()));
  setObjects(kModels, modelsOf(document_.request(), inspection.get()));
  unmatched_ = inspection ? draw::unmatchedByFrame(*inspection) : std::map<int, draw::FrameUnmatched>();
  for (int i = 0; i < int(highlights_.size()); ++i) {
    std::vector<SceneObject> highlights;
    if (inspection && std::size_t(i) < inspection->evidence.size()) {
      const std::vector<Highlight>& seen = inspection->evidence[std::size_t(i)].highlights;
      for (int h = 0; h < int(seen.size()); ++h) highlights.push_back({Kind::Highlight, i, h, {}, seen[std::size_t(h)].light});
      if (const auto found = unmatched_.find(i); found != unmatched_.end())
        for (const draw::FrameUnmatched::Spurious& s : found->second.spurious)
          highlights.push_back({Kind::Highlight, i, -1, s.model, s.light, s.predicted});
    }
    setHighlights(i, std::move(highlights));
  }
  refreshEffects();
  QStringList details;
  for (const int group : {kLights, kModels})
    for (const SceneObject& o : groups_[std::size_t(group)].objects) details << detailOf(o);
  if (details == details_) return;  // under a slider most results change numbers only
  details_ = details;
  emitChanged(kLights);
  emitChanged(kModels);
}

void SceneTreeModel::followSelection() {
  const draw::Selection now = document_.selection(), before = std::exchange(selection_, now);
  for (const int frame : std::set<int>{before.frame, now.frame}) {
    const QModelIndex row = indexOf(camera(frame));
    if (!row.isValid()) continue;
    emit dataChanged(row, row.siblingAtColumn(ColumnCount - 1));
    emitHighlightsChanged(frame);
  }
  for (const int group : {kSurfaces, kLights, kModels}) emitChanged(group);
}

void SceneTreeModel::followRoles() {
  const InspectionRequest& request = document_.request();
  if (request.train == train_ && request.excluded == excluded_) return;
  train_ = request.train;
  excluded_ = request.excluded;
  emitChanged(kCameras);
}

void SceneTreeModel::setObjects(int group, std::vector<SceneObject> objects) {
  std::vector<SceneObject>& now = groups_[std::size_t(group)].objects;
  if (now == objects) return;
  const QModelIndex parent = index(group, 0);
  if (!now.empty()) {
    beginRemoveRows(parent, 0, int(now.size()) - 1);
    now.clear();
    endRemoveRows();
  }
  if (objects.empty()) return;
  beginInsertRows(parent, 0, int(objects.size()) - 1);
  now = std::move(objects);
  endInsertRows();
}

void SceneTreeModel::setHighlights(int at, std::vector<SceneObject> highlights) {
  std::vector<SceneObject>& now = highlights_[std::size_t(at)];
  if (now == highlights) return emitHighlightsChanged(at);  // what misses them may be another
  const QModelIndex parent = indexOf(camera(at));
  const int had = int(now.size()), has = int(highlights.size());
  if (has < had) {
    beginRemoveRows(parent, has, had - 1);
    now = std::move(highlights);
    endRemoveRows();
  } else if (has > had) {
    beginInsertRows(parent, had, has - 1);
    now = std::move(highlights);
    endInsertRows();
  } else {
    now = std::move(highlights);
  }
  emitHighlightsChanged(at);
}

void SceneTreeModel::emitHighlightsChanged(int at) {
  const QModelIndex row = indexOf(camera(at));
  if (const int n = row.isValid() ? rowCount(row) : 0; n > 0)
    emit dataChanged(index(0, 0, row), index(n - 1, ColumnCount - 1, row));
}

void SceneTreeModel::followView() {
  viz::HiddenObjects hidden = hiddenObjects(document_);
  const bool layers = layersShown_ != layersShown();  // the active view may have its own, which are an option
  if (hidden == hidden_ && !layers) return;
  hidden_ = std::move(hidden);
  emitAllChanged();
}

void SceneTreeModel::refreshEffects() {
  std::map<int, double> effects;
  const auto influence = document_.influence();
  if (influence && !document_.influenceStale())
    for (const FrameInfluence& f : influence->frames)
      if (const std::optional<double> points = influenceOf(*influence, f.frame, document_.plottedModel()))
        effects[f.frame] = *points;
  const bool errors = influence && influence->probes.empty();
  if (effects == effects_ && errors == effectsAreErrors_) return;
  effectsAreErrors_ = errors;
  effects_ = std::move(effects);
  mostEffect_ = 0;
  for (const auto& [frame, points] : effects_) mostEffect_ = std::max(mostEffect_, std::abs(points));
  emitAllChanged();
  emit headerDataChanged(Qt::Horizontal, Effect, Effect);
  emit effectsChanged();
}

void SceneTreeModel::setActiveView(int view) {
  view_ = view;
  emitAllChanged();
}

void SceneTreeModel::emitChanged(int group) {
  const QModelIndex at = index(group, 0);
  emit dataChanged(at, at.siblingAtColumn(ColumnCount - 1));
  if (const int n = rowCount(at); n > 0) emit dataChanged(index(0, 0, at), index(n - 1, ColumnCount - 1, at));
}

void SceneTreeModel::emitAllChanged() {
  layersShown_ = layersShown();
  for (int g = 0; g < kGroups; ++g) emitChanged(g);
}

std::array<bool, SceneTreeModel::kGroups> SceneTreeModel::layersShown() const {
  std::array<bool, kGroups> shown;
  for (int g = 0; g < kGroups; ++g) shown[std::size_t(g)] = layerShown(groups_[std::size_t(g)]);
  return shown;
}

// --- structure --------------------------------------------------------------------------------------------------------------

QModelIndex SceneTreeModel::index(int row, int column, const QModelIndex& parent) const {
  if (!hasIndex(row, column, parent)) return {};
  if (!parent.isValid()) return createIndex(row, column, kGroupId);
  if (parent.internalId() == kGroupId) return createIndex(row, column, kObjectId + quintptr(parent.row()));
  return createIndex(row, column, kHighlightId + quintptr(parent.row()));
}

QModelIndex SceneTreeModel::parent(const QModelIndex& index) const {
  if (!index.isValid() || index.internalId() == kGroupId) return {};
  if (index.internalId() >= kHighlightId) return createIndex(int(index.internalId() - kHighlightId), 0, kObjectId + kCameras);
  return createIndex(int(index.internalId() - kObjectId), 0, kGroupId);
}

int SceneTreeModel::rowCount(const QModelIndex& parent) const {
  if (!parent.isValid()) return kGroups;
  if (parent.column() != 0) return 0;
  if (parent.internalId() == kGroupId) return int(groups_[std::size_t(parent.row())].objects.size());
  return parent.internalId() == kObjectId + kCameras ? int(highlights_[std::size_t(parent.row())].size()) : 0;
}

int SceneTreeModel::columnCount(const QModelIndex&) const { return ColumnCount; }

std::optional<SceneObject> SceneTreeModel::objectAt(const QModelIndex& index) const {
  if (!index.isValid() || index.internalId() == kGroupId) return {};
  if (index.internalId() >= kHighlightId)
    return highlights_[std::size_t(index.internalId() - kHighlightId)][std::size_t(index.row())];
  return groups_[std::size_t(index.internalId() - kObjectId)].objects[std::size_t(index.row())];
}

QModelIndex SceneTreeModel::groupOf(Kind kind) const {
  for (int g = 0; g < kGroups; ++g)
    if (groups_[std::size_t(g)].kind == kind) return index(g, 0);
  return {};
}

QModelIndex SceneTreeModel::indexOf(const SceneObject& object) const {
  if (object.kind == Kind::Highlight) {
    const QModelIndex parent = indexOf(camera(object.frame));
    if (object.predicted < 0) return object.highlight < rowCount(parent) ? index(object.highlight, 0, parent) : QModelIndex();
    if (!parent.isValid()) return {};
    const std::vector<SceneObject>& all = highlights_[std::size_t(object.frame)];
    const auto found = std::find(all.begin(), all.end(), object);
    return found == all.end() ? QModelIndex() : index(int(found - all.begin()), 0, parent);
  }
  const QModelIndex group = groupOf(object.kind);
  const std::vector<SceneObject>& objects = groups_[std::size_t(group.row())].objects;
  const auto found = std::find(objects.begin(), objects.end(), object);
  return found == objects.end() ? QModelIndex() : index(int(found - objects.begin()), 0, group);
}

std::vector<SceneObject> SceneTreeModel::objectsOf(Kind kind) const {
  const QModelIndex group = groupOf(kind);
  return group.isValid() ? groups_[std::size_t(group.row())].objects : std::vector<SceneObject>();
}

Qt::ItemFlags SceneTreeModel::flags(const QModelIndex& index) const {
  if (!index.isValid()) return {};
  const std::optional<SceneObject> object = objectAt(index);
  Qt::ItemFlags flags = Qt::ItemIsEnabled | Qt::ItemIsSelectable;
  if (index.column() == Name && !(object && object->kind == Kind::Highlight) &&
      (object || !groups_[std::size_t(index.row())].objects.empty()))
    flags |= Qt::ItemIsUserCheckable;
  return flags;
}

// --- what it says -----------------------------------------------------------------------------------------------------------

QString SceneTreeModel::nameOf(const SceneObject& o) const {
  const Scene* scene = document_.scene();
  switch (o.kind) {
    case Kind::Surface: return o.key == viz::HiddenObjects::kDepthMaps ? tr("depth maps") : tr("surface %1").arg(nameText(o.key));
    case Kind::Camera: return tr("camera %1").arg(nameText(scene->frames[std::size_t(o.frame)].id));
    case Kind::Highlight:
      return (o.predicted >= 0 ? tr("spurious highlight %1 of frame %2") : tr("highlight %1 of frame %2"))
          .arg(o.predicted >= 0 ? o.predicted + 1 : o.highlight + 1)
          .arg(nameText(scene->frames[std::size_t(o.frame)].id));
    case Kind::Light: return lightText(o.key);
    case Kind::Ellipsoid:
      return objectsOf(Kind::Light).size() < 2 ? nameText(o.key) : tr("%1 of %2").arg(nameText(o.key), lightText(o.light));
  }
  return {};
}

std::vector<std::string> SceneTreeModel::missedBy(const SceneObject& o) const {
  const auto inspection = document_.inspection();
  const auto found = unmatched_.find(o.frame);
  // Where a truth is scored, its highlights are other ones.
  if (o.highlight < 0 || !inspection || inspection->evidence[std::size_t(o.frame)].againstTruth || found == unmatched_.end())
    return {};
  const auto missed = found->second.missedBy.find(o.highlight);
  return missed == found->second.missedBy.end() ? std::vector<std::string>() : missed->second;
}

/// As the frame view and the list of problems mark and count them; what matters first, as the panel is narrow.
QString SceneTreeModel::highlightName(const SceneObject& o) const {
  if (o.predicted >= 0) return tr("△ spurious %1, of %2").arg(o.predicted + 1).arg(nameText(o.key));
  const std::vector<std::string> models = missedBy(o);
  if (models.empty()) return tr("highlight %1").arg(o.highlight + 1);
  return models.size() == 1 ? tr("□ missed %1, by %2").arg(o.highlight + 1).arg(nameText(models.front()))
                            : tr("□ missed %1, by %2 models").arg(o.highlight + 1).arg(models.size());
}

QString SceneTreeModel::detailOf(const SceneObject& o) const {
  const Scene& scene = *document_.scene();
  const auto inspection = document_.inspection();
  switch (o.kind) {
    case Kind::Surface: {
      const auto found = scene.surfaces.find(o.key);
      if (found == scene.surfaces.end()) return tr("per frame");
      return toQString(found->second.shape());
    }
    case Kind::Camera: return roleName(document_.role(o.frame));
    case Kind::Highlight: return nameText(o.light);
    case Kind::Light: {
      const auto estimated = inspection && std::any_of(inspection->lights.begin(), inspection->lights.end(),
                                                       [&](const auto& l) { return l.first.light == o.key && l.second; });
      const auto known = std::any_of(scene.lights.begin(), scene.lights.end(), [&](const TrueLight& l) { return l.id == o.key; });
      return estimated ? tr("estimated") : known ? tr("truth only") : QString();
    }
    case Kind::Ellipsoid: {
      const ModelResult::Fit* const shown = fitOf(o);
      if (!shown) return {};
      if (!shown->fit) return tr("no fit");
      const EllipsoidFit* const fitted = shown->fit->as<EllipsoidFit>();
      return fitted ? QString::fromLatin1(describe(fitted->quadric)) : tr("no ellipsoid");
    }
  }
  return {};
}

const ModelResult::Fit* SceneTreeModel::fitOf(const SceneObject& o) const {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection || !inspection->models.count(o.key)) return nullptr;
  const std::string here = surfaceKeyOf(document_.scene()->frames[std::size_t(document_.selection().frame)]);
  const ModelResult::Fit* shown = nullptr;
  for (const ModelResult::Fit& fit : inspection->models.at(o.key).fits)
    if (fit.light == o.light && (!shown || (fit.surface && *fit.surface == here))) shown = &fit;
  return shown;
}

QString SceneTreeModel::tipOf(const SceneObject& o, int column) const {
  if (column == Detail && o.kind == Kind::Camera)
    return document_.role(o.frame) == FrameRole::Excluded ? tr("Click to restore its previous role")
                                                          : tr("Click to exclude this frame");
  if (column == Effect && o.kind == Kind::Camera && effects_.count(o.frame))
    return tr("Influence on %1: %2 %. Positive: the frame helps; negative: the model is better without it")
        .arg(toQString(document_.plottedModel()), QString::number(effects_.at(o.frame), 'g', 3));
  if (o.kind == Kind::Highlight) return highlightTip(o);
  return column == Detail ? detailOf(o) : QString();
}

/// Whole names, which the panel may cut, and why it is so.
QString SceneTreeModel::highlightTip(const SceneObject& o) const {
  QStringList lines{tr("%1, %2").arg(nameOf(o), lightText(o.light))};
  const std::vector<std::string> models = o.predicted >= 0 ? std::vector<std::string>{o.key} : missedBy(o);
  const auto inspection = document_.inspection();
  // A depth map would have to be read for the cause, on the interface's thread.
  const bool quick = inspection && inspection->scene->frames[std::size_t(o.frame)].depth.empty();
  for (const std::string& model : models) {
    draw::Selection of;
    of.frame = o.frame;
    of.highlight = o.highlight;
    of.predicted = o.predicted;
    of.light = o.light;
    of.model = model;
    const draw::UnmatchedRow found = quick ? draw::selectedUnmatched(*inspection, of, model) : draw::UnmatchedRow();
    const QString cause = found.row ? toQString(whyUnmatched(*inspection, *found.comparison, *found.row)) : QString();
    lines << (cause.isEmpty() ? nameText(model) : tr("%1: %2").arg(nameText(model), cause));
  }
  return lines.join(QLatin1Char('\n'));
}

bool SceneTreeModel::layerShown(const Group& group) const {
  return std::any_of(group.layers.begin(), group.layers.end(),
                     [&](const char* layer) { return layerVisibleIn(document_, view_, layer); });
}

QVariant SceneTreeModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || !document_.scene()) return {};
  const std::optional<SceneObject> object = objectAt(index);
  if (!object) return groupData(groups_[std::size_t(index.row())], index.column(), role);
  const std::size_t group = index.internalId() >= kHighlightId ? kCameras : std::size_t(index.internalId() - kObjectId);
  return objectData(*object, groups_[group], index.row(), index.column(), role);
}

QVariant SceneTreeModel::groupData(const Group& group, int column, int role) const {
  const int all = int(group.objects.size());
  const int hidden =
      int(std::count_if(group.objects.begin(), group.objects.end(), [&](const auto& o) { return isHiddenIn(hidden_, o); }));
  switch (role) {
    case Qt::DisplayRole:
      if (column == Name) return group.title;
      if (column == Detail) return hidden == 0 ? QString::number(all) : tr("%1 of %2").arg(all - hidden).arg(all);
      return {};
    case Qt::CheckStateRole:
      if (column != Name || all == 0) return {};
      return hidden == 0 ? Qt::Checked : hidden == all ? Qt::Unchecked : Qt::PartiallyChecked;
    case Qt::ForegroundRole:
      if (all == 0 || !layerShown(group)) return QGuiApplication::palette().brush(QPalette::Disabled, QPalette::Text);
      return {};
    case Qt::ToolTipRole: return layerShown(group) ? QString() : tr("Hidden because their layers are off; see Layers");
    case kSortRole: return int(&group - groups_.data());
    default: return {};
  }
}

QVariant SceneTreeModel::objectData(const SceneObject& o, const Group& group, int row, int column, int role) const {
  switch (role) {
    case Qt::DisplayRole:
      if (column == Detail) return o.kind == Kind::Ellipsoid ? QString() : detailOf(o);
      if (column == Effect) {
        if (o.kind != Kind::Camera || !effects_.count(o.frame)) return {};
        const double points = effects_.at(o.frame);
        // Two digits of the largest, so that the column lines up and differences show.
        const int decimals = mostEffect_ > 0 ? std::clamp(1 - int(std::floor(std::log10(mostEffect_))), 0, 6) : 0;
        const QString text = QString::number(points, 'f', decimals);
        return points > 0 && !effectsAreErrors_ ? QLatin1Char('+') + text : text;
      }
      if (o.kind == Kind::Camera) return nameText(document_.scene()->frames[std::size_t(o.frame)].id);
      if (o.kind == Kind::Highlight) return highlightName(o);
      if (o.kind == Kind::Surface) return o.key == viz::HiddenObjects::kDepthMaps ? tr("depth maps") : nameText(o.key);
      // A model's row is one text over all columns: the names are long, and so is what the fit is.
      return o.kind == Kind::Light ? nameText(o.key) : tr("%1: %2").arg(nameOf(o), detailOf(o));
    case Qt::CheckStateRole:
      if (column != Name || o.kind == Kind::Highlight) return {};
      return isHiddenIn(hidden_, o) ? Qt::Unchecked : Qt::Checked;
    case Qt::DecorationRole:
      if (column == Detail && o.kind == Kind::Camera) return colourSwatch(toQColor(roleColour(document_.role(o.frame))));
      if (column == Name && o.kind == Kind::Ellipsoid) {
        const ModelResult::Fit* const fit = fitOf(o);
        return colourSwatch(toQColor(draw::modelColour(o.key, fit && fit->fit && !fit->fit->poor.empty())));
      }
      return {};
    case Qt::FontRole: {
      const bool shownSurface = o.kind == Kind::Surface && groups_[0].objects.size() > 1 &&
                                o.key == surfaceKeyOf(document_.scene()->frames[std::size_t(document_.selection().frame)]);
      if (column != Name || !(shownSurface || isSelected(o, document_.selection()))) return {};
      QFont bold;
      bold.setBold(true);
      return bold;
    }
    case Qt::ForegroundRole:
      if (isHiddenIn(hidden_, o) || !layerShown(group))
        return QGuiApplication::palette().brush(QPalette::Disabled, QPalette::Text);
      if (o.kind == Kind::Highlight && column == Name && (o.predicted >= 0 || !missedBy(o).empty())) return warningColour();
      return {};
    case Qt::TextAlignmentRole: return int((column == Effect ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
    case Qt::ToolTipRole: return plainTip(tipOf(o, column));
    case kSortRole:
      if (column == Effect && o.kind == Kind::Camera)
        return effects_.count(o.frame) ? QVariant(effects_.at(o.frame)) : QVariant();
      if (column == Detail && o.kind == Kind::Camera) return int(document_.role(o.frame));
      return row;
    case kFindRole:
      return nameOf(o) + QLatin1Char(' ') + detailOf(o) +
             (o.kind == Kind::Highlight ? QLatin1Char(' ') + highlightName(o) : QString());
    default: return {};
  }
}

QVariant SceneTreeModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  static const char* const titles[] = {QT_TR_NOOP("Object"), QT_TR_NOOP("Type"), QT_TR_NOOP("Influence, pp")};
  if (role == Qt::DisplayRole) return section == Effect && effectsAreErrors_ ? tr("Left out, %") : tr(titles[section]);
  if (role == Qt::ToolTipRole && section == Effect)
    return (effectsAreErrors_
                ? tr("Error of %1 on each training frame, predicted from the others, %. See the plot Influence of frames")
                : tr("Influence of each training frame on %1: increase of the held-out error without it, in percentage points. "
                     "See the plot Influence of frames"))
        .arg(toQString(document_.plottedModel()));
  return {};
}

// --- to the document --------------------------------------------------------------------------------------------------------

bool SceneTreeModel::setData(const QModelIndex& index, const QVariant& value, int role) {
  if (role != Qt::CheckStateRole || !(flags(index) & Qt::ItemIsUserCheckable)) return false;
  const bool hide = value.toInt() == Qt::Unchecked;
  viz::HiddenObjects hidden = hidden_;
  QString name;
  if (const std::optional<SceneObject> object = objectAt(index)) {
    setHiddenIn(hidden, *object, hide);
    name = nameOf(*object);
  } else {
    const Group& group = groups_[std::size_t(index.row())];
    for (const SceneObject& o : group.objects) setHiddenIn(hidden, o, hide);
    name = tr("all %1").arg(group.title.toLower());
  }
  setHiddenObjects(document_, hidden, hide ? tr("Hide %1").arg(name) : tr("Show %1").arg(name));
  return true;
}

}  // namespace glint::gui
