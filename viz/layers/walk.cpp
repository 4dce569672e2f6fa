// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/numeric.h"
#include "viz/glyphs.h"
#include "viz/layers.h"
#include "viz/lit_parts.h"
#include "viz/walk_story.h"

namespace glint::viz {
namespace {

constexpr std::size_t kNormalsEvery = 4;  // places passed: each one's normal would be a hedge

/// The part of a circle between two unit vectors.
TriangleMesh sector(const Eigen::Vector3d& centre, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  constexpr int kParts = 12;
  TriangleMesh mesh;
  mesh.vertices.push_back(centre);
  for (int i = 0; i <= kParts; ++i) {
    const double t = static_cast<double>(i) / kParts;
    mesh.vertices.push_back(centre + radius * ((1 - t) * a + t * b).normalized());
    if (i > 0) mesh.triangles.push_back({0, i, i + 1});
  }
  return mesh;
}

/// Places that were passed, their normals, and the end where the limit angle is reached.
void addTrail(LayerContent& content, const std::vector<WalkPlace>& places, int visited, const Colour& colour, double size,
              double width, const Eigen::Vector3d& lift, const Picked& info) {
  if (visited == 0) return;
  Points trail;
  std::vector<Segment> normals;
  for (std::size_t i = 0; i < static_cast<std::size_t>(visited); ++i) {
    trail.push_back(places[i].position + lift);
    if (i % kNormalsEvery == 0) normals.emplace_back(trail.back(), trail.back() + 0.45 * size * places[i].normal);
  }
  if (trail.size() > 1) content.add(lineActor({trail}, colour, width), info, width);
  content.add(segmentActor(normals, colour, 1.2), info, 1.2);
  if (static_cast<std::size_t>(visited) == places.size()) content.add(sphereActor({trail.back()}, 0.035 * size, colour), info);
}

}  // namespace

LayerContent walkLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.walk || in.walk->frame != in.selection.frame) return content;
  const WalkStory& story = *in.walk;
  const WalkStory::Moment now = story.at(in.walkStep);
  const WalkPlace& place = story.place(now);
  const double size = std::max(story.trace.reachOnSurface, story.trace.reachOnPlane);
  const Eigen::Vector3d lift = std::min(in.scale.lift, 0.01 * size) * story.normal;
  const Colour surface = in.ink(), plane = canonicalColour();
  Picked info;
  info.layer = "walk";
  info.frame = story.frame;
  info.model = story.model;
  info.light = story.light;
  info.direction = story.direction;
  info.text = line(story.inverse ? "inverse walk of frame" : "walk of frame", in.frame(story.frame).id) +
              line("limit angle", degrees(story.trace.limitAngle), "deg") + line("reach on S", story.trace.reachOnSurface, "m") +
              line("reach on T", story.trace.reachOnPlane, "m");
  const Eigen::Vector3d origin = story.trace.onPlane.front().position + lift;
  const double disc = 1.12 * size;
  content.drawn.push_back({named(discActor(origin, story.normal, disc, kVirtualCamera, 0.16), "plane"), info, 0, false});
  const Eigen::Vector3d across = story.normal.cross(story.along);
  content.add(lineActor({circle(origin, disc * story.along, disc * across)}, kVirtualCamera, 1.0), info, 1.0);
  // Seen from above, S hardly lies under T: the wider trail shows beside the other.
  addTrail(content, story.trace.onSurface, now.visitedOnSurface, surface, size, 5.0, lift, info);
  addTrail(content, story.trace.onPlane, now.visitedOnPlane, plane, size, 2.5, lift, info);
  // The foot under the point of T: the gap that the walk on S crosses.
  if (now.onSurface) content.add(segmentActor({{place.onTangentPlane + lift, place.position + lift}}, plane, 1.2), info, 1.2);
  const Eigen::Vector3d at = place.position + lift, half = story.half(place);
  const Colour& own = now.onSurface ? surface : plane;
  const double arrow = 0.75 * size, shaft = 0.012 * size;
  content.add(named(segmentActor(dashed(at, at + 1.3 * size * story.toEye(place), 0.05 * size), kVirtualCamera, 1.2), "camera"),
              info, 1.2);
  content.add(named(segmentActor(dashed(at, at + 1.3 * size * story.toLight(place), 0.05 * size), kLightColour, 1.2), "light"),
              info, 1.2);
  content.add(sphereActor({at}, 0.045 * size, own), info);
  content.drawn.push_back(
      {named(sheetActor(sector(at, place.normal, half, 0.9 * arrow), kFailed, 0.55), "angle"), info, 0, false});
  content.add(named(arrowActor({{at, at + arrow * place.normal}}, shaft, own), "normal"), info);
  content.add(named(arrowActor({{at, at + arrow * half}}, shaft, kLightColour), "half"), info);
  content.labels.push_back({at + 1.05 * arrow * place.normal, walkText(story, in.walkStep), in.ink()});
  return content;
}

}  // namespace glint::viz
