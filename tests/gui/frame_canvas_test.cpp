// SPDX-License-Identifier: BSD-3-Clause
// Overlays lie where the numbers say, at every zoom and device pixel ratio (CTest runs this class at 1 and at 2).
#include "gui/frame/frame_canvas.h"

#include <QFontMetricsF>
#include <QMouseEvent>
#include <QSignalSpy>
#include <cmath>

#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
constexpr double kTolerancePx = 0.1;  // device pixels: the promise of the frame view
constexpr double kLineX = 100.25;

QImage grabbed(FrameCanvas& canvas) { return canvas.grab().toImage().convertToFormat(QImage::Format_RGB32); }

/// Centre of mass of the pure red along one row, in device pixel coordinates where a pixel's centre is at +0.5; -1 without red
/// pixels.
double redCentre(const QImage& image, int row) {
  double sum = 0, weighted = 0;
  for (int x = 0; x < image.width(); ++x) {
    const QRgb c = image.pixel(x, row);
    const double red = std::max(0, qRed(c) - qGreen(c));
    sum += red;
    weighted += red * (x + 0.5);
  }
  return sum > 50 ? weighted / sum : -1;
}

draw::FrameOverlay verticalLine(double x) {
  draw::OverlayLine line;
  for (int y = 0; y <= 480; y += 20) line.points.push_back({x, y - 0.5});
  line.colour = {1, 0, 0};
  line.width = 2;
  draw::FrameOverlay overlay;
  overlay.lines.push_back(line);
  return overlay;
}
}  // namespace

class FrameCanvasTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    canvas_ = std::make_unique<FrameCanvas>();
    canvas_->resize(640, 480);
    QImage photograph(640, 480, QImage::Format_RGB888);
    photograph.fill(Qt::black);
    canvas_->setPhotograph(photograph);
    canvas_->fit();
    ratio_ = canvas_->devicePixelRatioF();
    const QByteArray wanted = qgetenv("QT_SCALE_FACTOR");
    if (!wanted.isEmpty()) QCOMPARE(ratio_, wanted.toDouble());
  }

  void anOverlayLiesOnItsPixel_data() {
    QTest::addColumn<double>("zoom");
    for (const double zoom : {0.5, 1.0, 2.7, 8.0, 64.0}) QTest::addRow("zoom %g", zoom) << zoom;
  }
  void anOverlayLiesOnItsPixel() {
    QFETCH(double, zoom);
    canvas_->setOverlay(verticalLine(kLineX));
    canvas_->lookAt({101.0, 240.0}, zoom);
    // Pixel 101 is in the middle of the widget (320 logical), so the line is 0.75 pixels to its left.
    const double expected = (320.0 - 0.75 * zoom) * ratio_;
    const double found = redCentre(grabbed(*canvas_), int(200 * ratio_));
    QVERIFY2(std::abs(found - expected) < kTolerancePx,
             qPrintable(QStringLiteral("found %1, expected %2").arg(found).arg(expected)));
  }

  /// Pixel (0, 0) is the centre of the top-left pixel: at zoom 1 a line through x = 0 runs half a pixel from the photograph's
  /// edge.
  void pixelZeroIsAPixelCentre() {
    canvas_->setOverlay(verticalLine(0));
    QCOMPARE(canvas_->zoom(), 1.0);  // 640 x 480 fits exactly
    // The stroke, 2 wide, is cut by the widget's edge at 0: it covers 0 .. 1.5.
    const double found = redCentre(grabbed(*canvas_), int(200 * ratio_));
    QVERIFY2(std::abs(found - 0.75 * ratio_) < kTolerancePx * ratio_, qPrintable(QString::number(found)));
  }

  /// The photograph itself is drawn under the overlay without a shift: a bright column and a line through its centre coincide.
  void thePhotographLiesUnderTheOverlay() {
    QImage photograph(640, 480, QImage::Format_RGB888);
    photograph.fill(Qt::black);
    for (int y = 0; y < 480; ++y) photograph.setPixelColor(100, y, Qt::red);
    canvas_->setPhotograph(photograph);
    for (const double zoom : {1.0, 4.0, 8.0, 31.0}) {
      canvas_->setOverlay({});
      canvas_->lookAt({103.0, 240.0}, zoom);
      const double found = redCentre(grabbed(*canvas_), int(200 * ratio_));
      const double expected = (320.0 - 3.0 * zoom) * ratio_;
      // Nearest-neighbour drawing rounds edges to device pixels.
      QVERIFY2(std::abs(found - expected) <= 0.51,
               qPrintable(QStringLiteral("zoom %1: found %2, expected %3").arg(zoom).arg(found).arg(expected)));
    }
  }

  void wheelKeepsThePixelUnderTheMouse() {
    const QPointF at(200, 150);
    const Pixel before = canvas_->pixelFromWidget(at);
    QWheelEvent wheel(at, at, {}, QPoint(0, 240), Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
    QCoreApplication::sendEvent(canvas_.get(), &wheel);
    QCOMPARE(canvas_->zoom(), 2.0);
    QVERIFY((canvas_->pixelFromWidget(at) - before).norm() < 1e-9);
  }

  void aClickReportsThePixelAndADragPans() {
    QSignalSpy clicked(canvas_.get(), &FrameCanvas::clicked);
    canvas_->show();
    QVERIFY(QTest::qWaitForWindowExposed(canvas_.get()));
    QTest::mouseClick(canvas_.get(), Qt::LeftButton, {}, {120, 80});
    QCOMPARE(clicked.count(), 1);
    QCOMPARE(clicked[0][0].toDouble(), 119.5);
    QCOMPARE(clicked[0][1].toDouble(), 79.5);
    const QPointF zero = canvas_->widgetFromPixel({0, 0});
    drag(canvas_.get(), {{120, 80}, {135, 85}, {150, 90}});
    QCOMPARE(clicked.count(), 1);
    QCOMPARE(canvas_->widgetFromPixel({0, 0}), zero + QPointF(30, 10));
  }

  void theScaleOfFalseColourIsAsWideAsItsNumbers() {
    const auto left = [&](const char* number) {  // of the box, on a white photograph
      canvas_->setScale({{0, "0"}, {1, number}});
      const QImage shown = canvas_->grab().toImage();
      const int row = int(100 * ratio_);
      for (int x = shown.width() / 2; x < shown.width(); ++x)
        if (qGray(shown.pixel(x, row)) < 150) return double(x) / ratio_;
      return -1.0;
    };
    QImage white(640, 480, QImage::Format_RGB888);
    white.fill(Qt::white);
    canvas_->setPhotograph(white);
    canvas_->fit();
    const QFontMetricsF metrics(canvas_->font());
    const double more = metrics.horizontalAdvance(QStringLiteral("0.0000000625")) - metrics.horizontalAdvance("0.000000");
    QVERIFY(std::abs(left("0.000000") - left("0.0000000625") - more) < 3);
    // Right of its numbers the box is empty: nothing is cut.
    const QImage shown = canvas_->grab().toImage();
    for (int y = int(12 * ratio_); y < int(185 * ratio_); ++y)
      QVERIFY2(qGray(shown.pixel(int((640 - 13) * ratio_), y)) < 150, qPrintable(QString::number(y)));
  }

  void theProbeSaysPositionAndValue() {
    QSignalSpy probed(canvas_.get(), &FrameCanvas::probed);
    QTest::mouseMove(canvas_.get(), {10, 10});
    QMouseEvent move(QEvent::MouseMove, QPointF(21, 31), QPointF(21, 31), QPointF(21, 31), Qt::NoButton, Qt::NoButton,
                     Qt::NoModifier);
    QCoreApplication::sendEvent(canvas_.get(), &move);
    QVERIFY(probed.count() > 0);
    QVERIFY2(probed.last()[0].toString().contains("x 20.50  y 30.50"), qPrintable(probed.last()[0].toString()));
  }

 private:
  std::unique_ptr<FrameCanvas> canvas_;
  double ratio_ = 1;
};

QObject* makeFrameCanvasTest() { return new FrameCanvasTest; }

}  // namespace glint::gui

#include "frame_canvas_test.moc"
