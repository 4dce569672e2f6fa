// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/pixel_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/geometry/transforms.h"
#include "core/highlight/diffuse.h"

namespace glint {
namespace {

constexpr std::size_t kLeastCells = 30;  // several per unknown of the background and the lobe
constexpr double kOthersReach = 2.5;     // footprints of another light's highlight that are left out
constexpr double kLeastReachPx = 4;      // beyond a small highlight's edge, so that its background shows
constexpr int kOutline = 64;             // points of an ellipse that bound its box

/// Squared distance from the centre of an ellipse in units of its semi-axes.
double squaredRadius(const Ellipse& e, const Pixel& p) {
  const Pixel d = p - e.centre;
  const double c = std::cos(e.angle), s = std::sin(e.angle);
  const double x = (c * d.x() + s * d.y()) / e.semiAxes.x(), y = (-s * d.x() + c * d.y()) / e.semiAxes.y();
  return x * x + y * y;
}

/// The ellipse at half the peak that a Gaussian lobe would have with this one at `level`, `by` times as large, and no smaller
/// than kLeastReachPx more than it was.
Ellipse around(const Ellipse& e, double level, double by) {
  const double share = std::clamp(level, 0.01, 0.99), toHalf = std::sqrt(std::log(0.5) / std::log(share));
  Ellipse wide = e;
  for (int i = 0; i < 2; ++i) wide.semiAxes(i) = std::max(by * toHalf * e.semiAxes(i), e.semiAxes(i) + kLeastReachPx);
  return wide;
}

/// Cells over the box with a margin for the blur; all of them without values.
void placeCells(PixelPatch& patch, const Eigen::AlignedBox2d& box, int width, int height, const PatchOptions& options) {
  patch.cellPx = std::max(1, static_cast<int>(std::ceil(std::sqrt(box.volume() / options.cells))));
  const int margin = std::max(1, static_cast<int>(std::ceil(3 * options.blurPx / patch.cellPx))) * patch.cellPx;
  const double low = (patch.cellPx - 1) / 2.0;  // from the first pixel's centre to the cell's
  const int left = static_cast<int>(std::floor(std::clamp(box.min().x(), 0.0, width - 1.0))) - margin;
  const int top = static_cast<int>(std::floor(std::clamp(box.min().y(), 0.0, height - 1.0))) - margin;
  const int right = static_cast<int>(std::ceil(std::clamp(box.max().x(), 0.0, width - 1.0))) + margin;
  const int bottom = static_cast<int>(std::ceil(std::clamp(box.max().y(), 0.0, height - 1.0))) + margin;
  patch.firstCell = Pixel(left + low, top + low);
  patch.columns = (right - left) / patch.cellPx + 1;
  patch.rows = (bottom - top) / patch.cellPx + 1;
  const std::size_t n = static_cast<std::size_t>(patch.columns) * patch.rows;
  patch.value.assign(n, 0);
  patch.used.assign(n, 0);
  patch.onSurface.assign(n, 0);
  patch.seen.resize(n);
}

Pixel idealPixelOf(const PixelPatch& patch, int row, int column) {
  return patch.camera.undistorted(patch.firstCell + patch.cellPx * Pixel(column, row));
}

/// Joins a cell with what its centre shows; false off the surface.
bool joinWithSurface(PixelPatch& patch, std::size_t cell, const Pixel& ideal, const Surface& surface) {
  if (!ideal.allFinite()) return false;
  const Outcome<SurfacePoint> hit = surface.firstHit(patch.camera.ray(ideal));
  if (!hit || !hit->position.allFinite() || !hit->normal.allFinite()) return false;
  const Eigen::Vector3d eye = patch.camera.centreInWorld();
  patch.onSurface[cell] = 1;
  patch.seen[cell] = lobe::seenFrom(eye, surface, facing(*hit, eye));
  return true;
}

/// Mean of a cell's pixels. @return whether all of them lie in the image and may be used
bool takeMean(PixelPatch& patch, std::size_t cell, int row, int column, const LinearPixels& pixels) {
  const int width = pixels.value.width, height = pixels.value.height;
  const Pixel first = patch.firstCell - Pixel::Constant((patch.cellPx - 1) / 2.0);
  const int x0 = static_cast<int>(first.x()) + column * patch.cellPx, y0 = static_cast<int>(first.y()) + row * patch.cellPx;
  if (x0 < 0 || y0 < 0 || x0 + patch.cellPx > width || y0 + patch.cellPx > height) return false;
  double sum = 0;
  bool whole = true;
  for (int y = y0; y < y0 + patch.cellPx; ++y)
    for (int x = x0; x < x0 + patch.cellPx; ++x) {
      whole = whole && pixels.usable[static_cast<std::size_t>(y) * width + x];
      sum += pixels.value.at(x, y);
    }
  patch.value[cell] = static_cast<float>(sum / (patch.cellPx * patch.cellPx));
  return whole;
}

/// A cell at the edge of the object mixes it with what lies behind.
void dropEdges(PixelPatch& patch) {
  for (int row = 0; row < patch.rows; ++row)
    for (int column = 0; column < patch.columns; ++column) {
      bool inside = row > 0 && column > 0 && row + 1 < patch.rows && column + 1 < patch.columns;
      for (int dy = -1; dy <= 1 && inside; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          inside = inside && patch.onSurface[static_cast<std::size_t>(row + dy) * patch.columns + column + dx];
      if (!inside) patch.used[static_cast<std::size_t>(row) * patch.columns + column] = 0;
    }
}

}  // namespace

LinearPixels linearPixels(const Image& linear, const Image* mask, double clipValue, const DiffuseLight* under) {
  require(linear.channels == 1 || linear.channels == 3, "linearPixels: 1 or 3 channels");
  require(!mask || (mask->width == linear.width && mask->height == linear.height && mask->channels == 1),
          "linearPixels: a mask of that size with one channel");
  LinearPixels p;
  p.value = Image(linear.width, linear.height, 1);
  p.usable.assign(p.value.data.size(), 0);
  p.clipped.assign(p.value.data.size(), 0);
  const double clip = clipValue > 0 ? clipValue : std::nan("");  // nothing reaches it, not even an infinite value
  constexpr float kLargest = std::numeric_limits<float>::max();
  const float* v = linear.data.data();
  for (std::size_t i = 0; i < p.value.data.size(); ++i) {
    // Without branches: this loop goes over every pixel of every frame.
    bool good = !mask || mask->data[i] != 0.f, full = false;
    double sum = 0;
    for (int c = 0; c < linear.channels; ++c, ++v) {
      good &= (*v >= 0) & (*v <= kLargest);
      full |= *v >= clip;
      sum += *v;
    }
    p.clipped[i] = full;
    p.usable[i] = good & !full;
    p.value.data[i] = std::isfinite(sum) ? static_cast<float>(sum / linear.channels) : 0.f;
  }
  if (under) takeOff(*under, p.value, p.usable);
  return p;
}

std::size_t PixelPatch::usedCells() const { return static_cast<std::size_t>(std::count(used.begin(), used.end(), 1)); }

Outcome<PixelPatch> pixelPatch(const LinearPixels& pixels, const Camera& camera, const Surface& surface, int frame,
                               const Highlight& highlight, const std::vector<Highlight>& others, const PatchOptions& options) {
  require(options.reach > 1 && options.cells >= 100 && options.blurPx >= 0, "pixelPatch: options");
  if (!highlight.ellipse) return Failure{Reason::NotSupported, "a highlight without an ellipse"};
  const Ellipse region = around(*highlight.ellipse, highlight.level, options.reach);
  Eigen::AlignedBox2d box;
  for (const Pixel& p : region.sample(kOutline)) {
    const Pixel measured = camera.distorted(p);
    if (measured.allFinite()) box.extend(measured);
  }
  if (box.isEmpty()) return Failure{Reason::NotFinite, "the highlight's surroundings"};

  PixelPatch patch;
  patch.light = highlight.light;
  patch.frame = frame;
  patch.camera = camera;
  patch.peak = highlight.peak;
  patch.radiusPx = highlight.ellipse->semiAxes.mean();
  placeCells(patch, box, pixels.value.width, pixels.value.height, options);

  std::vector<Ellipse> elsewhere;
  for (const Highlight& o : others)
    if (o.ellipse) elsewhere.push_back(around(*o.ellipse, o.level, kOthersReach));
  for (int row = 0; row < patch.rows; ++row)
    for (int column = 0; column < patch.columns; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * patch.columns + column;
      const Pixel ideal = idealPixelOf(patch, row, column);
      if (!joinWithSurface(patch, i, ideal, surface) || !takeMean(patch, i, row, column, pixels)) continue;
      patch.used[i] = squaredRadius(region, ideal) < 1 && std::none_of(elsewhere.begin(), elsewhere.end(), [&](const Ellipse& e) {
                        return squaredRadius(e, ideal) < 1;
                      });
    }
  dropEdges(patch);
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (patch.used[i]) patch.top = std::max<double>(patch.top, patch.value[i]);
  if (patch.usedCells() < kLeastCells)
    return Failure{Reason::TooFewPoints,
                   "only " + std::to_string(patch.usedCells()) + " pixels around the highlight can be used"};
  if (!(patch.top > 0)) return Failure{Reason::NoHighlight, "only zeros around the highlight"};
  return patch;
}

PixelPatch carriedBy(PixelPatch patch, const Eigen::Isometry3d& by) {
  if (isIdentity(by)) return patch;
  patch.camera.camFromWorld = patch.camera.camFromWorld * by.inverse();
  for (PixelPatch::Seen& s : patch.seen) {
    s.position = by * s.position;
    s.toCamera = by.linear() * s.toCamera;
    s.axes.normal = by.linear() * s.axes.normal;
    s.axes.tangent = by.linear() * s.axes.tangent;
  }
  return patch;
}

PixelPatch onSurface(PixelPatch patch, const Surface& surface) {
  for (int row = 0; row < patch.rows; ++row)
    for (int column = 0; column < patch.columns; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * patch.columns + column;
      if (patch.onSurface[i] && !joinWithSurface(patch, i, idealPixelOf(patch, row, column), surface))
        patch.onSurface[i] = patch.used[i] = 0;
    }
  return patch;
}

}  // namespace glint
