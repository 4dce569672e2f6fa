// SPDX-License-Identifier: BSD-3-Clause
// For people who work by keyboard, hear the window or see it badly: every control has a name, icons say what they do, pictures
// say what they show.
#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSlider>
#include <QAbstractSpinBox>
#include <QAccessible>
#include <QComboBox>
#include <QDockWidget>
#include <QHeaderView>
#include <QLineEdit>
#include <QMainWindow>
#include <QPlainTextEdit>
#include <QProgressBar>
#include <QScrollBar>
#include <QSet>
#include <QTabBar>
#include <QTextEdit>
#include <QToolButton>
#include <filesystem>
#include <memory>

#include "gui/base/text.h"
#include "gui/explain/walk_view.h"
#include "gui/export/figure_dialog.h"
#include "gui/export/folder_dialog.h"
#include "gui/export/movie_dialog.h"
#include "gui/frame/frame_canvas.h"
#include "gui/lamps/ball_window.h"
#include "gui/plots/plot_canvas.h"
#include "gui/timeline/timeline_strip.h"
#include "gui/window/main_window.h"
#include "gui/window/palette.h"
#include "gui/window/reader.h"
#include "gui/window/shortcut_dialog.h"
#include "tests/gui/fixture.h"
#include "tests/sanitizers/cases.h"

