// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics/highlight_rows.h"

namespace glint {

/// What most highlights that a model gets wrong have in common, and hardly any other one has.
struct SharedCause {
  std::string text;                  ///< "4 of 5 have an incident angle above 60°; 0 of 20 others"
  int wrong = 0, ofWrong = 0;        ///< wrong highlights that have it, of those where it is known
  int others = 0, ofOthers = 0;      ///< the same of highlights that are right
  double chance = 1;                 ///< that a split of this size comes by chance: hypergeometric, one-sided
  std::vector<RowKey> highlights{};  ///< the wrong ones that have it
};

/// Strong splits alone: at least three quarters of the wrong highlights (three or more), at most a tenth of the others, and a
/// chance of at most 0.001. What is tried: incident angle, observed diameter, radiance and limit angle, and the frame's position,
/// each above or below the value that splits best; the light, the surface, the image's border, a clipped core. It says what goes
/// together, not what causes what. Wrong is what is not Ok; excluded frames and what was not compared do not count.
/// @param rows  highlightRows() of the inspection
/// @return best first, at most one for each thing that is tried
std::vector<SharedCause> sharedCauses(const Inspection& inspection, const std::vector<HighlightRow>& rows,
                                      const std::string& model);

}  // namespace glint
