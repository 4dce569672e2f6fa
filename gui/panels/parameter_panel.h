// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QScrollArea>
#include <functional>
#include <vector>

#include "gui/document/document.h"

class QGridLayout;
class QLabel;
class QToolButton;

namespace glint::gui {

/// One row per setting of `allParams()`, grouped by stage; nothing here knows a single setting.
/// Object names for tests and scripts: "slider:KEY", "value:KEY", "reset:KEY".
class ParameterPanel : public QScrollArea {
  Q_OBJECT
 public:
  explicit ParameterPanel(Document& document, QWidget* parent = nullptr);

  /// Scrolls to a parameter's row and gives it the keyboard. False for an unknown key.
  bool showParameter(const std::string& key);

 private:
  struct Row {
    std::string key;
    std::function<void()> refresh;  ///< shows the document's value
    QToolButton* reset;
  };
  void addNumber(const ParamSpec& spec, QGridLayout* grid, int row);
  void addChoice(const ParamSpec& spec, QGridLayout* grid, int row);
  void addFlag(const ParamSpec& spec, QGridLayout* grid, int row);
  void addRow(const ParamSpec& spec, QGridLayout* grid, int row, std::function<void()> refresh);
  void refresh();

  Document& document_;
  QLabel* hint_ = nullptr;
  std::vector<Row> rows_;
};

}  // namespace glint::gui
