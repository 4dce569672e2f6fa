// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/highlight_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/base/number_text.h"
#include "core/light/estimate.h"
#include "core/pipeline/depth_motion.h"
#include "core/surface/brightest_point.h"

namespace glint {
namespace {

constexpr std::size_t kPanel = 12;    // views that are asked: more cost time and say the same
constexpr int kCarriedPoints = 36;    // of a contour: as many directions as a prediction has
constexpr double kEdgeOn = 0.2;       // cosine: beyond it a pixel covers five times its width on the surface
constexpr double kBesidePx = 2;       // beyond the contour: no surface there means that it runs along the silhouette
constexpr double kMostBeside = 0.05;  // of the contour: less is a touch of a few pixels
constexpr double kMatchPx = 2;        // middles of contours of the same paint: poses and pixels leave that open,
constexpr double kMatchShare = 0.15;  // of the radius, as well as the background under them
constexpr double kLeastApartPx = 4;   // between the two places
constexpr double kLikeArea = 3;       // factor: the level follows the strongest peak of each frame
constexpr double kLikeStrength = 3;   // factor: exposures differ
constexpr double kFoundAbove = 1.3;   // over the level: weaker spots may be missed without being away
constexpr double kNearestLamp = 0.2;  // of the camera's distance: what nearer lamps do is measured against this one
constexpr double kNextLamp = 3;       // times as far: the places of the highlights in between lie on about a straight line
constexpr double kTouching = 0.1;     // of the motion of the nearest lamp's highlight: a lamp within a fiftieth of the distance
constexpr int kLeastViews = 2;        // one may find another spot there by chance
constexpr int kMajority = 3;          // as many for paint as against it
constexpr double kOtherSideDeg = 1;   // views within that see the same
constexpr double kHighlightShare = 0.5;  // of the radius: a highlight's middle is not its mirror point
constexpr double kLeastNoisePx = 0.05;   // of a middle: exact images have that from their pixels
constexpr double kWorthTheArea = 1.5;    // over the least area that is detected

constexpr const char* kOwnDepth = "depth:";  // as SurfaceCache::keyOf without a frame: all of them are asked
constexpr const char* kOnlyTexture = "every bright spot stays on the surface: texture";

double radiusOf(double areaPx2) { return std::sqrt(std::max(0.0, areaPx2) / M_PI); }
bool alike(double a, double b, double factor) { return a <= factor * b && b <= factor * a; }

/// A spot on the surface.
struct Spot {
  SurfacePoint middle;                   ///< under the middle of its contour, normal on the camera's side
  std::vector<Eigen::Vector3d> outline;  ///< its contour
  ReflectedRay mirrored;
  double distance = 0;  ///< from its camera
};

std::optional<Spot> spotOf(const Highlight& h, const Camera& camera, const Surface& surface) {
  if (h.touchesBorder || h.contour.points.size() < 3) return std::nullopt;
  const Pixel centre = centroid(h.contour);
  const Outcome<BrightestPoint> middle = observedBrightestPoint(surface, camera, centre);
  if (!middle) return std::nullopt;
  Spot spot;
  spot.middle = middle->point;
  spot.mirrored = reflectedRay(*middle, camera);
  const Eigen::Vector3d towards = camera.centreInWorld() - spot.middle.position;
  spot.distance = towards.norm();
  if (!(spot.middle.normal.dot(towards) > kEdgeOn * spot.distance)) return std::nullopt;
  int beside = 0;
  for (const Pixel& p : resample(h.contour, kCarriedPoints)) {
    const Outcome<SurfacePoint> on = surface.firstHit(camera.ray(p));
    const Pixel outwards = (p - centre).normalized();
    beside += !on || !outwards.allFinite() || !surface.firstHit(camera.ray(p + kBesidePx * outwards));
    if (on) spot.outline.push_back(on->position);
  }
  if (beside > kMostBeside * kCarriedPoints || spot.outline.size() < 3) return std::nullopt;
  return spot;
}

/// Where paint is in another view.
struct Place {
  Pixel middle;
  double areaPx2 = 0;
  double tolerance() const { return std::max(kMatchPx, kMatchShare * radiusOf(areaPx2)); }
};

/// Nothing if the view does not see all of it, or nearly edge-on.
std::optional<Place> placeIn(const Camera& camera, const Surface& surface, const Spot& spot) {
  const Eigen::Vector3d towards = camera.centreInWorld() - spot.middle.position;
  if (!(spot.middle.normal.dot(towards) > kEdgeOn * towards.norm())) return std::nullopt;
  Polyline line;
  for (const Eigen::Vector3d& p : spot.outline) {
    const std::optional<Pixel> pixel = camera.project(p);
    if (!pixel) return std::nullopt;
    const Pixel measured = camera.distorted(*pixel);
    if (!measured.allFinite() || measured.minCoeff() < kMatchPx || measured.x() > camera.width - 1 - kMatchPx ||
        measured.y() > camera.height - 1 - kMatchPx)
      return std::nullopt;
    line.points.push_back(*pixel);
  }
  if (surface.occluded(spot.middle, camera.centreInWorld())) return std::nullopt;
  return Place{centroid(line), std::abs(signedArea(line))};
}

double distanceToSegment(const Pixel& p, const Pixel& a, const Pixel& b) {
  const Pixel along = b - a;
  const double t = along.squaredNorm() > 0 ? std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0) : 0;
  return (p - a - t * along).norm();
}

/// Where a highlight would be in another view: the brightest points of lamps ever farther away along the mirrored ray.
struct Path {
  std::vector<std::vector<Pixel>> places;  ///< of each lamp, from near to far; empty if none is seen
  bool empty() const {
    return std::all_of(places.begin(), places.end(), [](const auto& p) { return p.empty(); });
  }
  double distanceTo(const Pixel& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t lamp = 0; lamp < places.size(); ++lamp)
      for (const Pixel& a : places[lamp]) {
        least = std::min(least, (a - p).norm());
        if (lamp + 1 == places.size() || places[lamp + 1].empty()) continue;
        const auto next = std::min_element(places[lamp + 1].begin(), places[lamp + 1].end(), [&](const Pixel& x, const Pixel& y) {
          return (x - a).squaredNorm() < (y - a).squaredNorm();
        });
        least = std::min(least, distanceToSegment(p, a, *next));
      }
    return least;
  }
};

