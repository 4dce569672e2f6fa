// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/frame_overlay.h"

namespace glint::draw {
namespace {

std::vector<Eigen::Vector2d> corners(MarkShape shape, const Eigen::Vector2d& at, double half) {
  constexpr double kHeight = 1.732;  // of an equilateral triangle, in half sides
  if (shape == MarkShape::Triangle)
    return {at + half * Eigen::Vector2d(-1, kHeight / 3), at + half * Eigen::Vector2d(1, kHeight / 3),
            at + half * Eigen::Vector2d(0, -2 * kHeight / 3)};
  return {at + half * Eigen::Vector2d(-1, -1), at + half * Eigen::Vector2d(1, -1), at + half * Eigen::Vector2d(1, 1),
          at + half * Eigen::Vector2d(-1, 1)};
}

}  // namespace

void paintOverlay(Painter& painter, const FrameOverlay& overlay, const Crop& crop, const Box& box, double inkScale, bool hints) {
  const auto place = [&](const Pixel& p) {
    return Eigen::Vector2d(box.x + (p.x() - crop.x) * box.width / crop.width,
                           box.y + (p.y() - crop.y) * box.height / crop.height);
  };
  for (const OverlayLine& line : overlay.lines) {
    std::vector<Eigen::Vector2d> points;
    points.reserve(line.points.size());
    for (const Pixel& p : line.points) points.push_back(place(p));
    if (line.halo) painter.stroke(points, line.closed, kHalo, inkScale * (line.width + 2), Dash::Solid, box);
    painter.stroke(points, line.closed, line.colour, inkScale * line.width, line.dash, box);
  }
  for (const OverlayMark& mark : overlay.marks) {
    const Eigen::Vector2d at = place(mark.at);
    if (!(at.x() >= box.x && at.x() <= box.x + box.width && at.y() >= box.y && at.y() <= box.y + box.height)) continue;
    const double size = inkScale * mark.size;
    const auto draw = [&](const Colour& colour, double width, double reach) {
      if (mark.shape == MarkShape::Circle) return painter.ring(at, size, colour, width, box);
      if (mark.shape != MarkShape::Cross) painter.stroke(corners(mark.shape, at, size), true, colour, width, Dash::Solid, box);
      if (mark.shape == MarkShape::Triangle) return;
      if (mark.shape == MarkShape::Square) {  // with a cross from corner to corner, as plots and the timeline have one
        const std::vector<Eigen::Vector2d> c = corners(mark.shape, at, size);
        painter.stroke({c[0], c[2]}, false, colour, width, Dash::Solid, box);
        return painter.stroke({c[1], c[3]}, false, colour, width, Dash::Solid, box);
      }
      for (const Eigen::Vector2d& arm : {Eigen::Vector2d(reach, 0), Eigen::Vector2d(0, reach)})
        painter.stroke({at - arm, at + arm}, false, colour, width, Dash::Solid, box);
    };
    if (mark.halo) draw(kHalo, inkScale * (mark.width + 2), size + inkScale);
    draw(mark.colour, inkScale * mark.width, size);
    if (hints) painter.hint(at, size + inkScale, mark.label);
  }
}

}  // namespace glint::draw
