// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/reflectance/light_radiance.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr double kStencilPx = 0.05;  // of the differences: their truncation moves a maximum by about 1e-4 px, round-off by less
constexpr double kSettledPx = 1e-7;
constexpr double kSamePeakPx = 0.05;
constexpr int kMaxSteps = 80;
constexpr double kFirstStridePx = 4, kLongestStridePx = 40;  // of steps uphill where the field is not concave
constexpr double kAtBorderPx = 1e-3;  // a pattern search ends this close to the border of its domain, or closer

/// How far inside the domain, px; negative outside.
double depthInImage(const Pixel& p, const Camera& camera, double marginPx) {
  return std::min({p.x(), p.y(), camera.width - 1 - p.x(), camera.height - 1 - p.y()}) + marginPx;
}

}  // namespace

RadianceField::RadianceField(const Surface& surface, const Camera& camera, Lobe lobe, double roughness, const Lamp& lamp)
    : RadianceField(surface, camera, lobe, roughness, lamp, lobe::LampRule{}) {
  rule_ = lobe::lampRuleFor(in_.shape, lamp.isPoint() ? 0 : largestSizeRatio());
}

RadianceField::RadianceField(const Surface& surface, const Camera& camera, Lobe lobe, double roughness, const Lamp& lamp,
                             const lobe::LampRule& rule)
    : surface_(surface),
      camera_(camera),
      eye_(camera.centreInWorld()),
      lobe_(lobe),
      roughness_(roughness),
      lamp_(lamp),
      in_(lobe::inWorld(lamp)),
      rule_(rule) {
  require(roughness > 0 && std::isfinite(roughness), "RadianceField: roughness must be positive");
}

/// Of the visible points where the lobe may show, on a coarse grid; where none of them is near the mirror direction, of the
/// nearest.
double RadianceField::largestSizeRatio() const {
  constexpr int kColumns = 12, kRows = 9;
  constexpr double kFoot = 7, kReserve = 1.25;  // log I below the lobe's top; for what lies between the grid's points
  double largest = 0, nearest = 0, leastFall = std::numeric_limits<double>::infinity();
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      const std::optional<SurfacePoint> p =
          visible(Pixel((x + 0.5) / kColumns * (camera_.width - 1), (y + 0.5) / kRows * (camera_.height - 1)));
      if (!p) continue;
      const double fall = fallOfLobe(*p);
      if (!std::isfinite(fall)) continue;
      const double ratio = lobe::lampRatio(roughness_, p->position, (eye_ - p->position).normalized(), in_);
      if (fall < kFoot) largest = std::max(largest, ratio);
      if (fall < leastFall) leastFall = fall, nearest = ratio;
    }
  return kReserve * std::max(largest, nearest);
}

std::optional<double> RadianceField::at(const SurfacePoint& p, double floor) const {
  const double seen = (eye_ - p.position).norm();
  if (!(seen > 0)) return std::nullopt;
  const std::optional<double> log =
      lobe::logOfLamp<double>(lobe_, roughness_, p.position, p.normal, (eye_ - p.position) / seen, in_, rule_);
  if (!log || !std::isfinite(*log)) return std::nullopt;
  const double total = *log;
  if (total < floor) return total;
  return hidden(p, seen) ? std::nullopt : std::optional<double>(total);
}

bool RadianceField::hidden(const SurfacePoint& p, double seen) const {
  if (!surface_.occluded(p, occlusionTarget(surface_, p.position, lamp_.centre, seen))) return false;
  const auto ends = lamp_.ends();
  return !ends || (surface_.occluded(p, ends->first) && surface_.occluded(p, ends->second));
}

std::optional<SurfacePoint> RadianceField::visible(const Pixel& p) const {
  const Outcome<SurfacePoint> hit = surface_.firstHit(camera_.ray(p));
  return hit ? std::optional<SurfacePoint>(facing(*hit, eye_)) : std::nullopt;
}

std::optional<double> RadianceField::at(const Pixel& p) const {
  const std::optional<SurfacePoint> hit = visible(p);
  return hit ? at(*hit) : std::nullopt;
}

