// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/own_files.h"

#include <QCoreApplication>
#include <QDir>
#include <QFileInfo>
#include <QStandardPaths>
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/permitted.h"
#include "core/base/sha256.h"
#include "core/scene/scene_files.h"
#include "gui/document/document.h"

namespace glint::gui {

namespace fs = std::filesystem;

namespace {
constexpr int kFoldersAbove = 4;  // the program lies that deep in its source tree's build folder at most

QString ownFolder(const char* name) {
  return QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + QLatin1Char('/') + QLatin1String(name);
}

std::vector<fs::path> shippedFolders() {
  std::vector<fs::path> folders;
  if (const QString lessons = qEnvironmentVariable("GLINT_LESSONS"); !lessons.isEmpty())
    folders.emplace_back(lessons.toStdString());
  QDir at(QCoreApplication::applicationDirPath());
  folders.emplace_back(at.filePath(QStringLiteral("../share/glint")).toStdString());
  for (int up = 0; up < kFoldersAbove; ++up, at.cdUp())
    if (at.exists(QStringLiteral("sessions/lessons")))
      folders.emplace_back(at.filePath(QStringLiteral("sessions")).toStdString());
  return folders;
}
}  // namespace

QString recoveryFolder() { return ownFolder("recovery"); }
QString locksFolder() { return ownFolder("locks"); }

bool isOwnRecovery(const QString& file) {
  // The file itself, not where a link in the folder leads.
  return realPath(QFileInfo(file).absolutePath().toStdString()) == realPath(recoveryFolder().toStdString());
}

bool isShipped(const QString& file) { return !file.isEmpty() && liesIn(shippedFolders(), file.toStdString()); }

bool isOpenLesson(const Document& document) {
  return !document.option("explain/lesson", std::string()).empty() && isShipped(document.sessionFile());
}

std::vector<fs::path> filesOfInput(const Document& document) {
  if (!document.scene()) return {};
  std::vector<fs::path> inputs = filesOf(*document.scene());
  for (const QString& path : {document.inputFile(), document.sessionFile()})
    if (!path.isEmpty()) inputs.emplace_back(path.toStdString());
  return inputs;
}

bool isOfInput(const Document& document, const QString& file) {
  const std::vector<fs::path> inputs = filesOfInput(document);
  const fs::path wanted = file.toStdString();
  return std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) {
    std::error_code ignored;  // what is missing is no input
    return fs::equivalent(input, wanted, ignored);
  });
}

std::string stampOf(const QString& file) {
  try {
    return sha256OfFile(file.toStdString());
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace glint::gui
