// SPDX-License-Identifier: BSD-3-Clause
#include "viz/walk_picture.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/base/numeric.h"

namespace glint::viz {
namespace {

constexpr double kDrawnLimit = 0.44;  // rad: the limit angle in the sections, 25 degrees
constexpr double kMostStretch = 20;
constexpr double kGlyphWidth = 0.6;  // of a letter, in heights of the text, on average

/// Maps the section (distance along the direction, height along N; m) to px.
struct Section {
  Box box;
  double pxPerMetre = 1, stretch = 1, ground = 0;  ///< ground: y of T, px
  Eigen::Vector2d at(double distance, double height) const {
    return {box.x + pxPerMetre * distance, ground - pxPerMetre * stretch * height};
  }
  /// A vector of the section as a px direction of this length; stretched as the heights are, so that normals stay square to S.
  Eigen::Vector2d arrow(const Eigen::Vector3d& v, const WalkStory& story, double length) const {
    const Eigen::Vector2d d(stretch * v.dot(story.along), -v.dot(story.normal));
    return length * d.normalized();
  }
};

struct Painter {
  const WalkStory& story;
  Colour ink, faint, plane, limit, half;
  double textPx;
  WalkPicture out;

  void section(const Section& s, const char* title, const std::vector<WalkPlace>& places, int visited, bool current,
               bool onSurface) {
    const Colour& own = onSurface ? ink : plane;
    const Eigen::Vector3d start = story.trace.onPlane.front().position;
    const auto where = [&](const WalkPlace& p) { return s.at(p.distance, (p.position - start).dot(story.normal)); };
    double highest = s.ground;
    for (const WalkPlace& p : places) highest = std::min(highest, where(p).y());
    // The letters on the arrows stay below the words above them.
    const double below = s.box.y + (beside(s.box, title) ? 1.3 : 2.5) * textPx;
    const double length = std::clamp((highest - below - textPx) / 1.12, 0.15 * s.box.height, 0.42 * s.box.height);
    out.lines.push_back(
        {{s.at(0, 0), {s.box.x + s.box.width, s.ground}}, onSurface ? faint : plane, 1, onSurface ? Dash::Dotted : Dash::Solid});
    std::vector<Eigen::Vector2d> profile, trail;
    for (std::size_t i = 0; i < places.size(); ++i) {
      profile.push_back(where(places[i]));
      if (static_cast<int>(i) >= visited) continue;
      trail.push_back(profile.back());
      if (i % 4 == 0)
        out.lines.push_back({{trail.back(), trail.back() + s.arrow(places[i].normal, story, 0.5 * length)}, faint, 1});
    }
    out.lines.push_back({profile, faint, 1});
    if (trail.size() > 1) out.lines.push_back({trail, own, 2.5});
    if (visited == 0) return;
    const WalkPlace& p = places[static_cast<std::size_t>(visited - 1)];
    const Eigen::Vector2d at = where(p), n = s.arrow(p.normal, story, length), h = s.arrow(story.half(p), story, length);
    std::vector<Eigen::Vector2d> fan{at};
    for (int i = 0; i <= 8; ++i) fan.push_back(at + 0.8 * length * ((1 - i / 8.0) * n + i / 8.0 * h).normalized());
    out.lines.push_back({fan, limit, 1, Dash::Solid, true});
    out.lines.push_back({{at, at + n}, own, 2});
    out.lines.push_back({{at, at + h}, half, 2});
    out.texts.push_back({at + 1.12 * n, "N", own, Align::Centre});
    if ((h - n).norm() > textPx) out.texts.push_back({at + 1.12 * h, "H", half, Align::Centre});
    out.dots.push_back({at, own, current ? 4.5 : 3.0});
  }

  /// Whether the angle has room beside the title; in a narrow half it is below it.
  bool beside(const Box& box, const char* title) const {
    return kGlyphWidth * textPx * static_cast<double>(std::string(title).size() + std::string("α 88.88°").size() + 2) < box.width;
  }

  void head(const Box& box, const char* title, const std::vector<WalkPlace>& places, int visited, const Colour& colour) {
    out.texts.push_back({{box.x, box.y + textPx}, title, colour, Align::Left, true});
    const std::string alpha =
        visited > 0 ? formatted("α %.2f°", degrees(places[static_cast<std::size_t>(visited - 1)].alpha)) : std::string("not yet");
    const bool right = beside(box, title);
    out.texts.push_back({{right ? box.x + box.width : box.x, box.y + (right ? 1.0 : 2.2) * textPx},
                         alpha,
                         visited > 0 ? ink : faint,
                         right ? Align::Right : Align::Left});
  }

