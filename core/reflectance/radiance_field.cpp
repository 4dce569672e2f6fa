// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry/camera.h"
#include "core/reflectance/light_radiance.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr double kStencilPx = 0.05;  // of the differences: their truncation moves a maximum by about 1e-4 px, round-off by less
constexpr double kSettledPx = 1e-7;
constexpr double kLastMovePx = 3e-4;  // Newton's next move is about the square over the highlight's width: it would be settled
constexpr double kSamePeakPx = 0.05;
constexpr int kMaxSteps = 80;
constexpr double kFirstStridePx = 4, kLongestStridePx = 40;  // of steps uphill where the field is not concave
// Steps of the search without derivatives; a maximum at a kink is known no better than its last steps.
constexpr double kFirstPatternPx = 4, kLeastPatternPx = 1e-4, kPatternShrink = 0.25;
constexpr double kAtBorderPx = kStencilPx;  // closer to the border of its domain a climb goes on without derivatives

/// How far inside the domain, px; negative outside. @param image  up to the centres of its outermost pixels
double depthInImage(const Pixel& p, const Eigen::AlignedBox2d& image, double marginPx) {
  return std::min({p.x() - image.min().x(), p.y() - image.min().y(), image.max().x() - p.x(), image.max().y() - p.y()}) +
         marginPx;
}

/// What the camera sees, in ideal pixels, up to the centres of the outermost ones.
Eigen::AlignedBox2d centresSeen(const Camera& camera) {
  const Eigen::AlignedBox2d window = seenWindow(camera);
  const Pixel half(0.5, 0.5);
  return {window.min() + half, window.max() - half};
}

}  // namespace

RadianceField::RadianceField(const Surface& surface, const Camera& camera, Lobe lobe, const Roughness& roughness,
                             const Lamp& lamp)
    : RadianceField(surface, camera, lobe, roughness, lamp, lobe::LampRule{}) {
  rule_ = lobe::lampRuleFor(lamp_.shape, lamp.isPoint() ? 0 : largestSizeRatio());
}

RadianceField::RadianceField(const Surface& surface, const Camera& camera, Lobe lobe, const Roughness& roughness,
                             const Lamp& lamp, const lobe::LampRule& rule)
    : surface_(surface),
      camera_(camera),
      image_(centresSeen(camera)),
      eye_(camera.centreInWorld()),
      lobe_(lobe),
      roughness_(roughness),
      lamp_(lamp),
      rule_(rule) {
  require(roughness > 0 && std::isfinite(roughness.mean), "RadianceField: roughness must be positive");
}

/// Size ratio over the visible points where the lobe may show, on a coarse grid; where no point is near the mirror direction, at
/// the nearest one.
double RadianceField::largestSizeRatio() const {
  constexpr int kColumns = 12, kRows = 9;
  constexpr double kFoot = 7, kReserve = 1.25;  // log I below the lobe's top; for what lies between the grid's points
  double largest = 0, nearest = 0, leastFall = std::numeric_limits<double>::infinity();
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      const std::optional<SurfacePoint> p =
          visible(image_.min() + Pixel((x + 0.5) / kColumns * image_.sizes().x(), (y + 0.5) / kRows * image_.sizes().y()));
      if (!p) continue;
      const double fall = fallOfLobe(*p);
      if (!std::isfinite(fall)) continue;
      const double ratio = lobe::lampRatio(roughness_, p->position, (eye_ - p->position).normalized(), lamp_);
      if (fall < kFoot) largest = std::max(largest, ratio);
      if (fall < leastFall) leastFall = fall, nearest = ratio;
    }
  return kReserve * std::max(largest, nearest);
}

std::optional<double> RadianceField::at(const SurfacePoint& p, double floor) const {
  const double seen = (eye_ - p.position).norm();
  if (!(seen > 0)) return std::nullopt;
  const std::optional<double> log = lobe::logOfLamp<double>(lobe_, roughness_, p.position, axesAt(lobe_, surface_, p),
                                                            (eye_ - p.position) / seen, lamp_, rule_);
  if (!log || !std::isfinite(*log)) return std::nullopt;
  const double total = *log;
  if (total < floor) return total;
  return hidden(p, seen) ? std::nullopt : std::optional<double>(total);
}

bool RadianceField::hidden(const SurfacePoint& p, double seen) const {
  if (!surface_.occluded(p, occlusionTarget(surface_, p.position, lightOf(lamp_), seen))) return false;
  const std::vector<Eigen::Vector3d> extremes = extremesOf(lamp_);
  return std::all_of(extremes.begin(), extremes.end(), [&](const Eigen::Vector3d& e) { return surface_.occluded(p, e); });
}

std::optional<SurfacePoint> RadianceField::visible(const Pixel& p) const {
  const Outcome<SurfacePoint> hit = surface_.firstHit(camera_.ray(p));
  return hit ? std::optional<SurfacePoint>(facing(*hit, eye_)) : std::nullopt;
}

std::optional<double> RadianceField::at(const Pixel& p) const {
  const std::optional<SurfacePoint> hit = visible(p);
  return hit ? at(*hit) : std::nullopt;
}

