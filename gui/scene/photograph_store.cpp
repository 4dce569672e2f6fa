// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/photograph_store.h"

#include <algorithm>
#include <exception>

#include "core/pipeline/photograph.h"
#include "gui/base/background.h"
#include "viz/convert.h"

namespace glint::gui {

namespace {
constexpr std::size_t kMostBytes = std::size_t(384) << 20;
constexpr std::size_t kMostWishes = 40;  // older ones are of frames that were scrubbed over
}  // namespace

PhotographStore::PhotographStore(QObject* parent) : QObject(parent), worker_(new QObject) {
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  startInBackground(thread_);
}

PhotographStore::~PhotographStore() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    queue_.clear();
  }
  thread_.quit();
  thread_.wait();
}

void PhotographStore::setScene(std::shared_ptr<const Scene> scene) {
  if (scene == source_.scene && !source_.synthesis) return;
  kept_.clear();
  keptBytes_ = 0;
  setSource({std::move(scene), nullptr, {}});
}

void PhotographStore::setInspection(const std::shared_ptr<const Inspection>& inspection) {
  if (inspection->given != source_.scene) setScene(inspection->given);
  std::string pictures = pictureKey(*inspection);
  if (pictures == source_.pictures) return;
  const bool synthesised = picturesAreSynthesised(*inspection);
  setSource({source_.scene, synthesised ? inspection : nullptr, std::move(pictures)});
}

void PhotographStore::setSource(Source source) {
  source_ = std::move(source);
  wanted_.clear();
  const std::lock_guard<std::mutex> lock(mutex_);
  queue_.clear();
  sourceToRead_ = source_;
}

viz::LayerCache::Photograph PhotographStore::get(int frame, int maxWidth) {
  if (!source_.scene || frame < 0 || frame >= int(source_.scene->frames.size())) return {};
  const Key key(frame, maxWidth);
  vtkSmartPointer<vtkImageData> before;
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.key == key; });
  if (found != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, found);
    if (kept_.front().pictures == source_.pictures) return {kept_.front().texture, false};
    before = kept_.front().texture;
  }
  if (wanted_.insert(key).second) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      queue_.push_back(key);
      if (queue_.size() > kMostWishes) {
        wanted_.erase(queue_.front());
        queue_.erase(queue_.begin());
      }
    }
    ++pending_;
    QMetaObject::invokeMethod(
        worker_, [this] { readNext(); }, Qt::QueuedConnection);
  }
  return {before, true};
}

void PhotographStore::readNext() {  // on the thread
  Key key(-1, 0);
  Source from;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    from = sourceToRead_;
    if (!queue_.empty()) {
      key = queue_.back();
      queue_.pop_back();
    }
  }
  vtkSmartPointer<vtkImageData> texture;
  if (key.first >= 0 && from.scene) {
    try {
      const Frame& f = from.scene->frames[std::size_t(key.first)];
      const int every = std::max(1, f.camera.width / std::max(1, key.second));  // no more pixels than the texture has
      const Outcome<Image> image = from.synthesis ? photographOf(*from.synthesis, key.first, every) : readPhotograph(f);
      if (image) texture = viz::toTexture(*image, key.second);
    } catch (const std::exception&) {
      texture = nullptr;  // said by the layer as one that could not be read
    }
  }
  QMetaObject::invokeMethod(
      this, [this, from, key, texture] { deliver(from, key, texture); }, Qt::QueuedConnection);
}

void PhotographStore::deliver(const Source& from, const Key& key, const vtkSmartPointer<vtkImageData>& texture) {
  --pending_;
  if (key.first < 0 || from.scene != source_.scene || from.pictures != source_.pictures || !wanted_.erase(key)) return;
  const auto before = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.key == key; });
  if (before != kept_.end()) {
    keptBytes_ -= before->bytes;
    kept_.erase(before);
  }
  Kept kept{key, texture, 0, from.pictures};
  if (texture) kept.bytes = std::size_t(texture->GetActualMemorySize()) * 1024;
  keptBytes_ += kept.bytes;
  kept_.push_front(std::move(kept));
  while (keptBytes_ > kMostBytes && kept_.size() > 1) {
    keptBytes_ -= kept_.back().bytes;
    kept_.pop_back();
  }
  emit arrived(key.first);
}

}  // namespace glint::gui
