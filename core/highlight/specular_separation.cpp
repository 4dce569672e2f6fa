// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/specular_separation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>

#include "core/base/number_text.h"
#include "core/highlight/frame_blur.h"

namespace glint {
namespace {

constexpr double kMiddle = 0.4;                             // footprints: the lobe is above 0.9 of its peak there (level 0.5)
constexpr double kRingFrom = 1.6;                           // footprints, where the background's ring starts
constexpr double kRingTo = 6;                               // far enough out that tail and diffuse light differ
constexpr std::size_t kMostRing = 20000, kLeastRing = 200;  // pixels
constexpr int kLeastMiddle = 3;                             // pixels
constexpr int kFewClipped = 3;                              // fewer are hot pixels
constexpr double kGreyShare = 1e-3;                         // of the mean: channels that differ by less are copies of one
constexpr double kDarkShare = 0.03;      // of the peak: diffuse light below it bends no contour, and has no colour to speak of
constexpr double kLeastAngleDeg = 5;     // between the colours; at less a white balance that is off by a tenth decides
constexpr double kMostNoise = 0.05;      // of the peak: a contour then wanders by as much as a diffuse edge bends it
constexpr double kMostLeftover = 0.03;   // of the peak
constexpr double kOthersReach = 2.5;     // footprints of another highlight that are left out
constexpr double kNegativeLamp = -0.05;  // of the mean of its channels: no lamp's

Eigen::Vector3d colourAt(const Image& image, int x, int y) { return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)}; }

std::optional<Footprint> footprintOf(const Highlight& h) {
  if (!h.ellipse || !(h.ellipse->semiAxes.minCoeff() > 0)) return std::nullopt;
  Footprint f;
  f.centre = h.ellipse->centre;
  f.level = h.level;
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(h.ellipse->angle).toRotationMatrix();
  f.shape = axes * h.ellipse->semiAxes.cwiseAbs2().asDiagonal() * axes.transpose();
  return f;
}

/// Squared distance from the middle in footprints.
class Reach {
 public:
  explicit Reach(const Footprint& f) : centre_(f.centre), inverse_(f.shape.inverse()) {}
  double squared(double x, double y) const {
    const Eigen::Vector2d d = Pixel(x, y) - centre_;
    return d.dot(inverse_ * d);
  }

 private:
  Pixel centre_;
  Eigen::Matrix2d inverse_;
};

cv::Rect boxOf(const Footprint& f, double reach, int width, int height) {
  const Eigen::Vector2d half = reach * f.shape.diagonal().cwiseSqrt();
  const int x0 = static_cast<int>(std::floor(std::clamp(f.centre.x() - half.x(), 0.0, width - 1.0))),
            y0 = static_cast<int>(std::floor(std::clamp(f.centre.y() - half.y(), 0.0, height - 1.0)));
  const int x1 = static_cast<int>(std::ceil(std::clamp(f.centre.x() + half.x(), 0.0, width - 1.0))),
            y1 = static_cast<int>(std::ceil(std::clamp(f.centre.y() + half.y(), 0.0, height - 1.0)));
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

/// Colours around and in the highlight.
struct Colours {
  std::vector<Eigen::Vector3d> ring, inside;
  std::vector<Eigen::Vector2d> insideAt;  ///< in footprints along x and y
  std::vector<double> ringSquared;        ///< reach^2 of each in the ring
  Eigen::Vector3d middle{0, 0, 0};        ///< mean
  double middleTail = 0;                  ///< mean of the Gaussian lobe there
  int middlePixels = 0, clipped = 0;
  bool grey = true;
};

Colours coloursAround(const Image& image, const std::vector<char>& usable, double clipValue, const Footprint& footprint,
                      const std::vector<Reach>& others) {
  Colours c;
  const Reach reach(footprint);
  const cv::Rect box = boxOf(footprint, kRingTo, image.width, image.height);
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(box.area()) / kMostRing)));
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = box.x; x < box.x + box.width; ++x) {
      const double squared = reach.squared(x, y);
      if (squared > kRingTo * kRingTo || !usable[static_cast<std::size_t>(y) * image.width + x]) continue;
      const Eigen::Vector3d colour = colourAt(image, x, y);
      const bool full = clipValue > 0 && colour.maxCoeff() >= clipValue;
      if (squared <= 1) {
        c.clipped += full;
        c.inside.push_back(colour);
        c.insideAt.push_back((Pixel(x, y) - footprint.centre).cwiseQuotient(footprint.shape.diagonal().cwiseSqrt()));
        c.grey = c.grey && colour.maxCoeff() - colour.minCoeff() <= kGreyShare * colour.mean();
        if (squared > kMiddle * kMiddle) continue;
        c.middle += colour;
        c.middleTail += std::pow(footprint.level, squared);
        ++c.middlePixels;
      } else if (squared >= kRingFrom * kRingFrom && !full && x % stride == 0 && y % stride == 0) {
        const auto belongs = [&](const Reach& other) { return other.squared(x, y) < kOthersReach * kOthersReach; };
        if (std::any_of(others.begin(), others.end(), belongs)) continue;
        c.ring.push_back(colour);
        c.ringSquared.push_back(squared);
        c.grey = c.grey && colour.maxCoeff() - colour.minCoeff() <= kGreyShare * colour.mean();
      }
    }
  if (c.middlePixels > 0) {
    c.middle /= c.middlePixels;
    c.middleTail /= c.middlePixels;
  }
  return c;
}