namespace {

/// The way uphill in a field, within its image and a margin.
class Climb {
 public:
  Climb(const RadianceField& field, const Eigen::AlignedBox2d& image, double marginPx, const Pixel& start)
      : field_(field), image_(image), marginPx_(marginPx), p_(start) {}

  /// False where the field is undefined at the start.
  bool run() {
    const std::optional<double> first = value(p_);
    if (!first) return false;
    here_ = *first;
    for (; step_ < kMaxSteps && pattern_ > kLeastPatternPx; ++step_) {
      const Taken taken = newtonStep();
      if (taken == Taken::AtTop) break;
      if (taken == Taken::None) searchAround();
    }
    return true;
  }
  const Pixel& pixel() const { return p_; }
  double height() const { return here_; }

  /// At the border of the domain: whether the field rises outwards.
  bool risesBeyond() const {
    if (depthInImage(p_, image_, marginPx_) >= kAtBorderPx) return false;
    Pixel outwards(0, 0);
    for (int i = 0; i < 2; ++i) {
      const double first = image_.min()(i) - marginPx_, last = image_.max()(i) + marginPx_;
      outwards(i) = p_(i) - first < kAtBorderPx ? -1 : last - p_(i) < kAtBorderPx ? 1 : 0;
    }
    const std::optional<double> beyond = field_.at(Pixel(p_ + kFirstStridePx * kStencilPx * outwards));
    return beyond && *beyond > here_;
  }

 private:
  enum class Taken { None, Uphill, AtTop };

  std::optional<double> value(const Pixel& q) const {
    return depthInImage(q, image_, marginPx_) < 0 ? std::nullopt : field_.at(q);
  }

  /// Newton's method, or uphill where the field is not concave. None where the field ends nearby or does not rise as it says.
  Taken newtonStep() {
    // Beside, above, and two corners: central differences of second order want no more.
    double f[3][3];
    for (const auto& [i, j] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}}) {
      const std::optional<double> v = value(p_ + kStencilPx * Pixel(i, j));
      if (!v) return Taken::None;
      f[i + 1][j + 1] = *v;
    }
    const Eigen::Vector2d gradient(f[2][1] - f[0][1], f[1][2] - f[1][0]);
    Eigen::Matrix2d hessian;
    hessian(0, 0) = f[2][1] - 2 * here_ + f[0][1];
    hessian(1, 1) = f[1][2] - 2 * here_ + f[1][0];
    hessian(0, 1) = hessian(1, 0) = (f[2][2] + f[0][0] - 2 * here_ - hessian(0, 0) - hessian(1, 1)) / 2;
    const bool concave = hessian(0, 0) < 0 && hessian.determinant() > 0;
    Eigen::Vector2d move =
        concave ? Eigen::Vector2d(-0.5 * kStencilPx * hessian.ldlt().solve(gradient))
                : Eigen::Vector2d(gradient.norm() > 0 ? Eigen::Vector2d(stride_ * gradient.normalized()) : Pixel(0, 0));
    if (move.norm() > kLongestStridePx) move *= kLongestStridePx / move.norm();
    if (concave && move.norm() < kSettledPx) return Taken::AtTop;
    for (double share = 1; share > 1e-3; share *= 0.25) {  // shorter: then the model is wrong, not the step too long
      const std::optional<double> next = value(p_ + share * move);
      if (!next || !(*next > here_)) continue;
      p_ += share * move;
      here_ = *next;
      stride_ = std::min(share == 1 ? 2 * stride_ : kFirstStridePx, kLongestStridePx);
      return concave && share == 1 && move.norm() < kLastMovePx ? Taken::AtTop : Taken::Uphill;
    }
    // Uphill by less than the values' own round-off: this is the top.
    return concave && move.norm() < 1e-3 ? Taken::AtTop : Taken::None;
  }

  /// The field ends in the stencil, or has a kink (flat facets): to better neighbours, closer and closer.
  void searchAround() {
    bool moved = false;
    for (; !moved && pattern_ > kLeastPatternPx; pattern_ *= moved ? 1 : kPatternShrink)
      for (int tried = 0; tried < 8 && step_ < kMaxSteps; ++tried) {
        // The way that led on first, then the ways beside it.
        const int turn = (tried % 2 ? 1 : -1) * ((tried + 1) / 2);
        const double a = (heading_ + turn) * M_PI / 4;
        const Pixel q = p_ + pattern_ * Pixel(std::cos(a), std::sin(a));
        const std::optional<double> next = value(q);
        if (!next || !(*next > here_)) continue;
        p_ = q;
        here_ = *next;
        moved = true;
        heading_ += turn;
        // The way along the border may be as long as the image.
        if (tried == 0 && depthInImage(p_, image_, marginPx_) < kAtBorderPx) pattern_ = std::min(2 * pattern_, kLongestStridePx);
        tried = -1;
        ++step_;
      }
  }

  const RadianceField& field_;
  const Eigen::AlignedBox2d& image_;
  double marginPx_;
  Pixel p_;
  double here_ = 0;  ///< value at p_
  double pattern_ = kFirstPatternPx, stride_ = kFirstStridePx;
  int heading_ = 0;  ///< eighths of a turn
  int step_ = 0;
};

}  // namespace