/// @param moved  how the lamps have moved since the spot was seen
Path pathIn(const Camera& camera, const Surface& surface, const Spot& spot, const Eigen::Isometry3d& moved) {
  const double near = kNearestLamp * spot.distance;
  Path path;
  for (const double away : {near, kNextLamp * near, std::numeric_limits<double>::infinity()}) {
    const Light lamp = std::isfinite(away)
                           ? Light::at(moved * Eigen::Vector3d(spot.mirrored.origin + away * spot.mirrored.direction))
                           : Light::towards(moved.linear() * spot.mirrored.direction);
    path.places.emplace_back();
    const Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(surface, camera, lamp);
    if (!found) continue;
    for (const BrightestPoint& b : *found) path.places.back().push_back(b.pixel);
  }
  return path;
}

/// As detected: with what was withheld.
std::vector<Highlight> candidatesOf(const FrameEvidence& e) {
  if (e.asSeen) return candidatesOf(*e.asSeen);
  std::vector<Highlight> all = e.highlights;
  for (const WithheldTexture& t : e.textures) all.push_back(t.highlight);
  return all;
}

bool isGiven(const Frame& frame) { return !frame.highlights.empty(); }

/// What one view says.
struct Answer {
  enum class Says { Nothing, Stays, Alike, Away } says = Says::Nothing;
  int side = 0;                    ///< from which the view sees the spot
  Pixel left{0, 0};                ///< from where paint would be to where it is found
  std::optional<Pixel> ofNearest;  ///< the same of the nearest lamp's highlight
};

