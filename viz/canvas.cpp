// SPDX-License-Identifier: BSD-3-Clause
// VTK 9.1 drops every character beyond ASCII from narrow strings; its overloads for vtkUnicodeString, deprecated in that very
// version, keep them.
#define VTK_DEPRECATION_LEVEL 0
#include "viz/canvas.h"

#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkTextProperty.h>
#include <vtkUnicodeString.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"
#include "core/codecs/codecs.h"
#include "viz/text_lock.h"

namespace glint::viz {
namespace {

constexpr int kFine = 2;   ///< drawn at twice the size and averaged: line widths in half pixels
constexpr int kShift = 4;  ///< sub-pixel bits of OpenCV's drawing functions
constexpr double kDashPx = 7, kDotPx = 2.5;

cv::Scalar scalar(const Colour& c) { return {255 * c[2], 255 * c[1], 255 * c[0]}; }

/// Canvas px (corner origin) to fixed-point pixels of the fine image (centre origin).
cv::Point fixedPoint(const Eigen::Vector2d& p) {
  const double scale = 1 << kShift;
  const auto to = [&](double v) { return static_cast<int>(std::lround(std::clamp(v * kFine - 0.5, -3e4, 3e4) * scale)); };
  return {to(p.x()), to(p.y())};
}

/// The pieces of a chain that a dash pattern leaves. @param pattern  px that are drawn and left out in turn
std::vector<std::vector<Eigen::Vector2d>> dashes(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& pattern) {
  std::vector<std::vector<Eigen::Vector2d>> pieces;
  std::size_t at = 0;
  double left = pattern.front();
  bool drawing = true;
  std::vector<Eigen::Vector2d> piece{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    Eigen::Vector2d from = points[i - 1];
    double length = (points[i] - from).norm();
    while (length > left) {
      const Eigen::Vector2d end = from + (points[i] - from) * (left / length);
      if (drawing) {
        piece.push_back(end);
        pieces.push_back(piece);
      }
      piece = {end};
      length -= left;
      from = end;
      drawing = !drawing;
      at = (at + 1) % pattern.size();
      left = pattern[at];
    }
    left -= length;
    if (drawing) piece.push_back(points[i]);
  }
  if (drawing && piece.size() > 1) pieces.push_back(piece);
  return pieces;
}

void setUp(vtkTextProperty* look, double sizePx, bool bold) {
  look->SetFontSize(std::max(6, static_cast<int>(std::lround(sizePx))));
  look->SetColor(1, 1, 1);
  look->SetBold(bold);
  if (!fontFile().empty()) {
    look->SetFontFamily(VTK_FONT_FILE);
    look->SetFontFile(fontFile().c_str());
  }
}

/// Coverage of a level line of text, bottom row first.
struct Glyphs {
  int width = 0, height = 0;
  std::vector<unsigned char> alpha;
};
Glyphs rendered(const std::string& text, double sizePx, bool bold) {
  Glyphs glyphs;
  if (text.empty()) return glyphs;
  const std::lock_guard lock(textMutex());
  vtkNew<vtkTextProperty> look;
  setUp(look, sizePx, bold);
  vtkNew<vtkImageData> image;
  int dims[2] = {0, 0};
  if (!vtkFreeTypeTools::GetInstance()->RenderString(look, vtkUnicodeString::from_utf8(text), 72, image, dims)) return glyphs;
  int extent[6];
  image->GetExtent(extent);
  glyphs.width = std::min(dims[0], extent[1] - extent[0] + 1);
  glyphs.height = std::min(dims[1], extent[3] - extent[2] + 1);
  for (int y = 0; y < glyphs.height; ++y) {
    for (int x = 0; x < glyphs.width; ++x) {
      glyphs.alpha.push_back(static_cast<const unsigned char*>(image->GetScalarPointer(extent[0] + x, extent[2] + y, 0))[3]);
    }
  }
  return glyphs;
}

/// Rows of a rendered line below its baseline: those under the ink of a letter on it.
int descentOf(double sizePx) {
  const Glyphs e = rendered("E", sizePx, false);
  for (int y = 0; y < e.height; ++y) {
    for (int x = 0; x < e.width; ++x) {
      if (e.alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(e.width) + static_cast<std::size_t>(x)] > 127) return y;
    }
  }
  return 0;
}

}  // namespace

std::recursive_mutex& textMutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

void render(vtkRenderWindow* window) {
  const std::lock_guard lock(textMutex());
  window->Render();
}

