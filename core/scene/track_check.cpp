// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/track_check.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/number_text.h"
#include "core/capture/capture.h"
#include "core/scene/capture_scene.h"

namespace glint {
namespace {

constexpr std::size_t kMostPoints = 4000;  // of a sample: more do not change a median, and each takes a ray

double quantile(std::vector<double>& values, double q) {
  return values.empty() ? 0 : ranked(values, static_cast<std::size_t>(q * double(values.size() - 1)));
}

void compareObservations(const Scene& scene, const std::vector<CaptureTrack>& tracks, TrackCheck& check) {
  std::vector<double> distances, shiftX, shiftY;
  for (const CaptureTrack& track : tracks)
    for (const CaptureTrack::Observation& o : track.seen) {
      const Camera& camera = scene.frames.at(static_cast<std::size_t>(o.view)).camera;
      ++check.observations;
      const std::optional<Pixel> ideal = camera.project(track.point);
      if (!ideal) {
        ++check.behind;
        continue;
      }
      const Pixel shift = o.measured - camera.distorted(*ideal);
      if (!shift.allFinite()) continue;
      distances.push_back(shift.norm());
      shiftX.push_back(shift.x());
      shiftY.push_back(shift.y());
    }
  check.medianPx = quantile(distances, 0.5);
  check.p95Px = quantile(distances, 0.95);
  check.shiftPx = {quantile(shiftX, 0.5), quantile(shiftY, 0.5)};
}

void compareSurface(const Scene& scene, const std::vector<CaptureTrack>& tracks, TrackCheck& check) {
  constexpr double kAgree = 0.01;  // of the distance: sparse points scatter by some tenths of a percent
  const SurfaceCache surfaces(scene);
  std::vector<double> ratios;
  const std::size_t step = std::max<std::size_t>(1, tracks.size() / kMostPoints);
  for (std::size_t i = 0; i < tracks.size(); i += step) {
    if (tracks[i].seen.empty()) continue;
    const int frame = tracks[i].seen.front().view;
    if (scene.frames[static_cast<std::size_t>(frame)].surface.empty()) return;  // depth maps are compared elsewhere
    const Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(frame, {});
    if (!surface) return;
    const Eigen::Vector3d eye = scene.frames[static_cast<std::size_t>(frame)].camera.centreInWorld();
    const Eigen::Vector3d sight = tracks[i].point - eye;
    if (!(sight.norm() > 0)) continue;
    const Outcome<SurfacePoint> hit = (*surface)->firstHit({eye, sight.normalized()});
    if (!hit) continue;
    const double ratio = (hit->position - eye).norm() / sight.norm();
    ratios.push_back(ratio);
    check.onSurface += std::abs(ratio - 1) < kAgree;
  }
  check.met = static_cast<int>(ratios.size());
  check.depthRatio = quantile(ratios, 0.5);
}

std::vector<SeenPoint> sampleOfTracks(const Scene& scene, const std::vector<CaptureTrack>& tracks) {
  std::vector<SeenPoint> sample;
  const std::size_t step = std::max<std::size_t>(1, tracks.size() / kMostPoints);
  for (std::size_t i = 0; i < tracks.size(); i += step)
    if (!tracks[i].seen.empty())
      sample.push_back({tracks[i].point, scene.frames[std::size_t(tracks[i].seen.front().view)].camera.centreInWorld()});
  return sample;
}

void concludeCameras(TrackCheck& check) {
  constexpr double kGood = 2;         // px: bundle adjustment leaves less than one
  constexpr double kHalfPixel = 0.3;  // px, along x and along y at once: a shift that no distortion or noise makes
  if (2 * check.behind > check.observations) {
    check.findings.push_back(
        formatted("%d of %d sparse points lie behind the cameras that saw them (poses are inverted, or camera "
                  "axes point backwards?)",
                  check.behind, check.observations));
  } else if (check.medianPx > kGood) {
    check.findings.push_back(
        formatted("the capture's own sparse points project %.3g px (median) from where its photographs show "
                  "them (cameras and points of different runs, or images of another size?)",
                  check.medianPx));
  } else if (std::min(std::abs(check.shiftPx.x()), std::abs(check.shiftPx.y())) > kHalfPixel) {
    check.findings.push_back(
        formatted("the capture's own sparse points project (%.2f, %.2f) px beside where its photographs show "
                  "them: the principal point or the points are half a pixel off",
                  -check.shiftPx.x(), -check.shiftPx.y()));
    if (check.shiftPx.x() * check.shiftPx.y() > 0)
      check.correction = principalPointCorrection(std::copysign(0.5, check.shiftPx.x()));
  }
}

void concludeSurface(TrackCheck& check) {
  constexpr int kEnough = 20;       // points: fewer may all be of the background
  constexpr double kFew = 0.05;     // of those that meet the surface
  constexpr double kWrongUnit = 5;  // a factor that no wrong pose makes
  if (check.points < kEnough) return;
  const bool few = check.met < kEnough;
  check.surfaceElsewhere = few || check.onSurface < kFew * check.met;
  if (few) {
    check.findings.push_back(
        formatted("only %d of the capture's sparse points are seen before or on the surface (is the mesh in "
                  "the frame of the cameras?)",
                  check.met));
  } else if (check.surfaceElsewhere) {
    const bool unit = check.depthRatio > kWrongUnit || check.depthRatio < 1 / kWrongUnit;
    check.findings.push_back(
        formatted("the surface passes through %d of the %d sparse points that it should: it lies at %.3g times their distance ",
                  check.onSurface, check.met, check.depthRatio) +
        (unit ? "(--surface-units, or a mesh of another scale?)" : "(is the mesh in the frame of the cameras?)"));
  }
}

}  // namespace

std::optional<TrackCheck> checkTracks(const Scene& scene, const ProgressFn& progress) {
  const CaptureReader* reader = captureReaderNamed(scene.kind);
  if (!reader) return std::nullopt;
  if (!report(progress, {"sparse points", 0, 1})) throw Stopped{};
  const CaptureOptions options = captureOptionsOf(scene);
  const Capture capture = reader->read(scene.file, options);
  std::vector<CaptureTrack> tracks = reader->tracks(capture, options);
  if (tracks.empty() || capture.views.size() != scene.frames.size()) return std::nullopt;
  const double metres = scene.choices.metresPerUnit.value_or(capture.metresPerUnit);
  for (CaptureTrack& track : tracks) track.point *= metres;
  TrackCheck check;
  check.points = static_cast<int>(tracks.size());
  compareObservations(scene, tracks, check);
  if (!report(progress, {"sparse points", 1, 2})) throw Stopped{};
  concludeCameras(check);
  if (check.findings.empty()) {  // what the cameras get wrong moves the surface as well
    compareSurface(scene, tracks, check);
    concludeSurface(check);
    if (check.surfaceElsewhere) check.sample = sampleOfTracks(scene, tracks);
  }
  return check;
}

}  // namespace glint
