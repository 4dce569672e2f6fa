// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "core/reflectance/added_lobe.h"
#include "core/reflectance/extended_fit.h"
#include "core/reflectance/fit.h"

namespace glint {
namespace {

// How much smaller the sum of squares over their mean must be before a cosine power is preferred to a microfacet lobe: three
// standard deviations.
constexpr double kMicrofacetGain = 9;
constexpr std::size_t kPromisingStarts = 6;  // of those that a short fit to few points likes best
// No lobe explains the contours where the best start of each leaves this many times what a poor fit may leave. Beside a lobe that
// does, the others' best start left at most 3 times that (wide lobes, grazing views); starts from mirrored images leave 8 times
// and more.
constexpr double kFarFromAnyLobe = 6;
constexpr int kMostRounds = 3;  // of lobes that start again from a better one: each round must have found a better light
constexpr double kNarrowestGuess = 1e-4, kWidestGuess = 1.0;  // roughness of first guesses

bool isBetter(const RadianceFit& a, const RadianceFit& b) { return a.poor != b.poor ? b.poor : a.cost < b.cost; }

double clampedRoughness(Lobe lobe, double width, double level) {
  return std::clamp(roughnessOf(lobe, width, level), kNarrowestGuess, kWidestGuess);
}

/// The best of some lobes; a microfacet lobe where the residuals do not tell.
const RadianceFit& preferred(const std::map<Lobe, RadianceFit>& found) {
  const RadianceFit *best = nullptr, *microfacet = nullptr;
  for (const auto& [lobe, f] : found) {
    if (!best || isBetter(f, *best)) best = &f;
    if (isMicrofacet(lobe) && (!microfacet || isBetter(f, *microfacet))) microfacet = &f;
  }
  const bool asGood =
      microfacet && !microfacet->poor && microfacet->cost - best->cost < kMicrofacetGain * best->cost / best->points;
  return asGood ? *microfacet : *best;
}

/// Point lights of several lobes; keeps what each lobe found.
class PointSearch {
 public:
  PointSearch(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const RadianceFitOptions& options)
      : lobes_(lobes), views_(views), options_(options) {
    options_.lightSize = options_.otherStarts = false;
  }

  Outcome<RadianceFit> run(const Light& light, double width) {
    for (const Lobe lobe : lobes_) (void)(explains() ? follow(lobe) : tryFrom(lobe, light, roughnessFor(lobe, width)));
    if (!best_ || fit().doubtful) screen(light, width, StartGrid::Distances);
    if (!explains()) screen(light, width, StartGrid::Directions);
    // A lobe that was tried before the best light was known starts there too. Lobes tried later did so already.
    for (int round = 0; round < kMostRounds && explains(); ++round) {
      bool better = false;
      for (const Lobe lobe : lobes_)
        if (lobe != fit().lobe) better = follow(lobe) || better;
      if (!better) break;
    }
    if (!best_) return failure_;
    return preferred(found_);
  }

 private:
  const RadianceFit& fit() const { return found_.at(*best_); }
  bool explains() const { return best_ && !fit().poor; }
  double level() const { return views_.empty() ? 0.5 : views_.front().level; }
  double roughnessFor(Lobe lobe, double width) const { return clampedRoughness(lobe, width, level()); }

  /// Fits a lobe from a start. @return whether the best of all lobes became better.
  bool tryFrom(Lobe lobe, const Light& light, double roughness) {
    Outcome<RadianceFit> f = fitRadiance(lobe, views_, light, roughness, options_);
    if (!f) {
      if (!best_) failure_ = f.failure();
      return false;
    }
    const auto known = found_.find(lobe);
    if (known != found_.end() && !isBetter(*f, known->second)) return false;
    found_.insert_or_assign(lobe, *std::move(f));
    if (best_ && *best_ != lobe && !isBetter(found_.at(lobe), fit())) return false;
    best_ = lobe;
    followed_.clear();
    return true;
  }

  /// Starts from the best fit so far. Only once: it would lead to the same place again.
  bool follow(Lobe lobe) {
    if (!followed_.insert(lobe).second) return false;
    const Light light = fit().light();
    const double width = widthOf(fit().lobe, fit().roughness, level());
    const bool better = tryFrom(lobe, light, roughnessFor(lobe, width));
    followed_.insert(lobe);  // also where this lobe is the new best: it need not follow itself
    return better;
  }

