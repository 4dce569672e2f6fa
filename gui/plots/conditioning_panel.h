// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QAbstractButton>
#include <QWidget>
#include <map>
#include <string>
#include <vector>

#include "core/advise/conditioning.h"
#include "gui/document/document.h"

class QGridLayout;
class QLabel;
class QTabBar;

namespace glint::gui {

/// A coloured chip: a value with its verdict as colour and as a sign, which works without the colour.
class Chip : public QAbstractButton {
  Q_OBJECT
 public:
  Chip(Verdict verdict, const QString& text, QWidget* parent = nullptr);
  Verdict verdict() const { return verdict_; }
  void show(Verdict verdict, const QString& text);
  /// "%" or "px" after a space; "" = none.
  QString unit() const;
  /// The chips show no unit if the row's name has it.
  void setUnitShown(bool shown);
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;
  /// What is written: always the sign; of a number as many digits as there is room for; its unit unless the row's name has that.
  QString shown() const;

 signals:
  void entered();

 protected:
  void paintEvent(QPaintEvent* e) override;
  void enterEvent(QEvent* e) override;

 private:
  Verdict verdict_;
  bool unitShown_ = true;
};

/// The conditioning strip of one light (tabs choose where there are several, and say how each one is): one column per model, one
/// row per quantity, the held-out errors of the selected model, the reason in words below (of the chip under the mouse, else the
/// worst of the model that is selected). Follows every inspection. A click selects the chip's model.
class ConditioningPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ConditioningPanel(Document& document, QWidget* parent = nullptr);
  /// The chip of a model and quantity ("gap"), null without one.
  Chip* chip(const std::string& model, const std::string& finding) const;
  QString reason() const;

 protected:
  void showEvent(QShowEvent* e) override;

 private:
  void refresh();
  /// The selected frame's surface where each has its own fits; else "".
  std::string surfaceKey(const Inspection* inspection) const;
  void build();
  Chip* newChip(int conditioning, int finding);
  /// A row across all columns: how good the selected model predicts.
  void addPrediction(QGridLayout& grid, int row, int columns);
  void showPrediction();
  void showLights();
  /// Shows the columns of this light, if there are any.
  void follow(const std::string& light);
  /// A row's name has the unit of its chips, at any width and whatever the numbers are, so that it does not
  /// move.
  void placeUnit(int row);
  void explain(const Conditioning& c, const Finding& f);
  void explainWorst();

  struct Shown {
    Chip* chip;
    int conditioning;
    int finding;
    int row;  ///< of kRows
  };
  Document& document_;
  QTabBar* lights_;
  bool filling_ = false;  ///< the tabs are being changed by the panel itself
  std::string light_;     ///< id of the one shown
  QWidget* table_ = nullptr;
  std::string tableKey_;  ///< models and quantities that the table was built for
  std::map<int, QLabel*> titles_;
  QLabel* prediction_ = nullptr;  ///< in table_
  QLabel* reason_;
  QLabel* empty_;
  std::vector<Conditioning> conditioning_;
  std::vector<Shown> chips_;
  std::string surface_;  ///< key of the selected frame's surface, where every surface has its own models
  bool dirty_ = true;
};

}  // namespace glint::gui
