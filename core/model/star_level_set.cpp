// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/star_level_set.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/camera.h"
#include "core/model/models.h"
#include "core/model/pixel_sampler.h"
#include "core/model/star.h"
#include "core/model/walk.h"
#include "core/reflectance/lobe_terms.h"

namespace glint {

namespace {

// Shares of the region's radius. Differences over a tenth of it are unbiased to a part in a thousand; those of the last step,
// over a hundredth, to one in 1e5, and a mesh's kinks cost less than that.
constexpr double kWideStencil = 0.1, kNarrowStencil = 0.01;
constexpr int kSummitSteps = 10;
constexpr double kLargestAxisRatio = 100;  // beyond it (a fold) no second order describes the region

constexpr double kReachTolerance = 1e-6;  // relative; a hundredth of the contour's tolerance
constexpr int kRootSteps = 8;
constexpr double kTrust = 0.35;  // of the rise and of the reach: beyond it another branch may be in between
constexpr double kFall = 0.02;   // of the rise: a value that falls by more on its way out is no round-off or mesh noise
constexpr double kMarchStart = 0.2, kMarchGrowth = 1.35, kFarthest = 30;

// Share of the diameter: how far the curve between the directions may be off where it is checked. The points of the check join
// the outline, so that what remains is at most half of this (a kink), a thirtieth on a smooth curve.
constexpr double kMeanOff = 1e-4, kLargestOff = 5e-4;
constexpr std::size_t kMostDirections = 288;

/// Frame of the region { value < minimum + rise } to second order.
std::optional<Eigen::Matrix2d> frameOf(const Eigen::Matrix2d& hessian, double rise) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(hessian);
  const Eigen::Vector2d& k = eigen.eigenvalues();
  if (!(k.x() > 0) || !(k.y() < k.x() * kLargestAxisRatio * kLargestAxisRatio)) return std::nullopt;
  Eigen::Matrix2d frame = eigen.eigenvectors() * (2 * rise / k.array()).sqrt().matrix().asDiagonal();
  if (frame.determinant() < 0) frame.col(1) = -frame.col(1);  // turns from x to y
  return frame;
}

/// Weights of the polynomial through six values at equal steps, half-way between the middle two.
constexpr double kHalfway[6] = {3.0 / 256, -25.0 / 256, 150.0 / 256, 150.0 / 256, -25.0 / 256, 3.0 / 256};

/// Walks from one summit.
class Walk {
 public:
  Walk(const PixelSampler& sampler, const Summit& summit, const Eigen::Matrix2d& frame, double level)
      : sampler_(sampler), summit_(summit), frame_(frame), level_(level), rise_(level - summit.value) {}

  struct End {
    double reach;
    double slope;  ///< of the value by reach^2
    SurfacePoint point;
  };
  Eigen::Vector2d ray(double t) const { return frame_ * Eigen::Vector2d(std::cos(t), std::sin(t)); }

  /// The end in a direction of the image, from what its neighbours say.
  Outcome<End> end(const Eigen::Vector2d& ray, double guess, double slope, const SurfacePoint& from) const {
    double u = guess * guess, before = 0, valueBefore = 0, step = 1;
    const double expected = u;
    SurfacePoint at = from;
    for (int i = 0; i < kRootSteps; ++i) {
      const std::optional<PixelSample> s = sampler_.near(summit_.pixel + std::sqrt(u) * ray, at);
      if (!s) return ended();
      const double f = s->value - level_;
      if (!(std::abs(f) < kTrust * rise_)) return lost();
      // Closer, the difference is round-off.
      if (i > 0 && std::abs(u - before) > 1e-9 * u) slope = (f - valueBefore) / (u - before);
      if (!(slope > 0)) return lost();  // falling: not the first crossing
      at = s->point;
      const double next = u - f / slope, lastStep = i > 0 ? step : 0.05;  // 0.05: what a neighbour's slope is worth
      if (!(std::abs(next - expected) < 2 * kTrust * expected)) return lost();
      step = 0.5 * std::abs(next - u) / u;
      before = u;
      valueBefore = f;
      u = next;
      if (step * lastStep < kReachTolerance) return End{std::sqrt(u), slope, at};
    }
    return lost();
  }

