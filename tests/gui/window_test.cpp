// SPDX-License-Identifier: BSD-3-Clause
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkRenderer.h>

#include <QAction>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QListWidget>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QSettings>
#include <QSplitter>
#include <QStackedWidget>
#include <QTableView>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/window/layouts.h"
#include "gui/window/main_window.h"
#include "gui/window/message_bar.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class WindowTest : public QObject {
  Q_OBJECT
 private slots:
  void anEmptyWindowSaysWhatToDo() {
    MainWindow window(fixture_.engine());
    show(window);
    bool offered = false;
    for (const QPushButton* button : window.findChildren<QPushButton*>())
      offered |= button->isVisible() && button->text().contains("Open a scene");
    QVERIFY(offered);
    QVERIFY(window.idle());
    QVERIFY(!window.picture().isNull());
  }

  /// A hidden page counts for the least height of the views, and takes it from the docks below them.
  void theStartPageDoesNotKeepTheViewsHigh() {
    MainWindow window(fixture_.engine());
    auto* pages = window.centralWidget()->findChild<QStackedWidget*>();
    QVERIFY(pages);
    QVERIFY(pages->widget(0)->minimumSizeHint().height() < 200);
  }

  /// One of them anywhere makes every update of every widget a composition of the whole window by OpenGL.
  void noWidgetIsAnOpenGlWidget() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QVERIFY(!window.findChildren<VtkCanvas*>().isEmpty());
    for (const QWidget* widget : window.findChildren<QWidget*>())
      QVERIFY2(!widget->inherits("QOpenGLWidget"), widget->metaObject()->className());
  }

  void aCanvasShowsWhatVtkDraws() {
    VtkCanvas canvas;
    vtkNew<vtkRenderer> above, below;
    above->SetViewport(0, 0.5, 1, 1);
    above->SetBackground(1, 0, 0);
    below->SetViewport(0, 0, 1, 0.5);
    below->SetBackground(0, 0, 1);
    for (vtkRenderer* renderer : {above.Get(), below.Get()}) canvas.renderWindow()->AddRenderer(renderer);
    canvas.resize(120, 80);
    canvas.show();
    const auto expectHalves = [&] {
      const QImage picture = canvas.grab().toImage();
      QCOMPARE(picture.pixelColor(picture.width() / 2, 2), QColor(255, 0, 0));
      QCOMPARE(picture.pixelColor(picture.width() / 2, picture.height() - 3), QColor(0, 0, 255));
    };
    expectHalves();
    canvas.resize(61, 201);
    expectHalves();
    below->SetBackground(0, 1, 0);
    canvas.update();
    expectHalves();  // the last picture again, until VTK draws
    canvas.renderWindow()->Render();
    QCOMPARE(canvas.grab().toImage().pixelColor(30, 198), QColor(0, 255, 0));
  }

  void aSceneIsOpenedComputedAndShown() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QVERIFY(!window.document().stale());
    QCOMPARE(window.findChild<QTableView*>(QStringLiteral("errorTable"))->model()->rowCount(),
             12 * int(window.document().request().models.size()));
    QVERIFY(window.findChild<QWidget*>(QStringLiteral("sceneView"))->isVisible());
    QVERIFY(window.windowTitle().startsWith("scene.json"));
  }

  void aParameterChangesTheResultOffTheInterfaceThread() {
    Engine engine = fixture_.engine();
    QThread* interfaceThread = QThread::currentThread();
    std::atomic<bool> elsewhere{true};
    engine.inspect = [inner = engine.inspect, interfaceThread, &elsewhere](std::shared_ptr<const Scene> scene,
                                                                           const InspectionRequest& r, const ProgressFn& p,
                                                                           const Inspection* before) {
      if (QThread::currentThread() == interfaceThread) elsewhere = false;
      return inner(scene, r, p, before);
    };
    MainWindow window(engine);
    show(window);
    openAndWait(window);
    auto* box = window.findChild<QDoubleSpinBox*>(QStringLiteral("value:detect.level"));
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, "0.2");
    QTest::keyClick(box, Qt::Key_Return);
    QVERIFY(window.document().stale());
    QTRY_VERIFY(window.idle() && !window.document().stale());
    QCOMPARE(window.document().inspection()->evidence[0].highlights[0].level, 0.2);
    window.document().undoStack()->undo();
    QTRY_VERIFY(window.idle() && !window.document().stale());
    QCOMPARE(window.document().inspection()->evidence[0].highlights[0].level, 0.5);
    QVERIFY(elsewhere);
  }

  void anOwnLayoutComesBackInThisWindowAndTheNext() {
    QSettings().remove(QStringLiteral("layouts"));
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    QVERIFY(!window.actions().find("view.layout-own-2")->isEnabled());
    auto* plots = window.findChild<QDockWidget*>(QStringLiteral("plots"));
    auto* setup = window.findChild<QDockWidget*>(QStringLiteral("setup"));
    window.addDockWidget(Qt::RightDockWidgetArea, setup);
    plots->hide();
    QSplitter* views = viewsOf(window);
    views->setSizes({200, 600});
    QTest::qWait(20);
    const double share = shareOfFirst(views);
    window.actions().find("view.layout-keep-2")->trigger();
    window.applyLayout(QStringLiteral("compare"));
    views->setSizes({600, 200});
    QVERIFY(shareOfFirst(views) > share + 0.2);
    QVERIFY(plots->isVisible());
    QVERIFY(window.actions().find("view.layout-own-2")->isEnabled());
    window.actions().find("view.layout-own-2")->trigger();
    QVERIFY(!plots->isVisible() && setup->isVisible());
    QCOMPARE(window.dockWidgetArea(setup), Qt::RightDockWidgetArea);
    QTRY_VERIFY2(std::abs(shareOfFirst(views) - share) < 0.05, qPrintable(QString::number(shareOfFirst(views))));
    MainWindow next(fixture_.engine());
    show(next);
    next.actions().find("view.layout-own-2")->trigger();
    QVERIFY(next.findChild<QDockWidget*>(QStringLiteral("plots"))->isHidden());
    QSettings().remove(QStringLiteral("layouts"));
  }

  void stopLeavesTheOldResultsMarkedAsOutOfDate() {
    Engine engine = fixture_.engine();
    engine.inspect = [inner = engine.inspect](std::shared_ptr<const Scene> scene, const InspectionRequest& r, const ProgressFn& p,
                                              const Inspection* before) {
      for (int i = 0; r.settings.number("detect.level") < 0.3 && i < 6000; ++i) {
        if (!report(p, {"detect", i, 6000})) throw Stopped{};
        QThread::msleep(10);
      }
      return inner(scene, r, p, before);
    };
    MainWindow window(engine);
    show(window);
    openAndWait(window);
    const auto before = window.document().inspection();
    window.document().setSetting("detect.level", 0.2);
    auto* stop = window.findChild<QToolButton*>(QStringLiteral("stop"));
    QTRY_VERIFY(stop->isVisible());
    QTest::qWait(50);
    QTest::mouseClick(stop, Qt::LeftButton);
    QTRY_VERIFY(window.idle());
    QVERIFY(window.document().stale());
    QVERIFY(window.document().inspection() == before);
  }

  void aWrongInputIsAMessageAndKeepsWhatIsOpen() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    window.open(QStringLiteral("nowhere.json"));
    QTRY_VERIFY(window.idle());
    auto* bar = window.findChild<MessageBar*>(QStringLiteral("messageBar"));
    QVERIFY(bar->isVisible());
    QVERIFY(bar->text().contains("nowhere.json"));
    QVERIFY(window.document().scene() != nullptr);
  }

  void layersAreToggledAndUndone() {
    MainWindow window(fixture_.engine());
    show(window);
    openAndWait(window);
    auto* layers = window.findChild<QListWidget*>(QStringLiteral("layers"));
    QVERIFY(layers->count() >= 14);
    QListWidgetItem* first = layers->item(0);
    const std::string name = first->data(Qt::UserRole).toString().toStdString();
    const bool before = window.document().layerVisible(name);
    first->setCheckState(before ? Qt::Unchecked : Qt::Checked);
    QCOMPARE(window.document().layerVisible(name), !before);
    window.document().undoStack()->undo();
    QCOMPARE(first->checkState() == Qt::Checked, before);
  }

  void everyLayoutFitsTheSmallestWindow() {
    MainWindow window(fixture_.engine());
    window.resize(1100, 700);
    show(window);
    openAndWait(window);
    for (const QString& name : layoutNames()) {
      window.applyLayout(name);
      QTest::qWait(50);
      QVERIFY2(window.width() <= 1110 && window.height() <= 710,
               qPrintable(QStringLiteral("%1: %2 x %3").arg(name).arg(window.width()).arg(window.height())));
      QVERIFY(window.framePanel()->width() >= 200);
    }
  }

 private:
  /// Scene and frame beside each other.
  static QSplitter* viewsOf(MainWindow& window) { return qobject_cast<QSplitter*>(window.framePanel()->parentWidget()); }
  static double shareOfFirst(const QSplitter* views) {
    const QList<int> sizes = views->sizes();
    return double(sizes[0]) / std::max(1, sizes[0] + sizes[1]);
  }
  static void show(MainWindow& window) {
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
  }
  void openAndWait(MainWindow& window) {
    window.open(toQString(fixture_.opened().path));
    QTRY_VERIFY(window.document().scene() != nullptr);
    QTRY_VERIFY(window.idle() && window.document().inspection() != nullptr);
  }
  Fixture fixture_;
};

QObject* makeWindowTest() { return new WindowTest; }

}  // namespace glint::gui

#include "window_test.moc"
