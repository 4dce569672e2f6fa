// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/metrics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

// Our own distances of polylines: the libraries' polygons have no gaps, which predictions have where directions fail.

namespace glint {

namespace {

using Segment = ContourPart::Segment;

/// Segments of a polyline without its gaps and without repeated points' zero-length pieces.
std::vector<Segment> segmentsOf(const Polyline& line, const std::vector<std::pair<int, int>>& gaps) {
  std::vector<Segment> out;
  const int n = static_cast<int>(line.points.size());
  const int count = n < 2 ? 0 : line.closed ? n : n - 1;
  for (int i = 0; i < count; ++i) {
    const int j = (i + 1) % n;
    if (std::find(gaps.begin(), gaps.end(), std::pair<int, int>(i, j)) != gaps.end()) continue;
    const Pixel &a = line.points[i], &b = line.points[j];
    constexpr double kRepeated = 1e-15;  // of the coordinates: their round-off
    if ((b - a).norm() > kRepeated * (a.norm() + b.norm())) out.emplace_back(a, b);
  }
  return out;
}

/// 720 of an ellipse: every comparison takes the same directions.
std::vector<Segment> segmentsOf(const Ellipse& e) {
  constexpr int kCount = 720;
  static const auto directions = [] {
    std::vector<Eigen::Vector2d> d(kCount);
    for (int i = 0; i < kCount; ++i) {
      const double t = 2 * std::numbers::pi * i / kCount;
      d[i] = {std::cos(t), std::sin(t)};
    }
    return d;
  }();
  const Eigen::Rotation2Dd turn(e.angle);
  const Eigen::Matrix2d rotation = turn.toRotationMatrix();
  Polyline line;
  line.points.reserve(kCount);
  for (const Eigen::Vector2d& d : directions) line.points.push_back(e.centre + rotation * e.semiAxes.cwiseProduct(d));
  return segmentsOf(line, {});
}

double lengthOf(const std::vector<Segment>& segments) {
  double sum = 0;
  for (const Segment& s : segments) sum += (s.second - s.first).norm();
  return sum;
}

/// Distances from points along a path to one chain of segments: the same minimum as over all of them. Boxes around runs of
/// segments tell which ones cannot be nearest, the next point is usually nearest to where the last one was, and a box that was
/// far stays far until the path has gone that way.
class NearestSegment {
 public:
  explicit NearestSegment(const std::vector<Segment>& segments) {
    runs_.reserve(segments.size() / kRun + 1);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      if (i % kRun == 0) runs_.emplace_back();
      if (i % (kRun * kRuns) == 0) groups_.emplace_back();
      const auto& [a, b] = segments[i];
      for (Box* box : {&runs_.back().box, &groups_.back()}) box->extend(a), box->extend(b);
      for (std::size_t k = i % kRun; k < kRun; ++k) runs_.back().set(k, a, b - a);  // a shorter last run repeats its last segment
    }
    farUntil_.assign(groups_.size(), -1);
  }

  double operator()(const Pixel& q) {
    if (at_) travelled_ += (q - *at_).norm();
    at_ = q;
    double best = std::numeric_limits<double>::infinity();
    const std::size_t start = last_;
    look(start, q, best);
    double reach = std::sqrt(best) + travelled_;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (farUntil_[g] > reach || isFarther(groups_[g], q, best, farUntil_[g])) continue;
      for (std::size_t r = g * kRuns; r < std::min(runs_.size(), (g + 1) * kRuns); ++r) {
        if (r == start || runs_[r].farUntil > reach || isFarther(runs_[r].box, q, best, runs_[r].farUntil)) continue;
        look(r, q, best);
        reach = std::sqrt(best) + travelled_;
      }
    }
    return std::sqrt(best);
  }

 private:
  using Box = Eigen::AlignedBox2d;
  static constexpr std::size_t kRun = 8, kRuns = 8;
  static constexpr double kMarginPx = 1e-6;  // of the path's length, far above its round-off

