// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "gui/document/document.h"
#include "gui/plots/samples_loader.h"

namespace glint::gui {

/// What the frame view's layer "Lobes" draws, read while the layer is shown: the pixels of the selected frame's highlights with
/// every lobe fitted to them.
class LobeLayer : public QObject {
  Q_OBJECT
 public:
  explicit LobeLayer(Document& document, QObject* parent = nullptr);
  FrameSamplesPtr samples() const { return samples_; }  ///< null while hidden, and until they are read
  bool busy() const { return loader_.busy(); }

 signals:
  void changed();

 private:
  void follow();

  Document& document_;
  SamplesLoader loader_;
  FrameSamplesPtr samples_;
  std::shared_ptr<const Inspection> wantedOf_;  ///< what was asked for last
  int wantedFrame_ = -1;
  std::string wantedModel_;
};

}  // namespace glint::gui
