// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/runner.h"

#include <QThread>
#include <stdexcept>
#include <utility>

#include "core/app/session.h"
#include "core/scene/scene_reader.h"
#include "gui/base/text.h"
#include "gui/document/allowed_folders.h"

namespace glint::gui {

namespace {
OpenedPtr asked(std::shared_ptr<const Scene> scene, const InspectionRequest& request) {
  auto computedFor = std::make_shared<Opened>();
  computedFor->scene = std::move(scene);
  computedFor->request = request;
  return computedFor;
}

template <class Result>
std::shared_ptr<const Result> shared(Result result) {
  return std::make_shared<const Result>(std::move(result));
}
template <class Result>
std::shared_ptr<const Result> shared(std::shared_ptr<const Result> result) {
  return result;
}
}  // namespace

Runner::Runner(Engine engine, QObject* parent) : QObject(parent), engine_(std::move(engine)) {
  connect(&jobs_, &JobQueue::busyChanged, this, &Runner::busyChanged);
}

void Runner::open(const std::string& path, const Relinked& instead) {
  const auto work = [this, path, instead](const JobToken& token) -> OpenedPtr {
    const auto say = [&](const std::filesystem::path& file, const std::string& named) {
      const MissingPtr missing =
          std::make_shared<const Missing>(Missing{exactQString(path), exactQString(file.string()), named, instead});
      token.deliver([this, missing] { emit inputMissing(missing); });
    };
    // The part after the semicolon names options of the command line: buttons answer here.
    const auto leftOpen = [&](const InputError& e, Undecided what) {
      const UndecidedPtr undecided = std::make_shared<const Undecided>(std::move(what));
      token.deliver([this, undecided] { emit inputUndecided(undecided); });
      const std::string line = e.what();
      return std::runtime_error(line.substr(0, line.rfind("; ")));
    };
    try {
      const OpenedPtr opened = std::make_shared<const Opened>(engine_.open(path, instead));
      return token.overtaken() ? nullptr : opened;
    } catch (const MissingScene& e) {
      say(e.scene(), "");
      throw;
    } catch (const MissingMesh& e) {
      say(e.mesh(), e.named());
      throw;
    } catch (const UndecidedInput& e) {
      throw leftOpen(e, Undecided{exactQString(path), e.question(), e.option(), e.answers(), instead});
    } catch (const FolderBelow& e) {
      const std::string words = "'" + e.folder().filename().string() + "' (" + e.holds() + ")";
      throw leftOpen(
          e, Undecided{exactQString(path), UndecidedInput::Question::Reading, "", {{e.folder().string(), words}}, instead});
    } catch (const OutsidePath& e) {
      const OutsidePtr outside = std::make_shared<const Outside>(Outside{exactQString(path), e.folder().string(), instead});
      token.deliver([this, outside] { emit outsideNamed(outside); });
      throw std::runtime_error(withoutFlags(e));
    }
  };
  const auto done = [this](const JobResult<OpenedPtr>& result) {
    if (result.value && *result.value) emit opened(*result.value);
    end(result);
    if (!result.failure().isEmpty()) emit openFailed();
  };
  jobs_.start(work, done, Asks::Instead);  // results of the scene on screen are no longer needed; a save is
}

void Runner::inspect(std::shared_ptr<Pipeline> pipeline, const InspectionRequest& request, int frame) {
  const std::shared_ptr<const Scene> scene = pipeline->scene();
  auto stages = [this, pipeline = std::move(pipeline), frame](const JobToken& token, const OpenedPtr& asked,
                                                              const std::shared_ptr<StageTimes>& times) {
    ProgressFn progress = progressOf(token, cutOff_ ? kLongGraceMs : kGraceMs, times);
    bool isAhead = false;
    if (frame >= 0) {
      const bool wasCutOff = std::exchange(cutOff_, true);
      for (const Question::Part part : {Question::Part::FirstLook, Question::Part::Frame})
        if (const InspectionPtr ahead = engine_.ask(*pipeline, {asked->request, part, frame}, progress)) {
          if (!token.stopped()) token.deliver([this, ahead, frame] { emit frameFinished(ahead, frame); });
          isAhead = true;
        }
      cutOff_ = wasCutOff && !isAhead;
    }
    if (isAhead) {
      QElapsedTimer pause;
      pause.start();
      while (sinceRest_.isValid() && sinceRest_.elapsed() < kRestEveryMs && pause.elapsed() < kPauseMs) {
        if (!token.wanted()) throw Stopped{};
        QThread::msleep(2);
      }
      progress = progressOf(token, kRestGraceMs, times);
    }
    InspectionPtr all = engine_.ask(*pipeline, {asked->request}, progress);
    sinceRest_.start();
    return all;
  };
  const auto work = [this, stages = std::move(stages)](const JobToken& token, const OpenedPtr& asked) {
    const auto times = std::make_shared<StageTimes>();
    const auto say = [&](const QString& line) { token.deliver([this, line] { emit timed(line); }); };
    try {
      InspectionPtr all = stages(token, asked, times);
      say(tr("Computed: %1").arg(toQString(times->text())));
      return all;
    } catch (...) {
      if (!token.overtaken()) say(tr("Ended in stage \"%1\": %2").arg(toQString(times->stage()), toQString(times->text())));
      throw;
    }
  };
  compute(asked(scene, request), work, &Runner::finished);
}

void Runner::choose(std::shared_ptr<const Scene> scene, const InspectionRequest& request, double goodEnoughPct,
                    InspectionPtr previous) {
  const auto work = [this, goodEnoughPct, previous = std::move(previous)](const JobToken& token, const OpenedPtr& asked) {
    const std::optional<double> tolerance = goodEnoughPct > 0 ? std::optional(goodEnoughPct) : std::nullopt;
    return engine_.choose(asked->scene, asked->request, tolerance, progressOf(token), previous.get());
  };
  compute(asked(std::move(scene), request), work, &Runner::chosen);
}

void Runner::measure(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const std::string& file) {
  const auto work = [this, file](const JobToken& token, const OpenedPtr& asked) {
    return engine_.tradeoff(asked->scene, asked->request, file, progressOf(token));
  };
  compute(asked(std::move(scene), request), work, &Runner::measured);
}

void Runner::influence(InspectionPtr inspection) {
  const auto work = [this](const JobToken& token, const InspectionPtr& of) { return engine_.influence(*of, progressOf(token)); };
  compute(std::move(inspection), work, &Runner::influenceMeasured);
}

void Runner::save(OpenedPtr opened, InspectionPtr results, const std::string& path) {
  const auto work = [this, opened = std::move(opened), results = std::move(results), path](const JobToken& token) {
    engine_.save(*opened, results.get(), path, progressOf(token));
  };
  const auto done = [this, path](const JobResult<void>& result) {
    const QString problem = result.stopped ? toQString(path) + tr(": saving stopped; nothing was written") : result.failure();
    emit saved(exactQString(path), problem);
  };
  jobs_.start(work, done, Asks::Lasting);
}

template <class Work, class About, class Result>
void Runner::compute(About about, Work work, void (Runner::*tell)(const std::shared_ptr<const Result>&, const About&)) {
  jobs_.start(
      [about, work = std::move(work)](const JobToken& token) mutable {
        const std::shared_ptr<const Result> result = shared<Result>(work(token, about));
        if (token.stopped()) throw Stopped{};  // after its last report: nothing waits for it any longer
        return result;
      },
      [this, about, tell](const JobResult<std::shared_ptr<const Result>>& result) {
        if (result.value) emit(this->*tell)(*result.value, about);
        end(result);
      },
      Asks::Newest);
}

ProgressFn Runner::progressOf(const JobToken& token, int graceMs, std::shared_ptr<StageTimes> times) {
  const auto show = [this](const StageEvent& e) { emit progressed(toQString(e.stage), e.done, e.total); };
  QElapsedTimer clock;
  clock.start();
  return [token, graceMs, clock, times = std::move(times), go = token.progress(show)](const StageEvent& e) {
    if (times) times->note(e);
    return !(token.overtaken() && clock.elapsed() > graceMs) && go(e);
  };
}

void Runner::end(const JobEnd& end) {
  if (const QString& failure = end.failure(); !failure.isEmpty() && !end.overtaken) emit failed(failure);
  if (end.stopped && !end.overtaken) emit stopped();
}

}  // namespace glint::gui
