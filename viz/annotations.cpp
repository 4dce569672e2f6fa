// SPDX-License-Identifier: BSD-3-Clause
#include "viz/annotations.h"

#include <vtkActor2D.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCoordinate.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

namespace glint::viz {
namespace {

/// A set of lines in display pixels.
struct Strokes {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkActor2D> actor;

  Strokes() {
    data->SetPoints(points);
    data->SetLines(lines);
    vtkNew<vtkPolyDataMapper2D> mapper;
    vtkNew<vtkCoordinate> display;
    display->SetCoordinateSystemToDisplay();
    mapper->SetTransformCoordinate(display);
    mapper->SetInputData(data);
    actor->SetMapper(mapper);
    actor->PickableOff();
  }
  void clear() {
    points->Reset();
    lines->Reset();
  }
  void add(double x0, double y0, double x1, double y1) {
    const vtkIdType a = points->InsertNextPoint(x0, y0, 0), b = points->InsertNextPoint(x1, y1, 0);
    lines->InsertNextCell({a, b});
  }
  void finish(const Colour& colour, double width) {
    points->Modified();
    lines->Modified();
    data->Modified();
    actor->GetProperty()->SetColor(colour[0], colour[1], colour[2]);
    actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  }
};

void setColour(vtkTextActor* actor, const Colour& colour) { actor->GetTextProperty()->SetColor(colour[0], colour[1], colour[2]); }

vtkSmartPointer<vtkTextActor> textActor(const std::string& text, const Colour& colour) {
  auto actor = vtkSmartPointer<vtkTextActor>::New();
  actor->SetInput(text.c_str());
  actor->SetTextScaleModeToNone();
  actor->GetPositionCoordinate()->SetCoordinateSystemToDisplay();
  actor->PickableOff();
  setColour(actor, colour);
  if (!fontFile().empty()) {
    actor->GetTextProperty()->SetFontFamily(VTK_FONT_FILE);
    actor->GetTextProperty()->SetFontFile(fontFile().c_str());
  }
  return actor;
}

double luminance(const Colour& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/// A colour of the palette made readable as text on the background, keeping its hue.
Colour asText(const Colour& colour, bool dark) {
  Colour c = colour;
  for (int i = 0; i < 12 && (dark ? luminance(c) < 0.30 : luminance(c) > 0.42); ++i) {
    for (double& v : c) v = dark ? v + 0.15 * (1 - v) : 0.85 * v;
  }
  return c;
}

}  // namespace

std::string fontFile() {
  static const std::string file = [] {
    for (const char* candidate : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf"}) {
      std::error_code ignored;
      if (std::filesystem::exists(candidate, ignored)) return std::string(candidate);
    }
    return std::string{};
  }();
  return file;
}

int fontSizeFor(int windowHeight) { return std::clamp(windowHeight / 55, 11, 40); }

double roundLength(double limit) {
  const double decade = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= limit * (1 + 1e-12)) return factor * decade;
  }
  return decade;
}

std::string lengthText(double metres) {
  struct Unit {
    double size;
    const char* name;
  };
  static constexpr std::array<Unit, 5> units{{{1e3, "km"}, {1, "m"}, {1e-2, "cm"}, {1e-3, "mm"}, {1e-6, "um"}}};
  for (const Unit& unit : units) {
    if (metres >= unit.size * (1 - 1e-9) || unit.size == 1e-6) {
      char text[48];
      std::snprintf(text, sizeof text, "%.4g %s", metres / unit.size, unit.name);
      return text;
    }
  }
  return {};
}

struct Annotations::Impl {
  vtkRenderer* renderer = nullptr;
  bool dark = true;
  std::vector<std::pair<vtkSmartPointer<vtkTextActor>, Colour>> legend;  // title first, then entries, then notes
  std::vector<std::unique_ptr<Strokes>> swatches;                        // one for each legend entry
  std::vector<std::unique_ptr<Strokes>> outlines;                        // beneath them
  std::vector<char> entryAlways;
  std::size_t entries = 0;
  std::vector<DrawnLabel> labels;
  std::vector<vtkSmartPointer<vtkTextActor>> labelActors;
  Strokes bar;
  vtkSmartPointer<vtkTextActor> barText = textActor("", kTextOnDark);
  std::array<Strokes, 3> axes;
  std::array<vtkSmartPointer<vtkTextActor>, 3> axisTexts;