/// The combination w: w . middle is the lobe there; around the highlight w . I differs least from its tail, Gaussian plus GGX.
struct Combination {
  Eigen::Vector3d w;
  double rms;  ///< of what differs
};
Combination leastDiffuse(const Colours& c, double level) {
  const Eigen::Vector3d along = c.middle / c.middle.squaredNorm() * c.middleTail;
  const Eigen::Vector3d first = c.middle.unitOrthogonal(), second = c.middle.normalized().cross(first);
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  Eigen::Vector4d products = Eigen::Vector4d::Zero();
  const auto rowOf = [&](std::size_t i) {
    const double q = c.ringSquared[i];
    return Eigen::Vector4d(c.ring[i].dot(first), c.ring[i].dot(second), -std::pow(level, q),
                           -std::pow(1 + (1 / std::sqrt(level) - 1) * q, -2));
  };
  for (std::size_t i = 0; i < c.ring.size(); ++i) {
    const Eigen::Vector4d row = rowOf(i);
    squares += row * row.transpose();
    products -= row * c.ring[i].dot(along);
  }
  // A trace of damping for what the ring does not determine (one colour: the second direction is noise alone).
  squares.diagonal() += 1e-12 * squares.diagonal();
  squares.diagonal().array() += 1e-15 * squares.diagonal().maxCoeff();
  const Eigen::Vector4d x = squares.ldlt().solve(products);
  Combination result{along + x[0] * first + x[1] * second, 0};
  for (std::size_t i = 0; i < c.ring.size(); ++i) result.rms += std::pow(rowOf(i).dot(x) + c.ring[i].dot(along), 2);
  result.rms = std::sqrt(result.rms / static_cast<double>(c.ring.size()));
  return result;
}

/// Radiance per unit of s in each channel: the slope of the highlight's colours over s, beside diffuse light that is linear in
/// the pixel. What else the diffuse light does there goes into it, along the diffuse colours: it is for scale and pictures.
Eigen::Vector3d lampOf(const Colours& c, const Eigen::Vector3d& w) {
  Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> products = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < c.inside.size(); ++i) {
    const Eigen::Vector4d row(w.dot(c.inside[i]), 1, c.insideAt[i].x(), c.insideAt[i].y());
    squares += row * row.transpose();
    products += row * c.inside[i].transpose();
  }
  return squares.ldlt().solve(products).row(0).transpose();
}

double channelNoise(const Image& image, const std::vector<char>& usable, const cv::Rect& box, const Eigen::Vector3d& w) {
  Image part(box.width, box.height, 1);
  std::vector<char> use;
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      const bool good = usable[static_cast<std::size_t>(y + box.y) * image.width + x + box.x];
      use.push_back(good);
      part.at(x, y) = good ? static_cast<float>(w.dot(colourAt(image, x + box.x, y + box.y))) : 0.f;
    }
  return pixelNoise(part, use);
}

Failure cannotSeparate(std::string why) { return {Reason::NotSupported, std::move(why)}; }

std::vector<char> usablePixels(const Image& linear, const Image* mask) {
  std::vector<char> usable(static_cast<std::size_t>(linear.width) * linear.height);
  for (int y = 0; y < linear.height; ++y)
    for (int x = 0; x < linear.width; ++x) {
      const Eigen::Vector3d colour = colourAt(linear, x, y);
      usable[static_cast<std::size_t>(y) * linear.width + x] =
          colour.allFinite() && colour.minCoeff() >= 0 && (!mask || mask->at(x, y) != 0.f);
    }
  return usable;
}

}  // namespace

