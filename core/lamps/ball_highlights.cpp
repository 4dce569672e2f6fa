// SPDX-License-Identifier: BSD-3-Clause
#include "core/lamps/ball_highlights.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace glint {
namespace {

constexpr double kBright = 250;      // of 255: as good as clipped after a JPEG
constexpr int kLeastArea = 5;        // pixels; fewer are noise
constexpr double kCoreShare = 0.3;   // of the largest distance to the blob's border: the core without the streaks
constexpr double kSigmaShare = 0.1;  // of the core's radius: what the place of a clipped peak is known to

cv::Mat brightOnBall(const Image& photograph, const Eigen::Vector2d& corner, const BallOutline& ball) {
  cv::Mat bright(photograph.height, photograph.width, CV_8U, cv::Scalar(0));
  for (int y = 0; y < photograph.height; ++y)
    for (int x = 0; x < photograph.width; ++x) {
      if ((Eigen::Vector2d(x, y) + corner - ball.centre).norm() >= ball.radius) continue;
      float least = photograph.at(x, y);
      for (int c = 1; c < photograph.channels; ++c) least = std::min(least, photograph.at(x, y, c));
      bright.at<unsigned char>(y, x) = least >= kBright ? 255 : 0;
    }
  return bright;
}

}  // namespace

Outcome<LampObservation> findLampHighlight(const Image& photograph, const Eigen::Vector2d& corner,
                                           std::span<const BallOutline> balls, std::size_t which) {
  require(!photograph.empty() && which < balls.size(), "findLampHighlight: no photograph or no such ball");
  const cv::Mat bright = brightOnBall(photograph, corner, balls[which]);
  cv::Mat labels, stats, centres, distance;
  const int count = cv::connectedComponentsWithStats(bright, labels, stats, centres);
  cv::distanceTransform(bright, distance, cv::DIST_L2, cv::DIST_MASK_5);
  int best = 0;
  std::vector<double> widest(count, 0.0);
  for (int y = 0; y < distance.rows; ++y)
    for (int x = 0; x < distance.cols; ++x) {
      double& w = widest[labels.at<int>(y, x)];
      w = std::max(w, static_cast<double>(distance.at<float>(y, x)));
    }
  for (int i = 1; i < count; ++i)
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= kLeastArea && (best == 0 || widest[i] > widest[best])) best = i;
  if (best == 0) return Failure{Reason::NoHighlight, "nothing on the ball is bright enough for a lamp"};
  LampObservation result;
  result.object = which;
  result.clipped = true;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0;
  for (int y = 0; y < distance.rows; ++y)
    for (int x = 0; x < distance.cols; ++x) {
      const double d = distance.at<float>(y, x) - (1 - kCoreShare) * widest[best];
      if (labels.at<int>(y, x) != best || d <= 0) continue;
      sum += d * Eigen::Vector2d(x, y);
      weight += d;
    }
  result.peak = sum / weight + corner;
  const double sigma = std::max(0.1, kSigmaShare * widest[best]);
  result.covariance = sigma * sigma * Eigen::Matrix2d::Identity();
  for (int i = 1; i < count; ++i)
    if (i != best)
      result.dropped.push_back(
          {Eigen::Vector2d(centres.at<double>(i, 0), centres.at<double>(i, 1)) + corner, "smaller than the largest"});
  return result;
}

}  // namespace glint
