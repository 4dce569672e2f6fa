// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/app/lamp_fit.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/plot_data.h"

// Drawings of what photographs of mirror balls say about lamps.
namespace glint::draw {

/// Over one photograph: outlines as a person drew them (dashed), as they were refined, highlights with arrows along their
/// residuals (seen less predicted), and what was dropped (crosses).
struct BallOverlayInput {
  std::vector<BallOutline> drawn;                    ///< px of the shot
  int selected = -1;                                 ///< of `drawn`: thicker
  std::vector<Eigen::Vector2d> rim;                  ///< points of a rim that were clicked so far, px of the shot
  const BallLamps* fit = nullptr;                    ///< null = not measured
  const LampAnswer* lamp = nullptr;                  ///< of this photograph; null = none
  std::vector<std::size_t> balls;                    ///< of the fit, that this photograph shows
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< of the photograph in the shot: the overlay is in px of the photograph
  double residualScale = 1;                          ///< arrows are drawn so many times their length
};
FrameOverlay ballOverlay(const BallOverlayInput& in);

/// By how much arrows are enlarged so that the longest of all photographs is at most an eighth of the smallest ball's radius:
/// 1, 2, 5, 10, … 100. 1 where there is nothing to enlarge.
double ballResidualScale(const std::vector<FittedBall>& balls, const std::vector<LampAnswer>& lamps);

/// Distance from the predicted to the seen highlight of every photograph and ball, as bars; rings: of the prediction from the
/// other balls alone. A photograph without an answer has a cross.
/// @param lamps  one for each photograph
PlotData ballResidualPlot(const std::vector<LampAnswer>& lamps, std::size_t balls);
/// Each photograph's share in what is known of the balls' outlines, percent; the edges add the rest.
PlotData outlineSharePlot(const std::vector<LampAnswer>& lamps);

}  // namespace glint::draw
