// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <QStringList>

namespace glint::gui {

/// Named arrangements of the window. A layout says which docks are shown and how the two views share the middle.
struct Layout {
  const char* name;
  const char* title;
  QStringList docks;       ///< object names of the docks that are visible
  int sceneShare;          ///< of 100, the rest is the frame view's
  QStringList front = {};  ///< docks that come before their tabs, beside errors, layers and parameters
};

const QList<Layout>& layouts();
QStringList layoutNames();
const Layout& layoutByName(const QString& name);  ///< the first one for an unknown name

}  // namespace glint::gui
