// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/svg_painter.h"

#include <algorithm>
#include <cmath>

#include "core/base/bytes.h"
#include "core/base/html_text.h"
#include "core/base/number_text.h"
#include "core/draw/painter.h"

namespace glint::draw {
namespace {

/// Advance widths of DejaVu Sans 2.37 for the letters from blank to tilde, thousandths of the font's size.
constexpr int kAdvance[2][95] = {
    {318, 401, 460, 838, 636, 950, 780, 275, 390,  390, 500, 838, 318, 361, 318, 337, 636, 636, 636, 636, 636, 636, 636, 636,
     636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787,
     603, 787, 695, 635, 611, 732, 684, 989, 685,  611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352, 635,
     634, 278, 278, 579, 278, 974, 634, 612, 635,  635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838},
    {348, 456, 521, 838, 696, 1002, 872, 306,  457,  457, 523, 838, 380, 415, 380, 365, 696, 696, 696, 696, 696, 696, 696, 696,
     696, 696, 400, 400, 838, 838,  838, 580,  1000, 774, 762, 734, 830, 683, 683, 821, 837, 372, 372, 775, 637, 995, 837, 850,
     733, 850, 770, 720, 682, 812,  774, 1103, 771,  724, 725, 457, 365, 457, 838, 500, 500, 675, 716, 593, 716, 678, 435, 716,
     712, 343, 343, 665, 343, 1042, 712, 687,  716,  716, 493, 595, 478, 712, 652, 924, 645, 652, 582, 712, 365, 712, 838}};
constexpr int kOtherAdvance =
    650;  // of letters beyond those: Greek ones, the degree sign and the plus-minus sign have 500 to 840

std::string hex(const Colour& c) {
  const auto part = [](double v) { return int(std::lround(255 * std::clamp(v, 0.0, 1.0))); };
  return formatted("#%02x%02x%02x", part(c[0]), part(c[1]), part(c[2]));
}

/// Hundredths of a pixel: finer than any screen shows.
std::string num(double v) {
  std::string text = formatted("%.2f", v);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

}  // namespace

SvgPainter::SvgPainter(double width, double height, const std::optional<Colour>& background) : width_(width), height_(height) {
  if (background) fill({0, 0, width, height}, *background);
}

void SvgPainter::fill(const Box& box, const Colour& colour, double opacity) {
  if (!(box.width > 0) || !(box.height > 0)) return;
  body_ += "<rect x=\"" + num(box.x) + "\" y=\"" + num(box.y) + "\" width=\"" + num(box.width) + "\" height=\"" +
           num(box.height) + "\" fill=\"" + hex(colour) + (opacity < 1 ? "\" fill-opacity=\"" + num(opacity) : "") + "\"/>\n";
}

void SvgPainter::stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const Colour& colour, double widthPx, Dash dash,
                        const Box& clip) {
  constexpr double kApart = 0.1;  // px: nearer vertices show on no screen
  std::string path;
  for (const Chain& chain : chainsInside(points, closed, clip)) {
    Eigen::Vector2d last = chain.points.front();
    path += " M" + num(last.x()) + "," + num(last.y());
    for (std::size_t i = 1; i < chain.points.size(); ++i) {
      const Eigen::Vector2d& p = chain.points[i];
      if ((p - last).norm() < kApart && i + 1 < chain.points.size()) continue;
      path += " L" + num(p.x()) + "," + num(p.y());
      last = p;
    }
    if (chain.closed) path += " Z";
  }
  if (path.empty()) return;
  body_ += "<path fill=\"none\" stroke=\"" + hex(colour) + "\" stroke-width=\"" + num(widthPx) + "\"";
  if (dash != Dash::Solid)
    body_ += std::string(" stroke-dasharray=\"") +
             (dash == Dash::Dashed   ? "7 5"
              : dash == Dash::Dotted ? "2.5 3.5"
                                     : "8 3.5 2 3.5") +
             "\"";
  body_ += " d=\"" + path.substr(1) + "\"/>\n";
}

void SvgPainter::disc(const Eigen::Vector2d& centre, double radius, const Colour& colour) {
  if (!centre.allFinite()) return;
  body_ += "<circle cx=\"" + num(centre.x()) + "\" cy=\"" + num(centre.y()) + "\" r=\"" + num(radius) + "\" fill=\"" +
           hex(colour) + "\"/>\n";
}

void SvgPainter::text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const Colour& colour, Align align,
                      bool vertical, bool bold) {
  if (text.empty()) return;
  body_ += "<text font-size=\"" + num(sizePx) + "\" fill=\"" + hex(colour) + "\" textLength=\"" +
           num(textWidth(text, sizePx, bold)) + "\"";
  if (align != Align::Left) body_ += align == Align::Centre ? " text-anchor=\"middle\"" : " text-anchor=\"end\"";
  if (bold) body_ += " font-weight=\"bold\"";
  body_ += vertical ? " transform=\"translate(" + num(at.x()) + " " + num(at.y()) + ") rotate(-90)\""
                    : " x=\"" + num(at.x()) + "\" y=\"" + num(at.y()) + "\"";
  body_ += ">" + html::escaped(text) + "</text>\n";
}

double SvgPainter::textWidth(const std::string& text, double sizePx, bool bold) const {
  double sum = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 32 && byte < 127)
      sum += kAdvance[bold ? 1 : 0][byte - 32];
    else if ((byte & 0xC0) == 0xC0)  // the first byte of a letter of several
      sum += kOtherAdvance;
  }
  return sum / 1000 * sizePx;
}

void SvgPainter::hint(const Eigen::Vector2d& centre, double radius, const std::string& text) {
  if (!centre.allFinite() || text.empty()) return;
  std::string lines;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    lines += (from > 0 ? "\n" : "") + html::escaped(text.substr(from, end - from));
    from = end + 1;
  }
  hints_ += "<circle cx=\"" + num(centre.x()) + "\" cy=\"" + num(centre.y()) + "\" r=\"" + num(radius) +
            "\" fill-opacity=\"0\"><title>" + lines + "</title></circle>\n";
}

void SvgPainter::picture(const std::vector<unsigned char>& encoded, const std::string& mime, const Box& box) {
  body_ += "<image x=\"" + num(box.x) + "\" y=\"" + num(box.y) + "\" width=\"" + num(box.width) + "\" height=\"" +
           num(box.height) + "\" preserveAspectRatio=\"none\" image-rendering=\"pixelated\" href=\"data:" + mime + ";base64," +
           base64(encoded) + "\"/>\n";
}

std::string SvgPainter::open(const std::string& attributes) const {
  return "<svg viewBox=\"0 0 " + num(width_) + " " + num(height_) + "\" " + attributes +
         " font-family=\"DejaVu Sans, Verdana, sans-serif\" stroke-linejoin=\"round\" stroke-linecap=\"butt\">\n";
}

std::string SvgPainter::element(const std::string& label) const {
  return open("role=\"img\" aria-label=\"" + html::escaped(label) + "\"") + body_ + hints_ + "</svg>\n";
}

std::string SvgPainter::document(const std::string& title, const std::string& description) const {
  const std::string desc = description.empty() ? "" : "<desc>" + html::escaped(description) + "</desc>\n";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
         open("xmlns=\"http://www.w3.org/2000/svg\" width=\"" + num(width_) + "\" height=\"" + num(height_) + "\"") + "<title>" +
         html::escaped(title) + "</title>\n" + desc + body_ + hints_ + "</svg>\n";
}

}  // namespace glint::draw
