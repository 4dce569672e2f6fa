// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>

#include "gui/document/document.h"

namespace glint::gui {

constexpr int kMostSceneViews = 4;

/// How the 3D views lie in their widget.
enum class Arrangement { One, SideBySide, Grid, Wipe };

/// What the document's options say about the 3D views ("scene/..."), with their defaults.
struct SceneOptions {
  Arrangement arrangement = Arrangement::One;
  bool linked = true;                   ///< cameras move together, one eye for all; always in a wipe
  double wipe = 0.5;                    ///< place of the line, share of the width
  bool parallel = false, solo = false;  ///< `parallel`: all views; else each its own
  double glyphScale = 1, opacity = 0.5;
  bool lampsMove = false;  ///< true lights can be dragged
  viz::CameraColours colours;
  viz::HiddenObjects hidden;
  struct View {
    viz::Eye eye = viz::Eye::Outside;
    std::set<std::string> models;  ///< empty = all
    bool parallel = false;
    std::string name;  ///< "A: dual"; "" if there is nothing to tell apart
  };
  std::array<View, kMostSceneViews> views;

  int viewCount() const;
};
SceneOptions sceneOptions(const Document& document);

/// "scene/NAME" for the first view, "scene/NAME-2" for the second.
std::string viewOption(const char* name, int view);
const char* toText(Arrangement arrangement);
const char* toText(viz::Eye eye);

/// Layers of one 3D view alone are an option "scene/layers", "scene/layers-2": the names of those that it shows. It counts while
/// there are several views.
bool hasOwnLayers(const Document& document, int view);
bool layerVisibleIn(const Document& document, int view, const std::string& layer);
/// One step of undo. @param view  one with layers of its own, else all views change.
void setLayerVisibleIn(Document& document, int view, const std::string& layer, const std::string& title, bool visible);
/// Gives a view the layers that it shows now as its own, or takes them away.
void setOwnLayers(Document& document, int view, bool own);

/// Saved 3D cameras are options "scene/view/NAME", so that saving one is a step of undo like any other.
extern const char* const kSavedView;
/// Value of the option "scene/parallel": of four views, all but the last are without perspective.
extern const char* const kAxisViews;
std::string toText(const viz::ViewPoint& view);
std::optional<viz::ViewPoint> viewPointFromText(const std::string& text);

}  // namespace glint::gui