  Colour ink() const { return dark ? kTextOnDark : kTextOnLight; }
  void background(vtkTextActor* actor, double opacity) const {
    const Colour& c = dark ? kDarkBackground : kLightBackground;
    actor->GetTextProperty()->SetBackgroundColor(c[0], c[1], c[2]);
    actor->GetTextProperty()->SetBackgroundOpacity(opacity);
  }
  /// Pixels of a text size of 1: VTK's text sizes are points at 72 dots an inch.
  double pixelsPerPoint() const {
    vtkRenderWindow* window = renderer->GetRenderWindow();
    return window && window->GetDPI() > 0 ? window->GetDPI() / 72.0 : 1;
  }
  /// @param points  size of the text for VTK. @param font  its height in pixels
  void placeLegend(int height, int points, double font, bool narrow) {
    const double row = 1.5 * font, left = 0.9 * font;
    double y = height - 1.9 * font;
    for (std::size_t i = 0; i < legend.size(); ++i) {
      auto& [actor, colour] = legend[i];
      const bool entry = i >= 1 && i <= entries;
      const bool shown = !narrow || !entry || entryAlways[i - 1];
      actor->SetVisibility(shown);
      if (entry) swatches[i - 1]->actor->SetVisibility(shown);
      if (entry) outlines[i - 1]->actor->SetVisibility(shown);
      if (!shown) continue;
      actor->GetTextProperty()->SetFontSize(i == 0 ? points + 1 : points);
      setColour(actor, entry || i == 0 ? ink() : asText(colour, dark));
      background(actor, 0.55);
      actor->SetPosition(left + (entry ? 2.4 * font : 0), y);
      if (entry) {
        Strokes& swatch = *swatches[i - 1];
        swatch.clear();
        swatch.add(left, y + 0.42 * font, left + 1.8 * font, y + 0.42 * font);
        const double width = std::max(3.0, font / 4.0);
        swatch.finish(colour, width);
        // White on a light background is told by its edge, as the contour itself is.
        Strokes& outline = *outlines[i - 1];
        outline.clear();
        const bool faint = std::abs(luminance(colour) - luminance(dark ? kDarkBackground : kLightBackground)) < 0.25;
        if (faint) outline.add(left - 1, y + 0.42 * font, left + 1.8 * font + 1, y + 0.42 * font);
        outline.finish(ink(), width + 2);
      }
      y -= row;
    }
  }
  void placeLabels(int width, int height, int points, double font) {
    std::vector<std::array<double, 4>> taken;
    const Eigen::Vector3d eye = toEigen(renderer->GetActiveCamera()->GetPosition());
    const Eigen::Vector3d axis = toEigen(renderer->GetActiveCamera()->GetDirectionOfProjection());
    for (std::size_t i = 0; i < labels.size(); ++i) {
      vtkTextActor* actor = labelActors[i];
      const bool inFront = axis.dot(labels[i].anchor - eye) > 0;
      renderer->SetWorldPoint(labels[i].anchor.x(), labels[i].anchor.y(), labels[i].anchor.z(), 1);
      renderer->WorldToDisplay();
      double display[3];
      renderer->GetDisplayPoint(display);
      const bool inside = inFront && display[0] > -0.05 * width && display[0] < 1.05 * width && display[1] > -0.05 * height &&
                          display[1] < 1.05 * height;
      actor->SetVisibility(inside);
      if (!inside) continue;
      actor->GetTextProperty()->SetFontSize(points);
      setColour(actor, asText(labels[i].colour, dark));
      background(actor, 0.6);
      double size[2];
      actor->GetSize(renderer, size);
      const double x = std::clamp(display[0] + 0.8 * font, 2.0, std::max(2.0, width - size[0] - 4));
      double y = std::clamp(display[1] + 0.3 * font, 2.0, std::max(2.0, height - size[1] - 4));
      // Labels of close points are stacked upwards instead of printed over each other.
      for (bool moved = true; moved;) {
        moved = false;
        for (const auto& t : taken) {
          if (x < t[0] + t[2] && t[0] < x + size[0] && y < t[1] + t[3] && t[1] < y + size[1]) {
            y = t[1] + t[3] + 2;
            moved = true;
          }
        }
      }
      taken.push_back({x, y, size[0], size[1]});
      actor->SetPosition(x, y);
    }
  }
  void placeBar(int width, int height, int points, double font, const Eigen::Vector3d& reference) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const Eigen::Vector3d eye = toEigen(camera->GetPosition()), axis = toEigen(camera->GetDirectionOfProjection());
    const double depth = axis.dot(reference - eye);
    const bool visible = depth > 0;
    bar.actor->SetVisibility(visible);
    barText->SetVisibility(visible);
    if (!visible) return;
    const double metresPerPixel = camera->GetParallelProjection()
                                      ? 2 * camera->GetParallelScale() / height
                                      : 2 * depth * std::tan(camera->GetViewAngle() * std::numbers::pi / 360) / height;
    const double length = roundLength(0.16 * width * metresPerPixel), pixels = length / metresPerPixel;
    const double x1 = width - 1.2 * font, x0 = x1 - pixels, y = 1.1 * font, tick = 0.35 * font;
    bar.clear();
    bar.add(x0, y, x1, y);
    bar.add(x0, y - tick, x0, y + tick);
    bar.add(x1, y - tick, x1, y + tick);
    bar.finish(ink(), std::max(2.0, font / 7.0));
    barText->SetInput((lengthText(length) + " at the surface").c_str());
    barText->GetTextProperty()->SetFontSize(points);
    barText->GetTextProperty()->SetJustificationToRight();
    setColour(barText, ink());
    background(barText, 0.4);
    barText->SetPosition(x1, y + 0.6 * font);
  }
  void placeAxes(int points, double font) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const Eigen::Vector3d forward = toEigen(camera->GetDirectionOfProjection()).normalized();
    const Eigen::Vector3d right = forward.cross(toEigen(camera->GetViewUp())).normalized(), up = right.cross(forward);
    const double size = 2.8 * font, x0 = 4.2 * font, y0 = 4.2 * font;
    static constexpr std::array<Colour, 3> colours{{{0.86, 0.30, 0.30}, {0.35, 0.68, 0.33}, {0.33, 0.52, 0.90}}};
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i));
      const double dx = size * axis.dot(right), dy = size * axis.dot(up);
      axes[i].clear();
      axes[i].add(x0, y0, x0 + dx, y0 + dy);
      axes[i].finish(colours[i], std::max(2.0, font / 6.0));
      vtkTextActor* text = axisTexts[i];
      text->GetTextProperty()->SetFontSize(points);
      setColour(text, asText(colours[i], dark));
      text->GetTextProperty()->SetJustificationToCentered();
      text->GetTextProperty()->SetVerticalJustificationToCentered();
      text->SetPosition(x0 + 1.3 * dx, y0 + 1.3 * dy);
      text->SetVisibility(std::hypot(dx, dy) > 0.25 * size);
    }
  }
};

