// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/probe.h"

#include "core/geometry/camera.h"
#include "core/geometry/light.h"
#include "core/pipeline/carried.h"
#include "core/surface/mesh_policy.h"

namespace glint {

Outcome<PixelProbe> probePixel(const Inspection& inspection, int frame, const Pixel& measured) {
  require(inspection.scene && frame >= 0 && frame < static_cast<int>(inspection.scene->frames.size()),
          "probePixel: no such frame");
  if (!inspection.surfaces) return Failure{Reason::NoSurface, "the inspection holds no surfaces"};
  const Camera& camera = inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
  const Outcome<Pixel> ideal = withoutDistortion(camera, measured);
  if (!ideal) return ideal.failure();
  const Outcome<std::shared_ptr<const Surface>> surface =
      inspection.surfaces->surfaceOf(frame, meshPolicy(inspection.request.settings));
  if (!surface) return surface.failure();
  const Outcome<SurfacePoint> hit = (*surface)->firstHit(camera.ray(*ideal));
  if (!hit) return hit.failure();
  const Eigen::Vector3d eye = camera.centreInWorld();
  PixelProbe probe;
  probe.point = facing(*hit, eye);
  probe.depth = camera.depth(probe.point.position);
  const Eigen::Vector3d toCamera = (eye - probe.point.position).normalized();
  for (const auto& [id, estimate] : inspection.lightsFor(frame)) {
    if (!*estimate) continue;
    const Light light = carried((*estimate)->light, inspection.lightFromScene(frame, id).inverse());
    const Eigen::Vector3d toLight = light.directionFrom(probe.point.position);
    PixelProbe::Incidence incidence{id, {}};
    if (probe.point.normal.dot(toLight) > 0) incidence.alpha = incidentAngle(probe.point.normal, toLight, toCamera);
    probe.lights.push_back(incidence);
  }
  return probe;
}

}  // namespace glint
