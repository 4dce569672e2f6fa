// SPDX-License-Identifier: BSD-3-Clause
// How the 3D views are moved by hand.
#include <vtkRenderer.h>

#include <QWheelEvent>
#include <cmath>

#include "gui/base/vtk_canvas.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "tests/gui/scene_fixture.h"

namespace glint::gui {

class NavigationTest : public QObject, SceneFixture {
  Q_OBJECT
 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  /// What lies under the pointer stays there, whether the wheel or the left button moves the view.
  void theViewZoomsAndTurnsAboutWhatIsUnderThePointer() {
    settle();
    const double ratio = views().widget()->devicePixelRatioF();
    vtkRenderer* renderer = panel_->view().renderer();
    const int* size = renderer->GetSize();
    // A place of the surface that is away from the middle, where the focal point is.
    std::optional<viz::Picked> hit;
    for (int x = size[0] / 4; x < size[0] && !hit; x += 20)
      for (int y = size[1] / 4; y < size[1] && !hit; y += 20)
        if (const auto p = panel_->view().pick(x, y);
            p && p->layer == "surface" && std::hypot(x - size[0] / 2, y - size[1] / 2) > 40) {
          hit = p;
          hit->text = QString("%1 %2").arg(x).arg(y).toStdString();
        }
    QVERIFY(hit);
    const QStringList at = QString::fromStdString(hit->text).split(' ');
    const QPointF pointer(at[0].toInt() / ratio, views().widget()->height() - (at[1].toInt() + 1) / ratio);
    const auto shownAt = [&](const Eigen::Vector3d& world) {
      renderer->SetWorldPoint(world.x(), world.y(), world.z(), 1);
      renderer->WorldToDisplay();
      return Eigen::Vector2d(renderer->GetDisplayPoint()[0], renderer->GetDisplayPoint()[1]);
    };
    const Eigen::Vector2d before = shownAt(hit->position);
    const double far = (panel_->view().viewPoint().position - hit->position).norm();
    QWheelEvent wheel(pointer, views().widget()->mapToGlobal(pointer.toPoint()), {}, {0, 360}, Qt::NoButton, Qt::NoModifier,
                      Qt::NoScrollPhase, false);
    QCoreApplication::sendEvent(views().widget(), &wheel);
    settle();
    QVERIFY2((shownAt(hit->position) - before).norm() < 1, "zoomed away from the pointer");
    const double near = (panel_->view().viewPoint().position - hit->position).norm();
    QVERIFY2(std::abs(far / near - std::pow(1.2, 3)) < 1e-6 * far / near, "three notches of a factor of 1.2");
    const viz::ViewPoint start = panel_->view().viewPoint();
    drag(views().widget(), {pointer.toPoint(), pointer.toPoint() + QPoint(40, 0), pointer.toPoint() + QPoint(80, 25)});
    settle();
    QVERIFY2((shownAt(hit->position) - before).norm() < 3, "the press is to a whole pixel of the window");
    QVERIFY((panel_->view().viewPoint().position - start.position).norm() > 0.05 * near);
    QVERIFY(document_->selection().highlight < 0);  // a drag selects nothing
  }

  void fourViewsAlongTheAxesAndOneInPerspective() {
    settle();
    const viz::ViewPoint free = panel_->view().viewPoint();
    trigger("view.views-axes");
    QCOMPARE(views().viewCount(), 4);
    settle();
    std::vector<Eigen::Vector3d> back;
    for (int i = 0; i < 4; ++i) {
      const viz::ViewPoint v = views().view(i).viewPoint();
      back.push_back((v.position - v.focalPoint).normalized());
      QCOMPARE(views().view(i).parallel(), i < 3);
      if (i < 3) QVERIFY(std::abs(back[std::size_t(i)].cwiseAbs().maxCoeff() - 1) < 1e-9);
    }
    QVERIFY(std::abs(back[0].dot(back[1])) + std::abs(back[1].dot(back[2])) + std::abs(back[0].dot(back[2])) < 1e-9);
    QVERIFY((back[3] - (free.position - free.focalPoint).normalized()).norm() < 1e-9);
    document_->undoStack()->undo();
    QCOMPARE(views().viewCount(), 1);
    QVERIFY(!panel_->view().parallel());
  }
};

QObject* makeNavigationTest() { return new NavigationTest; }

}  // namespace glint::gui

#include "navigation_test.moc"
