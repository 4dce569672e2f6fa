// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/inspect/inspection.h"

namespace glint {

/// Why a highlight is missed or spurious, as far as geometry and detection tell, in words: beside the image, in the shadow of the object itself,
/// smaller than detect.min_area, at grazing incidence, seen by detection and not taken; else the distance to the nearest highlight of the other kind.
/// @param row  of the comparison, without metrics
/// @return "" for a row with metrics
std::string whyUnmatched(const Inspection& inspection, const FrameComparison& comparison, const FrameComparison::Row& row);

}  // namespace glint
