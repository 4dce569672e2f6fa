// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/photo_loader.h"

#include <exception>
#include <utility>

#include "gui/base/text.h"
#include "gui/base/to_qimage.h"

namespace glint::gui {

PhotoLoader::PhotoLoader(QObject* parent) : QObject(parent), worker_(new QObject) {
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  thread_.start();
}

PhotoLoader::~PhotoLoader() {
  ++newest_;
  thread_.quit();
  thread_.wait();
}

void PhotoLoader::setScene(std::shared_ptr<const Scene> scene) {
  ++newest_;
  kept_.clear();
  scene_ = std::move(scene);
}

void PhotoLoader::want(int frame) {
  if (!scene_ || frame < 0 || frame >= int(scene_->frames.size())) return;
  const int ticket = ++newest_;
  if (const QImage* kept = kept_.object(frame)) {
    emit loaded(frame, *kept);
    return;
  }
  ++pending_;
  QMetaObject::invokeMethod(
      worker_,
      [this, ticket, frame, scene = scene_] {
        QImage image;
        QString reason;
        if (ticket == newest_) {
          try {
            const Outcome<Image> photograph = readPhotograph(scene->frames[std::size_t(frame)]);
            if (photograph)
              image = toQImage(*photograph);
            else
              reason = toQString(photograph.failure().message());
          } catch (const std::exception& e) {
            reason = toQString(e.what());
          }
        }
        QMetaObject::invokeMethod(
            this, [this, ticket, frame, image, reason] { deliver(ticket, frame, image, reason); }, Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

void PhotoLoader::deliver(int ticket, int frame, const QImage& image, const QString& reason) {
  --pending_;
  if (ticket == newest_) {
    if (image.isNull()) {
      emit failed(frame, reason);
    } else {
      kept_.insert(frame, new QImage(image), 1 + int(image.sizeInBytes() >> 20));
      emit loaded(frame, image);
    }
  }
  if (pending_ == 0) emit idle();
}

}  // namespace glint::gui
