// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/ball_outline.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/app/ball_edges.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"

namespace glint {

namespace {

constexpr double kSearchShare = 0.1;  // the start is right to a tenth of its radius
constexpr double kLeastRadiusPx = 8;  // below it, a sector of the outline is shorter than a third of a pixel
constexpr double kBlurShare =
    1 / 280.;  // of the radius: where a ball fills the frame its edge is blurred by more pixels (1.5 of 420 measured)
constexpr double kLeastBlurPx = 1.0, kMostBlurPx = 4.0;  // sampling; what a lens blurs at most
constexpr double kFineReach = 16;                        // in blurs: what the first fit may be off
constexpr int kTries = 1500;                  // circles through three edges: one in nine of good edges is met 150 times
constexpr double kInlierShare = 0.006;        // of the radius, of the first circle: reflections lie beside the edge by more
constexpr double kTogether = 0.5;             // in blurs: edges of several photographs that are one
constexpr double kCloseWidth = 2;             // in blurs: where noise would lead the wide weights outwards
constexpr double kMuchMore = 1.25;            // of the support: a reflection may have a little more than the outline around it
constexpr double kFirstWidth = 6;             // in blurs: reflections lie inside of the edge by as much
constexpr double kInner = 0.7, kOuter = 1.3;  // in blurs: half width of the weights inside and outside of the outline
constexpr int kLeastSectors = kOutlineSectors / 3;   // fewer leave a centre that a shadow's edge may draw aside
constexpr int kWidestGap = kOutlineSectors * 5 / 9;  // 200 degrees: less than the other half of the outline
constexpr double kCounts = 0.05;                     // weight from which an edge is one that was used
constexpr double kLeastRcond = 1e-9;                 // of the normal matrix: below it a direction of the fit is free
constexpr double kLeastTriangle = 1e-6;              // px^2, twice the area: three points on a line
constexpr double kLeastGain = 0.1;   // of squared heights at twice the blur: a lens's blur is then five times ours
constexpr double kLevelShare = 0.5;  // of a grey level: rounding
constexpr double kShiftShare = 0.8,
                 kAside = 0.25;       // of the shift, along it and across: 95 % of the errors within three of it (tests)
constexpr double kRoughShare = 0.01;  // of the radius: the accuracy of a circle that a person draws on a large ball
constexpr double kCovered = 2;        // standard deviations to a given outline around the edges
constexpr int kLeftOut = 12;          // parts of the outline, each left out once

/// One place of the outline in one sector.
struct SectorEdge {
  int sector = 0;
  EdgePoint point;
};

struct WeightedEdge {
  double residual = 0, weight = 0;
};

/// Every sector's outermost edge within `outer` of the outline, with those of other photographs that agree with it.
std::vector<SectorEdge> outermost(const OutlineModel& model, const std::vector<BallEdge>& edges, double outer, double together) {
  std::array<double, kOutlineSectors> top;
  top.fill(-1e300);
  std::vector<double> distance(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    distance[i] = model.distance(edges[i].place);
    if (distance[i] < outer) top[edges[i].sector] = std::max(top[edges[i].sector], distance[i]);
  }
  std::array<SectorEdge, kOutlineSectors> mean{};
  std::array<double, kOutlineSectors> sum{};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const int s = edges[i].sector;
    if (!(distance[i] < outer) || distance[i] < top[s] - together) continue;
    const double w = 1 / (edges[i].sigmaPx * edges[i].sigmaPx);
    mean[s].point.place += w * edges[i].place;
    sum[s] += w;
  }
  std::vector<SectorEdge> result;
  for (int s = 0; s < kOutlineSectors; ++s)
    if (sum[s] > 0) result.push_back({s, {mean[s].point.place / sum[s], 1 / std::sqrt(sum[s])}});
  return result;
}

/// Half widths of Tukey's weights, px. Narrower inside, where reflections lie; equal where noise hides which side that is.
struct Widths {
  double inner = 0, outer = 0;
  Widths operator*(double times) const { return {inner * times, outer * times}; }
};

WeightedEdge weightedEdge(const OutlineModel& model, const Eigen::Vector2d& place, const Widths& widths) {
  const double r = model.distance(place), t = r / (2 * (r < 0 ? widths.inner : widths.outer));
  return {r, std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0.0};
}

/// One step of weighted Gauss-Newton. False if the edges do not determine one.
bool outlineStep(OutlineModel& model, const std::vector<SectorEdge>& edges, const Widths& widths, int leftOut = -1) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const SectorEdge& e : edges) {
    if (leftOut >= 0 && e.sector * kLeftOut / kOutlineSectors == leftOut) continue;
    const WeightedEdge w = weightedEdge(model, e.point.place, widths);
    if (w.weight == 0) continue;
    const Eigen::Vector3d row = model.derivatives(e.point.place);
    normal += w.weight * row * row.transpose();
    right -= w.weight * w.residual * row;
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() != Eigen::Success || !(solver.rcond() > kLeastRcond)) return false;
  const Eigen::Vector3d change = solver.solve(right);
  if (!change.allFinite()) return false;
  model.x += change;
  return model.x[2] > 0;
}