  using Eight = Eigen::Array<double, kRun, 1>;
  struct Run {
    Eight ax, ay, dx, dy, squared;
    Box box;
    double farUntil = -1;
    void set(std::size_t k, const Pixel& a, const Pixel& d) {
      ax[k] = a.x();
      ay[k] = a.y();
      dx[k] = d.x();
      dy[k] = d.y();
      squared[k] = d.squaredNorm();
    }
  };

  /// Remembers up to which length of path, and distance to look for beyond it, the box needs no look. The factor keeps round-off
  /// from turning down the nearest segment.
  bool isFarther(const Box& box, const Pixel& q, double best, double& farUntil) const {
    const double squared = box.squaredExteriorDistance(q);
    if (!(squared > best * (1 + 1e-9))) return false;  // round-off must not turn down the nearest
    farUntil = std::sqrt(squared) + travelled_ - kMarginPx;
    return true;
  }

  void look(std::size_t run, const Pixel& q, double& best) {
    const Run& r = runs_[run];
    const Eight t = (((q.x() - r.ax) * r.dx + (q.y() - r.ay) * r.dy) / r.squared).max(0.0).min(1.0);
    const Eight x = r.ax + t * r.dx - q.x(), y = r.ay + t * r.dy - q.y();
    const double squared = (x * x + y * y).minCoeff();
    if (squared < best) best = squared, last_ = run;
  }

  std::vector<Run> runs_;
  std::vector<Box> groups_;
  std::vector<double> farUntil_;  ///< of the groups
  std::size_t last_ = 0;
  std::optional<Pixel> at_;
  double travelled_ = 0;
};

struct OneWay {
  double mean = 0, max = 0;
};

/// Samples at the centres of equal arc-length pieces of `from` (midpoint rule), distance to `to`.
OneWay oneWay(const std::vector<Segment>& from, const std::vector<Segment>& to) {
  const double total = lengthOf(from);
  // Two samples a pixel resolve what marching squares can show; the bounds keep tiny and huge contours sensible.
  const int n = static_cast<int>(std::clamp(2 * total, 360.0, 2000.0));
  OneWay result;
  NearestSegment distanceTo(to);
  std::size_t segment = 0;
  double start = 0, l = (from[0].second - from[0].first).norm();
  for (int i = 0; i < n; ++i) {
    const double s = total * (i + 0.5) / n;
    while (s > start + l && segment + 1 < from.size()) {
      start += l;
      ++segment;
      l = (from[segment].second - from[segment].first).norm();
    }
    const Pixel q = from[segment].first + std::clamp((s - start) / l, 0.0, 1.0) * (from[segment].second - from[segment].first);
    const double d = distanceTo(q);
    result.mean += d / n;
    result.max = std::max(result.max, d);
  }
  return result;
}

/// Horizontal lines through a set of shapes, equally spaced.
struct Rows {
  double low, high;
  int count;
  double y(int i) const { return low + (high - low) * (i + 0.5) / count; }
};

/// Crossings of every row with one closed polyline. Each edge is asked only by the rows that it spans.
struct Crossings {
  std::vector<double> x;           ///< of all rows, row by row
  std::vector<std::size_t> start;  ///< of each row in x, and the end
};

