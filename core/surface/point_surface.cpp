// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/point_surface.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/surface/height_quadric.h"
#include "core/surface/mesh_topology.h"

namespace glint {
namespace {
using Eigen::Vector3d;

// The smallest determines 6 unknowns twice; each is 1.5 times the one before.
constexpr std::array<int, 6> kFitSizes{12, 18, 27, 40, 60, 90};
constexpr double kAsGood = 1.05;            // a larger fit that predicts within 5 % of the best one has the better normal
constexpr int kProbes = 2000;               // points by which the size of the fits is chosen: the median is then known to 2 %
constexpr double kReach = 1.2;              // h over the distance of the last neighbour, so that it still counts
constexpr double kFar = 5;                  // standard deviations off its neighbours' fit: the point is of something else
constexpr double kFarShare = 0.5;           // of the spacing; at edges a fit misses points by less
constexpr int kStar = 32;                   // neighbours among which a point's triangles are looked for; a star has 6 on average
constexpr int kChunk = 512;                 // points of one piece of parallel work
constexpr double kNormalOfMedian = 1.4826;  // standard deviation of a normal distribution over its median absolute deviation

constexpr const char* kNoFit = "no point has neighbours that determine a surface";

/// Nearest neighbours. PCL's tree is in single precision, on centred and scaled points; distances are computed again in double.
class Neighbours {
 public:
  explicit Neighbours(const PointCloud& cloud) : cloud_(cloud) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : cloud.points) box.extend(p);
    const Vector3d centre = box.center();
    const double size = std::max(box.sizes().norm(), std::numeric_limits<double>::min());
    pcl::PointCloud<pcl::PointXYZ>::Ptr points(new pcl::PointCloud<pcl::PointXYZ>);
    for (const Vector3d& p : cloud.points) {
      const Eigen::Vector3f f = ((p - centre) / size).cast<float>();
      points->emplace_back(f.x(), f.y(), f.z());
    }
    tree_.setInputCloud(points);
  }

  struct Near {
    int index;
    double distance;
  };
  /// The `count` nearest points without the point itself; in a cloud with normals only those of its own side.
  std::vector<Near> of(int index, int count) const {
    const bool sided = !cloud_.normals.empty();
    pcl::Indices found;
    std::vector<float> ignored;
    tree_.nearestKSearch(index, sided ? 2 * count + 1 : count + 1, found, ignored);
    std::vector<Near> near;
    const auto at = static_cast<std::size_t>(index);
    for (const int j : found) {
      const auto other = static_cast<std::size_t>(j);
      if (j == index || (sided && cloud_.normals[at].dot(cloud_.normals[other]) < 0)) continue;
      near.push_back({j, (cloud_.points[other] - cloud_.points[at]).norm()});
    }
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.distance < b.distance; });
    if (near.size() > static_cast<std::size_t>(count)) near.resize(static_cast<std::size_t>(count));
    return near;
  }

 private:
  const PointCloud& cloud_;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

struct Fit {
  bool fitted = false;
  Vector3d place, normal;
  double height = 0;         ///< of the quadric over the point, along the plane's normal
  double slopeVariance = 0;  ///< of both slopes together, for noise of 1
  double leverage = 0;       ///< the same in units of the reach: large where the neighbours hardly determine a slope
};

/// @param withItself  false: the point itself is left out, and `height` is what its neighbours predict it to be off by
Fit fitAt(const PointCloud& cloud, int index, const std::vector<Neighbours::Near>& near, bool withItself) {
  Fit fit;
  const Vector3d centre = cloud.points[static_cast<std::size_t>(index)];
  if (near.size() < static_cast<std::size_t>(kFitSizes.front()) || !(near.back().distance > 0)) return fit;
  const double reach = kReach * near.back().distance;
  const auto weightOf = [&](double r) {
    const double q = 1 - (r / reach) * (r / reach);
    return q * q;
  };
  double sum = 0;
  Vector3d mean = Vector3d::Zero();
  for (const auto& n : near) {
    const double w = weightOf(n.distance);
    sum += w;
    mean += w * (cloud.points[static_cast<std::size_t>(n.index)] - centre);
  }
  mean /= sum;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& n : near) {
    const Vector3d d = cloud.points[static_cast<std::size_t>(n.index)] - centre - mean;
    spread += weightOf(n.distance) * d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Eigen::Matrix3d frame = axes.eigenvectors();  // columns: normal, then the plane
  HeightQuadric quadric(frame, reach);
  for (const auto& n : near) quadric.add(cloud.points[static_cast<std::size_t>(n.index)] - centre, weightOf(n.distance));
  if (withItself) quadric.add(Vector3d::Zero(), 1);
  const std::optional<HeightQuadric::Fitted> fitted = quadric.solve();
  if (!fitted) return fit;
  fit.height = fitted->height;
  fit.place = centre + fit.height * frame.col(0);
  fit.normal = fitted->normal;
  fit.leverage = fitted->leverage;
  fit.slopeVariance = fit.leverage / (reach * reach);
  fit.fitted = fit.place.allFinite() && fit.normal.allFinite() && std::isfinite(fit.slopeVariance);
  return fit;
}