/// From wide weights to narrow ones.
bool fitOutline(OutlineModel& model, const std::vector<BallEdge>& edges, double blur, const Widths& widths, double widest) {
  std::vector<double> times;
  for (double w = widest; w > 1; w *= 0.8) times.push_back(w);
  times.insert(times.end(), 12, 1.0);
  for (const double t : times)
    for (int i = 0; i < 3; ++i)
      if (!outlineStep(model, outermost(model, edges, 2 * t * widths.outer, kTogether * blur), widths * t)) return false;
  return true;
}

/// How many sectors have an edge on the outline; those beside it count in part.
double support(const OutlineModel& model, const std::vector<BallEdge>& edges, double blur, const Widths& widths) {
  double sum = 0;
  for (const SectorEdge& e : outermost(model, edges, 2 * widths.outer, kTogether * blur))
    sum += weightedEdge(model, e.point.place, widths).weight;
  return sum;
}

/// From wide weights outwards; with equal ones from close by, where these find clearly more of an outline. The widths that were
/// used; nothing if neither fit holds.
std::optional<Widths> settle(OutlineModel& model, const std::vector<BallEdge>& edges, double blur, double widest) {
  const Widths outwards{kInner * blur, kOuter * blur}, equal{kOuter * blur, kOuter * blur};
  OutlineModel close = model;
  const double far = fitOutline(model, edges, blur, outwards, widest) ? support(model, edges, blur, outwards) : 0;
  const double near = fitOutline(close, edges, blur, equal, kCloseWidth) ? support(close, edges, blur, equal) : 0;
  if (far == 0 && near == 0) return std::nullopt;
  if (near <= kMuchMore * far) return outwards;
  model = close;
  return equal;
}

/// The circle through three points; radius 0 where they lie on a line.
Eigen::Vector3d circleThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  Eigen::Matrix2d m;
  m << (b - a).transpose(), (c - a).transpose();
  if (std::abs(m.determinant()) < kLeastTriangle) return Eigen::Vector3d::Zero();
  const Eigen::Vector2d centre = m.inverse() * (0.5 * Eigen::Vector2d((b - a).squaredNorm(), (c - a).squaredNorm()));
  return {a.x() + centre.x(), a.y() + centre.y(), centre.norm()};
}

bool nearStart(const Eigen::Vector3d& circle, const BallOutline& start) {
  return (circle.head<2>() - start.centre).norm() <= kSearchShare * start.radius &&
         std::abs(circle[2] - start.radius) <= kSearchShare * start.radius;
}

