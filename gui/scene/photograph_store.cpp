// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/photograph_store.h"

#include <QMutexLocker>
#include <algorithm>
#include <exception>

#include "viz/convert.h"

namespace glint::gui {

namespace {
constexpr std::size_t kMostBytes = std::size_t(384) << 20;
constexpr std::size_t kMostWishes = 40;  // older ones are of frames that were scrubbed over
}  // namespace

PhotographStore::PhotographStore(QObject* parent) : QObject(parent), worker_(new QObject) {
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  thread_.start();
}

PhotographStore::~PhotographStore() {
  {
    const QMutexLocker lock(&mutex_);
    queue_.clear();
  }
  thread_.quit();
  thread_.wait();
}

void PhotographStore::setScene(std::shared_ptr<const Scene> scene) {
  if (scene == scene_) return;
  scene_ = std::move(scene);
  kept_.clear();
  keptBytes_ = 0;
  wanted_.clear();
  const QMutexLocker lock(&mutex_);
  queue_.clear();
  sceneToRead_ = scene_;
}

viz::LayerCache::Photograph PhotographStore::get(int frame, int maxWidth) {
  if (!scene_ || frame < 0 || frame >= int(scene_->frames.size())) return {};
  const Key key(frame, maxWidth);
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.key == key; });
  if (found != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, found);
    return {kept_.front().texture, false};
  }
  if (wanted_.insert(key).second) {
    {
      const QMutexLocker lock(&mutex_);
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
  return {nullptr, true};
}

void PhotographStore::readNext() {  // on the thread
  Key key(-1, 0);
  std::shared_ptr<const Scene> scene;
  {
    const QMutexLocker lock(&mutex_);
    scene = sceneToRead_;
    if (!queue_.empty()) {
      key = queue_.back();
      queue_.pop_back();
    }
  }
  vtkSmartPointer<vtkImageData> texture;
  if (key.first >= 0 && scene) {
    try {
      const Outcome<Image> image = readPhotograph(scene->frames[std::size_t(key.first)]);
      if (image) texture = viz::toTexture(*image, key.second);
    } catch (const std::exception&) {
      texture = nullptr;  // said by the layer as one that could not be read
    }
  }
  QMetaObject::invokeMethod(
      this, [this, scene, key, texture] { deliver(scene, key, texture); }, Qt::QueuedConnection);
}

void PhotographStore::deliver(const std::shared_ptr<const Scene>& scene, const Key& key,
                              const vtkSmartPointer<vtkImageData>& texture) {
  --pending_;
  if (key.first < 0 || scene != scene_ || !wanted_.erase(key)) return;
  Kept kept{key, texture, 0};
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
