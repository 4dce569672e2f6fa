// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QThread>
#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "viz/layers.h"

namespace glint::gui {

/// Photographs for the 3D views as textures, read (or rendered for a what-if) on a thread of their own: the newest wishes first,
/// the last results kept.
class PhotographStore : public QObject {
  Q_OBJECT
 public:
  explicit PhotographStore(QObject* parent = nullptr);
  ~PhotographStore() override;
  void setScene(std::shared_ptr<const Scene> scene);
  /// The results whose photographs are wanted: of a scene as read, or synthesised ones. While those that a what-if changed are
  /// made again, get() gives the ones before.
  void setInspection(const std::shared_ptr<const Inspection>& inspection);
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
    std::string pictures;  // pictureKey() that they belong to
  };
  /// What is read from, and the pictureKey() of it.
  struct Source {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Inspection> synthesis;  // null: the scene's files
    std::string pictures;
  };
  void readNext();
  void deliver(const Source& from, const Key& key, const vtkSmartPointer<vtkImageData>& texture);

  void setSource(Source source);

  Source source_;
  std::list<Kept> kept_;  // newest use first
  std::size_t keptBytes_ = 0;
  std::set<Key> wanted_;
  std::mutex mutex_;  // of the two below, which the thread reads
  std::vector<Key> queue_;
  Source sourceToRead_;
  QThread thread_;
  QObject* worker_;
  int pending_ = 0;
};

}  // namespace glint::gui
