// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/photograph_store.h"

#include <algorithm>
#include <utility>

#include "viz/convert.h"

namespace glint::gui {

namespace {
constexpr std::size_t kMostWishes = 40;  // older ones are of frames that were scrubbed over
}

void PhotographStore::setScene(std::shared_ptr<const Scene> scene) {
  if (scene == pictures_.scene && !pictures_.synthesis) return;
  forgetWishes();
  kept_.clear();
  pictures_ = {std::move(scene)};
}

void PhotographStore::setInspection(const std::shared_ptr<const Inspection>& inspection) {
  if (inspection->given != pictures_.scene) setScene(inspection->given);
  if (pictures_.follow(inspection)) forgetWishes();
}

void PhotographStore::forgetWishes() {
  jobs_.drop();
  wished_.clear();
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.clear();
}

viz::LayerCache::Photograph PhotographStore::get(int frame, int maxWidth) {
  if (!pictures_.contain(frame)) return {};
  const Key key(frame, maxWidth);
  Texture before;
  if (const Kept* kept = kept_.object(key)) {
    if (kept->pictures == pictures_.key) return {kept->texture, false};
    before = kept->texture;
  }
  if (wished_.insert(key).second) wish(key);
  return {before, true};
}

void PhotographStore::wish(const Key& key) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.push_back(key);
    if (waiting_.size() > kMostWishes) wished_.erase(waiting_.front()), waiting_.erase(waiting_.begin());
  }
  const auto taken = std::make_shared<Key>(-1, 0);
  const auto read = [this, taken, pictures = pictures_](const JobToken& token) -> Texture {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (waiting_.empty() || token.overtaken()) return nullptr;  // it may be a wish for other pictures that waits
      *taken = waiting_.back();
      waiting_.pop_back();
    }
    const auto [frame, width] = *taken;
    const int every = std::max(1, pictures.frame(frame).camera.width / std::max(1, width));  // as the texture has
    const Outcome<DecodedFrames::Held> image = decodedFrames().part(pictures, frame, FrameSource::Image, every);
    return image ? viz::toTexture(**image, width) : nullptr;
  };
  const auto keep = [this, taken](const JobResult<Texture>& result) {
    if (result.overtaken || !wished_.erase(*taken)) return;
    const Texture texture = result.value.value_or(nullptr);  // the layer reports null as unreadable
    const int bytes = texture ? int(1024 * texture->GetActualMemorySize()) : 1;
    kept_.insert(*taken, new Kept{texture, pictures_.key}, std::min(bytes, int(kept_.maxCost())));
    emit arrived(taken->first);
  };
  jobs_.start(read, keep);
}

}  // namespace glint::gui
