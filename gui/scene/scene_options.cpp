// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/scene_options.h"

#include <QStringList>
#include <algorithm>
#include <cmath>

#include "gui/base/text.h"
#include "gui/scene/hidden_objects_option.h"

namespace glint::gui {

const char* const kSavedView = "scene/view/";
const char* const kAxisViews = "axes";

namespace {
const std::string kNone;

Arrangement arrangementOf(const std::string& text) {
  for (const Arrangement a : {Arrangement::SideBySide, Arrangement::Grid, Arrangement::Wipe})
    if (text == toText(a)) return a;
  return Arrangement::One;
}

viz::Eye eyeOf(const std::string& text) {
  for (const viz::Eye e : {viz::Eye::Camera, viz::Eye::VirtualCamera})
    if (text == toText(e)) return e;
  return viz::Eye::Outside;
}

bool isOn(const Document& document, const char* name, bool otherwise) {
  return document.option(std::string(name), otherwise ? 1.0 : 0.0) != 0;
}
}  // namespace

int SceneOptions::viewCount() const {
  switch (arrangement) {
    case Arrangement::One: return 1;
    case Arrangement::SideBySide:
    case Arrangement::Wipe: return 2;
    case Arrangement::Grid: return 4;
  }
  return 1;
}

std::string viewOption(const char* name, int view) {
  return std::string("scene/") + name + (view > 0 ? "-" + std::to_string(view + 1) : std::string());
}

const char* toText(Arrangement arrangement) {
  switch (arrangement) {
    case Arrangement::One: return "1";
    case Arrangement::SideBySide: return "2";
    case Arrangement::Grid: return "4";
    case Arrangement::Wipe: return "wipe";
  }
  return "1";
}

const char* toText(viz::Eye eye) {
  switch (eye) {
    case viz::Eye::Outside: return "outside";
    case viz::Eye::Camera: return "camera";
    case viz::Eye::VirtualCamera: return "virtual";
  }
  return "outside";
}

SceneOptions sceneOptions(const Document& document) {
  SceneOptions o;
  o.arrangement = arrangementOf(document.option("scene/views", kNone));
  const bool wipe = o.arrangement == Arrangement::Wipe;
  o.linked = wipe || isOn(document, "scene/linked", true);
  o.wipe = std::clamp(document.option("scene/wipe", 0.5), 0.02, 0.98);
  const bool axes = document.option("scene/parallel", kNone) == kAxisViews && o.arrangement == Arrangement::Grid;
  o.parallel = !axes && isOn(document, "scene/parallel", false);
  o.solo = isOn(document, "scene/solo", false);
  o.glyphScale = std::clamp(document.option("scene/glyph-scale", 1.0), 0.05, 20.0);
  o.opacity = std::clamp(document.option("scene/photograph-opacity", 0.5), 0.0, 1.0);
  const std::string by = document.option("scene/colour-by", kNone);
  o.colours.by = by == "model"       ? viz::CameraColours::By::Model
                 : by == "error"     ? viz::CameraColours::By::Error
                 : by == "influence" ? viz::CameraColours::By::Influence
                                     : viz::CameraColours::By::Role;
  o.colours.model = document.selection().model;
  if (const auto influence = document.influence();
      influence && !document.influenceStale() && o.colours.by == viz::CameraColours::By::Influence) {
    o.colours.model = document.plottedModel();
    const bool probes = !influence->probes.empty();  // else it holds errors, which neither help nor harm
    for (const FrameInfluence& f : probes ? influence->frames : std::vector<FrameInfluence>{})
      if (const std::optional<double> points = influenceOf(*influence, f.frame, o.colours.model))
        o.colours.influence[f.frame] = *points;
  }
  o.hidden = hiddenObjects(document);
  o.lampsMove = document.request().whatIf.synthesise;
  const std::vector<std::string>& all = document.request().models;
  for (int i = 0; i < kMostSceneViews; ++i) {
    SceneOptions::View& view = o.views[std::size_t(i)];
    view.eye = eyeOf(document.option(viewOption("look-through", o.linked ? 0 : i), kNone));
    const std::string models = document.option(viewOption("models", i), kNone);
    if (!models.empty() && models != "all")
      view.models = {models};
    else if (models.empty() && wipe && !all.empty())
      view.models = {i == 0 ? all.front() : all.back()};  // something to compare
    view.parallel = o.parallel || (axes && i + 1 < kMostSceneViews);
    if (o.viewCount() == 1) continue;
    const std::string letter(1, char('A' + i));
    view.name = letter + (view.models.empty() ? "" : ": " + *view.models.begin());
  }
  return o;
}

namespace {
constexpr char kBetween = ' ';  // no layer's name holds one

std::set<std::string> ownLayers(const Document& document, int view) {
  const QStringList names = exactQString(document.option(viewOption("layers", view), kNone)).split(QLatin1Char(kBetween));
  std::set<std::string> layers;
  for (const QString& name : names)
    if (!name.isEmpty()) layers.insert(name.toStdString());
  return layers;
}

void setLayers(Document& document, int view, const std::set<std::string>& layers, const QString& text) {
  std::string names(1, kBetween);  // own ones even if nothing is shown
  for (const std::string& name : layers) names += name + kBetween;
  document.setOption(viewOption("layers", view), names, text);
}

QString nameOf(int view) { return QString(QLatin1Char(char('A' + view))); }
}  // namespace

bool hasOwnLayers(const Document& document, int view) {
  if (document.option(viewOption("layers", view), kNone).empty()) return false;
  return sceneOptions(document).viewCount() > 1;
}

bool layerVisibleIn(const Document& document, int view, const std::string& layer) {
  return hasOwnLayers(document, view) ? ownLayers(document, view).count(layer) > 0 : document.layerVisible(layer);
}

void setLayerVisibleIn(Document& document, int view, const std::string& layer, const std::string& title, bool visible) {
  if (!hasOwnLayers(document, view)) return document.setLayerVisible(layer, title, visible);
  std::set<std::string> layers = ownLayers(document, view);
  if (visible == (layers.count(layer) > 0)) return;
  if (visible)
    layers.insert(layer);
  else
    layers.erase(layer);
  setLayers(document, view, layers,
            (visible ? QObject::tr("Show %1 in view %2") : QObject::tr("Hide %1 in view %2"))
                .arg(toQString(title).toLower(), nameOf(view)));
}

void setOwnLayers(Document& document, int view, bool own) {
  if (own == hasOwnLayers(document, view)) return;
  if (!own)
    return document.setOption(viewOption("layers", view), std::string(), QObject::tr("View %1: shared layers").arg(nameOf(view)));
  std::set<std::string> shown;
  for (const viz::Layer& layer : viz::sceneLayers())
    if (document.layerVisible(layer.name)) shown.insert(layer.name);
  setLayers(document, view, shown, QObject::tr("View %1: own layers").arg(nameOf(view)));
}

std::string toText(const viz::ViewPoint& v) {
  QStringList numbers;
  for (const Eigen::Vector3d& p : {v.position, v.focalPoint, v.up})
    for (int i = 0; i < 3; ++i) numbers << QString::number(p[i], 'g', 17);
  numbers << QString::number(v.viewAngleDeg, 'g', 17)
          << (v.parallel ? QStringLiteral("parallel") : QStringLiteral("perspective"));
  return numbers.join(QLatin1Char(' ')).toStdString();
}

std::optional<viz::ViewPoint> viewPointFromText(const std::string& text) {
  const QStringList parts = exactQString(text).split(QLatin1Char(' '));
  if (parts.size() != 11) return {};
  std::array<double, 10> n;
  for (int i = 0; i < 10; ++i) {
    bool isNumber = false;
    n[std::size_t(i)] = parts[i].toDouble(&isNumber);
    if (!isNumber || !std::isfinite(n[std::size_t(i)])) return {};
  }
  viz::ViewPoint v{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, n[9], parts[10] == QStringLiteral("parallel")};
  if (!(v.viewAngleDeg > 0 && v.viewAngleDeg < 180) || v.position == v.focalPoint || v.up.norm() == 0) return {};
  return v;
}

}  // namespace glint::gui
