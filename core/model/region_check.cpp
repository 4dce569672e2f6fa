// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/pixel_sampler.h"
#include "core/model/star_level_set.h"

namespace glint {
namespace {

constexpr std::size_t kMostParts = 8192;  // half of a large mesh: no bound helps there
constexpr int kMostLooks = 48;            // with more unexplained parts the level set is as fast
constexpr double kOnOutline = 1.02;       // relative reach: the outline is known far better, a part's middle is a point
constexpr double kPartsNear = 4;          // radii: where the bounds of a part at the outline may still reach the level
constexpr double kCellsNear = 1.5;
constexpr int kColumns = 20;  // of the grid that stands for the parts
// Share of the change of H - N from ray to ray: by how much it may bend within a cell, and move where the surface ends there.
constexpr double kCurvedShare = 0.25, kCutShare = 0.5;
constexpr int kFine = 4;  // rays a side over a cell or part that is looked at

/// What a ray of the grid found.
struct Node {
  bool hit = false;
  Eigen::Vector3d apart{0, 0, 0};  ///< H - N: its length is 2 sin(theta / 2)
  double cosView = 0, cosHalf = 0, lightDistance = 0;
  double change = 0;  ///< largest of `apart` towards its neighbours
};

/// Bounds of cells of the grid, tested eight at once.
struct EightCells {
  PartBounds bounds;
  std::array<Pixel, 8> middles;
  int filled = 0;
  EightCells() {
    bounds.tanSquared.setZero();
    bounds.cosView.setOnes();
    bounds.cosHalf.setOnes();
    bounds.lightSquared.setOnes();
  }
};

/// Rays over a part of the image, which stand for the parts of the surface.
struct RayGrid {
  Pixel min;
  int nx, ny;
  Eigen::Vector2d cell;  ///< px
  std::vector<Node> nodes;

  RayGrid(const Pixel& min, const Eigen::Vector2d& size)
      : min(min), nx(kColumns + 1), ny(1 + std::max(1, static_cast<int>(std::ceil(kColumns * size.y() / size.x())))) {
    cell = {size.x() / (nx - 1), size.y() / (ny - 1)};
    nodes.resize(static_cast<std::size_t>(nx) * ny);
  }
  Pixel pixelOf(int i, int j) const { return {min.x() + i * cell.x(), min.y() + j * cell.y()}; }

  void compareNeighbours() {
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        Node& node = nodes[j * nx + i];
        if (!node.hit) continue;
        for (const auto& [di, dj] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
          const int x = i + di, y = j + dj;
          if (x < 0 || y < 0 || x >= nx || y >= ny || !nodes[y * nx + x].hit) continue;
          node.change = std::max(node.change, (nodes[y * nx + x].apart - node.apart).norm());
        }
      }
  }

  /// Adds the bounds of the cell below and right of a node, unless no ray at its corners hit the surface.
  void addCell(int i, int j, double lightReach, EightCells& cells) const {
    // Between the corners `apart` is nearly linear: along the direction of its mean it is at least the least corner's, less
    // what the cell's twist and its neighbours say about second order.
    const int corners[4] = {j * nx + i, j * nx + i + 1, (j + 1) * nx + i, (j + 1) * nx + i + 1};
    Eigen::Vector3d mean(0, 0, 0);
    for (const int n : corners)
      if (nodes[n].hit) mean += nodes[n].apart;
    mean /= std::max(mean.norm(), 1e-300);  // not 0 / 0
    int defined = 0;
    double apart = std::numeric_limits<double>::infinity(), change = 0, cosLow = 1, cosHigh = 0, half = 1, nearLight = apart,
           farLight = 0;
    for (const int n : corners) {
      const Node& node = nodes[n];
      if (!node.hit) continue;
      ++defined;
      apart = std::min(apart, mean.dot(node.apart));
      change = std::max(change, node.change);
      cosLow = std::min(cosLow, node.cosView), cosHigh = std::max(cosHigh, node.cosView);
      half = std::min(half, node.cosHalf);
      nearLight = std::min(nearLight, node.lightDistance), farLight = std::max(farLight, node.lightDistance);
    }
    if (defined == 0) return;
    const bool whole = defined == 4;
    const double turned = lightReach > 0 ? lightReach / nearLight / std::max(half, 1e-3) : 0;  // of H, by the light's extent
    const double least = std::clamp(0.5 * (apart - (whole ? kCurvedShare : kCutShare) * change - turned), 0.0, 1.0),
                 cosine = 1 - 2 * least * least;
    const int k = cells.filled++;
    cells.bounds.tanSquared[k] =
        static_cast<float>(cosine > 1e-3 ? 1 / (cosine * cosine) - 1 : 1e6);  // 1e-3: an angle near 90 degrees
    cells.bounds.cosView[k] = static_cast<float>(whole ? std::max(0.0, 2 * cosLow - cosHigh) : 0);
    cells.bounds.cosHalf[k] = static_cast<float>(0.9 * half);
    const double light = std::max({2 * nearLight - farLight, 0.7 * nearLight, 0.0}) - lightReach;
    cells.bounds.lightSquared[k] = static_cast<float>(light > 0 ? light * light : 0);
    cells.middles[k] = pixelOf(i, j) + 0.5 * cell;
  }
};

/// What every way of looking shares.
class Inspector {
 public:
  Inspector(const StarField& field, const Camera& camera, const Surface& surface, const std::vector<StarOutline>& outlines,
            double level, const Pixel& min, const Pixel& max)
      : field_(field),
        camera_(camera),
        surface_(surface),
        outlines_(outlines),
        level_(level),
        min_(min),
        max_(max),
        sampler_(field.value, camera, surface) {}

