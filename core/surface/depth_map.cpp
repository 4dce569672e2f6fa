// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_map.h"

#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

// clang-format off
// Included with their code: to load libpcl_features, which has it for all types of points, takes a third of the start of `glint`
// (0.23 s of the processor, without it 0.15 s).
#include <pcl/features/impl/feature.hpp>
#include <pcl/features/impl/integral_image_normal.hpp>
#include <pcl/features/impl/normal_3d.hpp>
// clang-format on

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <utility>
#include <vector>

#include "core/surface/depth_filter.h"
#include "core/surface/mesh.h"

namespace glint {
namespace {

bool hasDepth(float z) { return std::isfinite(z) && z > 0; }

}  // namespace

FilledDepth withoutSmallHoles(const Image& depth, int largestHolePx, double inpaintRadiusPx) {
  FilledDepth result{Image(depth.width, depth.height, 1), {}};
  cv::Mat1f known(depth.height, depth.width, 0.f);
  cv::Mat1b none(depth.height, depth.width, uchar{0});
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float z = depth.at(x, y);
      if (hasDepth(z))
        result.depth.at(x, y) = known(y, x) = z;
      else
        none(y, x) = 255;
    }
  cv::Mat1i labels, stats;
  cv::Mat1d centroids;
  const int parts = cv::connectedComponentsWithStats(none, labels, stats, centroids, 8, CV_32S);
  std::vector<char> small(parts, 0);
  for (int i = 1; i < parts; ++i) {
    const int left = stats(i, cv::CC_STAT_LEFT), top = stats(i, cv::CC_STAT_TOP);
    const bool atBorder = left == 0 || top == 0 || left + stats(i, cv::CC_STAT_WIDTH) == depth.width ||
                          top + stats(i, cv::CC_STAT_HEIGHT) == depth.height;
    small[i] = !atBorder && stats(i, cv::CC_STAT_AREA) <= largestHolePx;
  }
  if (std::none_of(small.begin(), small.end(), [](char s) { return s != 0; })) return result;
  // All missing pixels are unknown to the filling, so that the zeros of large holes do not leak into small ones.
  // OpenCV adds up to 1.4 of the image's unit for the slope (a direction without a length). With metres as the unit that would be
  // 1.4 m of depth.
  constexpr double kUnits = 1e6;  // in a median depth, so that this is below the single precision
  const double unit = medianDepth(result.depth) / kUnits;
  cv::Mat1f painted;
  cv::inpaint(known * (1 / unit), none, painted, inpaintRadiusPx, cv::INPAINT_TELEA);
  painted *= unit;
  result.filled.assign(result.depth.data.size(), 0);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (small[labels(y, x)] && hasDepth(painted(y, x))) {
        result.depth.at(x, y) = painted(y, x);
        result.filled[static_cast<std::size_t>(y) * depth.width + x] = 1;
      }
  return result;
}

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// The points of a depth map in the camera's frame: double for the mesh, float and in units of the median depth for PCL, whose
/// single precision and radius then mean the same at every scale.
struct Points {
  std::vector<int> vertexOf;  ///< of each pixel; -1 = none
  std::vector<int> pixelOf;   ///< of each vertex
  std::vector<Eigen::Vector3d> positions;
  Cloud::Ptr cloud;
  double unit = 1;  ///< m
};

Points unprojected(const Image& depth, const Camera& camera) {
  Points points;
  points.unit = medianDepth(depth);
  points.vertexOf.assign(depth.data.size(), -1);
  points.cloud.reset(new Cloud(depth.width, depth.height));
  points.cloud->is_dense = false;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      pcl::PointXYZ& out = points.cloud->at(x, y);
      out.x = out.y = out.z = nan;
      const float z = depth.at(x, y);
      if (!(z > 0)) continue;
      const Pixel ideal = camera.undistorted(Pixel(x, y));
      const Eigen::Vector3d ray = camera.pixelFromRay.triangularView<Eigen::Upper>().solve(ideal.homogeneous());
      const Eigen::Vector3d p = static_cast<double>(z) / ray.z() * ray;
      if (!p.allFinite()) continue;
      const int pixel = y * depth.width + x;
      points.vertexOf[static_cast<std::size_t>(pixel)] = static_cast<int>(points.positions.size());
      points.positions.push_back(p);
      points.pixelOf.push_back(pixel);
      out.getVector3fMap() = (p / points.unit).cast<float>();
    }
  return points;
}

/// Two triangles for each cell of four pixels, cut where depth jumps.
std::vector<Eigen::Vector3i> cells(const Points& points, int width, int height, double jump) {
  std::vector<Eigen::Vector3i> triangles;
  const auto joined = [&](int a, int b) {
    const double za = points.positions[a].z(), zb = points.positions[b].z();
    return std::abs(za - zb) <= jump * std::min(za, zb);
  };
  const auto add = [&](int a, int b, int c) {
    if (a >= 0 && b >= 0 && c >= 0 && joined(a, b) && joined(b, c) && joined(c, a)) triangles.emplace_back(a, b, c);
  };
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      const int n = y * width + x;
      const int a = points.vertexOf[n], b = points.vertexOf[n + 1], c = points.vertexOf[n + width],
                d = points.vertexOf[n + width + 1];
      // With x right, y down and z forward this winding has its normal towards the camera.
      if (a >= 0 && d >= 0) {
        add(a, c, d);
        add(a, d, b);
      } else {
        add(a, c, b);
        add(b, c, d);
      }
    }
  return triangles;
}

