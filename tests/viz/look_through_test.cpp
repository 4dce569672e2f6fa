// SPDX-License-Identifier: BSD-3-Clause
// Looking through real and virtual cameras: geometry and photograph lie where the camera model says, at every window size.
#include <gtest/gtest.h>
#include <vtkCamera.h>
#include <vtkImageData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <cmath>
#include <numbers>

#include "tests/viz/image_checks.h"
#include "tests/viz/small_inspection.h"
#include "viz/convert.h"
#include "viz/layers.h"
#include "viz/scene_view.h"
#include "viz/view_camera.h"

namespace glint::viz {
namespace {

using test::countDifferent;
using test::countNear;
using test::isNear;
using test::smallInspection;
using test::TemporaryFolder;

constexpr double kAgreementPx = 0.5;  // what the view promises

/// The camera of a frame with everything that a pinhole picture does not have by itself.
void makeUneven(Camera& camera) {
  camera.pixelFromRay << 430, 0, 171, 0, 385, 108, 0, 0, 1;
  camera.lens.parameters = {-0.25, 0.08, 0.004, -0.003, 0};
}

/// Closed form: the whole photograph as large as it fits, in the middle.
Eigen::Vector2d expectedAt(const Camera& camera, const Pixel& ideal, int width, int height) {
  const double scale = std::min(double(width) / camera.width, double(height) / camera.height);
  return {0.5 * width + scale * (ideal.x() + 0.5 - 0.5 * camera.width),
          0.5 * height - scale * (ideal.y() + 0.5 - 0.5 * camera.height)};
}

/// Centroid (window px, y up) of a weight near a place; a negative weight sum gives NaN.
template <class Weight>
Eigen::Vector2d centroidNear(const Image& image, const Eigen::Vector2d& at, double radius, Weight&& weight) {
  Eigen::Vector2d sum(0, 0);
  double total = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Eigen::Vector2d p(x + 0.5, image.height - y - 0.5);
      if ((p - at).norm() > radius) continue;
      const double w = weight(x, y);
      sum += w * p;
      total += w;
    }
  }
  return sum / total;
}

/// Points about the scene, drawn as true lights.
std::vector<Eigen::Vector3d> targets() {
  return {{0.45, 0.1, 0.3}, {-0.42, -0.1, 0.3}, {0.1, -0.3, 0.2}, {0.42, -0.05, -0.3}, {0.15, 0.3, -0.1}};
}

class LookThrough : public test::PictureTest {
 protected:
  /// An inspection with an uneven camera in frame 0 and the targets as lights.
  std::shared_ptr<Inspection> uneven(const std::vector<Eigen::Vector3d>& points) {
    const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
    auto scene = std::make_shared<Scene>(*inspection->scene);
    makeUneven(scene->frames[0].camera);
    scene->lights.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      TrueLight light;
      light.id = std::to_string(i);
      light.lamp = lampAt(points[i]);
      scene->lights.push_back(light);
    }
    inspection->scene = scene;
    inspection->views[0].camera = scene->frames[0].camera;
    return inspection;
  }
  static void showOnly(SceneView& view, const std::string& layer) {
    for (const Layer& l : sceneLayers()) view.setLayerVisible(l.name, l.name == layer);
  }
  TemporaryFolder folder_;
};

TEST_F(LookThrough, GeometryAndPhotographAgreeAtEveryWindowSize) {
  const std::shared_ptr<Inspection> inspection = uneven(targets());
  const Camera& camera = inspection->scene->frames[0].camera;
  // What the camera would take: a soft dot at the measured pixel of each target.
  std::vector<unsigned char> bytes(static_cast<std::size_t>(3 * camera.width * camera.height), 0);
  double bent = 0;
  for (const Eigen::Vector3d& p : targets()) {
    const Pixel dot = camera.distorted(*camera.project(p));
    bent = std::max(bent, (dot - *camera.project(p)).norm());
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const double value = 255 * std::exp(-(Pixel(x, y) - dot).squaredNorm() / (2 * 2.0 * 2.0));
        unsigned char* pixel = &bytes[static_cast<std::size_t>(3 * (y * camera.width + x))];
        for (int c = 0; c < 3; ++c) pixel[c] = static_cast<unsigned char>(std::min(255.0, pixel[c] + value));
      }
    }
  }
  ASSERT_GT(bent, 3 * kAgreementPx) << "the distortion must matter";
  for (const auto& [width, height] : {std::pair(640, 480), std::pair(431, 700), std::pair(1000, 333)}) {
    SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
    resize(width, height);
    SceneView view;
    view.setInspection(inspection);
    view.setGlyphScale(0.4);
    view.setLegendVisible(false);
    view.setEye(Eye::Camera);
    ASSERT_TRUE(view.looksThrough());
    view.setPhotograph(0, toTexture(bytes.data(), camera.width, camera.height, 3 * camera.width));
    showOnly(view, "true-light");
    view.setPhotographOpacity(0);
    const Image geometry = render(view);
    showOnly(view, "");
    view.setPhotographOpacity(1);
    const Image photograph = render(view);
    for (const Eigen::Vector3d& p : targets()) {
      const Eigen::Vector2d expected = expectedAt(camera, *camera.project(p), width, height);
      ASSERT_TRUE(view.displayOf(camera.project(p)->x(), camera.project(p)->y()));
      EXPECT_LT((*view.displayOf(camera.project(p)->x(), camera.project(p)->y()) - expected).norm(), 1e-9);
      const double radius = 9 * std::max(1.0, std::min(width / 320.0, height / 240.0));
      const Eigen::Vector2d drawn = centroidNear(geometry, expected, radius,
                                                 [&](int x, int y) { return isNear(geometry, x, y, kTruth, 0.12) ? 1.0 : 0.0; });
      EXPECT_LT((drawn - expected).norm(), kAgreementPx) << drawn.transpose() << " not " << expected.transpose();
      const Eigen::Vector2d seen =
          centroidNear(photograph, expected, radius, [&](int x, int y) { return std::max(0.0, photograph.at(x, y, 0) - 0.15); });
      EXPECT_LT((seen - expected).norm(), kAgreementPx) << seen.transpose() << " not " << expected.transpose();
    }
  }
}

