// SPDX-License-Identifier: BSD-3-Clause
#include "core/surface/depth_map.h"

#include <pcl/features/normal_3d.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <utility>
#include <vector>

#include "core/base/median.h"
#include "core/surface/mesh.h"

namespace glint {
namespace {

bool hasDepth(float z) { return std::isfinite(z) && z > 0; }

/// Depth with small holes filled; 0 where there is none.
cv::Mat1f withoutSmallHoles(const Image& depth, const DepthMapOptions& options) {
  cv::Mat1f filled(depth.height, depth.width, 0.f);
  cv::Mat1b none(depth.height, depth.width, uchar{0});
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float z = depth.at(x, y);
      if (hasDepth(z))
        filled(y, x) = z;
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
    small[i] = !atBorder && stats(i, cv::CC_STAT_AREA) <= options.largestHolePx;
  }
  if (std::none_of(small.begin(), small.end(), [](char s) { return s != 0; })) return filled;
  // All missing pixels are unknown to the filling, so that the zeros of large holes do not leak into small ones.
  cv::Mat1f painted;
  cv::inpaint(filled, none, painted, options.inpaintRadiusPx, cv::INPAINT_TELEA);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x)
      if (small[labels(y, x)] && hasDepth(painted(y, x))) filled(y, x) = painted(y, x);
  return filled;
}

/// Of the pixels that have one; 1 when none has.
double medianDepth(const cv::Mat1f& depth) {
  std::vector<float> values;
  for (const float z : depth)
    if (z > 0) values.push_back(z);
  if (values.empty()) return 1;
  return upperMedian(std::move(values));
}

}  // namespace

Outcome<std::shared_ptr<const Surface>> makeDepthMap(const Image& depth, const Camera& camera, const DepthMapOptions& options) {
  require(depth.channels == 1, "depth map: one channel expected");
  require(depth.width == camera.width && depth.height == camera.height, "depth map: the size differs from the camera's images");
  require(options.normalRadius > 0 && options.largestHolePx >= 0 && options.inpaintRadiusPx > 0 && options.jump > 0,
          "depth map: radii and jump must be positive");
  const int width = depth.width, height = depth.height;
  if (width < 2 || height < 2) return Failure{Reason::NoSurface, "a depth map of a single row or column"};
  const cv::Mat1f z = withoutSmallHoles(depth, options);

  // Points in the camera frame: double for the mesh, float for PCL's normals.
  TriangleMesh mesh;
  std::vector<int> vertexOf(static_cast<std::size_t>(width) * height, -1);
  std::vector<Eigen::Vector3d> points;
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>(width, height));
  pcl::IndicesPtr indices(new pcl::Indices);
  cloud->is_dense = false;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const double unit = medianDepth(z);  // PCL counts in it: its single precision and the radius then mean the same at every scale
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      pcl::PointXYZ& out = cloud->at(x, y);
      out.x = out.y = out.z = nan;
      if (!(z(y, x) > 0)) continue;
      const Pixel ideal = camera.undistorted(Pixel(x, y));
      const Eigen::Vector3d ray = camera.pixelFromRay.triangularView<Eigen::Upper>().solve(ideal.homogeneous());
      const Eigen::Vector3d p = static_cast<double>(z(y, x)) / ray.z() * ray;
      if (!p.allFinite()) continue;
      vertexOf[static_cast<std::size_t>(y) * width + x] = static_cast<int>(points.size());
      points.push_back(p);
      indices->push_back(y * width + x);
      out.getVector3fMap() = (p / unit).cast<float>();
    }

  const auto joined = [&](int a, int b) {
    const double za = points[a].z(), zb = points[b].z();
    return std::abs(za - zb) <= options.jump * std::min(za, zb);
  };
  const auto add = [&](int a, int b, int c) {
    if (a >= 0 && b >= 0 && c >= 0 && joined(a, b) && joined(b, c) && joined(c, a)) mesh.triangles.emplace_back(a, b, c);
  };
  for (int y = 0; y + 1 < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      const int n = y * width + x;
      const int a = vertexOf[n], b = vertexOf[n + 1], c = vertexOf[n + width], d = vertexOf[n + width + 1];
      // With x right, y down and z forward this winding has its normal towards the camera.
      if (a >= 0 && d >= 0) {
        add(a, c, d);
        add(a, d, b);
      } else {
        add(a, c, b);
        add(b, c, d);
      }
    }
  if (mesh.triangles.empty()) return Failure{Reason::NoSurface, "no cell of the depth map is complete"};

  if (options.mesh.normals != NormalPolicy::Facet) {
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    pcl::search::Search<pcl::PointXYZ>::Ptr search;
    if (camera.hasDistortion())
      search.reset(new pcl::search::KdTree<pcl::PointXYZ>());
    else
      search.reset(new pcl::search::OrganizedNeighbor<pcl::PointXYZ>());
    estimation.setInputCloud(cloud);
    estimation.setIndices(indices);
    estimation.setSearchMethod(search);
    estimation.setRadiusSearch(options.normalRadius);
    estimation.setViewPoint(0, 0, 0);
    pcl::PointCloud<pcl::Normal> normals;
    estimation.compute(normals);
    const Eigen::Matrix3d worldFromCam = camera.camFromWorld.linear().transpose();
    for (const pcl::Normal& n : normals) {
      const Eigen::Vector3d normal = n.getNormalVector3fMap().cast<double>();
      // Too few neighbours: left empty, the mesh then takes it from the triangles.
      mesh.normals.push_back(normal.allFinite() && normal.norm() > 0 ? Eigen::Vector3d(worldFromCam * normal.normalized())
                                                                     : Eigen::Vector3d::Zero().eval());
    }
  }
  const Eigen::Isometry3d worldFromCam = camera.camFromWorld.inverse();
  for (const Eigen::Vector3d& p : points) mesh.vertices.push_back(worldFromCam * p);
  return makeMesh(std::move(mesh), options.mesh, false);
}

}  // namespace glint
