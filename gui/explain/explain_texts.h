// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QMap>
#include <QString>
#include <QStringList>

#include "core/advise/explain.h"

namespace glint::gui {

/// What resources/explain/steps.json says of one step.
struct ExplainText {
  struct Words {
    QString text, equation;
  };
  struct Shown {
    QStringList layers, frameLayers;
  };
  QString id, title, text, equation, section;
  QStringList layers;             ///< of the scene, that show it
  QStringList frameLayers;        ///< "frame/NAME"
  QString look;                   ///< which part of the scene to show, see ScenePanel::look
  bool solo = false;              ///< of the selected frame alone: what belongs to the others would lie over it
  bool epipolar = false;          ///< with the epipolar lines of two frames side by side, which are no other step's geometry
  QMap<QString, Words> ofModels;  ///< where a model does something else: by its id, "" = as for the others
  /// @param model  "" = none. For models that no step has words for: what it assumes, where others have words of their own.
  Words words(const QString& model) const;
  QMap<QString, Shown> shownOfModels;  ///< where the picture of a model has other parts: by its id
  /// What the step shows when that model is explained.
  Shown shown(const QString& model) const { return shownOfModels.value(model, {layers, frameLayers}); }
};

struct ExplainTexts {
  QList<ExplainText> steps;       ///< in their order
  QMap<QString, QString> broken;  ///< sentences by the id of the assumption
};
/// Read once from the program's resources.
const ExplainTexts& explainTexts();

/// The values of a number with its unit, as HTML without a break: what is smaller than counts is "0 within rounding", short
/// lengths are in mm, and no digit is beyond what counts.
QString valuesHtml(const ExplainNumber& number);

}  // namespace glint::gui
