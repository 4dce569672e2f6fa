// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/registration_starts.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <utility>

#include "core/base/evenly.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"

namespace glint {
namespace {
using Eigen::Vector3d;

// Lengths in this file are in radii of the mesh (root mean square) about its mean, unless stated.
constexpr int kCells = 40;     // of the grid along each side: a fifteenth of a radius, less than a start is off
constexpr int kPatches = 100;  // of the mesh: so many places can be told apart by points that hit them
constexpr int kTurns = 360;    // over all rotations: each is then within 30 degrees of one, from where closest points converge
constexpr int kPointsOfStart = 250;      // of a part of the cloud
constexpr int kSteps = 10;               // of closest points; the rest is done by registerMesh
constexpr double kFirstReach = 0.6;      // a point farther from the mesh than this is of something else, at first ...
constexpr double kLastReach = 0.15;      // ... and in the end
constexpr double kHit = 0.1;             // a point this near to the mesh lies on it, as far as a start can say
constexpr std::size_t kMostStarts = 48;  // handed on
constexpr std::array<double, 8> kShares{0.15, 0.25, 0.35, 0.45, 0.55, 0.7, 0.85, 1.0};  // of the cloud, around a centre
constexpr std::array<double, 2> kSharesOfPlaces{0.25, 0.45};                            // the same around places of the object
constexpr std::array<double, 3> kSizes{0.75, 1.0, 1.35};  // of the part's radius: one side of an object is smaller than the whole

/// The nearest sample of each cell of a grid: closest points in a few nanoseconds.
class NearestGrid {
 public:
  explicit NearestGrid(const MeshSamples& mesh) {
    for (const Vector3d& p : mesh.points()) scaled_.push_back((p - mesh.mean()) / mesh.radius());
    double most = 0;
    for (const Vector3d& p : scaled_) most = std::max(most, p.cwiseAbs().maxCoeff());
    half_ = most + 2 * kFirstReach;
    cells_.resize(std::size_t(kCells) * kCells * kCells);
    parallelFor(
        kCells,
        [&](int i) {
          for (int j = 0; j < kCells; ++j)
            for (int k = 0; k < kCells; ++k) {
              const Vector3d centre = half_ * ((Vector3d(i, j, k) + Vector3d::Constant(0.5)) * (2.0 / kCells) - Vector3d::Ones());
              cells_[at(i, j, k)] = mesh.nearest(mesh.mean() + mesh.radius() * centre, 1).front();
            }
        },
        {}, "");
    patchesOf();
  }
  /// Index of about the nearest sample; -1 outside.
  int nearest(const Vector3d& p) const {
    const Eigen::Array3d cell = (p.array() / half_ + 1) * (kCells / 2.0);
    if (!((cell >= 0).all() && (cell < kCells).all())) return -1;
    return cells_[at(int(cell.x()), int(cell.y()), int(cell.z()))];
  }
  const Vector3d& sample(int index) const { return scaled_[std::size_t(index)]; }
  int patch(int index) const { return patches_[std::size_t(index)]; }

