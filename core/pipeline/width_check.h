// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/light/own_widths.h"
#include "core/model/model.h"

namespace glint {

/// Two groups of views whose highlights differ in width because they lie on different parts of the surface.
struct WidthGroups {
  struct Group {
    std::vector<std::size_t> views;                   ///< indices into OwnWidths::views
    double limitAngle = 0;                            ///< rad, median
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< mean, m
  };
  Group narrow, wide;
  std::vector<std::size_t> both;  ///< one width does not describe these: their highlights lie on both parts
};

/// The groups, where widths of the views' own explain what one common width does not, where the widths differ beyond their own
/// uncertainty and beyond what the light's incidence may do to them (a long lamp, Fresnel's law), and where they go from place to
/// place and not back and forth as with the frames' exposures. A lobe whose width depends on the direction (brushed metal, a long
/// lamp) or a light that moves is described no better by widths of the views' own.
std::optional<WidthGroups> groupedByPlace(const OwnWidths& widths);

/// A sentence with both widths, their places, their frames and what to do; "" where the widths do not depend on the place.
/// @param views  of one light. @param light  of these views, if it was found
std::string widthDoubt(const std::vector<TrainingView>& views, const std::optional<Light>& light);

}  // namespace glint
