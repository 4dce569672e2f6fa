// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QColor>
#include <QList>
#include <QWidget>

#include "core/draw/epipolar_overlay.h"
#include "gui/base/actions.h"
#include "gui/document/document.h"

class QComboBox;
class QLabel;

namespace glint::gui {

/// Which frame is beside the selected one, and the tangent epipolar lines of the pair. Options "frame/side-by-side",
/// "frame/second" (number of a frame), "frame/epipolar" (off, real, virtual, both), "frame/epipolar-ellipse" (observed,
/// canonical).
class PairBar : public QWidget {
  Q_OBJECT
 public:
  explicit PairBar(Document& document, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);

  bool on() const;
  int secondFrame() const;
  /// Adds the lines to both overlays and shows by how much they miss.
  void addLines(draw::FrameOverlay& first, draw::FrameOverlay& second);
  /// A kind of line that is drawn: its colour, and whose it is with what it misses by.
  struct KeyEntry {
    QColor colour;
    QString text;
  };
  /// Empty without lines.
  const QList<KeyEntry>& key() const { return key_; }
  /// The key as a label; the owner of the bar places it where it does not scroll. Hidden without lines.
  QLabel* sentence() const { return miss_; }

 private:
  void refresh();
  void swap();

  Document& document_;
  QComboBox *second_, *lines_, *ellipse_;
  QLabel* miss_;
  QList<KeyEntry> key_;
  QAction* toggle_ = nullptr;
};

}  // namespace glint::gui
