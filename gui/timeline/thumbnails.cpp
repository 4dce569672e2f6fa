// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/thumbnails.h"

#include <algorithm>
#include <utility>

#include "gui/base/to_qimage.h"

namespace glint::gui {

void Thumbnails::forgetWishes() {
  jobs_.drop();
  wished_.clear();
}

void Thumbnails::setScene(std::shared_ptr<const Scene> scene) {
  forgetWishes();
  kept_.clear();
  pictures_ = {std::move(scene)};
}

void Thumbnails::setInspection(std::shared_ptr<const Inspection> inspection) {
  if (pictures_.follow(std::move(inspection))) forgetWishes();
}

QImage Thumbnails::find(int frame) const {
  const Kept* kept = kept_.object(frame);
  return kept ? kept->picture : QImage();
}

void Thumbnails::want(const QList<int>& frames, int heightPx) {
  QList<int> missing;
  for (const int frame : frames)
    if (const Kept* kept = kept_.object(frame); pictures_.contain(frame) && !(kept && kept->pictures == pictures_.key))
      missing << frame;
  if (missing.isEmpty()) return;
  // The same wish while it is being fulfilled: what has arrived by now is no longer in `missing`.
  bool same = busy();
  for (const int frame : missing) same = same && wished_.contains(frame);
  if (same) return;
  forgetWishes();
  wished_ = missing;
  for (const int frame : missing) {
    const auto make = [this, frame, heightPx, pictures = pictures_](const JobToken&) {
      ++reads_;
      const int every = std::max(1, pictures.frame(frame).camera.height / heightPx);
      const Outcome<DecodedFrames::Held> picture = decodedFrames().part(pictures, frame, FrameSource::Image, every);
      return picture ? toQImage(**picture).scaledToHeight(heightPx, Qt::SmoothTransformation) : QImage();
    };
    const auto keep = [this, frame, heightPx, pictures = pictures_](const JobResult<QImage>& result) {
      if (!(pictures == pictures_)) return;
      QImage small = result.value.value_or(QImage());
      if (small.isNull()) {  // the frame view says what is wrong with it
        small = QImage(1, heightPx, QImage::Format_RGB888);
        small.fill(Qt::black);
      }
      kept_.insert(frame, new Kept{small, pictures.key});
      emit arrived();
    };
    jobs_.start(make, keep);
  }
}

}  // namespace glint::gui
