// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QApplication>
#include <QDockWidget>

#include "gui/base/text.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

/// What tests of the whole window do with the window.
struct WindowFixture {
  static void show(MainWindow& window) {
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
  }
  /// The window with its scene, the docks of the layout for debugging, and the keyboard.
  void openActive(MainWindow& window) {
    show(window);
    openAndWait(window);
    window.applyLayout(QStringLiteral("debug"));
    QApplication::setActiveWindow(&window);
    QTRY_COMPARE(QApplication::activeWindow(), static_cast<QWidget*>(&window));
  }
  /// The docks that are on screen, without those behind another tab.
  static QList<QDockWidget*> seen(const MainWindow& window) {
    QList<QDockWidget*> docks;
    for (QDockWidget* dock : window.findChildren<QDockWidget*>())
      if (dock->isVisible() && !dock->visibleRegion().isEmpty()) docks << dock;
    return docks;
  }
  void openAndWait(MainWindow& window) {
    window.open(toQString(fixture_.opened().path));
    QTRY_VERIFY(window.document().scene() != nullptr);
    QTRY_VERIFY(window.idle() && window.document().inspection() != nullptr);
  }
  Fixture fixture_;
};

}  // namespace glint::gui