/// One spot, asked about in other views.
class Judge {
 public:
  Judge(const Highlight& h, const Camera& camera, const Surface& surface, const Spot& spot, double level, double minAreaPx2)
      : h_(h), camera_(camera), surface_(surface), spot_(spot), level_(level), minAreaPx2_(minAreaPx2) {}

  /// Whether the spot is on its point, without a look at where a highlight would be: Nothing, Alike or Away.
  Answer first(const Camera& camera, const FrameEvidence& evidence) const;
  /// Whether a highlight would be elsewhere: an answer Alike may become Stays.
  void second(const Camera& camera, const FrameEvidence& evidence, Answer& answer) const;
  MotionVerdict verdict(const std::vector<Answer>& answers) const;

 private:
  bool isExpected(const std::vector<Highlight>& candidates, const Place& place) const;
  const Highlight* foundAt(const std::vector<Highlight>& candidates, const Place& place) const;

  const Highlight& h_;
  const Camera& camera_;
  const Surface& surface_;
  const Spot& spot_;
  double level_, minAreaPx2_;
};

bool Judge::isExpected(const std::vector<Highlight>& candidates, const Place& place) const {
  if (place.areaPx2 < kWorthTheArea * minAreaPx2_) return false;
  if (h_.clipped || candidates.empty()) return true;
  double strongest = 0;
  for (const Highlight& c : candidates) {
    if (c.clipped) return false;  // its strength is unknown
    strongest = std::max(strongest, c.peakValue);
  }
  return h_.peakValue >= kFoundAbove * level_ * strongest;
}

const Highlight* Judge::foundAt(const std::vector<Highlight>& candidates, const Place& place) const {
  const Highlight* best = nullptr;
  double nearest = place.tolerance();
  for (const Highlight& c : candidates) {
    const double off = (centroid(c.contour) - place.middle).norm();
    const bool strengthKnown = !c.clipped && !h_.clipped && c.peakValue > 0 && h_.peakValue > 0;
    if (!(off <= nearest) || !alike(c.areaPx2, place.areaPx2, kLikeArea) ||
        (strengthKnown && !alike(c.peakValue, h_.peakValue, kLikeStrength)))
      continue;
    best = &c;
    nearest = off;
  }
  return best;
}

/// Another bright spot lies over the place, or has grown together with what is there.
bool isCovered(const std::vector<Highlight>& candidates, const Place& place) {
  return std::any_of(candidates.begin(), candidates.end(), [&](const Highlight& c) {
    return contains(c.contour, place.middle) || distance(c.contour, place.middle) < radiusOf(place.areaPx2);
  });
}

Answer Judge::first(const Camera& camera, const FrameEvidence& evidence) const {
  Answer answer;
  if (evidence.failure && evidence.failure->reason != Reason::NoHighlight) return answer;
  const std::optional<Place> place = placeIn(camera, surface_, spot_);
  if (!place) return answer;
  const std::vector<Highlight> candidates = candidatesOf(evidence);
  if (const Highlight* there = foundAt(candidates, *place)) {
    answer.says = Answer::Says::Alike;
    answer.left = centroid(there->contour) - place->middle;
  } else if (isExpected(candidates, *place) && !isCovered(candidates, *place)) {
    answer.says = Answer::Says::Away;
  }
  return answer;
}

