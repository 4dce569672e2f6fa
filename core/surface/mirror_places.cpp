// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/mirror_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace glint {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

namespace {

constexpr std::size_t kParts = 16384;  // of large meshes: a few MB of balls and cones, of which a search sees some ten kB
constexpr int kBitsPerAxis = 10;

/// Margins above the round-off of float (6e-8 per operation, a dozen operations on numbers of order 1).
constexpr double kBallMargin = 1e-6;       // of half the box
constexpr float kCosineMargin = 2e-6f;     // after squares and roots of it
constexpr float kDirectionMargin = 4e-7f;  // of a unit vector

/// Bits of a number with two zeros between each.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 16) & 0x030000ffu;
  v = (v | v << 8) & 0x0300f00fu;
  v = (v | v << 4) & 0x030c30c3u;
  return (v | v << 2) & 0x09249249u;
}

struct Keyed {
  std::uint32_t key;
  int triangle;
};

/// Sorts by radix, least significant digit first, three digits of ten bits.
void sortByKey(std::vector<Keyed>& items) {
  std::vector<Keyed> other(items.size());
  for (int digit = 0; digit < 3; ++digit) {
    const int shift = digit * kBitsPerAxis;
    std::array<std::uint32_t, (1u << kBitsPerAxis) + 1> first{};
    for (const Keyed& k : items) ++first[(k.key >> shift & 1023u) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    for (const Keyed& k : items) other[first[k.key >> shift & 1023u]++] = k;
    items.swap(other);
  }
}

/// A node while the tree is built.
struct Node {
  AlignedBox3d box;
  Vector3d centre{0, 0, 0}, axis{0, 0, 1};
  double radius = 0, angle = 0;  ///< half angle of the cone, rad; pi: all directions
  int next = 0;
};

}  // namespace

class NormalTree::Builder {
 public:
  Builder(NormalTree& tree, const TriangleMesh& mesh, const std::function<Vector3d(int, int)>& edgePoint,
          std::vector<Keyed> order)
      : tree_(tree),
        mesh_(mesh),
        edgePoint_(edgePoint),
        order_(std::move(order)),
        most_(std::max<std::size_t>(1, order_.size() / kParts)) {}

  void build() {
    tree_.finest_ = most_ == 1;
    const Node root = node(0, order_.size(), 0);
    if (root.next >= 0) return;
    // All triangles in one part: it is the only child of a root.
    Block block = emptyBlock();
    store(root, block);
    tree_.blocks_.push_back(block);
  }

 private:
  static Block emptyBlock() {
    Block block;
    for (Eight Block::*field : {&Block::x, &Block::y, &Block::z, &Block::radius, &Block::axisX, &Block::axisY, &Block::axisZ,
                                &Block::cosine, &Block::sine})
      (block.*field).setOnes();  // unused places: finite, never looked at
    block.next.fill(-1);
    return block;
  }

  /// Node of the triangles [first, end), which share the key's first `depth` digits.
  Node node(std::size_t first, std::size_t end, int depth) {
    if (end - first <= most_ && depth > 0) return part(first, end);
    // Children: the next digit of the key. Beyond the last digit (many triangles in one cell) runs of equal length.
    std::array<std::size_t, 9> bound;
    bound[0] = first;
    if (depth < kBitsPerAxis) {
      const int shift = 3 * (kBitsPerAxis - 1 - depth);
      if (order_[first].key >> shift == order_[end - 1].key >> shift) return node(first, end, depth + 1);
      for (std::uint32_t digit = 0; digit < 8; ++digit)
        bound[digit + 1] = std::partition_point(order_.begin() + bound[digit], order_.begin() + end,
                                                [&](const Keyed& k) { return (k.key >> shift & 7u) <= digit; }) -
                           order_.begin();
    } else {
      for (std::size_t k = 1; k <= 8; ++k) bound[k] = first + (end - first) * k / 8;
    }
    const int at = static_cast<int>(tree_.blocks_.size());
    tree_.blocks_.emplace_back();
    Block block = emptyBlock();
    std::array<Node, 8> children;
    for (int k = 0; k < 8; ++k)
      if (bound[k] < bound[k + 1]) {
        children[block.count] = node(bound[k], bound[k + 1], depth + 1);
        store(children[block.count], block);
      }
    tree_.blocks_[at] = block;
    return around(children.data(), block.count, at);
  }

