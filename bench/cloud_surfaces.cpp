// SPDX-License-Identifier: BSD-3-Clause
// Ways from a cloud of points to a surface, against the shape on which the points were drawn: the table in docs/captures.md,
// which docs/make_clouds.py writes with what this prints. One line of JSON for each cloud and way.
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <random>
#include <string>

#include "core/surface/mesh.h"
#include "core/surface/point_surface.h"

namespace glint {
namespace {
using Eigen::Vector3d;

constexpr int kPoints = 20000, kRays = 2000;
constexpr double kSphere = 0.5, kAround = 0.4, kTube = 0.16;  // m: radii of the sphere, and of the torus about z
constexpr double kReach = 0.03;  // m before the shape, where rays begin: nothing else of it lies there

struct Shape {
  std::string name;
  double area;
  std::function<Vector3d(std::mt19937_64&)> point;  ///< on it, evenly over its area
  std::function<Vector3d(const Vector3d&)> normal;  ///< outwards, where a point near it lies
};

Vector3d direction(std::mt19937_64& rng) {
  std::normal_distribution<double> gauss;
  return Vector3d(gauss(rng), gauss(rng), gauss(rng)).normalized();
}

Shape sphere() {
  return {"sphere", 4 * M_PI * kSphere * kSphere, [](std::mt19937_64& rng) { return Vector3d(kSphere * direction(rng)); },
          [](const Vector3d& p) { return p.normalized(); }};
}

Shape torus() {
  const auto spine = [](const Vector3d& p) { return Vector3d(kAround * Vector3d(p.x(), p.y(), 0).normalized()); };
  return {"torus", 4 * M_PI * M_PI * kAround * kTube,
          [](std::mt19937_64& rng) {
            std::uniform_real_distribution<double> turn(0, 2 * M_PI), uniform;
            double v = turn(rng);  // the area grows with the distance from the axis
            while (uniform(rng) * (kAround + kTube) > kAround + kTube * std::cos(v)) v = turn(rng);
            const double u = turn(rng), r = kAround + kTube * std::cos(v);
            return Vector3d(r * std::cos(u), r * std::sin(u), kTube * std::sin(v));
          },
          [spine](const Vector3d& p) { return (p - spine(p)).normalized(); }};
}

/// Towards random places of the shape, within 45 degrees of the normal there.
struct Sight {
  Ray ray;
  Vector3d target;
};
std::vector<Sight> sightsOf(const Shape& shape) {
  std::mt19937_64 rng(7);
  std::vector<Sight> sights;
  while (sights.size() < kRays) {
    const Vector3d p = shape.point(rng), n = shape.normal(p), d = direction(rng);
    if (d.dot(n) < std::sqrt(0.5)) continue;
    sights.push_back({{p + kReach * d, -d}, p});
  }
  return sights;
}

struct Result {
  int missed = 0;
  double squares = 0, seconds = 0;
  void take(const Shape& shape, const std::optional<SurfacePoint>& hit, const Vector3d& target, double spacing) {
    if (!hit || (hit->position - target).norm() > 3 * spacing) {  // through a hole to the other side
      ++missed;
      return;
    }
    const double cosine = std::min(1.0, std::abs(hit->normal.dot(shape.normal(hit->position))));
    squares += std::pow(std::acos(cosine) * 180 / M_PI, 2);
  }
};

template <class Hit>
Result measured(const Shape& shape, const std::vector<Sight>& sights, double spacing, const Hit& hit) {
  Result r;
  std::vector<std::optional<SurfacePoint>> hits;
  const auto start = std::chrono::steady_clock::now();
  for (const Sight& s : sights) hits.push_back(hit(s.ray));
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (std::size_t i = 0; i < hits.size(); ++i) r.take(shape, hits[i], sights[i].target, spacing);
  return r;
}

Result onMesh(const Shape& shape, const std::vector<Sight>& sights, double spacing, const TriangleMesh& mesh,
              NormalPolicy normals) {
  const std::shared_ptr<const Surface> surface = makeMesh(mesh, MeshPolicy{normals});
  return measured(shape, sights, spacing, [&](const Ray& ray) -> std::optional<SurfacePoint> {
    const Outcome<SurfacePoint> hit = surface->firstHit(ray);
    return hit ? std::optional(*hit) : std::nullopt;
  });
}

class Nearest {
 public:
  explicit Nearest(const std::vector<Vector3d>& points) : points_(points) {
    pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    for (const Vector3d& p : points) cloud->emplace_back(float(p.x()), float(p.y()), float(p.z()));
    tree_.setInputCloud(cloud);
  }
  std::vector<int> to(const Vector3d& p, int count) const {
    pcl::Indices found;
    std::vector<float> ignored;
    tree_.nearestKSearch(pcl::PointXYZ(float(p.x()), float(p.y()), float(p.z())), count, found, ignored);
    return {found.begin(), found.end()};
  }
  const std::vector<Vector3d>& points() const { return points_; }

