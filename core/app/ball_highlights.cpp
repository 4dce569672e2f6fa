// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/ball_highlights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/base/image.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/geometry/polyline.h"
#include "core/highlight/iso_contour.h"

namespace glint {
namespace {

constexpr double kSmoothPx = 0.7;     // closes the holes that a JPEG leaves in a clipped core; a tenth of the cores' radius
constexpr double kLeastTop = 32;      // of 255: below it the codes are too coarse for five levels
constexpr double kStandsOut = 5;      // in linear light over what 95 % of the ball stay below
constexpr double kClippedCode = 250;  // of 255: what a JPEG makes of white
constexpr double kBright = 0.9;       // of the top, in codes: 0.79 of the light
constexpr double kDim = 0.6;          // of the top, in codes: a third of the light; worth naming
constexpr int kLeastArea = 4;         // px: less is a speck
constexpr double kRival = 0.7;        // of the largest disc's radius: half of its area; then which is the lamp is not known
constexpr double kLeastRival = 0.2;   // of that radius: less is a scratch or dust in the lamp's light
constexpr double kWidest = 0.2;       // of the ball's radius: a lamp of 23 degrees
constexpr double kLimb = 0.97;        // of the outline's radius: a pixel counts four times as much as in the middle
constexpr double kOtherBallMargin =
    0.03;  // of the radius: outlines, perspective and another depth move the other ball's reflection
constexpr double kOtherBallReach = 1.5;  // in its own radii, for the same reasons
constexpr double kFineRadius = 12;       // px: finer sampling until the disc has that radius
constexpr int kFinest = 8;               // times
constexpr double kCoreShare = 0.4;       // of the disc's radius: places that are nearly as deep inside count in part
constexpr std::array kLevels{0.90, 0.92, 0.94, 0.96,
                             0.98};  // of the top, in codes: above the streaks, below what a JPEG makes of white
constexpr std::array kLevelsBelow{0.70, 0.75, 0.80, 0.85, 0.90};  // where the top is not clipped: the last tenth is noise
constexpr double kShapeShare =
    0.15;  // of the core's own spread: between the balls of psbox the peaks differ by this where levels agree
constexpr double kLeastPeakSigmaPx = 0.05;
constexpr int kCropMargin = 8;  // px around a core

constexpr std::size_t kInOneOf = 4;  // photographs a still reflection may be missing: hidden, or under a shadow
constexpr int kStillMargin = 2;      // px around a still reflection: what smoothing and a JPEG make of its edge

/// Something bright: its deepest place inside, and how deep that is.
struct Candidate {
  int label = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< px of the crop
  double radius = 0;
  cv::Rect box;
  cv::Point pixel;  ///< one of its own
};

/// The ball's part of a photograph: the least channel, smoothed; 0 outside of the ball.
struct BallView {
  cv::Mat values;
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< of its first pixel in the shot
  BallOutline ball;                                  ///< in the shot
  double top = 0, usual = 0;                         ///< codes: the largest; what 95 % stay below
};

/// Middle and radius of the largest disc inside of a mask.
struct Core {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< px of the crop
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  double radius = 0;
};

double lightOfCode(double code) { return linearFromSrgb(std::clamp(code / 255, 0.0, 1.0)); }

BallView lookAt(const Image& photograph, const Eigen::Vector2d& corner, const BallOutline& ball,
                const StillReflections& still = {}) {
  const Eigen::Vector2d centre = ball.centre - corner;
  const auto within = [](double v, int size) { return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(size))); };
  const int x0 = within(std::floor(centre.x() - ball.radius), photograph.width),
            x1 = within(std::ceil(centre.x() + ball.radius) + 1, photograph.width);
  const int y0 = within(std::floor(centre.y() - ball.radius), photograph.height),
            y1 = within(std::ceil(centre.y() + ball.radius) + 1, photograph.height);
  BallView view{cv::Mat(), corner + Eigen::Vector2d(x0, y0), ball};
  if (x1 - x0 < 3 || y1 - y0 < 3) return view;
  cv::Mat least(y1 - y0, x1 - x0, CV_32F), smooth;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      float v = photograph.at(x, y);
      for (int c = 1; c < photograph.channels; ++c) v = std::min(v, photograph.at(x, y, c));
      least.at<float>(y - y0, x - x0) = v;
    }
  cv::GaussianBlur(least, smooth, {}, kSmoothPx);
  std::vector<float> inside;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      float& v = smooth.at<float>(y - y0, x - x0);
      if ((Eigen::Vector2d(x, y) - centre).norm() < ball.radius && !still.cover(Eigen::Vector2d(x, y) + corner))
        inside.push_back(v);
      else
        v = 0;
    }
  if (inside.empty()) return view;
  view.values = smooth;
  view.usual = ranked(inside, inside.size() * 95 / 100);
  view.top = *std::max_element(inside.begin(), inside.end());
  return view;
}