  Node part(std::size_t first, std::size_t end) const {
    Node part;
    part.next = -1 - order_[(first + end - 1) / 2].triangle;
    const auto eachPoint = [&](auto&& visit) {
      for (std::size_t j = first; j < end; ++j) {
        const Eigen::Vector3i& t = mesh_.triangles[order_[j].triangle];
        for (int k = 0; k < 3; ++k) {
          visit(mesh_.vertices[t[k]]);
          if (edgePoint_) visit(edgePoint_(t[k], t[(k + 1) % 3]));  // a quadratic patch lies in the hull of its control points
        }
      }
    };
    Vector3d sum(0, 0, 0);
    bool whole = false;
    eachPoint([&](const Vector3d& p) { part.box.extend(p); });
    for (std::size_t j = first; j < end; ++j)
      for (const int v : mesh_.triangles[order_[j].triangle]) {
        sum += mesh_.normals[v];
        whole = whole || mesh_.normals[v].isZero();
      }
    part.centre = part.box.center();
    double squared = 0;
    eachPoint([&](const Vector3d& p) { squared = std::max(squared, (p - part.centre).squaredNorm()); });
    part.radius = std::sqrt(squared);
    // Interpolated normals are unit vectors along convex sums of the vertices' normals: they stay in any cone below 90 degrees.
    part.axis = sum.normalized();
    double cosine = 1, sine = 0;  // of the widest; the sine's square
    for (std::size_t j = first; j < end && !whole; ++j)
      for (const int v : mesh_.triangles[order_[j].triangle]) {
        const double c = part.axis.dot(mesh_.normals[v]);
        if (!(c > 0)) whole = true;
        cosine = std::min(cosine, c);
        sine = std::max(sine, part.axis.cross(mesh_.normals[v]).squaredNorm());
      }
    part.angle = whole ? std::numbers::pi : std::atan2(std::sqrt(sine), cosine);
    return part;
  }

  static Node around(const Node* children, int count, int next) {
    Node parent;
    parent.next = next;
    Vector3d sum(0, 0, 0);
    for (int k = 0; k < count; ++k) {
      parent.box.extend(children[k].box);
      sum += children[k].axis;
    }
    parent.centre = parent.box.center();
    // Where the axes cancel any axis is as good as another; the cone is then wide.
    parent.axis = sum.norm() > 1e-3 ? Vector3d(sum.normalized()) : children[0].axis;
    for (int k = 0; k < count; ++k) {
      const Node& c = children[k];
      parent.radius = std::max(parent.radius, (c.centre - parent.centre).norm() + c.radius);
      parent.angle = std::max(parent.angle, c.angle + std::atan2(parent.axis.cross(c.axis).norm(), parent.axis.dot(c.axis)));
    }
    parent.radius = std::min(parent.radius, 0.5 * parent.box.sizes().norm());
    return parent;
  }

  void store(const Node& n, Block& b) const {
    const Vector3d c = (n.centre - tree_.centre_) * tree_.scale_;
    const int k = b.count++;
    b.x[k] = static_cast<float>(c.x());
    b.y[k] = static_cast<float>(c.y());
    b.z[k] = static_cast<float>(c.z());
    b.radius[k] = static_cast<float>(n.radius * tree_.scale_ * (1 + kBallMargin) + kBallMargin);
    b.axisX[k] = static_cast<float>(n.axis.x());
    b.axisY[k] = static_cast<float>(n.axis.y());
    b.axisZ[k] = static_cast<float>(n.axis.z());
    const bool whole = !(n.angle < 0.5 * std::numbers::pi);
    b.cosine[k] = whole ? -1.f : static_cast<float>(std::cos(n.angle));
    b.sine[k] = whole ? 0.f : static_cast<float>(std::sin(n.angle));
    b.next[k] = n.next;
  }

  NormalTree& tree_;
  const TriangleMesh& mesh_;
  const std::function<Vector3d(int, int)>& edgePoint_;
  std::vector<Keyed> order_;
  std::size_t most_;  ///< triangles in a part
};