 private:
  static std::size_t at(int i, int j, int k) { return (std::size_t(i) * kCells + std::size_t(j)) * kCells + std::size_t(k); }
  /// Each sample belongs to the nearest of seeds that lie as far apart as they can.
  void patchesOf() {
    std::vector<double> distance(scaled_.size(), std::numeric_limits<double>::max());
    patches_.assign(scaled_.size(), 0);
    std::size_t seed = 0;
    for (int n = 0; n < kPatches; ++n) {
      for (std::size_t i = 0; i < scaled_.size(); ++i) {
        const double d = (scaled_[i] - scaled_[seed]).squaredNorm();
        if (d < distance[i]) distance[i] = d, patches_[i] = n;
      }
      seed = std::size_t(std::max_element(distance.begin(), distance.end()) - distance.begin());
    }
  }
  double half_ = 0;
  std::vector<Vector3d> scaled_;
  std::vector<int> cells_, patches_;
};

/// Rotations spread evenly. @see Alexa, Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3), CVPR 2022.
std::vector<Eigen::Matrix3d> turns() {
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;
  std::vector<Eigen::Matrix3d> all;
  for (int i = 0; i < kTurns; ++i) {
    const double s = i + 0.5, r = std::sqrt(s / kTurns), big = std::sqrt(1 - s / kTurns);
    const double alpha = 2 * EIGEN_PI * s / phi, beta = 2 * EIGEN_PI * s / psi;
    all.push_back(Eigen::Quaterniond(big * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha), big * std::sin(beta))
                      .normalized()
                      .toRotationMatrix());
  }
  return all;
}

/// A part of the cloud that may be the object: mean and radius say where and how large it is. In the unit of the cloud.
struct Part {
  Vector3d mean;
  double radius = 0;
  std::vector<Vector3d> points;
};

/// What the cameras look at (the place nearest to all lines between points and mean eyes), and the middle of the points.
std::vector<Vector3d> centresOf(const std::vector<SeenPoint>& points) {
  std::array<std::vector<double>, 3> values;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const SeenPoint& p : points) {
    for (int k = 0; k < 3; ++k) values[std::size_t(k)].push_back(p.point[k]);
    const Vector3d d = p.point - p.eye;
    if (!(d.norm() > 0)) continue;
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d.normalized() * d.normalized().transpose();
    normal += across;
    right += across * p.eye;
  }
  std::vector<Vector3d> centres{{upperMedian(values[0]), upperMedian(values[1]), upperMedian(values[2])}};
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  if (solver.info() == Eigen::Success && solver.rcond() > 1e-4)  // the eyes are not all in one place
    centres.push_back(solver.solve(right));
  return centres;
}

/// Points of the inner half of the cloud, each as far as possible from those before. Where the mesh or the points show only a
/// part of the object, the middle of one lies elsewhere on the other.
std::vector<Vector3d> placesOf(const std::vector<SeenPoint>& points, const Vector3d& centre) {
  constexpr int kPlaces = 6;  // as the faces of a cube
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i) order.emplace_back((points[i].point - centre).squaredNorm(), i);
  std::sort(order.begin(), order.end());
  order.resize((order.size() + 1) / 2);
  std::vector<Vector3d> places{points[order.back().second].point};
  while (places.size() < kPlaces) {
    double most = -1;
    Vector3d next = places.front();
    for (const auto& [ignored, i] : order) {
      double least = std::numeric_limits<double>::max();
      for (const Vector3d& place : places) least = std::min(least, (points[i].point - place).squaredNorm());
      if (least > most) most = least, next = points[i].point;
    }
    places.push_back(next);
  }
  return places;
}

void addParts(const std::vector<SeenPoint>& points, const Vector3d& centre, std::span<const double> shares,
              std::vector<Part>& parts) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < points.size(); ++i) order.emplace_back((points[i].point - centre).squaredNorm(), i);
  std::sort(order.begin(), order.end());
  for (const double share : shares) {
    const std::size_t n = std::min(points.size(), std::max<std::size_t>(10, std::size_t(share * double(points.size()))));
    Part part;
    part.mean.setZero();
    std::vector<Vector3d> inside;
    for (std::size_t i = 0; i < n; ++i) inside.push_back(points[order[i].second].point);
    for (const Vector3d& p : inside) part.mean += p / double(n);
    for (const Vector3d& p : inside) part.radius += (p - part.mean).squaredNorm() / double(n);
    part.radius = std::sqrt(part.radius);
    part.points = evenly(inside, kPointsOfStart);
    if (part.radius > 0) parts.push_back(std::move(part));
  }
}

std::vector<Part> partsOf(const std::vector<SeenPoint>& points) {
  std::vector<Part> parts;
  const std::vector<Vector3d> centres = centresOf(points);
  for (const Vector3d& centre : centres) addParts(points, centre, kShares, parts);
  for (const Vector3d& place : placesOf(points, centres.back())) addParts(points, place, kSharesOfPlaces, parts);
  return parts;
}

