// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QListWidget>
#include <QWidget>

#include "gui/document/document.h"

class QCheckBox;

namespace glint::gui {

/// The 3D picture's layers as a checklist: those of all views, or of the active view where it has its own.
class LayerList : public QListWidget {
  Q_OBJECT
 public:
  explicit LayerList(Document& document, QWidget* parent = nullptr);

 public slots:
  void setActiveView(int view);

 private:
  void refresh();
  Document& document_;
  int view_ = 0;
};

/// The checklist. With several views it names its view, and whether that has layers of its own.
class LayerPanel : public QWidget {
  Q_OBJECT
 public:
  explicit LayerPanel(Document& document, QWidget* parent = nullptr);

 public slots:
  void setActiveView(int view);

 private:
  void refresh();
  Document& document_;
  QCheckBox* own_;
  LayerList* list_;
  int view_ = 0;
};

}  // namespace glint::gui
