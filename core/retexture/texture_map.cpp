// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/texture_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <utility>

#include "core/surface/posed_surface.h"

namespace glint {
namespace {

using MapPoint = std::function<Eigen::Vector2d(const SurfacePoint&)>;

/// Angle over a full turn, in [0, 1).
double turnOf(double y, double x) {
  const double turn = std::atan2(y, x) / (2 * M_PI);
  return turn < 0 ? turn + 1 : turn;
}

Eigen::Vector2d onSphere(const Eigen::Vector3d& direction) {
  const double polar = std::atan2(direction.z(), direction.head<2>().norm());
  return {turnOf(direction.y(), direction.x()), 0.5 - polar / M_PI};
}

/// The map in the surface's own coordinates; empty without such coordinates.
std::pair<MapPoint, std::string> naturalMap(const AnalyticSpec& s) {
  const Eigen::Isometry3d local = s.worldFromSurface.inverse();
  if (s.type == "plane")
    return {[local](const SurfacePoint& p) {
              const Eigen::Vector3d q = local * p.position;
              return Eigen::Vector2d(0.5 + q.x(), 0.5 - q.y());
            },
            "the plane's x and y, one texture per metre"};
  if (s.type == "sheet")
    return {[local, k = s.curvature, length = s.length.value_or(1), width = s.width.value_or(1)](const SurfacePoint& p) {
              const Eigen::Vector3d q = local * p.position;
              const double arc = k == 0 ? q.x() : std::atan2(k * q.x(), 1 + k * q.z()) / k;
              return Eigen::Vector2d(0.5 + arc / length, 0.5 - q.y() / width);
            },
            "arc length and width of the sheet"};
  if (s.type == "sphere" || s.type == "ellipsoid")
    return {[local, axes = s.type == "sphere" ? Eigen::Vector3d(Eigen::Vector3d::Constant(s.radius)) : s.semiAxes](
                const SurfacePoint& p) { return onSphere((local * p.position).cwiseQuotient(axes)); },
            "longitude and latitude"};
  if (s.type == "cylinder")
    return {[local, girth = 2 * M_PI * s.radius](const SurfacePoint& p) {
              const Eigen::Vector3d q = local * p.position;
              return Eigen::Vector2d(turnOf(q.x(), q.z()), 0.5 - q.y() / girth);
            },
            "angle and height of the cylinder"};
  if (s.type == "torus")
    return {[local, major = s.majorRadius](const SurfacePoint& p) {
              const Eigen::Vector3d q = local * p.position;
              return Eigen::Vector2d(turnOf(q.y(), q.x()), 1 - turnOf(q.z(), q.head<2>().norm() - major));
            },
            "the two angles of the torus"};
  return {};
}

/// The two world coordinates across the normal's largest component; each side has the image's right and top as seen from outside.
Eigen::Vector2d onBox(const SurfacePoint& p, const Eigen::Vector3d& origin, double side) {
  const Eigen::Vector3d q = (p.position - origin) / side;
  Eigen::Index axis = 0;
  p.normal.cwiseAbs().maxCoeff(&axis);
  if (axis == 0) return {0.5 + q.y(), 0.5 - q.z()};
  if (axis == 1) return {0.5 + q.x(), 0.5 - q.z()};
  return {0.5 + q.x(), 0.5 - q.y()};
}

double wrapped(double v) { return v - std::floor(v); }

Eigen::Vector3d bilinear(const Image& image, const Eigen::Vector2d& uv) {
  const double x = wrapped(uv.x()) * image.width - 0.5, y = wrapped(uv.y()) * image.height - 0.5;
  const double fx = std::floor(x), fy = std::floor(y);
  const auto place = [](double v, int size) { return ((int(v) % size) + size) % size; };
  const int x0 = place(fx, image.width), x1 = place(fx + 1, image.width), y0 = place(fy, image.height),
            y1 = place(fy + 1, image.height);
  Eigen::Vector3d value;
  for (int c = 0; c < 3; ++c) {
    const double top = image.at(x0, y0, c) + (x - fx) * (double(image.at(x1, y0, c)) - image.at(x0, y0, c));
    const double bottom = image.at(x0, y1, c) + (x - fx) * (double(image.at(x1, y1, c)) - image.at(x0, y1, c));
    value(c) = top + (y - fy) * (bottom - top);
  }
  return value;
}

}  // namespace

TextureMapping textureMappingNamed(const std::string& name) {
  const auto at = std::find(kTextureMappings.begin(), kTextureMappings.end(), name);
  require(at != kTextureMappings.end(), "textureMappingNamed: unknown name " + name);
  return TextureMapping(at - kTextureMappings.begin());
}

TextureCoordinates::TextureCoordinates(const Scene& scene, int frame, const Surface& surface, TextureMapping mapping,
                                       double repeat)
    : repeat_(repeat) {
  require(repeat > 0 && std::isfinite(repeat), "TextureCoordinates: repeat > 0");
  const Frame& about = scene.frames.at(std::size_t(frame));
  const std::string& name = about.surface;
  if (!standsStill(about)) objectFromScene_ = about.worldFromObject.inverse();
  if (const AnalyticSpec* const formula = scene.formulaOf(name); formula && mapping == TextureMapping::Natural)
    std::tie(map_, words_) = naturalMap(*formula);
  if (map_) return;
  const Eigen::AlignedBox3d box = objectOf(surface).bounds();
  const bool bounded = !name.empty() && box.sizes().allFinite() && box.sizes().maxCoeff() > 0;
  const double side = bounded ? box.sizes().maxCoeff() : 1;
  const Eigen::Vector3d origin = bounded ? Eigen::Vector3d(box.center()) : Eigen::Vector3d::Zero();
  const std::string scale = bounded ? ", one texture across the surface" : ", one texture per metre";
  switch (mapping) {
    case TextureMapping::Planar:
      map_ = [origin, side](const SurfacePoint& p) {
        const Eigen::Vector3d q = (p.position - origin) / side;
        return Eigen::Vector2d(0.5 + q.x(), 0.5 - q.y());
      };
      words_ = "world x and y" + scale;
      return;
    case TextureMapping::Spherical:
      map_ = [middle = box.sizes().allFinite() ? Eigen::Vector3d(box.center()) : Eigen::Vector3d(0, 0, 0)](
                 const SurfacePoint& p) { return onSphere(p.position - middle); };
      words_ = "longitude and latitude about the surface's middle";
      return;
    case TextureMapping::Natural:
    case TextureMapping::Box:
      map_ = [origin, side](const SurfacePoint& p) { return onBox(p, origin, side); };
      words_ = "a box around the surface" + scale + "; it has seams where the normal changes its side";
      return;
  }
}

Eigen::Vector2d TextureCoordinates::at(const SurfacePoint& p) const {
  if (!objectFromScene_) return repeat_ * map_(p);
  SurfacePoint there = p;
  there.position = *objectFromScene_ * p.position;
  there.normal = objectFromScene_->linear() * p.normal;
  return repeat_ * map_(there);
}

TexturePyramid::TexturePyramid(const Image& linear) {
  require(linear.channels == 3 && linear.width > 0 && linear.height > 0, "TexturePyramid: a colour image");
  levels_.push_back(linear);
  mean_ = std::accumulate(linear.data.begin(), linear.data.end(), 0.0) / double(linear.data.size());
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    Image& last = levels_.back();
    const cv::Mat large(last.height, last.width, CV_32FC3, last.data.data());
    Image half(std::max(1, last.width / 2), std::max(1, last.height / 2), 3);
    cv::Mat small(half.height, half.width, CV_32FC3, half.data.data());
    cv::resize(large, small, small.size(), 0, 0, cv::INTER_AREA);
    levels_.push_back(std::move(half));
  }
}

Eigen::Vector3d TexturePyramid::at(const Eigen::Vector2d& uv, double footprint) const {
  const double pixels = footprint * std::max(levels_[0].width, levels_[0].height);
  const double level = std::clamp(pixels > 1 ? std::log2(pixels) : 0.0, 0.0, double(levels_.size() - 1));
  const std::size_t lower = std::size_t(level);
  const Eigen::Vector3d fine = bilinear(levels_[lower], uv);
  const double share = level - double(lower);
  return share > 0 ? Eigen::Vector3d(fine + share * (bilinear(levels_[lower + 1], uv) - fine)) : fine;
}

}  // namespace glint
