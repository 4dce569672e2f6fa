// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/runner.h"

#include <exception>
#include <stdexcept>
#include <utility>

#include "core/pipeline/session.h"
#include "gui/base/background.h"
#include "gui/base/text.h"
#include "gui/document/allowed_folders.h"

namespace glint::gui {

namespace {
constexpr int kSignalEveryMs = 40;  // progress on screen needs no more
}

Runner::Runner(Engine engine, QObject* parent) : QObject(parent), engine_(std::move(engine)), worker_(new QObject) {
  qRegisterMetaType<InspectionPtr>("glint::gui::InspectionPtr");
  qRegisterMetaType<OpenedPtr>("glint::gui::OpenedPtr");
  qRegisterMetaType<SelectionPtr>("glint::gui::SelectionPtr");
  qRegisterMetaType<TradeoffPtr>("glint::gui::TradeoffPtr");
  qRegisterMetaType<InfluencePtr>("glint::gui::InfluencePtr");
  qRegisterMetaType<MissingPtr>("glint::gui::MissingPtr");
  qRegisterMetaType<OutsidePtr>("glint::gui::OutsidePtr");
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  startInBackground(thread_);
}

Runner::~Runner() {
  cancel();
  thread_.quit();
  thread_.wait();
}

void Runner::cancel() {
  cancelled_ = newest_.load();
  cancelledSaves_ = newestSave_.load();
}

void Runner::open(const std::string& path, const Relinked& instead) {
  cancelled_ = newest_.load();  // results of the scene on screen are of no use any more; a save is
  const auto work = [this, path, instead](int job) {
    const auto say = [&](const std::filesystem::path& file, const std::string& named) {
      const MissingPtr missing =
          std::make_shared<const Missing>(Missing{exactQString(path), exactQString(file.string()), named, instead});
      QMetaObject::invokeMethod(
          this, [this, missing] { emit inputMissing(missing); }, Qt::QueuedConnection);
    };
    OpenedPtr opened;
    try {
      opened = std::make_shared<const Opened>(engine_.open(path, instead));
    } catch (const MissingScene& e) {
      say(e.scene(), "");
      throw;
    } catch (const MissingMesh& e) {
      say(e.mesh(), e.named());
      throw;
    } catch (const OutsidePath& e) {
      const OutsidePtr outside = std::make_shared<const Outside>(Outside{exactQString(path), e.folder().string(), instead});
      QMetaObject::invokeMethod(
          this, [this, outside] { emit outsideNamed(outside); }, Qt::QueuedConnection);
      throw std::runtime_error(withoutFlags(e));
    }
    if (job == newest_)
      QMetaObject::invokeMethod(
          this, [this, opened] { emit this->opened(opened); }, Qt::QueuedConnection);
  };
  post(work, [this] { emit openFailed(); });
}

void Runner::inspect(std::shared_ptr<const Scene> scene, const InspectionRequest& request, InspectionPtr previous, int frame) {
  auto computedFor = std::make_shared<Opened>();
  computedFor->request = request;
  post([this, scene = std::move(scene), computedFor, previous = std::move(previous), frame](int job) mutable {
    QElapsedTimer clock, lastSignal;
    clock.start();
    int graceMs = cutOff_ ? kLongGraceMs : kGraceMs;
    const ProgressFn progress = [&](const StageEvent& e) { return report(job, clock, lastSignal, e, graceMs); };
    if (job != newest_ || job <= cancelled_) throw Stopped{};  // overtaken while it waited
    if (engine_.inspectOneFrame && frame >= 0) {
      cutOff_ = true;
      const auto ahead = std::make_shared<const Inspection>(
          engine_.inspectOneFrame(scene, computedFor->request, frame, progress, previous.get()));
      if (job > cancelled_)
        QMetaObject::invokeMethod(
            this, [this, ahead, frame] { emit frameFinished(ahead, frame); }, Qt::QueuedConnection);
      cutOff_ = false;
      previous = ahead;
      clock.start();
      while (sinceRest_.isValid() && sinceRest_.elapsed() < kRestEveryMs && clock.elapsed() < kPauseMs) {
        if (job != newest_ || job <= cancelled_) throw Stopped{};
        QThread::msleep(2);
      }
      clock.start();
      graceMs = kRestGraceMs;
    }
    const auto result =
        std::make_shared<const Inspection>(engine_.inspect(scene, computedFor->request, progress, previous.get()));
    sinceRest_.start();
    if (job <= cancelled_) throw Stopped{};  // after its last report: nobody waits for it any more
    QMetaObject::invokeMethod(
        this, [this, result, computedFor] { emit finished(result, computedFor); }, Qt::QueuedConnection);
  });
}

void Runner::choose(std::shared_ptr<const Scene> scene, const InspectionRequest& request, double goodEnoughPct,
                    InspectionPtr previous) {
  auto computedFor = std::make_shared<Opened>();
  computedFor->request = request;
  computedFor->scene = scene;
  post([this, computedFor, goodEnoughPct, previous = std::move(previous)](int job) {
    QElapsedTimer clock, lastSignal;
    clock.start();
    const ProgressFn progress = [&](const StageEvent& e) { return report(job, clock, lastSignal, e); };
    if (job != newest_ || job <= cancelled_) throw Stopped{};
    const std::optional<double> tolerance = goodEnoughPct > 0 ? std::optional(goodEnoughPct) : std::nullopt;
    const auto selection = std::make_shared<const glint::Selection>(
        engine_.choose(computedFor->scene, computedFor->request, tolerance, progress, previous.get()));
    if (job > cancelled_)
      QMetaObject::invokeMethod(
          this, [this, selection, computedFor] { emit chosen(selection, computedFor); }, Qt::QueuedConnection);
  });
}

void Runner::measure(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const std::string& file) {
  auto computedFor = std::make_shared<Opened>();
  computedFor->request = request;
  computedFor->scene = scene;
  post([this, computedFor, file](int job) {
    QElapsedTimer clock, lastSignal;
    clock.start();
    const ProgressFn progress = [&](const StageEvent& e) { return report(job, clock, lastSignal, e); };
    if (job != newest_ || job <= cancelled_) throw Stopped{};
    const auto tradeoff =
        std::make_shared<const Tradeoff>(engine_.tradeoff(computedFor->scene, computedFor->request, file, progress));
    if (job > cancelled_)
      QMetaObject::invokeMethod(
          this, [this, tradeoff, computedFor] { emit measured(tradeoff, computedFor); }, Qt::QueuedConnection);
  });
}

void Runner::influence(InspectionPtr inspection) {
  post([this, inspection = std::move(inspection)](int job) {
    QElapsedTimer clock, lastSignal;
    clock.start();
    const ProgressFn progress = [&](const StageEvent& e) { return report(job, clock, lastSignal, e); };
    if (job != newest_ || job <= cancelled_) throw Stopped{};
    const auto influence = std::make_shared<const Influence>(engine_.influence(*inspection, progress));
    if (job > cancelled_)
      QMetaObject::invokeMethod(
          this, [this, influence, inspection] { emit influenceMeasured(influence, inspection); }, Qt::QueuedConnection);
  });
}

void Runner::save(OpenedPtr opened, InspectionPtr results, const std::string& path) {
  const int job = ++newestSave_;
  if (++pending_ == 1) emit busyChanged(true);
  QMetaObject::invokeMethod(
      worker_,
      [this, job, opened = std::move(opened), results = std::move(results), path] {
        QString problem;
        try {
          QElapsedTimer lastSignal;
          const ProgressFn progress = [&](const StageEvent& e) {
            if (job <= cancelledSaves_) return false;
            showProgress(lastSignal, e);
            return true;
          };
          engine_.save(*opened, results.get(), path, progress);
        } catch (const Stopped&) {
          problem = toQString(path) + tr(": saving stopped; nothing was written");
        } catch (const std::exception& e) {
          problem = toQString(e.what());
        }
        QMetaObject::invokeMethod(
            this,
            [this, path, problem] {
              emit saved(exactQString(path), problem);
              countEnd();
            },
            Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

void Runner::post(std::function<void(int)> work, std::function<void()> onFailure) {
  const int job = ++newest_;
  if (++pending_ == 1) emit busyChanged(true);
  QMetaObject::invokeMethod(
      worker_,
      [this, job, work = std::move(work), onFailure = std::move(onFailure)] {
        End how = End::Done;
        QString message;
        try {
          work(job);
        } catch (const Stopped&) {
          how = End::Stopped;
        } catch (const std::exception& e) {
          how = End::Failed;
          message = toQString(e.what());
        }
        QMetaObject::invokeMethod(
            this, [this, job, how, message, onFailure] { end(job, how, message, onFailure); }, Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

bool Runner::report(int job, const QElapsedTimer& clock, QElapsedTimer& lastSignal, const StageEvent& event, int graceMs) {
  if (job <= cancelled_) return false;
  if (job != newest_ && clock.elapsed() > graceMs) return false;
  showProgress(lastSignal, event);
  return true;
}

void Runner::showProgress(QElapsedTimer& lastSignal, const StageEvent& event) {
  if (lastSignal.isValid() && lastSignal.elapsed() < kSignalEveryMs) return;
  lastSignal.start();
  const QString stage = toQString(event.stage);
  QMetaObject::invokeMethod(
      this, [this, stage, done = event.done, total = event.total] { emit progressed(stage, done, total); }, Qt::QueuedConnection);
}

void Runner::countEnd() {
  if (--pending_ == 0) emit busyChanged(false);
}

void Runner::end(int job, End how, const QString& message, const std::function<void()>& onFailure) {
  if (job == newest_ && how == End::Failed) emit failed(message);
  if (how == End::Failed && onFailure) onFailure();
  if (job == newest_ && how == End::Stopped) emit stopped();
  countEnd();
}

}  // namespace glint::gui
