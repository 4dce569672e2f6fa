// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/allowed_folders.h"

#include <QFileInfo>
#include <QSettings>

namespace glint::gui {

namespace {
const QString kAllowedKey = QStringLiteral("allowed-folders");  // "FILE\nFOLDER"
constexpr int kMostAllowed = 500;

QString realFile(const QString& path) {
  const QFileInfo info(path);
  return info.exists() ? info.canonicalFilePath() : info.absoluteFilePath();
}
}  // namespace

QStringList allowedFolders(const QString& file) {
  QStringList folders;
  const QString start = realFile(file) + QLatin1Char('\n');
  for (const QString& entry : QSettings().value(kAllowedKey).toStringList())
    if (entry.startsWith(start)) folders << entry.mid(start.size());
  return folders;
}

void allowFolder(const QString& file, const QString& folder) {
  QSettings settings;
  QStringList all = settings.value(kAllowedKey).toStringList();
  const QString entry = realFile(file) + QLatin1Char('\n') + folder;
  all.removeAll(entry);
  all.prepend(entry);
  settings.setValue(kAllowedKey, QStringList(all.mid(0, kMostAllowed)));
}

std::string withoutFlags(const OutsidePath& refused) {
  const std::string words = refused.what();
  return words.substr(0, words.rfind(" (--"));
}

}  // namespace glint::gui
