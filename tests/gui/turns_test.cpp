// SPDX-License-Identifier: BSD-3-Clause
// What keeps the interface from standing still: views that draw one after the other, computation that goes behind it.
#include <vtkCallbackCommand.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <QTest>
#include <QTimer>
#include <memory>

#ifdef __linux__
#include <sys/resource.h>
#endif

#include "gui/base/draw_turns.h"
#include "gui/base/latest_job.h"
#include "gui/base/vtk_canvas.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class TurnsTest : public QObject {
  Q_OBJECT
 private slots:
  void whatTheUserDoesComesBetweenTwoDrawings() {
    QObject a, b;
    QStringList order;
    drawInTurn(&a, [&] {
      order << QStringLiteral("a");
      QTimer::singleShot(0, &a, [&] { order << QStringLiteral("event"); });
    });
    drawInTurn(&b, [&] { order << QStringLiteral("b"); });
    QVERIFY(order.isEmpty() && drawingsWait());
    QTRY_VERIFY(!drawingsWait());
    QCOMPARE(order, QStringList({"a", "event", "b"}));
  }

  void whoAsksAgainDrawsOnceAndTheLast() {
    QObject a;
    QStringList order;
    for (const char* name : {"first", "second"}) drawInTurn(&a, [&order, name] { order << QString::fromLatin1(name); });
    QTRY_VERIFY(!drawingsWait());
    QCOMPARE(order, QStringList({"second"}));
    // Asked while it draws: it comes again.
    drawInTurn(&a, [&] {
      order << QStringLiteral("third");
      drawInTurn(&a, [&] { order << QStringLiteral("fourth"); });
    });
    QTRY_VERIFY(!drawingsWait());
    QCOMPARE(order, QStringList({"second", "third", "fourth"}));
  }

  void whatIsDeletedLosesItsTurn() {
    auto a = std::make_unique<QObject>();
    QObject b;
    bool drawn = false, other = false;
    drawInTurn(a.get(), [&] { drawn = true; });
    a.reset();
    QVERIFY(!drawingsWait());
    drawInTurn(&b, [&] { other = true; });
    QTRY_VERIFY(other);
    QVERIFY(!drawn);
  }

  /// On screen a canvas in a new size waits for its turn; a grab gets the new picture at once.
  void aCanvasInANewSizeDrawsInItsTurn() {
    VtkCanvas canvas;
    vtkNew<vtkRenderer> renderer;
    renderer->SetBackground(1, 0, 0);
    canvas.renderWindow()->AddRenderer(renderer);
    canvas.resize(120, 80);
    canvas.show();
    QVERIFY(QTest::qWaitForWindowExposed(&canvas));
    QTRY_VERIFY(!drawingsWait());
    int drawings = 0;
    vtkNew<vtkCallbackCommand> count;
    count->SetClientData(&drawings);
    count->SetCallback([](vtkObject*, unsigned long, void* n, void*) { ++*static_cast<int*>(n); });
    canvas.renderWindow()->AddObserver(vtkCommand::EndEvent, count);
    canvas.resize(160, 100);
    canvas.repaint();
    QCOMPARE(drawings, 0);
    QVERIFY(drawingsWait());
    QTRY_VERIFY(!drawingsWait());
    QCOMPARE(drawings, 1);
    QCOMPARE(canvas.renderWindow()->GetSize()[0], qRound(160 * canvas.devicePixelRatioF()));
    canvas.repaint();  // the same size: the same picture
    QVERIFY(!drawingsWait());
    canvas.resize(90, 100);
    QCOMPARE(canvas.grab().toImage().pixelColor(5, 5), QColor(255, 0, 0));
    QCOMPARE(drawings, 2);
    canvas.renderWindow()->RemoveObserver(count);
  }

#ifdef __linux__
  void computationGoesBehindTheInterface() {
    LatestJob job;
    int there = 0;
    const int here = getpriority(PRIO_PROCESS, 0);
    job.run([&there] {
      there = getpriority(PRIO_PROCESS, 0);
      return LatestJob::Deliver();
    });
    QTRY_VERIFY(!job.busy());
    QCOMPARE(getpriority(PRIO_PROCESS, 0), here);
    if (here >= 10) QSKIP("the tests themselves run behind everything else");
    QVERIFY2(there > here, qPrintable(QString::number(there)));
  }
#endif
};

QObject* makeTurnsTest() { return new TurnsTest; }

}  // namespace glint::gui

#include "turns_test.moc"
