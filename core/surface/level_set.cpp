// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/level_set.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/base/outcome.h"

namespace glint {
namespace {

using Box = Eigen::AlignedBox2d;

/// The field restricted to a window, with its level subtracted: negative inside.
class Region {
 public:
  Region(const PixelField& field, const PixelFieldBatch& batch, double level, const Box& window)
      : field_(field), batch_(batch), level_(level), window_(window) {}

  std::optional<double> at(const Pixel& p) const {
    if (!window_.contains(p)) return std::nullopt;
    const std::optional<double> value = field_(p);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    return *value - level_;
  }
  /// Many pixels at once, perhaps at reduced precision.
  std::vector<std::optional<double>> roughlyAt(const std::vector<Pixel>& pixels) const {
    if (!batch_) {
      std::vector<std::optional<double>> values(pixels.size());
      for (std::size_t i = 0; i < pixels.size(); ++i) values[i] = at(pixels[i]);
      return values;
    }
    std::vector<std::optional<double>> values = batch_(pixels);
    require(values.size() == pixels.size(), "traceLevelSets: the batch returned another number of values");
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!values[i] || !std::isfinite(*values[i]) || !window_.contains(pixels[i]))
        values[i].reset();
      else
        *values[i] -= level_;
    }
    return values;
  }
  const Box& window() const { return window_; }
  double level() const { return level_; }

 private:
  const PixelField& field_;
  const PixelFieldBatch& batch_;
  double level_;
  Box window_;
};

struct Vertex {
  Pixel p;
  char border;
};

/// The end of the inside between `inside` (value va < 0) and `other` (not inside): a root where the field is defined on
/// both sides, else the border of its domain, by bisection.
Vertex crossing(const Region& region, Pixel a, double va, Pixel b, std::optional<double> vb, double tolerance) {
  int kept = 0;  // which end moved last: Illinois' rule halves the value of the end that stays twice
  for (int i = 0; i < 200 && (b - a).norm() > tolerance; ++i) {
    double t = 0.5;
    if (vb && i % 8 != 7) {
      // Half a tolerance away from the ends, so that the bracket closes from both sides.
      const double edge = std::min(0.5, 0.5 * tolerance / (b - a).norm());
      t = std::clamp(va / (va - *vb), edge, 1 - edge);
    }
    const Pixel m = a + t * (b - a);
    if (m == a || m == b) break;
    const std::optional<double> vm = region.at(m);
    if (vm && *vm == 0) return {m, 0};
    if (vm && *vm < 0) {
      a = m;
      va = *vm;
      if (vb && kept == 1) *vb *= 0.5;
      kept = 1;
    } else {
      b = m;
      vb = vm;
      if (kept == -1) va *= 0.5;
      kept = -1;
    }
  }
  if (!vb) return {a, 1};  // the last defined place
  return {0.5 * (a + b), 0};
}

struct Component {
  std::vector<Vertex> vertices;
  double minimum = std::numeric_limits<double>::infinity();
  Pixel minimumAt{0, 0};

  Polyline outline() const {
    Polyline line;
    line.closed = true;
    for (const Vertex& v : vertices) line.points.push_back(v.p);
    return line;
  }
  Box box() const {
    Box b;
    for (const Vertex& v : vertices) b.extend(v.p);
    return b;
  }
  /// Diameter of a disc, width of a band (twice over): four times the area over the perimeter.
  double thickness() const {
    const Polyline line = outline();
    return 4 * std::abs(signedArea(line)) / std::max(length(line), 1e-300);  // not 0 / 0
  }
};

/// Regular samples over a window, one ring of them outside so that everything closes.
class Grid {
 public:
  Grid(const Region& region, double step, bool everywhere) : region_(region), step_(step) {
    const Eigen::Vector2d size = region.window().sizes();
    nx_ = static_cast<int>(std::ceil(size.x() / step)) + 3;
    ny_ = static_cast<int>(std::ceil(size.y() / step)) + 3;
    origin_ = region.window().center() - 0.5 * step * Eigen::Vector2d(nx_ - 1, ny_ - 1);
    values_.resize(static_cast<std::size_t>(nx_) * ny_);
    known_.assign(values_.size(), 0);
    everywhere ? sampleEverywhere() : sampleInTwoLevels();
    settleNearLevel();
  }