std::optional<RadiancePeak> RadianceField::climb(Pixel p, double marginPx) const {
  const auto value = [&](const Pixel& q) -> std::optional<double> {
    return depthInImage(q, camera_, marginPx) < 0 ? std::nullopt : at(q);
  };
  std::optional<double> here = value(p);
  if (!here) return std::nullopt;
  double pattern = 4;  // px, of the search without derivatives
  double stride = kFirstStridePx;
  for (int step = 0; step < kMaxSteps && pattern > 1e-4; ++step) {  // px: a maximum at a kink is no better known
    std::optional<double> f[3][3];
    bool whole = true;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        f[i + 1][j + 1] = i == 0 && j == 0 ? here : value(p + kStencilPx * Pixel(i, j));
        whole = whole && f[i + 1][j + 1];
      }
    bool moved = false;
    if (whole) {
      const Eigen::Vector2d gradient(*f[2][1] - *f[0][1], *f[1][2] - *f[1][0]);
      Eigen::Matrix2d hessian;
      hessian(0, 0) = *f[2][1] - 2 * *here + *f[0][1];
      hessian(1, 1) = *f[1][2] - 2 * *here + *f[1][0];
      hessian(0, 1) = hessian(1, 0) = (*f[2][2] - *f[2][0] - *f[0][2] + *f[0][0]) / 4;
      const bool concave = hessian(0, 0) < 0 && hessian.determinant() > 0;
      Eigen::Vector2d move =
          concave ? Eigen::Vector2d(-0.5 * kStencilPx * hessian.ldlt().solve(gradient))
                  : Eigen::Vector2d(gradient.norm() > 0 ? Eigen::Vector2d(stride * gradient.normalized()) : Pixel(0, 0));
      if (move.norm() > kLongestStridePx) move *= kLongestStridePx / move.norm();
      if (concave && move.norm() < kSettledPx) break;
      for (double share = 1; share > 1e-3; share *= 0.5) {  // ten halvings: then the model is wrong, not the step too long
        const std::optional<double> next = value(p + share * move);
        if (!next || !(*next > *here)) continue;
        p += share * move;
        here = next;
        moved = true;
        stride = std::min(share == 1 ? 2 * stride : kFirstStridePx, kLongestStridePx);
        break;
      }
      // Uphill by less than the values' own round-off: this is the top.
      if (!moved && concave && move.norm() < 1e-3) break;
    }
    if (moved) continue;
    // The field ends in the stencil, or has a kink (flat facets): the best of eight neighbours, closer and closer.
    for (; !moved && pattern > 1e-4; pattern *= moved ? 1 : 0.5)
      for (int k = 0; k < 8; ++k) {
        const double a = k * M_PI / 4;
        const Pixel q = p + pattern * Pixel(std::cos(a), std::sin(a));
        const std::optional<double> next = value(q);
        if (!next || !(*next > *here)) continue;
        p = q;
        here = next;
        moved = true;
        break;
      }
  }
  const std::optional<SurfacePoint> point = visible(p);
  if (!point) return std::nullopt;
  RadiancePeak peak{p, *point, *here};
  if (depthInImage(p, camera_, marginPx) < kAtBorderPx) {
    // At the border of the domain: does the field rise outwards?
    Pixel outwards(0, 0);
    for (int i = 0; i < 2; ++i) {
      const double last = (i == 0 ? camera_.width : camera_.height) - 1 + marginPx;
      outwards(i) = p(i) + marginPx < kAtBorderPx ? -1 : last - p(i) < kAtBorderPx ? 1 : 0;
    }
    const std::optional<double> beyond = at(Pixel(p + kFirstStridePx * kStencilPx * outwards));
    peak.cut = beyond && *beyond > *here;
  }
  return peak;
}