/// The circle through three edges near most sectors' edges.
std::optional<Eigen::Vector3d> firstCircle(const std::vector<BallEdge>& edges, const BallOutline& start) {
  std::optional<Eigen::Vector3d> best;
  double most = 0;
  std::mt19937 random(20);  // any fixed number: the same answer every time
  std::uniform_int_distribution<std::size_t> any(0, edges.size() - 1);
  const double scale = std::max(kLeastBlurPx, kInlierShare * start.radius);
  for (int i = 0; i < kTries; ++i) {
    const Eigen::Vector3d c = circleThrough(edges[any(random)].place, edges[any(random)].place, edges[any(random)].place);
    if (!(c[2] > 0) || !nearStart(c, start)) continue;
    std::array<double, kOutlineSectors> near{};
    for (const BallEdge& e : edges) {
      const double t = ((e.place - c.head<2>()).norm() - c[2]) / (2 * scale);
      if (std::abs(t) < 1) near[e.sector] = std::max(near[e.sector], (1 - t * t) * (1 - t * t));
    }
    double sum = 0;
    for (const double n : near) sum += n;
    if (sum > most) most = sum, best = c;
  }
  return best;
}

/// What the refined model leaves: the edges used, rms, and the covariance by leaving parts out.
RefinedOutline assessOutline(const OutlineModel& model, const std::vector<SectorEdge>& edges, const Widths& widths) {
  RefinedOutline result;
  double sum = 0, squares = 0;
  for (const SectorEdge& e : edges) {
    const WeightedEdge w = weightedEdge(model, e.point.place, widths);
    if (w.weight < kCounts) continue;
    result.edge.push_back(e.point);
    sum += w.weight;
    squares += w.weight * w.residual * w.residual;
  }
  result.degreesOfFreedom = static_cast<int>(result.edge.size()) - 3;
  result.residualPx = sum > 0 ? std::sqrt(squares / sum) : 0.0;
  for (EdgePoint& p : result.edge) p.sigmaPx = std::max(p.sigmaPx, result.residualPx);
  std::vector<Eigen::Vector3d> without;
  for (int part = 0; part < kLeftOut; ++part) {
    OutlineModel other = model;
    bool fine = true;
    for (int i = 0; fine && i < 10; ++i)
      fine = outlineStep(other, edges, widths, part);  // Gauss-Newton from so near: converged to 1e-6 px
    if (fine) without.push_back(other.x - model.x);
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& w : without) mean += w / static_cast<double>(without.size());
  for (const Eigen::Vector3d& w : without) result.covariance += (w - mean) * (w - mean).transpose();
  result.covariance *= (kLeftOut - 1.0) / kLeftOut;
  return result;
}

/// The median height of the edges on the outline, grey levels per px.
double heightOn(const OutlineModel& model, const std::vector<BallEdge>& edges, double within) {
  std::vector<double> steps;
  for (const BallEdge& e : edges)
    if (std::abs(model.distance(e.place)) < within) steps.push_back(std::abs(e.step));
  return steps.empty() ? 0.0 : upperMedian(steps);
}

/// The error that all edges share. A step beside light that rises or falls up to the rim, as in what a ball mirrors, seems to
/// lie slope / step sigma^2 aside, sigma the whole blur: with twice the blur of ours by how much more, and the heights tell
/// sigma. Grey levels are whole numbers: a faint edge is known to the width of one level.
Eigen::Matrix3d commonErrors(const OutlineModel& model, const std::vector<Image>& linear, const std::vector<BallEdge>& edges,
                             double blur) {
  const double twice = 2 * blur, fine = heightOn(model, edges, kOuter * blur);
  const double level = fine > 0 ? kLevelShare / fine : 0;
  Eigen::Matrix3d result = level * level * Eigen::Matrix3d::Identity();
  OutlineModel wider = model;
  const std::vector<BallEdge> again = ballEdges(linear, model, kFineReach * blur, twice, kTogether * twice);
  if (again.empty() || !settle(wider, again, twice, kCloseWidth)) return result;
  const double coarse = heightOn(wider, again, kOuter * twice);
  if (!(coarse > 0)) return result;
  const Eigen::Vector3d shift = (wider.x - model.x) / std::clamp(fine * fine / (coarse * coarse) - 1, kLeastGain, 3.0);
  return result + kShiftShare * kShiftShare *
                      (shift * shift.transpose() + kAside * kAside * shift.squaredNorm() * Eigen::Matrix3d::Identity());
}