  /// Goes outwards until the level is crossed, without any guess.
  Outcome<End> march(const Eigen::Vector2d& ray) const {
    double reach = 0, value = -rise_, highest = -rise_;
    SurfacePoint at = summit_.point;
    for (double next = kMarchStart; next < kFarthest; next = reach + kMarchStart * std::max(1.0, reach * kMarchGrowth)) {
      const std::optional<PixelSample> s = sampler_.near(summit_.pixel + next * ray, at);
      if (!s) return ended();
      const double f = s->value - level_;
      if (f < highest - kFall * rise_) return Failure{Reason::NotMonotonic, "the field falls before it reaches the level"};
      if (f >= 0) return between(ray, reach, value, next, f, at);
      highest = std::max(highest, f);
      reach = next, value = f, at = s->point;
    }
    return Failure{Reason::NotReached, "the field stays under the level"};
  }

 private:
  static Failure ended() { return {Reason::SurfaceEnded, "the surface or the lit side ends inside the region"}; }
  static Failure lost() { return {Reason::NotConverged, "the end of a direction"}; }
  /// A root between two reaches, by regula falsi (Illinois) in reach^2; our own for the reason in walk.cpp.
  Outcome<End> between(const Eigen::Vector2d& ray, double low, double valueLow, double high, double valueHigh,
                       SurfacePoint at) const {
    double a = low * low, b = high * high, fa = valueLow, fb = valueHigh;
    const double chord = (valueHigh - valueLow) / (b - a);
    int kept = 0;
    for (int i = 0; i < 60; ++i) {  // bisection alone needs 24
      const double u = a - fa * (b - a) / (fb - fa);
      const std::optional<PixelSample> s = sampler_.near(summit_.pixel + std::sqrt(u) * ray, at);
      if (!s) return ended();
      const double f = s->value - level_;
      at = s->point;
      if (std::abs(f) < kReachTolerance * rise_ || b - a < kReachTolerance * b) return End{std::sqrt(u), chord, at};
      if (f < 0) {
        a = u, fa = f;
        if (kept == 1) fb *= 0.5;
        kept = 1;
      } else {
        b = u, fb = f;
        if (kept == -1) fa *= 0.5;
        kept = -1;
      }
    }
    return lost();
  }

  const PixelSampler& sampler_;
  const Summit& summit_;
  const Eigen::Matrix2d& frame_;
  double level_, rise_;
};

}  // namespace

Outcome<Summit> summitNear(const StarField& field, const Camera& camera, const Surface& surface, const BrightestPoint& start,
                           double rise) {
  const PixelSampler sampler(field.value, camera, surface);
  const Failure ended{Reason::SurfaceEnded, "the surface or the lit side ends at the maximum"},
      rough{Reason::NotConverged, "no smooth single maximum near the mirror point"};
  Summit top;
  top.pixel = start.pixel;
  std::optional<PixelSample> here = sampler.near(start.pixel, start.point);
  if (!here) return ended;
  double lowest = here->value;
  const auto around = [&](const Eigen::Vector2d& offset) {
    const std::optional<PixelSample> s = sampler.near(top.pixel + offset, here->point);
    if (s) lowest = std::min(lowest, s->value);
    return s ? s->value : std::nan("");
  };
  Eigen::Matrix2d frame = Eigen::Matrix2d::Identity(), curved = frame;
  bool known = false;
  for (int i = 0; i < kSummitSteps; ++i) {
    const double h = kWideStencil;
    double f[3][3];
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b) f[a + 1][b + 1] = a == 0 && b == 0 ? here->value : around(h * frame * Eigen::Vector2d(a, b));
    const Eigen::Vector2d gradient(f[2][1] - f[0][1], f[1][2] - f[1][0]);
    curved(0, 0) = (f[2][1] - 2 * f[1][1] + f[0][1]) / (h * h);
    curved(1, 1) = (f[1][2] - 2 * f[1][1] + f[1][0]) / (h * h);
    curved(0, 1) = curved(1, 0) = (f[2][2] - f[2][0] - f[0][2] + f[0][0]) / (4 * h * h);
    if (!curved.allFinite() || !gradient.allFinite()) return ended;
    const Eigen::Matrix2d inverse = frame.inverse();
    top.hessian = inverse.transpose() * curved * inverse;
    const std::optional<Eigen::Matrix2d> next = frameOf(top.hessian, rise);
    if (!next) {
      if (known) return rough;
      frame *= 0.2;  // smaller than the stencil was: closer the field may be convex
      continue;
    }
    // Differences over a stencil of another size than the region's say little about it: first the size, then the step.
    const Eigen::Matrix2d change = inverse * *next;
    const bool fits = change.norm() < 3 * std::numbers::sqrt2 && change.inverse().norm() < 3 * std::numbers::sqrt2;
    Eigen::Vector2d step = -curved.ldlt().solve(gradient) / (2 * h);
    const double length = step.norm();
    if (fits) {
      known = true;
      if (length > 1) step /= length;
      top.pixel += frame * step;
      here = sampler.near(top.pixel, here->point);
      if (!here) return ended;
      lowest = std::min(lowest, here->value);
    }
    frame = *next;
    if (!fits || length > 0.03) continue;  // the next step would be a thousandth
    // The last step, free of the third order; the Hessian is known.
    const double n = kNarrowStencil;
    const double left = around(-n * frame.col(0)), right = around(n * frame.col(0)), up = around(-n * frame.col(1)),
                 down = around(n * frame.col(1));
    const Eigen::Vector2d last =
        Eigen::Vector2d(right - left, down - up) / (-2 * n * 2 * rise);  // in its own frame the Hessian is 2 rise
    if (!(last.norm() < 0.1)) return rough;
    top.pixel += frame * last;
    here = sampler.near(top.pixel, here->point);
    if (!here || !(here->value <= lowest + 1e-5 * rise)) return rough;  // a kink, or a lower place beside it
    top.point = here->point;
    top.value = here->value;
    return top;
  }
  return rough;
}