  std::optional<Failure> byParts(const BoundedParts& bounded, bool& answered) const {
    const PartTest test = [&](const PartBounds& b) { return field_.above(b, level_); };
    const std::optional<std::vector<SurfacePart>> parts = bounded.partsThatMay(
        {sampler_.eye(), field_.light.homogeneous(), sidesOf(camera_, min_, max_)}, field_.lightReach, test, kMostParts);
    answered = parts.has_value();
    if (!parts) return std::nullopt;
    const double focal = std::max(camera_.pixelFromRay(0, 0), camera_.pixelFromRay(1, 1));
    std::vector<SurfacePoint> open;
    std::vector<double> sizes;
    for (const SurfacePart& part : *parts) {
      const std::optional<Pixel> pixel = camera_.project(part.middle.position);
      if (!pixel) continue;
      const double radius = part.radius * focal / camera_.depth(part.middle.position);
      if (explained(*pixel, kPartsNear * radius, part.middle)) continue;
      open.push_back(part.middle);
      sizes.push_back(radius);
    }
    if (open.empty()) return std::nullopt;
    // Most of them lie on the far side.
    const std::vector<char> hidden = occludedMany(surface_, open, sampler_.eye());
    int looks = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (hidden[i]) continue;
      const SurfacePoint p = facing(open[i], sampler_.eye());
      const Pixel pixel = *camera_.project(p.position);
      if (insideElsewhere(pixel, p) || insideNear(pixel, 2 * sizes[i])) return elsewhere();
      if (++looks > kMostLooks) return undecided();
    }
    return std::nullopt;
  }

  std::optional<Failure> byGrid() const {
    RayGrid grid(min_, max_ - min_);
    if (const std::optional<Failure> found = fill(grid)) return found;
    grid.compareNeighbours();
    EightCells cells;
    int looks = 0;
    for (int j = 0; j + 1 < grid.ny; ++j)
      for (int i = 0; i + 1 < grid.nx; ++i) {
        grid.addCell(i, j, field_.lightReach, cells);
        if (cells.filled < 8) continue;
        if (const std::optional<Failure> found = inCells(cells, grid.cell.maxCoeff(), looks)) return found;
        cells = {};
      }
    return inCells(cells, grid.cell.maxCoeff(), looks);
  }