Annotations::Annotations(vtkRenderer* renderer) : impl_(std::make_unique<Impl>()) {
  impl_->renderer = renderer;
  renderer->AddActor2D(impl_->bar.actor);
  renderer->AddActor2D(impl_->barText);
  const std::array<const char*, 3> names{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    impl_->axisTexts[i] = textActor(names[i], kTextOnDark);
    renderer->AddActor2D(impl_->axes[i].actor);
    renderer->AddActor2D(impl_->axisTexts[i]);
  }
}

Annotations::~Annotations() = default;

void Annotations::setLegend(const std::vector<LegendEntry>& entries, const std::vector<std::string>& notes,
                            const std::vector<std::string>& remarks, const std::string& title) {
  for (auto& [actor, colour] : impl_->legend) impl_->renderer->RemoveActor2D(actor);
  for (auto& swatch : impl_->swatches) impl_->renderer->RemoveActor2D(swatch->actor);
  for (auto& outline : impl_->outlines) impl_->renderer->RemoveActor2D(outline->actor);
  impl_->legend.clear();
  impl_->swatches.clear();
  impl_->outlines.clear();
  impl_->entryAlways.clear();
  impl_->entries = entries.size();
  impl_->legend.emplace_back(textActor(title, impl_->ink()), impl_->ink());
  for (const LegendEntry& entry : entries) {
    impl_->legend.emplace_back(textActor(entry.text, impl_->ink()), entry.colour);
    impl_->entryAlways.push_back(entry.always);
    impl_->outlines.push_back(std::make_unique<Strokes>());
    impl_->renderer->AddActor2D(impl_->outlines.back()->actor);
    impl_->swatches.push_back(std::make_unique<Strokes>());
    impl_->renderer->AddActor2D(impl_->swatches.back()->actor);
  }
  for (const std::string& note : notes) impl_->legend.emplace_back(textActor(note, kFailed), kFailed);
  for (const std::string& remark : remarks) impl_->legend.emplace_back(textActor(remark, kHeldOut), kHeldOut);
  for (auto& [actor, colour] : impl_->legend) impl_->renderer->AddActor2D(actor);
}

void Annotations::setLabels(const std::vector<DrawnLabel>& labels) {
  for (auto& actor : impl_->labelActors) impl_->renderer->RemoveActor2D(actor);
  impl_->labelActors.clear();
  impl_->labels = labels;
  for (const DrawnLabel& label : labels) {
    impl_->labelActors.push_back(textActor(label.text, label.colour));
    impl_->renderer->AddActor2D(impl_->labelActors.back());
  }
}

void Annotations::setDark(bool dark) { impl_->dark = dark; }

void Annotations::place(const Eigen::Vector3d& reference) {
  const int* size = impl_->renderer->GetSize();
  if (size[0] <= 0 || size[1] <= 0) return;
  const double scale = impl_->pixelsPerPoint();
  const int points = fontSizeFor(static_cast<int>(size[1] / scale));
  const double font = scale * points;
  impl_->placeLegend(size[1], points, font, size[0] < scale * kNarrowPicture);
  impl_->placeLabels(size[0], size[1], points, font);
  impl_->placeBar(size[0], size[1], points, font, reference);
  impl_->placeAxes(points, font);
}

}  // namespace glint::viz
