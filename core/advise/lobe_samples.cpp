// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/lobe_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/numeric.h"
#include "core/highlight/background.h"

namespace glint {
namespace {

constexpr int kLeastPixels = 6;         // three per unknown
constexpr double kBackgroundReach = 4;  // of the footprint, as fitBackground looks

float meanOf(const Image& image, int x, int y) {
  float sum = 0;
  for (int c = 0; c < image.channels; ++c) sum += image.at(x, y, c);
  return sum / float(image.channels);
}

Outcome<LobeFit> fitLobe(const std::vector<LobeSample>& samples) {
  LobeFit fit;
  double brightest = 0;
  for (const LobeSample& s : samples)
    if (s.fitted) brightest = fit.pixels++ ? std::max(brightest, s.logI) : s.logI;
  if (fit.pixels < kLeastPixels)
    return Failure{Reason::TooFewPoints, std::to_string(fit.pixels) + " pixels above the level of the fit"};
  // log I = a - b alpha^2 about the weighted means; weights relative to the brightest pixel, so that none overflows.
  double w = 0, x = 0, y = 0;
  for (const LobeSample& s : samples) {
    if (!s.fitted) continue;
    const double weight = std::exp(2 * (s.logI - brightest));
    w += weight;
    x += weight * s.alpha * s.alpha;
    y += weight * s.logI;
  }
  x /= w;
  y /= w;
  double xx = 0, xy = 0;
  for (const LobeSample& s : samples) {
    if (!s.fitted) continue;
    const double weight = std::exp(2 * (s.logI - brightest)), dx = s.alpha * s.alpha - x;
    xx += weight * dx * dx;
    xy += weight * dx * (s.logI - y);
  }
  if (!(xx > 0) || !(xy < 0)) return Failure{Reason::NotConverged, "the radiance does not fall with alpha"};
  fit.m = std::sqrt(-xx / xy);
  fit.logHeight = y - xy / xx * x;
  double squares = 0;
  for (const LobeSample& s : samples) {
    if (!s.fitted) continue;
    const double r = s.logI - fit.logHeight + s.alpha * s.alpha / (fit.m * fit.m);
    squares += std::exp(2 * (s.logI - brightest)) * r * r;
  }
  fit.rms = std::sqrt(squares / w);
  if (!std::isfinite(fit.m) || !std::isfinite(fit.logHeight)) return Failure{Reason::NotFinite, "the lobe's width"};
  return fit;
}

/// A highlight's surroundings, cut out of a frame that may be large, with the background that is fitted in them.
struct Surroundings {
  Image cut;                 ///< one channel
  int x0 = 0, y0 = 0;        ///< of the cut's first pixel in the frame
  std::vector<char> usable;  ///< one per pixel of the cut
  Footprint footprint;       ///< in px of the cut
  Background background;
  bool isUsable(int x, int y) const { return usable[std::size_t(y) * std::size_t(cut.width) + std::size_t(x)] != 0; }
};

Outcome<Surroundings> surroundingsOf(const Image& linear, const Image* mask, const Highlight& highlight, const Camera& camera) {
  if (!highlight.ellipse) return Failure{Reason::NotAnEllipse, "the observed contour has no ellipse"};
  const Ellipse& e = *highlight.ellipse;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(e.angle).toRotationMatrix();
  Surroundings s;
  Footprint& footprint = s.footprint;
  footprint.centre = camera.hasDistortion() ? camera.distorted(e.centre) : e.centre;
  footprint.shape = turn * e.semiAxes.cwiseAbs2().asDiagonal() * turn.transpose();
  footprint.level = highlight.level;

  const Pixel reach = kBackgroundReach * footprint.shape.diagonal().cwiseSqrt();
  s.x0 = std::max(0, int(std::floor(footprint.centre.x() - reach.x())));
  s.y0 = std::max(0, int(std::floor(footprint.centre.y() - reach.y())));
  const int x1 = std::min(linear.width - 1, int(std::ceil(footprint.centre.x() + reach.x())));
  const int y1 = std::min(linear.height - 1, int(std::ceil(footprint.centre.y() + reach.y())));
  if (x1 < s.x0 || y1 < s.y0) return Failure{Reason::OutsideImage, "the highlight"};
  footprint.centre -= Pixel(s.x0, s.y0);
  s.cut = Image(x1 - s.x0 + 1, y1 - s.y0 + 1, 1);
  std::vector<float> darkest;
  for (int y = 0; y < s.cut.height; ++y)
    for (int x = 0; x < s.cut.width; ++x) {
      const float v = meanOf(linear, s.x0 + x, s.y0 + y);
      s.cut.at(x, y) = v;
      const bool good = (!mask || mask->at(s.x0 + x, s.y0 + y) != 0) && std::isfinite(v);
      s.usable.push_back(good && v >= 0);
      if (good) darkest.push_back(v);
    }
  if (darkest.empty()) return Failure{Reason::TooFewPoints, "no glossy pixel around the highlight"};
  s.background = fitBackground(s.cut, s.usable, footprint, ranked(darkest, darkest.size() / 10));
  return s;
}

/// The lit surface at a pixel. Empty beside the surface and on its unlit side.
std::optional<LobePixel> litPixel(const Pixel& ideal, double radiance, const Camera& camera, const Surface& surface,
                                  const Light& light) {
  const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(ideal));
  if (!hit) return std::nullopt;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint p = facing(*hit, eye);
  const Eigen::Vector3d toLight = light.directionFrom(p.position);
  if (!(p.normal.dot(toLight) > 0)) return std::nullopt;
  const Eigen::Vector3d toCamera = (eye - p.position).normalized();
  const double alpha = incidentAngle(p.normal, toLight, toCamera);
  if (!std::isfinite(alpha) || !std::isfinite(radiance)) return std::nullopt;
  const double distance = light.atInfinity() ? 1 : (light.position() - p.position).norm();
  return LobePixel{alpha, radiance, p.normal, toLight, toCamera, distance};
}

/// Pixels and samples on an even grid in the highlight's reach.
LobeSamples samplesOf(const Surroundings& s, const Highlight& highlight, const Camera& camera, const Surface& surface,
                      const Light& light, const LobeOptions& options) {
  LobeSamples result;
  const double area = std::numbers::pi * options.reach * options.reach * std::sqrt(s.footprint.shape.determinant());
  const int step = std::max(1, int(std::lround(std::sqrt(area / options.mostSamples))));
  const Eigen::Matrix2d inverse = s.footprint.shape.inverse();
  const Pixel middle = centroid(highlight.contour);
  result.grid = {Pixel(s.x0, s.y0), step, (s.cut.width + step - 1) / step, (s.cut.height + step - 1) / step, {}};
  result.grid.places.resize(std::size_t(result.grid.width) * std::size_t(result.grid.height));
  for (int y = 0; y < s.cut.height; y += step)
    for (int x = 0; x < s.cut.width; x += step) {
      if (!s.isUsable(x, y)) continue;
      const Pixel d = Pixel(x, y) - s.footprint.centre;
      if (d.dot(inverse * d) > options.reach * options.reach) continue;
      const bool clipped = options.clipValue > 0 && s.cut.at(x, y) >= options.clipValue;
      if (clipped) ++result.clipped;
      const double above = s.cut.at(x, y) - s.background.at(x, y);
      const Pixel stored(s.x0 + x, s.y0 + y);
      const Pixel ideal = camera.hasDistortion() ? camera.undistorted(stored) : stored;
      if (!ideal.allFinite()) continue;
      const std::optional<LobePixel> place = litPixel(ideal, above, camera, surface, light);
      if (!place) continue;
      result.grid.places[std::size_t(y / step) * std::size_t(result.grid.width) + std::size_t(x / step)] = place;
      if (clipped) continue;
      result.pixels.push_back(*place);
      if (!(above > 0)) continue;
      const double direction = std::atan2(ideal.y() - middle.y(), ideal.x() - middle.x());
      result.samples.push_back({ideal, place->alpha, std::log(above), direction});
    }
  return result;
}

}  // namespace
double LobeFit::alphaAt(double fraction) const {
  require(fraction > 0 && fraction <= 1, "LobeFit::alphaAt: the fraction must be in (0, 1]");
  return m * std::sqrt(-std::log(fraction));
}