 private:
  static Failure elsewhere() { return {Reason::NotSupported, "another region without its own maximum"}; }
  static Failure undecided() { return {Reason::NotSupported, "the bounds leave much of the surface undecided"}; }
  double relativeReach(const Pixel& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const StarOutline& o : outlines_) least = std::min(least, o.relativeReach(p));
    return least;
  }
  /// Whether the place is inside an outline, or so close to one that nothing else follows from it.
  bool explained(const Pixel& p, double nearPx, const SurfacePoint& at) const {
    for (const StarOutline& o : outlines_) {
      if (o.surelyInside(p)) return true;
      const double least = o.leastRelativeReach(p);
      if (least >= kOnOutline && (1 - 1 / least) * (p - o.centre).norm() >= nearPx) continue;  // far from this one
      const double r = o.relativeReach(p);
      if (r < kOnOutline) return true;
      if ((1 - 1 / r) * (p - o.centre).norm() < nearPx && !(field_.value(facing(at, sampler_.eye())) < level_)) return true;
    }
    return false;
  }
  /// Whether a visible point is inside and lit, within the pixels that count, and outside of all outlines.
  bool insideElsewhere(const Pixel& p, const SurfacePoint& visible) const {
    if ((min_ - p).maxCoeff() > 0 || (p - max_).maxCoeff() > 0) return false;
    if (!(field_.value(visible) < level_) || relativeReach(p) < kOnOutline) return false;
    const double seen = (sampler_.eye() - visible.position).norm();
    return !surface_.occluded(visible, occlusionTarget(surface_, visible.position, field_.light, seen));
  }
  bool insideNear(const Pixel& p, double halfSide) const {
    std::vector<Pixel> pixels;
    std::vector<Ray> rays;
    for (int y = 0; y < kFine; ++y)
      for (int x = 0; x < kFine; ++x) {
        pixels.push_back(p + halfSide * Pixel(2 * (x + 0.5) / kFine - 1, 2 * (y + 0.5) / kFine - 1));
        rays.push_back(sampler_.ray(pixels.back()));
      }
    const std::vector<std::optional<SurfacePoint>> hits = surface_.approximateHits(rays);
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i] && insideElsewhere(pixels[i], facing(*hits[i], sampler_.eye()))) return true;
    return false;
  }

  /// What the grid's rays find; a failure where one finds something that is inside.
  std::optional<Failure> fill(RayGrid& grid) const {
    std::vector<Ray> rays;
    rays.reserve(grid.nodes.size());
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) rays.push_back(sampler_.ray(grid.pixelOf(i, j)));
    const std::vector<std::optional<SurfacePoint>> hits = surface_.approximateHits(rays);
    const Eigen::Vector4d& lw = field_.light.homogeneous();
    for (std::size_t n = 0; n < hits.size(); ++n) {
      if (!hits[n]) continue;
      const SurfacePoint p = facing(*hits[n], sampler_.eye());
      if (insideElsewhere(grid.pixelOf(static_cast<int>(n) % grid.nx, static_cast<int>(n) / grid.nx), p)) return elsewhere();
      Node& node = grid.nodes[n];
      const Eigen::Vector3d v = (sampler_.eye() - p.position).normalized(), offset = lw.head<3>() - lw.w() * p.position;
      node.lightDistance = offset.norm();
      const Eigen::Vector3d sum = offset / node.lightDistance + v;
      const double length = sum.norm();
      node.hit = length > 0;
      node.cosHalf = 0.5 * length;
      node.apart = sum / length - p.normal;
      node.cosView = p.normal.dot(v);
    }
    return std::nullopt;
  }
  /// Looks closer at cells whose bounds leave it open, unless an outline is near.
  std::optional<Failure> inCells(const EightCells& cells, double sidePx, int& looks) const {
    const Eight above = field_.above(cells.bounds, level_);
    for (int k = 0; k < cells.filled; ++k) {
      if (above[k] < 0) continue;
      const Pixel& p = cells.middles[k];
      const bool near = std::any_of(outlines_.begin(), outlines_.end(), [&](const StarOutline& o) {
        const double r = o.relativeReach(p);
        return r < 1 || (1 - 1 / r) * (p - o.centre).norm() < kCellsNear * sidePx;
      });
      if (near) continue;
      if (insideNear(p, 0.5 * sidePx)) return elsewhere();
      if (++looks > kMostLooks) return undecided();
    }
    return std::nullopt;
  }

  const StarField& field_;
  const Camera& camera_;
  const Surface& surface_;
  const std::vector<StarOutline>& outlines_;
  double level_;
  Pixel min_, max_;
  PixelSampler sampler_;
};

}  // namespace

std::optional<Failure> somethingElseInside(const StarField& field, const Camera& camera, const Surface& surface,
                                           const std::vector<StarOutline>& outlines, double level, const Pixel& min,
                                           const Pixel& max) {
  const Inspector inspector(field, camera, surface, outlines, level, min, max);
  if (const auto* bounded = dynamic_cast<const BoundedParts*>(&surface)) {
    bool answered = false;
    std::optional<Failure> found = inspector.byParts(*bounded, answered);
    if (answered) return found;
  }
  return inspector.byGrid();
}

}  // namespace glint
