// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/app/session.h"
#include "core/base/progress.h"
#include "core/report/report.h"

namespace glint {

/// What a page to hand out shows of an inspection, beside the inspection itself.
struct ShareChoice {
  std::vector<int> frames;  ///< by index, rising; empty = all, of a long sequence evenly chosen ones and those that train
  SessionView view;         ///< what is selected first, from where the scene is seen, and whose lesson it is
};

/// Most frames of a page that does not name its frames.
inline constexpr int kMostSharedFrames = 300;

/// One HTML file that needs no network: the scene in 3D, each photograph with its contours, the errors of `evaluationJson`
/// (without times, so that equal data give equal bytes), and the steps of a lesson. Everything that comes from files is data:
/// JSON without mark-up. The page's policy forbids every load.
/// @param report  what `evaluationJson` takes
/// @return the whole file. std::invalid_argument for a frame that does not exist. Stopped.
std::string sharePage(const Inspection& inspection, const ReportContext& report, const ShareChoice& choice = {},
                      const ProgressFn& progress = {});

}  // namespace glint
