// SPDX-License-Identifier: BSD-3-Clause
// Pictures against stored ones, by what an eye sees: another driver's edges pass, a missing layer does not. Text is left out,
// because fonts differ between machines. After a wanted change: GLINT_STORE_PICTURES=1 test_viz --gtest_filter='StoredPictures*',
// and look at tests/viz/pictures.
#include <gtest/gtest.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkProp.h>
#include <vtkPropCollection.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/base/outcome.h"
#include "core/draw/epipolar_overlay.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/plots.h"
#include "tests/viz/image_checks.h"
#include "tests/viz/perceptual.h"
#include "tests/viz/small_inspection.h"
#include "viz/pictures.h"
#include "viz/plot_export.h"
#include "viz/scene_view.h"

namespace glint::viz {
namespace {

using test::seenShare;
using test::storedPicture;

/// The small inspection, with no curve upon another, so that every one of them is seen.
std::shared_ptr<const Inspection> inspectionApart(const std::filesystem::path& folder) {
  auto inspection = test::smallInspection(folder);
  for (FrameEvidence& evidence : inspection->evidence)
    for (Highlight& h : evidence.highlights) h.ellipse = Ellipse{h.peak, {11, 8}, 0.4};
  for (FrameComparison& comparison : inspection->models["canonical"].frames) {
    PredictedHighlight& p = comparison.prediction.editable()[0];
    for (Pixel& vertex : p.contour.points) vertex = p.brightest.pixel + 1.35 * (vertex - p.brightest.pixel);
    p.ellipse = Ellipse{p.brightest.pixel, {25, 22}, 0.2};
    p.canonical->ellipse = Ellipse{p.brightest.pixel, {8, 5}, 1.2};
    p.brightest.pixel += Pixel(4, -3);
    p.sigmaPx.assign(p.contour.points.size(), 0.9);
    comparison.rows[0].metrics->contourErrorPct += comparison.frame;  // a line that is not level
  }
  return inspection;
}

class StoredPictures : public test::PictureTest {
 protected:
  void SetUp() override {
    PictureTest::SetUp();
    inspection_ = inspectionApart(folder_.path());
  }
  void compare(const std::string& name, const Image& now, const std::vector<Box>& masked = {}, double most = test::kMostSeen) {
    test::storePicture(name, now);
    const double share = seenShare(storedPicture(name), now, masked);
    EXPECT_LE(share, most) << name;
  }
  test::TemporaryFolder folder_;
  std::shared_ptr<const Inspection> inspection_;
};

/// The picture moved right and down by a number of px, interpolated.
Image moved(const Image& image, double by) {
  Image out = image;
  const auto at = [&](double x, double y, int c) {
    const int u = std::clamp(int(std::floor(x)), 0, image.width - 2), v = std::clamp(int(std::floor(y)), 0, image.height - 2);
    const double a = std::clamp(x - u, 0.0, 1.0), b = std::clamp(y - v, 0.0, 1.0);
    return (1 - b) * ((1 - a) * image.at(u, v, c) + a * image.at(u + 1, v, c)) +
           b * ((1 - a) * image.at(u, v + 1, c) + a * image.at(u + 1, v + 1, c));
  };
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = float(at(x - by, y - by, c));
  return out;
}

// ---- the 3D view ----

constexpr const char* kLooks[] = {"overview", "parallel", "camera", "virtual", "explained"};
const std::set<std::string> kExplained{"walk", "cones"};  // they lie over everything else: in a picture of their own

class StoredScenes : public StoredPictures {
 protected:
  void SetUp() override {
    StoredPictures::SetUp();
    if (!IsSkipped()) resize(kSceneWidth, kSceneHeight);
  }
  /// One way of looking at the scene with every layer (explained: the surface and those that explain), but for one.
  Image picture(const std::string& look, const std::string& withoutLayer = "") {
    SceneView view;
    view.setInspection(inspection_);
    view.setLegendVisible(false);
    for (const Layer& layer : sceneLayers()) {
      const bool explains = kExplained.count(layer.name) > 0;
      const bool shown = look == "explained" ? explains || layer.name == "surface" || layer.name == "ellipsoids" : !explains;
      view.setLayerVisible(layer.name, shown && layer.name != withoutLayer);
    }
    if (look == "explained") {
      const auto walk = std::make_shared<const WalkStory>(test::shortWalk(*inspection_));
      view.setWalk(walk, walk->steps() - 1);
    } else if (look == "parallel") {
      view.setParallel(true);
      view.lookAlong(AxisView::Top);
    } else if (look != "overview") {
      view.setEye(look == "camera" ? Eye::Camera : Eye::VirtualCamera);
      render(view);
      const Pixel peak = inspection_->evidence[0].highlights[0].peak;
      const Eigen::Vector2d at = *view.displayOf(peak.x(), peak.y());
      view.zoomPhotograph(5, at.x(), at.y());  // large enough for the thinnest contour
      view.movePhotograph(0.5 * kSceneWidth - at.x(), 0.5 * kSceneHeight - at.y());
    }
    // After the view has placed its text for this frame.
    vtkNew<vtkCallbackCommand> hideText;
    hideText->SetClientData(view.renderer());
    hideText->SetCallback([](vtkObject*, unsigned long, void* renderer, void*) {
      vtkPropCollection* props = static_cast<vtkRenderer*>(renderer)->GetViewProps();
      props->InitTraversal();
      while (vtkProp* prop = props->GetNextProp())
        if (prop->IsA("vtkTextActor")) prop->VisibilityOff();
    });
    view.renderer()->AddObserver(vtkCommand::StartEvent, hideText, -1);
    return render(view);
  }
  static constexpr int kSceneWidth = 400, kSceneHeight = 300;
};

TEST_F(StoredScenes, LookAsTheyDid) {
  for (const char* look : kLooks) compare("scene_" + std::string(look), picture(look));
}

TEST_F(StoredScenes, AMissingLayerIsNoticed) {
  for (const Layer& layer : sceneLayers()) {
    if (layer.name == "measured-lamps") continue;  // empty until lamps are measured: tests/viz/measured_lamps_test.cpp
    if (layer.name == "solver-runs") continue;     // empty until it is asked why models fail: tests/viz/solver_runs_test.cpp
    double most = 0;
    for (const char* look : kLooks) {
      const Image without = picture(look, layer.name);
      most = std::max(most, seenShare(storedPicture("scene_" + std::string(look)), without));
    }
    EXPECT_GT(most, test::kMostSeen) << layer.name;
  }
}

/// What another driver does to edges: they lie elsewhere by a part of a pixel, and are smoother.
TEST_F(StoredScenes, AnotherWayToSmoothEdgesPassesAndAMovedPictureDoesNot) {
  for (const char* look : kLooks) {
    const Image picture = storedPicture("scene_" + std::string(look));
    EXPECT_LE(seenShare(picture, moved(picture, 0.3)), test::kMostSeen) << look;
    EXPECT_GT(seenShare(picture, moved(picture, 2)), test::kMostSeen) << look;
  }
}

// ---- overlay of the frame view, ladder ----

class StoredFrames : public StoredPictures {
 protected:
  /// The enlarged highlight of frame 0 with everything over it, but for some roles.
  Image overlay(const std::set<OverlayRole>& hidden = {}) {
    const Outcome<Image> photograph = readPhotograph(inspection_->scene->frames[0]);
    Canvas canvas(400, 300, kDarkBackground);
    const Box box{0, 0, 400, 300};
    const Crop crop = *highlightCrop(*inspection_, 0, {}, 4.0 / 3);
    canvas.picture(*photograph, crop, box);
    canvas.fill(box, {0.3, 0.3, 0.3}, 0.85);  // so that every layer stands out
    OverlayOptions options;
    options.hidden = hidden;
    options.residualScale = 2;
    options.selection = Selection{0, "canonical", 0, "lamp", 0.7};
    paintOverlay(canvas, frameOverlay(*inspection_, 0, options), crop, box, 1);
    return canvas.image();
  }
  /// Frames 0 and 2 side by side with the tangent epipolar lines of their ellipses.
  Image pair(bool withLines = true) {
    PairRequest request;
    request.frames = {0, 2};
    const EpipolarPicture both = epipolarPicture(*inspection_, request);
    Canvas canvas(480, 180, kDarkBackground);
    for (int i : {0, 1}) {
      const Box box{240.0 * i, 0, 240, 180};
      canvas.picture(*readPhotograph(inspection_->scene->frames[0]), {-0.5, -0.5, 320, 240}, box);
      canvas.fill(box, {0.25, 0.25, 0.25}, 0.7);
      if (withLines) paintOverlay(canvas, both.frames[std::size_t(i)], {-0.5, -0.5, 320, 240}, box, 1);
    }
    return canvas.image();
  }
  Image ladder(const std::set<OverlayRole>& hidden = {}) {
    PictureOptions options;
    options.hidden = hidden;
    return ladderPicture(*inspection_, 0, readPhotograph(inspection_->scene->frames[0]), 480, 300, options);
  }
  // The ladder's letters are 10 px high: the title takes 2 of them, the numbers below the tiles 3.
  const std::vector<Box> kLadderText{{0, 0, 480, 24}, {0, 260, 480, 40}};
};

TEST_F(StoredFrames, LookAsTheyDid) {
  compare("frame_overlay", overlay(), {}, test::kMostSeenWithoutDriver);
  compare("frame_pair", pair(), {}, test::kMostSeenWithoutDriver);
  compare("ladder", ladder(), kLadderText, test::kMostSeenWithoutDriver);
}

TEST_F(StoredFrames, AMissingLayerIsNoticed) {
  for (const OverlayLayer& layer : overlayLayers()) {
    if (layer.role == OverlayRole::Unmatched || layer.role == OverlayRole::Lobes)
      continue;  // nothing is missed or spurious here, no pixels are read: tests/viz/unmatched_test.cpp, plots_test.cpp
    const Image without = overlay({layer.role});
    const double share = seenShare(storedPicture("frame_overlay"), without);
    EXPECT_GT(share, test::kMostSeenWithoutDriver) << layer.name;
  }
  EXPECT_GT(seenShare(storedPicture("frame_pair"), pair(false)), test::kMostSeenWithoutDriver);
  for (const OverlayRole role : {OverlayRole::ObservedContour, OverlayRole::PredictedContour, OverlayRole::PredictedPeak}) {
    const double share = seenShare(storedPicture("ladder"), ladder({role}), kLadderText);
    EXPECT_GT(share, test::kMostSeenWithoutDriver) << "ladder " << int(role);
  }
}

// ---- plots ----

constexpr int kPlotWidth = 400, kPlotHeight = 260;

/// Without words: title, axes, legend.
PlotData wordless(PlotData plot) {
  plot.title.clear();
  for (PlotAxis* axis : {&plot.x, &plot.y}) {
    axis->title.clear();
    axis->names = {{rangeOf(plot).x0, " "}};
  }
  for (PlotSeries& series : plot.series) series.inLegend = false;
  return plot;
}

class StoredPlots : public StoredPictures {
 protected:
  std::vector<PlotData> plots() {
    PlotData axes = semiAxesPlot(*inspection_);
    for (PlotSeries& series : axes.series)
      for (PlotPoint& p : series.points) p.band = {0.8 * p.y, 1.1 * p.y};
    const FrameSamples samples = frameSamples(*inspection_, 0, "canonical");
    return {errorPlot(*inspection_), residualDial(*inspection_, 0, -1), axes, limitAnglePlot(samples, -1)};
  }
  Image picture(const PlotData& plot, const Selection& selection = kSelected) {
    return plotImage(wordless(plot), {true, 1}, selection, kPlotWidth, kPlotHeight);
  }
  /// A dial writes its directions and its rings' values; the rest of it has no text.
  std::vector<Box> masked(const PlotData& plot) {
    if (!plot.dial) return {};
    return {{0, 110, 85, 40}, {315, 110, 85, 40}, {170, 0, 60, 26}, {170, 240, 60, 20}, {190, 120, 20, 20}, {210, 10, 55, 240}};
  }
  inline static const Selection kSelected{0, "canonical", 0, "lamp", 0.7};
};

TEST_F(StoredPlots, LookAsTheyDid) {
  for (const PlotData& plot : plots()) compare("plot_" + plot.id, picture(plot), masked(plot), test::kMostSeenInPlots);
}

TEST_F(StoredPlots, AMissingPartIsNoticed) {
  for (const PlotData& plot : plots()) {
    const auto expectSeen = [&](const Image& without, const std::string& what) {
      const double share = seenShare(storedPicture("plot_" + plot.id), without, masked(plot));
      EXPECT_GT(share, test::kMostSeenInPlots) << plot.id << " without " << what;
    };
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
      PlotData without = plot;
      for (PlotPoint& p : without.series[i].points) p.y = std::numeric_limits<double>::quiet_NaN();
      expectSeen(picture(without), "series " + plot.series[i].name);
    }
    if (!plot.shades.empty()) {
      PlotData without = plot;
      without.shades.clear();
      expectSeen(picture(without), "shades");
    }
    if (!plot.series.empty() && !plot.series[0].points.empty() && plot.series[0].points[0].band) {
      PlotData without = plot;
      for (PlotSeries& series : without.series)
        for (PlotPoint& p : series.points) p.band.reset();
      expectSeen(picture(without), "error bars");
    }
    if (!selectedSamples(plot, kSelected).empty()) expectSeen(picture(plot, {5, "dual"}), "the mark of the selection");
  }
}

TEST(SeenShare, SeesWhatAnEyeSees) {
  Image grey(100, 100, 3, 0.5f), same = grey, spot = grey;
  EXPECT_EQ(seenShare(grey, same), 0);
  for (float& v : same.data) v += 0.01f;  // L from 53.4 to 54.4: not seen
  EXPECT_EQ(seenShare(grey, same), 0);
  for (int y = 40; y < 60; ++y)
    for (int x = 40; x < 60; ++x) spot.at(x, y, 0) = 1;
  EXPECT_NEAR(seenShare(grey, spot), 0.045, 0.008) << "20 x 20 of 100 x 100 px, and a blurred edge";
  EXPECT_EQ(seenShare(grey, spot, {{30, 30, 40, 40}}), 0) << "masked";
  EXPECT_EQ(seenShare(grey, Image(99, 100, 3)), 1);
}

}  // namespace
}  // namespace glint::viz
