// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>
#include <optional>

#include "core/advise/duality.h"
#include "gui/document/document.h"
#include "viz/duality_picture.h"
#include "viz/scene_view.h"

class QLabel;

namespace glint::gui {

/// Primal and dual side by side, of what is selected: the planes that touch a model's cones, and their dual points. A plane under
/// the pointer lights its point and the other way round; the arrow keys go from plane to plane and from view to view; dragging
/// turns both. What is clicked in the 3D views, and a training frame that is selected, lights its plane here.
class DualityWindow : public QDialog {
  Q_OBJECT
 public:
  explicit DualityWindow(Document& document, QWidget* parent = nullptr);
  void open() override;  ///< shows it, in front
  const Duality* duality() const { return duality_ ? &*duality_ : nullptr; }
  viz::DualityPlane lit() const { return lit_; }
  /// As painted now.
  viz::DualityPicture picture() const;
  QWidget* canvas() const;

 public slots:
  /// Lights the plane of the frame's cone that touches it nearest to what was picked.
  void showPicked(const glint::viz::Picked& picked);

 signals:
  void litChanged();  ///< what lit() or duality() says, or whether it is on screen

 protected:
  void showEvent(QShowEvent* e) override;
  void hideEvent(QHideEvent* e) override;
  void keyPressEvent(QKeyEvent* e) override;

 private:
  class Picture;
  void refresh();
  void showWords();
  void light(const viz::DualityPlane& plane);
  int viewOf(int frame) const;
  int strongView() const;

  Document& document_;
  std::optional<Duality> duality_;
  QString why_;  ///< the picture is missing
  viz::DualityPlane lit_;
  int frame_ = -1;  ///< selected when it was last filled
  double turn_ = 0, tilt_ = 0;
  Picture* picture_;
  QLabel *subject_, *words_;
};

}  // namespace glint::gui