struct Canvas::Impl {
  int width, height;
  cv::Mat fine;  // BGR, kFine times the size
  struct Text {
    Eigen::Vector2d at;
    std::string text;
    double size;
    Colour colour;
    Align align;
    bool vertical, bold;
  };
  std::vector<Text> texts;  // laid over the averaged picture: FreeType smooths by itself

  cv::Rect pixels(const Box& box) const {
    const int x0 = static_cast<int>(std::lround(box.x * kFine)), y0 = static_cast<int>(std::lround(box.y * kFine));
    const int x1 = static_cast<int>(std::lround((box.x + box.width) * kFine)),
              y1 = static_cast<int>(std::lround((box.y + box.height) * kFine));
    return cv::Rect(x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)) & cv::Rect(0, 0, fine.cols, fine.rows);
  }
  /// Text is always rendered level and turned here: FreeType's box is then the line's, from descender to ascender.
  void print(cv::Mat& target, const Text& t) const {
    const Glyphs glyphs = rendered(t.text, t.size, t.bold);
    const double shift = t.align == Align::Left ? 0 : t.align == Align::Centre ? 0.5 * glyphs.width : glyphs.width;
    const int x0 = static_cast<int>(std::lround(t.at.x())), y0 = static_cast<int>(std::lround(t.at.y()));
    const int start = static_cast<int>(std::lround(shift)), descent = descentOf(t.size);
    for (int v = 0; v < glyphs.height; ++v) {
      for (int u = 0; u < glyphs.width; ++u) {
        const double alpha =
            glyphs.alpha[static_cast<std::size_t>(v) * static_cast<std::size_t>(glyphs.width) + static_cast<std::size_t>(u)] /
            255.0;
        // u runs along the text, up = v - descent away from its baseline.
        const int up = v - descent;
        const int column = t.vertical ? x0 - 1 - up : x0 - start + u;
        const int row = t.vertical ? y0 + start - u : y0 - 1 - up;
        if (alpha <= 0 || row < 0 || row >= target.rows || column < 0 || column >= target.cols) continue;
        cv::Vec3b& pixel = target.at<cv::Vec3b>(row, column);
        for (int c = 0; c < 3; ++c) {
          pixel[c] = static_cast<unsigned char>(
              std::lround((1 - alpha) * pixel[c] + alpha * 255 * t.colour[static_cast<std::size_t>(2 - c)]));
        }
      }
    }
  }
};

Canvas::Canvas(int width, int height, const Colour& background) : impl_(std::make_unique<Impl>()) {
  require(width >= 16 && height >= 16 && width <= 16384 && height <= 16384, "Canvas: size must be between 16 and 16384 pixels");
  impl_->width = width;
  impl_->height = height;
  impl_->fine = cv::Mat(height * kFine, width * kFine, CV_8UC3, scalar(background));
}

Canvas::~Canvas() = default;
int Canvas::width() const { return impl_->width; }
int Canvas::height() const { return impl_->height; }

void Canvas::fill(const Box& box, const Colour& colour, double opacity) {
  cv::Mat part = impl_->fine(impl_->pixels(box));
  if (part.empty()) return;
  if (opacity >= 1) {
    part.setTo(scalar(colour));
  } else {
    const cv::Mat ink(part.size(), CV_8UC3, scalar(colour));
    cv::addWeighted(ink, opacity, part, 1 - opacity, 0, part);
  }
}

void Canvas::picture(const Image& image, const Crop& crop, const Box& box) {
  const cv::Rect rect = impl_->pixels(box);
  if (rect.empty() || image.empty() || !(crop.width > 0) || !(crop.height > 0)) return;
  cv::Mat source(image.height, image.width, CV_8UC3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float v = image.at(x, y, image.channels == 3 ? 2 - c : 0);
        source.at<cv::Vec3b>(y, x)[c] =
            static_cast<unsigned char>(std::lround(255 * std::clamp(std::isfinite(v) ? v : 0.f, 0.f, 1.f)));
      }
    }
  }
  // Fine pixel (i, j) has its centre at ((i + 0.5) / kFine, ...) on the canvas; `crop` says which image pixel lies there.
  const double sx = crop.width / (box.width * kFine), sy = crop.height / (box.height * kFine);
  const double ox = crop.x + (rect.x + 0.5 - box.x * kFine) * sx, oy = crop.y + (rect.y + 0.5 - box.y * kFine) * sy;
  const cv::Mat imageFromFine = (cv::Mat_<double>(2, 3) << sx, 0, ox, 0, sy, oy);
  cv::Mat target = impl_->fine(rect);
  const bool shrinks = sx > 1 || sy > 1;
  if (shrinks) cv::GaussianBlur(source, source, {}, 0.4 * std::max(sx, 1e-3), 0.4 * std::max(sy, 1e-3));  // against moire
  cv::warpAffine(source, target, imageFromFine, target.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                 {0, 0, 0});
}

