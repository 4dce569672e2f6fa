// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/texture_panel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/numeric.h"
#include "core/pipeline/evidence.h"

namespace glint {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kTooSteep = 0.25;         // cosine: beyond it a pixel covers four times its width on the surface
constexpr double kHiddenStrides = 4;       // steps of the distances: a slope of 75 degrees changes by less from one to the next
constexpr double kDistancesAcross = 160;   // over an image's longer side: occlusion is decided on that grid
constexpr double kSurelyBeside2 = 9;       // squared radii of a spot: a Gaussian lobe has fallen to 0.2 % there
constexpr double kBeside2 = 4;             // the least that a tail can be fitted at: its shape matters farther in
constexpr double kTailEnds2 = 36;          // of the points that tell tails
constexpr std::size_t kEnoughBeside = 4;   // views: their middle half is two
constexpr std::size_t kLeastForTails = 3;  // views of a point
constexpr int kTailRounds = 8;             // of reweighting: the tails settle in five
constexpr double kTailScale = 2;           // of the spread: residuals beyond it count less
constexpr int kTailPoints = 600;           // of a view: two unknowns need no more
constexpr int kGainPoints = 1500;          // of a view: their median ratio is good to a few thousandths
constexpr double kSameExposure = 0.02;     // automatic exposures differ by more; below it is noise, or Fresnel's transmission
constexpr double kDark = 0.05;             // of the brightest value: ratios of darker ones are noise
constexpr double kNormalSpread = 1.4826;   // standard deviations in a median of absolute ones
constexpr double kExactSpread = 1e-12;     // of exact pictures
constexpr double kMostTail = 2;            // of the spot's own: more is no tail

double gaussianTail(double radius2) { return std::exp2(-radius2); }
double ggxTail(double radius2) { return std::pow(1 + (std::sqrt(2.0) - 1) * radius2, -2); }

/// Catmull and Rom's weights of the pixels at -1, 0, 1, 2 for a place between 0 and 1: edges stay as sharp as they are.
std::array<double, 4> cubicWeights(double t) {
  return {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
}

/// Not finite at the border, and where one of the sixteen pixels may not be used.
double sampled(const Image& image, const Pixel& at) {
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  if (x < 1 || y < 1 || x + 2 >= image.width || y + 2 >= image.height) return kUnknown;
  const std::array<double, 4> across = cubicWeights(at.x() - x), down = cubicWeights(at.y() - y);
  double sum = 0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += across[static_cast<std::size_t>(i)] * down[static_cast<std::size_t>(j)] * image.at(x - 1 + i, y - 1 + j);
  return sum;
}

/// Measured pixel of a surface point in a view that sees it; nothing where it is hidden, too steep or outside.
std::optional<Pixel> idealPlace(const TextureView& view, const SurfacePoint& at) {
  const Eigen::Vector3d towards = view.camera.centreInWorld() - at.position;
  const double distance = towards.norm();
  if (!(at.normal.dot(towards) > kTooSteep * distance)) return std::nullopt;
  const std::optional<Pixel> ideal = view.camera.project(at.position);
  if (!ideal) return std::nullopt;
  const Pixel measured = view.camera.hasDistortion() ? view.camera.distorted(*ideal) : *ideal;
  if (!measured.allFinite()) return std::nullopt;
  const int column = static_cast<int>(std::lround(measured.x() / view.stride)),
            row = static_cast<int>(std::lround(measured.y() / view.stride));
  if (column < 0 || row < 0 || column >= view.distance.width || row >= view.distance.height) return std::nullopt;
  const double step = kHiddenStrides * view.stride * distance / view.camera.pixelFromRay(0, 0);
  if (!(std::abs(view.distance.at(column, row) - distance) < step)) return std::nullopt;
  return ideal;
}

/// Rays through every `step`-th pixel of a row; those that the lens does not show look along the axis of nothing and miss.
std::vector<Ray> rowOfRays(const Camera& camera, int y, int step, std::vector<int>& columns) {
  std::vector<Ray> rays;
  columns.clear();
  for (int x = 0; x < camera.width; x += step) {
    const Pixel ideal = camera.undistorted(Pixel(x, y));
    if (!ideal.allFinite()) continue;
    rays.push_back(camera.ray(ideal));
    columns.push_back(x);
  }
  return rays;
}

/// Mean of the middle half.
double middleOf(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 4;
  double sum = 0;
  for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * cut);
}

/// Least squares of two shares, each point's own value eliminated.
class TailEquations {
 public:
  /// One point as several views show it.
  void add(const std::vector<double>& weights, const std::vector<double>& values, const std::vector<Eigen::Vector2d>& tails) {
    double sum = 0, meanValue = 0;
    Eigen::Vector2d meanTail = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i) {
      sum += weights[i];
      meanValue += weights[i] * values[i];
      meanTail += weights[i] * tails[i];
    }
    meanValue /= sum;
    meanTail /= sum;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const Eigen::Vector2d tail = tails[i] - meanTail;
      normal_ += weights[i] * tail * tail.transpose();
      right_ += weights[i] * tail * (values[i] - meanValue);
    }
  }

  /// At least 0 each: where one would be below, the other alone.
  Eigen::Vector2d solved() const {
    Eigen::Vector2d both = normal_.ldlt().solve(right_);
    for (int k = 0; k < 2; ++k) {
      if (both(k) >= 0) continue;
      const int other = 1 - k;
      both(k) = 0;
      both(other) = normal_(other, other) > 0 ? std::max(0.0, right_(other) / normal_(other, other)) : 0;
      break;
    }
    return both;
  }

 private:
  Eigen::Matrix2d normal_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_ = Eigen::Vector2d::Zero();
};

}  // namespace

