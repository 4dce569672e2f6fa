// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <vector>

#include "core/app/ball_observation.h"
#include "core/base/image.h"

/// Photographs of mirror balls, traced ray by ray, so that outlines and reflections have an exact truth that shares no code with
/// core.
namespace glint::ball_pictures {

/// Balls of radius 1 before a pinhole at the origin that looks along z.
struct Scene {
  double focal = 1e7;  ///< px; this large it is a distant camera
  Eigen::Vector2d principal = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector3d> balls;
  double mirrors = 0.6;                                 ///< share of the light
  std::function<double(const Eigen::Vector3d&)> light;  ///< linear, 1 = white, from a direction
};

/// The ball whose outline has this circle before a distant camera.
inline Eigen::Vector3d ballOf(const Scene& scene, const BallOutline& outline) {
  const double z = scene.focal / outline.radius;
  const Eigen::Vector2d c = (outline.centre - scene.principal) / scene.focal * z;
  return {c.x(), c.y(), z};
}

inline std::optional<double> hit(const Eigen::Vector3d& from, const Eigen::Vector3d& along, const Eigen::Vector3d& ball) {
  const Eigen::Vector3d d = ball - from;
  const double b = along.dot(d), inside = 1 - (d - b * along).squaredNorm();
  if (inside < 0 || b - std::sqrt(inside) < 1e-9) return std::nullopt;
  return b - std::sqrt(inside);
}

inline double trace(const Scene& scene, Eigen::Vector3d from, Eigen::Vector3d along) {
  double share = 1;
  for (int bounce = 0; bounce < 4; ++bounce) {
    double nearest = 1e300;
    const Eigen::Vector3d* ball = nullptr;
    for (const Eigen::Vector3d& b : scene.balls)
      if (const auto t = hit(from, along, b); t && *t < nearest) nearest = *t, ball = &b;
    if (!ball) return share * scene.light(along);
    from += nearest * along;
    const Eigen::Vector3d normal = (from - *ball).normalized();
    along -= 2 * normal.dot(along) * normal;
    share *= scene.mirrors;
  }
  return 0;
}

/// Linear light of a cut-out; `samples` rays along each side of a pixel.
inline cv::Mat render(const Scene& scene, const Eigen::Vector2d& corner, int width, int height, int samples) {
  cv::Mat image(height, width, CV_64F);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) {
          const Eigen::Vector2d p =
              (corner + Eigen::Vector2d(x + (i + 0.5) / samples - 0.5, y + (j + 0.5) / samples - 0.5) - scene.principal) /
              scene.focal;
          sum += trace(scene, Eigen::Vector3d::Zero(), Eigen::Vector3d(p.x(), p.y(), 1).normalized());
        }
      image.at<double>(y, x) = sum / (samples * samples);
    }
  return image;
}

/// What a camera makes of linear light: blur, sRGB (IEC 61966-2-1), noise in codes, clipping, and where a quality is given a
/// JPEG.
inline Image photograph(const cv::Mat& linear, double blurPx, double noise = 0, unsigned seed = 1, int jpeg = 0) {
  cv::Mat blurred = linear.clone();  // OpenCV would blur a shared picture in its place
  if (blurPx > 0) cv::GaussianBlur(linear, blurred, {}, blurPx);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  cv::Mat codes(linear.rows, linear.cols, CV_8U);
  for (int y = 0; y < linear.rows; ++y)
    for (int x = 0; x < linear.cols; ++x) {
      const double v = std::clamp(blurred.at<double>(y, x), 0.0, 1.0);
      const double code = 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055) + noise * normal(random);
      codes.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(code);
    }
  if (jpeg > 0) {
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", codes, bytes, {cv::IMWRITE_JPEG_QUALITY, jpeg});
    codes = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  }
  Image image(codes.cols, codes.rows, 1);
  for (int y = 0; y < codes.rows; ++y)
    for (int x = 0; x < codes.cols; ++x) image.at(x, y) = codes.at<unsigned char>(y, x);
  return image;
}

/// A black ball before even grey.
inline Scene blackBall(const BallOutline& outline, double grey = 0.15) {
  Scene scene;
  scene.principal = outline.centre;
  scene.balls = {ballOf(scene, outline)};
  scene.mirrors = 0;
  scene.light = [grey](const Eigen::Vector3d&) { return grey; };
  return scene;
}

/// An angle around the optical axis that lies in a sector, for lights that shine on a part of the background.
inline bool around(const Eigen::Vector3d& direction, double middleDeg, double halfWidthDeg) {
  const double turn = std::atan2(direction.y(), direction.x()) * 180 / std::numbers::pi - middleDeg;
  return std::abs(std::remainder(turn, 360.0)) < halfWidthDeg;
}

}  // namespace glint::ball_pictures
