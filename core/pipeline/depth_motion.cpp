// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/depth_motion.h"

#include <algorithm>
#include <cmath>

#include "core/base/numeric.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr std::size_t kDepthsKept = 16;  // those of one panel, and of the frames that ask
constexpr double kSameDepth = 0.02;      // of the distance: a Kinect's noise at 3 m is half of it
constexpr double kNearPx = 8;            // more than a match may be off (kMatchPx, kMatchShare): this look must lose none
constexpr double kNearShare = 0.5;       // of the radius
constexpr int kAnswers = 2;              // views without which no spot is paint

/// What other depth maps and their candidates say about one spot, before its surface is built.
struct QuickLook {
  int known = 0;    ///< views whose depth map has the point
  int near = 0;     ///< of them, those with a candidate near it
  int waiting = 0;  ///< of them, those not searched yet
};

bool anyNear(const FrameEvidence& e, const Pixel& place) {
  const auto near = [&](const Highlight& h) {
    const double radius = std::sqrt(std::max(0.0, h.areaPx2) / M_PI);
    return (centroid(h.contour) - place).norm() <= std::max(kNearPx, kNearShare * radius);
  };
  return std::any_of(e.highlights.begin(), e.highlights.end(), near) ||
         std::any_of(e.textures.begin(), e.textures.end(), [&](const WithheldTexture& t) { return near(t.highlight); });
}

/// Nothing if the frame's own depth has no point there.
std::optional<QuickLook> quickLook(const Scene& scene, int frame, const Highlight& h, const std::vector<int>& panel,
                                   const std::vector<FrameEvidence>& evidence, const PanelDepths& depths) {
  if (h.fromScene || h.contour.points.size() < 3) return std::nullopt;
  const Camera& camera = scene.frames[static_cast<std::size_t>(frame)].camera;
  const Pixel centre = centroid(h.contour);
  const std::optional<double> depth = depths.at(frame, centre);
  if (!depth) return std::nullopt;
  const Eigen::Vector3d inCamera = camera.pixelFromRay.inverse() * centre.homogeneous() * *depth;
  const Eigen::Vector3d point = camera.camFromWorld.inverse() * inCamera;
  QuickLook look;
  for (const int other : panel) {
    if (!depths.has(other, point)) continue;
    const std::optional<Pixel> place = scene.frames[static_cast<std::size_t>(other)].camera.project(point);
    const FrameEvidence& e = evidence[static_cast<std::size_t>(other)];
    ++look.known;
    look.waiting += e.frame < 0;
    look.near += e.frame >= 0 && place && anyNear(e, *place);
  }
  return look;
}

}  // namespace

PanelDepths::PanelDepths(const Scene& scene, const Settings& settings) : scene_(scene), policy_(depthPolicy(settings)) {}

std::shared_ptr<const Image> PanelDepths::image(int frame) const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto known = std::find_if(recent_.begin(), recent_.end(), [&](const auto& r) { return r.first == frame; });
    if (known != recent_.end()) {
      recent_.splice(recent_.begin(), recent_, known);
      return recent_.front().second;
    }
  }
  std::shared_ptr<const Image> read;
  try {
    if (Outcome<std::optional<Image>> depth = readDepth(scene_.frames[static_cast<std::size_t>(frame)], policy_); depth && *depth)
      read = std::make_shared<const Image>(*std::move(*depth));
  } catch (const InputError&) {
    // The user of the depth map reports it.
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  recent_.emplace_front(frame, read);
  if (recent_.size() > kDepthsKept) recent_.pop_back();
  return read;
}

std::optional<double> PanelDepths::at(int frame, const Pixel& ideal) const {
  const std::shared_ptr<const Image> depth = image(frame);
  const Pixel measured = scene_.frames[static_cast<std::size_t>(frame)].camera.distorted(ideal);
  if (!depth || !measured.allFinite() || measured.minCoeff() < 0 || measured.x() > depth->width - 1 ||
      measured.y() > depth->height - 1)
    return std::nullopt;
  const int x0 = static_cast<int>(std::lround(measured.x())), y0 = static_cast<int>(std::lround(measured.y()));
  std::vector<float> values;
  for (int y = std::max(0, y0 - 1); y <= std::min(depth->height - 1, y0 + 1); ++y)
    for (int x = std::max(0, x0 - 1); x <= std::min(depth->width - 1, x0 + 1); ++x)
      if (depth->at(x, y) > 0) values.push_back(depth->at(x, y));
  constexpr std::size_t kMost = 5;  // of nine
  if (values.size() < kMost) return std::nullopt;
  return upperMedian(values);
}

bool PanelDepths::has(int frame, const Eigen::Vector3d& point) const {
  const Camera& camera = scene_.frames[static_cast<std::size_t>(frame)].camera;
  const std::optional<Pixel> pixel = camera.project(point);
  if (!pixel) return false;
  const std::optional<double> depth = at(frame, *pixel);
  const double expected = (camera.camFromWorld * point).z();
  return depth && std::abs(*depth - expected) <= kSameDepth * expected;
}

std::vector<MotionVerdict> judgedByMotion(const Scene& scene, int frame, const std::vector<int>& panel,
                                          const std::vector<FrameEvidence>& evidence,
                                          const std::function<std::shared_ptr<const Surface>()>& surface,
                                          const PanelDepths& depths, const Settings& settings) {
  const std::vector<Highlight>& highlights = evidence[static_cast<std::size_t>(frame)].highlights;
  std::vector<MotionVerdict> verdicts(highlights.size());
  if (highlights.empty() || panel.empty()) return verdicts;
  if (!scene.frames[static_cast<std::size_t>(frame)].surface.empty())
    return motionVerdicts(scene, frame, panel, evidence, surface().get(), settings);
  bool waits = false, worthIt = false;
  std::vector<char> apart(highlights.size(), 0);
  for (std::size_t i = 0; i < highlights.size(); ++i) {
    const std::optional<QuickLook> look = quickLook(scene, frame, highlights[i], panel, evidence, depths);
    if (!look) continue;
    apart[i] = look->known == 0;
    if (look->near + look->waiting < std::min(kAnswers, look->known) || look->known == 0) continue;
    worthIt = true;
    if (look->waiting == 0) continue;
    waits = true;
    verdicts[i].kind = MotionVerdict::Kind::Waiting;
  }
  if (waits) return verdicts;
  if (worthIt) verdicts = motionVerdicts(scene, frame, panel, evidence, surface().get(), settings, &depths);
  for (std::size_t i = 0; i < highlights.size(); ++i)
    if (apart[i]) {
      verdicts[i].kind = MotionVerdict::Kind::CannotTell;
      verdicts[i].apart = true;
    }
  return verdicts;
}

}  // namespace glint