/// Connected parts of { value >= level }, holes filled; 0 elsewhere.
cv::Mat brightParts(const cv::Mat& values, double level, int& count) {
  cv::Mat mask = values >= level, labels;
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(mask, outlines, -1, cv::Scalar(255), cv::FILLED);
  count = cv::connectedComponents(mask, labels, 8);
  return labels;
}

/// The largest disc inside of a mask, whose border has a zero pixel around; weights fall linearly to the share of the depth.
Core largestDisc(const cv::Mat& mask) {
  cv::Mat depth;
  cv::distanceTransform(mask, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  double deepest = 0;
  cv::minMaxLoc(depth, nullptr, &deepest);
  Core core;
  core.radius = deepest;
  double sum = 0;
  for (int pass = 0; pass < 2; ++pass) {
    if (pass == 1) core.centre /= sum;
    for (int y = 0; y < depth.rows; ++y)
      for (int x = 0; x < depth.cols; ++x) {
        const double w = depth.at<float>(y, x) - (1 - kCoreShare) * deepest;
        if (w <= 0) continue;
        const Eigen::Vector2d p(x, y);
        if (pass == 0) sum += w, core.centre += w * p;
        if (pass == 1) core.spread += w / sum * (p - core.centre) * (p - core.centre).transpose();
      }
  }
  return core;
}

cv::Rect cropAround(const BallView& view, const Candidate& candidate) {
  const cv::Rect& box = candidate.box;
  const cv::Rect wide(box.x - kCropMargin, box.y - kCropMargin, box.width + 2 * kCropMargin, box.height + 2 * kCropMargin);
  return wide & cv::Rect(0, 0, view.values.cols, view.values.rows);
}

/// The disc of the part of { value >= level } around `place`, sampled finely enough. Radius 0: no such part.
Core discAt(const BallView& view, const Candidate& candidate, double level) {
  const cv::Rect crop = cropAround(view, candidate);
  const int times = std::clamp(static_cast<int>(std::ceil(kFineRadius / std::max(candidate.radius, 1.0))), 1, kFinest);
  cv::Mat fine;
  cv::resize(view.values(crop), fine, {}, times, times, cv::INTER_LINEAR);
  cv::copyMakeBorder(fine, fine, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  int count = 0;
  const cv::Mat labels = brightParts(fine, level, count);
  const auto toFine = [&](double v, int first) { return static_cast<int>(std::lround((v - first + 0.5) * times - 0.5)) + 1; };
  const int x = std::clamp(toFine(candidate.place.x(), crop.x), 0, labels.cols - 1),
            y = std::clamp(toFine(candidate.place.y(), crop.y), 0, labels.rows - 1);
  if (labels.at<int>(y, x) == 0) return {};
  Core core = largestDisc(labels == labels.at<int>(y, x));
  core.centre = Eigen::Vector2d(crop.x, crop.y) +
                ((core.centre - Eigen::Vector2d(1, 1) + Eigen::Vector2d(0.5, 0.5)) / times - Eigen::Vector2d(0.5, 0.5));
  core.spread /= times * times;
  core.radius /= times;
  return core;
}

/// Everything that reaches `level`, with the largest disc of each, largest first.
std::vector<Candidate> candidates(const BallView& view, double level, const cv::Mat& labels, int count) {
  cv::Mat padded, depth;
  cv::copyMakeBorder(labels > 0, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::distanceTransform(padded, depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  std::vector<Candidate> found(static_cast<std::size_t>(count));
  std::vector<int> area(static_cast<std::size_t>(count), 0);
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      const int label = labels.at<int>(y, x);
      if (label == 0) continue;
      Candidate& c = found[static_cast<std::size_t>(label)];
      ++area[static_cast<std::size_t>(label)];
      c.label = label;
      c.pixel = {x, y};
      c.box |= cv::Rect(x, y, 1, 1);
      const double d = depth.at<float>(y + 1, x + 1);
      if (d > c.radius) c.radius = d, c.place = {x, y};
    }
  std::erase_if(found, [&](const Candidate& c) { return c.label == 0 || area[static_cast<std::size_t>(c.label)] < kLeastArea; });
  for (Candidate& c : found) {
    const Core core = discAt(view, c, level);
    if (core.radius > 0) c.place = core.centre, c.radius = core.radius;
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.radius > b.radius; });
  return found;
}

/// Whether a place on a ball shows another one, for a distant camera and equal depths. In radii, D away, the other's centre
/// is reflected at s from the ball's: D (1 - 2 s^2) + s = 0, s = (1 + sqrt(1 + 8 D^2)) / (4 D); half as large as its angle, times
/// cos.
bool showsAnotherBall(const Eigen::Vector2d& place, std::span<const BallOutline> balls, std::size_t which) {
  const BallOutline& own = balls[which];
  for (std::size_t j = 0; j < balls.size(); ++j) {
    const Eigen::Vector2d apart = balls[j].centre - own.centre;
    const double distance = apart.norm() / own.radius;
    if (j == which || distance < 1 + balls[j].radius / own.radius) continue;
    const double s = (1 + std::sqrt(1 + 8 * distance * distance)) / (4 * distance);
    const double reach = kOtherBallReach * 0.5 * balls[j].radius / own.radius / distance + kOtherBallMargin;
    const Eigen::Vector2d middle = own.centre + s * own.radius * apart.normalized();
    if ((place - middle).norm() < reach * own.radius) return true;
  }
  return false;
}

bool atLimb(const Eigen::Vector2d& place, const BallOutline& ball) { return (place - ball.centre).norm() > kLimb * ball.radius; }

std::string placeText(const Eigen::Vector2d& p) { return formatted("%.1f, %.1f", p.x(), p.y()); }

/// The contour around a place at a level, in the shot; empty without one.
std::vector<Eigen::Vector2d> contourAround(const BallView& view, const Candidate& candidate, double level) {
  const cv::Rect crop = cropAround(view, candidate);
  Image image(crop.width, crop.height, 1);
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x) image.at(x, y) = view.values.at<float>(crop.y + y, crop.x + x);
  const Eigen::Vector2d first(crop.x, crop.y), inside = candidate.place - first;
  for (const IsoContour& c : isoContours(image, level)) {
    if (signedArea(c.line) <= 0 || !contains(c.line, inside)) continue;
    std::vector<Eigen::Vector2d> result;
    for (const Pixel& p : c.line.points) result.push_back(p + first + view.corner);
    return result;
  }
  return {};
}

/// Peak, covariance and contour from the levels.
LampObservation measurePeak(const BallView& view, const Candidate& lamp, bool clipped) {
  LampObservation result;
  result.clipped = clipped;
  const auto& levels = clipped ? kLevels : kLevelsBelow;
  std::vector<Core> cores;
  for (const double level : levels)
    if (const Core core = discAt(view, lamp, level * view.top); core.radius > 0) cores.push_back(core);
  const double n = static_cast<double>(cores.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Core& c : cores) mean += c.centre / n, spread += c.spread / n;
  for (const Core& c : cores)  // not divided by n once more: levels of one photograph share its streaks and its noise
    result.covariance += (c.centre - mean) * (c.centre - mean).transpose() / std::max(1.0, n - 1);
  result.covariance += kShapeShare * kShapeShare * spread + kLeastPeakSigmaPx * kLeastPeakSigmaPx * Eigen::Matrix2d::Identity();
  result.peak = mean + view.corner;
  result.contour = contourAround(view, lamp, levels[levels.size() / 2] * view.top);
  return result;
}

/// Why the largest candidate is not the lamp's reflection, or not surely; nothing if it is.
std::optional<Failure> objection(const BallView& view, const std::vector<Candidate>& bright, std::span<const BallOutline> balls,
                                 std::size_t which, const Image& photograph, const Eigen::Vector2d& corner) {
  const Candidate& lamp = bright[0];
  const Eigen::Vector2d place = lamp.place + view.corner;
  if (lamp.radius > kWidest * view.ball.radius)
    return Failure{view.top >= kClippedCode ? Reason::Clipped : Reason::NoHighlight,
                   "a fifth of the ball is as bright as its brightest place: no single place of a lamp"};
  if (atLimb(place, view.ball))
    return Failure{Reason::NoHighlight, "the largest highlight, at " + placeText(place) + ", lies at the ball's outline"};
  if (showsAnotherBall(place, balls, which))
    return Failure{Reason::NoHighlight,
                   "the largest highlight, at " + placeText(place) + ", lies where another ball is reflected"};
  const Eigen::Vector2d first = view.corner - corner + Eigen::Vector2d(lamp.box.x, lamp.box.y);
  if (first.x() < 1 || first.y() < 1 || first.x() + lamp.box.width >= photograph.width ||
      first.y() + lamp.box.height >= photograph.height)
    return Failure{Reason::OutsideImage, "the photograph's border cuts the highlight at " + placeText(place)};
  for (const Candidate& other : bright) {
    const Eigen::Vector2d there = other.place + view.corner;
    if (&other == &lamp || showsAnotherBall(there, balls, which) || atLimb(there, view.ball)) continue;
    if (other.radius > kRival * lamp.radius)
      return Failure{Reason::NoHighlight, "two highlights of about the same size, at " + placeText(place) + " and " +
                                              placeText(there) + ": which is the lamp's is not known"};
  }
  return std::nullopt;
}

/// Everything else that is bright, with the reason against it.
std::vector<DroppedHighlight> droppedHighlights(const BallView& view, const std::vector<Candidate>& bright,
                                                std::span<const BallOutline> balls, std::size_t which) {
  constexpr const char* kSmaller = "smaller than the lamp's";
  int count = 0;
  const cv::Mat labels = brightParts(view.values, kDim * view.top, count);
  const auto labelOf = [&](const Candidate& c) { return labels.at<int>(c.pixel); };
  std::vector<DroppedHighlight> result;
  const auto drop = [&](const Candidate& c, const char* reason) {
    const Eigen::Vector2d place = c.place + view.corner;
    if (atLimb(place, view.ball)) reason = "at the ball's outline";
    if (showsAnotherBall(place, balls, which)) reason = "reflection of another ball";
    result.push_back({place, reason, std::string_view(reason) == kSmaller && c.radius > kLeastRival * bright[0].radius});
  };
  for (std::size_t i = 1; i < bright.size(); ++i)
    drop(bright[i], labelOf(bright[i]) == labelOf(bright[0]) ? "streak of the lamp's reflection" : kSmaller);
  for (const Candidate& dim : candidates(view, kDim * view.top, labels, count))
    if (std::none_of(bright.begin(), bright.end(), [&](const Candidate& c) { return labelOf(c) == dim.label; }))
      drop(dim, "dimmer than the lamp's");
  return result;
}

/// Whether a part of what is bright reaches a reflection that stays.
bool touches(const BallView& view, const cv::Mat& labels, const Candidate& lamp, const StillReflections& still) {
  if (still.mask.empty()) return false;
  for (int y = lamp.box.y; y < lamp.box.y + lamp.box.height; ++y)
    for (int x = lamp.box.x; x < lamp.box.x + lamp.box.width; ++x)
      for (int side = 0; labels.at<int>(y, x) == lamp.label && side < 4; ++side)
        if (still.cover(view.corner + Eigen::Vector2d(x + (side == 0) - (side == 1), y + (side == 2) - (side == 3)))) return true;
  return false;
}

}  // namespace

