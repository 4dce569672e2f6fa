// SPDX-License-Identifier: BSD-3-Clause
#pragma once

class QMenu;

namespace glint::gui {

class Actions;
class Document;
class SceneViews;

/// "Top, front, side and perspective": four views with cameras of their own, three along the axes and without perspective, the
/// fourth as the active view was. One step of undo.
void addAxisViews(Actions& actions, QMenu* menu, Document& document, SceneViews& views);

}  // namespace glint::gui