/// The widest run of sectors without an edge.
int widestGap(const OutlineModel& model, const std::vector<EdgePoint>& edge) {
  std::array<bool, kOutlineSectors> has{};
  for (const EdgePoint& p : edge) {
    const Eigen::Vector2d d = p.place - model.x.head<2>();
    const double turn = std::atan2(d.y(), d.x()) / (2 * std::numbers::pi) * kOutlineSectors;
    has[(static_cast<int>(std::lround(turn)) + kOutlineSectors) % kOutlineSectors] = true;
  }
  int widest = 0, run = 0;
  for (int i = 0; i < 2 * kOutlineSectors; ++i) widest = std::max(widest, run = has[i % kOutlineSectors] ? 0 : run + 1);
  return std::min(widest, kOutlineSectors);
}

/// The circle of least squares to a model's outline: the model's own where it is one.
BallOutline circleOf(const OutlineModel& model) {
  if (!model.camera) return {model.x.head<2>(), model.x[2]};
  std::array<Eigen::Vector2d, kOutlineSectors> outline;
  for (int s = 0; s < kOutlineSectors; ++s) {
    const double angle = 2 * std::numbers::pi * s / kOutlineSectors;
    outline[s] = model.x.head<2>() + model.radiusAt(angle) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  OutlineModel circle{model.x, std::nullopt};
  for (int round = 0; round < 5; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int s = 0; s < kOutlineSectors; ++s) {  // weighted by length, so that the middle of an ellipse is its circle's
      const double length = (outline[(s + 1) % kOutlineSectors] - outline[(s + kOutlineSectors - 1) % kOutlineSectors]).norm();
      const Eigen::Vector3d row = circle.derivatives(outline[s]);
      normal += length * row * row.transpose();
      right -= length * circle.distance(outline[s]) * row;
    }
    circle.x += normal.ldlt().solve(right);
  }
  return {circle.x.head<2>(), circle.x[2]};
}

void checkRequest(std::span<const Image> photographs, const BallOutline& start, const std::optional<OutlineCamera>& camera) {
  require(!photographs.empty(), "refineBallOutline: no photograph");
  for (const Image& p : photographs)
    require(!p.empty() && (p.channels == 1 || p.channels == 3) && p.width == photographs[0].width &&
                p.height == photographs[0].height,
            "refineBallOutline: photographs of equal size with 1 or 3 channels");
  require(start.centre.allFinite() && start.radius >= kLeastRadiusPx && std::isfinite(start.radius),
          "refineBallOutline: a start of at least 8 px");
  require(!camera || (camera->focalPx > 0 && std::isfinite(camera->focalPx) && camera->principal.allFinite()),
          "refineBallOutline: a focal length above 0");
}

std::string ballText(const BallOutline& ball) {
  return "the ball at " + formatted("%.0f, %.0f", ball.centre.x(), ball.centre.y());
}

/// The model fitted to the photographs; places are those of the photographs. Two finer looks after the first.
Outcome<RefinedOutline> refineLinear(const std::vector<Image>& linear, const BallOutline& start,
                                     const std::optional<OutlineCamera>& camera) {
  const double blur = std::clamp(kBlurShare * start.radius, kLeastBlurPx, kMostBlurPx);
  const double slant =
      2 * std::numbers::pi / kOutlineSectors * kSearchShare * start.radius;  // of a centre that is off by a tenth
  OutlineModel model{{start.centre.x(), start.centre.y(), start.radius}, std::nullopt};
  const std::string ball = ballText(start);
  std::vector<BallEdge> edges = ballEdges(linear, model, 2 * kSearchShare * start.radius, blur, slant);
  const Failure nothing{Reason::TooFewPoints, ball + " has no outline to see"};
  if (edges.size() < 3) return nothing;
  const std::optional<Eigen::Vector3d> first = firstCircle(edges, start);
  if (!first) return nothing;
  model = {*first, camera};
  const double wide = std::max(kFirstWidth * blur, 2 * kInlierShare * start.radius) / blur;
  std::optional<Widths> widths = settle(model, edges, blur, wide);
  if (!widths) return nothing;
  for (int look = 0; look < 2; ++look) {
    edges = ballEdges(linear, model, kFineReach * blur, blur, kTogether * blur);
    widths = settle(model, edges, blur, look == 0 ? kFirstWidth : kCloseWidth);
    if (!widths) return nothing;
  }
  RefinedOutline result = assessOutline(model, outermost(model, edges, 2 * widths->outer, kTogether * blur), *widths);
  result.outline = circleOf(model);
  if (result.edge.size() < static_cast<std::size_t>(kLeastSectors))
    return Failure{Reason::TooFewPoints, ball + " shows an outline in " + std::to_string(result.edge.size()) + " of " +
                                             std::to_string(kOutlineSectors) + " directions; a third is needed"};
  if (widestGap(model, result.edge) > kWidestGap)
    return Failure{Reason::RankDeficient, ball + " shows its outline on one side only"};
  if (!nearStart({result.outline.centre.x(), result.outline.centre.y(), result.outline.radius}, start))
    return Failure{Reason::NotConverged, ball + ": the outline found lies more than a tenth of the radius from the one given"};
  result.covariance += commonErrors(model, linear, edges, blur);
  if (!result.covariance.allFinite()) return Failure{Reason::NotFinite, ball + ": the outline's covariance"};
  return result;
}

}  // namespace

