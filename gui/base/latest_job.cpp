// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/latest_job.h"

#include <exception>
#include <utility>

#include "gui/base/background.h"

namespace glint::gui {

LatestJob::LatestJob(QObject* parent) : QObject(parent), worker_(new QObject) {
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  startInBackground(thread_);
}

LatestJob::~LatestJob() {
  ++newest_;
  thread_.quit();
  thread_.wait();
}

void LatestJob::run(std::function<Deliver()> work) {
  const int job = ++newest_;
  ++pending_;
  awaited_ = true;
  QMetaObject::invokeMethod(
      worker_,
      [this, job, work = std::move(work)] {
        Deliver deliver;
        try {
          if (job == newest_) deliver = work();
        } catch (const std::exception&) {
          // A job reports what can go wrong in its result; what is left is a bug, which must not end the program.
        }
        QMetaObject::invokeMethod(
            this,
            [this, job, deliver = std::move(deliver)] {
              --pending_;
              if (job != newest_) return;
              awaited_ = false;
              if (deliver) deliver();
            },
            Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

}  // namespace glint::gui
