// SPDX-License-Identifier: BSD-3-Clause
// The legend of the 3D picture: read from its pixels, with no scene behind it.
#include "viz/annotations.h"

#include <gtest/gtest.h>
#include <vtkActor2DCollection.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/number_text.h"
#include "tests/viz/image_checks.h"
#include "viz/canvas.h"
#include "viz/convert.h"
#include "viz/label_places.h"
#include "viz/offscreen.h"
#include "viz/scene_view.h"

namespace glint::viz {
namespace {

using test::isNear;

constexpr Colour kOrange{0.9, 0.6, 0}, kMagenta{0.9, 0.1, 0.9}, kWhite{1, 1, 1}, kBlueEntry{0.1, 0.3, 0.9};
constexpr int kHeight = 480;
constexpr double kSame = 0.12;  // a channel: strokes are drawn without smoothing, texts with it

class LegendPicture : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v Xvfb > /dev/null 2>&1") != 0) GTEST_SKIP() << "Xvfb is not installed";
    display_ = std::make_unique<test::TestDisplay>();
    ASSERT_TRUE(*display_) << display_->failure().message();
  }
  Image picture(int width, bool dark, const std::function<void(Annotations&)>& fill) {
    vtkNew<vtkRenderer> renderer;
    const Colour& back = dark ? kDarkBackground : kLightBackground;
    renderer->SetBackground(back[0], back[1], back[2]);
    vtkNew<vtkRenderWindow> window;
    prepareWindow(window);
    window->SetShowWindow(false);
    window->SetOffScreenRendering(1);
    window->SetSize(width, kHeight);
    window->AddRenderer(renderer);
    Annotations annotations(renderer);
    annotations.setDark(dark);
    fill(annotations);
    window->Render();
    annotations.place({0, 0, 0});
    window->Render();
    legend_ = annotations.legendSize();
    texts_.clear();
    vtkActor2DCollection* actors = renderer->GetActors2D();
    actors->InitTraversal();
    while (vtkActor2D* actor = actors->GetNextActor2D()) {
      auto* text = vtkTextActor::SafeDownCast(actor);
      if (!text || !text->GetVisibility() || !text->GetInput()) continue;
      double size[2];
      text->GetSize(renderer, size);
      texts_[text->GetInput()] = {text->GetPosition()[0], text->GetPosition()[1], size[0], size[1]};
    }
    Image image = pictureOf(window);
    window->RemoveRenderer(renderer);
    window->Finalize();
    return image;
  }
  /// Pixels like `colour` whose column, in heights of the text, is within [from, to).
  static int count(const Image& image, const Colour& colour, double from, double to) {
    const double font = fontSizeFor(kHeight);
    int n = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = std::max(0, int(from * font)); x < std::min<double>(image.width, to * font); ++x)
        n += isNear(image, x, y, colour, kSame);
    return n;
  }
  std::unique_ptr<test::TestDisplay> display_;
  Eigen::Vector2d legend_;
  std::map<std::string, Box> texts_;  ///< what is shown of them, window px, y up
};

constexpr double kSwatch = 3.0, kWide = 40;  // where swatches end and texts begin, where texts have ended: in heights of the text

TEST_F(LegendPicture, AnEntryHasAStrokeOfItsColourAndATextInThatOfTexts) {
  for (const bool dark : {true, false}) {
    SCOPED_TRACE(dark);
    const Image image = picture(800, dark, [](Annotations& a) { a.setLegend({{kOrange, "primal"}}, {}, {}, "title"); });
    EXPECT_GT(count(image, kOrange, 0, kSwatch), 30);
    EXPECT_EQ(count(image, kOrange, kSwatch, kWide), 0);
    EXPECT_GT(count(image, dark ? kTextOnDark : kTextOnLight, kSwatch, kWide), 30);
    const Image hidden = picture(800, dark, [](Annotations& a) {
      a.setLegend({{kOrange, "primal"}}, {}, {}, "title");
      a.place({0, 0, 0});  // it was there before
      a.setLegendVisible(false);
    });
    EXPECT_EQ(count(hidden, kOrange, 0, kWide), 0);
    EXPECT_EQ(legend_, Eigen::Vector2d(0, 0));
  }
}

