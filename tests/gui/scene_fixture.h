// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkRenderer.h>

#include <QAction>
#include <QMenu>
#include <set>

#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

/// The 3D views on screen, with the fixture's scene and its circles.
struct SceneFixture {
  void begin() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    panel_ = std::make_unique<ScenePanel>(*document_);
    actions_ = std::make_unique<Actions>();
    menu_ = std::make_unique<QMenu>();
    panel_->addActions(*actions_, menu_.get());
    document_->open(spread());
    auto inspection = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request()));
    inspection->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
    document_->setInspection(inspection, document_->request());
    panel_->resize(900, 600);
    panel_->show();
    QVERIFY(QTest::qWaitForWindowExposed(panel_.get()));
    settle();
  }
  void end() {
    panel_.reset();
    menu_.reset();
    actions_.reset();
  }
  /// The fixture's scene with its cameras side by side, so that they can be told apart.
  Opened spread() {
    Opened opened = fixture_.opened();
    auto scene = std::make_shared<Scene>(*opened.scene);
    for (std::size_t i = 0; i < scene->frames.size(); ++i)
      scene->frames[i].camera.camFromWorld = Eigen::Translation3d(0.25 * (double(i) - 2), 0, 2);
    opened.scene = scene;
    return opened;
  }
  SceneViews& views() { return panel_->views(); }
  /// Where a world point is drawn, widget coordinates.
  QPoint onScreen(const Eigen::Vector3d& point) {
    vtkRenderer* renderer = panel_->view().renderer();
    renderer->SetWorldPoint(point.x(), point.y(), point.z(), 1);
    renderer->WorldToDisplay();
    const double ratio = views().widget()->devicePixelRatioF();
    return {int(renderer->GetDisplayPoint()[0] / ratio),
            views().widget()->height() - 1 - int(renderer->GetDisplayPoint()[1] / ratio)};
  }
  void showOnly(const std::set<std::string>& layers) {
    for (const viz::Layer& layer : viz::sceneLayers())
      document_->setLayerVisible(layer.name, layer.title, layers.count(layer.name) > 0);
  }
  void trigger(const char* id) {
    QAction* action = actions_->find(QLatin1String(id));
    QVERIFY2(action, id);
    action->trigger();
    QCoreApplication::processEvents();
  }
  /// Draws what is needed, with every photograph.
  void settle() {
    QCoreApplication::processEvents();
    QTRY_VERIFY(!views().busy());
    QCoreApplication::processEvents();
    panel_->renderNow();
  }
  Fixture fixture_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<Actions> actions_;
  std::unique_ptr<QMenu> menu_;
  std::unique_ptr<ScenePanel> panel_;
};

}  // namespace glint::gui
