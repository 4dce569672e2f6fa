// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/layouts.h"

#include <QObject>

namespace glint::gui {

const QList<Layout>& layouts() {
  static const QList<Layout> all = {
      {"debug",
       QT_TRANSLATE_NOOP("Layout", "Debug"),
       {"setup", "layers", "parameters", "conditioning", "numbers", "timeline", "errors", "plots"},
       50},
      {"compare", QT_TRANSLATE_NOOP("Layout", "Compare"), {"setup", "timeline", "errors", "plots"}, 35, {"ladder"}},
      {"explain", QT_TRANSLATE_NOOP("Layout", "Explain"), {"explain", "timeline"}, 55, {"explain"}},
      {"present", QT_TRANSLATE_NOOP("Layout", "Present"), {"timeline"}, 55}};
  return all;
}

QStringList layoutNames() {
  QStringList names;
  for (const Layout& layout : layouts()) names << QLatin1String(layout.name);
  return names;
}

const Layout& layoutByName(const QString& name) {
  for (const Layout& layout : layouts())
    if (name == QLatin1String(layout.name)) return layout;
  return layouts().front();
}

}  // namespace glint::gui