void Judge::second(const Camera& camera, const FrameEvidence& evidence, Answer& answer) const {
  const std::optional<Place> place = placeIn(camera, surface_, spot_);
  if (!place) return;
  const std::vector<Highlight> candidates = candidatesOf(evidence);
  const Highlight* const there = foundAt(candidates, *place);
  const double apart = std::max(kLeastApartPx, 2 * place->tolerance());
  bool predicted = false;
  for (const Eigen::Isometry3d& moved : {Eigen::Isometry3d::Identity(), camera.camFromWorld.inverse() * camera_.camFromWorld}) {
    const Path path = pathIn(camera, surface_, spot_, moved);
    if (path.empty()) continue;
    predicted = true;
    if (path.distanceTo(place->middle) < apart) return;
    for (const Highlight& c : candidates) {
      const double near = std::max(kLeastApartPx, kHighlightShare * radiusOf(c.areaPx2));
      if (&c != there && alike(c.areaPx2, place->areaPx2, kLikeArea) && path.distanceTo(centroid(c.contour)) < near) return;
    }
    for (const Pixel& p : path.places.front())
      if (!answer.ofNearest || (p - place->middle).norm() < answer.ofNearest->norm()) answer.ofNearest = p - place->middle;
  }
  if (predicted) answer.says = Answer::Says::Stays;
}

/// Regression of what is left of the motion on that of the nearest lamp's highlight: its share, plus twice its standard
/// deviation. Infinity where nothing is known.
double shareOfNearest(const std::vector<const Answer*>& stays) {
  double across = 0, along = 0, rest = 0;
  int n = 0;
  for (const Answer* a : stays) {
    if (!a->ofNearest) continue;
    along += a->ofNearest->squaredNorm();
    across += a->left.dot(*a->ofNearest);
    ++n;
  }
  if (n < kLeastViews || !(along > 0)) return std::numeric_limits<double>::infinity();
  const double share = across / along;
  for (const Answer* a : stays)
    if (a->ofNearest) rest += (a->left - share * *a->ofNearest).squaredNorm();
  const double sigma = std::max(kLeastNoisePx, std::sqrt(rest / (2 * n - 1)));
  return std::max(0.0, share) + 2 * sigma / std::sqrt(along);
}

/// Views that see the spot from one side agree and count once; one of them that contradicts paint counts.
std::set<int> sidesWith(const std::vector<Answer>& answers, Answer::Says says) {
  std::set<int> sides;
  for (const Answer& a : answers)
    if (a.says == says) sides.insert(a.side);
  return sides;
}

MotionVerdict Judge::verdict(const std::vector<Answer>& answers) const {
  MotionVerdict v;
  std::vector<const Answer*> staying;
  for (const Answer& a : answers) {
    v.alike += a.says == Answer::Says::Alike;
    if (a.says == Answer::Says::Stays) staying.push_back(&a);
  }
  const std::set<int> away = sidesWith(answers, Answer::Says::Away);
  std::set<int> stays = sidesWith(answers, Answer::Says::Stays);
  std::erase_if(stays, [&](int side) { return away.count(side) > 0; });
  v.stays = static_cast<int>(stays.size());
  v.away = static_cast<int>(away.size());
  if (v.stays > 0) v.lampWithin = shareOfNearest(staying) * kNearestLamp * spot_.distance;
  if (v.stays >= kLeastViews && v.stays >= kMajority * v.away && v.lampWithin <= kTouching * kNearestLamp * spot_.distance)
    v.kind = MotionVerdict::Kind::Texture;
  else if (v.stays + v.alike >= kLeastViews && v.stays + v.alike >= kMajority * v.away)
    v.kind = MotionVerdict::Kind::CannotTell;
  return v;
}

/// Whether it may be paint, if all views that have not answered yet suggest it.
bool mayBeTexture(const std::vector<Answer>& answers, int waiting) {
  const int away = static_cast<int>(sidesWith(answers, Answer::Says::Away).size());
  const int there = waiting + static_cast<int>(std::count_if(answers.begin(), answers.end(),
                                                             [](const Answer& a) { return a.says == Answer::Says::Alike; }));
  return there >= kLeastViews && there >= kMajority * away;
}

