// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QPoint>
#include <QSet>
#include <QTimer>
#include <memory>
#include <vector>

#include "viz/lit_parts.h"

namespace glint::gui {

class DualityWindow;
class EquationBrowser;
class SceneViews;

/// Joins a text's symbols with the 3D views: what the user points at in either lights up in both. Also the plane that is lit in
/// the window of primal and dual, which touches its cone in 3D; and back, what is clicked in 3D lights its plane there.
class SymbolLinks : public QObject {
  Q_OBJECT
 public:
  SymbolLinks(EquationBrowser& text, SceneViews& views, QObject* parent);
  void follow(DualityWindow& duality);
  /// What is lit in the first view.
  const viz::LitParts& lit() const { return *lit_.front(); }
  /// Lights the symbols of what is drawn at a place of the widget of the views, and that.
  void pointAt(const QPoint& place);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void light(const QSet<QString>& symbols);
  void showPlane();

  EquationBrowser& text_;
  SceneViews& views_;
  DualityWindow* duality_ = nullptr;
  std::vector<std::unique_ptr<viz::LitParts>> lit_;  ///< one for each view
  QTimer rest_;                                      ///< the pointer has to rest that long
  QPoint pointer_;
};

}  // namespace glint::gui