std::optional<RadiancePeak> RadianceField::climb(Pixel start, double marginPx) const {
  Climb climb(*this, image_, marginPx, start);
  if (!climb.run()) return std::nullopt;
  const std::optional<SurfacePoint> point = visible(climb.pixel());
  if (!point) return std::nullopt;
  return RadiancePeak{climb.pixel(), *point, climb.height(), climb.risesBeyond()};
}
double RadianceField::fallOfLobe(const SurfacePoint& p) const {
  const Eigen::Vector3d toCamera = (eye_ - p.position).normalized();
  const Eigen::Vector3d mirrored = reflect(toCamera, p.normal);
  const auto [offset, extent] = lobe::nearestTo(lamp_, p.position, mirrored);
  const double apart = std::atan2(offset.cross(mirrored).norm(), offset.dot(mirrored));
  if (!(apart > extent)) return 0;
  // The light's point nearest to the mirror direction.
  const Eigen::Vector3d turn = offset.cross(mirrored).normalized();
  const Eigen::Vector3d toLight = Eigen::AngleAxisd(extent, turn) * offset.normalized();
  const std::optional<LogRadiance> here = logRadiance(lobe_, roughness_, axesAt(lobe_, surface_, p), toLight, toCamera);
  const std::optional<LogRadiance> top = logRadiance(lobe_, roughness_, p.normal, p.normal, p.normal);
  return here && top ? top->lobe - here->lobe : std::numeric_limits<double>::infinity();
}

CoarseScan coarseScan(const Surface& surface, const Camera& camera, double stepPx) {
  CoarseScan scan;
  std::vector<Ray> rays;
  const Eigen::AlignedBox2d image = centresSeen(camera);
  const int columns = std::max(1, int(std::ceil(image.sizes().x() / stepPx)));
  const int rows = std::max(1, int(std::ceil(image.sizes().y() / stepPx)));
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= columns; ++x) {
      scan.pixels.emplace_back(image.min() +
                               Pixel(double(x) / columns * image.sizes().x(), double(y) / rows * image.sizes().y()));
      rays.push_back(camera.ray(scan.pixels.back()));
    }
  scan.hits = surface.approximateHits(rays);
  const Eigen::Vector3d eye = camera.centreInWorld();
  for (std::optional<SurfacePoint>& hit : scan.hits)
    if (hit) hit = facing(*hit, eye);
  return scan;
}

std::vector<RadiancePeak> RadianceField::peaks(const std::vector<Pixel>& starts, double scanStepPx) const {
  return scanStepPx > 0 ? peaks(starts, coarseScan(surface_, camera_, scanStepPx)) : peaksFrom(starts, nullptr);
}

std::vector<RadiancePeak> RadianceField::peaks(const std::vector<Pixel>& starts, const CoarseScan& scan) const {
  return peaksFrom(starts, &scan);
}

std::vector<RadiancePeak> RadianceField::peaksFrom(const std::vector<Pixel>& starts, const CoarseScan* scan) const {
  std::vector<RadiancePeak> found;
  const auto add = [&](const Pixel& start, double marginPx) {
    const std::optional<RadiancePeak> peak = climb(start, marginPx);
    if (!peak) return;
    for (const RadiancePeak& p : found)
      if ((p.pixel - peak->pixel).norm() < kSamePeakPx) return;
    found.push_back(*peak);
  };
  for (const Pixel& s : starts)
    if (depthInImage(s, image_, 0) >= 0) add(s, 0);
  if (scan) {
    std::optional<std::size_t> best;
    double brightest = -std::numeric_limits<double>::infinity();
    for (const RadiancePeak& p : found) brightest = std::max(brightest, p.logRadiance);
    for (std::size_t i = 0; i < scan->hits.size(); ++i) {
      if (!scan->hits[i]) continue;
      const std::optional<double> v = at(*scan->hits[i], brightest);
      if (!v || *v <= brightest) continue;
      brightest = *v;
      best = i;
    }
    if (best) add(scan->pixels[*best], 0);
  }
  const auto brighter = [](const RadiancePeak& a, const RadiancePeak& b) { return a.logRadiance > b.logRadiance; };
  std::stable_sort(found.begin(), found.end(), brighter);
  if (found.empty() || found.front().cut) {
    // The image's border is no maximum: it lies beyond.
    const double margin = kPeakMargin * (image_.sizes().maxCoeff() + 1);
    std::vector<Pixel> from;
    for (const RadiancePeak& p : found)
      if (p.cut) from.push_back(p.pixel);
    for (const Pixel& s : starts)
      if (depthInImage(s, image_, 0) < 0) from.push_back(s);
    found.erase(std::remove_if(found.begin(), found.end(), [](const RadiancePeak& p) { return p.cut; }), found.end());
    for (const Pixel& p : from) add(p, margin);
    std::stable_sort(found.begin(), found.end(), brighter);
  }
  return found;
}

}  // namespace glint
