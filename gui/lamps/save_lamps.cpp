// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/save_lamps.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QRegularExpression>

#include "core/base/atomic_file.h"
#include "core/report/measured_lamps.h"

namespace glint::gui {

QString saveLamps(QWidget* window, const LampsReport& report, const QString& folder,
                  const std::vector<std::filesystem::path>& inputs) {
  QString filter;
  QString file =
      QFileDialog::getSaveFileName(window, QObject::tr("Save lamps"), QDir(folder).filePath(QStringLiteral("lamps.json")),
                                   QObject::tr("Lamps (*.json);;Tables (*.csv);;Light positions for RTI (*.lp)"), &filter);
  if (file.isEmpty()) return {};
  if (QFileInfo(file).suffix().isEmpty()) file += QRegularExpression(QStringLiteral("\\*(\\.\\w+)")).match(filter).captured(1);
  const std::string path = file.toStdString();
  Outputs(inputs).file(path, "lamps", lampsKind(path, "lamps"));
  atomicWrite(path, lampsText(report, path));
  return file;
}

}  // namespace glint::gui
