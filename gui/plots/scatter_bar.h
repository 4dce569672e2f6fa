// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QWidget>

#include "core/draw/scatter_plot.h"
#include "gui/document/document.h"

class QAction;
class QComboBox;
class QMenu;

namespace glint::gui {

/// Which two columns a scatter plot shows, what its colours mean, and which axes are logarithmic: options of the view, with undo.
class ScatterBar : public QWidget {
  Q_OBJECT
 public:
  /// @param prefix  of its options: "plots/scatter-"
  ScatterBar(Document& document, const char* prefix, QWidget* parent = nullptr);
  /// With what is brushed.
  draw::ScatterOptions options() const;
  /// Its boxes show what the options say.
  void showOptions();

 private:
  QComboBox* column(const char* name, const QString& title, RowValue otherwise);
  QAction* logarithm(QMenu* menu, const char* name, const QString& title);
  std::string key(const char* name) const { return prefix_ + name; }
  RowValue value(const char* name, RowValue otherwise) const;
  bool isLog(const char* name) const { return document_.option(key(name), std::string("off")) == "on"; }

  Document& document_;
  std::string prefix_;
  QComboBox *x_, *y_;
  QAction *logX_, *logY_;
  QList<QAction*> colours_;  ///< in the order of scatterColours()
};

}  // namespace glint::gui
