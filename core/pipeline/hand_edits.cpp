// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/hand_edits.h"

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_point.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/number_text.h"
#include "core/geometry/camera.h"
#include "core/highlight/peak.h"
#include "core/pipeline/evidence.h"

namespace glint {
namespace {

using Kind = HighlightEdit::Kind;

constexpr double kJoinStepPx = 1;    // of points along a line that joins or cuts: detection's contours are about as dense
constexpr double kLeastPartPx2 = 1;  // of a part that is cut off: less is no highlight
constexpr int kCutDirections = 180;  // that are tried for the shortest cut: a degree apart
constexpr int kSeedWindowPx =
    48;  // half side of the window that a seed is grown in at first; doubled while its contour leaves it
constexpr double kSeedAreaPx2 = 4;   // smallest region that is grown: the person vouches for it
constexpr double kSeedContrast = 1;  // the same of its height over the background's spread
constexpr double kSeedBesidePx = 2;  // a click this near to a region means it

bool encloses(const Highlight& h, const Pixel& p) { return h.contour.points.size() > 2 && contains(h.contour, p); }

/// The smallest highlight around a place; -1 = none.
int at(const std::vector<Highlight>& highlights, const Pixel& place) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(highlights.size()); ++i) {
    const Highlight& h = highlights[static_cast<std::size_t>(i)];
    if (encloses(h, place) && (best < 0 || h.areaPx2 < highlights[static_cast<std::size_t>(best)].areaPx2)) best = i;
  }
  return best;
}

/// A place inside of the contour: the peak, the centroid, else the middle of the widest chord at the centroid's height.
Pixel placeIn(const Highlight& h) {
  if (encloses(h, h.peak)) return h.peak;
  const Pixel middle = centroid(h.contour);
  if (encloses(h, middle)) return middle;
  std::vector<double> crossings;
  const std::vector<Pixel>& p = h.contour.points;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Pixel &a = p[i], &b = p[(i + 1) % p.size()];
    if ((a.y() > middle.y()) != (b.y() > middle.y()))
      crossings.push_back(a.x() + (middle.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::sort(crossings.begin(), crossings.end());
  Pixel best = middle;
  double widest = 0;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    if (crossings[i + 1] - crossings[i] > widest) {
      widest = crossings[i + 1] - crossings[i];
      best = {(crossings[i] + crossings[i + 1]) / 2, middle.y()};
    }
  return best;
}

/// The points from a towards b, without b.
void addLine(std::vector<Pixel>& points, const Pixel& a, const Pixel& b) {
  const int n = std::max(1, static_cast<int>(std::ceil((b - a).norm() / kJoinStepPx)));
  for (int i = 0; i < n; ++i) points.push_back(a + double(i) / n * (b - a));
}

void describe(Highlight& h) {
  h.areaPx2 = std::abs(signedArea(h.contour));
  h.ellipse.reset();
  if (h.contour.points.size() >= 5)
    if (const Outcome<Ellipse> e = fitEllipse(h.contour.points)) h.ellipse = *e;
  h.otherLevels.clear();
  h.flank = nullptr;  // of the shape as it was seen
  h.trueLevel.reset();
}

/// The convex hull of both, and how much of its length joins them.
Highlight merged(const Highlight& a, const Highlight& b) {
  namespace bg = boost::geometry;
  using Point = bg::model::d2::point_xy<double>;
  bg::model::multi_point<Point> points;
  for (const Highlight* h : {&a, &b})
    for (const Pixel& p : h->contour.points) points.emplace_back(p.x(), p.y());
  bg::model::polygon<Point> hull;
  bg::convex_hull(points, hull);
  std::vector<Pixel> corners;
  for (const Point& p : hull.outer()) corners.emplace_back(p.x(), p.y());
  if (corners.size() > 1) corners.pop_back();  // it closes the ring
  Highlight h = a.peakValue >= b.peakValue ? a : b;
  h.contour.points.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) addLine(h.contour.points, corners[i], corners[(i + 1) % corners.size()]);
  if (signedArea(h.contour) < 0) std::reverse(h.contour.points.begin(), h.contour.points.end());
  double joining = 0;
  const std::size_t n = h.contour.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Pixel &p = h.contour.points[i], &q = h.contour.points[(i + 1) % n], middle = (p + q) / 2;
    if (std::min(distance(a.contour, middle), distance(b.contour, middle)) > kJoinStepPx) joining += (q - p).norm();
  }
  h.clipped = a.clipped || b.clipped;
  h.touchesBorder = a.touchesBorder || b.touchesBorder;
  h.peakCut = a.peakCut || b.peakCut;
  describe(h);
  h.byHand = formatted("merged by hand: %.0f %% of its contour joins two highlights and was not seen",
                       100 * joining / std::max(length(h.contour), kJoinStepPx));
  return h;
}