NormalTree::NormalTree(const TriangleMesh& mesh, const MeshTopology& topology, const AlignedBox3d& bounds,
                       const std::function<Vector3d(int, int)>& edgePoint)
    : centre_(bounds.center()), scale_(2 / bounds.sizes().norm()) {
  std::vector<Keyed> order;
  order.reserve(mesh.triangles.size());
  const double cells = ((1 << kBitsPerAxis) - 1) / std::max(bounds.sizes().maxCoeff(), 1e-300);  // not 0 / 0
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!topology.alive[i]) continue;
    const Eigen::Vector3i& t = mesh.triangles[i];
    const Vector3d p = ((mesh.vertices[t.x()] + mesh.vertices[t.y()] + mesh.vertices[t.z()]) / 3 - bounds.min()) * cells;
    order.push_back({spread(static_cast<std::uint32_t>(p.x())) | spread(static_cast<std::uint32_t>(p.y())) << 1 |
                         spread(static_cast<std::uint32_t>(p.z())) << 2,
                     static_cast<int>(i)});
  }
  sortByKey(order);
  Builder(*this, mesh, edgePoint, std::move(order)).build();
}

NormalTree::View NormalTree::viewOf(const MirrorQuery& query) const {
  View view;
  view.eye = ((query.eye - centre_) * scale_).cast<float>();
  const Vector3d l = (query.light.head<3>() - query.light.w() * centre_) * scale_;
  const double size = std::hypot(l.norm(), query.light.w());  // so that float cannot overflow
  view.light = (l / size).cast<float>();
  view.w = static_cast<float>(query.light.w() / size);
  view.lightUnit = size / scale_;
  for (int k = 0; k < 4; ++k)
    view.sides[k] << query.sides[k].cast<float>(), static_cast<float>(query.sides[k].dot(centre_ - query.eye) * scale_);
  return view;
}

NormalTree::Halfway NormalTree::halfwayOf(const Block& b, const View& view, float lightReach) {
  // Chord of the angle under which a ball is seen from a point outside of it; more than 2 from inside.
  const auto chord = [](const Eight& radiusOverDistance) -> Eight {
    const Eight s = radiusOverDistance.min(1.f);
    return s * (2.f / (1.f + (1.f - s * s).sqrt())).sqrt() + 1e3f * (radiusOverDistance - 0.999f).max(0.f);
  };
  Halfway h;
  const Eight vx = view.eye.x() - b.x, vy = view.eye.y() - b.y, vz = view.eye.z() - b.z;
  const Eight lx = view.light.x() - view.w * b.x, ly = view.light.y() - view.w * b.y, lz = view.light.z() - view.w * b.z;
  // The eye may lie inside a ball: 1e-30 keeps 0 / 0 away, and the chord is then the whole sphere.
  h.toEye = (vx * vx + vy * vy + vz * vz).sqrt().max(1e-30f);
  h.toLight = (lx * lx + ly * ly + lz * lz).sqrt().max(1e-30f);  // as above
  const Eight sx = vx / h.toEye + lx / h.toLight, sy = vy / h.toEye + ly / h.toLight, sz = vz / h.toEye + lz / h.toLight;
  h.sum = (sx * sx + sy * sy + sz * sz).sqrt().max(1e-30f);  // as above
  // L + V moves by at most the two chords within the ball, H therefore by an angle of at most asin(of them / |L + V|).
  h.viewChord = chord(b.radius / h.toEye);
  const Eight moved = h.viewChord + chord((view.w * b.radius + lightReach) / h.toLight) + kDirectionMargin;
  h.sine = (moved / h.sum).min(1.f);
  h.cosine = (1.f - h.sine * h.sine).sqrt();
  h.between = (b.axisX * sx + b.axisY * sy + b.axisZ * sz) / h.sum;
  h.viewAlong = (b.axisX * vx + b.axisY * vy + b.axisZ * vz) / h.toEye;
  return h;
}

Eight NormalTree::insideOf(const Block& b, const View& view) {
  const auto& sides = view.sides;
  Eight inside = sides[0].x() * b.x + sides[0].y() * b.y + sides[0].z() * b.z + sides[0].w();
  for (int k = 1; k < 4; ++k) inside = inside.min(sides[k].x() * b.x + sides[k].y() * b.y + sides[k].z() * b.z + sides[k].w());
  return inside + b.radius;
}

