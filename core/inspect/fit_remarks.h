// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/inspect/inspection.h"

namespace glint {

/// Some frame, whether it trains or not, shows a highlight of this light.
bool isSeen(const Inspection& inspection, const std::string& light);
/// Lights on in most frames of a fit that show no highlight of their own: this one's may be theirs, too. "" without such lights.
std::string mergedRemark(const Inspection& inspection, const ModelFit& fit);
/// Training frames that show the fit's light and have no view because they repeat another one. "" without such frames.
std::string repeatedRemark(const Inspection& inspection, const ModelFit& fit);
/// Training highlights of the fit's light shaped by hand, each with what that leaves in doubt. "" without such highlights.
std::string byHandRemark(const Inspection& inspection, const ModelFit& fit);

}  // namespace glint
