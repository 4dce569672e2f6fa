// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_fusion.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/numeric.h"
#include "core/base/outcome.h"
#include "core/surface/depth_filter.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr int kPatchPx = 16;  // the noise of a patch's mean is a tenth of a pixel's or less, also where rounding correlates it
constexpr int kLeastInPatch = 64;       // pixels: a quarter of a patch
constexpr int kLeastPatches = 8;        // fewer say little about a whole object
constexpr double kStill = 1e-3;         // of the depth: what calibrated poses and a renderer's depth leave between frames
constexpr double kSlanted = 0.3;        // cosine: a surface seen more slantwise has more error than it adds
constexpr double kMostWeight = 4;       // of another view over that of the own one: beyond it the noise model cannot be trusted
constexpr double kSigmaOfMad = 1.4826;  // standard deviation of a Gaussian over its median absolute deviation

/// A point of the view with its normal, world frame.
struct FusionSeed {
  int pixel;
  Vector3d point, normal, ray;  ///< ray: per metre of depth
};

std::vector<FusionSeed> fusionSeedsOf(const SmoothDepth& smooth, const Camera& camera) {
  std::vector<FusionSeed> seeds;
  const Eigen::Isometry3d worldFromCam = camera.camFromWorld.inverse();
  for (int y = 0; y < smooth.depth.height; ++y)
    for (int x = 0; x < smooth.depth.width; ++x) {
      const int pixel = y * smooth.depth.width + x;
      const Vector3d& n = smooth.normals[static_cast<std::size_t>(pixel)];
      const double z = smooth.depth.at(x, y);
      if (!(z > 0) || n.isZero()) continue;
      const Pixel ideal = camera.undistorted(Pixel(x, y));
      const Vector3d ray = camera.pixelFromRay.triangularView<Eigen::Upper>().solve(ideal.homogeneous());
      if (!ray.allFinite() || !(-n.dot(ray.normalized()) > kSlanted)) continue;
      seeds.push_back({pixel, worldFromCam * Vector3d(z / ray.z() * ray), worldFromCam.linear() * n,
                       worldFromCam.linear() * Vector3d(ray / ray.z())});
    }
  return seeds;
}

/// What another map says at a seed: how far along the view's ray its surface lies, and how much that counts.
struct Shift {
  double metres = 0, alongNormal = 0, weight = 0;
};

std::optional<Shift> shiftAt(const FusionSeed& seed, const DepthView& other, double ownDepth, double radius) {
  const std::optional<Pixel> ideal = other.camera.project(seed.point);
  if (!ideal) return std::nullopt;
  const Pixel p = other.camera.distorted(*ideal);
  if (!p.allFinite()) return std::nullopt;
  const double x = std::round(p.x()), y = std::round(p.y());
  if (!(x >= 0 && y >= 0 && x < other.depth.width && y < other.depth.height)) return std::nullopt;
  const double z = other.depth.at(static_cast<int>(x), static_cast<int>(y));
  if (!(std::isfinite(z) && z > 0)) return std::nullopt;
  // The measured point at the pixel's centre lies on the surface. Its distance from the tangent plane is wanted.
  const Pixel centre = other.camera.undistorted(Pixel(x, y));
  if (!centre.allFinite()) return std::nullopt;
  const Ray ray = other.camera.ray(centre);
  const double cosine = -seed.normal.dot(ray.direction);
  if (!(cosine > kSlanted)) return std::nullopt;
  const double perDepth = (other.camera.camFromWorld.linear() * ray.direction).z();
  if (!(perDepth > 0)) return std::nullopt;
  Shift shift;
  shift.alongNormal = seed.normal.dot(ray.at(z / perDepth) - seed.point);
  if (!(std::abs(shift.alongNormal) < radius)) return std::nullopt;
  const double own = seed.normal.dot(seed.ray);  // below 0
  shift.metres = shift.alongNormal / own;
  const double ratio = (ownDepth * ownDepth) / (z * z) * own / seed.normal.dot(ray.direction / perDepth);
  shift.weight = std::min(kMostWeight, ratio * ratio);
  return shift;
}

/// Distances of one other view at all seeds, and whether they are those of a still object.
struct Agreement {
  std::vector<std::optional<Shift>> shifts;  ///< one per seed
  int patches = 0;
  double noise = 0, patchRms = 0;  ///< m, along the normals
};

Agreement agreementOf(const std::vector<FusionSeed>& seeds, const Image& ownDepth, const DepthView& other, double radius) {
  Agreement a;
  const int across = (ownDepth.width + kPatchPx - 1) / kPatchPx, down = (ownDepth.height + kPatchPx - 1) / kPatchPx;
  std::vector<std::vector<double>> patches(static_cast<std::size_t>(across) * down);
  for (const FusionSeed& seed : seeds) {
    const int x = seed.pixel % ownDepth.width, y = seed.pixel / ownDepth.width;
    a.shifts.push_back(shiftAt(seed, other, ownDepth.at(x, y), radius));
    if (a.shifts.back())
      patches[static_cast<std::size_t>(y / kPatchPx) * across + x / kPatchPx].push_back(a.shifts.back()->alongNormal);
  }
  std::vector<double> deviations;
  double sum = 0;
  for (const std::vector<double>& patch : patches) {
    if (static_cast<int>(patch.size()) < kLeastInPatch) continue;
    double mean = 0;
    for (const double v : patch) mean += v / double(patch.size());
    for (const double v : patch) deviations.push_back(std::abs(v - mean));
    sum += mean * mean;
    ++a.patches;
  }
  if (a.patches == 0) return a;
  a.patchRms = std::sqrt(sum / a.patches);
  a.noise = kSigmaOfMad * upperMedian(std::move(deviations));
  return a;
}

}  // namespace

FusedDepth fusedDepth(const Image& own, const Camera& camera, const std::vector<DepthView>& others, double radius) {
  require(own.channels == 1 && own.width == camera.width && own.height == camera.height && radius > 0,
          "fusedDepth: one channel, the camera's size and a positive radius expected");
  FusedDepth result{own, {}, {}, {}, 0};
  for (float& z : result.depth.data)
    if (!(std::isfinite(z) && z > 0)) z = 0;
  const SmoothDepth smooth = fittedDepth(result.depth, camera, radius);
  const std::vector<FusionSeed> seeds = fusionSeedsOf(smooth, camera);
  std::vector<double> sum(seeds.size(), 0), weight(seeds.size(), 0);
  for (const DepthView& other : others) {
    const Agreement a = agreementOf(seeds, smooth.depth, other, radius);
    if (a.patches < kLeastPatches) {
      result.unseen.push_back(other.id);
      continue;
    }
    if (a.patchRms > std::max(a.noise, kStill * medianDepth(smooth.depth))) {
      result.refused.push_back(other.id);
      result.disagreementM = std::max(result.disagreementM, a.patchRms);
      continue;
    }
    result.used.push_back(other.id);
    for (std::size_t i = 0; i < seeds.size(); ++i)
      if (a.shifts[i]) {
        sum[i] += a.shifts[i]->weight * a.shifts[i]->metres;
        weight[i] += a.shifts[i]->weight;
      }
  }
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    if (!(weight[i] > 0)) continue;
    float& z = result.depth.data[static_cast<std::size_t>(seeds[i].pixel)];
    const double start = smooth.depth.data[static_cast<std::size_t>(seeds[i].pixel)];
    const double fused = start + (z - start + sum[i]) / (1 + weight[i]);
    if (fused > 0) z = static_cast<float>(fused);
  }
  return result;
}

}  // namespace glint
