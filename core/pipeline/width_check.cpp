// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/width_check.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/model/plausible.h"

namespace glint {
namespace {

constexpr double kClearGain = 0.5;        // of the robust sum that a common width leaves; a panel's widths leave 0.7 of it
constexpr double kMostOfViews = 2.0 / 3;  // of them must be described by a width of their own
constexpr std::size_t kLeastViews = 4;    // a light has three unknowns, and each view brings its own width
constexpr double kVisibleRatio = 0.1;     // of the width, in logarithms: less moves a contour by less than a twentieth
constexpr double kSigmas = 3;             // of the widths' own uncertainty
constexpr double kMostBySlant = 1.0;      // of d log width / d sin^2 of the incidence: a lamp that outweighs the lobe
constexpr double kLeastBySlant = -0.3;    // Fresnel's law and shadowing narrow a lobe by less
constexpr double kBackAndForth = 1.6;     // times the range: the way through widths from place to place; exposures go further

struct WidthAtPlace {
  std::size_t view;
  double log, sigma, slant;
  Eigen::Vector3d place;
};

/// Slope of a line through log widths over the slant, held between what incidence can do.
double slopeBySlant(const std::vector<WidthAtPlace>& items) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = double(items.size());
  for (const WidthAtPlace& i : items) x += i.slant / n, y += i.log / n;
  for (const WidthAtPlace& i : items) xx += (i.slant - x) * (i.slant - x), xy += (i.slant - x) * (i.log - y);
  return xx > 0 ? std::clamp(xy / xx, kLeastBySlant, kMostBySlant) : 0;
}

/// Sum of the changes from each place to the nearest one that was not yet visited, from the end of the chain on.
double wayThrough(std::vector<WidthAtPlace> items) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const WidthAtPlace& i : items) middle += i.place / double(items.size());
  const auto nearestFirst = [](std::vector<WidthAtPlace>& all, const Eigen::Vector3d& to, double sign) {
    std::iter_swap(all.begin(), std::min_element(all.begin(), all.end(), [&](const WidthAtPlace& a, const WidthAtPlace& b) {
                     return sign * (a.place - to).squaredNorm() < sign * (b.place - to).squaredNorm();
                   }));
  };
  nearestFirst(items, middle, -1);
  double way = 0;
  while (items.size() > 1) {
    const WidthAtPlace from = items.front();
    items.erase(items.begin());
    nearestFirst(items, from.place, 1);
    way += std::abs(items.front().log - from.log);
  }
  return way;
}

WidthGroups::Group groupOf(std::span<const WidthAtPlace> items, const OwnWidths& widths) {
  WidthGroups::Group g;
  std::vector<double> angles;
  for (const WidthAtPlace& i : items) {
    g.views.push_back(i.view);
    g.place += i.place / double(items.size());
    angles.push_back(widths.views[i.view].limitAngle);
  }
  std::sort(g.views.begin(), g.views.end());
  g.limitAngle = upperMedian(angles);
  return g;
}

/// All contours of a frame lie at a share of its strongest peak: those of weaker highlights are narrower.
bool isStrongest(const TrainingView& view, const std::vector<TrainingView>& views) {
  return std::none_of(views.begin(), views.end(), [&](const TrainingView& o) {
    return o.frame == view.frame && o.highlight.peakValue > view.highlight.peakValue;
  });
}

}  // namespace

std::optional<WidthGroups> groupedByPlace(const OwnWidths& widths) {
  WidthGroups groups;
  std::vector<WidthAtPlace> items;
  std::size_t seen = 0;
  for (std::size_t v = 0; v < widths.views.size(); ++v) {
    const OwnWidth& w = widths.views[v];
    if (!(w.limitAngle > 0)) continue;
    ++seen;
    if (w.explained)
      items.push_back({v, std::log(w.limitAngle), w.sigma, w.sineSquared, w.place});
    else
      groups.both.push_back(v);
  }
  if (seen < kLeastViews || double(items.size()) < kMostOfViews * double(seen)) return std::nullopt;
  if (!(widths.cost < kClearGain * widths.commonCost)) return std::nullopt;
  const double slope = slopeBySlant(items);
  for (WidthAtPlace& i : items) i.log -= slope * i.slant;
  std::stable_sort(items.begin(), items.end(), [](const WidthAtPlace& a, const WidthAtPlace& b) { return a.log < b.log; });
  const double range = items.back().log - items.front().log;
  if (!(range > kVisibleRatio) || !(range > kSigmas * std::hypot(items.front().sigma, items.back().sigma))) return std::nullopt;
  if (wayThrough(items) > kBackAndForth * range) return std::nullopt;
  std::size_t cut = 1;  // at the largest step
  for (std::size_t k = 1; k < items.size(); ++k)
    if (items[k].log - items[k - 1].log > items[cut].log - items[cut - 1].log) cut = k;
  groups.narrow = groupOf(std::span(items).first(cut), widths);
  groups.wide = groupOf(std::span(items).subspan(cut), widths);
  return groups;
}

std::string widthDoubt(const std::vector<TrainingView>& views, const std::optional<Light>& light) {
  std::vector<BundleView> contours;
  std::vector<std::string> names;
  double level = 0;
  for (const TrainingView& v : views) {
    if (!v.seen || v.highlight.touchesBorder || !isStrongest(v, views)) continue;
    contours.push_back({v.camera, v.surface.get(), v.highlight.contour.points, v.seen->brightest});
    names.push_back(frameNameOf(v));
    level = v.highlight.level;
  }
  if (contours.size() < kLeastViews || !(level > 0 && level < 1)) return "";
  const std::optional<OwnWidths> widths = ownWidths(contours, light);
  const std::optional<WidthGroups> groups = widths ? groupedByPlace(*widths) : std::nullopt;
  if (!groups) return "";
  const auto frames = [&](const std::vector<std::size_t>& of) {
    std::string text;
    for (const std::size_t v : of) text += (text.empty() ? "" : ", ") + names[v];
    return (of.size() == 1 ? "frame " : "frames ") + text;
  };
  const auto part = [&](const WidthGroups::Group& g) {
    return formatted("%.3g near (%.3g, %.3g, %.3g) m, ", std::tan(g.limitAngle) / std::sqrt(-std::log(level)), g.place.x(),
                     g.place.y(), g.place.z()) +
           frames(g.views);
  };
  return "the highlight's width depends on the place on the surface: roughness about " + part(groups->narrow) + "; " +
         part(groups->wide) + (groups->both.empty() ? "" : "; on both parts, " + frames(groups->both)) +
         " (leave the frames of one part out with --exclude, or mask that part)";
}

}  // namespace glint
