// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <memory>
#include <optional>
#include <string>

#include "core/retexture/retexture.h"
#include "gui/base/job_queue.h"
#include "gui/frame/photo_loader.h"

namespace glint::gui {

/// What a retextured picture of a frame is made from.
struct RetextureWish {
  std::shared_ptr<const Inspection> inspection;
  int frame = -1;
  std::string file;          ///< of the texture or background; "" if none is needed
  RetextureRequest request;  ///< but for its picture
  viz::Development look;     ///< as the photograph beside it
};

struct RetextureAnswer {
  int frame = -1;
  std::string model;
  std::shared_ptr<const Retextured> result;  ///< null if it failed
  FramePicture picture;
  QString failure;  ///< one line; "" = none
};

/// Retextures frames off the interface thread. A run for the same frame goes on to its end, so that pictures follow a slider
/// that is being dragged; then comes the newest request.
class RetextureMaker : public QObject {
  Q_OBJECT
 public:
  explicit RetextureMaker(QObject* parent = nullptr);
  ~RetextureMaker() override;
  /// made() follows; at once where nothing has changed since.
  void want(const RetextureWish& wish);
  /// No request is needed any longer.
  void forget();
  /// An answer is on its way.
  bool busy() const { return running_ || waiting_; }

 signals:
  void made(const glint::gui::RetextureAnswer& answer);

 private:
  struct Known;
  void start(const RetextureWish& wish);
  void stop();
  static RetextureAnswer answer(const JobToken& token, const RetextureWish& wish, Known& known);

  std::shared_ptr<Known> known_;  ///< its content is touched in jobs alone, of which one runs at a time
  std::optional<RetextureWish> running_, waiting_;
  bool stopping_ = false;  ///< what runs was stopped, and has not ended yet
  JobQueue jobs_;
};

}  // namespace glint::gui