/// The mirrored camera is left-handed: a picture that is flipped or not mirrored puts the points elsewhere.
TEST_F(LookThrough, TheVirtualCameraProjectsAsPM) {
  const std::shared_ptr<Inspection> plain = smallInspection(folder_.path());
  const Plane plane = plain->views[0].seen->tangentPlane;
  const Eigen::Vector3d at = plain->views[0].seen->brightest.point.position, eye = plain->views[0].camera.centreInWorld();
  const Eigen::Vector3d away = (at - plane.reflected(eye)).normalized();  // the virtual camera's view of the brightest point
  const Eigen::Matrix<double, 3, 2> side = tangentBasis(away);
  const std::vector<Eigen::Vector3d> points{at + 0.4 * away + 0.1 * side.col(0), at + 0.4 * away - 0.07 * side.col(1),
                                            at + 0.3 * away - 0.09 * side.col(0) + 0.05 * side.col(1)};
  const std::shared_ptr<Inspection> inspection = uneven(points);
  const Camera& camera = inspection->scene->frames[0].camera;
  const Projection pm = virtualCamera(camera, plane);
  for (const auto& [width, height] : {std::pair(640, 480), std::pair(431, 700)}) {
    resize(width, height);
    SceneView view;
    view.setInspection(inspection);
    view.setGlyphScale(0.4);
    view.setLegendVisible(false);
    view.setEye(Eye::VirtualCamera);
    ASSERT_TRUE(view.looksThrough());
    EXPECT_EQ(view.eyeText(), "through virtual camera 0000 (mirrored)");
    showOnly(view, "true-light");
    const Image image = render(view);
    for (const Eigen::Vector3d& p : points) {
      const Eigen::Vector2d expected = expectedAt(camera, pm.project(p), width, height);
      const Eigen::Vector2d drawn =
          centroidNear(image, expected, 14, [&](int x, int y) { return isNear(image, x, y, kTruth, 0.12) ? 1.0 : 0.0; });
      EXPECT_LT((drawn - expected).norm(), kAgreementPx) << drawn.transpose() << " not " << expected.transpose();
    }
  }
}

