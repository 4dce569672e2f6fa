// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/photo_loader.h"

#include <exception>
#include <utility>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
/// The picture's bytes without a copy; they live as long as the image.
QImage imageOf(const std::shared_ptr<const viz::Picture8>& picture) {
  using Held = std::shared_ptr<const viz::Picture8>;
  return QImage(
      picture->rgb.data(), picture->width, picture->height, 3 * picture->width, QImage::Format_RGB888,
      [](void* held) { delete static_cast<Held*>(held); }, new Held(picture));
}
}  // namespace

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
  last_ = {};
  lastFrame_ = wanted_ = -1;
  scene_ = std::move(scene);
}

void PhotoLoader::setLook(FrameSource source, const viz::Development& development) {
  if (source == source_ && development == development_) return;
  source_ = source;
  development_ = development;
  lastFrame_ = -1;
  if (wanted_ >= 0) want(wanted_);
}

void PhotoLoader::want(int frame) {
  if (!scene_ || frame < 0 || frame >= int(scene_->frames.size())) return;
  const int ticket = ++newest_;
  wanted_ = frame;
  if (frame == lastFrame_) {
    emit loaded(frame, last_);
    return;
  }
  ++pending_;
  const Kept* found = kept_.object(keyOf(frame));
  QMetaObject::invokeMethod(
      worker_,
      [this, ticket, frame, scene = scene_, source = source_, development = development_, values = found ? *found : Kept()] {
        FramePicture picture;
        picture.values = values;
        const Frame& f = scene->frames[std::size_t(frame)];
        picture.kind = source != FrameSource::Radiance ? viz::Values::Srgb
                       : f.radiance.empty()            ? viz::Values::Linearised
                                                       : viz::Values::Linear;
        QString reason;
        if (ticket == newest_) {
          try {
            if (!picture.values) {
              ++reads_;
              const Outcome<Image> image = source == FrameSource::Radiance ? readLinear(f, source) : readPhotograph(f);
              if (image)
                picture.values = std::make_shared<const Image>(*image);
              else
                reason = toQString(image.failure().message());
            }
            if (picture.values && ticket == newest_) {
              picture.developed = std::make_shared<const viz::Picture8>(viz::develop(*picture.values, picture.kind, development));
              picture.shown = imageOf(picture.developed);
            }
          } catch (const std::exception& e) {
            reason = toQString(e.what());
          }
        }
        QMetaObject::invokeMethod(
            this, [this, ticket, frame, picture, reason] { deliver(ticket, frame, picture.values, picture, reason); },
            Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

void PhotoLoader::deliver(int ticket, int frame, const Kept& values, const FramePicture& picture, const QString& reason) {
  --pending_;
  if (ticket == newest_) {
    if (picture.shown.isNull()) {
      emit failed(frame, reason);
    } else {
      kept_.insert(keyOf(frame), new Kept(values), 1 + int(values->data.size() * sizeof(float) >> 20));
      last_ = picture;
      lastFrame_ = frame;
      emit loaded(frame, picture);
    }
  }
  if (pending_ == 0) emit idle();
}

}  // namespace glint::gui