/// What is said where too few views see a spot: nothing, unless it stays in all that do.
MotionVerdict tooFew(const std::vector<Answer>& answers) {
  MotionVerdict v;
  for (const Answer& a : answers) {
    v.alike += a.says == Answer::Says::Alike;
    v.away += a.says == Answer::Says::Away;
  }
  if (v.alike > 0 && v.away == 0) v.kind = MotionVerdict::Kind::CannotTell;
  return v;
}

/// Each camera's side of a point: cameras within a degree of the first one of a side belong to that side.
std::vector<int> sidesOf(const std::vector<const Camera*>& cameras, const Eigen::Vector3d& point) {
  std::vector<Eigen::Vector3d> first;
  std::vector<int> sides;
  for (const Camera* camera : cameras) {
    const Eigen::Vector3d towards = (camera->centreInWorld() - point).normalized();
    const auto same = std::find_if(first.begin(), first.end(), [&](const Eigen::Vector3d& s) {
      return s.dot(towards) > std::cos(kOtherSideDeg * M_PI / 180);
    });
    sides.push_back(static_cast<int>(same - first.begin()));
    if (same == first.end()) first.push_back(towards);
  }
  return sides;
}

}  // namespace

MotionUse motionUse(const Settings& settings) {
  const std::string& use = settings.text("detect.motion");
  return use == "off" ? MotionUse::Off : use == "flag" ? MotionUse::Flag : MotionUse::Reject;
}

std::string MotionVerdict::text() const {
  if (kind == Kind::Texture)
    return formatted(
        "texture: it stays on the surface in %d of %d views in which a highlight would have left its place (else a lamp within "
        "%.2g m of the surface, or relief that the surface does not have)",
        stays, stays + away, lampWithin);
  if (kind != Kind::CannotTell) return "";
  if (apart)
    return "its motion cannot tell highlight and texture: the surface is this frame's own depth map, and that of no other view "
           "has its "
           "point (the object bends or moves, poses and depth do not agree, or no other view sees it)";
  if (stays + alike < kLeastViews)
    return formatted(
        "it stays on the surface in the only other view that would show it: its motion cannot tell highlight and texture, %d "
        "views "
        "must be asked",
        kLeastViews);
  const std::string found =
      formatted("it stays on the surface in %d other views: its motion cannot tell highlight and texture, ", stays + alike);
  if (stays < kLeastViews) return found + "a highlight would stay near it too (the views are too close for a spot of its size)";
  if (stays < kMajority * away) return found + formatted("%d views that should show it there do not", away);
  return found + (std::isfinite(lampWithin) ? formatted("a lamp within %.2g m of the surface would do that too", lampWithin)
                                            : "no lamp could be tried");
}

std::vector<std::vector<int>> motionPanels(const Scene& scene, const SurfaceCache& surfaces) {
  std::map<std::string, std::vector<int>> seeing;
  for (int f = 0; f < static_cast<int>(scene.frames.size()); ++f) {
    const Frame& frame = scene.frames[static_cast<std::size_t>(f)];
    if (isGiven(frame) || (frame.surface.empty() && frame.depth.empty())) continue;
    seeing[frame.surface.empty() ? kOwnDepth : surfaces.keyOf(f)].push_back(f);
  }
  std::vector<std::vector<int>> panels(scene.frames.size());
  for (const auto& [key, frames] : seeing) {
    std::vector<int> asked;
    const std::size_t n = std::min(kPanel, frames.size());
    for (std::size_t i = 0; i < n; ++i) asked.push_back(frames[i * frames.size() / n]);
    for (const int f : frames) {
      std::vector<int>& panel = panels[static_cast<std::size_t>(f)];
      std::copy_if(asked.begin(), asked.end(), std::back_inserter(panel), [&](int other) { return other != f; });
    }
  }
  return panels;
}

