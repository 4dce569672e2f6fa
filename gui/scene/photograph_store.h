// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QCache>
#include <QObject>
#include <QPair>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "gui/base/decoded_frames.h"
#include "gui/base/job_queue.h"
#include "viz/layers.h"

namespace glint::gui {

/// Photographs for the 3D views as textures, read (or rendered for a what-if) off the interface thread: the newest wishes first,
/// the last results kept.
class PhotographStore : public QObject {
  Q_OBJECT
 public:
  explicit PhotographStore(QObject* parent = nullptr) : QObject(parent) {}
  void setScene(std::shared_ptr<const Scene> scene);
  /// The results whose photographs are wanted: of a scene as read, or synthesised ones. While those that a what-if changed are
  /// made again, get() gives the ones before.
  void setInspection(const std::shared_ptr<const Inspection>& inspection);
  /// The texture, or `arriving` with a later signal. @param maxWidth  px.
  viz::LayerCache::Photograph get(int frame, int maxWidth);
  bool busy() const { return jobs_.busy(); }

 signals:
  void arrived(int frame);

 private:
  using Texture = vtkSmartPointer<vtkImageData>;
  using Key = QPair<int, int>;  // frame, width
  struct Kept {
    Texture texture;   // null: cannot be read
    QString pictures;  // key of those that it belongs to
  };
  void forgetWishes();
  void wish(const Key& key);

  FramePictures pictures_;
  QCache<Key, Kept> kept_{384 << 20};  // cost in bytes
  std::set<Key> wished_;
  std::mutex mutex_;  // of the next
  std::vector<Key> waiting_;
  JobQueue jobs_;
};

}  // namespace glint::gui
