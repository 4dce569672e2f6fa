// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/shard.h"
#include "core/report/report.h"

namespace glint {

/// What `evaluate --shard` writes: the evaluation of the shard's frames, with the key `shard` (docs/formats.md, "Parts"), from which
/// mergedEvaluation() computes the whole. Reads the files that every shard uses, to hash them. Stopped.
/// @param inspection  of inspectShard()
std::string evaluationPart(const Inspection& inspection, const ReportContext& context, const Shard& shard,
                           const ProgressFn& progress = {});

struct MergedEvaluation {
  std::string json;    ///< equal to evaluationJson() of one run, to the last bit, times aside
  int frames = 0;      ///< of all parts
  std::string reason;  ///< why no model answered; "" = one did
};
/// The whole of all parts of one evaluation.
/// @throw InputError (file, place): what readParts() refuses, parts of another request, of other inputs or with other fits, frames that are in
///        no part or in two, and anything that no part holds.
MergedEvaluation mergedEvaluation(const std::vector<std::string>& files);

}  // namespace glint
