// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/pareto.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

bool finite(const Cost& c) { return std::isfinite(c.errorPct) && std::isfinite(c.us); }

}  // namespace

bool dominates(const Cost& a, const Cost& b) {
  return a.errorPct <= b.errorPct && a.us <= b.us && (a.errorPct < b.errorPct || a.us < b.us);
}

bool clearlyDominates(const Cost& a, const Cost& b, double errorSlack, double timeSlack) {
  return dominates({a.errorPct * errorSlack, a.us * timeSlack}, b);
}

std::vector<char> paretoFront(const std::vector<Cost>& costs) {
  std::vector<char> front(costs.size(), 0);
  for (std::size_t i = 0; i < costs.size(); ++i)
    front[i] = finite(costs[i]) && std::none_of(costs.begin(), costs.end(),
                                                [&](const Cost& other) { return finite(other) && dominates(other, costs[i]); });
  return front;
}

Presets presetsOf(const std::vector<Cost>& costs) {
  Presets p;
  const std::vector<char> front = paretoFront(costs);
  const auto take = [&](int& best, int i, auto key) {
    if (best < 0 || key(costs[i]) < key(costs[best])) best = i;
  };
  const auto us = [](const Cost& c) { return c.us; };
  const auto error = [](const Cost& c) { return c.errorPct; };
  for (int i = 0; i < static_cast<int>(costs.size()); ++i) {
    if (!front[i]) continue;
    take(p.exact, i, error);
    if (costs[i].errorPct <= kUsableErrorPct) take(p.fast, i, us);
  }
  if (p.exact < 0) return p;
  const double same = costs[p.exact].errorPct + kSameErrorPct;
  for (int i = 0; i < static_cast<int>(costs.size()); ++i)
    if (front[i] && costs[i].errorPct <= same) take(p.exact, i, us);
  if (p.fast < 0)
    for (int i = 0; i < static_cast<int>(costs.size()); ++i)
      if (front[i]) take(p.fast, i, us);
  const auto x = [&](const Cost& c) { return std::log(std::max(c.us, kSmallestUs)); };
  const auto y = [&](const Cost& c) { return std::log(std::max(c.errorPct, kSmallestErrorPct)); };
  const double x0 = x(costs[p.fast]), dx = x(costs[p.exact]) - x0;
  const double y0 = y(costs[p.exact]), dy = y(costs[p.fast]) - y0;
  const auto distance = [&](const Cost& c) {
    return std::hypot(dx > 0 ? (x(c) - x0) / dx : 0.0, dy > 0 ? (y(c) - y0) / dy : 0.0);
  };
  for (int i = 0; i < static_cast<int>(costs.size()); ++i) {
    // Faster than `fast` means unusable.
    if (!front[i] || costs[i].us < costs[p.fast].us) continue;
    take(p.balanced, i, distance);
  }
  return p;
}

}  // namespace glint