double StarOutline::relativeReach(const Pixel& p) const {
  const Eigen::Vector2d x = inverse * (p - centre);
  const int n = static_cast<int>(reach.size());
  double at = std::atan2(x.y(), x.x()) / (2 * std::numbers::pi) * n;
  if (at < 0) at += n;
  const int i = std::min(static_cast<int>(at), n - 1);
  const double share = at - i;
  return x.norm() / ((1 - share) * reach[i] + share * reach[(i + 1) % n]);
}

namespace {

double angleOf(int direction, int of) { return 2 * std::numbers::pi * direction / of; }

/// Ends in n directions, each from what those before it say. @param slopes  gets those of the value by reach^2
std::optional<Failure> walkAround(const Walk& walk, int n, StarOutline& outline, std::vector<double>& slopes) {
  ReachGuess guess;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d ray = walk.ray(angleOf(i, n));
    Outcome<Walk::End> end = Failure{Reason::NotConverged, ""};
    if (i > 0) end = walk.end(ray, guess.next(), slopes[i - 1], outline.points[i - 1]);
    if (!end) end = walk.march(ray);
    if (!end) return end.failure();
    guess.add(end->reach);
    outline.reach.push_back(end->reach);
    slopes.push_back(end->slope);
    outline.points.push_back(end->point);
  }
  return std::nullopt;
}

Failure unknownCurve() { return {Reason::NotConverged, "the curve between the directions"}; }