/// A point as its neighbours see it.
struct LeftOut {
  double off = std::numeric_limits<double>::quiet_NaN();  ///< from its neighbours' fit, along the fit's normal; NaN without a fit
  double spacing = 0;                                     ///< see spacingOf
};

/// The side of the square that a point has for itself on a surface, by the distance of the nearest kFitSizes.front() points.
double spacingOf(const std::vector<Neighbours::Near>& near) {
  const std::size_t n = std::min(near.size(), static_cast<std::size_t>(kFitSizes.front()));
  return n == 0 ? 0 : near[n - 1].distance * std::sqrt(M_PI / double(n));
}

/// @param every  n-th point
std::vector<LeftOut> leftOut(const PointCloud& cloud, const Neighbours& tree, int count, int every, const ProgressFn& progress) {
  const int n = static_cast<int>(cloud.points.size()), probes = (n + every - 1) / every, pieces = (probes + kChunk - 1) / kChunk;
  std::vector<LeftOut> all(static_cast<std::size_t>(probes));
  parallelFor(
      pieces,
      [&](int piece) {
        for (int i = piece * kChunk; i < std::min(probes, (piece + 1) * kChunk); ++i) {
          const std::vector<Neighbours::Near> near = tree.of(i * every, count);
          LeftOut& one = all[static_cast<std::size_t>(i)];
          one.spacing = spacingOf(near);
          if (const Fit fit = fitAt(cloud, i * every, near, false); fit.fitted) one.off = std::abs(fit.height);
        }
      },
      progress, "surface of points");
  return all;
}

/// Standard deviation of the points across the surface; nothing if no point has a fit.
std::optional<double> sigmaOf(const std::vector<LeftOut>& all) {
  std::vector<double> off;
  for (const LeftOut& one : all)
    if (std::isfinite(one.off)) off.push_back(one.off);
  if (off.empty()) return std::nullopt;
  return kNormalOfMedian * upperMedian(std::move(off));
}

/// The largest fits that predict points as well as the best.
int chosenSize(const PointCloud& cloud, const Neighbours& tree, const ProgressFn& progress) {
  const int every = std::max(1, static_cast<int>(cloud.points.size()) / kProbes);
  std::array<double, kFitSizes.size()> sigma{};
  for (std::size_t k = 0; k < kFitSizes.size(); ++k)
    sigma[k] = sigmaOf(leftOut(cloud, tree, kFitSizes[k], every, progress)).value_or(std::numeric_limits<double>::infinity());
  const double best = *std::min_element(sigma.begin(), sigma.end());
  int chosen = kFitSizes.front();
  for (std::size_t k = 0; k < kFitSizes.size(); ++k)
    if (sigma[k] <= kAsGood * best) chosen = kFitSizes[k];
  return chosen;
}

/// The cloud without repeated points.
PointCloud withoutRepeats(const PointCloud& cloud) {
  std::vector<std::size_t> order(cloud.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) { return std::array{cloud.points[i].x(), cloud.points[i].y(), cloud.points[i].z()}; };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  std::vector<char> repeats(cloud.points.size());
  for (std::size_t i = 1; i < order.size(); ++i) repeats[order[i]] = key(order[i]) == key(order[i - 1]);
  PointCloud out;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (repeats[i]) continue;
    out.points.push_back(cloud.points[i]);
    if (!cloud.normals.empty()) out.normals.push_back(cloud.normals[i]);
  }
  return out;
}

