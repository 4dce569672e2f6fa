// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/highlight/background.h"
#include "core/highlight/clipped_flank.h"
#include "core/highlight/frame_blur.h"
#include "core/light/estimate.h"
#include "core/pipeline/evidence.h"

namespace glint {

namespace {

constexpr int kContourSamples = 72;        // of a contour: as many as elsewhere
constexpr double kOutwardPx = 2;           // beyond the contour: no surface there means that it runs along the silhouette
constexpr double kSilhouetteShare = 0.05;  // of the contour: less is a touch of a few pixels
constexpr double kMostOff = 0.5;           // of the contour: then the highlight lies beside the surface
constexpr double kTenth = 0.1;             // of the level: the change that a clipped contour is tried with
constexpr double kSameLampDeg = 5;  // two mirrored rays of one lamp: peaks of clipped highlights are off by that on a small ball
constexpr double kWorthCutPx2 = 1;  // less is a corner
constexpr double kWorthBlurShare = 0.01;  // of the radius: less blur moves the contour by less than detection does
constexpr double kWorthBlurPx = 0.3;

double bilinearAt(const Image& v, const Pixel& p) {
  const double u = std::clamp(p.x(), 0.0, v.width - 1.001), w = std::clamp(p.y(), 0.0, v.height - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(w);
  const double a = u - x, b = w - y;
  return (1 - b) * ((1 - a) * v.at(x, y) + a * v.at(x + 1, y)) + b * ((1 - a) * v.at(x, y + 1) + a * v.at(x + 1, y + 1));
}

double slopeAt(const Image& v, const Pixel& p) {
  return Eigen::Vector2d(bilinearAt(v, p + Pixel(1, 0)) - bilinearAt(v, p - Pixel(1, 0)),
                         bilinearAt(v, p + Pixel(0, 1)) - bilinearAt(v, p - Pixel(0, 1)))
             .norm() /
         2;
}

/// The highlight as an ellipse in measured pixels.
std::optional<Footprint> footprintOnImage(const Highlight& h, const Camera& camera) {
  if (!h.ellipse) return std::nullopt;
  Footprint footprint;
  footprint.centre = camera.distorted(h.ellipse->centre);
  footprint.level = h.level;
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(h.ellipse->angle).toRotationMatrix();
  footprint.shape = axes * h.ellipse->semiAxes.cwiseAbs2().asDiagonal() * axes.transpose();
  if (!footprint.centre.allFinite()) return std::nullopt;
  return footprint;
}

/// How much smaller the contour of a Gaussian lobe would be without the blur: r^2 = 2 ln(1/q) (variance of the lobe + variance of
/// the blur). No edge moves by more than the blur itself.
double widenedBy(const FrameBlur& blur, const Ellipse& e, double level) {
  double most = 0;
  for (int axis = 0; axis < 2; ++axis) {
    const double r = e.semiAxes[axis], variance = blur.varianceAlong(e.angle + axis * M_PI / 2);
    const double sharp = std::sqrt(std::max(0.0, r * r + 2 * std::log(level) * variance));
    most = std::max(most, std::min(r - sharp, std::sqrt(variance)));
  }
  return most;
}

void measureContour(const Highlight& h, const Frame& frame, const LinearPixels& pixels, double noise, HighlightQuality& q) {
  const std::optional<Footprint> footprint = footprintOnImage(h, frame.camera);
  Background background;
  if (footprint) background = fitBackground(pixels.value, pixels.usable, *footprint, 0);
  std::vector<double> byNoise, byLevel;
  for (const Pixel& ideal : resample(h.contour, kContourSamples)) {
    const Pixel p = frame.camera.distorted(ideal);
    if (!p.allFinite()) continue;
    const double slope = slopeAt(pixels.value, p);
    if (!(slope > 0)) continue;
    byNoise.push_back(noise / slope);
    byLevel.push_back(kTenth * std::abs(bilinearAt(pixels.value, p) - background.at(p.x(), p.y())) / slope);
  }
  if (byNoise.empty()) return;
  q.noisePx = upperMedian(byNoise);
  if (h.clipped) q.levelPx = h.flank ? h.flank->sigmaPx : upperMedian(byLevel);
  if (footprint && !h.clipped)
    q.backgroundPx = backgroundUncertaintyPct(pixels.value, pixels.usable, *footprint, h.peakValue) / 100 *
                     std::sqrt(4 / M_PI * std::max(0.0, h.areaPx2));
}

void lookAtSilhouette(const Highlight& h, const Camera& camera, const Surface& surface, HighlightQuality& q) {
  const Pixel middle = centroid(h.contour);
  int beside = 0, off = 0;
  for (const Pixel& p : resample(h.contour, kContourSamples)) {
    const Pixel outwards = (p - middle).normalized();
    if (!outwards.allFinite()) continue;
    off += !surface.firstHit(camera.ray(p));
    beside += !surface.firstHit(camera.ray(p + kOutwardPx * outwards));
  }
  q.silhouetteShare = static_cast<double>(beside) / kContourSamples;
  if (off > kMostOff * kContourSamples)
    q.flags.emplace_back("off the surface");
  else if (q.silhouetteShare > kSilhouetteShare)
    q.flags.push_back(formatted("at the silhouette: %.0f %% of the contour", 100 * q.silhouetteShare));
}

/// By how much two mirrored rays miss a common lamp, rad: seen from the nearer of the two places, or halfway where they diverge.
double disagreement(const ReflectedRay& a, const ReflectedRay& b) {
  const double apart = std::atan2(a.direction.cross(b.direction).norm(), a.direction.dot(b.direction));
  const Eigen::Vector3d between = b.origin - a.origin;
  Eigen::Matrix<double, 3, 2> directions;
  directions << a.direction, -b.direction;
  const Eigen::Vector2d t = directions.colPivHouseholderQr().solve(between);
  if (!t.allFinite() || !(t.minCoeff() > 0)) return apart;
  const double miss = (a.origin + t[0] * a.direction - b.origin - t[1] * b.direction).norm();
  return std::min(apart, std::atan2(miss, t.minCoeff()));
}

}  // namespace

std::vector<HighlightQuality> highlightQualities(const Frame& frame, const LinearPixels& pixels, const Surface* surface,
                                                 const std::optional<FrameBlur>& blur, const std::vector<Highlight>& highlights) {
  const double noise = pixelNoise(pixels.value, pixels.usable);
  std::vector<HighlightQuality> qualities(highlights.size());
  if (pixels.value.width < 3 || pixels.value.height < 3) return qualities;
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    const Highlight& h = highlights[i];
    HighlightQuality& q = qualities[i];
    if (h.contour.points.size() < 3) continue;
    if (h.clipped) q.flags.push_back(h.flank ? "clipped core: " + inWords(*h.flank) : "clipped core");
    if (h.cutPx2 > kWorthCutPx2) q.flags.push_back(formatted("streaks cut off: %.0f px2", h.cutPx2));
    if (h.touchesBorder)
      q.flags.emplace_back(h.peakCut ? "cut by the image's edge, and its peak lies beyond" : "cut by the image's edge");
    measureContour(h, frame, pixels, noise, q);
    if (surface) lookAtSilhouette(h, frame.camera, *surface, q);
    if (!blur || !h.ellipse) continue;
    q.blurPx = widenedBy(*blur, *h.ellipse, h.level);
    if (q.blurPx > std::max(kWorthBlurPx, kWorthBlurShare * h.ellipse->semiAxes.y()))
      q.flags.push_back(
          blur->motionPx > 0
              ? formatted("no edge of the frame is sharper than a motion of %.1f px along %.0f degrees and a blur of %.1f px: "
                          "motion during the exposure, or nothing sharp is in view",
                          blur->motionPx, blur->directionRad * 180 / M_PI, blur->sigmaPx)
              : formatted("no edge of the frame is sharper than a blur of %.1f px: defocus, or nothing sharp is in view",
                          blur->sigmaPx));
  }
  return qualities;
}

void flagStrangers(const Frame& frame, const Surface& surface, const std::vector<Highlight>& highlights,
                   std::vector<HighlightQuality>& qualities) {
  require(qualities.size() == highlights.size(), "flagStrangers: one quality for each highlight");
  if (frame.lightsOn.size() > 1 || highlights.size() < 2) return;
  std::vector<std::optional<ReflectedRay>> rays;
  std::optional<std::size_t> largest;
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    const Outcome<BrightestPoint> b = observedBrightestPoint(surface, frame.camera, highlights[i].peak);
    rays.push_back(b ? std::optional(reflectedRay(*b, frame.camera)) : std::nullopt);
    if (b && (!largest || highlights[i].areaPx2 > highlights[*largest].areaPx2)) largest = i;
  }
  for (std::size_t i = 0; largest && i < highlights.size(); ++i) {
    if (i == *largest || !rays[i]) continue;
    const double deg = disagreement(*rays[*largest], *rays[i]) * 180 / M_PI;
    if (deg > kSameLampDeg)
      qualities[i].flags.push_back(formatted(
          "not the lamp of the largest highlight (mirrored rays miss each other by %.0f degrees): another lamp, a reflection "
          "or texture",
          deg));
  }
}

}  // namespace glint