std::vector<LobeSpot> lobeSpots(const std::vector<Highlight>& highlights) {
  std::vector<LobeSpot> spots;
  for (const Highlight& h : highlights) {
    if (!h.ellipse || !(h.ellipse->semiAxes.minCoeff() > 0)) continue;
    LobeSpot spot;
    spot.centre = h.ellipse->centre;
    const double toHalf2 = std::log(0.5) / std::log(std::clamp(h.level, 0.01, 0.99));  // as a Gaussian lobe falls
    const Eigen::Rotation2Dd turn(h.ellipse->angle);
    const Eigen::Vector2d squared = (h.ellipse->semiAxes.array().square() * toHalf2).inverse();
    spot.inverse = turn * squared.asDiagonal() * turn.inverse();
    spot.peak = h.peakValue > 0 ? h.peakValue : 1;  // clipped: linear codes end at 1
    spots.push_back(spot);
  }
  return spots;
}

Outcome<TextureView> textureView(const Scene& scene, int index, FrameSource source, const DetectSettings& settings,
                                 const Surface& surface) {
  const Frame& frame = scene.frames[static_cast<std::size_t>(index)];
  Outcome<LinearPixels> pixels = pixelsOf(frame, source, settings);
  if (!pixels) return pixels.failure();
  TextureView view;
  view.frame = index;
  view.camera = frame.camera;
  view.value = std::move(pixels->value);
  for (std::size_t i = 0; i < view.value.data.size(); ++i)
    if (!pixels->usable[i]) view.value.data[i] = kUnknown;
  const int width = view.value.width, height = view.value.height;
  view.stride = std::max(1, static_cast<int>(std::max(width, height) / kDistancesAcross));
  view.distance = Image((width - 1) / view.stride + 1, (height - 1) / view.stride + 1, 1, kUnknown);
  std::vector<int> columns;
  for (int y = 0; y < height; y += view.stride) {
    const std::vector<Ray> rays = rowOfRays(view.camera, y, view.stride, columns);
    const auto hits = surface.approximateHits(rays);
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i])
        view.distance.at(columns[i] / view.stride, y / view.stride) =
            static_cast<float>((hits[i]->position - rays[i].origin).norm());
  }
  return view;
}

