// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "core/base/numeric.h"
#include "core/model/models.h"

namespace glint {

std::vector<Pixel> levelSetPoints(const TrainingView& view, int n) {
  std::vector<Pixel> points = resample(view.highlight.contour, n);
  if (view.highlight.touchesBorder) std::erase_if(points, [&](const Pixel& p) { return onImageBorder(view.camera, p); });
  return points;
}

double medianContourAngle(const std::vector<TrainingView>& views, const Light& light, int pointsPerView) {
  std::vector<double> alphas;
  for (const TrainingView& v : views) {
    if (!v.seen || v.highlight.contour.points.size() < 3) continue;
    const Eigen::Vector3d eye = v.camera.centreInWorld();
    for (const Pixel& p : levelSetPoints(v, pointsPerView)) {
      const Outcome<SurfacePoint> hit = v.surface->firstHit(v.camera.ray(p));
      if (!hit) continue;
      const SurfacePoint s = facing(*hit, eye);
      const Eigen::Vector3d l = light.directionFrom(s.position);
      if (s.normal.dot(l) > 0) alphas.push_back(incidentAngle(s.normal, l, (eye - s.position).normalized()));
    }
  }
  if (alphas.empty()) return 0;
  return upperMedian(std::move(alphas));
}

}  // namespace glint