bool StillReflections::cover(const Eigen::Vector2d& place) const {
  const int x = static_cast<int>(std::lround(place.x() - corner.x())), y = static_cast<int>(std::lround(place.y() - corner.y()));
  return x >= 0 && y >= 0 && x < mask.width && y < mask.height && mask.at(x, y) > 0;
}

StillReflections stillReflections(std::span<const Image> photographs, const Eigen::Vector2d& corner, const BallOutline& ball) {
  StillReflections result;
  std::vector<BallView> views;
  std::vector<double> tops;
  for (const Image& p : photographs) {
    if (std::any_of(p.data.begin(), p.data.end(), [](float v) { return !std::isfinite(v); })) continue;
    if (BallView view = lookAt(p, corner, ball); !view.values.empty()) tops.push_back(view.top), views.push_back(std::move(view));
  }
  if (views.size() < 2) return result;
  cv::Mat stays(views[0].values.size(), CV_32F);  // what three of four photographs are at least as bright as
  std::vector<float> here(views.size()), inside;
  for (int y = 0; y < stays.rows; ++y)
    for (int x = 0; x < stays.cols; ++x) {
      std::transform(views.begin(), views.end(), here.begin(), [&](const BallView& v) { return v.values.at<float>(y, x); });
      stays.at<float>(y, x) = ranked(here, here.size() / kInOneOf);
      if (stays.at<float>(y, x) > 0) inside.push_back(stays.at<float>(y, x));
    }
  if (inside.empty()) return result;
  const double usual = lightOfCode(ranked(inside, inside.size() * 3 / 4)), core = std::max(kLeastTop, kDim * upperMedian(tops));
  cv::Mat out(stays.size(), CV_8U), labels, places, boxes;
  for (int y = 0; y < stays.rows; ++y)
    for (int x = 0; x < stays.cols; ++x)
      out.at<unsigned char>(y, x) = lightOfCode(stays.at<float>(y, x)) >= kStandsOut * usual ? 255 : 0;
  const int count = cv::connectedComponentsWithStats(out, labels, boxes, places, 8);
  cv::Mat mask = cv::Mat::zeros(stays.size(), CV_8U);
  for (int k = 1; k < count; ++k) {
    double brightest = 0;
    cv::minMaxLoc(stays, nullptr, &brightest, nullptr, nullptr, labels == k);
    if (brightest < core || boxes.at<int>(k, cv::CC_STAT_AREA) < kLeastArea) continue;
    mask.setTo(255, labels == k);
    result.places.push_back(views[0].corner + Eigen::Vector2d(places.at<double>(k, 0), places.at<double>(k, 1)));
  }
  if (result.places.empty()) return result;
  cv::dilate(mask, mask, {}, {-1, -1}, kStillMargin);
  result.corner = views[0].corner;
  result.mask = Image(mask.cols, mask.rows, 1);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) result.mask.at(x, y) = mask.at<unsigned char>(y, x);
  return result;
}