  /// Outer boundaries of all inside parts.
  std::vector<Component> trace(double tolerance) {
    std::vector<Component> components;
    // One directed segment per cell and crossing pair, keyed by the grid edge it leaves from; the inside is on the
    // side that x turns to y.
    next_.assign(2 * values_.size(), -1);
    for (int j = 0; j + 1 < ny_; ++j)
      for (int i = 0; i + 1 < nx_; ++i) addCell(i, j);
    for (std::size_t start = 0; start < next_.size(); ++start)
      if (next_[start] >= 0) {
        Component c;
        int edge = static_cast<int>(start);
        while (edge >= 0) {
          c.vertices.push_back(vertexOn(edge, tolerance));
          edge = std::exchange(next_[edge], -1);
          if (edge == static_cast<int>(start)) break;
        }
        if (c.vertices.size() >= 3 && signedArea(c.outline()) > 0) components.push_back(std::move(c));
      }
    assignMinima(components);
    return components;
  }

 private:
  int index(int i, int j) const { return j * nx_ + i; }
  Pixel pixel(int n) const { return origin_ + step_ * Eigen::Vector2d(n % nx_, n / nx_); }
  bool inside(int n) const { return values_[n] && *values_[n] < 0; }

  void sample(const std::vector<int>& nodes) {
    std::vector<Pixel> pixels;
    pixels.reserve(nodes.size());
    for (const int n : nodes) pixels.push_back(pixel(n));
    const std::vector<std::optional<double>> values = region_.roughlyAt(pixels);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      values_[nodes[i]] = values[i];
      known_[nodes[i]] = 1;
    }
  }
  void sampleEverywhere() {
    std::vector<int> nodes(values_.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = static_cast<int>(n);
    sample(nodes);
  }
  /// Every fourth node first; then all nodes of blocks that may reach below the level, judged by how much the field changes
  /// over the neighbouring blocks, or where it is undefined somewhere.
  void sampleInTwoLevels() {
    constexpr int kBlock = 4;
    const int bx = (nx_ - 2) / kBlock + 1, by = (ny_ - 2) / kBlock + 1;  // blocks; their last nodes may be cut
    const auto node = [&](int x, int y) { return index(std::min(x * kBlock, nx_ - 1), std::min(y * kBlock, ny_ - 1)); };
    std::vector<int> coarse;
    for (int y = 0; y <= by; ++y)
      for (int x = 0; x <= bx; ++x) coarse.push_back(node(x, y));
    sample(coarse);
    std::vector<char> wanted(values_.size(), 0);
    for (int y = 0; y < by; ++y)
      for (int x = 0; x < bx; ++x) {
        double lowest = std::numeric_limits<double>::infinity(), low = lowest, high = -lowest;
        int defined = 0, corners = 0;
        for (int v = std::max(0, y - 1); v <= std::min(by, y + 2); ++v)
          for (int u = std::max(0, x - 1); u <= std::min(bx, x + 2); ++u) {
            const bool corner = u >= x && u <= x + 1 && v >= y && v <= y + 1;
            corners += corner;
            const std::optional<double>& value = values_[node(u, v)];
            if (!value) continue;
            if (corner) {
              ++defined;
              lowest = std::min(lowest, *value);
            }
            low = std::min(low, *value);
            high = std::max(high, *value);
          }
        const bool borderOfDomain = defined > 0 && defined < corners;
        // Nothing defined at the corners: a part of the surface smaller than a block may hide, next to parts that are seen.
        const bool besideDomain = defined == 0 && high >= low;
        const bool reaches = defined > 0 && lowest - (high - low) < 0;
        if (!(reaches || besideDomain || (borderOfDomain && lowest - 2 * (high - low) < 0))) continue;
        for (int j = y * kBlock; j <= std::min((y + 1) * kBlock, ny_ - 1); ++j)
          for (int i = x * kBlock; i <= std::min((x + 1) * kBlock, nx_ - 1); ++i) wanted[index(i, j)] = 1;
      }
    // A component that leaves the wanted blocks is followed into their neighbours.
    while (true) {
      std::vector<int> nodes;
      for (std::size_t n = 0; n < wanted.size(); ++n)
        if (wanted[n] && !known_[n]) nodes.push_back(static_cast<int>(n));
      if (nodes.empty()) break;
      sample(nodes);
      for (int j = 1; j + 1 < ny_; ++j)
        for (int i = 1; i + 1 < nx_; ++i)
          if (inside(index(i, j)))
            for (const int n : {index(i - 1, j), index(i + 1, j), index(i, j - 1), index(i, j + 1)}) wanted[n] = 1;
    }
  }
  /// Nodes beside a boundary take the exact field, so that every bracket is a true one.
  void settleNearLevel() {
    std::vector<char> exact(values_.size(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      for (int j = 0; j < ny_; ++j)
        for (int i = 0; i < nx_; ++i) {
          const int n = index(i, j);
          const auto settle = [&](int m) {
            if (exact[m]) return;
            exact[m] = 1;
            const bool before = inside(m);
            values_[m] = region_.at(pixel(m));
            changed = changed || inside(m) != before;
          };
          if (i + 1 < nx_ && inside(n) != inside(n + 1)) settle(n), settle(n + 1);
          if (j + 1 < ny_ && inside(n) != inside(n + nx_)) settle(n), settle(n + nx_);
        }
    }
  }

  /// Grid edges: 2 n is node n to its right neighbour, 2 n + 1 to the one below.
  Vertex vertexOn(int edge, double tolerance) const {
    const int a = edge / 2, b = edge % 2 ? a + nx_ : a + 1;
    return inside(a) ? crossing(region_, pixel(a), *values_[a], pixel(b), values_[b], tolerance)
                     : crossing(region_, pixel(b), *values_[b], pixel(a), values_[a], tolerance);
  }
  void link(int from, int to) { next_[from] = to; }

  void addCell(int i, int j) {
    const int n = index(i, j);
    const std::array<int, 4> corner{n, n + 1, n + nx_ + 1, n + nx_};                  // turning from x towards y
    const std::array<int, 4> edge{2 * n, 2 * (n + 1) + 1, 2 * (n + nx_), 2 * n + 1};  // edge k joins corners k and k + 1
    int mask = 0;
    for (int k = 0; k < 4; ++k) mask |= inside(corner[k]) << k;
    if (mask == 0 || mask == 15) return;
    // Going round the cell, the boundary enters where the outside begins (corner in, next out) and leaves where it ends.
    std::array<int, 2> out{}, in{};
    int outs = 0, ins = 0;
    for (int k = 0; k < 4; ++k) {
      const bool here = mask >> k & 1, following = mask >> ((k + 1) % 4) & 1;
      if (here && !following) out[outs++] = k;
      if (!here && following) in[ins++] = k;
    }
    if (outs == 1) return link(edge[out[0]], edge[in[0]]);
    // Two opposite corners inside: a finer grid decides whether they are connected through the cell.
    const bool joined = diagonalJoined(corner[out[0]], corner[out[1]]);
    for (int k = 0; k < 2; ++k) {
      // Separate corners: from the edge after the corner back to the edge before it. Joined corners: across to the other corner.
      const int before = (out[k] + 3) % 4, after = (out[k] + 1) % 4;
      link(edge[out[k]], edge[joined ? after : before]);
    }
  }

  bool diagonalJoined(int a, int b) const {
    constexpr int kFine = 9;
    const Pixel from = pixel(a), d = pixel(b) - pixel(a);
    std::array<char, kFine * kFine> in{};
    for (int j = 0; j < kFine; ++j)
      for (int i = 0; i < kFine; ++i) {
        const std::optional<double> v = region_.at(from + Eigen::Vector2d(d.x() * i / (kFine - 1.0), d.y() * j / (kFine - 1.0)));
        in[j * kFine + i] = v && *v < 0;
      }
    std::vector<int> stack{0};
    in[0] = 2;
    while (!stack.empty()) {
      const int n = stack.back();
      stack.pop_back();
      if (n == kFine * kFine - 1) return true;
      const int x = n % kFine, y = n / kFine;
      const auto visit = [&](int u, int v) {
        if (u < 0 || v < 0 || u >= kFine || v >= kFine || in[v * kFine + u] != 1) return;
        in[v * kFine + u] = 2;
        stack.push_back(v * kFine + u);
      };
      visit(x + 1, y), visit(x - 1, y), visit(x, y + 1), visit(x, y - 1);
    }
    return false;
  }

  void assignMinima(std::vector<Component>& components) const {
    for (Component& c : components) {
      const Polyline line = c.outline();
      const Box box = c.box();
      const Eigen::Vector2d low = (box.min() - origin_) / step_, high = (box.max() - origin_) / step_;
      for (int j = std::max(0, static_cast<int>(std::ceil(low.y()))); j <= std::min(ny_ - 1, static_cast<int>(high.y())); ++j)
        for (int i = std::max(0, static_cast<int>(std::ceil(low.x()))); i <= std::min(nx_ - 1, static_cast<int>(high.x())); ++i) {
          const int n = index(i, j);
          if (!inside(n) || *values_[n] >= c.minimum || !contains(line, pixel(n))) continue;
          c.minimum = *values_[n];
          c.minimumAt = pixel(n);
        }
    }
  }

  const Region& region_;
  double step_;
  int nx_ = 0, ny_ = 0;
  Pixel origin_;
  std::vector<std::optional<double>> values_;
  std::vector<char> known_;
  std::vector<int> next_;  ///< per edge, the edge where the segment that leaves from it ends; only one cell sees it as leaving
};

/// Chords of a component split until they are within the sagitta.
class Splitter {
 public:
  Splitter(const Region& region, const LevelSetOptions& options) : region_(region), options_(options) {}

  std::vector<Vertex> refined(const std::vector<Vertex>& coarse) {
    out_.clear();
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      const Vertex& a = coarse[i];
      const Vertex& b = coarse[(i + 1) % coarse.size()];
      // px: vertices this near are one that two neighbouring cells found.
      if (out_.empty() || (out_.back().p - a.p).norm() > 1e-7) out_.push_back(a);
      split(a, b, 0);
    }
    while (out_.size() > 3 && (out_.back().p - out_.front().p).norm() <= 1e-7) out_.pop_back();  // as above
    return std::move(out_);
  }

 private:
  void split(const Vertex& a, const Vertex& b, int depth) {
    const Eigen::Vector2d chord = b.p - a.p;
    const double length = chord.norm();
    if (length < 2 * options_.sagittaPx || depth > 14) return;
    const std::optional<Vertex> middle = onCurve(0.5 * (a.p + b.p), Eigen::Vector2d(chord.y(), -chord.x()) / length, length);
    if (!middle) return;
    const double offset = (middle->p - 0.5 * (a.p + b.p)).norm();
    const bool smooth = a.border == b.border && a.border == middle->border;
    // On a smooth curve halves have a quarter of the sagitta; at the end of the domain there may be a corner.
    const bool done = offset <= (smooth && depth > 0 ? 4 : 1) * options_.sagittaPx;
    if (done && offset <= 1e-3 * options_.sagittaPx) return;  // straight: nothing gained by a vertex
    if (!done) split(a, *middle, depth + 1);
    out_.push_back(*middle);
    if (!done) split(*middle, b, depth + 1);
  }

  /// Nearest end of the inside from p along +-normal, within a few chord lengths. `outwards` points away from the
  /// inside.
  std::optional<Vertex> onCurve(const Pixel& p, const Eigen::Vector2d& outwards, double length) const {
    const std::optional<double> here = region_.at(p);
    const bool isInside = here && *here < 0;
    const Eigen::Vector2d direction = isInside ? outwards : Eigen::Vector2d(-outwards);
    // A sharp tip can stand out of its chord by more than the chord's length.
    const double farthest = isInside ? 4 * length : length;
    Pixel last = p;
    std::optional<double> lastValue = here;
    for (double reach = std::max(0.02 * length, 2 * options_.sagittaPx);; reach *= 4) {
      reach = std::min(reach, farthest);
      const Pixel q = p + reach * direction;
      const std::optional<double> value = region_.at(q);
      const bool qInside = value && *value < 0;
      if (isInside && !qInside) return crossing(region_, last, *lastValue, q, value, options_.tolerancePx);
      if (!isInside && qInside) return crossing(region_, q, *value, last, lastValue, options_.tolerancePx);
      if (reach >= farthest) return std::nullopt;
      last = q;
      lastValue = value;
    }
  }

  const Region& region_;
  const LevelSetOptions& options_;
  std::vector<Vertex> out_;
};

