// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/lobe_comparison.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "core/highlight/iso_contour.h"
#include "core/reflectance/added_lobe.h"

namespace glint {
namespace {

constexpr int kLeastLobePixels = 24;                 // three numbers of each lobe, and some to tell lobes apart by
constexpr int kAlphaBins = 24;                       // of alpha: a curve that one can follow
constexpr int kLeastInBin = 3;                       // fewer have no spread
constexpr int kWidthSteps = 36;                      // of the search, equal in log m: a lobe's width changes by 18 % a step
constexpr double kNarrowest = 0.003, kWidest = 1.3;  // of m: a mirror, and what is hardly a highlight
constexpr int kBits = 20;                            // of log m: a millionth
constexpr double kToldApart = 9;                     // of chi squared: three standard deviations of one number

/// Logarithm of S. Behind the horizon, and beyond 90 degrees from Phong's mirror direction, there is no light.
double logOfLobe(Lobe lobe, double m, const LobePixel& p) {
  const std::optional<LogRadiance> log = logRadiance(lobe, m, p.normal, p.toLight, p.toCamera);
  return log ? log->total() - 2 * std::log(p.distance) : -std::numeric_limits<double>::infinity();
}

/// Equal-weight least squares of I = K S + b for one lobe and width.
struct Line {
  double height = 0, offset = 0, rms = std::numeric_limits<double>::infinity();
  double logMost = 0;          ///< logarithm of the greatest S, for which `height` is K S
  std::vector<double> values;  ///< S of each pixel over its greatest; empty if the lobe is not defined at a pixel
};

Line lineFor(const std::vector<LobePixel>& pixels, Lobe lobe, double m) {
  Line line;
  std::vector<double> logs;
  double most = -std::numeric_limits<double>::infinity();
  for (const LobePixel& p : pixels) {
    logs.push_back(logOfLobe(lobe, m, p));
    most = std::max(most, logs.back());
  }
  if (!std::isfinite(most)) return line;
  line.logMost = most;
  double s = 0, i = 0, ss = 0, si = 0;
  const double n = double(pixels.size());
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    line.values.push_back(std::exp(logs[k] - most));
    s += line.values[k] / n;
    i += pixels[k].radiance / n;
  }
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    ss += std::pow(line.values[k] - s, 2);
    si += (line.values[k] - s) * (pixels[k].radiance - i);
  }
  if (!(ss > 0)) return line;
  line.height = si / ss;
  line.offset = i - line.height * s;
  double squares = 0;
  for (std::size_t k = 0; k < pixels.size(); ++k)
    squares += std::pow(pixels[k].radiance - line.offset - line.height * line.values[k], 2);
  line.rms = std::sqrt(squares / n);
  return line;
}

struct Fitted {
  LobeMatch match;
  Line line;
};

Fitted fitted(const std::vector<LobePixel>& pixels, Lobe lobe) {
  Fitted result;
  result.match.lobe = lobe;
  const auto rms = [&](double logM) { return lineFor(pixels, lobe, std::exp(logM)).rms; };
  const double from = std::log(kNarrowest), step = (std::log(kWidest) - from) / (kWidthSteps - 1);
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kWidthSteps; ++k)
    if (const double r = rms(from + k * step); r < least) least = r, best = k;
  if (!std::isfinite(least) || best == 0 || best == kWidthSteps - 1) {
    result.match.failure = Failure{Reason::NotConverged, "the pixels do not tell the lobe's width"};
    return result;
  }
  const auto found = boost::math::tools::brent_find_minima(rms, from + (best - 1) * step, from + (best + 1) * step, kBits);
  result.match.m = std::exp(found.first);
  result.line = lineFor(pixels, lobe, result.match.m);
  if (!(result.line.height > 0))
    result.match.failure = Failure{Reason::NotConverged, "the radiance does not fall as the lobe does"};
  return result;
}

/// The runs of a closed contour between points that keep(point) refuses; the whole where it refuses none.
template <typename Keep>
void addRuns(const Polyline& closed, const Keep& keep, std::vector<Polyline>& runs) {
  const std::size_t n = closed.points.size();
  std::size_t start = 0;
  while (start < n && keep(closed.points[start])) ++start;
  if (start == n) return runs.push_back(closed);
  Polyline run;
  run.closed = false;
  for (std::size_t i = 1; i <= n; ++i) {  // from behind a refused point to it
    const Pixel& p = closed.points[(start + i) % n];
    if (keep(p)) {
      run.points.push_back(p);
      continue;
    }
    if (run.points.size() > 1) runs.push_back(run);
    run.points.clear();
  }
}

