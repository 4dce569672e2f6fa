// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QCache>
#include <QSet>
#include <QString>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>

#include "core/pipeline/photograph.h"

namespace glint::gui {

/// The source of pictures: a scene's files, or a what-if that renders them.
struct FramePictures {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const Inspection> synthesis{};  ///< null: the scene's files
  QString key{};                                  ///< pictureKey(); "" for files

  /// From now on those that belong to results on the same scene; null: as captured. False if that changes nothing.
  bool follow(std::shared_ptr<const Inspection> inspection);
  bool contain(int frame) const { return scene && frame >= 0 && frame < int(scene->frames.size()); }
  const Frame& frame(int index) const { return scene->frames[std::size_t(index)]; }
  friend bool operator==(const FramePictures& a, const FramePictures& b) { return a.scene == b.scene && a.key == b.key; }
};

/// One frame's picture, read from its file, or rendered at every n-th pixel. What readLinear, readPhotograph, linearImageOf and
/// photographOf return and throw.
Outcome<Image> decodeFrame(const FramePictures& of, int frame, FrameSource source, int every, const ProgressFn& going);

/// The whole frames that were decoded for the screen last, shared by all that show them. A frame on screen stays as long
/// as there is room for it; one decoded for something small stays only while there is plenty. Those of a scene that is
/// gone, and those of another what-if on the same scene, make room first. Thread-safe.
class DecodedFrames {
 public:
  using Held = std::shared_ptr<const Image>;
  using Decode = std::function<Outcome<Image>(const FramePictures&, int frame, FrameSource, int every, const ProgressFn&)>;

  /// @param mostBytes  of all images that are kept.
  explicit DecodedFrames(int mostBytes, Decode decode = decodeFrame);
  Held find(const FramePictures& pictures, int frame, FrameSource source);  ///< null if it is missing
  /// Serves a view: does not wait. @return, throws  as decodeFrame.
  Outcome<Held> whole(const FramePictures& pictures, int frame, FrameSource source, const ProgressFn& going = {});
  /// Serves a thumbnail, a texture, a value: waits for a file that is being read for a view. What a what-if renders comes at
  /// every n-th pixel unless the whole is there, and is not kept.
  Outcome<Held> part(const FramePictures& pictures, int frame, FrameSource source, int every);
  int bytes() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return int(kept_.totalCost());
  }

 private:
  struct Key {
    std::weak_ptr<const Scene> scene;
    QString pictures;
    int frame;
    FrameSource source;
    bool ofSameScene(const Key& o) const { return !scene.owner_before(o.scene) && !o.scene.owner_before(scene); }
    friend bool operator==(const Key& a, const Key& b) {
      return a.frame == b.frame && a.source == b.source && a.pictures == b.pictures && a.ofSameScene(b);
    }
    friend uint qHash(const Key& key, uint seed = 0) { return qHash(2 * key.frame + int(key.source), seed); }
  };
  Outcome<Held> decode(const Key& key, const FramePictures& pictures, int every, const ProgressFn& going, bool forView);

  const Decode decode_;
  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable decoded_;
  QCache<Key, Held> kept_;  ///< cost in bytes
  QSet<Key> underWay_;      ///< being decoded for a view
};

DecodedFrames& decodedFrames();  ///< those of this program

}  // namespace glint::gui
