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
#include <filesystem>
#include <numbers>
#include <optional>
#include <utility>

#include "core/draw/contrast.h"
#include "viz/label_places.h"
#include "viz/legend_panel.h"
#include "viz/text_lock.h"

namespace glint::viz {
namespace {

constexpr double kLeastLegend = 9;      // width of a view, in heights of the text, that has room for a legend
constexpr double kClearSwatch = 2;      // contrast from which a swatch is told from the ground without an edge
constexpr double kColourBarRows = 7.8;  // lines of text from the lower edge to above the title of the colour bar

/// A set of lines in display pixels.
struct Strokes {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkPolyData> data;
  vtkNew<vtkActor2D> actor;
  Eigen::Vector2d origin{0, 0};  ///< of the viewport in the window

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
    const vtkIdType a = points->InsertNextPoint(origin.x() + x0, origin.y() + y0, 0),
                    b = points->InsertNextPoint(origin.x() + x1, origin.y() + y1, 0);
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

/// A colour of the palette made readable as text on the background.
Colour asText(const Colour& colour, bool dark) { return draw::readableOn(dark ? kDarkBackground : kLightBackground, colour); }

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

struct Annotations::Impl {
  vtkRenderer* renderer = nullptr;
  bool dark = true;
  std::vector<std::pair<vtkSmartPointer<vtkTextActor>, Colour>> legend;  // title first, then entries, then notes
  struct Fitted {
    std::string text;  // whole
    double room = 0;   // px, that it was shortened to
    int points = 0;
  };
  std::vector<Fitted> legendTexts;                 // of `legend`
  std::vector<std::unique_ptr<Strokes>> swatches;  // one for each legend entry
  std::vector<std::unique_ptr<Strokes>> outlines;  // beneath them
  std::vector<char> entryAlways;
  std::size_t entries = 0;
  std::vector<DrawnLabel> labels;
  std::vector<vtkSmartPointer<vtkTextActor>> labelActors;
  Strokes bar;
  vtkSmartPointer<vtkTextActor> barText = textActor("", kTextOnDark);
  std::array<Strokes, 3> axes;
  std::array<vtkSmartPointer<vtkTextActor>, 3> axisTexts;
  std::vector<std::unique_ptr<Strokes>> barSteps;  // of the colour bar
  std::optional<ColourBar> scale;
  std::vector<vtkSmartPointer<vtkTextActor>> scaleTexts;  // title, then ticks
  Strokes border, handle;
  Border borderKind = Border::None;
  vtkSmartPointer<vtkTextActor> name = textActor("", kTextOnDark), badge = textActor("", kTextOnDark);
  bool legendVisible = true, titleVisible = true;
  LegendPanel panel;
  bool onPicture = false;
  double textScale = 1;

  std::vector<Rectangle> taken;  // by what stands still: labels keep off it
  std::vector<Points> glyphs;    // corners of each drawn camera: labels keep off those where they can
  Eigen::Vector2d origin{0, 0};