std::optional<std::vector<int>> NormalTree::candidates(const MirrorQuery& query, std::size_t most) const {
  const View view = viewOf(query);
  std::vector<int> found;
  std::vector<int> tasks{0};
  while (!tasks.empty()) {
    const Block& b = blocks_[tasks.back()];
    tasks.pop_back();
    // N is parallel to some H only if the cone around N and the one around H overlap.
    const Halfway h = halfwayOf(b, view, 0);
    const Eight missed = b.cosine * h.cosine - b.sine * h.sine - h.between.abs();
    const Eight inside = insideOf(b, view);
    for (int k = 0; k < b.count; ++k) {
      if (missed[k] > kCosineMargin || inside[k] < 0) continue;
      if (b.next[k] >= 0) {
        tasks.push_back(b.next[k]);
        continue;
      }
      if (found.size() == most) return std::nullopt;
      found.push_back(-1 - b.next[k]);
    }
  }
  return found;
}

std::optional<std::vector<std::pair<int, double>>> NormalTree::partsThatMay(const MirrorQuery& query, double lightReach,
                                                                            const PartTest& test, std::size_t most,
                                                                            std::optional<double> fromOutside) const {
  const View view = viewOf(query);
  // N.V below this is turned away. 2: never.
  const float away =
      fromOutside && *fromOutside < 0.5 * std::numbers::pi ? static_cast<float>(std::sin(*fromOutside)) + kCosineMargin : 2.f;
  const float reach = static_cast<float>(lightReach / view.lightUnit * (1 + kBallMargin));
  const float unitSquared = static_cast<float>(view.lightUnit * view.lightUnit);
  std::vector<std::pair<int, double>> found;
  std::vector<int> tasks{0};
  while (!tasks.empty()) {
    const Block& b = blocks_[tasks.back()];
    tasks.pop_back();
    const Halfway h = halfwayOf(b, view, reach);
    PartBounds bounds;
    // The angle between axis and H, less both cones; 0 where the cones overlap or span more than a half space.
    const Eight coneCosine = b.cosine * h.cosine - b.sine * h.sine, coneSine = b.sine * h.cosine + b.cosine * h.sine;
    const Eight along = h.between.abs().min(1.f), across = (1.f - along * along).sqrt();
    const Eight apartSine = (across * coneCosine - along * coneSine - kCosineMargin).max(0.f);
    // The bound 1e-3 is an angle near 90 degrees.
    const Eight apartCosine = (along * coneCosine + across * coneSine + kCosineMargin).max(1e-3f);
    const Eigen::Array<bool, 8, 1> overlap = along + kCosineMargin >= coneCosine || coneCosine <= 0.f;
    bounds.tanSquared = overlap.select(Eight::Zero(), (apartSine / apartCosine).square());
    // The angle between axis and V, plus both cones.
    const Eight viewSine = h.viewChord.min(1.f), viewCosine = (1.f - viewSine * viewSine).sqrt();
    const Eight openCosine = b.cosine * viewCosine - b.sine * viewSine, openSine = b.sine * viewCosine + b.cosine * viewSine;
    const Eight facing = h.viewAlong.abs().min(1.f), aside = (1.f - facing * facing).sqrt() * openSine;
    bounds.cosView = (openCosine <= 0.f).select(Eight::Zero(), (facing * openCosine - aside - kCosineMargin).max(0.f));
    // The largest N.V of a part whose axis points away from the eye.
    const Eigen::Array<bool, 8, 1> unseen = openCosine > 0.f && h.viewAlong < 0.f && aside - facing * openCosine < -away;
    bounds.cosHalf = (0.5f * h.sum * (1.f - h.sine) - kDirectionMargin).max(0.f);
    bounds.lightSquared = ((h.toLight - view.w * b.radius - reach) * (1.f - kCosineMargin)).max(0.f).square() * unitSquared;
    const Eight excess = test(bounds), inside = insideOf(b, view);
    for (int k = 0; k < b.count; ++k) {
      if (excess[k] < 0 || inside[k] < 0 || unseen[k]) continue;
      if (b.next[k] >= 0) {
        tasks.push_back(b.next[k]);
        continue;
      }
      if (found.size() == most) return std::nullopt;
      found.emplace_back(-1 - b.next[k], b.radius[k] / scale_);
    }
  }
  return found;
}

}  // namespace glint