/// The outline of the drawn ellipsoid is the ellipse C* ~ P M Q* (P M)^T, and the canonical ellipse covers itself in the
/// photograph.
TEST_F(LookThrough, OutlinesInTheVirtualCameraAreTheImageEllipses) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  SceneView view;
  view.setInspection(inspection);
  view.setLegendVisible(false);
  view.setEye(Eye::VirtualCamera);
  showOnly(view, "");
  const Image without = render(view);
  showOnly(view, "ellipsoids");
  view.setModels({"canonical"});
  const Image with = render(view);
  const Camera& camera = inspection->scene->frames[0].camera;
  const Outcome<Ellipse> outline = outlineEllipse(*inspection->models.at("canonical").fits[0].fit->ellipsoid(),
                                                  virtualCamera(camera, inspection->views[0].seen->tangentPlane));
  ASSERT_TRUE(outline);
  Eigen::AlignedBox2d drawn, expected;
  for (int y = 60; y < kHeight - 70; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::abs(with.at(x, y, 1) - without.at(x, y, 1)) > 0.04) {
        drawn.extend(Eigen::Vector2d(x, kHeight - y - 1));
        drawn.extend(Eigen::Vector2d(x + 1, kHeight - y));
      }
    }
  }
  for (const Pixel& p : outline->sample(720)) expected.extend(expectedAt(camera, p, kWidth, kHeight));
  ASSERT_FALSE(drawn.isEmpty());
  // The outline is drawn by triangles within it and by lines of 1.5 px about it.
  EXPECT_LT((drawn.min() - expected.min()).cwiseAbs().maxCoeff(), 2.5)
      << drawn.min().transpose() << " " << expected.min().transpose();
  EXPECT_LT((drawn.max() - expected.max()).cwiseAbs().maxCoeff(), 2.5)
      << drawn.max().transpose() << " " << expected.max().transpose();

  showOnly(view, "canonical-ellipses");
  view.setSolo(true);
  view.setModels({"dual"});
  const Image canonical = render(view);
  const Ellipse& ellipse = *inspection->views[0].canonical->ellipse;
  int onIt = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (!isNear(canonical, x, y, modelColour("canonical"), 0.1)) continue;
      double nearest = 1e9;
      for (const Pixel& p : ellipse.sample(720))
        nearest =
            std::min(nearest, (expectedAt(camera, p, kWidth, kHeight) - Eigen::Vector2d(x + 0.5, kHeight - y - 0.5)).norm());
      EXPECT_LT(nearest, 2.6);  // half of the 3 px line, and its anti-aliased edge
      ++onIt;
    }
  }
  EXPECT_GT(onIt, 150);
}

TEST_F(LookThrough, TheMirroredPictureIsLitAsTheOtherOne) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  const auto brightness = [&](Eye eye) {
    SceneView view;
    view.setInspection(inspection);
    view.setLegendVisible(false);
    view.setEye(eye);
    showOnly(view, "light");
    const Image image = render(view);
    double brightest = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (image.at(x, y, 2) < 0.5 * image.at(x, y, 0)) brightest = std::max<double>(brightest, image.at(x, y, 0));
    return brightest;
  };
  EXPECT_GT(brightness(Eye::VirtualCamera), 0.8);  // a yellow ball seen from its unlit inside is nearly black
}

TEST_F(LookThrough, WhereThereIsNoHighlightThereIsNoVirtualCamera) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  inspection->evidence[5].highlights.clear();
  SceneView view;
  view.setInspection(inspection);
  view.setSelection({5, "", -1});
  render(view);
  const ViewPoint before = view.viewPoint();
  view.setEye(Eye::VirtualCamera);
  EXPECT_FALSE(view.looksThrough());
  EXPECT_NE(view.eyeText().find("no virtual camera"), std::string::npos) << view.eyeText();
  EXPECT_FALSE(view.displayOf(0, 0));
  render(view);
  EXPECT_LT((view.viewPoint().position - before.position).norm(), 1e-12);
  view.setSelection({0, "", -1});  // it follows the frames
  EXPECT_TRUE(view.looksThrough());
  EXPECT_EQ(view.eyeText(), "through virtual camera 0000 (mirrored)");
  view.setEye(Eye::Outside);
  EXPECT_EQ(view.eyeText(), "");
  render(view);
  EXPECT_LT((view.viewPoint().position - before.position).norm(), 1e-12);
}

TEST_F(LookThrough, ZoomKeepsWhatIsUnderThePointer) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  SceneView view;
  view.setInspection(inspection);
  view.setEye(Eye::Camera);
  render(view);
  const Eigen::Vector2d before = *view.displayOf(200, 60);
  view.zoomPhotograph(3, before.x(), before.y());
  EXPECT_LT((*view.displayOf(200, 60) - before).norm(), 1e-9);
  EXPECT_NEAR((*view.displayOf(201, 60) - before).norm(), 3 * 2.0, 1e-9);  // 640 px for 320
  view.movePhotograph(5, -7);
  EXPECT_LT((*view.displayOf(200, 60) - before - Eigen::Vector2d(5, -7)).norm(), 1e-9);
}