/// How far the inside reaches from an inside pixel, smallest and largest over 16 directions, by doubling steps.
std::pair<double, double> reachFrom(const Region& region, const Pixel& p, double farthest) {
  double smallest = std::numeric_limits<double>::infinity(), largest = 0;
  for (int k = 0; k < 16; ++k) {
    const double a = k * std::numbers::pi / 8;
    const Eigen::Vector2d d(std::cos(a), std::sin(a));
    double reach = 1e-3;  // px: the smallest highlight that is told from a point
    while (reach < farthest) {
      const std::optional<double> v = region.at(p + reach * d);
      if (!v || *v >= 0) break;
      reach *= 1.5;
    }
    smallest = std::min(smallest, reach);
    largest = std::max(largest, reach);
  }
  return {smallest, largest};
}

/// The component around an inside pixel, traced on a finer grid in a window that grows until the component fits.
std::optional<Component> traceAround(const PixelField& field, const PixelFieldBatch& batch, double level, const Box& domain,
                                     const Pixel& p, double step, Box window, double tolerance) {
  for (int growth = 0; growth < 8; ++growth) {
    const Box clipped = window.intersection(domain);
    if (clipped.isEmpty()) return std::nullopt;
    const double largest = clipped.sizes().maxCoeff();
    const double used = std::max(step, largest / 400);  // at most 160,000 samples
    const Region region(field, batch, level, clipped);
    for (Component& c : Grid(region, used, true).trace(tolerance)) {
      if (!contains(c.outline(), p)) continue;
      const Box box = c.box();
      const double close = 1e-6 * largest + 2 * tolerance;  // of the size found first: the same border
      const bool cut = (box.min().x() < clipped.min().x() + close && clipped.min().x() > domain.min().x()) ||
                       (box.min().y() < clipped.min().y() + close && clipped.min().y() > domain.min().y()) ||
                       (box.max().x() > clipped.max().x() - close && clipped.max().x() < domain.max().x()) ||
                       (box.max().y() > clipped.max().y() - close && clipped.max().y() < domain.max().y());
      if (!cut) return std::move(c);
      break;
    }
    const Eigen::Vector2d grow = window.sizes();
    window = Box(window.min() - grow, window.max() + grow);
  }
  return std::nullopt;
}