Outcome<RefinedOutline> refineBallOutline(std::span<const Image> photographs, const Eigen::Vector2d& corner,
                                          const BallOutline& start, const std::optional<OutlineCamera>& camera) {
  checkRequest(photographs, start, camera);
  for (const Image& p : photographs)
    for (const float v : p.data)
      if (!std::isfinite(v)) return Failure{Reason::NotFinite, "a pixel of the photograph of " + ballText(start)};
  const Eigen::Vector2d nearest =
      (start.centre - corner).cwiseMax(0.0).cwiseMin(Eigen::Vector2d(photographs[0].width - 1, photographs[0].height - 1));
  if ((nearest - (start.centre - corner)).norm() > start.radius)
    return Failure{Reason::OutsideImage, ballText(start) + " lies outside of its photograph"};
  std::optional<OutlineCamera> shifted = camera;
  if (shifted) shifted->principal -= corner;
  Outcome<RefinedOutline> result = refineLinear(linearLight(photographs), {start.centre - corner, start.radius}, shifted);
  if (!result) return result;
  result->outline.centre += corner;
  for (EdgePoint& p : result->edge) p.place += corner;
  return result;
}

OutlineChoice chosenOutline(const Outcome<RefinedOutline>& found, const RefinedOutline& given) {
  if (!found) return {given, found.failure().message()};
  const auto sigma = [](const RefinedOutline& o) { return std::sqrt(o.covariance.diagonal().maxCoeff()); };
  if (!(sigma(*found) < std::max(sigma(given), kRoughShare * given.outline.radius)))
    return {given, formatted("its edges tell it to %.2g px only", sigma(*found))};
  OutlineChoice choice{*found, ""};
  const double inside = given.outline.radius - found->outline.radius - (given.outline.centre - found->outline.centre).norm();
  if (inside > 0) choice.outline.covariance(2, 2) += inside * inside / (kCovered * kCovered);
  if (inside > 3 * sigma(*found)) choice.withinPx = inside;
  return choice;
}

namespace {
constexpr double kLargest = 1e6;  // of the points' distance: beyond, the last digits of the points decide
}

Outcome<BallOutline> circleThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  if (!a.allFinite() || !b.allFinite() || !c.allFinite()) return Failure{Reason::NotFinite, "a point of the rim"};
  // 2 (p - a) . x = |p - a|^2 for the other two points, x from a.
  Eigen::Matrix2d rows;
  rows << (b - a).transpose(), (c - a).transpose();
  const double size = rows.norm();
  const Eigen::Vector2d squares = rows.rowwise().squaredNorm();
  if (!(size > 0) || !(kLargest * std::abs(rows.determinant()) > size * size))
    return Failure{Reason::RankDeficient, "the three points lie on a line"};
  const Eigen::Vector2d x = rows.inverse() * (0.5 * squares);
  return BallOutline{a + x, x.norm()};
}

}  // namespace glint