Outcome<SeparatedRegion> separateColours(const Image& linear, const std::vector<char>& usable, double clipValue,
                                         const Highlight& highlight, const std::vector<Highlight>& others) {
  require(usable.size() == static_cast<std::size_t>(linear.width) * linear.height, "separateColours: one entry per pixel");
  if (linear.channels != 3) return cannotSeparate("the image is grey");
  const std::optional<Footprint> footprint = footprintOf(highlight);
  if (!footprint) return Failure{Reason::NotAnEllipse, "a highlight has no ellipse"};
  std::vector<Reach> left;
  for (const Highlight& h : others)
    if (const std::optional<Footprint> f = footprintOf(h)) left.emplace_back(*f);
  const Colours c = coloursAround(linear, usable, clipValue, *footprint, left);
  if (highlight.clipped || c.clipped >= kFewClipped) return cannotSeparate("clipped pixels have lost their colour");
  if (c.middlePixels < kLeastMiddle || c.ring.size() < kLeastRing)
    return Failure{Reason::TooFewPoints, formatted("%zu pixels around a highlight, %zu are needed", c.ring.size(), kLeastRing)};
  if (c.grey) return cannotSeparate("the image is grey");
  Eigen::Vector3d diffuse(0, 0, 0);
  for (const Eigen::Vector3d& colour : c.ring) diffuse += colour / static_cast<double>(c.ring.size());
  if (!(diffuse.mean() > kDarkShare * c.middle.mean()))
    return cannotSeparate("there is no diffuse light around the highlight (metal, or black): nothing to separate");

  const Combination found = leastDiffuse(c, footprint->level);
  const Eigen::Vector3d lamp = lampOf(c, found.w);
  SeparatedRegion region;
  region.footprint = *footprint;
  if (!found.w.allFinite() || !lamp.allFinite() || !(lamp.mean() > 0))
    return cannotSeparate("no combination of the channels is free of the diffuse colours");
  region.lampColour = lamp / lamp.mean();
  region.channels = found.w * lamp.mean();
  region.angleDeg = std::atan2(lamp.cross(diffuse).norm(), lamp.dot(diffuse)) * 180 / M_PI;
  region.noise = channelNoise(linear, usable, boxOf(*footprint, kRingTo, linear.width, linear.height), found.w);
  region.leftover = std::sqrt(std::max(0.0, found.rms * found.rms - region.noise * region.noise));
  if (region.angleDeg < kLeastAngleDeg)
    return cannotSeparate(formatted("the diffuse colour is the lamp's, to %.1f degrees", region.angleDeg));
  if (region.noise > kMostNoise)
    return cannotSeparate(formatted("noise of the separated highlight would be %.0f %% of its peak", 100 * region.noise));
  if (region.leftover > kMostLeftover)
    return cannotSeparate(
        formatted("no combination of the channels is free of the colours around the highlight (%.0f %% of its peak is left): "
                  "several materials, "
                  "or one of the lamp's colour",
                  100 * region.leftover));
  if (region.lampColour.minCoeff() < kNegativeLamp) return cannotSeparate("what is left is no lamp's colour");
  return region;
}

namespace {

/// The specular part around one highlight.
struct SpecularView {
  Image value, mask;
  cv::Rect box;
};
SpecularView viewOf(const Image& linear, const std::vector<char>& usable, const SeparatedRegion& region) {
  SpecularView view;
  view.box = boxOf(region.footprint, kRingTo, linear.width, linear.height);
  view.value = Image(view.box.width, view.box.height, 1);
  view.mask = Image(view.box.width, view.box.height, 1);
  for (int y = 0; y < view.box.height; ++y)
    for (int x = 0; x < view.box.width; ++x) {
      const Eigen::Vector3d colour = colourAt(linear, x + view.box.x, y + view.box.y);
      // Noise below zero is no broken pixel; a broken one stays broken.
      const double s = colour.allFinite() && colour.minCoeff() >= 0 ? std::max(0.0, region.channels.dot(colour))
                                                                    : std::numeric_limits<double>::quiet_NaN();
      view.value.at(x, y) = static_cast<float>(s);
      view.mask.at(x, y) = usable[static_cast<std::size_t>(y + view.box.y) * linear.width + x + view.box.x];
    }
  return view;
}

/// The highlight of the view that overlaps the one before most, in the image's pixels.
std::optional<Highlight> tracedIn(const SpecularView& view, const DetectOptions& options, const Highlight& before) {
  Outcome<std::vector<Highlight>> found = detectHighlights(view.value, &view.mask, options);
  if (!found) return std::nullopt;
  const Pixel origin(view.box.x, view.box.y);
  std::optional<Highlight> best;
  for (Highlight& h : *found) {
    for (Pixel& p : h.contour.points) p += origin;
    h.peak += origin;
    if (h.ellipse) h.ellipse->centre += origin;
    const bool overlaps = contains(h.contour, before.peak) || contains(before.contour, h.peak);
    if (overlaps && (!best || h.areaPx2 > best->areaPx2)) best = std::move(h);
  }
  return best;
}

}  // namespace