TexturePanel::TexturePanel(std::vector<TextureView> views, std::shared_ptr<const Surface> surface)
    : views_(std::move(views)), surface_(std::move(surface)) {}

template <class Take>
void TexturePanel::overSurface(const TextureView& view, int step, const Take& take) const {
  const Eigen::Vector3d eye = view.camera.centreInWorld();
  std::vector<int> columns;
  for (int y = 0; y < view.value.height; y += step) {
    const std::vector<Ray> rays = rowOfRays(view.camera, y, step, columns);
    const auto hits = surface_->approximateHits(rays);
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i] && hits[i]->normal.allFinite()) take(columns[i], y, facing(*hits[i], eye));
  }
}

void TexturePanel::look(const SurfacePoint& at, int except, const std::vector<double>& gains,
                        std::vector<Sample>& samples) const {
  samples.clear();
  for (std::size_t j = 0; j < views_.size(); ++j) {
    const TextureView& view = views_[j];
    if (view.frame == except) continue;
    const std::optional<Pixel> ideal = idealPlace(view, at);
    if (!ideal) continue;
    Sample s;
    s.view = j;
    s.at = view.camera.hasDistortion() ? view.camera.distorted(*ideal) : *ideal;
    s.value = gains[j] * sampled(view.value, s.at);
    if (!std::isfinite(s.value)) continue;
    s.radius2 = std::numeric_limits<double>::infinity();
    for (const LobeSpot& spot : view.spots) {
      const double radius2 = spot.squaredRadius(*ideal);
      s.radius2 = std::min(s.radius2, radius2);
      s.tail[0] += gains[j] * spot.peak * gaussianTail(radius2);
      s.tail[1] += gains[j] * spot.peak * ggxTail(radius2);
    }
    samples.push_back(s);
  }
}

std::vector<double> TexturePanel::gainsFor(const TextureView& view) const {
  float brightest = 0;
  std::size_t on = 0;
  for (const float v : view.value.data)
    if (std::isfinite(v)) brightest = std::max(brightest, v), ++on;
  std::vector<std::vector<double>> ratios(views_.size());
  const int step = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(on) / kGainPoints)));
  overSurface(view, step, [&](int x, int y, const SurfacePoint& at) {
    const double own = view.value.at(x, y);
    if (!(own > kDark * brightest)) return;
    for (std::size_t j = 0; j < views_.size(); ++j) {
      if (views_[j].frame == view.frame) continue;
      const std::optional<Pixel> ideal = idealPlace(views_[j], at);
      if (!ideal) continue;
      const Camera& camera = views_[j].camera;
      const double other = sampled(views_[j].value, camera.hasDistortion() ? camera.distorted(*ideal) : *ideal);
      if (std::isfinite(other) && other > 0) ratios[j].push_back(own / other);
    }
  });
  std::vector<double> gains(views_.size(), 1);
  for (std::size_t j = 0; j < views_.size(); ++j) {
    if (ratios[j].empty()) continue;
    const double gain = upperMedian(ratios[j]);
    if (std::abs(gain - 1) > kSameExposure) gains[j] = gain;
  }
  return gains;
}

Image TexturePanel::underByMedian(const TextureView& view) const {
  Image diffuse(view.value.width, view.value.height, 1, kUnknown);
  const std::vector<double> gains = gainsFor(view);
  std::vector<Sample> samples;
  std::vector<double> values;
  overSurface(view, 1, [&](int x, int y, const SurfacePoint& at) {
    look(at, view.frame, gains, samples);
    if (samples.size() < kLeastForTails) return;
    values.clear();
    for (const Sample& s : samples) values.push_back(s.value);
    diffuse.at(x, y) = static_cast<float>(ranked(values, (values.size() - 1) / 2));
  });
  return diffuse;
}

