// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/contour_feet.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/uncertainty.h"

namespace glint {

std::vector<double> arcOf(const Polyline& line) {
  std::vector<double> arc;
  double sum = 0;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    arc.push_back(sum);
    sum += (line.points[(i + 1) % line.points.size()] - line.points[i]).norm();
  }
  for (double& a : arc) a /= sum;
  return arc;
}

std::vector<ContourFoot> feetOn(const Polyline& predicted, const std::vector<Pixel>& points) {
  const std::size_t n = predicted.points.size();
  if (n < 3) return {};
  const std::vector<Pixel> normals = outwardNormals(predicted);
  const std::vector<double> arc = arcOf(predicted);
  std::vector<ContourFoot> feet;
  feet.reserve(points.size());
  for (const Pixel& p : points) {
    double best = std::numeric_limits<double>::infinity();
    ContourFoot foot;
    for (std::size_t i = 0; i < n; ++i) {
      const Pixel a = predicted.points[i], along = predicted.points[(i + 1) % n] - a;
      const double squared = along.squaredNorm(), t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
      const double d = (a + t * along - p).squaredNorm();
      if (d < best) best = d, foot.share = t, foot.from = i;
    }
    foot.to = (foot.from + 1) % n;
    const Pixel at = predicted.points[foot.from] + foot.share * (predicted.points[foot.to] - predicted.points[foot.from]);
    foot.normal = ((1 - foot.share) * normals[foot.from] + foot.share * normals[foot.to]).normalized();
    foot.distance = std::copysign(std::sqrt(best), foot.normal.dot(p - at));
    const double end = foot.to == 0 ? 1.0 : arc[foot.to];
    foot.arc = arc[foot.from] + foot.share * (end - arc[foot.from]);
    feet.push_back(foot);
  }
  return feet;
}

}  // namespace glint