/// x -> scale rotation x + shift from corresponding points, by their sums. The scale is the ratio of the spreads (Horn 1987),
/// which closest points shrink less than least squares would.
class Correspondences {
 public:
  void add(const Vector3d& from, const Vector3d& to) {
    n_ += 1, from_ += from, to_ += to, product_ += to * from.transpose();
    fromSquares_ += from.squaredNorm(), toSquares_ += to.squaredNorm();
  }
  double count() const { return n_; }
  bool solve(Similarity& out) const {
    const Vector3d a = from_ / n_, b = to_ / n_;
    const double spreadA = fromSquares_ / n_ - a.squaredNorm(), spreadB = toSquares_ / n_ - b.squaredNorm();
    if (!(spreadA > 0) || !(spreadB > 0)) return false;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(product_ / n_ - b * a.transpose(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
    sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    out.rotation = svd.matrixU() * sign * svd.matrixV().transpose();
    out.scale = std::sqrt(spreadB / spreadA);
    out.translation = b - out.scale * out.rotation * a;
    return true;
  }

 private:
  double n_ = 0, fromSquares_ = 0, toSquares_ = 0;
  Vector3d from_ = Vector3d::Zero(), to_ = Vector3d::Zero();
  Eigen::Matrix3d product_ = Eigen::Matrix3d::Zero();
};

struct Start {
  Similarity meshFromPoints;  ///< to the scaled mesh
  double score = 0;
};

/// Closest points; the score counts places of the mesh that are hit, so that a cloud that shrinks onto one place gains nothing.
Start improved(const NearestGrid& grid, const Part& part, const std::vector<Vector3d>& cloud, Similarity t) {
  constexpr double kFewest = 8;  // correspondences: fewer would fit anything
  for (int step = 0; step < kSteps; ++step) {
    const double reach = kFirstReach * std::pow(kLastReach / kFirstReach, double(step) / (kSteps - 1));
    Correspondences pairs;
    for (const Vector3d& p : part.points) {
      const Vector3d q = t * p;
      const int near = grid.nearest(q);
      if (near >= 0 && (grid.sample(near) - q).squaredNorm() < reach * reach) pairs.add(p - part.mean, grid.sample(near));
    }
    if (pairs.count() < kFewest || !pairs.solve(t)) return {};
    t.translation -= t.scale * (t.rotation * part.mean);
  }
  std::array<bool, kPatches> hit{};
  int on = 0;
  for (const Vector3d& p : cloud) {
    const Vector3d q = t * p;
    const int near = grid.nearest(q);
    if (near < 0 || (grid.sample(near) - q).squaredNorm() > kHit * kHit) continue;
    hit[std::size_t(grid.patch(near))] = true;
    ++on;
  }
  const double places = double(std::count(hit.begin(), hit.end(), true));
  return {t, places * std::sqrt(double(on) / double(cloud.size()))};
}

/// The best starts, each unlike those before it.
std::vector<Similarity> chosen(std::vector<Start> starts, const MeshSamples& mesh) {
  constexpr double kUnlike = 0.15;  // radii that some corner of the mesh's box moves
  std::stable_sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.score > b.score; });
  const Similarity scaledFromMesh{1 / mesh.radius(), Eigen::Matrix3d::Identity(), -mesh.mean() / mesh.radius()};
  std::vector<Similarity> kept;  // from the scaled mesh
  for (const Start& s : starts) {
    if (!(s.score > 0) || kept.size() == kMostStarts) break;
    const auto alike = [&](const Similarity& other) {
      const Similarity move = s.meshFromPoints * other;
      double most = 0;
      for (int k = 0; k < 3; ++k)
        for (const double side : {-1.0, 1.0}) {
          const Vector3d corner = side * Vector3d::Unit(k);
          most = std::max(most, (move * corner - corner).norm());
        }
      return most < kUnlike;
    };
    if (std::none_of(kept.begin(), kept.end(), alike)) kept.push_back(s.meshFromPoints.inverse());
  }
  for (Similarity& s : kept) s = s * scaledFromMesh;
  return kept;
}

}  // namespace