namespace glint::gui {

namespace {
QString said(const QWidget* widget, QAccessible::Text text) {
  QAccessibleInterface* interface = QAccessible::queryAccessibleInterface(const_cast<QWidget*>(widget));
  return interface ? interface->text(text).trimmed() : QString();
}

/// Parts that Qt makes, which have the name of what they are a part of.
bool isInternal(const QWidget* widget) {
  if (qobject_cast<const QScrollBar*>(widget) || qobject_cast<const QHeaderView*>(widget)) return true;
  if (widget->inherits("QTableCornerButton") || widget->inherits("QLineEditIconButton") || widget->inherits("QComboBoxListView"))
    return true;
  for (const QWidget* w = widget; w; w = w->parentWidget()) {
    if (w->objectName().startsWith(QLatin1String("qt_"))) return true;
    const QWidget* parent = w->parentWidget();
    if (qobject_cast<const QComboBox*>(parent) || qobject_cast<const QAbstractSpinBox*>(parent)) return true;
  }
  return qobject_cast<const QTabBar*>(widget) &&
         qobject_cast<const QMainWindow*>(widget->parentWidget());  // of docks: each tab has a title
}

bool isControl(const QWidget* widget) {
  return qobject_cast<const QAbstractButton*>(widget) || qobject_cast<const QComboBox*>(widget) ||
         qobject_cast<const QAbstractSpinBox*>(widget) || qobject_cast<const QLineEdit*>(widget) ||
         qobject_cast<const QAbstractSlider*>(widget) || qobject_cast<const QAbstractItemView*>(widget) ||
         qobject_cast<const QTextEdit*>(widget) || qobject_cast<const QPlainTextEdit*>(widget) ||
         qobject_cast<const QProgressBar*>(widget) || qobject_cast<const QTabBar*>(widget) ||
         (widget->focusPolicy() & Qt::TabFocus);
}

bool showsIconAlone(const QAbstractButton* button) {
  if (button->icon().isNull()) return false;
  const auto* tool = qobject_cast<const QToolButton*>(button);
  return button->text().isEmpty() || (tool && tool->toolButtonStyle() == Qt::ToolButtonIconOnly);
}

/// Words by which a widget is found again: its class, its name in the program and its panel.
QString whereIs(const QWidget* widget) {
  QStringList path{QStringLiteral("%1 '%2'").arg(QLatin1String(widget->metaObject()->className()), widget->objectName())};
  for (const QWidget* w = widget->parentWidget(); w; w = w->parentWidget())
    if (!w->objectName().isEmpty() && path.size() < 3) path << w->objectName();
  return path.join(QStringLiteral(" in "));
}

/// Faults that a walk over all widgets of a window finds.
QStringList missingIn(const QWidget& window) {
  QStringList missing;
  for (const QWidget* widget : window.findChildren<QWidget*>()) {
    if (isInternal(widget) || !isControl(widget)) continue;
    const QString name = said(widget, QAccessible::Name);
    if (name.isEmpty()) missing << whereIs(widget) + QStringLiteral(": no name");
    if (QString(name).remove(QStringLiteral("&&")).contains(QLatin1Char('&')))
      missing << whereIs(widget) + QStringLiteral(": a mnemonic in its name: ") + name;
    const auto* button = qobject_cast<const QAbstractButton*>(widget);
    if (button && showsIconAlone(button) && said(widget, QAccessible::Description).isEmpty() && button->toolTip().isEmpty())
      missing << whereIs(widget) + QStringLiteral(": an icon without a word");
  }
  missing.removeDuplicates();
  return missing;
}
}  // namespace

class AccessibilityTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() {
    const std::filesystem::path copy = copy_.path().toStdString();
    std::filesystem::copy(GLINT_SOURCE_DIR "/sessions/two-lamps", copy, std::filesystem::copy_options::recursive);
    window_ = std::make_unique<MainWindow>(coreEngine());
    window_->resize(1500, 940);
    window_->show();
    QVERIFY(QTest::qWaitForWindowExposed(window_.get()));
    atStart_ = missingIn(*window_);
    window_->open(copy_.filePath(QStringLiteral("two-lamps.glint")));
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().scene() && window_->idle() && !window_->document().stale(),
                             3 * testing_support::kWaitMs);
  }
  void cleanupTestCase() { window_.reset(); }

  void everyControlOfTheStartPageHasAName() { QVERIFY2(atStart_.isEmpty(), qPrintable("\n" + atStart_.join('\n'))); }

  /// Each dock is brought to the front, so that what is made when it is first seen is there.
  void everyControlOfTheWindowHasAName() {
    for (QDockWidget* dock : window_->findChildren<QDockWidget*>()) {
      dock->show();
      dock->raise();
      QCoreApplication::processEvents();
    }
    for (const char* on : {"frame.side-by-side", "frame.retexture", "explain.start"})
      if (QAction* action = window_->actions().find(QLatin1String(on))) action->trigger();
    QTRY_VERIFY(window_->idle());
    const QStringList missing = missingIn(*window_);
    QVERIFY2(missing.isEmpty(), qPrintable("\n" + missing.join('\n')));
  }

  /// Each widget that takes the keyboard shows it: more of its pixels change than a text cursor has.
  void everyStopOfTheKeyboardIsSeen() {
    QApplication::setActiveWindow(window_.get());
    QTRY_COMPARE(QApplication::activeWindow(), static_cast<QWidget*>(window_.get()));
    window_->setAttribute(Qt::WA_KeyboardFocusChange);  // as the Tab key sets it
    QSet<QWidget*> seen;
    QStringList unseen;
    QList<QWidget*> places{window_.get()};
    for (QDockWidget* dock : window_->findChildren<QDockWidget*>()) places << dock;
    for (QWidget* place : places) {
      if (auto* dock = qobject_cast<QDockWidget*>(place)) {
        dock->show();
        dock->raise();
      }
      QTRY_VERIFY(window_->idle());
      for (QWidget* w : place->findChildren<QWidget*>()) {
        if (seen.contains(w) || !(w->focusPolicy() & Qt::TabFocus) || w->focusProxy() || !w->isVisible() || !w->isEnabled() ||
            w->window() != window_.get() || w->size().isEmpty() || w->visibleRegion().isEmpty())
          continue;
        seen.insert(w);
        window_->setFocus(Qt::OtherFocusReason);
        const QImage before = w->grab().toImage();
        w->setFocus(Qt::TabFocusReason);
        if (!w->hasFocus()) {
          unseen << whereIs(w) + QStringLiteral(": takes no focus");
          continue;
        }
        const QImage after = w->grab().toImage();
        int changed = 0;
        for (int y = 0; y < std::min(before.height(), after.height()); ++y)
          for (int x = 0; x < std::min(before.width(), after.width()); ++x) changed += before.pixel(x, y) != after.pixel(x, y);
        if (changed < (w->width() + w->height()) / 2)
          unseen << whereIs(w) + QStringLiteral(": %1 px of %2 x %3").arg(changed).arg(w->width()).arg(w->height());
      }
    }
    QVERIFY2(seen.size() > 60, qPrintable(QString::number(seen.size())));
    QVERIFY2(unseen.isEmpty(), qPrintable(QStringLiteral("of %1\n").arg(seen.size()) + unseen.join('\n')));
  }

  void everyControlOfADialogHasAName() {
    std::vector<std::unique_ptr<QWidget>> dialogs;
    dialogs.push_back(
        std::make_unique<FigureDialog>(QStringLiteral("Figure"), QStringLiteral("figure"), QSize(640, 480), nullptr));
    dialogs.push_back(std::make_unique<MovieDialog>(MovieOf::Turntable, 12, true, nullptr));
    dialogs.push_back(std::make_unique<FolderDialog>(QStringLiteral("Folder"), QStringLiteral("What"), QStringLiteral("f"),
                                                     QStringLiteral("Write"), nullptr));
    dialogs.push_back(std::make_unique<ShortcutDialog>(window_->actions()));
    dialogs.push_back(std::make_unique<Reader>());
    dialogs.push_back(std::make_unique<BallWindow>(coreEngine()));
    for (const auto& dialog : dialogs) {
      const QStringList missing = missingIn(*dialog);
      QVERIFY2(missing.isEmpty(), qPrintable(QLatin1String(dialog->metaObject()->className()) + "\n" + missing.join('\n')));
    }
  }

  void everyActionSaysWhatItIs() {
    QStringList missing;
    for (const QAction* action : window_->actions().all())
      if (Actions::title(action).trimmed().isEmpty() || action->toolTip().isEmpty()) missing << Actions::id(action);
    QVERIFY2(missing.isEmpty(), qPrintable(missing.join('\n')));
  }

  void picturesSayWhatTheyShow() {
    QList<QWidget*> pictures;
    for (FrameCanvas* canvas : window_->findChildren<FrameCanvas*>()) pictures << canvas;
    for (PlotCanvas* canvas : window_->findChildren<PlotCanvas*>()) pictures << canvas;
    pictures << window_->findChildren<QWidget*>(QStringLiteral("sceneView")) << window_->findChild<TimelineStrip*>();
    QVERIFY(pictures.size() >= 5);
    for (QWidget* picture : pictures) {
      QVERIFY2(!said(picture, QAccessible::Name).isEmpty(), qPrintable(whereIs(picture)));
      QVERIFY2(!said(picture, QAccessible::Description).isEmpty(), qPrintable(whereIs(picture)));
    }
    const QString scene = said(window_->findChild<QWidget*>(QStringLiteral("sceneView")), QAccessible::Description);
    QVERIFY2(scene.contains("12 cameras") && scene.contains("limit-angle"), qPrintable(scene));
    window_->document().selectFrame(0);
    QTRY_VERIFY2(
        said(window_->findChild<QWidget*>(QStringLiteral("frameCanvas")), QAccessible::Description).contains("limit-angle"),
        "the errors that stand below the photograph");
  }

  /// The timeline is read frame by frame, and each frame can be chosen without a mouse or an eye.
  void framesOfTheTimelineAreItsChildren() {
    auto* strip = window_->findChild<TimelineStrip*>();
    QAccessibleInterface* list = QAccessible::queryAccessibleInterface(strip);
    QVERIFY(list);
    QCOMPARE(list->role(), QAccessible::List);
    QCOMPARE(list->childCount(), 12);
    window_->document().selectFrame(3);
    QAccessibleInterface* frame = list->child(7);
    QVERIFY(frame && frame->isValid());
    QCOMPARE(frame->text(QAccessible::Name), QStringLiteral("Frame 0007, held out"));
    QVERIFY2(frame->text(QAccessible::Description).contains("limit-angle"), qPrintable(frame->text(QAccessible::Description)));
    QVERIFY(!frame->state().selected && list->child(3)->state().selected);
    QCOMPARE(list->indexOfChild(frame), 7);
    QCOMPARE(frame->parent(), list);
    QCOMPARE(list->child(7), frame);
    const QRect at = frame->rect();
    QVERIFY(!at.isEmpty());
    QCOMPARE(list->childAt(at.center().x(), at.center().y()), frame);
    QVERIFY(!list->child(12) && !list->child(-1));
    frame->actionInterface()->doAction(QAccessibleActionInterface::pressAction());
    QCOMPARE(window_->document().selection().frame, 7);
    QVERIFY(frame->state().selected);
  }

 private:
  QTemporaryDir copy_;
  QStringList atStart_;
  std::unique_ptr<MainWindow> window_;
};

QObject* makeAccessibilityTest() { return new AccessibilityTest; }

}  // namespace glint::gui

#include "accessibility_test.moc"
