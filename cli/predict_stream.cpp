// SPDX-License-Identifier: BSD-3-Clause
#include "cli/predict_stream.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <system_error>

#include "cli/inspection_arguments.h"
#include "cli/interrupt.h"
#include "cli/terminal.h"
#include "core/base/stage_times.h"
#include "core/pipeline/live_prediction.h"
#include "core/report/labels.h"
#include "core/report/texts.h"
#include "core/scene/pose_lines.h"

namespace glint::cli {
namespace {

/// Standard input, or a file of any kind but a folder: a named pipe is as good as a file.
class PoseInput {
 public:
  explicit PoseInput(const std::string& poses)
      : isInput_(poses.empty() || poses == "-"), name_(isInput_ ? "standard input" : poses) {
    if (isInput_) return;
    std::error_code ignored;  // what cannot be asked about is not opened either
    if (std::filesystem::is_directory(poses, ignored)) throw InputError(poses, "--poses", "is a folder, not a file of poses");
    file_.open(poses, std::ios::binary);
    if (!file_) throw InputError(poses, "--poses", "cannot be opened");
  }
  std::istream& stream() { return isInput_ ? std::cin : file_; }
  const std::string& name() const { return name_; }

 private:
  bool isInput_;
  std::string name_;
  std::ifstream file_;
};

/// What went wrong in a stream that goes on.
struct Missed {
  std::size_t wrong = 0, lost = 0, odd = 0;
  std::string first, firstOdd;

  void sayTo(const Context& context) const {
    if (wrong > 0)
      context.warn(std::to_string(wrong) + (wrong == 1 ? " line was" : " lines were") +
                   " wrong and answered with an error; first: " + first);
    if (lost > 0) context.warn(std::to_string(lost) + (lost == 1 ? " line has" : " lines have") + " no pose: tracking was lost");
    if (odd > 0) context.warn((odd > 1 ? std::to_string(odd) + " poses were repaired; first: " : "") + firstOdd);
  }
};

/// The answer to the next line; "" at the end.
std::string nextAnswer(PoseLineReader& reader, const LivePredictor& predictor, Missed& missed) {
  try {
    const std::optional<PoseLine> pose = reader.next();
    if (!pose) return {};
    if (!reader.warning().empty() && missed.odd++ == 0) missed.firstOdd = reader.warning();
    const Outcome<LiveAnswer> answer = predictor.predict(pose->id, pose->cameraFromWorld, pose->camera, pose->worldFromObject);
    if (!answer) return liveRefusal(pose->id, reader.line(), "failed", answer.failure().message());
    return liveLine({pose->id, pose->time}, *answer, microsecondsSince(reader.arrived()));
  } catch (const LostPose& e) {
    ++missed.lost;
    return liveRefusal(reader.id(), reader.line(), "failed", e.what());
  } catch (const InputError& e) {
    if (e.place().empty()) throw;  // not a line but the file
    if (missed.wrong++ == 0) missed.first = e.what();
    return liveRefusal(reader.id(), reader.line(), "error", e.what());
  }
}

}  // namespace

int answerPoses(const OpenedSession& opened, const InspectionRequest& request, const std::string& poses, const Context& context) {
  PoseInput input(poses);
  const LivePredictor predictor(opened.scene, request, context.progress());
  if (const std::optional<Failure> none = predictor.failure()) throw CannotAnswer{*none};
  requireLights(predictor.inspection());
  for (const std::string& w : warningsOf(predictor.inspection())) context.warn(w);
  for (const auto& [name, result] : predictor.inspection().models)
    for (const std::string& line : bandLines(predictor.inspection(), result)) context.info(name + ": " + line);
  showWarnings();  // now: a live stream may never end
  context.info("ready: a line for each pose of " + input.name());
  PoseLineReader reader(input.stream(), input.name());
  Missed missed;
  std::size_t answered = 0;
  try {
    for (std::string line = nextAnswer(reader, predictor, missed); !line.empty(); line = nextAnswer(reader, predictor, missed)) {
      if (interrupted()) throw Stopped{};
      context.write("-", line);  // flushes
      ++answered;
    }
  } catch (const ReaderGone&) {
    // A user of `head` wants no more lines; a program that waits for answers wants to know why they stop.
    throw InputError("standard output", "",
                     "was closed by its reader after " + std::to_string(answered) + (answered == 1 ? " answer" : " answers"));
  }
  missed.sayTo(context);
  return kDone;
}

}  // namespace glint::cli