/// In single precision: the search for the exact nearest point begins at its result.
struct MeshSamples::Tree : pcl::KdTreeFLANN<pcl::PointXYZ> {};

MeshSamples::MeshSamples(const TriangleMesh& mesh, int count) {
  std::vector<double> sums;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])],
                   &c = mesh.vertices[std::size_t(t[2])];
    area_ += (b - a).cross(c - a).norm() / 2;
    sums.push_back(area_);
  }
  require(area_ > 0, "MeshSamples: no triangle has an area");
  std::mt19937_64 rng(1);
  const auto uniform = [&rng] { return double(rng() >> 11) * 0x1p-53; };
  for (int i = 0; i < count; ++i) {  // one in each of `count` equal parts of the area
    const auto at = std::upper_bound(sums.begin(), sums.end(), area_ * (i + uniform()) / count);
    const std::size_t triangle = std::min(std::size_t(at - sums.begin()), sums.size() - 1);
    const Eigen::Vector3i& t = mesh.triangles[triangle];
    double u = uniform(), v = uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vector3d& a = mesh.vertices[std::size_t(t[0])];
    points_.push_back(a + u * (mesh.vertices[std::size_t(t[1])] - a) + v * (mesh.vertices[std::size_t(t[2])] - a));
    triangles_.push_back(int(triangle));
  }
  for (const Vector3d& p : points_) mean_ += p / count;
  for (const Vector3d& p : points_) radius_ += (p - mean_).squaredNorm() / count;
  radius_ = std::sqrt(radius_);
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const Vector3d& p : points_) {
    const Eigen::Vector3f f = ((p - mean_) / radius_).cast<float>();
    cloud->emplace_back(f.x(), f.y(), f.z());
  }
  constexpr float kEpsilon = 0.1F;  // a tenth farther than the nearest one serves as well, and is found much sooner
  const auto tree = std::make_shared<Tree>();
  tree->setEpsilon(kEpsilon);
  tree->setInputCloud(cloud);
  tree_ = tree;
}

std::vector<int> MeshSamples::nearest(const Vector3d& p, int count) const {
  const Eigen::Vector3f f = ((p - mean_) / radius_).cast<float>();
  pcl::Indices found;
  std::vector<float> ignored;
  tree_->nearestKSearch(pcl::PointXYZ(f.x(), f.y(), f.z()), count, found, ignored);
  return {found.begin(), found.end()};
}

std::vector<Similarity> registrationStarts(const MeshSamples& mesh, const std::vector<SeenPoint>& points,
                                           const ProgressFn& progress) {
  const NearestGrid grid(mesh);
  const std::vector<Part> parts = partsOf(points);
  const std::vector<Eigen::Matrix3d> rotations = turns();
  std::vector<Vector3d> cloud;
  for (const SeenPoint& p : points) cloud.push_back(p.point);
  cloud = evenly(cloud, std::size_t(2 * kPointsOfStart));
  std::vector<Start> starts(parts.size() * kSizes.size() * rotations.size());
  parallelFor(
      static_cast<int>(parts.size()),
      [&](int i) {
        const Part& part = parts[std::size_t(i)];
        std::size_t at = std::size_t(i) * kSizes.size() * rotations.size();
        for (const double size : kSizes)
          for (const Eigen::Matrix3d& r : rotations) {
            Similarity t{1 / (size * part.radius), r, Vector3d::Zero()};
            t.translation = -t.scale * (r * part.mean);
            starts[at++] = improved(grid, part, cloud, t);
          }
      },
      progress, "mesh in the cameras' frame");
  return chosen(std::move(starts), mesh);
}

}  // namespace glint
