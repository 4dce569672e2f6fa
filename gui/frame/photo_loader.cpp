// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/photo_loader.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr double kQuickPixels = 2e4;  // rendered in some 20 ms
int quickStep(const Camera& camera) {
  return std::max(2, int(std::ceil(std::sqrt(double(camera.width) * camera.height / kQuickPixels))));
}

/// The picture's bytes without a copy; they live as long as the image.
QImage imageOf(const std::shared_ptr<const viz::Picture8>& picture) {
  using Held = std::shared_ptr<const viz::Picture8>;
  return QImage(
      picture->rgb.data(), picture->width, picture->height, 3 * picture->width, QImage::Format_RGB888,
      [](void* held) { delete static_cast<Held*>(held); }, new Held(picture));
}
}  // namespace

QString photographAwaited(const Scene& scene, int frame) {
  return QObject::tr("reading the photograph of %1").arg(nameText(scene.frames[std::size_t(frame)].id));
}

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

void PhotoLoader::forget() {
  ++newest_;
  kept_.clear();
  lastFrame_ = -1;
}

void PhotoLoader::setScene(std::shared_ptr<const Scene> scene) {
  forget();
  last_ = {};
  wanted_ = -1;
  synthesis_.reset();
  pictureKey_.clear();
  scene_ = std::move(scene);
}

void PhotoLoader::setInspection(std::shared_ptr<const Inspection> inspection) {
  if (inspection && inspection->given != scene_) return;
  const std::string key = inspection ? pictureKey(*inspection) : "";
  if (key == pictureKey_) return;
  forget();
  pictureKey_ = key;
  synthesis_ = key.empty() ? nullptr : std::move(inspection);
  if (wanted_ >= 0) want(wanted_);
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
  Wish wish{ticket, frame, scene_, synthesis_, source_, development_, found ? *found : Kept()};
  QMetaObject::invokeMethod(
      worker_, [this, wish = std::move(wish)] { answer(wish); }, Qt::QueuedConnection);
}

void PhotoLoader::answer(const Wish& wish) {  // on the thread
  const auto send = [&](const FramePicture& picture, const QString& reason) {
    QMetaObject::invokeMethod(
        this, [this, ticket = wish.ticket, frame = wish.frame, picture, reason] { deliver(ticket, frame, picture, reason); },
        Qt::QueuedConnection);
  };
  const auto wanted = [&] { return wish.ticket == newest_; };
  FramePicture picture;
  picture.values = wish.values;
  picture.synthesised = wish.synthesis != nullptr;
  const Frame& f = wish.scene->frames[std::size_t(wish.frame)];
  picture.kind = wish.source != FrameSource::Radiance         ? viz::Values::Srgb
                 : f.radiance.empty() && !picture.synthesised ? viz::Values::Linearised
                                                              : viz::Values::Linear;
  const auto developed = [&](const Outcome<Image>& image) {
    if (image) picture.values = std::make_shared<const Image>(*image);
    if (!picture.values || !wanted()) return;
    picture.developed = std::make_shared<const viz::Picture8>(viz::develop(*picture.values, picture.kind, wish.development));
    picture.shown = imageOf(picture.developed);
  };
  const auto rendered = [&](int every) {
    const ProgressFn going = [&](const StageEvent&) { return wanted(); };
    return wish.source == FrameSource::Radiance ? linearImageOf(*wish.synthesis, wish.frame, FrameSource::Radiance, every, going)
                                                : photographOf(*wish.synthesis, wish.frame, every, going);
  };
  QString reason;
  try {
    if (wanted() && picture.values) {
      developed(Failure{});
    } else if (wanted()) {
      ++reads_;
      if (picture.synthesised) {
        picture.complete = false;
        developed(rendered(quickStep(f.camera)));
        if (!picture.shown.isNull()) send(picture, {});
        picture.complete = true;
      }
      const Outcome<Image> image = picture.synthesised                    ? rendered(1)
                                   : wish.source == FrameSource::Radiance ? readLinear(f, wish.source)
                                                                          : readPhotograph(f);
      if (!image) reason = toQString(image.failure().message());
      developed(image);
    }
  } catch (const Stopped&) {  // another one is wished for by now
    picture.shown = {};
  } catch (const std::exception& e) {
    reason = toQString(e.what());
  }
  picture.complete = true;
  send(picture, reason);
}

void PhotoLoader::deliver(int ticket, int frame, const FramePicture& picture, const QString& reason) {
  if (picture.complete) --pending_;
  if (ticket == newest_) {
    if (picture.shown.isNull()) {
      emit failed(frame, reason);
    } else {
      if (picture.complete) {
        kept_.insert(keyOf(frame), new Kept(picture.values), 1 + int(picture.values->data.size() * sizeof(float) >> 20));
        lastFrame_ = frame;
      }
      last_ = picture;
      emit loaded(frame, picture);
    }
  }
  if (pending_ == 0) emit idle();
}

}  // namespace glint::gui