double RadianceField::fallOfLobe(const SurfacePoint& p) const {
  const Eigen::Vector3d toCamera = (eye_ - p.position).normalized();
  const Eigen::Vector3d mirrored = reflect(toCamera, p.normal);
  Eigen::Vector3d offset = in_.light.head<3>() - in_.light.w() * p.position;
  if (lamp_.isSegment()) {
    // The segment's point nearest to the mirrored ray.
    const Eigen::Vector3d axis = in_.light.w() * lamp_.halfAxis;
    const Eigen::Vector3d acrossAxis = axis - axis.dot(mirrored) * mirrored, across = offset - offset.dot(mirrored) * mirrored;
    const double squared = acrossAxis.squaredNorm();
    offset += (squared > 0 ? std::clamp(-across.dot(acrossAxis) / squared, -1.0, 1.0) : 0.0) * axis;
  }
  const double apart = std::atan2(offset.cross(mirrored).norm(), offset.dot(mirrored));
  const double extent = std::atan2(lamp_.radius * std::abs(in_.light.w()), offset.norm());
  if (!(apart > extent)) return 0;
  // The light's point nearest to the mirror direction.
  const Eigen::Vector3d turn = offset.cross(mirrored).normalized();
  const Eigen::Vector3d toLight = Eigen::AngleAxisd(extent, turn) * offset.normalized();
  const std::optional<LogRadiance> here = logRadiance(lobe_, roughness_, p.normal, toLight, toCamera);
  const std::optional<LogRadiance> top = logRadiance(lobe_, roughness_, p.normal, p.normal, p.normal);
  return here && top ? top->lobe - here->lobe : std::numeric_limits<double>::infinity();
}

std::vector<RadiancePeak> RadianceField::peaks(const std::vector<Pixel>& starts, double scanStepPx) const {
  std::vector<RadiancePeak> found;
  const auto add = [&](const Pixel& start, double marginPx) {
    const std::optional<RadiancePeak> peak = climb(start, marginPx);
    if (!peak) return;
    for (const RadiancePeak& p : found)
      if ((p.pixel - peak->pixel).norm() < kSamePeakPx) return;
    found.push_back(*peak);
  };
  for (const Pixel& s : starts)
    if (depthInImage(s, camera_, 0) >= 0) add(s, 0);
  if (scanStepPx > 0) {
    std::vector<Pixel> pixels;
    std::vector<Ray> rays;
    const int columns = std::max(1, int(std::ceil((camera_.width - 1) / scanStepPx)));
    const int rows = std::max(1, int(std::ceil((camera_.height - 1) / scanStepPx)));
    for (int y = 0; y <= rows; ++y)
      for (int x = 0; x <= columns; ++x) {
        pixels.emplace_back(double(x) / columns * (camera_.width - 1), double(y) / rows * (camera_.height - 1));
        rays.push_back(camera_.ray(pixels.back()));
      }
    const std::vector<std::optional<SurfacePoint>> hits = surface_.approximateHits(rays);
    std::optional<std::size_t> best;
    double brightest = -std::numeric_limits<double>::infinity();
    for (const RadiancePeak& p : found) brightest = std::max(brightest, p.logRadiance);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i]) continue;
      const std::optional<double> v = at(facing(*hits[i], eye_), brightest);
      if (!v || *v <= brightest) continue;
      brightest = *v;
      best = i;
    }
    if (best) add(pixels[*best], 0);
  }
  const auto brighter = [](const RadiancePeak& a, const RadiancePeak& b) { return a.logRadiance > b.logRadiance; };
  std::stable_sort(found.begin(), found.end(), brighter);
  if (found.empty() || found.front().cut) {
    // The image's border is no maximum: it lies beyond.
    const double margin = kPeakMargin * std::max(camera_.width, camera_.height);
    std::vector<Pixel> from;
    for (const RadiancePeak& p : found)
      if (p.cut) from.push_back(p.pixel);
    for (const Pixel& s : starts)
      if (depthInImage(s, camera_, 0) < 0) from.push_back(s);
    found.erase(std::remove_if(found.begin(), found.end(), [](const RadiancePeak& p) { return p.cut; }), found.end());
    for (const Pixel& p : from) add(p, margin);
    std::stable_sort(found.begin(), found.end(), brighter);
  }
  return found;
}

}  // namespace glint