  void move(vtkTextActor* actor, double x, double y) const { actor->SetPosition(origin.x() + x, origin.y() + y); }
  Eigen::Vector2d sizeOf(vtkTextActor* actor) const {
    double size[2] = {0, 0};
    const std::lock_guard lock(textMutex());
    actor->GetSize(renderer, size);
    return {size[0], size[1]};
  }
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
  int pointsFor(int height) const {
    return static_cast<int>(std::lround(textScale * fontSizeFor(static_cast<int>(height / pixelsPerPoint()))));
  }
  /// What of a legend's text there is room for, ending in "…". Measured again only when room or size have changed.
  void fitLegendText(std::size_t i, double room, int points) {
    Fitted& f = legendTexts[i];
    if (f.room == room && f.points == points) return;
    f.room = room;
    f.points = points;
    vtkTextActor* actor = legend[i].first;
    actor->SetInput(f.text.c_str());
    if (sizeOf(actor).x() <= room) return;
    // Laying out a text takes long for one that is tried at every length: halve what is in question.
    const auto shorter = [&](std::size_t length) {
      while (length > 0 && (static_cast<unsigned char>(f.text[length]) & 0xC0) == 0x80) --length;  // whole characters
      return f.text.substr(0, length) + "…";
    };
    std::size_t fits = 0, tooLong = f.text.size();
    while (tooLong - fits > 1) {
      const std::size_t middle = (fits + tooLong) / 2;
      actor->SetInput(shorter(middle).c_str());
      (sizeOf(actor).x() <= room ? fits : tooLong) = middle;
    }
    actor->SetInput(shorter(fits).c_str());
  }
  /// Optional entries share rows if one for each would take too much of the picture. A low picture leaves them out.
  enum class LegendRows { Own, Shared, Fewer };
  LegendRows legendRows(double rowHeight, int height) const {
    const auto rows = [&](double each) {
      double count = double(legend.size()) - double(entries);
      for (const bool always : entryAlways) count += always ? 1 : each;
      return count * rowHeight;
    };
    constexpr double kShare = 0.3, kMost = 0.5, kInARow = 2;
    return rows(1) <= kShare * height            ? LegendRows::Own
           : rows(1 / kInARow) <= kMost * height ? LegendRows::Shared
                                                 : LegendRows::Fewer;
  }
  /// @param points  size of the text for VTK. @param font  its height in pixels
  void placeLegend(int width, int height, int points, double font) {
    const double row = 1.5 * font, left = 0.9 * font;
    const LegendRows rows = legendRows(row, height);
    const bool room = width > kLeastLegend * font;              // one that is a row of "…" says nothing
    double y = height - 0.4 * font - (titleVisible ? 0 : row);  // the view's name is beside the title's place
    double next = width;                                        // where the next entry begins if it shares the row
    const std::size_t before = taken.size();
    for (std::size_t i = 0; i < legend.size(); ++i) {
      auto& [actor, colour] = legend[i];
      const bool entry = i >= 1 && i <= entries, always = !entry || entryAlways[i - 1];
      const bool shown = legendVisible && room && (i > 0 || titleVisible) && (rows != LegendRows::Fewer || always);
      actor->SetVisibility(shown);
      if (entry) swatches[i - 1]->actor->SetVisibility(shown);
      if (entry) outlines[i - 1]->actor->SetVisibility(shown);
      if (!shown) continue;
      const double indent = entry ? 2.4 * font : 0;
      const int size = i == 0 ? points + 1 : points;
      actor->GetTextProperty()->SetFontSize(size);
      setColour(actor, entry || i == 0 ? ink() : asText(colour, dark));
      background(actor, onPicture ? 0 : 0.55);  // first: with it a text is larger
      fitLegendText(i, width - 2 * left - indent, size);
      const double wide = indent + sizeOf(actor).x();
      const bool shares = rows == LegendRows::Shared && !always && next + wide <= width - left;
      const double start = shares ? next : left, x = start + indent;
      if (!shares) y -= row;
      next = always ? width : start + wide + font;
      move(actor, x, y);
      taken.push_back({0, y - 0.3 * font, x + sizeOf(actor).x(), row});
      if (entry) {
        Strokes& swatch = *swatches[i - 1];
        swatch.clear();
        swatch.origin = origin;
        swatch.add(start, y + 0.42 * font, start + 1.8 * font, y + 0.42 * font);
        const double stroke = std::max(3.0, font / 4.0);
        swatch.finish(colour, stroke);
        // White on a light background is told by its edge, as the contour itself is.
        Strokes& outline = *outlines[i - 1];
        outline.clear();
        outline.origin = origin;
        const bool faint = draw::contrast(colour, dark ? kDarkBackground : kLightBackground) < kClearSwatch;
        if (faint) outline.add(start - 1, y + 0.42 * font, start + 1.8 * font + 1, y + 0.42 * font);
        outline.finish(ink(), stroke + 2);
      }
    }
    panel.hide();
    if (!onPicture || taken.size() == before) return;
    Eigen::AlignedBox2d box;
    for (std::size_t i = before; i < taken.size(); ++i) {
      const Rectangle& r = taken[i];
      box.extend(Eigen::Vector2d(r.x, r.y)).extend(Eigen::Vector2d(r.x + r.width, r.y + r.height));
    }
    panel.show(origin.x() + 0.4 * font, origin.y() + box.min().y() - 0.3 * font, origin.x() + box.max().x() + 0.5 * font,
               origin.y() + box.max().y() + 0.3 * font, dark ? kDarkBackground : kLightBackground);
  }
  void placeLabels(int width, int height, int points, double font) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const Eigen::Vector3d eye = toEigen(camera->GetPosition()), axis = toEigen(camera->GetDirectionOfProjection());
    const auto inFront = [&](const Eigen::Vector3d& p) { return camera->GetParallelProjection() || axis.dot(p - eye) > 0; };
    const auto onScreen = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
      renderer->SetWorldPoint(p.x(), p.y(), p.z(), 1);
      renderer->WorldToDisplay();
      double display[3];
      renderer->GetDisplayPoint(display);
      return Eigen::Vector2d(display[0], display[1]) - origin;
    };
    std::vector<Rectangle> onGlyphs;
    for (const Points& corners : labels.empty() ? std::vector<Points>{} : glyphs) {
      if (!std::all_of(corners.begin(), corners.end(), inFront)) continue;
      Eigen::AlignedBox2d box;
      for (const Eigen::Vector3d& p : corners) box.extend(onScreen(p));
      onGlyphs.push_back({box.min().x(), box.min().y(), box.sizes().x(), box.sizes().y()});
    }
    const Eigen::Vector2d picture(width, height);
    const auto placeOf = [&](const DrawnLabel& label, const Eigen::Vector2d& at, const Eigen::Vector2d& size) {
      if (label.tail && inFront(*label.tail))
        if (const auto place = placeAtTip(at, at - onScreen(*label.tail), size, picture, font, taken)) return place;
      const double clear = label.clear > 0 ? label.clear * screenOf(label.anchor, rightOf(camera), label.clear).norm() : 0;
      return placeForLabel(at, size, picture, font, taken, onGlyphs, clear);
    };
    for (const bool atTip : {true, false}) {  // a letter has its one place at its arrow, other texts have several
      for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i].tail.has_value() != atTip) continue;
        vtkTextActor* actor = labelActors[i];
        const Eigen::Vector2d at = onScreen(labels[i].anchor);
        const bool inside = inFront(labels[i].anchor) && at.x() > -0.05 * width && at.x() < 1.05 * width &&
                            at.y() > -0.05 * height && at.y() < 1.05 * height;
        actor->SetVisibility(inside);
        if (!inside) continue;
        actor->GetTextProperty()->SetFontSize(points);
        setColour(actor, asText(labels[i].colour, dark));
        background(actor, 0.75);  // over lines, too
        const std::optional<Rectangle> place = placeOf(labels[i], at, sizeOf(actor));
        actor->SetVisibility(place.has_value());
        if (!place) continue;
        taken.push_back(*place);
        move(actor, place->x, place->y);
      }
    }
  }
  static Eigen::Vector3d rightOf(vtkCamera* camera) {
    return toEigen(camera->GetDirectionOfProjection()).cross(toEigen(camera->GetViewUp())).normalized();
  }
  /// How far a unit step at a world point goes on the screen, px; right for every projection, mirrored or enlarged.
  Eigen::Vector2d screenOf(const Eigen::Vector3d& at, const Eigen::Vector3d& direction, double step) const {
    Eigen::Vector2d ends[2];
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d p = at + i * step * direction;
      renderer->SetWorldPoint(p.x(), p.y(), p.z(), 1);
      renderer->WorldToDisplay();
      double display[3];
      renderer->GetDisplayPoint(display);
      ends[i] = {display[0], display[1]};
    }
    return (ends[1] - ends[0]) / step;
  }
  void placeBar(int width, int points, double font, const Eigen::Vector3d& reference) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const Eigen::Vector3d eye = toEigen(camera->GetPosition()), axis = toEigen(camera->GetDirectionOfProjection());
    const double depth = axis.dot(reference - eye);
    const bool visible = depth > 0;
    bar.actor->SetVisibility(visible);
    barText->SetVisibility(visible);
    if (!visible) return;
    const Eigen::Vector2d onScreen = screenOf(reference, rightOf(camera), 1e-3 * depth);
    const double metresPerPixel = 1 / onScreen.norm();
    if (!std::isfinite(metresPerPixel)) return;
    const double length = roundLength(0.16 * width * metresPerPixel), pixels = length / metresPerPixel;
    const double x1 = width - 1.2 * font, x0 = x1 - pixels, y = 1.1 * font, tick = 0.35 * font;
    bar.clear();
    bar.origin = origin;
    bar.add(x0, y, x1, y);
    bar.add(x0, y - tick, x0, y + tick);
    bar.add(x1, y - tick, x1, y + tick);
    bar.finish(ink(), std::max(2.0, font / 7.0));
    barText->SetInput((lengthText(length) + " at the surface").c_str());
    barText->GetTextProperty()->SetFontSize(points);
    barText->GetTextProperty()->SetJustificationToRight();
    setColour(barText, ink());
    background(barText, 0.4);
    move(barText, x1, y + 0.6 * font);
    const double reach = std::max(sizeOf(barText).x(), pixels);
    taken.push_back({x1 - reach - 4, 0, reach + 8 + 1.2 * font, y + 2 * font});
  }
  bool colourBarShown() const {
    return scale.has_value() && (legendVisible || borderKind == Border::None);  // views with the same legend have one bar
  }
  /// Draws the text above the scale bar.
  void placeColourBar(int width, int points, double font) {
    const bool shown = colourBarShown() && width > kLeastLegend * font;
    for (auto& text : scaleTexts) text->SetVisibility(shown);
    for (auto& step : barSteps) step->actor->SetVisibility(shown);
    if (!shown) return;
    // Beside the axes, also in a narrow picture.
    const double length = std::min({15 * font, 0.5 * width, std::max(4 * font, width - 14 * font)});
    const double x0 = width - 3 * font - length, y = 5.4 * font;
    const double step = length / static_cast<double>(barSteps.size());
    for (std::size_t i = 0; i < barSteps.size(); ++i) {
      Strokes& s = *barSteps[i];
      s.clear();
      s.origin = origin;
      const double x = x0 + step * static_cast<double>(i);
      s.add(x, y, x + step + 1, y);
      s.finish(scale->colours[i], 0.6 * font);
    }
    for (std::size_t i = 0; i < scaleTexts.size(); ++i) {
      vtkTextActor* text = scaleTexts[i];
      text->GetTextProperty()->SetFontSize(points);
      text->GetTextProperty()->SetJustificationToCentered();
      setColour(text, ink());
      background(text, 0.4);
    }
    // Texts are centred, but stay within the picture; of ticks that would touch, the ends stay.
    double left = x0 - 2 * font;
    const auto centred = [&](vtkTextActor* text, double x, double bottom) {
      const double half = 0.5 * sizeOf(text).x(), at = std::min(x, width - 0.5 * font - half);
      move(text, at, bottom);
      left = std::min(left, at - half);
      return std::pair(at - half, at + half);
    };
    centred(scaleTexts[0], x0 + 0.5 * length, y + 0.7 * font);
    std::vector<std::pair<double, double>> placed;
    const std::size_t ticks = scale->ticks.size();
    for (std::size_t k = 0; k < ticks; ++k) {
      const std::size_t i = k < 2 ? k * (ticks - 1) : k - 1;  // first, last, then those between
      vtkTextActor* text = scaleTexts[i + 1];
      const auto [from, to] = centred(text, x0 + scale->ticks[i].first * length, y - 1.7 * font);
      const bool touches = std::any_of(placed.begin(), placed.end(), [&, from = from, to = to](const auto& p) {
        return from < p.second + 0.4 * font && p.first < to + 0.4 * font;
      });
      text->SetVisibility(!touches);
      if (!touches) placed.emplace_back(from, to);
    }
    taken.push_back({left, y - 2 * font, width - left, 4.2 * font});
  }
  /// Height at which a text of the upper right corner is free, below what is there already.
  double below(double x, double y, const Eigen::Vector2d& size) const {
    for (const Rectangle& t : taken) {
      if (x < t.x + t.width && y < t.y + t.height && t.y < y + size.y()) y = t.y - size.y() - 3;
    }
    return y;
  }
  void placeBorder(int width, int height, int points, double font) {
    border.clear();
    border.origin = origin;
    handle.clear();
    handle.origin = origin;
    if (borderKind == Border::Around || borderKind == Border::Active) {
      border.add(0, 1, width, 1);
      border.add(0, height - 1, width, height - 1);
      border.add(1, 0, 1, height);
      border.add(width - 1, 0, width - 1, height);
    } else if (borderKind == Border::Wipe) {
      border.add(1, 0, 1, height);
      handle.add(1, 0.5 * height - 1.5 * font, 1, 0.5 * height + 1.5 * font);
    }
    border.finish(borderKind == Border::Active ? kActiveView : kHeldOut, borderKind == Border::Around ? 1 : 2);
    handle.finish(ink(), std::max(6.0, 0.5 * font));
    name->SetVisibility(name->GetInput() && *name->GetInput());
    if (name->GetVisibility()) {
      name->GetTextProperty()->SetFontSize(points);
      name->GetTextProperty()->SetJustificationToRight();
      setColour(name, ink());
      background(name, 0.6);
      const Eigen::Vector2d size = sizeOf(name);
      const double y = below(width - 0.9 * font - size.x(), height - 1.9 * font, size);
      move(name, width - 0.9 * font, y);
      taken.push_back({width - 0.9 * font - size.x(), y - 0.3 * font, size.x() + font, 2.2 * font});
    }
    badge->SetVisibility(badge->GetInput() && *badge->GetInput());
    if (!badge->GetVisibility()) return;
    vtkTextProperty* text = badge->GetTextProperty();
    text->SetFontSize(points + 1);
    text->BoldOn();
    text->SetJustificationToRight();
    setColour(badge, {1, 1, 1});
    text->SetBackgroundColor(0.75 * kActiveView[0], 0.75 * kActiveView[1], 0.75 * kActiveView[2]);
    text->SetBackgroundOpacity(0.9);
    // In the upper right corner, below whatever is there.
    const Eigen::Vector2d size = sizeOf(badge);
    const double x = width - 0.9 * font - size.x();
    const double y = below(x, height - 2.1 * font, size);
    move(badge, width - 0.9 * font, y);
    taken.push_back({x, y - 0.3 * font, size.x(), 2 * font});
  }
  void placeAxes(int points, double font, const Eigen::Vector3d& reference) {
    vtkCamera* camera = renderer->GetActiveCamera();
    const Eigen::Vector3d forward = toEigen(camera->GetDirectionOfProjection()).normalized();
    const Eigen::Vector3d up = rightOf(camera).cross(forward);
    const double step = 1e-3 * (reference - toEigen(camera->GetPosition())).norm();
    const bool mirrored = screenOf(reference, rightOf(camera), step).x() < 0;  // as through a virtual camera
    const Eigen::Vector3d right = (mirrored ? -1 : 1) * rightOf(camera);
    const double size = 2.8 * font, x0 = 4.2 * font, y0 = 4.2 * font;
    static constexpr std::array<Colour, 3> colours{{{0.86, 0.30, 0.30}, {0.35, 0.68, 0.33}, {0.33, 0.52, 0.90}}};
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i));
      const double dx = size * axis.dot(right), dy = size * axis.dot(up);
      axes[i].clear();
      axes[i].origin = origin;
      axes[i].add(x0, y0, x0 + dx, y0 + dy);
      axes[i].finish(colours[i], std::max(2.0, font / 6.0));
      vtkTextActor* text = axisTexts[i];
      text->GetTextProperty()->SetFontSize(points);
      setColour(text, asText(colours[i], dark));
      text->GetTextProperty()->SetJustificationToCentered();
      text->GetTextProperty()->SetVerticalJustificationToCentered();
      move(text, x0 + 1.3 * dx, y0 + 1.3 * dy);
      text->SetVisibility(std::hypot(dx, dy) > 0.25 * size);
    }
    taken.push_back({0, 0, x0 + 1.5 * size, y0 + 1.5 * size});
  }
};