 private:
  const std::vector<Vector3d>& points_;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

/// Where the ray meets the moving least squares surface: the quadric fitted to the neighbours of where it is now, met again and
/// again. The fit is that of core/surface/point_surface.h. @see Adamson and Alexa, Ray tracing point set surfaces, SMI 2003.
std::optional<SurfacePoint> onMovingLeastSquares(const Nearest& cloud, int neighbours, const Ray& ray, double begin) {
  constexpr int kMostSteps = 20;
  Vector3d at = ray.origin + begin * ray.direction, normal = -ray.direction;
  for (int step = 0; step < kMostSteps; ++step) {
    const std::vector<int> near = cloud.to(at, neighbours);
    const double h = (cloud.points()[std::size_t(near.back())] - at).norm();
    Vector3d mean = Vector3d::Zero();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const int i : near) mean += cloud.points()[std::size_t(i)] / double(near.size());
    for (const int i : near) {
      const Vector3d d = cloud.points()[std::size_t(i)] - mean;
      spread += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> plane(spread);
    const Vector3d z = plane.eigenvectors().col(0), x = plane.eigenvectors().col(1), y = z.cross(x);
    Eigen::Matrix<double, 6, 6> normals = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (const int i : near) {
      const Vector3d d = cloud.points()[std::size_t(i)] - at;
      const double u = d.dot(x) / h, v = d.dot(y) / h, w = std::pow(std::max(0.0, 1 - d.squaredNorm() / (h * h)), 2);
      Eigen::Matrix<double, 6, 1> row;
      row << 1, u, v, u * u, u * v, v * v;
      normals += w * row * row.transpose();
      right += w * d.dot(z) / h * row;
    }
    const Eigen::Matrix<double, 6, 1> c = normals.ldlt().solve(right);
    if (!c.allFinite()) return std::nullopt;
    normal = (z - c[1] * x - c[2] * y).normalized();
    const double slope = ray.direction.dot(z - c[1] * x - c[2] * y);
    if (std::abs(slope) < 1e-3) return std::nullopt;
    const double move = c[0] * h / slope;
    at += move * ray.direction;
    if (std::abs(move) < 1e-6 * h) return SurfacePoint{at, normal};
  }
  return std::nullopt;
}

TriangleMesh greedy(const TriangleMesh& fitted, double spacing) {
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud(new pcl::PointCloud<pcl::PointNormal>);
  for (std::size_t i = 0; i < fitted.vertices.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = fitted.vertices[i].cast<float>();
    p.getNormalVector3fMap() = fitted.normals[i].cast<float>();
    cloud->push_back(p);
  }
  pcl::search::KdTree<pcl::PointNormal>::Ptr tree(new pcl::search::KdTree<pcl::PointNormal>);
  tree->setInputCloud(cloud);
  pcl::GreedyProjectionTriangulation<pcl::PointNormal> maker;  // angles and neighbours as in PCL's tutorial
  maker.setSearchRadius(4 * spacing);
  maker.setMu(2.5);
  maker.setMaximumNearestNeighbors(100);
  maker.setMaximumSurfaceAngle(M_PI / 4);
  maker.setMinimumAngle(M_PI / 18);
  maker.setMaximumAngle(2 * M_PI / 3);
  maker.setNormalConsistency(false);
  maker.setInputCloud(cloud);
  maker.setSearchMethod(tree);
  std::vector<pcl::Vertices> triangles;
  maker.reconstruct(triangles);
  TriangleMesh mesh = fitted;
  mesh.triangles.clear();
  for (const pcl::Vertices& t : triangles)
    mesh.triangles.emplace_back(int(t.vertices[0]), int(t.vertices[1]), int(t.vertices[2]));
  return mesh;
}

void print(const Shape& shape, double noise, const char* way, const Result& r) {
  const int hit = kRays - r.missed;
  std::printf(
      "{\"shape\": \"%s\", \"noise\": %g, \"way\": \"%s\", \"rms_deg\": %.4g, \"missed_pct\": %.4g, \"us_per_ray\": %.4g}\n",
      shape.name.c_str(), noise, way, hit ? std::sqrt(r.squares / hit) : -1.0, 100.0 * r.missed / kRays, 1e6 * r.seconds / kRays);
  std::fflush(stdout);
}

/// @return false, with a reason on standard error, where no surface can be made
bool compare(const Shape& shape, double noise) {
  std::mt19937_64 rng(20261);
  std::normal_distribution<double> gauss;
  const double spacing = std::sqrt(shape.area / kPoints);
  PointCloud cloud;
  std::vector<Vector3d> trueNormals;
  for (int i = 0; i < kPoints; ++i) {
    const Vector3d p = shape.point(rng);
    trueNormals.push_back(shape.normal(p));
    cloud.points.push_back(p + noise * spacing * gauss(rng) * trueNormals.back());
  }
  const Outcome<PointSurface> made = surfaceOfPoints(cloud);
  if (!made) {
    std::fprintf(stderr, "%s, noise %g: %s\n", shape.name.c_str(), noise, made.failure().message().c_str());
    return false;
  }
  const std::vector<Sight> sights = sightsOf(shape);
  const Nearest nearest(cloud.points);
  constexpr int kStar = 30;  // neighbours among which a point's triangles are looked for
  std::vector<std::vector<int>> neighbours;
  for (const Vector3d& p : cloud.points) {
    neighbours.push_back(nearest.to(p, kStar + 1));
    neighbours.back().erase(neighbours.back().begin());
  }
  TriangleMesh raw;
  raw.vertices = cloud.points;
  raw.triangles = trianglesBetween(cloud.points, trueNormals, neighbours, std::vector<double>(cloud.points.size(), 3 * spacing));
  print(shape, noise, "facets", onMesh(shape, sights, spacing, raw, NormalPolicy::Facet));
  TriangleMesh moved = made->mesh;
  for (Vector3d& v : moved.vertices) v = cloud.points[std::size_t(nearest.to(v, 1).front())];
  print(shape, noise, "fitted normals", onMesh(shape, sights, spacing, moved, NormalPolicy::Interpolated));
  print(shape, noise, "greedy", onMesh(shape, sights, spacing, greedy(made->mesh, spacing), NormalPolicy::Interpolated));
  print(shape, noise, "along the ray", measured(shape, sights, spacing, [&](const Ray& ray) {
          return onMovingLeastSquares(nearest, made->facts.neighbours, ray, kReach);
        }));
  print(shape, noise, "glint", onMesh(shape, sights, spacing, made->mesh, NormalPolicy::Interpolated));
  return true;
}

}  // namespace
}  // namespace glint

int main() {
  bool all = true;
  for (const double noise : {0.03, 0.1, 0.3}) all = glint::compare(glint::sphere(), noise) && all;
  for (const double noise : {0.1, 0.3}) all = glint::compare(glint::torus(), noise) && all;
  return all ? 0 : 1;
}
