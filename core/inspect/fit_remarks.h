// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/inspect/inspection.h"

namespace glint {

/// Some frame, whether it trains or not, shows a highlight of this light.
bool isSeen(const Inspection& inspection, const std::string& light);
/// Lights that are on in most frames of a fit and show no highlight of their own in any frame: this one's may be theirs too. "" where none is.
std::string mergedRemark(const Inspection& inspection, const ModelFit& fit);
/// Training frames that show the fit's light and have no view because they repeat another one. "" without such frames.
std::string repeatedRemark(const Inspection& inspection, const ModelFit& fit);
/// Training highlights of the fit's light whose shape was made by hand, each with what that leaves in doubt. "" without such highlights.
std::string byHandRemark(const Inspection& inspection, const ModelFit& fit);

}  // namespace glint
