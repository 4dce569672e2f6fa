// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/choice/extrapolation.h"
#include "core/choice/leave_one_out.h"

namespace glint {

/// What all candidates of one choice share, and a second search that takes poor fits too: folds keep their lights, canonical
/// contours and fits, so that nothing is fitted twice.
struct ChoiceGround {
  /// @param mostViews  to predict
  ChoiceGround(const Inspection& given, std::size_t mostViews);
  ChoiceGround(const ChoiceGround&) = delete;
  ChoiceGround& operator=(const ChoiceGround&) = delete;

  /// Estimates the light of all views once, before the first model that needs one. A mesh that it smooths serves the left-out
  /// fits and the views to predict as well. Where every surface has its own models each left-out fit looks for itself.
  void findLights(const ProgressFn& progress);
  /// On a smoothed mesh, what pixels said of the given one does not serve: those of all views are fitted there once, and fits
  /// with a view left out start from that.
  void fitPixels(const ProgressFn& progress);

  Inspection inspection;              ///< as given, with the lights of all views and the meshes they smoothed
  std::vector<Fold> folds;            ///< one per left-out view
  std::map<std::string, Fold> whole;  ///< by light: nothing is left out
  std::vector<ViewToPredict> views;

 private:
  bool lightsFound_ = false, pixelsFitted_ = false;
};

}  // namespace glint