/// Turns windings and normals to agree, and drops points of no triangle.
TriangleMesh agreeing(TriangleMesh mesh) {
  const MeshTopology topology = topologyOf(mesh);
  std::vector<Vector3d> sums(mesh.vertices.size(), Vector3d::Zero());
  TriangleMesh out;
  std::vector<int> place(mesh.vertices.size(), -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!topology.alive[i]) continue;
    Eigen::Vector3i t = mesh.triangles[i];
    if (topology.turned[i]) std::swap(t.y(), t.z());
    const auto at = [&](int k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    const Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0));
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(t[k]);
      sums[v] += normal;
      if (place[v] < 0) {
        place[v] = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[v]);
        out.normals.push_back(mesh.normals[v]);
      }
    }
    out.triangles.emplace_back(place[static_cast<std::size_t>(t.x())], place[static_cast<std::size_t>(t.y())],
                               place[static_cast<std::size_t>(t.z())]);
  }
  for (std::size_t v = 0; v < sums.size(); ++v)
    if (place[v] >= 0 && sums[v].dot(mesh.normals[v]) < 0) out.normals[static_cast<std::size_t>(place[v])] *= -1;
  return out;
}

/// The steps from the cloud to the surface.
class SurfaceOfPoints {
 public:
  SurfaceOfPoints(const PointCloud& cloud, const PointSurfaceOptions& options, const ProgressFn& progress)
      : options_(options), progress_(progress), cloud_(withoutRepeats(cloud)) {
    facts_.points = cloud.points.size();
  }

  Outcome<PointSurface> make() {
    if (const auto failure = tooFew()) return *failure;
    if (const auto failure = dropOutliers()) return *failure;
    if (const auto failure = tooFew()) return *failure;
    const Neighbours tree(cloud_);
    fitAll(tree);
    if (const auto failure = uncertain()) return *failure;
    mesh_.triangles = trianglesBetween(mesh_.vertices, mesh_.normals, stars_, largest_);
    mesh_ = agreeing(std::move(mesh_));
    facts_.used = mesh_.vertices.size();
    if (mesh_.triangles.empty()) return Failure{Reason::NoSurface, "no points can be joined: " + facts_.text()};
    return PointSurface{std::move(mesh_), facts_};
  }

 private:
  std::optional<Failure> tooFew() const {
    if (cloud_.points.size() >= kFewestPoints) return std::nullopt;
    return Failure{Reason::TooFewPoints,
                   formatted("a surface needs at least %zu points, there are %zu", kFewestPoints, cloud_.points.size())};
  }

