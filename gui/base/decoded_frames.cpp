// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/decoded_frames.h"

#include <QScopeGuard>
#include <algorithm>
#include <limits>
#include <utility>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kMostBytes = 768 << 20;  // some ten frames of 6 megapixels, or two of 32
constexpr int kShareOfParts = 4;       // what was decoded for thumbnails fills a quarter: all else is room for what is looked at
}  // namespace

bool FramePictures::follow(std::shared_ptr<const Inspection> inspection) {
  if (inspection && inspection->given != scene) return false;
  const QString before = std::exchange(key, inspection ? exactQString(pictureKey(*inspection)) : QString());
  if (key == before) return false;
  synthesis = key.isEmpty() ? nullptr : std::move(inspection);
  return true;
}

Outcome<Image> decodeFrame(const FramePictures& of, int frame, FrameSource source, int every, const ProgressFn& going) {
  if (!of.synthesis) return source == FrameSource::Image ? readPhotograph(of.frame(frame)) : readLinear(of.frame(frame), source);
  return source == FrameSource::Image ? photographOf(*of.synthesis, frame, every, going)
                                      : linearImageOf(*of.synthesis, frame, source, every, going);
}

DecodedFrames::DecodedFrames(int mostBytes, Decode decode) : decode_(std::move(decode)), kept_(mostBytes) {}

DecodedFrames::Held DecodedFrames::find(const FramePictures& pictures, int frame, FrameSource source) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Held* found = kept_.object({pictures.scene, pictures.key, frame, source});
  return found ? *found : nullptr;
}

Outcome<DecodedFrames::Held> DecodedFrames::whole(const FramePictures& pictures, int frame, FrameSource source,
                                                  const ProgressFn& going) {
  const Key key{pictures.scene, pictures.key, frame, source};
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const Held* found = kept_.object(key)) return *found;
    underWay_.insert(key);
  }
  const auto letThemGoOn = qScopeGuard([&] {  // whether it succeeds, fails or is stopped
    const std::lock_guard<std::mutex> lock(mutex_);
    underWay_.remove(key);
    decoded_.notify_all();
  });
  return decode(key, pictures, 1, going, true);
}

Outcome<DecodedFrames::Held> DecodedFrames::part(const FramePictures& pictures, int frame, FrameSource source, int every) {
  const Key key{pictures.scene, pictures.key, frame, source};
  {
    std::unique_lock<std::mutex> lock(mutex_);
    // Rendering the whole may take seconds, and a few pixels are soon there.
    if (!pictures.synthesis) decoded_.wait(lock, [&] { return !underWay_.contains(key); });
    if (const Held* found = kept_.object(key)) return *found;
  }
  return decode(key, pictures, pictures.synthesis ? every : 1, {}, false);
}

Outcome<DecodedFrames::Held> DecodedFrames::decode(const Key& key, const FramePictures& pictures, int every,
                                                   const ProgressFn& going, bool forView) {
  Outcome<Image> image = decode_(pictures, key.frame, key.source, every, going);
  if (!image) return image.failure();
  const Held held = std::make_shared<const Image>(std::move(*image));
  if (!forView && pictures.synthesis) return held;
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const Key& other : kept_.keys()) {
    const bool bothRendered = !other.pictures.isEmpty() && !key.pictures.isEmpty();
    if (other.scene.expired() || (bothRendered && other.pictures != key.pictures && other.ofSameScene(key))) kept_.remove(other);
  }
  const std::size_t most = std::numeric_limits<int>::max();  // more than there is room for: it is not kept
  const int bytes = int(std::min(most, held->data.size() * sizeof(float)));
  if (forView || bytes <= kept_.maxCost() / kShareOfParts - kept_.totalCost()) kept_.insert(key, new Held(held), bytes);
  return held;
}

DecodedFrames& decodedFrames() {
  static auto* const all = new DecodedFrames(kMostBytes);  // never deleted: jobs may use it while the program is told to exit
  return *all;
}

}  // namespace glint::gui
