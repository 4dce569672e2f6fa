// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/photo_loader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr double kQuickPixels = 2e4;  // rendered in some 20 ms
int quickStep(const Camera& camera) {
  return std::max(2, int(std::ceil(std::sqrt(double(camera.width) * camera.height / kQuickPixels))));
}
}  // namespace

QImage imageOf(const std::shared_ptr<const viz::Picture8>& picture) {
  using Held = std::shared_ptr<const viz::Picture8>;
  return QImage(
      picture->rgb.data(), picture->width, picture->height, 3 * picture->width, QImage::Format_RGB888,
      [](void* held) { delete static_cast<Held*>(held); }, new Held(picture));
}

QString photographAwaited(const Scene& scene, int frame) {
  return QObject::tr("reading the photograph of %1").arg(nameText(scene.frames[std::size_t(frame)].id));
}

void PhotoLoader::forget() {
  jobs_.drop();
  lastFrame_ = -1;
}

void PhotoLoader::setScene(std::shared_ptr<const Scene> scene) {
  forget();
  pictures_ = {std::move(scene)};
  last_ = {};
  wanted_ = -1;
  setBehind(false);
}

void PhotoLoader::setBehind(bool behind) {
  if (std::exchange(behind_, behind) != behind) emit behindChanged();
}

void PhotoLoader::setInspection(std::shared_ptr<const Inspection> inspection) {
  if (!pictures_.follow(std::move(inspection))) return;
  const bool shown = lastFrame_ >= 0;
  forget();
  if (shown) setBehind(true);
  want(wanted_);
}

void PhotoLoader::setLook(FrameSource source, const viz::Development& development) {
  if (source == source_ && development == development_) return;
  source_ = source;
  development_ = development;
  lastFrame_ = -1;
  want(wanted_);
}

void PhotoLoader::want(int frame) {
  if (!pictures_.contain(frame)) return;
  wanted_ = frame;
  if (frame == lastFrame_) {
    jobs_.drop();
    emit loaded(frame, last_);
    return;
  }
  const auto work = [this, frame, pictures = pictures_, source = source_, how = development_](const JobToken& token) {
    return answer(token, frame, pictures, source, how);
  };
  const auto done = [this, frame](const JobResult<Outcome<FramePicture>>& result) {
    if (result.overtaken || result.stopped) return;
    setBehind(false);
    if (!result.value) return void(emit failed(frame, result.failure()));
    const Outcome<FramePicture>& picture = *result.value;
    if (!picture) return void(emit failed(frame, toQString(picture.failure().message())));
    lastFrame_ = frame;
    last_ = *picture;
    emit loaded(frame, *picture);
  };
  jobs_.start(work, done, Asks::Newest);
}

Outcome<FramePicture> PhotoLoader::answer(const JobToken& token, int frame, const FramePictures& pictures, FrameSource source,
                                          const viz::Development& how) {  // in a job
  const Frame& f = pictures.frame(frame);
  FramePicture picture;
  picture.synthesised = pictures.synthesis != nullptr;
  picture.kind = source != FrameSource::Radiance              ? viz::Values::Srgb
                 : f.radiance.empty() && !picture.synthesised ? viz::Values::Linearised
                                                              : viz::Values::Linear;
  const auto develop = [&](DecodedFrames::Held values) {
    if (!token.wanted()) throw Stopped{};
    picture.values = std::move(values);
    picture.developed = std::make_shared<const viz::Picture8>(viz::develop(*picture.values, picture.kind, how));
    picture.shown = imageOf(picture.developed);
  };
  const ProgressFn going = [&](const StageEvent&) { return token.wanted(); };
  DecodedFrames::Held values = decodedFrames().find(pictures, frame, source);
  if (!values) {
    ++reads_;
    if (picture.synthesised) {
      if (Outcome<Image> quick = decodeFrame(pictures, frame, source, quickStep(f.camera), going)) {
        develop(std::make_shared<const Image>(std::move(*quick)));
        picture.complete = false;
        token.deliver([this, token, frame, picture] {
          if (token.overtaken()) return;
          last_ = picture;
          setBehind(false);
          emit loaded(frame, picture);
        });
        picture.complete = true;
      }
    }
    Outcome<DecodedFrames::Held> whole = decodedFrames().whole(pictures, frame, source, going);
    if (!whole) return whole.failure();
    values = std::move(*whole);
  }
  develop(std::move(values));
  return picture;
}

}  // namespace glint::gui