double movedBy(double share, const Highlight& h) {
  if (!(h.level > 0 && h.level < 1) || !(h.areaPx2 > 0)) return 0;
  return share * std::sqrt(h.areaPx2 / M_PI) / (2 * h.level * -std::log(h.level));
}

SpecularSeparation separateHighlights(const Image& linear, const Image* mask, const DetectOptions& options,
                                      std::vector<Highlight>& highlights) {
  SpecularSeparation separation;
  if (linear.channels != 3) {
    separation.reason = "the image is grey";
    return separation;
  }
  const std::vector<char> usable = usablePixels(linear, mask);
  std::vector<SpecularView> views;
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    std::vector<Highlight> others = highlights;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    Outcome<SeparatedRegion> region = separateColours(linear, usable, options.clipValue, highlights[i], others);
    if (!region) {
      separation.reason = region.failure().detail;
      if (highlights.size() > 1)
        separation.reason += formatted(" (highlight at %.0f, %.0f)", highlights[i].peak.x(), highlights[i].peak.y());
      separation.regions.clear();
      return separation;
    }
    separation.regions.push_back(*std::move(region));
    views.push_back(viewOf(linear, usable, separation.regions.back()));
  }
  DetectOptions again = options;
  again.removeBackground = false;
  again.clipValue = 0;
  again.separatePeaks = false;
  again.references.clear();
  const auto traceAll = [&]() -> std::optional<std::vector<Highlight>> {
    std::vector<Highlight> traced;
    for (std::size_t i = 0; i < highlights.size(); ++i) {
      std::optional<Highlight> h = tracedIn(views[i], again, highlights[i]);
      if (!h) return std::nullopt;
      traced.push_back(*std::move(h));
    }
    return traced;
  };
  std::optional<std::vector<Highlight>> traced = traceAll();
  // The level is a fraction of the strongest peak, as before, unless each has its own.
  if (traced && traced->size() > 1 && !options.separatePeaks) {
    double top = 0;
    for (const Highlight& h : *traced) top = std::max(top, h.peakValue);
    again.reference = options.reference ? *options.reference : top;
    traced = traceAll();
  }
  if (!traced) {
    separation.reason = "the specular part shows no contour where the highlight was found";
    separation.regions.clear();
    return separation;
  }
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    (*traced)[i].light = highlights[i].light;
    (*traced)[i].touchesBorder = highlights[i].touchesBorder;
    (*traced)[i].peakCut = highlights[i].peakCut;
  }
  highlights = *std::move(traced);
  separation.separated = true;
  return separation;
}

Image specularPart(const Image& linear, const SpecularSeparation& separation) {
  Image part(linear.width, linear.height, 3);
  if (linear.channels != 3) return part;
  for (const SeparatedRegion& region : separation.regions) {
    const Reach reach(region.footprint);
    const cv::Rect box = boxOf(region.footprint, kRingTo, linear.width, linear.height);
    for (int y = box.y; y < box.y + box.height; ++y)
      for (int x = box.x; x < box.x + box.width; ++x) {
        const Eigen::Vector3d colour = colourAt(linear, x, y);
        if (reach.squared(x, y) > kRingTo * kRingTo || !colour.allFinite()) continue;
        const double s = std::max(0.0, region.channels.dot(colour));
        for (int k = 0; k < 3; ++k)
          part.at(x, y, k) = std::max(part.at(x, y, k), static_cast<float>(std::max(0.0, s * region.lampColour[k])));
      }
  }
  return part;
}

}  // namespace glint