  void screen(const Light& light, double width, StartGrid grid) {
    std::vector<RadianceStart> starts;
    for (const Lobe lobe : lobes_) {
      for (const RadianceStart& s : screenStarts(lobe, views_, light, roughnessFor(lobe, width), grid, options_))
        starts.push_back(s);
      const auto far = [](const RadianceStart& s) { return s.excess > kFarFromAnyLobe; };
      if (!starts.empty() && std::all_of(starts.begin(), starts.end(), far)) return;
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const RadianceStart& a, const RadianceStart& b) { return a.cost < b.cost; });
    if (starts.size() > kPromisingStarts) starts.resize(kPromisingStarts);
    for (auto s = starts.begin(); s != starts.end() && !(best_ && !fit().doubtful); ++s) {
      const bool tried = std::any_of(starts.begin(), s, [&](const RadianceStart& earlier) { return earlier.isNear(*s); });
      if (s->promises() && !tried) (void)tryFrom(s->lobe, s->light, s->roughness);
    }
  }

  const std::vector<Lobe>& lobes_;
  const std::vector<RadianceView>& views_;
  RadianceFitOptions options_;
  std::map<Lobe, RadianceFit> found_;
  std::set<Lobe> followed_;  ///< lobes that started from the best fit of the moment
  std::optional<Lobe> best_;
  Failure failure_{Reason::NotConverged, ""};
};

/// A size is tried on the best lobe; only where it shows are the others tried with one too.
RadianceFit withSphere(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const RadianceFit& point,
                       RadianceFitOptions options) {
  options.lightSize = true;
  options.otherStarts = false;
  RadianceFit best = point;
  const auto tryLobe = [&](Lobe lobe) {
    const Outcome<RadianceFit> f = fitRadiance(lobe, views, point.light(), point.roughness, options);
    if (f && f->cost < best.cost) best = *f;
  };
  tryLobe(point.lobe);
  if (radiusOf(best.lamp) > 0)
    for (const Lobe lobe : lobes)
      if (lobe != point.lobe) tryLobe(lobe);
  return best;
}

}  // namespace

Outcome<RadianceFit> searchRadiance(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const Light& light,
                                    double widthRad, const LampChoices& lamps, const RadianceFitOptions& options) {
  require(!lobes.empty(), "searchRadiance: no lobe");
  Outcome<RadianceFit> best = PointSearch(lobes, views, options).run(light, widthRad);
  if (lobes.size() == 1 && (!best || best->poor)) {
    // Another lobe may find the way from the first guess; from its light the lobe asked for starts close.
    const Lobe other = lobes[0] == Lobe::TorranceSparrow ? Lobe::BlinnPhong : Lobe::TorranceSparrow;
    const Outcome<RadianceFit> guide = PointSearch({other}, views, options).run(light, widthRad);
    if (guide && !guide->poor) {
      const double width = widthOf(other, guide->roughness, views.front().level);
      if (Outcome<RadianceFit> again = PointSearch(lobes, views, options).run(guide->light(), width); again && !again->poor)
        best = std::move(again);
    }
  }
  if (best && !best->poor && admits<SphereShape<>>(lamps)) best = withSphere(lobes, views, *best, options);
  for (const LampShape& kind : allLampShapes())
    if (lamps[kind.index()] && isSearched(kind))
      if (const auto extended = fitExtended(kind, lobes, views, best ? &*best : nullptr, light, widthRad, options))
        best = *extended;
  return best;
}

Outcome<RadianceFit> fitNear(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const RadianceFit& near,
                             const RadianceFitOptions& options) {
  require(!lobes.empty() && !views.empty(), "fitNear: no lobe, or no view");
  const double level = views.front().level, width = widthOf(near.lobe, near.roughness, level);
  std::map<Lobe, RadianceFit> found;
  Failure failure{Reason::NotConverged, ""};
  for (const Lobe lobe : lobes) {
    Outcome<RadianceFit> f = fitLamp(
        lobe, views, near.lamp, lobe == near.lobe ? near.roughness : Roughness(clampedRoughness(lobe, width, level)), options);
    if (f)
      found.insert_or_assign(lobe, *std::move(f));
    else
      failure = f.failure();
  }
  if (found.empty()) return failure;
  if (near.lamp.isPoint()) return preferred(found);
  // The same choice as in searchRadiance, which takes the smallest residual where the lamp has a size.
  const auto best =
      std::min_element(found.begin(), found.end(), [](const auto& a, const auto& b) { return isBetter(a.second, b.second); });
  return best->second;
}

}  // namespace glint