Outcome<LobeSamples> lobeSamples(const Image& linear, const Image* mask, const Highlight& highlight, const Camera& camera,
                                 const Surface& surface, const Light& light, const LobeOptions& options) {
  require(!linear.empty() && options.reach > 0 && options.fitLevel > 0 && options.mostSamples > 0,
          "lobeSamples: empty image or options out of range");
  require(!mask || (mask->width == linear.width && mask->height == linear.height), "lobeSamples: the mask has another size");
  const Outcome<Surroundings> around = surroundingsOf(linear, mask, highlight, camera);
  if (!around) return around.failure();
  LobeSamples result = samplesOf(*around, highlight, camera, surface, light, options);
  if (result.samples.empty()) return Failure{Reason::TooFewPoints, "no pixel of the lit surface is above the background"};
  result.background = around->background.at(around->footprint.centre.x(), around->footprint.centre.y());
  double brightest = 0;
  for (const LobePixel& p : result.pixels) brightest = std::max(brightest, p.radiance);
  constexpr double kContrast = 3;          // as DetectOptions::minContrast
  constexpr double kFloatRoundOff = 1e-5;  // of the value: some steps of single precision, in which images are stored
  if (!(brightest > std::max(kContrast * around->background.spread, kFloatRoundOff * std::abs(result.background))))
    return Failure{Reason::NoHighlight, "nothing stands out from the background"};
  const double least = std::log(options.fitLevel * brightest);
  for (LobeSample& s : result.samples) s.fitted = s.logI >= least;
  Outcome<LobeFit> fit = fitLobe(result.samples);
  if (fit)
    result.fit = *fit;
  else
    result.fitFailure = fit.failure();
  return result;
}

}  // namespace glint
