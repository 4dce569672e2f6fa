// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/samples_loader.h"

#include <exception>
#include <utility>

namespace glint::gui {

SamplesLoader::SamplesLoader(QObject* parent) : QObject(parent), worker_(new QObject) {
  qRegisterMetaType<FrameSamplesPtr>("glint::gui::FrameSamplesPtr");
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  thread_.start();
}

SamplesLoader::~SamplesLoader() {
  ++newest_;
  thread_.quit();
  thread_.wait();
}

void SamplesLoader::want(std::shared_ptr<const Inspection> inspection, int frame, const std::string& model) {
  const int ticket = ++newest_;
  if (!inspection) return;
  ++pending_;
  QMetaObject::invokeMethod(
      worker_,
      [this, ticket, inspection = std::move(inspection), frame, model] {
        auto samples = std::make_shared<viz::FrameSamples>();
        if (ticket == newest_) {
          try {
            *samples = viz::frameSamples(*inspection, frame, model);
          } catch (const std::exception& e) {
            samples->failure = e.what();
          }
        }
        QMetaObject::invokeMethod(
            this,
            [this, ticket, samples = FrameSamplesPtr(std::move(samples))] {
              --pending_;
              if (ticket == newest_) emit loaded(samples);
            },
            Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

}  // namespace glint::gui