Annotations::Annotations(vtkRenderer* renderer) : impl_(std::make_unique<Impl>()) {
  impl_->renderer = renderer;
  renderer->AddActor2D(impl_->panel.actor());  // beneath all that follows
  renderer->AddActor2D(impl_->bar.actor);
  renderer->AddActor2D(impl_->barText);
  const std::array<const char*, 3> names{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    impl_->axisTexts[i] = textActor(names[i], kTextOnDark);
    renderer->AddActor2D(impl_->axes[i].actor);
    renderer->AddActor2D(impl_->axisTexts[i]);
  }
  renderer->AddActor2D(impl_->border.actor);
  renderer->AddActor2D(impl_->handle.actor);
  renderer->AddActor2D(impl_->name);
  renderer->AddActor2D(impl_->badge);
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
  impl_->legendTexts.clear();
  for (auto& [actor, colour] : impl_->legend) {
    impl_->legendTexts.push_back({actor->GetInput()});
    impl_->renderer->AddActor2D(actor);
  }
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

void Annotations::setGlyphs(std::vector<Points> corners) { impl_->glyphs = std::move(corners); }

void Annotations::setColourBar(const std::optional<ColourBar>& bar) {
  for (auto& step : impl_->barSteps) impl_->renderer->RemoveActor2D(step->actor);
  for (auto& text : impl_->scaleTexts) impl_->renderer->RemoveActor2D(text);
  impl_->barSteps.clear();
  impl_->scaleTexts.clear();
  impl_->scale = bar;
  if (!bar) return;
  for (std::size_t i = 0; i < bar->colours.size(); ++i) {
    impl_->barSteps.push_back(std::make_unique<Strokes>());
    impl_->renderer->AddActor2D(impl_->barSteps.back()->actor);
  }
  impl_->scaleTexts.push_back(textActor(bar->title, impl_->ink()));
  for (const auto& [at, text] : bar->ticks) impl_->scaleTexts.push_back(textActor(text, impl_->ink()));
  for (auto& text : impl_->scaleTexts) impl_->renderer->AddActor2D(text);
}

void Annotations::setBadge(const std::string& text) { impl_->badge->SetInput(text.c_str()); }

void Annotations::setBorder(Border border, const std::string& name) {
  impl_->borderKind = border;
  impl_->name->SetInput(name.c_str());
}

void Annotations::setLegendVisible(bool visible, bool title) {
  impl_->legendVisible = visible;
  impl_->titleVisible = title;
}

Eigen::Vector2d Annotations::legendSize() {
  const int* size = impl_->renderer->GetSize();
  if (!impl_->legendVisible || impl_->legend.empty() || size[0] <= 0 || size[1] <= 0) return {0, 0};
  const double scale = impl_->pixelsPerPoint();
  const int points = impl_->pointsFor(size[1]);
  impl_->taken.clear();
  impl_->placeLegend(size[0], size[1], points, scale * points);
  Eigen::Vector2d reach(0, 0);
  for (const Rectangle& r : impl_->taken) reach = reach.cwiseMax(Eigen::Vector2d(r.x + r.width, size[1] - r.y));
  return reach;
}

double Annotations::colourBarHeight() {
  const int height = impl_->renderer->GetSize()[1];
  if (!impl_->colourBarShown() || height <= 0) return 0;
  return kColourBarRows * impl_->pixelsPerPoint() * impl_->pointsFor(height);
}

void Annotations::setOnPicture(bool on) { impl_->onPicture = on; }

void Annotations::setDark(bool dark) { impl_->dark = dark; }
void Annotations::setTextScale(double scale) { impl_->textScale = scale; }

void Annotations::place(const Eigen::Vector3d& reference) {
  const int* size = impl_->renderer->GetSize();
  if (size[0] <= 0 || size[1] <= 0) return;
  const double scale = impl_->pixelsPerPoint();
  const int points = impl_->pointsFor(size[1]);
  const double font = scale * points;
  impl_->origin = Eigen::Vector2d(impl_->renderer->GetOrigin()[0], impl_->renderer->GetOrigin()[1]);
  impl_->taken.clear();
  impl_->placeLegend(size[0], size[1], points, font);
  impl_->placeBar(size[0], points, font, reference);
  impl_->placeColourBar(size[0], points, font);
  impl_->placeBorder(size[0], size[1], points, font);
  impl_->placeAxes(points, font, reference);
  impl_->placeLabels(size[0], size[1], points, font);
}

}  // namespace glint::viz