/// The nearest point of the chain: after which vertex, and where.
std::pair<std::size_t, Pixel> onChain(const Polyline& line, const Pixel& p) {
  std::pair<std::size_t, Pixel> best{0, line.points.front()};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Pixel &a = line.points[i], d = line.points[(i + 1) % line.points.size()] - a;
    const double share = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    const Pixel q = a + share * d;
    if ((q - p).norm() >= least) continue;
    least = (q - p).norm();
    best = {i, q};
  }
  return best;
}

/// Both sides of a cut between the points of the contour nearest to two places; nothing if one has no area.
std::optional<std::pair<Polyline, Polyline>> cut(const Polyline& line, const Pixel& from, const Pixel& to) {
  auto [i, a] = onChain(line, from);
  auto [j, b] = onChain(line, to);
  if (i == j) return std::nullopt;
  if (i > j) std::swap(i, j), std::swap(a, b);
  std::pair<Polyline, Polyline> parts;
  const std::size_t n = line.points.size();
  parts.first.points.push_back(a);
  for (std::size_t k = i + 1; k <= j; ++k) parts.first.points.push_back(line.points[k]);
  addLine(parts.first.points, b, a);
  parts.second.points.push_back(b);
  for (std::size_t k = j + 1; k <= i + n; ++k) parts.second.points.push_back(line.points[k % n]);
  addLine(parts.second.points, a, b);
  for (Polyline* part : {&parts.first, &parts.second}) {
    *part = withoutRepeats(*part);
    if (part->points.size() < 5 || std::abs(signedArea(*part)) < kLeastPartPx2) return std::nullopt;
  }
  return parts;
}

/// The maximum of the image inside of a contour, ideal; its centroid where the image cannot tell.
Pixel peakIn(const Polyline& contour, const Camera& camera, const LinearPixels* pixels, double window) {
  if (!pixels) return centroid(contour);
  Image inside(pixels->value.width, pixels->value.height, 1);
  int x0 = -1, y0 = -1;
  Eigen::AlignedBox2d box;
  for (const Pixel& p : contour.points) box.extend(camera.distorted(p));
  const auto bound = [](double v, int n) { return static_cast<int>(std::clamp(v, 0.0, n - 1.0)); };
  if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) return centroid(contour);
  for (int y = bound(std::floor(box.min().y()), inside.height); y <= bound(std::ceil(box.max().y()), inside.height); ++y)
    for (int x = bound(std::floor(box.min().x()), inside.width); x <= bound(std::ceil(box.max().x()), inside.width); ++x) {
      if (!pixels->usable[static_cast<std::size_t>(y) * inside.width + x] || !contains(contour, camera.undistorted(Pixel(x, y))))
        continue;
      inside.at(x, y) = pixels->value.at(x, y);
      if (x0 < 0 || inside.at(x, y) > inside.at(x0, y0)) x0 = x, y0 = y;
    }
  if (x0 < 0) return centroid(contour);
  const Outcome<PeakFit> fit = fitPeak(inside, x0, y0, window);
  const Pixel peak = camera.undistorted(fit ? fit->at : Pixel(x0, y0));
  return peak.allFinite() && contains(contour, peak) ? peak : centroid(contour);
}

