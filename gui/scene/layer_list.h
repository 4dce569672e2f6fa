// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QListWidget>

#include "gui/document/document.h"

namespace glint::gui {

/// The 3D picture's layers as a checklist.
class LayerList : public QListWidget {
  Q_OBJECT
 public:
  explicit LayerList(Document& document, QWidget* parent = nullptr);

 private:
  void refresh();
  Document& document_;
};

}  // namespace glint::gui
