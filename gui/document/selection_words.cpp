// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/selection_words.h"

#include <QObject>
#include <QStringList>
#include <cmath>
#include <numbers>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
/// What was given up, where nothing was chosen.
QString givenUp(const draw::Selection& before, const draw::Selection& after) {
  if (before.model != after.model) return QObject::tr("Select all models");
  if (before.highlight != after.highlight || before.predicted != after.predicted) return QObject::tr("Deselect the highlight");
  if (before.direction != after.direction) return QObject::tr("Deselect the contour point");
  return QObject::tr("Select all lights");
}
}  // namespace

QString selectionWords(const draw::Selection& before, const draw::Selection& after, const Scene& scene) {
  const QString frame = nameText(scene.frames[std::size_t(after.frame)].id);
  const bool another = before.frame != after.frame;
  QStringList chosen;
  if (!after.model.empty() && after.model != before.model) chosen << toQString(after.model);
  // A highlight's light follows from it.
  const bool highlight = after.highlight >= 0 && (another || after.highlight != before.highlight);
  if (!after.light.empty() && after.light != before.light && !highlight) chosen << lightText(after.light);
  if (highlight) chosen << QObject::tr("highlight %1").arg(after.highlight + 1);
  const bool spurious = after.predicted >= 0 && (another || after.predicted != before.predicted);
  if (spurious) chosen << QObject::tr("spurious highlight %1").arg(after.predicted + 1);
  const bool point = after.direction && (another || after.direction != before.direction);
  if (point) chosen << QObject::tr("contour point at %1°").arg(std::lround(*after.direction * 180 / std::numbers::pi));
  if (chosen.isEmpty()) return another ? QObject::tr("Select frame %1").arg(frame) : givenUp(before, after);
  const QString what = chosen.join(QStringLiteral(", "));
  return another || highlight || spurious || point ? QObject::tr("Select %1 in frame %2").arg(what, frame)
                                                   : QObject::tr("Select %1").arg(what);
}

}  // namespace glint::gui