/// Joins the directions half-way between those of an outline: where the curve through its ends lies, corrected by what the field
/// says there.
/// @return whether the curve was known well enough
Outcome<bool> joinHalfway(const Walk& walk, const PixelSampler& sampler, const Surface& surface, double level,
                          StarOutline& outline, std::vector<double>& slopes) {
  const Failure ended{Reason::SurfaceEnded, "the surface or the lit side ends between the directions"};
  const int n = static_cast<int>(outline.reach.size());
  std::vector<double> reach(2 * n), slope(2 * n);
  std::vector<SurfacePoint> points(2 * n);
  std::vector<Ray> rays;
  rays.reserve(n);
  double mean = 0, largest = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    reach[2 * i] = outline.reach[i], slope[2 * i] = slopes[i], points[2 * i] = outline.points[i];
    double between = 0;
    for (int k = 0; k < 6; ++k) between += kHalfway[k] * outline.reach[(i + k - 2 + n) % n];
    if (!(between > 0)) return unknownCurve();
    reach[2 * i + 1] = between;
    squares += outline.reach[i] * outline.reach[i];
    rays.push_back(sampler.ray(outline.centre + between * walk.ray(angleOf(2 * i + 1, 2 * n))));
  }
  const double area = std::numbers::pi * outline.frame.determinant();
  const double diameter = 2 * std::sqrt(area / std::numbers::pi * squares / n);
  const std::vector<std::optional<SurfacePoint>> hits = surface.approximateHits(rays);
  for (int i = 0; i < n; ++i) {
    double& r = reach[2 * i + 1];
    const Eigen::Vector2d ray = walk.ray(angleOf(2 * i + 1, 2 * n));
    if (!hits[i]) return ended;
    const std::optional<PixelSample> s = sampler.near(outline.centre + r * ray, *hits[i]);
    if (!s) return ended;
    const double g = 0.5 * (slopes[i] + slopes[(i + 1) % n]), off = (s->value - level) / (2 * g * r);  // of the reach
    // Across the contour: in the frame the outline is nearly a circle, and its normal is the ray.
    const Eigen::Vector2d normal = outline.inverse.transpose() * (outline.inverse * ray);
    const double distance = std::abs(off) / normal.norm();
    mean += distance / n;
    largest = std::max(largest, distance);
    r -= off;
    slope[2 * i + 1] = g;
    points[2 * i + 1] = s->point;
    if (std::abs(off) > 1e-3 * r) {  // a Newton step from that far leaves an error of a part in 1e5
      const Outcome<Walk::End> end = walk.end(ray, r, g, s->point);
      if (!end) return end.failure();
      r = end->reach;
      slope[2 * i + 1] = end->slope;
      points[2 * i + 1] = end->point;
    }
  }
  outline.reach = std::move(reach);
  slopes = std::move(slope);
  outline.points = std::move(points);
  return mean <= kMeanOff * diameter && largest <= kLargestOff * diameter;
}

}  // namespace

Outcome<StarOutline> starAround(const StarField& field, const Camera& camera, const Surface& surface, const Summit& summit,
                                double level, int directions) {
  const std::optional<Eigen::Matrix2d> frame = frameOf(summit.hessian, level - summit.value);
  if (!frame) return Failure{Reason::NotConverged, "the maximum is too long for its width"};
  const PixelSampler sampler(field.value, camera, surface);
  const Walk walk(sampler, summit, *frame, level);
  StarOutline outline;
  outline.centre = summit.pixel;
  outline.frame = *frame;
  outline.inverse = frame->inverse();
  std::vector<double> slopes;
  // Half of the directions, as those half-way between join them; 12: twice the stencil between them.
  if (const std::optional<Failure> failure = walkAround(walk, std::max(12, directions / 2), outline, slopes)) return *failure;
  while (true) {
    const Outcome<bool> known = joinHalfway(walk, sampler, surface, level, outline, slopes);
    if (!known) return known.failure();
    if (*known) break;
    if (2 * outline.reach.size() > kMostDirections) return unknownCurve();
  }
  const auto [least, most] = std::minmax_element(outline.reach.begin(), outline.reach.end());
  outline.least = *least, outline.most = *most;
  const int n = static_cast<int>(outline.reach.size());
  for (int i = 0; i < n; ++i) outline.pixels.push_back(summit.pixel + outline.reach[i] * walk.ray(angleOf(i, n)));
  return outline;
}
namespace {

bool hiddenOrDark(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& eye, bool mayBeHidden, const Light& light,
                  const Surface& surface) {
  if (mayBeHidden && anyOccluded(surface, points, eye)) return true;
  const double seen = (eye - points.front().position).norm();
  if (!light.atInfinity()) return anyOccluded(surface, points, occlusionTarget(surface, points.front().position, light, seen));
  // Rays to a light at infinity are parallel: each has its own target.
  return std::any_of(points.begin(), points.end(), [&](const SurfacePoint& p) {
    return surface.occluded(p, occlusionTarget(surface, p.position, light, seen));
  });
}

}  // namespace