Crossings crossings(const Polyline& shape, const Rows& rows) {
  Crossings c;
  c.start.assign(rows.count + 1, 0);
  const auto& p = shape.points;
  const double perRow = rows.count / (rows.high - rows.low);
  const auto forEach = [&](const auto& visit) {
    for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
      const double top = std::min(p[i].y(), p[j].y()), bottom = std::max(p[i].y(), p[j].y());
      if (!std::isfinite(top + bottom)) continue;
      // One row more on both sides: the exact test decides.
      const int first = std::max(0, static_cast<int>((top - rows.low) * perRow - 1.5));
      const int last = std::min(rows.count - 1, static_cast<int>((bottom - rows.low) * perRow + 0.5));
      for (int r = first; r <= last; ++r)
        if (const double y = rows.y(r); (p[i].y() > y) != (p[j].y() > y)) visit(r, y, p[i], p[j]);
    }
  };
  forEach([&](int r, double, const Pixel&, const Pixel&) { ++c.start[r + 1]; });
  for (int r = 0; r < rows.count; ++r) c.start[r + 1] += c.start[r];
  c.x.resize(c.start.back());
  std::vector<std::size_t> next(c.start.begin(), c.start.end() - 1);
  forEach([&](int r, double y, const Pixel& a, const Pixel& b) {
    c.x[next[r]++] = a.x() + (y - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
  });
  for (int r = 0; r < rows.count; ++r) std::sort(c.x.begin() + c.start[r], c.x.begin() + c.start[r + 1]);
  return c;
}

/// Inside intervals of the union of shapes (even-odd within each) on one row.
void intervals(const std::vector<Crossings>& shapes, int row, std::vector<std::pair<double, double>>& out) {
  out.clear();
  for (const Crossings& c : shapes)
    for (std::size_t k = c.start[row]; k + 1 < c.start[row + 1]; k += 2) out.emplace_back(c.x[k], c.x[k + 1]);
  std::sort(out.begin(), out.end());
  std::size_t kept = 0;
  for (std::size_t k = 1; k < out.size(); ++k) {
    if (out[k].first <= out[kept].second)
      out[kept].second = std::max(out[kept].second, out[k].second);
    else
      out[++kept] = out[k];
  }
  if (!out.empty()) out.resize(kept + 1);
}

double lengthOf(const std::vector<std::pair<double, double>>& spans) {
  double sum = 0;
  for (const auto& [a, b] : spans) sum += b - a;
  return sum;
}

double commonLength(const std::vector<std::pair<double, double>>& a, const std::vector<std::pair<double, double>>& b) {
  double sum = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    sum += std::max(0.0, std::min(a[i].second, b[j].second) - std::max(a[i].first, b[j].first));
    if (a[i].second < b[j].second)
      ++i;
    else
      ++j;
  }
  return sum;
}

}  // namespace

double regionIou(const std::vector<Polyline>& a, const std::vector<Polyline>& b, double cellPx) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto* set : {&a, &b})
    for (const Polyline& s : *set)
      for (const Pixel& p : s.points) low = std::min(low, p.y()), high = std::max(high, p.y());
  if (!(high > low)) return 0;
  // Exact along each line; the lines sample the height by the midpoint rule.
  const Rows rows{low, high, static_cast<int>(std::clamp(std::ceil((high - low) / cellPx), 200.0, 4000.0))};
  std::vector<Crossings> xa, xb;
  for (const Polyline& s : a) xa.push_back(crossings(s, rows));
  for (const Polyline& s : b) xb.push_back(crossings(s, rows));
  double common = 0, all = 0;
  std::vector<std::pair<double, double>> ia, ib;
  for (int i = 0; i < rows.count; ++i) {
    intervals(xa, i, ia);
    intervals(xb, i, ib);
    const double both = commonLength(ia, ib);
    common += both;
    all += lengthOf(ia) + lengthOf(ib) - both;
  }
  return all > 0 ? common / all : 0;
}

std::vector<std::pair<int, int>> matchByOverlap(const std::vector<Polyline>& observed, const std::vector<Polyline>& predicted,
                                                std::vector<double>* ious) {
  struct Candidate {
    double iou;
    int o, p;
  };
  std::vector<Candidate> candidates;
  for (int o = 0; o < static_cast<int>(observed.size()); ++o)
    for (int p = 0; p < static_cast<int>(predicted.size()); ++p)
      if (const double iou = regionIou({observed[o]}, {predicted[p]}); iou > 0) candidates.push_back({iou, o, p});
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) { return x.iou > y.iou; });
  std::vector<char> usedO(observed.size(), 0), usedP(predicted.size(), 0);
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    if (usedO[c.o] || usedP[c.p]) continue;
    usedO[c.o] = usedP[c.p] = 1;
    kept.push_back(c);
  }
  std::sort(kept.begin(), kept.end(), [](const Candidate& x, const Candidate& y) { return x.o < y.o; });
  std::vector<std::pair<int, int>> pairs;
  if (ious) ious->clear();
  for (const Candidate& c : kept) {
    pairs.emplace_back(c.o, c.p);
    if (ious) ious->push_back(c.iou);
  }
  return pairs;
}