/// A highlight around a measured pixel, by the usual detection in a window about it, in which it is one of the separate peaks.
Outcome<Highlight> grown(const Scene& scene, int frame, const InspectionRequest& request, const Pixel& ideal) {
  const Frame& f = scene.frames[static_cast<std::size_t>(frame)];
  const Pixel clicked = f.camera.distorted(ideal);
  if (!isInPhotograph(f.camera, ideal)) return Failure{Reason::OutsideImage, "the place is outside of the image"};
  const Outcome<MaskedImage> image = readMasked(f, request.source);
  if (!image) return image.failure();
  const Image& linear = image->linear;
  DetectOptions options = detectOptionsFor(f, request.source, request.settings);
  options.separatePeaks = true;
  options.minAreaPx2 = std::min(options.minAreaPx2, kSeedAreaPx2);
  options.minContrast = std::min(options.minContrast, kSeedContrast);
  const auto part = [](const Image& of, int x0, int y0, int x1, int y1) {
    Image crop(x1 - x0, y1 - y0, of.channels);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        for (int c = 0; c < of.channels; ++c) crop.at(x - x0, y - y0, c) = of.at(x, y, c);
    return crop;
  };
  std::string why = "no region is large and bright enough";
  for (int half = kSeedWindowPx;; half *= 2) {
    const int x0 = std::max(0, int(clicked.x()) - half), x1 = std::min(linear.width, int(clicked.x()) + half + 1);
    const int y0 = std::max(0, int(clicked.y()) - half), y1 = std::min(linear.height, int(clicked.y()) + half + 1);
    const bool whole = x0 == 0 && y0 == 0 && x1 == linear.width && y1 == linear.height;
    const Image crop = part(linear, x0, y0, x1, y1);
    std::optional<Image> cropMask;
    if (image->mask) cropMask = part(*image->mask, x0, y0, x1, y1);
    const Pixel inCrop = clicked - Pixel(x0, y0);
    const Outcome<std::vector<Highlight>> found = detectHighlights(crop, cropMask ? &*cropMask : nullptr, options);
    const Highlight* nearest = nullptr;
    if (found)
      for (const Highlight& h : *found)
        if ((contains(h.contour, inCrop) || distance(h.contour, inCrop) <= kSeedBesidePx) &&
            (!nearest || h.areaPx2 < nearest->areaPx2))
          nearest = &h;
    if (!found)
      why = found.failure().detail;
    else if (!nearest)
      why = "nothing there stands out of its surroundings at the contour level";
    if ((nearest && !nearest->touchesBorder) || whole) {
      if (!nearest) return Failure{Reason::NoHighlight, why};
      Highlight h = *nearest;
      for (Pixel& p : h.contour.points) {
        const Outcome<Pixel> q = withoutDistortion(f.camera, p + Pixel(x0, y0));
        if (!q) return q.failure();
        p = *q;
      }
      const Outcome<Pixel> peak = withoutDistortion(f.camera, h.peak + Pixel(x0, y0));
      if (!peak) return peak.failure();
      h.peak = *peak;
      describe(h);
      h.byHand = "grown by hand from one pixel: its contour is at the level of its own peak";
      return h;
    }
  }
}

/// The edits of one frame at work on its evidence.
class Editing {
 public:
  Editing(FrameEvidence& evidence, const Scene& scene, const InspectionRequest& request)
      : e_(evidence), scene_(scene), request_(request) {
    for (int i = 0; i < static_cast<int>(e_.highlights.size()); ++i) found_.push_back(e_.asFound(i));
    next_ = static_cast<int>(e_.highlights.size() + e_.textures.size());
    for (const int f : found_) next_ = std::max(next_, f + 1);
  }

  void run() {
    const bool any = !e_.highlights.empty();
    for (const HighlightEdit& edit : request_.whatIf.edits) {
      if (edit.frame != e_.frame || edit.places.size() != placesOf(edit.kind)) continue;
      if (edit.kind == Kind::Ignore) ignore(edit.places[0]);
      if (edit.kind == Kind::Merge) merge(edit.places[0], edit.places[1]);
      if (edit.kind == Kind::Split) split(edit);
      if (edit.kind == Kind::Seed) seed(edit);
    }
    e_.found = std::move(found_);
    if (!e_.highlights.empty())
      e_.failure.reset();
    else if (any)
      e_.failure = Failure{Reason::NoHighlight, "every highlight is ignored by hand"};
  }

 private:
  void take(int i) {
    e_.highlights.erase(e_.highlights.begin() + i);
    found_.erase(found_.begin() + i);
  }

  void ignore(const Pixel& place) {
    const int i = at(e_.highlights, place), t = at(e_.truth, place);
    if (t >= 0) {
      if (e_.againstTruth) e_.ignored.push_back(e_.truth[static_cast<std::size_t>(t)]);
      e_.truth.erase(e_.truth.begin() + t);
    }
    if (i < 0) return;
    if (!e_.againstTruth || t < 0) e_.ignored.push_back(e_.highlights[static_cast<std::size_t>(i)]);
    take(i);
  }

  void merge(const Pixel& first, const Pixel& second) {
    const int i = at(e_.highlights, first), j = at(e_.highlights, second);
    if (i < 0 || j < 0 || i == j) return;
    e_.highlights[static_cast<std::size_t>(i)] =
        merged(e_.highlights[static_cast<std::size_t>(i)], e_.highlights[static_cast<std::size_t>(j)]);
    take(j);
  }

