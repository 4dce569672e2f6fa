// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QTimer>
#include <memory>

#include "gui/base/latest_job.h"
#include "gui/document/document.h"
#include "viz/walk_story.h"

namespace glint::gui {

/// The walk of the selected direction, and how far it is shown: computed off the interface thread while the layer "walk" is
/// shown, forwards, or inverse while that step is explained. Its place is the option "explain/walk-step"; while it plays
/// it is nowhere but here, and pausing stores it as one step of undo.
class WalkPlayer : public QObject {
  Q_OBJECT
 public:
  explicit WalkPlayer(Document& document, QObject* parent = nullptr);
  std::shared_ptr<const viz::WalkStory> story() const { return story_; }  ///< null = none
  const QString& problem() const { return problem_; }                     ///< why there is no walk; "" if not asked for
  int step() const;
  bool playing() const { return timer_.isActive(); }
  bool busy() const { return job_.busy(); }

 public slots:
  void play();  ///< from the start when the walk is at its end
  void pause();
  void toggle() { playing() ? pause() : play(); }
  /// @param gesture  as Document::setOption.
  void setStep(int step, int gesture = 0);

 signals:
  void changed();  ///< story, step, playing

 private:
  struct Question {
    std::shared_ptr<const Inspection> inspection;
    draw::Selection selection;
    bool inverse = false;
    friend bool operator==(const Question&, const Question&) = default;
  };
  void ask();
  void followOption();
  void advance();

  Document& document_;
  LatestJob job_;
  QTimer timer_;
  Question asked_;
  std::shared_ptr<const viz::WalkStory> story_;
  QString problem_;
  int shown_ = 0;       ///< while playing
  std::string option_;  ///< of the document, as last seen
};

}  // namespace glint::gui
