// SPDX-License-Identifier: BSD-3-Clause
#include "gui/explain/walk_player.h"

#include <algorithm>
#include <cmath>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
const char* const kWalkStep = "explain/walk-step";  // absent = the whole walk
constexpr int kStepMs = 70;

/// "not supported" is the program's word for what a model does not do.
QString why(const Failure& failure) {
  const bool bare = failure.reason == Reason::NotSupported && !failure.detail.empty();
  return toQString(bare ? failure.detail : failure.message());
}
}  // namespace

WalkPlayer::WalkPlayer(Document& document, QObject* parent) : QObject(parent), document_(document) {
  timer_.setInterval(kStepMs);
  connect(&timer_, &QTimer::timeout, this, &WalkPlayer::advance);
  for (const auto signal :
       {&Document::inspectionChanged, &Document::selectionChanged, &Document::sceneOpened, &Document::layersChanged})
    connect(&document_, signal, this, &WalkPlayer::ask);
  connect(&document_, &Document::optionsChanged, this, &WalkPlayer::followOption);
}

int WalkPlayer::step() const {
  const int last = story_ ? story_->steps() - 1 : 0;
  return playing() ? shown_ : std::clamp(int(std::lround(document_.option(kWalkStep, double(last)))), 0, last);
}

void WalkPlayer::ask() {
  if (!document_.inspection() || !document_.layerVisible("walk")) {
    job_.drop();
    timer_.stop();
    asked_ = {};
    if (!story_ && problem_.isEmpty()) return;
    story_.reset();
    problem_.clear();
    emit changed();
    return;
  }
  const Question question{document_.inspection(), document_.selection(),
                          document_.option("explain/step", std::string()) == "inverse-walk"};
  if (question == asked_) return;
  asked_ = question;
  // Depth maps are read for it: not here.
  job_.run([this, question] {
    const draw::Selection& s = question.selection;
    const int frame = std::clamp(s.frame, 0, int(question.inspection->scene->frames.size()) - 1);
    const Explanation explanation = explain(*question.inspection, frame, s.highlight, s.model);
    const Outcome<viz::WalkStory> found = viz::walkStory(*question.inspection, explanation, question.inverse, s.direction);
    auto story = found ? std::make_shared<const viz::WalkStory>(*found) : nullptr;
    const QString problem = found ? QString() : why(found.failure());
    return LatestJob::Deliver([this, story, problem] {
      story_ = story;
      problem_ = problem;
      if (!story_) timer_.stop();
      emit changed();
    });
  });
}

void WalkPlayer::followOption() {
  const std::string now = document_.option(kWalkStep, std::string());
  const bool moved = now != option_;
  option_ = now;
  if (moved) timer_.stop();  // someone else moved it: undo, a session
  ask();
  if (moved) emit changed();
}

void WalkPlayer::play() {
  if (!story_ || playing()) return;
  shown_ = step() >= story_->steps() - 1 ? 0 : step();
  timer_.start();
  emit changed();
}

void WalkPlayer::pause() {
  if (!playing()) return;
  timer_.stop();
  document_.showOption(kWalkStep, double(shown_));  // playing leaves no step of undo
  emit changed();
}

void WalkPlayer::setStep(int step, int gesture) {
  if (!story_) return;
  timer_.stop();
  const int at = std::clamp(step, 0, story_->steps() - 1);
  document_.setOption(kWalkStep, double(at), tr("Walk to step %1").arg(at + 1), gesture);
}

void WalkPlayer::advance() {
  if (!story_) return timer_.stop();
  if (++shown_ >= story_->steps() - 1) {
    shown_ = story_->steps() - 1;
    return pause();
  }
  emit changed();
}

}  // namespace glint::gui
