// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMutex>
#include <QObject>
#include <QThread>
#include <list>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "viz/layers.h"

namespace glint::gui {

/// Photographs for the 3D views as textures, read on a thread of their own: the newest wishes first, the last results kept.
class PhotographStore : public QObject {
  Q_OBJECT
 public:
  explicit PhotographStore(QObject* parent = nullptr);
  ~PhotographStore() override;
  void setScene(std::shared_ptr<const Scene> scene);
  /// The texture, or `arriving` with a later signal. @param maxWidth  px.
  viz::LayerCache::Photograph get(int frame, int maxWidth);
  bool busy() const { return pending_ > 0; }

 signals:
  void arrived(int frame);

 private:
  using Key = std::pair<int, int>;  // frame, width
  struct Kept {
    Key key;
    vtkSmartPointer<vtkImageData> texture;  // null: cannot be read
    std::size_t bytes = 0;
  };
  void readNext();
  void deliver(const std::shared_ptr<const Scene>& scene, const Key& key, const vtkSmartPointer<vtkImageData>& texture);

  std::shared_ptr<const Scene> scene_;
  std::list<Kept> kept_;  // newest use first
  std::size_t keptBytes_ = 0;
  std::set<Key> wanted_;
  QMutex mutex_;  // of the two below, which the thread reads
  std::vector<Key> queue_;
  std::shared_ptr<const Scene> sceneToRead_;
  QThread thread_;
  QObject* worker_;
  int pending_ = 0;
};

}  // namespace glint::gui
