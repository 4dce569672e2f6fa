// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace glint {

/// Views of one surface from one place see the same reflection and have the same errors of pose and surface. A left-out view is
/// predicted honestly only where every view from its place is left out with it. An object that moves before a camera that stands
/// has other surfaces.
/// @param views  with `camera` and a pointer `surface` each (BundleView, RadianceView, TrainingView)
/// @return one number per view, equal for views from one place; the places count from 0 in the order in which they first occur
template <class View>
std::vector<int> placesOf(const std::vector<View>& views) {
  /// Share of the extent of all centres: rounding stays below it, and no two steps of a hand are as near.
  constexpr double kSamePlace = 1e-6;
  Eigen::AlignedBox3d box;
  std::vector<Eigen::Vector3d> centres;
  for (const View& v : views) box.extend(centres.emplace_back(v.camera.centreInWorld()));
  std::vector<int> places;
  std::vector<std::size_t> first;  // view of each place
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto at = std::find_if(first.begin(), first.end(), [&](std::size_t k) {
      return views[k].surface == views[i].surface && (centres[k] - centres[i]).norm() <= kSamePlace * box.diagonal().norm();
    });
    places.push_back(static_cast<int>(at - first.begin()));
    if (at == first.end()) first.push_back(i);
  }
  return places;
}

/// How many different places there are.
inline int countOf(const std::vector<int>& places) {
  return places.empty() ? 0 : 1 + *std::max_element(places.begin(), places.end());
}

/// Evenly spread places to leave out, one after the other: all of them up to `atMost`.
inline std::vector<int> placesToLeaveOut(const std::vector<int>& places, int atMost) {
  const int count = countOf(places), folds = std::min(count, atMost);
  std::vector<int> left;
  for (int k = 0; k < folds; ++k) left.push_back(static_cast<int>(static_cast<long long>(k) * count / folds));
  return left;
}

/// Whether a richer model predicts left-out views better than a plain one by more than the standard error of the gain: the mean
/// logarithm of their errors' ratio. False for fewer than three views, different numbers of them, or errors that are not positive
/// and finite.
/// @param richer,plain  error of every left-out view, in one unit
inline bool predictsLeftOutBetter(const std::vector<double>& richer, const std::vector<double>& plain) {
  if (richer.size() < 3 || richer.size() != plain.size()) return false;
  double mean = 0, squares = 0;
  const double n = static_cast<double>(richer.size());
  for (std::size_t i = 0; i < richer.size(); ++i) mean += std::log(plain[i] / richer[i]) / n;
  for (std::size_t i = 0; i < richer.size(); ++i) squares += std::pow(std::log(plain[i] / richer[i]) - mean, 2);
  return std::isfinite(mean) && mean > std::sqrt(squares / (n - 1) / n);
}

}  // namespace glint