  void split(const HighlightEdit& edit) {
    const int i = at(e_.highlights, edit.places[0]);
    if (i < 0) return;
    const Highlight whole = e_.highlights[static_cast<std::size_t>(i)];
    auto parts = cut(whole.contour, edit.places[1], edit.places[2]);
    if (!parts) return;
    if (contains(parts->second, whole.peak)) std::swap(parts->first, parts->second);
    const double across = (edit.places[2] - edit.places[1]).norm();
    const Frame& f = scene_.frames[static_cast<std::size_t>(e_.frame)];
    std::optional<LinearPixels> pixels;
    if (Outcome<LinearPixels> read = pixelsOf(f, request_.source, request_.settings)) pixels = *std::move(read);
    const auto part = [&](Polyline& contour) {
      Highlight h = whole;
      h.contour = std::move(contour);
      if (!contains(h.contour, whole.peak)) {
        h.peak = peakIn(h.contour, f.camera, pixels ? &*pixels : nullptr, request_.settings.number("detect.peak_window"));
        h.peakValue = 0;
      }
      describe(h);
      h.byHand = formatted("split by hand: %.0f %% of its contour is the cut", 100 * across / length(h.contour));
      return h;
    };
    e_.highlights[static_cast<std::size_t>(i)] = part(parts->first);
    add(part(parts->second));
  }

  void seed(const HighlightEdit& edit) {
    Outcome<Highlight> h = grown(scene_, e_.frame, request_, edit.places[0]);
    if (!h) return;
    h->light = edit.light;
    for (int i = static_cast<int>(e_.highlights.size()) - 1; i >= 0; --i)
      if (contains(h->contour, e_.highlights[static_cast<std::size_t>(i)].peak)) take(i);
    add(*std::move(h));
  }

  void add(Highlight h) {
    e_.highlights.push_back(std::move(h));
    found_.push_back(next_++);
  }

  FrameEvidence& e_;
  const Scene& scene_;
  const InspectionRequest& request_;
  std::vector<int> found_;
  int next_ = 0;  // number of the next highlight that is new
};

}  // namespace

bool isIgnored(const WhatIf& w, int frame, const Highlight& h) {
  return std::any_of(w.edits.begin(), w.edits.end(), [&](const HighlightEdit& e) {
    return e.kind == Kind::Ignore && e.frame == frame && e.places.size() == 1 && encloses(h, e.places[0]);
  });
}

bool hasEdits(const WhatIf& w, int frame) {
  return std::any_of(w.edits.begin(), w.edits.end(), [&](const HighlightEdit& e) { return e.frame == frame; });
}

void applyEdits(FrameEvidence& evidence, const Scene& scene, const InspectionRequest& request) {
  if (evidence.frame >= 0 && hasEdits(request.whatIf, evidence.frame)) Editing(evidence, scene, request).run();
}

HighlightEdit ignoreEdit(int frame, const Highlight& h) { return {Kind::Ignore, frame, {placeIn(h)}}; }

HighlightEdit mergeEdit(int frame, const Highlight& a, const Highlight& b) {
  return {Kind::Merge, frame, {placeIn(a), placeIn(b)}};
}

Outcome<HighlightEdit> splitEdit(int frame, const Highlight& h, const Pixel& at) {
  if (!encloses(h, at)) return Failure{Reason::NotReached, "the place is not inside of the highlight"};
  // The nearest crossing on either side, for each direction.
  const auto crossing = [&](const Pixel& direction) -> std::optional<double> {
    std::optional<double> nearest;
    const std::vector<Pixel>& p = h.contour.points;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Pixel a = p[i] - at, d = p[(i + 1) % p.size()] - p[i];
      const double det = direction.x() * d.y() - direction.y() * d.x();
      if (det == 0) continue;
      const double along = (a.x() * d.y() - a.y() * d.x()) / det, share = (a.x() * direction.y() - a.y() * direction.x()) / det;
      if (along > 0 && share >= 0 && share <= 1 && (!nearest || along < *nearest)) nearest = along;
    }
    return nearest;
  };
  std::optional<HighlightEdit> best;
  double shortest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kCutDirections; ++k) {
    const double angle = std::numbers::pi * k / kCutDirections;
    const Pixel direction(std::cos(angle), std::sin(angle));
    const std::optional<double> ahead = crossing(direction), behind = crossing(-direction);
    if (!ahead || !behind || *ahead + *behind >= shortest) continue;
    const Pixel from = at + *ahead * direction, to = at - *behind * direction;
    if (!cut(h.contour, from, to)) continue;
    shortest = *ahead + *behind;
    best = HighlightEdit{Kind::Split, frame, {placeIn(h), from, to}};
  }
  if (!best) return Failure{Reason::NotReached, "a part of the cut highlight would have no area"};
  return *best;
}

Outcome<HighlightEdit> seedEdit(const Scene& scene, const InspectionRequest& request, int frame, const Pixel& at,
                                const std::string& light) {
  if (request.whatIf.synthesise)
    return Failure{Reason::NotSupported, "contours are synthesised: there is no photograph to look at"};
  const Outcome<Highlight> h = grown(scene, frame, request, at);
  if (!h) return h.failure();
  return HighlightEdit{Kind::Seed, frame, {at}, light};
}

}  // namespace glint
