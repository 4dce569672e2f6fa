// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QMap>
#include <QString>
#include <QStringList>

namespace glint::gui {

/// What resources/explain/steps.json says of one step.
struct ExplainText {
  QString id, title, text, equation, section;
  QStringList layers;       ///< of the scene, that show it
  QStringList frameLayers;  ///< "frame/NAME"
  QString look;             ///< what of the scene is to be seen, see ScenePanel::look
};

struct ExplainTexts {
  QList<ExplainText> steps;       ///< in their order
  QMap<QString, QString> broken;  ///< sentences by the id of the assumption
};
/// Read once from the program's resources.
const ExplainTexts& explainTexts();

}  // namespace glint::gui
