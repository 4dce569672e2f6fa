// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QImage>
#include <QObject>
#include <QString>
#include <atomic>
#include <memory>

#include "gui/base/decoded_frames.h"
#include "gui/base/job_queue.h"
#include "viz/develop.h"

namespace glint::gui {

/// A frame's image: the numbers, and how they look on screen.
struct FramePicture {
  std::shared_ptr<const Image> values;  ///< null for a picture without numbers
  viz::Values kind = viz::Values::Srgb;
  bool synthesised = false;  ///< rendered for a what-if, not captured
  bool complete = true;      ///< else a first look at some of its pixels, the whole follows
  std::shared_ptr<const viz::Picture8> developed;
  QImage shown;  ///< shares the pixels of `developed`
};

/// The picture's bytes without a copy; they live as long as the image.
QImage imageOf(const std::shared_ptr<const viz::Picture8>& picture);

/// The text over the photograph of another frame meanwhile.
QString photographAwaited(const Scene& scene, int frame);

/// Reads, or renders for a what-if, photographs or radiances and develops them off the interface thread. Only the newest wish is
/// answered: scrubbing over hundreds of frames reads those that one stops at.
class PhotoLoader : public QObject {
  Q_OBJECT
 public:
  explicit PhotoLoader(QObject* parent = nullptr) : QObject(parent) {}
  void setScene(std::shared_ptr<const Scene> scene);
  /// Where a what-if synthesises the contours, the pictures are those that belong to these results; null = as captured. Where
  /// this changes them, the last wish is answered again: by a quick look first, then by the whole.
  void setInspection(std::shared_ptr<const Inspection> inspection);
  /// What is shown and how; the last wish is answered again when this changes it.
  void setLook(FrameSource source, const viz::Development& development);
  /// Answers with loaded() or failed(), at once when the frame was the last one.
  void want(int frame);
  bool busy() const { return jobs_.busy(); }
  /// The last answer does not belong to these results (see setInspection): that of the last wish is on its way.
  bool behind() const { return behind_; }
  int reads() const { return reads_; }  ///< files decoded so far
  /// The last answer.
  const FramePicture& picture() const { return last_; }
  int pictureFrame() const { return lastFrame_; }

 signals:
  void behindChanged();
  void loaded(int frame, const glint::gui::FramePicture& picture);
  void failed(int frame, const QString& reason);

 private:
  Outcome<FramePicture> answer(const JobToken& token, int frame, const FramePictures& pictures, FrameSource source,
                               const viz::Development& how);
  void forget();
  void setBehind(bool behind);

  FramePictures pictures_;
  FrameSource source_ = FrameSource::Image;
  viz::Development development_;
  int wanted_ = -1;
  FramePicture last_;
  int lastFrame_ = -1;
  bool behind_ = false;
  std::atomic<int> reads_{0};
  JobQueue jobs_{JobQueue::Rank::Foreground};
};

}  // namespace glint::gui
