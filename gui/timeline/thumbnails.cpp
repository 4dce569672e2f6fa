// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/thumbnails.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "core/pipeline/photograph.h"
#include "gui/base/background.h"
#include "gui/base/to_qimage.h"

namespace glint::gui {

Thumbnails::Thumbnails(QObject* parent) : QObject(parent), worker_(new QObject) {
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  startInBackground(thread_);
}

Thumbnails::~Thumbnails() {
  ++newest_;
  thread_.quit();
  thread_.wait();
}

void Thumbnails::setScene(std::shared_ptr<const Scene> scene) {
  ++newest_;
  kept_.clear();
  wished_.clear();
  synthesis_.reset();
  pictures_.clear();
  scene_ = std::move(scene);
}

void Thumbnails::setInspection(std::shared_ptr<const Inspection> inspection) {
  if (inspection && inspection->given != scene_) return;
  std::string pictures = inspection ? pictureKey(*inspection) : "";
  if (pictures == pictures_) return;
  ++newest_;
  wished_.clear();
  synthesis_ = inspection && picturesAreSynthesised(*inspection) ? std::move(inspection) : nullptr;
  pictures_ = std::move(pictures);
}

QImage Thumbnails::find(int frame) const {
  const Kept* kept = kept_.object(frame);
  return kept ? kept->picture : QImage();
}

void Thumbnails::want(const QList<int>& frames, int heightPx) {
  if (!scene_) return;
  QList<int> missing;
  for (const int frame : frames)
    if (const Kept* kept = kept_.object(frame);
        frame >= 0 && frame < int(scene_->frames.size()) && !(kept && kept->pictures == pictures_))
      missing << frame;
  if (missing.isEmpty()) return;
  // The same wish while it is being fulfilled: what has arrived by now is no longer in `missing`.
  bool same = pending_ > 0;
  for (const int frame : missing) same = same && wished_.contains(frame);
  if (same) return;
  wished_ = missing;
  ++pending_;
  const int ticket = ++newest_;
  QMetaObject::invokeMethod(
      worker_,
      [this, ticket, missing, heightPx, scene = scene_, synthesis = synthesis_, pictures = pictures_] {
        for (const int frame : missing) {
          if (ticket != newest_) break;
          QImage small(1, heightPx, QImage::Format_RGB888);  // stands for a frame that cannot be read
          small.fill(Qt::black);
          try {
            ++reads_;
            const Frame& f = scene->frames[std::size_t(frame)];
            const int every = std::max(1, f.camera.height / heightPx);
            if (const Outcome<Image> picture = synthesis ? photographOf(*synthesis, frame, every) : readPhotograph(f))
              small = toQImage(*picture).scaledToHeight(heightPx, Qt::SmoothTransformation);
          } catch (const std::exception&) {  // the frame view says what is wrong with it
          }
          QMetaObject::invokeMethod(
              this,
              [this, scene, pictures, frame, small] {
                if (scene != scene_ || pictures != pictures_) return;
                kept_.insert(frame, new Kept{small, pictures});
                emit arrived();
              },
              Qt::QueuedConnection);
        }
        QMetaObject::invokeMethod(
            this,
            [this] {
              --pending_;
              emit arrived();
            },
            Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

}  // namespace glint::gui
