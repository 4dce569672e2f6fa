// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/photograph.h"

#include <algorithm>
#include <utility>

#include "core/base/image.h"
#include "core/pipeline/what_if.h"
#include "core/synth/synth.h"

namespace glint {

namespace {

/// The factor that makes radiance a picture, and the albedo of the matt part.
struct Exposure {
  double factor = 1, albedo = 0;
};

std::shared_ptr<const Surface> curvedSurface(const Inspection& in, int frame) {
  Outcome<std::shared_ptr<const Surface>> surface = in.surfaces->surfaceOf(frame, NormalPolicy::Curved);
  return surface ? *surface : nullptr;
}

/// Peaks are known from the synthesised contours: no frame needs to be rendered for it.
Outcome<Exposure> exposureOf(const Inspection& in, const Material& material) {
  int frame = -1;
  const Highlight* brightest = nullptr;
  std::pair<bool, double> best;  // contours are followed beyond the image: peaks there count only where no other is
  for (std::size_t i = 0; i < in.scene->frames.size(); ++i) {
    const Camera& c = in.scene->frames[i].camera;
    for (const Highlight& h : in.scene->frames[i].highlights) {
      const Pixel p = c.distorted(h.peak);
      const bool inside = p.x() > -0.5 && p.y() > -0.5 && p.x() < c.width - 0.5 && p.y() < c.height - 0.5;
      if (const std::pair rank(inside, h.peakValue); !brightest || rank > best) best = rank, brightest = &h, frame = int(i);
    }
  }
  if (!brightest || !(brightest->peakValue > 0))
    return Failure{Reason::NoHighlight, "no frame of the sequence shows a highlight"};
  const Frame& f = in.scene->frames[std::size_t(frame)];
  const std::shared_ptr<const Surface> surface = curvedSurface(in, frame);
  const Ray ray = f.camera.ray(brightest->peak);
  const Outcome<SurfacePoint> hit = surface ? surface->firstHit(ray) : Outcome<SurfacePoint>(Failure{Reason::NoSurface, f.id});
  double matt = 0;
  if (hit)
    for (const TrueLight& light : lightsOn(*in.scene, withoutSwitchingOff(in.request.whatIf), frame))
      matt += shade(*surface, *hit, ray.origin, light, material).diffuse;
  Exposure exposure;
  exposure.factor = kPeakValue / ((1 + kMattShare) * brightest->peakValue);
  if (matt > 0) exposure.albedo = kMattShare * brightest->peakValue / matt;
  return exposure;
}

}  // namespace

bool picturesAreSynthesised(const Inspection& inspection) { return inspection.request.whatIf.synthesise; }

bool hasPhotograph(const Inspection& in, int frame) {
  const Frame& f = in.given->frames[std::size_t(frame)];
  return picturesAreSynthesised(in) || !f.image.empty() || !f.radiance.empty();
}

std::string pictureKey(const Inspection& inspection) {
  // The exposure is that of all frames: as long as only some are known, pictures are those of a first look.
  const bool some =
      std::any_of(inspection.evidence.begin(), inspection.evidence.end(), [](const FrameEvidence& e) { return e.frame < 0; });
  if (!picturesAreSynthesised(inspection)) return "";
  return synthesisKey(inspection.request.whatIf) + "|off " + lightsOffKey(inspection.request.whatIf) +
         (some ? "|first look" : "");
}

Outcome<Image> linearImageOf(const Inspection& in, int frame, FrameSource source, int every, const ProgressFn& progress) {
  require(frame >= 0 && frame < int(in.given->frames.size()), "linearImageOf: there is no such frame");
  require(every >= 1, "linearImageOf: every n-th pixel, n >= 1");
  if (!picturesAreSynthesised(in)) return readLinear(in.given->frames[std::size_t(frame)], source);
  Material material;
  material.lobe = in.request.whatIf.lobe;
  material.roughness = in.request.whatIf.roughness;
  const Outcome<Exposure> exposure = exposureOf(in, material);
  if (!exposure) return exposure.failure();
  const Outcome<std::shared_ptr<const Surface>> surface = in.surfaces->surfaceOf(frame, NormalPolicy::Curved);
  if (!surface) return surface.failure();
  const Frame& f = in.scene->frames[std::size_t(frame)];
  const RenderedRadiance r =
      renderRadiance(**surface, f.camera, lightsOn(*in.scene, in.request.whatIf, frame), material, every, progress);
  const bool matt = source == FrameSource::Image;
  Image picture(f.camera.width, f.camera.height, matt ? 3 : 1);
  for (std::size_t k = 0; k < picture.data.size(); ++k) {
    const std::size_t pixel = k / std::size_t(picture.channels);
    picture.data[k] = float(exposure->factor * (r.specular.data[pixel] + (matt ? exposure->albedo * r.diffuse.data[pixel] : 0)));
  }
  return picture;
}

Outcome<Image> photographOf(const Inspection& in, int frame, int every, const ProgressFn& progress) {
  require(frame >= 0 && frame < int(in.given->frames.size()), "photographOf: there is no such frame");
  if (!picturesAreSynthesised(in)) return readPhotograph(in.given->frames[std::size_t(frame)]);
  Outcome<Image> picture = linearImageOf(in, frame, FrameSource::Image, every, progress);
  if (picture)
    for (float& v : picture->data) v = float(srgbFromLinear(std::clamp(double(v), 0.0, 1.0)));
  return picture;
}

}  // namespace glint