/// Two halves of a wipe are one picture.
TEST_F(LookThrough, TheWipeShowsOnePicture) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  for (const Eye eye : {Eye::Outside, Eye::Camera}) {
    SCOPED_TRACE(eye == Eye::Camera ? "camera" : "outside");
    const auto prepare = [&](SceneView& view) {
      view.setInspection(inspection);
      view.setLegendVisible(false);
      for (const Layer& l : sceneLayers()) view.setLayerVisible(l.name, l.name == "surface" || l.name == "observed-contours");
      view.setViewPoint({{2, -1.5, 1}, {0, 0, 0}, {0, 0, 1}, 30});
      view.setEye(eye);
    };
    SceneView whole, left, right;
    for (SceneView* view : {&whole, &left, &right}) prepare(*view);
    const Image expected = render(whole);
    for (SceneView* view : {&left, &right}) view->setPartOfWindow(true);
    left.renderer()->SetViewport(0, 0, 0.4, 1);
    right.renderer()->SetViewport(0.4, 0, 1, 1);
    vtkNew<vtkRenderWindow> window;
    prepareWindow(window);
    window->SetShowWindow(false);
    window->SetOffScreenRendering(1);
    window->SetSize(kWidth, kHeight);
    window->AddRenderer(left.renderer());
    window->AddRenderer(right.renderer());
    window->Render();
    const Image parts = pictureOf(window);
    int different = 0, seen = 0;
    for (int y = 60; y < 380; ++y) {  // below are axes and scale bar, of each view its own
      for (int x = 0; x < kWidth; ++x) {
        for (int c = 0; c < 3; ++c) different += std::abs(parts.at(x, y, c) - expected.at(x, y, c)) > 0.1;
        seen += !isNear(expected, x, y, kDarkBackground, 0.05);
      }
    }
    EXPECT_GT(seen, 10000);
    EXPECT_LT(different, 0.01 * seen);  // light depends a little on the camera's depth range
    window->RemoveRenderer(left.renderer());
    window->RemoveRenderer(right.renderer());
    window->Finalize();
  }
}

// --- views from outside -----------------------------------------------------------------------------------------------

TEST(ViewCamera, AFittedViewHoldsAllPointsAndTouchesItsMargins) {
  const Eigen::Vector3d back = Eigen::Vector3d(1, 2, 0.7).normalized();
  const Eigen::Vector3d up = (Eigen::Vector3d::UnitZ() - back.z() * back).normalized(), right = up.cross(back);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(std::sin(3.1 * i), 0.5 * std::cos(1.7 * i), 0.3 * std::sin(5.3 * i + 1));
  const Margins margins{0.5, 0.9, 0.8, 0.7};
  constexpr double kAspect = 1.7;
  for (const bool parallel : {false, true}) {
    SCOPED_TRACE(parallel);
    const ViewPoint view = fitted(points, back, up, kAspect, margins, parallel, Eigen::Vector3d::Zero(), 1e-3);
    EXPECT_EQ(view.parallel, parallel);
    const double half = std::tan(view.viewAngleDeg * std::numbers::pi / 360);
    double most = 0;  // share of the margin that is used
    for (const Eigen::Vector3d& p : points) {
      const double depth = parallel ? (view.position - view.focalPoint).norm() : back.dot(view.position - p);
      const double x = right.dot(p - view.position) / (depth * half * kAspect), y = up.dot(p - view.position) / (depth * half);
      ASSERT_GT(depth, 0);
      for (const double share : {x / margins.right, -x / margins.left, y / margins.top, -y / margins.bottom}) {
        EXPECT_LT(share, 1 + 1e-9);
        most = std::max(most, share);
      }
    }
    EXPECT_NEAR(most, 1, 1e-9);
  }
}

TEST(ViewCamera, AxisViewsLookAlongTheAxes) {
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0)}) {
    for (const AxisView view :
         {AxisView::Front, AxisView::Back, AxisView::Left, AxisView::Right, AxisView::Top, AxisView::Bottom}) {
      const AxisDirections d = axisDirections(view, up);
      EXPECT_NEAR(d.back.norm(), 1, 1e-12);
      EXPECT_NEAR(d.up.norm(), 1, 1e-12);
      EXPECT_NEAR(d.back.dot(d.up), 0, 1e-12);
    }
    EXPECT_EQ(axisDirections(AxisView::Top, up).back, up);
    EXPECT_EQ(axisDirections(AxisView::Front, up).up, up);
  }
  // z up: the front is seen from -y, and the right-hand side of that picture is +x; the right view stands there.
  const AxisDirections front = axisDirections(AxisView::Front, {0, 0, 1});
  EXPECT_EQ(front.back, Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(front.up.cross(front.back), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(axisDirections(AxisView::Right, {0, 0, 1}).back, Eigen::Vector3d(1, 0, 0));
}

TEST(ViewCamera, AParallelViewIsStoredAsTheSameView) {
  vtkNew<vtkCamera> camera;
  const ViewPoint wanted{{1, 2, 3}, {0, 0, 0.1}, Eigen::Vector3d(0, 0, 1), 40, true};
  setViewPoint(camera, wanted);
  EXPECT_NEAR(camera->GetParallelScale(), (wanted.position - wanted.focalPoint).norm() * std::tan(20 * std::numbers::pi / 180),
              1e-12);
  camera->SetParallelScale(2 * camera->GetParallelScale());  // zoomed out: as far as twice the distance
  const ViewPoint seen = viewPointOf(camera);
  EXPECT_TRUE(seen.parallel);
  EXPECT_NEAR((seen.position - wanted.focalPoint).norm(), 2 * (wanted.position - wanted.focalPoint).norm(), 1e-9);
}

}  // namespace
}  // namespace glint::viz