namespace {

/// Mean and largest distance of the contours' pieces from each other; of one contour alone where the other has no pieces.
OneWay bothWays(const std::vector<Segment>& o, const std::vector<Segment>& p, const std::vector<Segment>& fromO,
                const std::vector<Segment>& fromP) {
  if (fromO.empty() || fromP.empty()) return fromO.empty() ? fromP.empty() ? OneWay{} : oneWay(fromP, o) : oneWay(fromO, p);
  const OneWay forth = oneWay(fromO, p), back = oneWay(fromP, o);
  return {0.5 * (forth.mean + back.mean), std::max(forth.max, back.max)};
}

ContourMetrics undefinedMetrics(const Pixel& observedPeak, const Pixel& predictedPeak) {
  ContourMetrics m;
  m.contourErrorPx = m.contourErrorPct = m.ellipseErrorPct = m.hausdorffPx = m.centreOffsetPx = std::nan("");
  m.axisRatioError = m.angleErrorDeg = std::nan("");
  m.peakOffsetPx = (observedPeak - predictedPeak).norm();
  return m;
}

/// All that is not a distance of points on the contours.
void compareRegions(const Polyline& observed, const Polyline& predicted, const std::optional<Ellipse>& predictedEllipse,
                    std::optional<double> iou, ContourMetrics& m) {
  const double diameter = 2 * std::sqrt(std::abs(signedArea(observed)) / std::numbers::pi);
  m.contourErrorPct = diameter > 0 ? 100 * m.contourErrorPx / diameter : std::nan("");
  m.iou = iou ? *iou : regionIou({observed}, {predicted});
  m.centreOffsetPx = (centroid(observed) - centroid(predicted)).norm();
  const Outcome<Ellipse> eo = fitEllipse(observed.points);
  std::optional<Ellipse> ep = predictedEllipse;
  if (!ep)
    if (const Outcome<Ellipse> fitted = fitEllipse(predicted.points)) ep = *fitted;
  if (!eo || !ep) return;
  const std::vector<Segment> so = segmentsOf(*eo), sp = segmentsOf(*ep);
  if (!so.empty() && !sp.empty())
    m.ellipseErrorPct = 50 * (oneWay(so, sp).mean + oneWay(sp, so).mean) / std::sqrt(4 * eo->area() / std::numbers::pi);
  const double ro = eo->semiAxes.y() / eo->semiAxes.x(), rp = ep->semiAxes.y() / ep->semiAxes.x();
  m.axisRatioError = std::abs(ro - rp);
  const double angle = std::fmod(std::abs(eo->angle - ep->angle) * 180 / std::numbers::pi, 180);
  m.angleErrorDeg = (ro > 0.99 || rp > 0.99) ? 0 : std::min(angle, 180 - angle);  // a circle has no axis
}

/// The part of a piece that the image shows, up to the centres of its outermost pixels.
std::optional<Segment> seenOf(const Segment& piece, const Camera& camera) {
  const Pixel a = camera.distorted(piece.first), d = camera.distorted(piece.second) - a;
  if (!a.allFinite() || !d.allFinite()) return std::nullopt;
  double from = 0, to = 1;
  const double last[2] = {camera.width - 1.0, camera.height - 1.0};
  for (int axis = 0; axis < 2; ++axis) {
    if (d(axis) == 0) {
      if (a(axis) < 0 || a(axis) > last[axis]) return std::nullopt;
      continue;
    }
    const double t = -a(axis) / d(axis), u = (last[axis] - a(axis)) / d(axis);
    from = std::max(from, std::min(t, u));
    to = std::min(to, std::max(t, u));
  }
  if (!(to > from)) return std::nullopt;
  const Pixel along = piece.second - piece.first;
  return Segment{piece.first + from * along, piece.first + to * along};
}

/// A line as the photograph measures it, without places that the lens shows nowhere.
Polyline measured(const Polyline& ideal, const Camera& camera) {
  if (!camera.hasDistortion()) return ideal;
  Polyline line{{}, ideal.closed};
  for (const Pixel& p : ideal.points)
    if (const Pixel q = camera.distorted(p); q.allFinite()) line.points.push_back(q);
  return line;
}

}  // namespace

