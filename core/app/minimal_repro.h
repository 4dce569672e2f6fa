// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// What is wrong with one model's answer for one light in one frame: its error, or why it is missing.
struct Fault {
  int frame = -1;
  std::string model, light;
  std::optional<double> errorPct;  ///< mean contour error of the matched highlights; exactly one of the two is set
  std::optional<Reason> reason;
  std::string text() const;  ///< "contour error 12.3 %" or "too few views"
};

enum class FaultKept {
  Within,  ///< the error stays within the tolerance of its value, on both sides
  AtLeast  ///< or becomes larger
};
struct FaultTolerance {
  FaultKept kept = FaultKept::Within;
  double share = 0.2;  ///< of the error, 0 .. 1
};
/// The same named failure, or an error that is near enough.
bool sameFault(const Fault& was, const Fault& now, const FaultTolerance& tolerance);

/// What an inspection says of a model in a frame. @param light  "" = the one with the largest error there, else the first that
/// failed. NotSupported if the model was not computed or predicts nothing for this frame.
Outcome<Fault> faultOf(const Inspection& inspection, int frame, const std::string& model, const std::string& light);

struct MinimalRepro {
  Fault before, after;    ///< with all training frames, and with those kept
  std::vector<int> kept;  ///< training frames that remain, of the inspection's; with models per surface the fault's frame is one
  int of = 0;             ///< training frames that the fit had
  int asked = 0;          ///< fits that were tried
};
/// The smallest set of training frames (no single one can be left out; see `minimalSubset`) whose fit still shows the fault.
/// Views, with the what-if and the noise, are those of the inspection; light, canonical contours and the model are computed
/// again. A fault frame that trains itself is always kept. NotSupported as faultOf; NotReached if the fault does not show even
/// with all of them, computed this way. Stopped.
Outcome<MinimalRepro> minimalRepro(const Inspection& inspection, const Fault& fault, const FaultTolerance& tolerance,
                                   const ProgressFn& progress = {});

struct WrittenRepro {
  std::filesystem::path session;
  Fault fault;         ///< as the written session shows it
  bool shows = false;  ///< that is the fault, within the tolerance
};
/// Writes it as a folder of its own: scene.json with the kept frames (their contours and peaks as evidence of the fault's light,
/// with what-if and noise applied), then the fault's frame; their images, the surface, and session repro.glint, which selects the
/// frame and says in its notes what it shows. Whole or not at all; the session is computed from what was written, so that it
/// replays.
/// @throw InputError as `atomicFolder`, or for an input that cannot be copied; Stopped.
WrittenRepro writeRepro(const Inspection& inspection, const MinimalRepro& repro, const FaultTolerance& tolerance,
                        const std::filesystem::path& folder, const ProgressFn& progress = {});

}  // namespace glint
