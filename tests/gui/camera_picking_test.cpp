// SPDX-License-Identifier: BSD-3-Clause
// Cameras in the 3D view, by left and right clicks on their lines and between them; lamps behind what shines through.
#include <QMenu>
#include <cmath>

#include "gui/base/vtk_canvas.h"
#include "tests/gui/scene_fixture.h"

namespace glint::gui {

class CameraPickingTest : public QObject, SceneFixture {
  Q_OBJECT
 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void aClickOnACameraSelectsItsFrame() {
    for (const viz::Layer& layer : viz::sceneLayers())
      document_->setLayerVisible(layer.name, layer.title, layer.name == "cameras");
    settle();
    QTest::mouseClick(views().widget(), Qt::LeftButton, {}, onScreen(document_->scene()->frames[8].camera.centreInWorld()));
    QCOMPARE(document_->selection().frame, 8);
  }

  /// An ellipsoid shines through: what lies behind it is seen, and can be taken.
  void theLampIsDraggedThroughAnEllipsoid() {
    auto scene = std::make_shared<Scene>(*document_->scene());
    TrueLight lamp;
    lamp.id = "lamp";
    lamp.lamp = lampAt(Eigen::Vector3d(0.3, -0.6, -0.8));
    scene->lights = {lamp};
    Opened opened = fixture_.opened();
    opened.scene = scene;
    opened.request.whatIf.synthesise = true;
    document_->open(opened);
    auto inspection = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request()));
    inspection->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
    ModelFit around;
    around.model = "canonical";
    around.light = "lamp";
    const Ellipsoid ellipsoid(Eigen::Isometry3d(Eigen::Translation3d(lamp.lamp.position())), {0.3, 0.25, 0.2});
    around.family = EllipsoidFit{ellipsoid.dual(), ellipsoid};
    inspection->models["canonical"].fits = {{"lamp", {}, around, {}}};
    document_->setInspection(inspection, document_->request());
    showOnly({"true-light", "ellipsoids"});
    settle();
    panel_->frameAll();
    settle();
    const QPoint from = onScreen(lamp.lamp.position()), there = from + QPoint(-60, 35);
    const double ratio = views().widget()->devicePixelRatioF();
    const std::optional<viz::Picked> nearest =
        panel_->view().pick(int(from.x() * ratio), int((views().widget()->height() - 1 - from.y()) * ratio));
    QCOMPARE(nearest ? QString::fromStdString(nearest->layer) : QString(), QStringLiteral("ellipsoids"));  // before the lamp
    drag(views().widget(), {from, from + QPoint(-20, 10), there});
    QVERIFY(document_->request().whatIf.lightsBy.count("lamp"));
  }

  void aRightClickOnACameraExcludesIt() {
    for (const viz::Layer& layer : viz::sceneLayers())
      document_->setLayerVisible(layer.name, layer.title, layer.name == "cameras");
    settle();
    QTest::mouseClick(views().widget(), Qt::RightButton, {}, onScreen(document_->scene()->frames[8].camera.centreInWorld()));
    auto* menu = panel_->findChild<QMenu*>(QStringLiteral("cameraMenu"));
    QVERIFY(menu && menu->isVisible());
    QCOMPARE(document_->selection().frame, 0);  // it asks, it does not select
    const QList<QAction*> actions = menu->actions();
    const auto exclude =
        std::find_if(actions.begin(), actions.end(), [](QAction* a) { return a->text() == "E&xclude this frame"; });
    QVERIFY(exclude != actions.end());
    (*exclude)->trigger();
    menu->close();
    QCOMPARE(document_->role(8), FrameRole::Excluded);
    document_->undoStack()->undo();
    QCOMPARE(document_->role(8), FrameRole::HeldOut);
    // Looking through a camera selects its frame: the eye follows the selected one.
    const auto through = std::find_if(actions.begin(), actions.end(), [](QAction* a) { return a->text().startsWith("&Look"); });
    QVERIFY(through != actions.end());
    (*through)->trigger();
    QCOMPARE(document_->selection().frame, 8);
    QVERIFY(panel_->view().looksThrough());
  }

  /// Cameras are drawn as lines. What lies between the lines belongs to the camera, too, whether the surface is behind it or
  /// before it.
  void aRightClickInsideACameraIsOneOnIt() {
    showOnly({"cameras", "surface"});
    largeCameras();
    const Eigen::Vector3d inside = insideOf(2) + Eigen::Vector3d(0.04, 0, 0);  // the ball lies straight before it
    int throughTheSurface = 0;
    for (const Eigen::Vector3d& from : {Eigen::Vector3d(0, 0, -4), Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0, -4, -1.7)}) {
      lookFrom(from, inside);
      QTest::mouseClick(views().widget(), Qt::RightButton, {}, onScreen(inside));
      auto* menu = panel_->findChild<QMenu*>(QStringLiteral("cameraMenu"));
      QVERIFY(menu && menu->isVisible());
      QVERIFY2(menu->actions().first()->text().endsWith("0002"), qPrintable(menu->actions().first()->text()));
      menu->close();
      QCOMPARE(document_->selection().frame, 0);
      QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
      const auto hit = panel_->view().pick(display(inside).x(), display(inside).y());
      throughTheSurface += hit && hit->layer == "surface";
    }
    QCOMPARE(throughTheSurface, 2);  // where a left click is one on it
  }

  void aCameraIsPickedInAllOfItsFrustumAndTheNearestCounts() {
    showOnly({"cameras"});
    largeCameras();
    const auto at = [this](const Eigen::Vector3d& p) {
      const auto hit = panel_->view().pickCamera(display(p).x(), display(p).y());
      return hit ? hit->frame : -1;
    };
    const Eigen::Vector3d eye = document_->scene()->frames[11].camera.centreInWorld(), depth(0, 0, kDepth);
    const auto corners = viz::imagePlane(document_->scene()->frames[11].camera, kDepth);
    // Seen from behind, a camera has its image plane as outline.
    lookFrom(eye - Eigen::Vector3d(0, 0, 4), eye);
    const auto backside = panel_->view().pickCamera(display(insideOf(11)).x(), display(insideOf(11)).y());
    QVERIFY(backside && (backside->position - eye).norm() < 0.1 * kDepth);
    for (const Eigen::Vector3d& corner : corners) {
      for (const double share : {0.0, 0.5, 0.9}) QCOMPARE(at(eye + depth + share * (corner - eye - depth)), 11);
      QVERIFY(at(eye + depth + 1.1 * (corner - eye - depth)) != 11);
    }
    lookFrom(eye + Eigen::Vector3d(0.03, 0, 4), eye);
    const auto front = panel_->view().pickCamera(display(eye + depth).x(), display(eye + depth).y());
    QVERIFY(front && (front->position - eye - depth).norm() < 0.1 * kDepth);
    // Seen sideways the cameras stand one behind the other and show only their sides.
    for (const auto& [from, nearest] : {std::pair(-4.0, 11), std::pair(4.0, 0)}) {
      const Eigen::Vector3d there = document_->scene()->frames[std::size_t(nearest)].camera.centreInWorld();
      lookFrom(there + Eigen::Vector3d(from, 0, 0.5 * kDepth), insideOf(nearest));
      const double half = 0.4 * corners[2].y();  // at 0.8 of the depth, where the frustum is 0.8 times as high
      for (const double share : {-0.9, -0.5, 0.0, 0.5, 0.9})
        QCOMPARE(at(there + 0.8 * depth + Eigen::Vector3d(0, 2 * share * half, 0)), nearest);
      const auto hit = panel_->view().pickCamera(display(insideOf(nearest)).x(), display(insideOf(nearest)).y());
      QVERIFY((hit->position - insideOf(nearest)).norm() < 0.5 * kDepth);
      QCOMPARE(at(there + 0.8 * depth + Eigen::Vector3d(0, 1.15 * 2 * half, 0)), -1);
    }
    // A left click between the lines selects the frame, too, where nothing else is.
    const Eigen::Vector3d between = insideOf(8) + Eigen::Vector3d(0.04, 0, 0);
    lookFrom(insideOf(8) - Eigen::Vector3d(0, 0, 2), insideOf(8));
    QTest::mouseClick(views().widget(), Qt::LeftButton, {}, onScreen(between));
    QCOMPARE(document_->selection().frame, 8);
    QCOMPARE(at(insideOf(8)), 8);
    showOnly({});
    settle();
    QCOMPARE(at(insideOf(8)), -1);
  }

  void camerasBehindTheEyeOrAroundItAreNotPicked() {
    showOnly({"cameras", "surface"});
    largeCameras();
    const auto picked = [this] {
      const double ratio = views().widget()->devicePixelRatioF();
      int n = 0;
      for (int y = 5; y < views().widget()->height(); y += 20)
        for (int x = 5; x < views().widget()->width(); x += 20)
          n += panel_->view().pickCamera(int(x * ratio), int(y * ratio)).has_value();
      return n;
    };
    const Eigen::Vector3d before(0, 0, -1);
    lookFrom(before, before - Eigen::Vector3d::UnitZ());
    QVERIFY(picked() > 10);
    lookFrom(before, before + Eigen::Vector3d::UnitZ());
    QCOMPARE(picked(), 0);
    document_->selectFrame(8);
    trigger("view.look-through");
    settle();
    QVERIFY(panel_->view().looksThrough());
    QCOMPARE(picked(), 0);
  }

 private:
  /// The same as a window pixel, y up.
  Eigen::Vector2i display(const Eigen::Vector3d& point) {
    vtkRenderer* renderer = panel_->view().renderer();
    renderer->SetWorldPoint(point.x(), point.y(), point.z(), 1);
    renderer->WorldToDisplay();
    return {int(renderer->GetDisplayPoint()[0]), int(renderer->GetDisplayPoint()[1])};
  }
  /// Makes the insides of cameras wider than a click on a line may miss, without overlap.
  void largeCameras() { document_->setOption("scene/glyph-scale", 1.5, "large cameras"); }
  static constexpr double kDepth = 0.3;  ///< m, of a drawn camera then: 0.8 of the 0.25 m between two, times 1.5
  Eigen::Vector3d insideOf(int frame) {
    return document_->scene()->frames[std::size_t(frame)].camera.centreInWorld() + Eigen::Vector3d(0, 0, 0.5 * kDepth);
  }
  void lookFrom(const Eigen::Vector3d& eye, const Eigen::Vector3d& at) {
    const bool steep = std::abs((at - eye).normalized().y()) > 0.9;
    panel_->view().setViewPoint({eye, at, steep ? Eigen::Vector3d::UnitZ().eval() : Eigen::Vector3d::UnitY().eval(), 30});
    settle();
  }
};

QObject* makeCameraPickingTest() { return new CameraPickingTest; }

}  // namespace glint::gui

#include "camera_picking_test.moc"