Outcome<LampObservation> findLampHighlight(const Image& photograph, const Eigen::Vector2d& corner,
                                           std::span<const BallOutline> balls, std::size_t which, const StillReflections& still) {
  require(!photograph.empty() && (photograph.channels == 1 || photograph.channels == 3) && which < balls.size(),
          "findLampHighlight: a photograph with 1 or 3 channels, and one of the balls");
  for (const BallOutline& b : balls)
    require(b.centre.allFinite() && b.radius > 0 && std::isfinite(b.radius), "findLampHighlight: outlines with a radius above 0");
  for (const float v : photograph.data)
    if (!std::isfinite(v)) return Failure{Reason::NotFinite, "a pixel of the photograph"};
  const BallView view = lookAt(photograph, corner, balls[which], still);
  if (view.values.empty()) return Failure{Reason::OutsideImage, "the ball lies outside of its photograph"};
  if (view.top < kLeastTop || lightOfCode(view.top) < kStandsOut * lightOfCode(view.usual))
    return Failure{Reason::NoHighlight, "nothing on the ball stands out from the rest"};
  int count = 0;
  const cv::Mat labels = brightParts(view.values, kBright * view.top, count);
  const std::vector<Candidate> bright = candidates(view, kBright * view.top, labels, count);
  if (bright.empty()) return Failure{Reason::NoHighlight, "what stands out on the ball is smaller than four pixels"};
  if (touches(view, labels, bright[0], still))
    return Failure{Reason::NoHighlight, "the largest highlight, at " + placeText(bright[0].place + view.corner) +
                                            ", touches a reflection that does not move between photographs"};
  if (const auto why = objection(view, bright, balls, which, photograph, corner)) return *why;
  LampObservation result = measurePeak(view, bright[0], view.top >= kClippedCode);
  if (!result.peak.allFinite() || !result.covariance.allFinite()) return Failure{Reason::NotFinite, "the highlight's place"};
  result.object = which;
  result.dropped = droppedHighlights(view, bright, balls, which);
  for (const Eigen::Vector2d& place : still.places) result.dropped.push_back({place, "does not move between photographs"});
  return result;
}

}  // namespace glint