/// Lowers the minimum of components that contain a place with a lower value. @return whether any contains it
bool lowerMinima(std::vector<Component>& components, const Pixel& p, double value) {
  bool known = false;
  for (Component& c : components) {
    if (!contains(c.outline(), p)) continue;
    known = true;
    if (value < c.minimum) c.minimum = value, c.minimumAt = p;
  }
  return known;
}

/// Outlines as smooth as asked for, the largest first.
std::vector<LevelSetComponent> refined(const std::vector<Component>& components, const Region& region,
                                       const LevelSetOptions& options) {
  std::vector<LevelSetComponent> result;
  Splitter splitter(region, options);
  for (const Component& c : components) {
    LevelSetComponent out;
    for (const Vertex& v : splitter.refined(c.vertices)) {
      out.outline.points.push_back(v.p);
      out.onBorder.push_back(v.border);
    }
    out.minimum = c.minimum + region.level();
    out.minimumAt = c.minimumAt;
    if (out.outline.points.size() >= 3) result.push_back(std::move(out));
  }
  std::stable_sort(result.begin(), result.end(), [](const LevelSetComponent& a, const LevelSetComponent& b) {
    return std::abs(signedArea(a.outline)) > std::abs(signedArea(b.outline));
  });
  return result;
}

}  // namespace