std::vector<MotionVerdict> motionVerdicts(const Scene& scene, int frame, const std::vector<int>& panel,
                                          const std::vector<FrameEvidence>& evidence, const Surface* surface,
                                          const Settings& settings, const PanelDepths* depths) {
  const Camera& camera = scene.frames[static_cast<std::size_t>(frame)].camera;
  const std::vector<Highlight>& highlights = evidence[static_cast<std::size_t>(frame)].highlights;
  std::vector<MotionVerdict> verdicts(highlights.size());
  std::vector<const Camera*> cameras;
  for (const int f : panel) cameras.push_back(&scene.frames[static_cast<std::size_t>(f)].camera);
  for (std::size_t i = 0; surface && i < highlights.size(); ++i) {
    const std::optional<Spot> spot = spotOf(highlights[i], camera, *surface);
    if (highlights[i].fromScene || !spot) continue;
    const Judge judge(highlights[i], camera, *surface, *spot, settings.number("detect.level"),
                      settings.number("detect.min_area"));
    const std::vector<int> sides = sidesOf(cameras, spot->middle.position);
    std::vector<Answer> answers;
    int waiting = 0;
    for (std::size_t k = 0; k < panel.size(); ++k) {
      const FrameEvidence& e = evidence[static_cast<std::size_t>(panel[k])];
      const bool silent = depths && !depths->has(panel[k], spot->middle.position);
      answers.push_back(e.frame < 0 || silent ? Answer{} : judge.first(*cameras[k], e));
      answers.back().side = sides[k];
      waiting += e.frame < 0 && !silent;
    }
    if (!mayBeTexture(answers, waiting)) {
      if (waiting == 0) verdicts[i] = tooFew(answers);
      continue;
    }
    if (waiting > 0) {
      verdicts[i].kind = MotionVerdict::Kind::Waiting;
      continue;
    }
    for (std::size_t k = 0; k < panel.size(); ++k)
      if (answers[k].says == Answer::Says::Alike)
        judge.second(*cameras[k], evidence[static_cast<std::size_t>(panel[k])], answers[k]);
    verdicts[i] = judge.verdict(answers);
  }
  return verdicts;
}

void withholdTextures(FrameEvidence& e, const std::vector<MotionVerdict>& verdicts, const Camera& camera) {
  require(verdicts.size() == e.highlights.size() && e.textures.empty(), "withholdTextures: one verdict for each highlight");
  std::vector<Highlight> kept;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    Highlight& h = e.highlights[i];
    if (verdicts[i].kind != MotionVerdict::Kind::Texture) {
      kept.push_back(std::move(h));
      continue;
    }
    const std::string reason = verdicts[i].text();
    e.rejected.push_back({camera.distorted(centroid(h.contour)), h.areaPx2, reason});
    e.textures.push_back({static_cast<int>(i), std::move(h), reason});
  }
  e.highlights = std::move(kept);
  if (e.textures.empty()) return;
  std::stable_sort(e.rejected.begin(), e.rejected.end(), [](const auto& a, const auto& b) { return a.areaPx2 > b.areaPx2; });
  if (e.highlights.empty()) e.failure = Failure{Reason::NoHighlight, kOnlyTexture};
}

void returnTextures(FrameEvidence& e) {
  if (e.textures.empty()) return;
  if (e.highlights.empty()) e.failure.reset();
  for (const WithheldTexture& t : e.textures) {
    e.highlights.insert(e.highlights.begin() + t.place, t.highlight);
    std::erase_if(e.rejected,
                  [&](const RejectedCandidate& r) { return r.reason == t.reason && r.areaPx2 == t.highlight.areaPx2; });
  }
  e.textures.clear();
}

void dropTextures(FrameEvidence& again, const std::vector<WithheldTexture>& textures) {
  std::erase_if(again.highlights, [&](const Highlight& h) {
    return std::any_of(textures.begin(), textures.end(), [&](const WithheldTexture& t) {
      return contains(h.contour, centroid(t.highlight.contour)) && contains(t.highlight.contour, centroid(h.contour));
    });
  });
  if (again.highlights.empty() && !again.failure) again.failure = Failure{Reason::NoHighlight, kOnlyTexture};
}

}  // namespace glint