  void chart(const Box& box, const WalkStory::Moment& now) {
    const WalkTrace& t = story.trace;
    const double most = 1.05 * std::max(t.reachOnSurface, t.reachOnPlane), top = 1.25 * t.limitAngle;
    const auto at = [&](double distance, double alpha) {
      return Eigen::Vector2d(box.x + box.width * distance / most, box.y + box.height * (1 - std::min(alpha, top) / top));
    };
    out.lines.push_back({{at(0, top), at(0, 0), at(most, 0)}, faint, 1});
    out.lines.push_back({{at(0, t.limitAngle), at(most, t.limitAngle)}, limit, 1.2, Dash::Dashed});
    out.texts.push_back(
        {at(0, t.limitAngle) + Eigen::Vector2d(4, -0.3 * textPx), formatted("limit angle %.2f°", degrees(t.limitAngle)), limit});
    const auto curve = [&](const std::vector<WalkPlace>& places, int visited, const Colour& colour) {
      std::vector<Eigen::Vector2d> line;
      for (int i = 0; i < visited; ++i) {
        const WalkPlace& p = places[static_cast<std::size_t>(i)];
        if (std::isfinite(p.alpha)) line.push_back(at(p.distance, p.alpha));
      }
      if (line.size() > 1) out.lines.push_back({line, colour, 2});
      if (line.empty()) return;
      out.dots.push_back({line.back(), colour, 3.5});
      if (visited == static_cast<int>(places.size()))
        out.lines.push_back({{line.back(), {line.back().x(), at(0, 0).y()}}, colour, 1, Dash::Dotted});
    };
    curve(t.onSurface, now.visitedOnSurface, ink);
    curve(t.onPlane, now.visitedOnPlane, plane);
    const double reach = now.onSurface ? t.reachOnSurface : t.reachOnPlane;
    const std::string axis = "distance on T",
                      end = formatted(now.onSurface ? "ends at %.1f mm on S" : "ends at %.1f mm on T", 1000 * reach);
    // In a narrow picture the end says of which distance the axis is.
    if (kGlyphWidth * textPx * static_cast<double>(axis.size() + end.size() + 1) < box.width)
      out.texts.push_back({{box.x, box.y + box.height + 1.2 * textPx}, axis, faint});
    out.texts.push_back({{box.x + box.width, box.y + box.height + 1.2 * textPx}, end, now.onSurface ? ink : plane, Align::Right});
  }
};

}  // namespace

WalkPicture walkPicture(const WalkStory& story, int step, double width, double height, double textPx, bool dark) {
  const Colour ink = dark ? kTextOnDark : kTextOnLight;
  const Colour faint = dark ? Colour{0.50, 0.52, 0.56} : Colour{0.55, 0.57, 0.60};
  // The light's yellow is too pale for lines on white.
  Painter painter{
      story,  ink, faint, canonicalColour(), modelColour(levelSetModel().id()), dark ? kLightColour : Colour{0.62, 0.50, 0.0},
      textPx, {}};
  const WalkStory::Moment now = story.at(step);
  const double margin = 6, gap = 14, sectionHeight = 0.56 * height, half = (width - 2 * margin - gap) / 2;
  const double most = std::max(story.trace.reachOnSurface, story.trace.reachOnPlane);
  double lowest = 0;  // of S under T; a concave mirror rises above it
  const Eigen::Vector3d start = story.trace.onPlane.front().position;
  for (const WalkPlace& p : story.trace.onSurface) lowest = std::max(lowest, std::abs((p.position - start).dot(story.normal)));
  Section s;
  s.pxPerMetre = 0.72 * half / std::max(most, 1e-300);
  s.stretch = std::clamp(std::tan(kDrawnLimit) / std::tan(std::max(story.trace.limitAngle, 1e-3)), 1.0, kMostStretch);
  const double room = 0.25 * sectionHeight;  // px that S may leave T
  if (lowest * s.pxPerMetre * s.stretch > room) s.stretch = std::max(1.0, room / (lowest * s.pxPerMetre));
  s.ground = margin + 0.74 * sectionHeight;
  s.box = {margin, margin, half, sectionHeight};
  painter.section(s, "Surface S", story.trace.onSurface, now.visitedOnSurface, now.onSurface, true);
  painter.head(s.box, "Surface S", story.trace.onSurface, now.visitedOnSurface, ink);
  s.box.x += half + gap;
  painter.section(s, "Plane T", story.trace.onPlane, now.visitedOnPlane, !now.onSurface, false);
  painter.head(s.box, "Plane T", story.trace.onPlane, now.visitedOnPlane, painter.plane);
  if (s.stretch > 1.05)
    painter.out.texts.push_back(
        {{width - margin, margin + sectionHeight + 0.2 * textPx}, formatted("heights × %.1f", s.stretch), faint, Align::Right});
  const double top = margin + sectionHeight + 1.2 * textPx;
  painter.chart({margin, top, width - 2 * margin, height - top - 1.6 * textPx - margin}, now);
  return painter.out;
}

}  // namespace glint::viz