std::vector<LevelSetComponent> traceLevelSets(const PixelField& field, const PixelFieldBatch& batch, double level, int width,
                                              int height, const LevelSetOptions& options) {
  require(width > 0 && height > 0, "traceLevelSets: width and height must be positive");
  return traceLevelSets(field, batch, level, Box(Pixel(-0.5, -0.5), Pixel(width - 0.5, height - 0.5)), options);
}

std::vector<LevelSetComponent> traceLevelSets(const PixelField& field, const PixelFieldBatch& batch, double level,
                                              const Eigen::AlignedBox2d& window, const LevelSetOptions& options) {
  require(static_cast<bool>(field), "traceLevelSets: no field");
  require(window.sizes().allFinite() && window.sizes().minCoeff() > 0, "traceLevelSets: the window must be finite and not empty");
  require(options.gridStepPx > 0 && options.sagittaPx > 0 && options.tolerancePx > 0 && options.marginPx >= 0,
          "traceLevelSets: gridStepPx, sagittaPx and tolerancePx must be positive, marginPx not negative");
  require(std::isfinite(level), "traceLevelSets: level must be finite");
  const Pixel margin(options.marginPx, options.marginPx);
  const Box domain(window.min() - margin, window.max() + margin);
  const Region region(field, batch, level, domain);

  std::vector<Component> coarse = Grid(region, options.gridStepPx, false).trace(options.tolerancePx), components;
  // Thin components may be broken or missing corners on this grid: trace them again with about 8 cells across.
  std::vector<Pixel> todo;
  for (Component& c : coarse) {
    if (c.thickness() > 4 * options.gridStepPx || !std::isfinite(c.minimum))
      components.push_back(std::move(c));
    else
      todo.push_back(c.minimumAt);
  }
  for (const Pixel& seed : options.seeds)
    if (seed.allFinite()) todo.push_back(seed);
  for (const Pixel& p : todo) {
    const std::optional<double> value = region.at(p);
    if (!value || !(*value < 0)) continue;
    if (lowerMinima(components, p, *value)) continue;
    const auto [smallest, largest] = reachFrom(region, p, 8 * options.gridStepPx);
    // At most 64 cells along the region and at least four across it; 1e-3 px as in reachFrom.
    const double step = std::clamp(smallest / 4, std::max(largest / 64, 1e-3), options.gridStepPx);
    const Eigen::Vector2d half = Eigen::Vector2d::Constant(1.2 * largest + 3 * step);
    std::optional<Component> c = traceAround(field, batch, level, domain, p, step, Box(p - half, p + half), options.tolerancePx);
    if (!c) continue;
    if (*value < c->minimum) c->minimum = *value, c->minimumAt = p;
    // What the finer grid shows to be one part replaces the pieces seen before.
    const Polyline outline = c->outline();
    std::erase_if(components, [&](const Component& old) { return contains(outline, old.minimumAt); });
    components.push_back(std::move(*c));
  }
  return refined(components, region, options);
}

}  // namespace glint
