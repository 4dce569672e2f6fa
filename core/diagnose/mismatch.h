// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/inspect/inspection.h"

namespace glint {

/// Why a highlight is missed or spurious, in words, by geometry and detection: beside the image, in the object's own shadow,
/// smaller than detect.min_area, at grazing incidence, detected but rejected; else the distance to the nearest of the other kind.
/// @param row  of the comparison, without metrics
/// @return "" for a row with metrics
std::string whyUnmatched(const Inspection& inspection, const FrameComparison& comparison, const FrameComparison::Row& row);

}  // namespace glint