/// One normal per vertex, camera frame, towards the camera; 0 where there are too few neighbours.
std::vector<Eigen::Vector3d> planeNormals(const Points& points, bool onPixelGrid, double radius) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  pcl::search::Search<pcl::PointXYZ>::Ptr search;
  if (onPixelGrid)
    search.reset(new pcl::search::OrganizedNeighbor<pcl::PointXYZ>());
  else
    search.reset(new pcl::search::KdTree<pcl::PointXYZ>());
  estimation.setInputCloud(points.cloud);
  estimation.setIndices(pcl::IndicesPtr(new pcl::Indices(points.pixelOf.begin(), points.pixelOf.end())));
  estimation.setSearchMethod(search);
  estimation.setRadiusSearch(radius / points.unit);
  estimation.setViewPoint(0, 0, 0);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  std::vector<Eigen::Vector3d> result;
  for (const pcl::Normal& n : normals) {
    const Eigen::Vector3d normal = n.getNormalVector3fMap().cast<double>();
    result.push_back(normal.allFinite() && normal.norm() > 0 ? normal.normalized() : Eigen::Vector3d::Zero().eval());
  }
  return result;
}

/// The same from integral images of the covariance over squares of pixels that are 2 `radius` wide.
std::vector<Eigen::Vector3d> integralNormals(const Points& points, const Camera& camera, double radius, double jump) {
  pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setNormalEstimationMethod(estimation.COVARIANCE_MATRIX);
  estimation.setMaxDepthChangeFactor(static_cast<float>(jump));
  constexpr double kLeastPx = 3, kMostPx = 200;
  const double sidePx = 2 * radius * camera.pixelFromRay(0, 0) / points.unit;
  estimation.setNormalSmoothingSize(static_cast<float>(std::clamp(sidePx, kLeastPx, kMostPx)));
  estimation.setDepthDependentSmoothing(false);
  estimation.setViewPoint(0, 0, 0);
  estimation.setInputCloud(points.cloud);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  std::vector<Eigen::Vector3d> result;
  for (const int pixel : points.pixelOf) {
    const Eigen::Vector3d normal = normals[static_cast<std::size_t>(pixel)].getNormalVector3fMap().cast<double>();
    result.push_back(normal.allFinite() && normal.norm() > 0 ? normal.normalized() : Eigen::Vector3d::Zero().eval());
  }
  return result;
}

SmoothDepth smoothed(const Image& depth, const Camera& camera, const DepthPolicy& policy, double radius) {
  switch (policy.smoothing) {
    case DepthSmoothing::None: break;
    case DepthSmoothing::Bilateral: return bilateralDepth(depth, camera, radius);
    case DepthSmoothing::Fit: return fittedDepth(depth, camera, radius);
  }
  return {depth, {}};
}

}  // namespace

Outcome<std::shared_ptr<const Surface>> makeDepthMap(const Image& depth, const Camera& camera, const DepthMapOptions& options) {
  const DepthPolicy& policy = options.mesh.depth;
  require(depth.channels == 1, "depth map: one channel expected");
  require(depth.width == camera.width && depth.height == camera.height, "depth map: the size differs from the camera's images");
  require(options.normalRadius > 0 && policy.largestHolePx >= 0 && options.inpaintRadiusPx > 0 && options.jump > 0 &&
              policy.radius >= 0 && std::isfinite(policy.radius),
          "depth map: radii and jump must be positive");
  if (depth.width < 2 || depth.height < 2) return Failure{Reason::NoSurface, "a depth map of a single row or column"};
  const FilledDepth filled = withoutSmallHoles(depth, policy.largestHolePx, options.inpaintRadiusPx);
  const double radius = policy.radius > 0 ? policy.radius : options.normalRadius * medianDepth(filled.depth);
  const SmoothDepth smooth = smoothed(filled.depth, camera, policy, radius);
  const Points points = unprojected(smooth.depth, camera);

  TriangleMesh mesh;
  mesh.triangles = cells(points, depth.width, depth.height, options.jump);
  if (mesh.triangles.empty()) return Failure{Reason::NoSurface, "no cell of the depth map is complete"};
  if (options.mesh.normals != NormalPolicy::Facet) {
    if (!smooth.normals.empty())
      for (const int pixel : points.pixelOf) mesh.normals.push_back(smooth.normals[static_cast<std::size_t>(pixel)]);
    else if (policy.normals == DepthNormals::Integral)
      mesh.normals = integralNormals(points, camera, radius, options.jump);
    else
      mesh.normals = planeNormals(points, !camera.hasDistortion(), radius);
    // Normals that are 0 stay so: the mesh then takes them from the triangles.
    const Eigen::Matrix3d worldFromCam = camera.camFromWorld.linear().transpose();
    for (Eigen::Vector3d& n : mesh.normals) n = worldFromCam * n;
  }
  const Eigen::Isometry3d worldFromCam = camera.camFromWorld.inverse();
  for (const Eigen::Vector3d& p : points.positions) mesh.vertices.push_back(worldFromCam * p);
  std::vector<char> filledVertices;
  if (!filled.filled.empty())
    for (const int pixel : points.pixelOf) filledVertices.push_back(filled.filled[static_cast<std::size_t>(pixel)]);
  return makeMesh(std::move(mesh), options.mesh, false, std::move(filledVertices));
}

}  // namespace glint
