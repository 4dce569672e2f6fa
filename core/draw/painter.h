// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/draw/colours.h"

namespace glint::draw {

/// A rectangle of the canvas, px from the top left.
struct Box {
  double x = 0, y = 0, width = 0, height = 0;
};
/// A part of an image in its own pixels: (x, y) = left and top *edge*, so a whole image is (-0.5, -0.5, w, h).
using Crop = Box;

enum class Dash { Solid, Dashed, Dotted, DashDotted };
enum class Align { Left, Centre, Right };

/// What charts and overlays are painted with, whatever takes the strokes: pixels in memory (viz/canvas.h), a file that scales
/// (core/draw/svg_painter.h) or the screen (gui/base/qt_painter.h). Coordinates are px, (0, 0) is the top left corner and y
/// points down. What is painted later lies on top.
class Painter {
 public:
  virtual ~Painter() = default;
  /// @param opacity  0..1
  virtual void fill(const Box& box, const Colour& colour, double opacity = 1) = 0;
  /// A polyline, cut at `clip` unless that is empty. Points that are not finite are left out.
  virtual void stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const Colour& colour, double widthPx,
                      Dash dash = Dash::Solid, const Box& clip = {}) = 0;
  virtual void disc(const Eigen::Vector2d& centre, double radius, const Colour& colour) = 0;
  /// A circle's line; by default a polygon.
  virtual void ring(const Eigen::Vector2d& centre, double radius, const Colour& colour, double widthPx, const Box& clip = {});
  /// One line of text; `at` is the baseline's left end, middle or right end. `vertical`: it runs upwards.
  virtual void text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const Colour& colour,
                    Align align = Align::Left, bool vertical = false, bool bold = false) = 0;
  virtual double textWidth(const std::string& text, double sizePx, bool bold = false) const = 0;
  /// What is at a place, in words, for pictures that answer the mouse by themselves; others leave it out.
  virtual void hint(const Eigen::Vector2d& /*centre*/, double /*radius*/, const std::string& /*text*/) {}

  /// The text, its end replaced by an ellipsis if it is wider than `widthPx`.
  std::string fitted(const std::string& text, double sizePx, double widthPx) const;
  /// The text in lines that are at most `widthPx` wide, broken at blanks; a single wider word is a line of its own.
  std::vector<std::string> wrapped(const std::string& text, double sizePx, double widthPx) const;
};

/// How far below a middle line the baseline lies of letters that are centred on it, px.
inline double belowMiddle(double sizePx) { return 0.36 * sizePx; }

/// A caption under a figure: lines that the width of the page broke.
struct Caption {
  std::vector<std::string> lines;
  double sizePx = 0;
  double height = 0;  ///< px, with the room above and below the lines; 0 = no caption
};

/// Breaks a caption at blanks; a word that is wider than the page is cut. What exceeds `mostHeight` ends in an ellipsis.
/// @param painter  measures
/// @param width    px of the whole picture
Caption captionOf(const Painter& painter, const std::string& text, double sizePx, double width, double mostHeight);
/// Paints it from `top` down; the ground is the caller's.
void paintCaption(Painter& painter, const Caption& caption, double top, const Colour& ink);

/// A polyline of at least two points.
struct Chain {
  std::vector<Eigen::Vector2d> points;
  bool closed = false;
};

/// The part of a polyline in a box, border included. A line that leaves it becomes open pieces; one wholly inside stays as
/// it is. Points that are not finite are left out. @param box  without width: everything
/// @see Liang & Barsky, A New Concept and Method for Line Clipping, 1984.
std::vector<Chain> chainsInside(const std::vector<Eigen::Vector2d>& points, bool closed, const Box& box);

}  // namespace glint::draw
