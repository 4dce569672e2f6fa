// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/clipped_flank.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/highlight/iso_contour.h"

namespace glint {
namespace {

constexpr std::array kFlankLevels{0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.22, 0.16, 0.12};  // of the clip height
constexpr std::size_t kLeastFlankLevels = 5;                                                   // of four unknowns
constexpr double kClipRank = 0.02;   // of the clipped pixels: the least values are those where one channel is only just clipped
constexpr double kClipNoise = 2;     // in standard deviations: nearer to the clip value noise is cut on one side
constexpr double kFlankNoise = 6;    // a level below this many deviations follows noise
constexpr double kMostDrift = 0.25;  // of the shorter semi-axis, of the centre between levels: more is no single lobe
constexpr double kMostRatioChange = 1.3;  // of the axes' ratio between levels
constexpr double kMostGrowth = 1.3;       // over v^-1, the area of the longest tail fitted: more is a neighbour that joins
constexpr double kAreaSigmaPx2 = 0.3;     // of a contour made of chords, measured on exact lobes of 5 to 60 px
constexpr double kUnusablePx = 1.5;       // a contour that near to an unusable pixel follows its border

// The profile and its uncertainty. The tests use lobes with other profiles.
constexpr std::array kTails{1.0, 1 / 1.5, 0.5,  1 / 3.0, 0.2,
                            0.1, 0.0,     -0.1, -0.2};  // 1/beta: from tails longer than GGX's to lobes that end
constexpr std::array kStarts{-2.5, -1.0, 0.3, 1.5};     // log(A0 / median area)
constexpr double kShapeSigma = 0.5;     // of log p, before the levels are looked at: lamps of any size, lobes of two parts
constexpr double kProfileSigma = 0.01;  // of log I at a level: real lobes follow no profile to better than that
constexpr double kPeakSigma = 0.02;     // of log K: the same at the top
constexpr double kReachSigma = 0.1;     // of log K, per unit of log(K / highest level)
constexpr int kMostSteps = 60;
constexpr double kFirstDamping = 1e-3, kLeastDamping = 1e-9, kMostDamping = 1e7;  // Levenberg-Marquardt, relative to the diagonal
constexpr double kDamped = 5;                                                     // factor from step to step
constexpr double kConverged = 1e-7;  // of the cost: log K then changes by far less than its sigma

// When a peak is trusted.
constexpr double kMostLogSigma = 0.2;  // a level known to a fifth; worse is no better than the clip value
constexpr double kMostShape = 2;       // p: flatter tops are a lamp's image in a mirror, whose height no wall shows
constexpr double kLeastGrown = 1.6;    // of the areas from the highest to the lowest level: a Gaussian clipped at a thirtieth
constexpr double kMostMisfit = 0.05;   // rms of log I: beyond it the flank is no lobe's
constexpr double kMostOutOfRound =
    0.08;  // median over levels: star bursts and mirrored lamps have 0.1 to 0.2 (psbox), lobes on bent surfaces below 0.05
constexpr int kRoundSamples = 72;         // along a contour: the rays of a star burst are wider than that
constexpr double kHighestContour = 0.95;  // of the clip height: the cells of a contour just below it touch clipped pixels

constexpr const char* kSteep = "the slope is steep, as around a lamp's image in a mirror, and does not show how high it rises";

using Unknowns = Eigen::Vector4d;  // log K, log A0, log p, offset of the background

struct ProfileFit {
  Unknowns x = Unknowns::Zero();
  double cost = std::numeric_limits<double>::infinity();
  double variance = 0;  ///< of log K
  double misfit = 0;
};

/// Levels, scaled to the strongest value and the median area.
struct Flank {
  std::vector<double> logValue, inverse, logArea, sigma;
  double backgroundSigma = 0;
};

/// Residuals and their derivatives: the levels, then the two priors. Returns the cost.
double evaluate(const Flank& s, double tail, const Unknowns& x, Eigen::Matrix4d* h, Unknowns* g, double* squares = nullptr) {
  const double p = std::exp(x[2]);
  double cost = 0;
  if (h) h->setZero(), g->setZero();
  if (squares) *squares = 0;
  for (std::size_t i = 0; i < s.logValue.size(); ++i) {
    const double place = std::min((s.logArea[i] - x[1]) * p, 300.0), u = std::exp(place);  // exp stays finite
    const double fall = tail != 0 ? -std::log1p(u * tail) / tail : -u, slope = -u / (1 + u * tail);
    const double off = s.logValue[i] - x[3] * s.inverse[i] - x[0] - fall, r = off / s.sigma[i];
    cost += r * r;
    if (squares) *squares += off * off;
    if (!h) continue;
    const Unknowns j = Unknowns(-1, slope * p, -slope * place, -s.inverse[i]) / s.sigma[i];
    *h += j * j.transpose();
    *g += j * r;
  }
  const double shape = x[2] / kShapeSigma, offset = x[3] / s.backgroundSigma;
  if (h) {
    (*h)(2, 2) += 1 / (kShapeSigma * kShapeSigma);
    (*h)(3, 3) += 1 / (s.backgroundSigma * s.backgroundSigma);
    (*g)[2] += shape / kShapeSigma;
    (*g)[3] += offset / s.backgroundSigma;
  }
  return cost + shape * shape + offset * offset;
}

/// Levenberg-Marquardt from several A0.
ProfileFit fitProfile(const Flank& s, double tail) {
  ProfileFit best;
  for (const double start : kStarts) {
    Unknowns x(0, start, 0, 0), g;
    Eigen::Matrix4d h;
    double cost = evaluate(s, tail, x, &h, &g), damping = kFirstDamping;
    for (int step = 0; step < kMostSteps && damping < kMostDamping; ++step) {
      Eigen::Matrix4d damped = h;
      damped.diagonal() *= 1 + damping;
      const Unknowns next = x - damped.ldlt().solve(g);
      const double now = next.allFinite() ? evaluate(s, tail, next, nullptr, nullptr) : cost;
      if (!(now < cost)) {
        damping *= kDamped;
        continue;
      }
      const bool done = cost - now < kConverged * (1 + cost);
      x = next;
      damping = std::max(damping / kDamped, kLeastDamping);
      cost = evaluate(s, tail, x, &h, &g);
      if (done) break;
    }
    if (!(cost < best.cost)) continue;
    const Eigen::Matrix4d covariance = h.ldlt().solve(Eigen::Matrix4d::Identity());
    if (!(covariance(0, 0) > 0) || !std::isfinite(covariance(0, 0))) continue;
    double squares = 0;
    evaluate(s, tail, x, nullptr, nullptr, &squares);
    best = {x, cost, covariance(0, 0), std::sqrt(squares / static_cast<double>(s.logValue.size()))};
  }
  return best;
}

bool usableSample(const FlankSample& s) {
  return s.value > 0 && s.areaPx2 > 0 && std::isfinite(s.value) && std::isfinite(s.areaPx2) && s.logSigma >= 0 &&
         std::isfinite(s.logSigma);
}

}  // namespace

double FlankPeak::areaAt(double v) const {
  if (!(v > 0) || !(v < value)) return 0;
  const double fall = std::log(value / v), u = tail != 0 ? std::expm1(fall * tail) / tail : fall;
  return areaPx2 * std::pow(u, 1 / shape);
}

double FlankPeak::fallAt(double area) const {
  const double u = std::pow(std::max(0.0, area) / areaPx2, shape);
  return tail != 0 ? std::pow(std::max(0.0, 1 + u * tail), -1 / tail) : std::exp(-u);
}

Outcome<FlankPeak> peakFromFlank(std::span<const FlankSample> given, double backgroundSigma) {
  if (!std::all_of(given.begin(), given.end(), usableSample) || !std::isfinite(backgroundSigma))
    return Failure{Reason::NotFinite, "a level's value or area is not positive and finite"};
  if (given.size() < kLeastFlankLevels)
    return Failure{Reason::TooFewPoints,
                   formatted("%zu levels of the slope can be traced, %zu are needed", given.size(), kLeastFlankLevels)};
  std::vector<FlankSample> samples(given.begin(), given.end());
  std::sort(samples.begin(), samples.end(), [](const FlankSample& a, const FlankSample& b) { return a.value > b.value; });
  const double top = samples.front().value, middle = samples[samples.size() / 2].areaPx2;
  if (!(samples.back().areaPx2 > samples.front().areaPx2))
    return Failure{Reason::NotConverged, "contours do not grow as the level falls"};
  if (samples.back().areaPx2 < kLeastGrown * samples.front().areaPx2) return Failure{Reason::NotConverged, kSteep};
  Flank s;
  s.backgroundSigma = std::max(backgroundSigma / top, 1e-6);  // 0: the background is known; the prior stays finite
  for (const FlankSample& q : samples) {
    s.logValue.push_back(std::log(q.value / top));
    s.inverse.push_back(top / q.value);
    s.logArea.push_back(std::log(q.areaPx2 / middle));
    s.sigma.push_back(std::hypot(q.logSigma, kProfileSigma));
  }
  std::vector<ProfileFit> fits;
  for (const double tail : kTails) fits.push_back(fitProfile(s, tail));
  const std::size_t best = static_cast<std::size_t>(
      std::min_element(fits.begin(), fits.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; }) - fits.begin());
  if (!std::isfinite(fits[best].cost)) return Failure{Reason::NotConverged, "no profile follows the slope"};
  // What the profiles leave beyond the noise widens everything by as much.
  const double excess = std::max(1.0, fits[best].cost / static_cast<double>(samples.size() - 4));
  double sum = 0, mean = 0, square = 0;
  for (const ProfileFit& f : fits) {
    const double weight = std::isfinite(f.cost) ? std::exp(-0.5 * (f.cost - fits[best].cost) / excess) : 0;
    if (!(weight > 0)) continue;
    sum += weight;
    mean += weight * f.x[0];
    square += weight * (f.x[0] * f.x[0] + f.variance * excess);
  }
  mean /= sum;
  const double variance = std::max(0.0, square / sum - mean * mean);
  FlankPeak peak;
  peak.value = top * std::exp(mean);
  peak.logSigma = std::sqrt(variance + std::pow(kPeakSigma, 2) + std::pow(kReachSigma * std::max(0.0, mean), 2));
  peak.areaPx2 = middle * std::exp(fits[best].x[1]);
  peak.shape = std::exp(fits[best].x[2]);
  peak.tail = kTails[best];
  peak.misfit = fits[best].misfit;
  if (!std::isfinite(peak.value) || !std::isfinite(peak.logSigma) || !std::isfinite(peak.areaPx2) || !std::isfinite(peak.shape))
    return Failure{Reason::NotConverged, kSteep};
  return peak;
}