/// The bin of every pixel; -1 if its bin has too few.
std::vector<int> binned(const std::vector<LobePixel>& pixels, double peak, std::vector<LobeComparison::Bin>& bins) {
  double widest = 0;
  for (const LobePixel& p : pixels) widest = std::max(widest, p.alpha);
  std::vector<int> at, place(kAlphaBins, -1);
  std::vector<LobeComparison::Bin> all(kAlphaBins);
  for (const LobePixel& p : pixels) {
    const int k = widest > 0 ? std::min(kAlphaBins - 1, int(kAlphaBins * p.alpha / widest)) : 0;
    at.push_back(k);
    LobeComparison::Bin& bin = all[std::size_t(k)];
    ++bin.pixels;
    bin.alpha += p.alpha;
    bin.mean += p.radiance / peak;
    bin.spread += std::pow(p.radiance / peak, 2);
  }
  for (int k = 0; k < kAlphaBins; ++k) {
    LobeComparison::Bin& bin = all[std::size_t(k)];
    if (bin.pixels < kLeastInBin) continue;
    const double n = bin.pixels;
    bin.alpha /= n;
    bin.mean /= n;
    bin.spread = std::sqrt(std::max(0.0, bin.spread / n - bin.mean * bin.mean) * n / (n - 1));
    place[std::size_t(k)] = int(bins.size());
    bins.push_back(bin);
  }
  for (int& k : at) k = place[std::size_t(k)];
  return at;
}

}  // namespace

Outcome<LobeComparison> compareLobes(const LobeSamples& samples) {
  LobeComparison result;
  result.clipped = samples.clipped;
  std::vector<LobePixel> pixels;
  const std::size_t every = std::max<std::size_t>(1, samples.pixels.size() / kMostLobePixels);
  for (std::size_t i = 0; i < samples.pixels.size(); i += every) pixels.push_back(samples.pixels[i]);
  result.pixels = int(pixels.size());
  if (result.pixels < kLeastLobePixels)
    return Failure{Reason::TooFewPoints,
                   std::to_string(result.pixels) + " pixels that are not clipped, need " + std::to_string(kLeastLobePixels)};
  std::vector<Fitted> all;
  for (const Lobe lobe : allLobes()) all.push_back(fitted(pixels, lobe));
  for (std::size_t k = 0; k < all.size(); ++k)
    if (!all[k].match.failure && (result.best < 0 || all[k].line.rms < all[std::size_t(result.best)].line.rms))
      result.best = int(k);
  if (result.best < 0) return all.empty() ? Failure{Reason::NotSupported, "there is no lobe"} : *all.front().match.failure;
  const Line& winner = all[std::size_t(result.best)].line;
  const double peak = winner.height;
  const std::vector<int> binOf = binned(pixels, peak, result.measured);
  for (Fitted& one : all) {
    if (!one.match.failure) {
      one.match.rmsPct = 100 * one.line.rms / peak;
      one.match.offsetPct = 100 * one.line.offset / peak;
      one.match.logUnit = one.line.logMost - std::log(one.line.height / peak);
      const double ratio = winner.rms > 0 ? one.line.rms / winner.rms : one.line.rms > 0 ? std::numeric_limits<double>::max() : 1;
      one.match.asGood = result.pixels * (ratio * ratio - 1) < kToldApart;
      one.match.profile.assign(result.measured.size(), 0);
      for (std::size_t i = 0; i < pixels.size(); ++i)
        if (binOf[i] >= 0)
          one.match.profile[std::size_t(binOf[i])] +=
              (one.line.height * one.line.values[i] + one.line.offset) / peak / result.measured[std::size_t(binOf[i])].pixels;
    }
    result.matches.push_back(std::move(one.match));
  }
  return result;
}

std::vector<Polyline> lobeContours(const LobeGrid& grid, const LobeMatch& match, double level) {
  require(level > 0 && grid.places.size() == std::size_t(grid.width) * std::size_t(grid.height),
          "lobeContours: the level must be positive, the grid complete");
  std::vector<Polyline> lines;
  if (match.failure || grid.width < 2 || grid.height < 2) return lines;
  Image share(grid.width, grid.height, 1);
  const auto at = [&](int x, int y) -> const std::optional<LobePixel>& {
    return grid.places[std::size_t(y) * std::size_t(grid.width) + std::size_t(x)];
  };
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x)
      if (const std::optional<LobePixel>& place = at(x, y))
        share.at(x, y) = float(std::exp(logOfLobe(match.lobe, match.m, *place) - match.logUnit) + match.offsetPct / 100);
  // Beside an empty cell the contour is the border of what is known, not of the highlight.
  const auto known = [&](const Pixel& p) {
    for (int y = int(std::floor(p.y())); y <= int(std::ceil(p.y())); ++y)
      for (int x = int(std::floor(p.x())); x <= int(std::ceil(p.x())); ++x)
        if (x < 0 || y < 0 || x >= grid.width || y >= grid.height || !at(x, y)) return false;
    return true;
  };
  for (const IsoContour& contour : isoContours(share, level)) addRuns(contour.line, known, lines);
  for (Polyline& line : lines)
    for (Pixel& p : line.points) p = grid.first + grid.step * p;
  return lines;
}

}  // namespace glint