/// White is told from a light background by its edge.
TEST_F(LegendPicture, AColourLikeTheBackgroundHasAnEdge) {
  const auto edge = [&](bool dark, const Colour& colour) {
    const Image image = picture(800, dark, [&](Annotations& a) { a.setLegend({{colour, " "}}, {}, {}, " "); });
    return count(image, dark ? kTextOnDark : kTextOnLight, 0, kSwatch);
  };
  EXPECT_GT(edge(false, kWhite), 20);
  EXPECT_EQ(edge(false, {0, 0.2, 0.6}), 0);
  EXPECT_GT(edge(true, {0.1, 0.1, 0.2}), 20);
}

/// Bright texts over a bright photograph: 85 % of the dark ground and 15 % of what lies beneath, on which they have 9 : 1.
TEST_F(LegendPicture, OverAPhotographItStandsOnAPanel) {
  const auto pixels = [&](bool onPicture) {
    const Image image = picture(800, false, [&](Annotations& a) {
      a.setDark(true);
      a.setOnPicture(onPicture);
      a.setLegend({{kOrange, "primal"}, {kMagenta, "dual"}}, {}, {}, "a title");
    });
    return count(image, {0.2305, 0.239, 0.256}, 0.5, 6);
  };
  const double font = fontSizeFor(kHeight);
  EXPECT_GT(pixels(true), 2 * font * font) << "two rows of texts and what lies between them";
  EXPECT_LT(pixels(false), font) << "but for the smoothed edges of letters";
}

/// How many rows of pixels lie between the strokes of two neighbouring entries of the list; nothing if the first is left
/// out.
TEST_F(LegendPicture, ALongLegendSharesRowsAndALowPictureKeepsOnlyWhatItHasToShow) {
  const auto between = [&](int width, int others) -> std::optional<int> {
    const Image image = picture(width, true, [others](Annotations& a) {
      std::vector<LegendEntry> entries{{kOrange, "first"}, {kMagenta, "second"}};
      for (int i = 0; i < others; ++i) entries.push_back({kWhite, "another"});
      entries.push_back({kBlueEntry, "model", true});
      a.setLegend(entries, {}, {}, "title");
    });
    EXPECT_GT(count(image, kBlueEntry, 0, kSwatch), 30) << width << ", " << others;
    const auto firstRow = [&](const Colour& colour) {
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          if (isNear(image, x, y, colour, kSame)) return y;
      return -1;
    };
    const int first = firstRow(kOrange), second = firstRow(kMagenta);
    EXPECT_EQ(first < 0, second < 0);
    return first < 0 ? std::nullopt : std::optional(second - first);
  };
  for (const int width : {360, 800}) {  // a narrow picture has the same rows: all of it is seen at 1366 x 768
    const std::optional<int> own = between(width, 2);
    ASSERT_TRUE(own) << width;
    EXPECT_GT(*own, 10) << width;
    EXPECT_EQ(between(width, 9), std::optional(0)) << width;
    EXPECT_FALSE(between(width, 40)) << width;
  }
}

TEST_F(LegendPicture, NotesAreInTheColourOfWhatFailedAndRemarksAreFaint) {
  const auto redAndGrey = [&](const std::vector<std::string>& notes, const std::vector<std::string>& remarks) {
    const Image image = picture(800, true, [&](Annotations& a) { a.setLegend({}, notes, remarks, " "); });
    int red = 0, grey = 0;
    for (int y = 0; y < image.height / 2; ++y)
      for (int x = 0; x < image.width / 2; ++x) {
        const double r = image.at(x, y, 0), g = image.at(x, y, 1), b = image.at(x, y, 2);
        red += r > 0.5 && r > 1.4 * std::max(g, b);
        grey += r > 0.45 && std::abs(r - g) < 0.1 && std::abs(r - b) < 0.1;
      }
    return std::array<bool, 2>{red > 30, grey > 30};
  };
  EXPECT_EQ(redAndGrey({}, {}), (std::array<bool, 2>{false, false}));
  EXPECT_EQ(redAndGrey({"the fit of dual failed"}, {}), (std::array<bool, 2>{true, false}));
  EXPECT_EQ(redAndGrey({}, {"photographs: 25 of 100 cameras"}), (std::array<bool, 2>{false, true}));
}