namespace {

/// Clipped pixel that is farthest from all that is not.
Pixel deepestClipped(const FlankView& view) {
  cv::Mat saturated(view.corrected.height + 2, view.corrected.width + 2, CV_8U, cv::Scalar(0)), depth;
  for (int y = 0; y < view.corrected.height; ++y)
    for (int x = 0; x < view.corrected.width; ++x)
      if (view.saturated[static_cast<std::size_t>(y) * view.corrected.width + x]) saturated.at<unsigned char>(y + 1, x + 1) = 255;
  cv::distanceTransform(saturated, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::Point at;
  cv::minMaxLoc(depth, nullptr, nullptr, nullptr, &at);
  return Pixel(at.x - 1, at.y - 1);
}

/// Along a pixel that is not usable: the contour then follows the mask.
bool alongUnusable(const FlankView& view, const Polyline& line) {
  const int reach = static_cast<int>(std::ceil(kUnusablePx));
  for (const Pixel& q : line.points)
    for (int y = static_cast<int>(q.y()) - reach; y <= static_cast<int>(q.y()) + reach + 1; ++y)
      for (int x = static_cast<int>(q.x()) - reach; x <= static_cast<int>(q.x()) + reach + 1; ++x)
        if (x >= 0 && y >= 0 && x < view.corrected.width && y < view.corrected.height &&
            !view.usable[static_cast<std::size_t>(y) * view.corrected.width + x] && (Pixel(x, y) - q).norm() < kUnusablePx)
          return true;
  return false;
}

/// Why a level no longer belongs to the highlight; null = it does.
const char* notOfTheSame(const FlankLevel& now, const std::vector<FlankLevel>& above) {
  if (!now.ellipse) return "contours are no ellipses";
  if (above.empty()) return nullptr;
  const FlankLevel &first = above.front(), &last = above.back();
  if (!(now.areaPx2 > last.areaPx2)) return "contours do not grow as the level falls";
  // Near the top of a lobe areas grow fast; the logarithm of the area grows ever slower with the value's, down to the tail's.
  if (above.size() > 1) {
    const FlankLevel& before = above[above.size() - 2];
    const double expected = std::max(1.0, std::log(last.areaPx2 / before.areaPx2) / std::log(before.value / last.value));
    if (std::log(now.areaPx2 / last.areaPx2) > kMostGrowth * expected * std::log(last.value / now.value))
      return "the contour joins something else";
  }
  if ((now.ellipse->centre - first.ellipse->centre).norm() > kMostDrift * now.ellipse->semiAxes.y())
    return "contours do not lie around each other as those of one lobe do";
  const auto ratio = [](const Ellipse& e) { return e.semiAxes.x() / e.semiAxes.y(); };
  const double change = ratio(*now.ellipse) / ratio(*first.ellipse);
  if (std::max(change, 1 / change) > kMostRatioChange) return "the contour's shape changes from level to level";
  return nullptr;
}

/// Rms distance of a contour from its ellipse, as a share of the ellipse's radius in the same direction.
double outOfRound(const Polyline& line, const Ellipse& e) {
  double sum = 0;
  for (const Pixel& q : resample(line, kRoundSamples)) {
    const Pixel p = Eigen::Rotation2Dd(-e.angle) * (q - e.centre);
    sum += std::pow(p.cwiseQuotient(e.semiAxes).norm() - 1, 2);
  }
  return std::sqrt(sum / kRoundSamples);
}

double medianOutOfRound(const std::vector<FlankLevel>& levels) {
  std::vector<double> all;
  for (const FlankLevel& level : levels) all.push_back(level.outOfRound);
  return upperMedian(all);
}

/// The contour at a value around a pixel; empty, with the reason why levels end here, if there is no contour.
std::optional<FlankLevel> levelAround(const FlankView& view, const Pixel& inside, double value, const char*& reason) {
  for (const IsoContour& c : isoContours(view.corrected, value)) {
    if (signedArea(c.line) < view.minAreaPx2 || !contains(c.line, inside)) continue;
    if (c.touchesBorder) {
      reason = "the slope runs out of the view";
      return std::nullopt;
    }
    if (alongUnusable(view, c.line)) {
      reason = "the slope touches pixels that are masked or not usable";
      return std::nullopt;
    }
    FlankLevel level;
    level.value = value;
    level.contour = withoutStreaks(c.line).line;
    level.areaPx2 = signedArea(level.contour);
    if (const Outcome<Ellipse> e = fitEllipse(level.contour.points)) level.ellipse = *e;
    if (level.ellipse) level.outOfRound = outOfRound(level.contour, *level.ellipse);
    return level;
  }
  reason = "there is no contour around the core";
  return std::nullopt;
}

std::vector<FlankSample> samplesOf(const ClippedFlank& flank, double noise) {
  std::vector<FlankSample> samples;
  for (std::size_t i = 0; i < flank.levels.size(); ++i) {
    const FlankLevel& level = flank.levels[i];
    const FlankLevel& other = flank.levels[i > 0 ? i - 1 : std::min<std::size_t>(1, flank.levels.size() - 1)];
    const double grown = std::abs(level.areaPx2 - other.areaPx2), fallen = std::abs(std::log(level.value / other.value));
    // Noise of a pixel is averaged along the contour; an error of the area counts by the slope of log I over it.
    const double byNoise = noise / level.value / std::sqrt(std::max(1.0, length(level.contour)));
    samples.push_back({level.value, level.areaPx2, std::hypot(byNoise, grown > 0 ? kAreaSigmaPx2 * fallen / grown : 0)});
  }
  return samples;
}

}  // namespace

ClippedFlank traceFlank(const FlankView& view) {
  const std::size_t pixels = view.corrected.data.size();
  require(view.corrected.channels == 1 && view.usable.size() == pixels && view.saturated.size() == pixels,
          "traceFlank: one channel and maps of its size");
  ClippedFlank flank;
  flank.backgroundSigma = view.backgroundSigma;
  std::vector<float> clipped;
  for (std::size_t i = 0; i < pixels; ++i)
    if (view.saturated[i]) clipped.push_back(view.corrected.data[i]);
  if (clipped.empty()) {
    flank.reason = "no pixel is clipped";
    return flank;
  }
  flank.clipHeight = ranked(clipped, static_cast<std::size_t>(kClipRank * static_cast<double>(clipped.size())));
  const Pixel inside = deepestClipped(view);
  const char* ended = "the slope sinks into the noise";
  for (const double share : kFlankLevels) {
    const double value = share * flank.clipHeight;
    if (!(value > 0) || value > flank.clipHeight - kClipNoise * view.noise) continue;
    if (value < kFlankNoise * view.noise) break;
    std::optional<FlankLevel> level = levelAround(view, inside, value, ended);
    if (!level) break;
    if (const char* const stranger = notOfTheSame(*level, flank.levels)) {
      ended = stranger;
      break;
    }
    flank.levels.push_back(*std::move(level));
  }
  const Outcome<FlankPeak> peak = peakFromFlank(samplesOf(flank, view.noise), view.backgroundSigma);
  if (!peak) {
    flank.reason = peak.failure().detail + (flank.levels.size() < kLeastFlankLevels ? std::string(": ") + ended : "");
    return flank;
  }
  flank.peak = *peak;
  if (!(peak->value > flank.clipHeight))
    flank.reason = "the profile's peak is not above the clip value";
  else if (peak->shape > kMostShape)
    flank.reason = kSteep;
  else if (peak->misfit > kMostMisfit)
    flank.reason = formatted("the slope is not that of a lobe: it leaves the profile by %.0f %%", 100 * peak->misfit);
  else if (const double ragged = medianOutOfRound(flank.levels); ragged > kMostOutOfRound)
    flank.reason = formatted(
        "the slope is not that of a lobe: its contours leave their ellipses by %.0f %%, as those of a star burst", 100 * ragged);
  else if (peak->logSigma > kMostLogSigma)
    flank.reason = formatted("the peak is known to %.0f %% only", 100 * peak->logSigma);
  else
    flank.trusted = true;
  return flank;
}

bool reachesLevel(const ClippedFlank& flank, double level) {
  return flank.trusted && level * flank.peak->value < kHighestContour * flank.clipHeight;
}

void noteContour(ClippedFlank& flank, double level, double reference, const Polyline& contour) {
  constexpr double kSamePeak = 1 - 1e-9;  // round-off
  flank.levelAsked = level;
  flank.contourValue = level * reference;
  flank.outsideCore = reachesLevel(flank, level) && flank.contourValue < kHighestContour * flank.clipHeight &&
                      reference >= kSamePeak * flank.peak->value;
  flank.sigmaPx = 0;
  const double round = length(contour), area = std::abs(signedArea(contour));
  if (!(round > 0) || !(area > 0)) return;
  if (!flank.peak || !flank.trusted) {
    flank.sigmaPx = std::sqrt(area / M_PI / 3);  // of anything between none and the whole radius, equally likely
    return;
  }
  // A background that is too high lowers the peak, too: the two add up.
  const double wanted = level * std::max(reference, flank.peak->value);
  const double off = flank.peak->logSigma + (1 - level) * flank.backgroundSigma / flank.contourValue;
  const double lower = flank.peak->areaAt(wanted * std::exp(-off)), higher = flank.peak->areaAt(wanted * std::exp(off));
  flank.sigmaPx = (lower - higher) / (2 * round);
  if (!flank.outsideCore) {
    const double shrunk = std::clamp(flank.peak->areaAt(wanted) / flank.peak->areaAt(flank.contourValue), 0.0, 1.0);
    flank.sigmaPx += area * (1 - shrunk) / (round * (1 + std::sqrt(shrunk)) / 2);  // between similar lines: area over mean length
  }
}

std::string inWords(const ClippedFlank& flank) {
  if (!flank.peak)
    return formatted("the peak cannot be told (%s): contour at %g of the clip value, too large by an unknown part of its radius",
                     flank.reason.c_str(), flank.levelAsked);
  const double times = flank.peak->value / flank.clipHeight, pct = 100 * flank.peak->logSigma;
  const std::string peak = formatted("peak about %.2g times the clip value (+-%.0f %%), from %zu levels of the slope", times, pct,
                                     flank.levels.size());
  if (flank.outsideCore)
    return peak + formatted(": contour at %g of it, outside of the core (+-%.2g px)", flank.levelAsked, flank.sigmaPx);
  const double own = flank.contourValue / flank.peak->value;
  if (!flank.trusted)
    return peak + formatted("; not relied on (%s): contour at %g of the clip value, too large by an unknown part of its radius",
                            flank.reason.c_str(), flank.levelAsked);
  return peak + formatted(": level %g lies inside the clipped core, the contour at about %.2g, too large by %.2g px or less",
                          flank.levelAsked, own, flank.sigmaPx);
}

}  // namespace glint
