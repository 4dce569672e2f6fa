// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/clip.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace glint::draw {
namespace {

/// From where to where, as shares of its length, a segment lies in the box; nothing if it does not.
std::optional<std::pair<double, double>> inside(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& low,
                                                const Eigen::Vector2d& high) {
  double from = 0, to = 1;
  for (int i = 0; i < 2; ++i) {
    const double d = b[i] - a[i];
    if (d == 0) {
      if (a[i] < low[i] || a[i] > high[i]) return {};
      continue;
    }
    const double t0 = (low[i] - a[i]) / d, t1 = (high[i] - a[i]) / d;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  if (!(from <= to)) return {};
  return std::pair(from, to);
}

}  // namespace

std::vector<Chain> chainsInside(const std::vector<Eigen::Vector2d>& points, bool closed, const Box& box) {
  Chain whole;
  whole.closed = closed;
  for (const Eigen::Vector2d& p : points)
    if (p.allFinite()) whole.points.push_back(p);
  const std::size_t n = whole.points.size();
  if (n < 2) return {};
  const Eigen::Vector2d low(box.x, box.y), high(box.x + box.width, box.y + box.height);
  const auto contains = [&](const Eigen::Vector2d& p) {
    return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
  };
  if (!(box.width > 0) || std::all_of(whole.points.begin(), whole.points.end(), contains)) return {whole};
  std::vector<Chain> chains;
  std::vector<Eigen::Vector2d> piece;
  const auto finish = [&] {
    if (piece.size() > 1) chains.push_back({piece, false});
    piece.clear();
  };
  for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
    const Eigen::Vector2d &a = whole.points[i], &b = whole.points[(i + 1) % n];
    const auto part = inside(a, b, low, high);
    if (!part) continue;  // the piece before it ended at the border
    if (piece.empty()) piece.push_back(a + part->first * (b - a));
    piece.push_back(a + part->second * (b - a));
    if (part->second < 1) finish();
  }
  finish();
  return chains;
}

}  // namespace glint::draw