TEST_F(LegendPicture, WhatThereIsNoRoomForEndsInAnEllipsis) {
  const std::string title = "vase, frame 0045 (held out)", entry = "canonical 0.39 %",
                    note = "primal: not reached: no prediction überlappt this highlight, nor any other one";
  const auto fill = [&](Annotations& a) { a.setLegend({{kOrange, entry, true}}, {note}, {}, title); };
  for (const bool dark : {true, false}) {
    picture(320, dark, fill);
    EXPECT_TRUE(texts_.count(title)) << "what fits stays";
    EXPECT_TRUE(texts_.count(entry));
    EXPECT_FALSE(texts_.count(note));
    bool found = false;
    for (const auto& [text, box] : texts_) {
      if (text.empty() || text.front() != 'p') continue;
      found = true;
      const std::string dots = "…", kept = text.substr(0, text.size() - dots.size());
      EXPECT_EQ(text, kept + dots);
      EXPECT_EQ(note.substr(0, kept.size()), kept);
      EXPECT_GT(kept.size(), 20u);
    }
    EXPECT_TRUE(found);
  }
  picture(800, true, fill);
  EXPECT_TRUE(texts_.count(note)) << "whole where there is room";
  std::set<std::string> cut;
  for (int width = 200; width < 420; width += 10) {
    picture(width, true, fill);
    for (const auto& [text, box] : texts_) {
      if (text.empty() || text.find(" at the surface") != std::string::npos) continue;  // ends at its place
      EXPECT_LE(box.x + box.width, width) << text;
      cut.insert(text);
    }
  }
  for (const std::string& text : cut) EXPECT_EQ(text.find("\xC3…"), std::string::npos) << "half a character";
}

/// A label on the lines of a camera is hard to read; where there is nothing else, it is still better than none.
TEST(LabelPlaces, KeepOffCamerasWhereThereIsRoom) {
  const Eigen::Vector2d at(200, 200), size(80, 14), picture(400, 400);
  constexpr double kFont = 14;
  const std::optional<Rectangle> first = placeForLabel(at, size, picture, kFont, {}, {});
  ASSERT_TRUE(first);
  EXPECT_GT(first->x, at.x());
  const Rectangle beside{first->x + 30, first->y - 5, 20, 30};  // a camera to the right of the point
  const std::optional<Rectangle> off = placeForLabel(at, size, picture, kFont, {}, {beside});
  ASSERT_TRUE(off);
  EXPECT_FALSE(off->overlaps(beside));
  const Rectangle all{0, 0, 400, 400};
  const std::optional<Rectangle> over = placeForLabel(at, size, picture, kFont, {}, {all});
  ASSERT_TRUE(over);
  EXPECT_EQ(over->x, first->x);
  EXPECT_EQ(over->y, first->y);
  EXPECT_FALSE(placeForLabel(at, size, picture, kFont, {all}, {}));
}

/// As far from the tip at every zoom: no corner of the text is nearer along the arrow than the gap, and its middle is on the
/// arrow's line.
TEST(LabelPlaces, ALetterStandsInFrontOfItsArrowsTip) {
  const Eigen::Vector2d tip(200, 180), size(12, 16), picture(400, 400);
  constexpr double kFont = 20, kGap = 6;
  for (int degrees = 0; degrees < 360; degrees += 15) {
    SCOPED_TRACE(degrees);
    const double a = degrees * std::numbers::pi / 180;
    const Eigen::Vector2d along(std::cos(a), std::sin(a));
    for (const double length : {5.0, 80.0, 3000.0}) {
      const std::optional<Rectangle> r = placeAtTip(tip, length * along, size, picture, kFont, {});
      ASSERT_TRUE(r);
      double nearest = 1e9;
      for (const double x : {r->x, r->x + r->width})
        for (const double y : {r->y, r->y + r->height}) nearest = std::min(nearest, (Eigen::Vector2d(x, y) - tip).dot(along));
      EXPECT_NEAR(nearest, kGap, 1e-9);
      const Eigen::Vector2d middle(r->x + 0.5 * r->width - tip.x(), r->y + 0.5 * r->height - tip.y());
      EXPECT_NEAR(middle.x() * along.y() - middle.y() * along.x(), 0, 1e-9);
      EXPECT_FALSE(placeAtTip(tip, length * along, size, picture, kFont, {*r})) << "taken";
    }
  }
  EXPECT_FALSE(placeAtTip(tip, {0.5, 0}, size, picture, kFont, {})) << "seen from its end";
  EXPECT_FALSE(placeAtTip({398, 180}, {50, 0}, size, picture, kFont, {})) << "out of the picture";
}

TEST(LabelPlaces, KeepOffWhatIsDrawnAtTheirPoint) {
  const Eigen::Vector2d at(200, 200), size(80, 14), picture(400, 400);
  constexpr double kFont = 14;
  for (const double clear : {3.0, 20.0, 70.0}) {
    const std::optional<Rectangle> r = placeForLabel(at, size, picture, kFont, {}, {}, clear);
    ASSERT_TRUE(r);
    EXPECT_GT(r->x, at.x() + clear);
    EXPECT_LT(r->x, at.x() + clear + kFont) << "and is seen to belong to it";
  }
}

