// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QScrollArea>
#include <QStringList>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/fits.h"
#include "core/pipeline/what_if_knobs.h"
#include "gui/document/document.h"

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QToolButton;

namespace glint::gui {

/// Highlights of the selected frame that there are knobs for, of the newest results: those before edits by hand, then those that
/// were made by hand. Each with what edits did to it, "" = nothing.
QStringList highlightsToMove(const Document& document);
/// One step of undo; equal positive gestures merge. @param value  in the unit of the knob.
void turnKnob(Document& document, const WhatIfKnob& knob, double value, int gesture = 0);

/// What if the light, the surface, a camera or a contour were another: one row per knob of `whatIfKnobs`, every change one step
/// of undo, the results follow. A synthesis starts from the lobe that was fitted on the scene as captured, where there is one.
/// Object names for tests: "slider:KEY", "value:KEY", "reset:KEY", "whatif.synthesise", "whatif.lobe", "whatif.origin".
class WhatIfPanel : public QScrollArea {
  Q_OBJECT
 public:
  explicit WhatIfPanel(Document& document, QWidget* parent = nullptr);
  /// Scrolls to the knob of this key, "synthesise" or "lobe", and gives it the keyboard. If the knob needs synthesised contours
  /// and they are off, the switch that makes them gets the keyboard. False for an unknown key.
  bool showKnob(const std::string& key);

 private:
  struct Row {
    WhatIfKnob knob;
    std::function<void(double)> show;
    std::vector<QWidget*> widgets;
    QToolButton* reset;
  };
  void rebuild();  ///< another frame has other knobs
  void refresh();
  void addRow(const WhatIfKnob& knob, QGridLayout* grid, int row);
  void rememberLobe();
  WhatIf started(WhatIf w, bool synthesise) const;  ///< with the lobe to start from, or without it again
  QString origin(const WhatIf& w) const;

  Document& document_;
  QCheckBox* synthesise_;
  QComboBox* lobe_;
  QLabel *summary_, *origin_;
  QToolButton* resetAll_;
  QWidget* knobs_ = nullptr;
  std::vector<Row> rows_;
  const Scene* builtFor_ = nullptr;
  int builtFrame_ = -1;
  QStringList builtHighlights_;
  double builtRoughness_ = 0;
  std::optional<FittedLobe> fitted_;  ///< on the scene as captured; stays while its contours are synthesised
  std::string whyNotFitted_;          ///< "" before the first results
};

}  // namespace glint::gui