  /// Chooses the size of the fits, measures the noise, and leaves out what is far off its neighbours or alone.
  std::optional<Failure> dropOutliers() {
    const Neighbours tree(cloud_);
    facts_.neighbours = options_.neighbours > 0 ? options_.neighbours : chosenSize(cloud_, tree, progress_);
    const std::vector<LeftOut> all = leftOut(cloud_, tree, facts_.neighbours, 1, progress_);
    const std::optional<double> noise = sigmaOf(all);
    if (!noise) return Failure{Reason::TooFewPoints, kNoFit};
    facts_.noise = *noise;
    std::vector<double> spacing;
    for (const LeftOut& one : all) spacing.push_back(one.spacing);
    facts_.spacing = upperMedian(std::move(spacing));
    PointCloud kept;
    for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
      const auto& [off, apart] = all[i];
      if (!std::isfinite(off) || (off > kFar * facts_.noise && off > kFarShare * apart)) continue;
      kept.points.push_back(cloud_.points[i]);
      if (!cloud_.normals.empty()) kept.normals.push_back(cloud_.normals[i]);
    }
    cloud_ = std::move(kept);
    return std::nullopt;
  }

  void fitAll(const Neighbours& tree) {
    const int n = static_cast<int>(cloud_.points.size());
    const auto size = static_cast<std::size_t>(n);
    std::vector<Fit> fits(size);
    std::vector<double> doubt(size);
    stars_.resize(size);
    largest_.resize(size);
    parallelFor((n + kChunk - 1) / kChunk,
                [&](int piece) {
                  for (int i = piece * kChunk; i < std::min(n, (piece + 1) * kChunk); ++i) {
                    const auto at = static_cast<std::size_t>(i);
                    const std::vector<Neighbours::Near> near = tree.of(i, std::max(kFitSizes.back(), facts_.neighbours));
                    for (std::size_t k = 0; k < near.size() && k < std::size_t(kStar); ++k) stars_[at].push_back(near[k].index);
                    largest_[at] = options_.largestHole * spacingOf(near);
                    fits[at] = steadyFit(i, near);
                    doubt[at] = doubtOf(i, near, fits[at]);
                  }
                },
                progress_, "surface of points");
    for (std::size_t i = 0; i < size; ++i) {
      const Fit& fit = fits[i];
      if (!fit.fitted) largest_[i] = 0;  // no triangle of its own
      mesh_.vertices.push_back(fit.fitted ? fit.place : cloud_.points[i]);
      mesh_.normals.push_back(fit.fitted ? fit.normal : Vector3d::UnitZ().eval());
      if (fit.fitted) doubts_.push_back(doubt[i] * 180 / M_PI);
    }
    for (std::size_t i = 0; i < size; ++i)
      std::erase_if(stars_[i], [&](int j) { return !fits[static_cast<std::size_t>(j)].fitted; });
  }

  static std::vector<Neighbours::Near> first(const std::vector<Neighbours::Near>& near, int count) {
    return {near.begin(), near.begin() + std::min<std::ptrdiff_t>(count, std::ssize(near))};
  }

  /// The fit of the chosen size, or of the next larger one whose neighbours determine the slopes: the neighbours of the smallest
  /// may lie on a conic.
  Fit steadyFit(int i, const std::vector<Neighbours::Near>& near) const {
    constexpr double kSteady = 4;  // leverage; a dozen neighbours all around have 0.5 to 1
    Fit fit = fitAt(cloud_, i, first(near, facts_.neighbours), true);
    for (const int size : kFitSizes)
      if (size > facts_.neighbours && !(fit.fitted && fit.leverage < kSteady)) fit = fitAt(cloud_, i, first(near, size), true);
    fit.fitted = fit.fitted && fit.leverage < kSteady;
    return fit;
  }

  /// Standard deviation of a normal, rad: by the noise, and by how it differs from that of a fit of another size, where the
  /// surface is no quadric as far as the fits reach. (Nested fits differ by noise, too, at most by that of the smaller one.)
  double doubtOf(int i, const std::vector<Neighbours::Near>& near, const Fit& fit) const {
    if (!fit.fitted) return 0;
    const int other = facts_.neighbours == kFitSizes.front() ? kFitSizes[1] : std::max(kFitSizes.front(), facts_.neighbours / 2);
    const Fit second = fitAt(cloud_, i, first(near, other), true);
    const double byNoise = facts_.noise * facts_.noise * fit.slopeVariance;
    if (!second.fitted) return std::sqrt(byNoise);
    const double turn = fit.normal.cross(second.normal).norm();
    const double expected = facts_.noise * facts_.noise * std::abs(second.slopeVariance - fit.slopeVariance);
    return std::sqrt(byNoise + std::max(0.0, turn * turn - expected));
  }

  std::optional<Failure> uncertain() {
    if (doubts_.empty()) return Failure{Reason::TooFewPoints, kNoFit};
    facts_.normalSigmaDeg = upperMedian(doubts_);
    facts_.used = cloud_.points.size();
    if (facts_.normalSigmaDeg <= options_.mostNormalSigmaDeg) return std::nullopt;
    return Failure{Reason::NoSurface,
                   formatted("the normals are uncertain by %.1f degrees, more than %.1f: the points are too few or "
                             "too noisy for reflections; ",
                             facts_.normalSigmaDeg, options_.mostNormalSigmaDeg) +
                       facts_.text()};
  }

  PointSurfaceOptions options_;
  const ProgressFn& progress_;
  PointCloud cloud_;
  PointSurfaceFacts facts_;
  TriangleMesh mesh_;
  std::vector<std::vector<int>> stars_;
  std::vector<double> largest_, doubts_;
};

}  // namespace

std::string PointSurfaceFacts::text() const {
  return formatted(
      "%zu points, %zu of them used, %.3g m apart, noise %.2g m, normals uncertain by %.2g degrees, fits of %d points", points,
      used, spacing, noise, normalSigmaDeg, neighbours);
}

Outcome<PointSurface> surfaceOfPoints(const PointCloud& cloud, const PointSurfaceOptions& options, const ProgressFn& progress) {
  require(cloud.normals.empty() || cloud.normals.size() == cloud.points.size(),
          "surfaceOfPoints: as many normals as points, or none");
  require(options.neighbours == 0 || options.neighbours >= kFitSizes.front(), "surfaceOfPoints: a fit needs at least 12 points");
  require(options.largestHole > 0 && options.mostNormalSigmaDeg > 0, "surfaceOfPoints: limits must be positive");
  for (const Vector3d& p : cloud.points)
    if (!p.allFinite()) return Failure{Reason::NotFinite, "a point of the cloud"};
  return SurfaceOfPoints(cloud, options, progress).make();
}

}  // namespace glint