TEST_F(LegendPicture, ALetterStandsAtTheTipOfItsArrow) {
  // VTK's first camera looks at the origin, which is in the middle of the picture.
  picture(800, true, [](Annotations& a) { a.setLabels({{{0, 0, 0}, "N", kMagenta, Eigen::Vector3d(-0.1, 0, 0)}}); });
  ASSERT_TRUE(texts_.count("N"));
  const Box& box = texts_["N"];
  EXPECT_GT(box.x, 400);
  EXPECT_LT(box.x, 400 + fontSizeFor(kHeight));
  EXPECT_NEAR(box.y + 0.5 * box.height, 0.5 * kHeight, 1.5);
}

TEST(ErrorText, HasThreeSignificantDigits) {
  EXPECT_EQ(errorText(0), "0.00");
  EXPECT_EQ(errorText(0.0512), "0.05");
  EXPECT_EQ(errorText(2.666), "2.67");
  EXPECT_EQ(errorText(9.994), "9.99");
  EXPECT_EQ(errorText(9.996), "10.0");
  EXPECT_EQ(errorText(47.13), "47.1");
  EXPECT_EQ(errorText(99.96), "100");
  EXPECT_EQ(errorText(999.6), "1000");
  EXPECT_EQ(errorText(1009.84), "1010");
  EXPECT_EQ(errorText(123456), "123000");
  EXPECT_EQ(errorText(std::nan("")), "-");
}

TEST_F(LegendPicture, LabelsNeverLieOverOneAnother) {
  constexpr int kLabels = 30;
  const auto fill = [](Annotations& a) {
    std::vector<DrawnLabel> labels;
    for (int i = 0; i < kLabels; ++i) labels.push_back({{0.002 * i, 0, 0}, "label of point " + std::to_string(i), kMagenta});
    a.setLabels(labels);
  };
  for (const int width : {200, 320, 800}) {
    SCOPED_TRACE(width);
    picture(width, true, fill);
    std::vector<Box> shown;
    for (const auto& [text, box] : texts_)
      if (text.find("label") == 0) shown.push_back(box);
    EXPECT_GE(shown.size(), 5u);
    for (std::size_t i = 0; i < shown.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Box &a = shown[i], &b = shown[j];
        EXPECT_FALSE(a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height) << i << " " << j;
      }
  }
}

/// In a presentation all of them are larger, and the legend reaches as much farther.
TEST_F(LegendPicture, AllTextsGrowTogether) {
  const auto fill = [](double scale) {
    return [scale](Annotations& a) {
      a.setTextScale(scale);
      a.setLegend({{kOrange, "primal"}}, {"a note"}, {}, "a title");
      a.setLabels({{{0.1, 0, 0}, "label", kMagenta}});
    };
  };
  picture(900, true, fill(1));
  const std::map<std::string, Box> usual = texts_;
  const Eigen::Vector2d legend = legend_;
  picture(900, true, fill(2));
  ASSERT_EQ(texts_.size(), usual.size());
  for (const auto& [text, box] : usual) {
    if (text.size() < 3) continue;
    ASSERT_TRUE(texts_.count(text)) << text;
    EXPECT_NEAR(texts_[text].width / box.width, 2, 0.25) << text;  // whole points and pixels
  }
  EXPECT_NEAR(legend_.y() / legend.y(), 2, 0.2);
}

/// The label of a point that lies under the legend stands beside it.
TEST_F(LegendPicture, LabelsLeaveItFree) {
  const Image image = picture(800, true, [](Annotations& a) {
    a.setLegend({{kOrange, "primal, with a long text"}, {kOrange, "dual, with a long text"}}, {}, {}, "a title");
    a.setLabels({{{-0.42, 0.25, 0}, "label", kMagenta}});  // seen from VTK's first camera, at distance 1
  });
  ASSERT_GT(legend_.x(), 50);
  int under = 0, all = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (!isNear(image, x, y, kMagenta, 0.25)) continue;
      ++all;
      under += x < legend_.x() - 2 && y < legend_.y() - 2;
    }
  EXPECT_GT(all, 10);
  EXPECT_EQ(under, 0);
}

}  // namespace
}  // namespace glint::viz
