// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/track_check.h"

#include <algorithm>
#include <cmath>

#include "core/base/evenly.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/scene/capture.h"
#include "core/scene/scene_reader.h"

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

/// A point of the sample and the frames that saw it. Where the program does not say which did, those that have it in their image,
/// the nearest camera first, because it sees the point's own side of the object best.
struct Sighting {
  Eigen::Vector3d point;
  std::vector<int> frames;
};

/// The nearest frame and others spread over the distances: the nearest ones stand side by side, and one thing may hide a point
/// from all of them.
std::vector<int> framesWithInView(const Scene& scene, const Eigen::Vector3d& point) {
  constexpr std::size_t kMost = 8;  // frames: who sees a point of the object is then among them, and each takes a ray
  std::vector<std::pair<double, int>> having;
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Camera& camera = scene.frames[i].camera;
    const std::optional<Pixel> ideal = camera.project(point);
    const Pixel q = ideal ? camera.distorted(*ideal) : Pixel(-1, -1);
    if (ideal && q.x() >= -0.5 && q.y() >= -0.5 && q.x() < camera.width - 0.5 && q.y() < camera.height - 0.5)
      having.emplace_back((camera.centreInWorld() - point).norm(), static_cast<int>(i));
  }
  std::sort(having.begin(), having.end());
  std::vector<int> frames;
  for (const auto& [distance, frame] : evenly(having, kMost)) frames.push_back(frame);
  return frames;
}

std::vector<Sighting> sightingsOf(const Scene& scene, const std::vector<CaptureTrack>& tracks, const ProgressFn& progress,
                                  TrackCheck& check) {
  const std::size_t step = std::max<std::size_t>(1, tracks.size() / kMostPoints);
  std::vector<Sighting> sightings((tracks.size() + step - 1) / step);
  parallelFor(
      static_cast<int>(sightings.size()),
      [&](int i) {
        const CaptureTrack& track = tracks[std::size_t(i) * step];
        Sighting& s = sightings[std::size_t(i)];
        s.point = track.point;
        if (!check.withTracks)
          s.frames = framesWithInView(scene, track.point);
        else if (!track.seen.empty())
          s.frames = {track.seen.front().view};
      },
      progress, "sparse points");
  check.sampled = static_cast<int>(sightings.size());
  std::erase_if(sightings, [](const Sighting& s) { return s.frames.empty(); });
  check.inView = static_cast<int>(sightings.size());
  return sightings;
}

/// @return whether there is a surface to compare with. One that is made of these very points agrees with them; where no surface
///   can be made of points, the report says why
bool compareSurface(const Scene& scene, const std::vector<Sighting>& sightings, TrackCheck& check) {
  constexpr double kAgree = 0.01;  // of the distance: sparse points scatter by some tenths of a percent
  const SurfaceCache surfaces(scene);
  std::vector<double> ratios;
  for (const Sighting& s : sightings) {
    const Frame& frame = scene.frames[static_cast<std::size_t>(s.frames.front())];
    if (frame.surface.empty()) return false;  // depth maps are compared elsewhere
    if (std::get_if<CapturePoints>(&scene.surfaces.at(frame.surface))) return false;
    const Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(s.frames.front(), {});
    if (!surface) return false;
    const Eigen::Vector3d eye = frame.camera.centreInWorld(), sight = s.point - eye;
    if (!(sight.norm() > 0)) continue;
    const Outcome<SurfacePoint> hit = (*surface)->firstHit({eye, sight.normalized()});
    if (!hit) continue;
    const double ratio = (hit->position - eye).norm() / sight.norm();
    ratios.push_back(ratio);
    check.onSurface += std::abs(ratio - 1) < kAgree;
  }
  check.met = static_cast<int>(ratios.size());
  check.depthRatio = quantile(ratios, 0.5);
  return !sightings.empty();
}

std::vector<SeenPoint> sampleOf(const Scene& scene, const std::vector<Sighting>& sightings) {
  std::vector<SeenPoint> sample;
  for (const Sighting& s : sightings) {
    const auto eye = [&](int frame) { return scene.frames[static_cast<std::size_t>(frame)].camera.centreInWorld(); };
    sample.push_back({s.point, eye(s.frames.front())});
    for (std::size_t k = 1; k < s.frames.size(); ++k) sample.back().orEyes.push_back(eye(s.frames[k]));
  }
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

/// Checks points without a record of which images show them: each one was in at least two images, or it would not exist.
void concludeView(TrackCheck& check) {
  if (2 * check.inView >= check.sampled) return;
  check.findings.push_back(
      formatted("only %d of %d sparse points of a sample lie inside of any image (points of another world than the "
                "cameras, or poses that are inverted?)",
                check.inView, check.sampled));
}

void concludeSurface(TrackCheck& check) {
  constexpr int kEnough = 20;       // points: fewer may all be of the background
  constexpr double kFew = 0.2;      // of those that meet the surface: a wrong one passes through a tenth by chance
  constexpr double kMost = 0.5;     // fewer: another place is sought, and told where it explains them
  constexpr double kWrongUnit = 5;  // a factor that no wrong pose makes
  if (check.points < kEnough) return;
  const bool few = check.met < kEnough;
  check.surfaceElsewhere = few || check.onSurface < kMost * check.met;
  if (few) {
    const std::string number = check.met == 0 ? "none" : formatted("only %d", check.met);
    check.findings.push_back(number +
                             formatted(" of %d sparse points of the capture %s seen before or on the surface (is the mesh in "
                                       "the frame of the cameras?)",
                                       check.inView, check.met <= 1 ? "is" : "are"));
  } else if (check.onSurface < kFew * check.met) {
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
  TrackCheck check;
  std::vector<CaptureTrack> tracks;
  try {
    tracks = reader->tracks(capture, options);
  } catch (const InputError& e) {  // nobody needs them but this check
    check.findings.push_back(std::string("the sparse points cannot be read: ") + e.what());
    return check;
  }
  if (tracks.empty() || capture.views.size() != scene.frames.size()) return std::nullopt;
  const double metres = scene.choices.metresPerUnit.value_or(capture.metresPerUnit);
  for (CaptureTrack& track : tracks) track.point *= metres;
  check.points = static_cast<int>(tracks.size());
  check.withTracks = std::any_of(tracks.begin(), tracks.end(), [](const CaptureTrack& t) { return !t.seen.empty(); });
  compareObservations(scene, tracks, check);
  const std::vector<Sighting> sightings = sightingsOf(scene, tracks, progress, check);
  if (check.withTracks)
    concludeCameras(check);
  else
    concludeView(check);
  if (check.findings.empty()) {  // an error of the cameras moves the surface as well
    if (compareSurface(scene, sightings, check)) concludeSurface(check);
    if (check.surfaceElsewhere) check.sample = sampleOf(scene, sightings);
  }
  return check;
}

}  // namespace glint