Image TexturePanel::under(const TextureView& view) const {
  Image diffuse(view.value.width, view.value.height, 1, kUnknown);
  const std::vector<double> gains = gainsFor(view);
  std::vector<Sample> samples;
  std::vector<double> values;
  overSurface(view, 1, [&](int x, int y, const SurfacePoint& at) {
    look(at, view.frame, gains, samples);
    if (samples.empty()) return;
    for (const double beside : {kSurelyBeside2, kBeside2}) {
      values.clear();
      for (const Sample& s : samples)
        if (s.radius2 >= beside) values.push_back(withoutTails(s));
      if (values.size() >= kEnoughBeside) break;
    }
    if (values.empty()) {
      const Sample& farthest = *std::max_element(samples.begin(), samples.end(),
                                                 [](const Sample& a, const Sample& b) { return a.radius2 < b.radius2; });
      values.push_back(withoutTails(farthest));
    }
    diffuse.at(x, y) = static_cast<float>(std::max(0.0, middleOf(values)));
  });
  return diffuse;
}

std::vector<std::vector<TexturePanel::Sample>> TexturePanel::pointsInTails() const {
  std::vector<std::vector<Sample>> points;
  std::vector<Sample> samples;
  for (const TextureView& view : views_) {
    const std::vector<double> gains = gainsFor(view);
    std::size_t around = 0;
    for (int y = 0; y < view.value.height; y += view.stride)
      for (int x = 0; x < view.value.width; x += view.stride) around += std::isfinite(view.value.at(x, y));
    const int step = std::max(1, static_cast<int>(view.stride * std::sqrt(static_cast<double>(around) / kTailPoints)));
    overSurface(view, step, [&](int, int, const SurfacePoint& at) {
      look(at, -1, gains, samples);
      std::erase_if(samples, [](const Sample& s) { return s.radius2 < kBeside2; });
      const bool near = std::any_of(samples.begin(), samples.end(), [](const Sample& s) { return s.radius2 < kTailEnds2; });
      if (near && samples.size() >= kLeastForTails) points.push_back(samples);
    });
  }
  return points;
}

std::vector<std::vector<TexturePanel::Sample>> TexturePanel::sightings(int points) const {
  std::vector<std::vector<Sample>> found;
  std::vector<Sample> samples;
  const std::vector<double> asTheyAre(views_.size(), 1);
  for (const TextureView& view : views_) {
    std::size_t on = 0;
    for (const float d : view.distance.data) on += std::isfinite(d);
    const int step = view.stride * std::max(1, static_cast<int>(std::sqrt(static_cast<double>(on) / points)));
    overSurface(view, step, [&](int, int, const SurfacePoint& at) {
      look(at, -1, asTheyAre, samples);
      std::erase_if(samples, [](const Sample& s) { return s.radius2 < kSurelyBeside2; });
      for (Sample& s : samples) s.point = at;
      if (samples.size() > 1) found.push_back(samples);
    });
  }
  return found;
}

double TexturePanel::withoutTails(const Sample& s) const { return s.value - tails_[0] * s.tail[0] - tails_[1] * s.tail[1]; }

void TexturePanel::fitTails() {
  tails_ = {0, 0};
  const std::vector<std::vector<Sample>> points = pointsInTails();
  double spread = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kTailRounds && !points.empty(); ++round) {
    TailEquations equations;
    std::vector<double> residuals;
    for (const std::vector<Sample>& samples : points) {
      std::vector<double> left;
      for (const Sample& s : samples) left.push_back(withoutTails(s));
      std::vector<double> sorted = left;
      const double middle = middleOf(sorted);
      std::vector<double> weights, values;
      std::vector<Eigen::Vector2d> tails;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        residuals.push_back(std::abs(left[i] - middle));
        const double r = std::isfinite(spread) ? (left[i] - middle) / (kTailScale * spread) : 0;
        weights.push_back(1 / (1 + r * r));
        values.push_back(samples[i].value);
        tails.emplace_back(samples[i].tail[0], samples[i].tail[1]);
      }
      equations.add(weights, values, tails);
    }
    spread = std::max(kNormalSpread * upperMedian(residuals), kExactSpread);
    const Eigen::Vector2d both = equations.solved();
    tails_ = {std::min(both(0), kMostTail), std::min(both(1), kMostTail)};
  }
}

}  // namespace glint