Outcome<std::vector<PredictedHighlight>> starHighlights(const StarField& field, const Camera& camera, const Surface& surface,
                                                        const std::vector<Summit>& summits, double level,
                                                        const Settings& settings) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  const Eigen::AlignedBox2d window = seenWindow(camera);
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5);
  const bool mayBeHidden = PixelSampler(field.value, camera, surface).follows();
  const double margin = kMarginFraction * window.sizes().maxCoeff();
  bool cut = false;
  std::vector<StarOutline> outlines;
  std::vector<PredictedHighlight> highlights;
  for (const Summit& s : summits) {
    if (!((s.pixel - window.min() - half).minCoeff() >= 0) || !((window.max() - half - s.pixel).minCoeff() >= 0))
      return Failure{Reason::OutsideImage, "a maximum"};
    if (!(s.value < level)) continue;
    Outcome<StarOutline> outline = starAround(field, camera, surface, s, level, settings.integer("predict.directions"));
    if (!outline) return outline.failure();
    for (const Pixel& p : outline->pixels) {
      const double outside = std::max((window.min() - p).maxCoeff(), (p - window.max()).maxCoeff());
      if (outside >= margin) return Failure{Reason::OutsideImage, "the outline reaches beyond the margin"};
      cut = cut || outside > 0;
    }
    std::vector<SurfacePoint> lit = outline->points;
    lit.push_back(s.point);
    if (hiddenOrDark(lit, eye, mayBeHidden, field.light, surface)) return Failure{Reason::Occluded, "at an end of the star"};
    CanonicalContour ends;
    ends.directions.resize(outline->pixels.size());
    ends.pixels = outline->pixels;
    PredictedHighlight h;
    outlineOf(ends, h);
    if (const Outcome<Ellipse> e = fitEllipse(ends.pixels)) h.ellipse = *e;
    h.brightest = {
        s.point, s.pixel,
        incidentAngle(s.point.normal, field.light.directionFrom(s.point.position), (eye - s.point.position).normalized())};
    h.tangentPlane = Plane::through(s.point.position, s.point.normal);
    highlights.push_back(std::move(h));
    outlines.push_back(std::move(*outline));
  }
  if (outlines.empty()) return Failure{Reason::NotReached, "no maximum below the level"};
  for (std::size_t i = 0; i < outlines.size(); ++i)
    for (const PredictedHighlight& other : highlights)
      if (&other != &highlights[i] && outlines[i].relativeReach(other.brightest.pixel) < 1)
        return Failure{Reason::NotMonotonic, "the outline encloses another maximum"};
  const Eigen::Vector2d beyond = Eigen::Vector2d::Constant(cut ? margin : 0);
  if (const std::optional<Failure> other =
          somethingElseInside(field, camera, surface, outlines, level, window.min() - beyond, window.max() + beyond))
    return *other;
  std::stable_sort(highlights.begin(), highlights.end(), [](const PredictedHighlight& a, const PredictedHighlight& b) {
    return std::abs(signedArea(a.contour)) > std::abs(signedArea(b.contour));
  });
  return highlights;
}

namespace {

constexpr double kSamePeakPx = 0.05;  // as RadianceField::peaks

}  // namespace

Outcome<std::vector<PredictedHighlight>> radianceStars(const RadianceField& radiance, const ReflectanceFit& fit,
                                                       const Light& light, const std::vector<BrightestPoint>& mirrorPoints,
                                                       double faintest, const Camera& camera, const Surface& surface,
                                                       const Settings& settings) {
  const double rise = -std::log(fit.level);
  StarField field{[&](const SurfacePoint& at) {
                    // Above any floor, so that no shadow is asked for.
                    const std::optional<double> log = radiance.at(at, std::numeric_limits<double>::infinity());
                    return log ? -*log : std::nan("");
                  },
                  light, reachOf(fit.shape) * light.homogeneous().w(),
                  [&](const PartBounds& parts, double highest) {
                    return Eight(largestLogRadiance(fit.lobe, fit.roughness, parts) + float(highest));
                  }};
  std::vector<Summit> summits;
  for (const BrightestPoint& b : mirrorPoints) {
    const Outcome<Summit> s = summitNear(field, camera, surface, b, rise);
    if (!s) return s.failure();
    const auto same = [&](const Summit& other) { return (other.pixel - s->pixel).norm() < kSamePeakPx; };
    if (std::none_of(summits.begin(), summits.end(), same)) summits.push_back(*s);
  }
  const auto brightest =
      std::min_element(summits.begin(), summits.end(), [](const Summit& a, const Summit& b) { return a.value < b.value; });
  if (brightest == summits.end() || !(radiance.fallOfLobe(brightest->point) < faintest))
    return Failure{Reason::NoBrightestPoint, "the brightest point is far down the lobe"};
  return starHighlights(field, camera, surface, summits, brightest->value + rise, settings);
}

}  // namespace glint
