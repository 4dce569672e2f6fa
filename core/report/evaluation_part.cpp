// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/evaluation_part.h"

#include <algorithm>

#include "core/base/json_dom.h"
#include "core/base/part_file.h"
#include "core/inspect/shard.h"
#include "core/report/evaluation_json.h"
#include "core/report/part_records.h"
#include "core/session/input_digests.h"

namespace glint {
namespace {

using evaluation::ComparisonRecord;
using evaluation::FitOrder;
using evaluation::FrameRecord;
using json_dom::Json;

/// The files that every shard reads: of the scene itself and of the frames that all of them look at.
Json commonInputs(const Inspection& inspection, const ProgressFn& progress) {
  const bool all =
      std::all_of(inspection.evidence.begin(), inspection.evidence.end(), [](const auto& e) { return e.frame >= 0; });
  Scene common = *inspection.given;
  common.frames.clear();
  for (int f = 0; f < static_cast<int>(inspection.given->frames.size()); ++f)
    if (all || (!inspection.train.perSurface && inspection.isTraining(f)))
      common.frames.push_back(inspection.given->frames[static_cast<std::size_t>(f)]);
  Json inputs = Json::object();
  for (const auto& [path, sha256] : inputDigests(common, progress)) json_dom::append(inputs, path, sha256);
  return inputs;
}

FitOrder orderOf(const Inspection& inspection, const FitKey& key) {
  for (const TrainingView& v : inspection.views)
    if (!v.highlight.light.empty() && inspection.keyFor(v.frame, v.highlight.light) == key) return {0, v.frame};
  for (const FrameEvidence& e : inspection.evidence)
    for (const Highlight& h : e.scored())
      if (!h.light.empty() && inspection.keyFor(e.frame, h.light) == key) return {1, e.frame};
  return {};
}

Json recordsOf(const Inspection& inspection, const ModelResult& result) {
  Json fits = Json::array(), comparisons = Json::array();
  for (const ModelResult::Fit& f : result.fits) {
    FitOrder order = orderOf(inspection, f.key());
    order.bandRemarks = static_cast<int>(f.bandRemarks.size());
    fits.push_back(Json::parse(jsonOf(order)));
  }
  for (const FrameComparison& c : result.frames) {
    if (!inspection.isHeldOut(c.frame)) continue;
    comparisons.push_back(Json::parse(jsonOf(ComparisonRecord{tallyOf(c), evaluation::rowCount(c)})));
  }
  return {{"fits", std::move(fits)}, {"comparisons", std::move(comparisons)}};
}

}  // namespace

std::string evaluationPart(const Inspection& inspection, const ReportContext& context, const Shard& shard,
                           const ProgressFn& progress) {
  const std::vector<int> frames = framesOfShard(shard, inspection);
  const InspectionRequest& request = inspection.request;
  Json document = json_dom::parse(evaluationJson(inspection, context), "part");
  Json& about = document["shard"];
  about = {{"frames", frames},
           {"scene_frames", inspection.scene->frames.size()},
           {"per_surface", inspection.train.perSurface},
           {"noise_px", request.noisePx},
           {"seed", request.seed},
           {"truth", !request.truthFolder.empty()},
           {"inputs", commonInputs(inspection, progress)}};
  about["records"] = Json::array();
  for (const int f : frames)
    about["records"].push_back(
        Json::parse(jsonOf(FrameRecord{noteOf(inspection, f), detectionOf(inspection.evidence[static_cast<std::size_t>(f)])})));
  about["models"] = Json::object();
  for (const std::string& name : request.models) about["models"][name] = recordsOf(inspection, inspection.models.at(name));
  return partText(document.dump(-1, ' ', false, Json::error_handler_t::replace), shard, context.program);
}

}  // namespace glint