ContourPart partInImage(const Polyline& contour, const std::vector<std::pair<int, int>>& gaps, const Camera& camera) {
  ContourPart part;
  Polyline whole = measured(contour, camera);
  whole.closed = true;
  part.region = clippedTo(Eigen::AlignedBox2d(Pixel(0, 0), Pixel(camera.width - 1.0, camera.height - 1.0)), whole);
  if (camera.hasDistortion())
    for (Pixel& p : part.region.points) p = camera.undistorted(p);
  for (const Segment& s : segmentsOf(contour, gaps)) {
    if (alongImageBorder(camera, s.first, s.second)) continue;
    part.line.push_back(s);
    if (const std::optional<Segment> seen = seenOf(s, camera)) part.seen.push_back(*seen);
  }
  return part;
}

ContourMetrics compareContours(const ContourPart& observed, const ContourPart& predicted, const Pixel& observedPeak,
                               const Pixel& predictedPeak, std::optional<double> iou) {
  ContourMetrics m = undefinedMetrics(observedPeak, predictedPeak);
  if (observed.region.points.empty() || predicted.region.points.empty()) return m;
  const auto alone = [](const ContourPart& a, const ContourPart& b) { return !a.seen.empty() && b.line.empty(); };
  if (alone(observed, predicted) || alone(predicted, observed)) return m;
  const OneWay distance = bothWays(observed.line, predicted.line, observed.seen, predicted.seen);
  m.contourErrorPx = distance.mean;
  m.hausdorffPx = distance.max;
  compareRegions(observed.region, predicted.region, std::nullopt, iou, m);
  return m;
}

ContourMetrics compareContours(const Polyline& observed, const Polyline& predicted, const std::vector<std::pair<int, int>>& gaps,
                               const std::optional<Ellipse>& predictedEllipse, const Pixel& observedPeak,
                               const Pixel& predictedPeak, std::optional<double> iou) {
  ContourMetrics m = undefinedMetrics(observedPeak, predictedPeak);
  const std::vector<Segment> o = segmentsOf(observed, {}), p = segmentsOf(predicted, gaps);
  if (o.empty() || p.empty()) return m;
  const OneWay distance = bothWays(o, p, o, p);
  m.contourErrorPx = distance.mean;
  m.hausdorffPx = distance.max;
  compareRegions(observed, predicted, predictedEllipse, iou, m);
  return m;
}

double quantileOf(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return std::nan("");
  const double at = q * double(sorted.size() - 1);
  const std::size_t i = static_cast<std::size_t>(at);
  const double t = at - double(i);
  return i + 1 < sorted.size() ? (1 - t) * sorted[i] + t * sorted[i + 1] : sorted[i];
}

Statistic statisticOf(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  std::sort(values.begin(), values.end());
  Statistic s;
  s.count = static_cast<int>(values.size());
  double sum = 0;
  for (const double v : values) sum += v;
  s.mean = values.empty() ? std::nan("") : sum / double(values.size());
  s.median = quantileOf(values, 0.5);
  s.p95 = quantileOf(values, 0.95);
  s.max = values.empty() ? std::nan("") : values.back();
  return s;
}

}  // namespace glint