void Canvas::stroke(const std::vector<Eigen::Vector2d>& points, bool closed, const Colour& colour, double widthPx, Dash dash,
                    const Box& clip) {
  std::vector<Eigen::Vector2d> chain;
  for (const Eigen::Vector2d& p : points) {
    if (p.allFinite()) chain.push_back(p);
  }
  if (chain.size() < 2) return;
  if (closed) chain.push_back(chain.front());
  cv::Rect part(0, 0, impl_->fine.cols, impl_->fine.rows);
  if (clip.width > 0) part = impl_->pixels(clip);
  if (part.empty()) return;
  cv::Mat target = impl_->fine(part);
  const cv::Point origin(part.x << kShift, part.y << kShift);
  const int thickness = std::max(1, static_cast<int>(std::lround(widthPx * kFine)));
  std::vector<std::vector<Eigen::Vector2d>> pieces{chain};
  if (dash == Dash::Dashed) pieces = dashes(chain, {kDashPx, 0.7 * kDashPx});
  if (dash == Dash::Dotted) pieces = dashes(chain, {kDotPx, 1.4 * kDotPx});
  if (dash == Dash::DashDotted) pieces = dashes(chain, {kDashPx, 0.5 * kDashPx, kDotPx, 0.5 * kDashPx});
  for (const std::vector<Eigen::Vector2d>& piece : pieces) {
    std::vector<cv::Point> fixed;
    for (const Eigen::Vector2d& p : piece) fixed.push_back(fixedPoint(p) - origin);
    cv::polylines(target, fixed, false, scalar(colour), thickness, cv::LINE_AA, kShift);
  }
}

void Canvas::disc(const Eigen::Vector2d& centre, double radius, const Colour& colour) {
  cv::circle(impl_->fine, fixedPoint(centre), static_cast<int>(std::lround(radius * kFine * (1 << kShift))), scalar(colour),
             cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::text(const Eigen::Vector2d& at, const std::string& text, double sizePx, const Colour& colour, Align align,
                  bool vertical, bool bold) {
  impl_->texts.push_back({at, text, sizePx, colour, align, vertical, bold});
}

double Canvas::textWidth(const std::string& text, double sizePx, bool bold) const {
  if (text.empty()) return 0;
  const std::lock_guard lock(textMutex());
  vtkNew<vtkTextProperty> look;
  setUp(look, sizePx, bold);
  int box[4] = {0, 0, 0, 0};
  if (!vtkFreeTypeTools::GetInstance()->GetBoundingBox(look, vtkUnicodeString::from_utf8(text), 72, box)) return 0;
  return box[1] - box[0] + 1;
}

Image Canvas::image() const {
  cv::Mat small;
  cv::resize(impl_->fine, small, {impl_->width, impl_->height}, 0, 0, cv::INTER_AREA);
  for (const Impl::Text& text : impl_->texts) impl_->print(small, text);
  Image image(small.cols, small.rows, 3);
  for (int y = 0; y < small.rows; ++y) {
    for (int x = 0; x < small.cols; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(small.at<cv::Vec3b>(y, x)[2 - c]) / 255.f;
    }
  }
  return image;
}

void writePng(const Image& image, const std::string& file) {
  require(!image.empty() && (image.channels == 3 || image.channels == 1), "writePng: needs 1 or 3 channels");
  cv::Mat pixels(image.height, image.width, CV_8UC3);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float v = image.at(x, y, image.channels == 3 ? 2 - c : 0);
        pixels.at<cv::Vec3b>(y, x)[c] =
            static_cast<unsigned char>(std::lround(255 * std::clamp(std::isfinite(v) ? v : 0.f, 0.f, 1.f)));
      }
    }
  }
  std::vector<unsigned char> bytes;
  if (!encodeWithOpenCv(".png", pixels, bytes)) throw InputError(file, "", "cannot encode the picture as PNG");
  atomicWrite(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace glint::viz
