// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/ball_outlines.h"

#include <algorithm>
#include <cmath>

#include "core/app/ball_outline.h"
#include "core/base/number_text.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr double kMiddleReach = 1.6;     // of what counts as near: the cross in the middle is larger than a line is wide
constexpr std::size_t kMostSteps = 200;  // more than a person takes back; each holds some hundred bytes

Eigen::Index firstChange(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Index at = 0;
  (a - b).cwiseAbs().maxCoeff(&at);
  return at;
}
}  // namespace

void BallOutlines::keep(State before, std::optional<Field> field) {
  future_.clear();
  if (field && field == lastField_) return;  // the step begins with the first value
  lastField_ = field;
  past_.push_back(std::move(before));
  if (past_.size() > kMostSteps) past_.erase(past_.begin());
}

void BallOutlines::step(std::vector<State>& from, std::vector<State>& to) {
  if (from.empty() || drag_) return;
  to.push_back(state());
  const State now = std::move(from.back());
  from.pop_back();
  balls_ = now.balls;
  corners_ = now.corners;
  folder_ = now.folder;
  drawing_ = now.drawing;
  selected_ = now.selected;
  rim_.clear();
  lastField_.reset();
  emit changed();
  emit ballsChanged();
}

void BallOutlines::forgetSteps() {
  past_.clear();
  future_.clear();
  lastField_.reset();
  emit changed();
}

void BallOutlines::select(int ball) {
  ball = std::clamp(ball, -1, int(balls_.size()) - 1);
  if (ball == selected_) return;
  selected_ = ball;
  lastField_.reset();
  emit changed();
}

void BallOutlines::add(const BallOutline& outline) {
  keep(state());
  balls_.push_back({folder_, outline});
  selected_ = int(balls_.size()) - 1;
  emit changed();
  emit ballsChanged();
}

void BallOutlines::remove(int ball) {
  if (ball < 0 || ball >= int(balls_.size())) return;
  keep(state());
  balls_.erase(balls_.begin() + ball);
  selected_ = std::min(selected_, int(balls_.size()) - 1);
  emit changed();
  emit ballsChanged();
}

void BallOutlines::set(int ball, const BallOutline& outline) {
  if (ball < 0 || ball >= int(balls_.size())) return;
  BallOutline& now = balls_[std::size_t(ball)].outline;
  if (now.centre == outline.centre && now.radius == outline.radius) return;
  const auto numbers = [](const BallOutline& o) { return Eigen::Vector3d(o.centre.x(), o.centre.y(), o.radius); };
  keep(state(), Field{ball, firstChange(numbers(now), numbers(outline))});
  now = outline;
  emit changed();
  emit ballsChanged();
}

void BallOutlines::clear() {
  balls_.clear();
  corners_.clear();
  rim_.clear();
  folder_.clear();
  selected_ = -1;
  drag_.reset();
  drawing_ = Drawing::FromMiddle;
  forgetSteps();
  emit ballsChanged();
}

void BallOutlines::setFolder(const QString& folder) {
  if (folder == folder_) return;
  folder_ = folder;
  lastField_.reset();
  rim_.clear();
  emit changed();
}

Eigen::Vector2d BallOutlines::cornerOf(const QString& folder) const {
  const auto found = corners_.find(folder);
  return found == corners_.end() ? Eigen::Vector2d(0, 0) : found->second;
}

void BallOutlines::setCorner(const QString& folder, const Eigen::Vector2d& corner) {
  const Eigen::Vector2d now = cornerOf(folder);
  if (corner == now) return;
  keep(state(), Field{-1, corner.x() != now.x() ? 0 : 1});
  corners_[folder] = corner;
  emit changed();
  emit ballsChanged();
}

void BallOutlines::setDrawing(Drawing drawing) {
  if (drawing == drawing_) return;
  drawing_ = drawing;
  rim_.clear();
  emit changed();
}

void BallOutlines::clickRim(const Pixel& at) {
  if (drawing_ != Drawing::ThroughRim) return;
  rim_.push_back(at);
  if (rim_.size() < 3) return emit changed();
  const Outcome<BallOutline> circle = circleThrough(rim_[0], rim_[1], rim_[2]);
  rim_.clear();
  if (!circle) {
    emit changed();
    return emit problem(tr("No circle: %1").arg(toQString(circle.failure().detail)));
  }
  add(*circle);
  drawing_ = Drawing::Nothing;  // after it: one step back is to where it was drawn
  emit changed();
}

std::vector<NamedBall> BallOutlines::named() const {
  std::vector<NamedBall> named;
  for (const Ball& ball : balls_) {
    NamedBall n;
    n.folder = ball.folder.toStdString();
    n.corner = cornerOf(ball.folder);
    n.outline = {ball.outline.centre + n.corner, ball.outline.radius};
    n.text = formatted("%g,%g,%g", ball.outline.centre.x(), ball.outline.centre.y(), ball.outline.radius);
    named.push_back(std::move(n));
  }
  return named;
}

std::optional<std::pair<int, BallOutlines::Part>> BallOutlines::partAt(const Pixel& at, double nearPx) const {
  std::optional<std::pair<int, Part>> best;
  double nearest = nearPx;
  for (int k = 0; k < int(balls_.size()); ++k) {
    if (balls_[std::size_t(k)].folder != folder_) continue;
    const BallOutline& o = balls_[std::size_t(k)].outline;
    const double fromMiddle = (at - o.centre).norm();
    for (const auto& [part, distance] :
         {std::pair(Part::Middle, fromMiddle / kMiddleReach), std::pair(Part::Rim, std::abs(fromMiddle - o.radius))})
      if (distance <= nearest) nearest = distance, best = std::pair(k, part);
  }
  return best;
}

bool BallOutlines::wouldTake(const Pixel& at, double nearPx, Qt::KeyboardModifiers) const {
  return partAt(at, nearPx) || drawing_ == Drawing::FromMiddle;
}

bool BallOutlines::take(const Pixel& at, double nearPx, Qt::KeyboardModifiers) {
  if (drawing_ == Drawing::ThroughRim) return false;  // a click on another ball's outline may be one on a rim behind it
  if (const auto part = partAt(at, nearPx)) {
    drag_ = Drag{part->first, part->second, balls_[std::size_t(part->first)].outline.centre - at, false, false, state()};
    select(part->first);
    return true;
  }
  if (drawing_ != Drawing::FromMiddle) return false;
  drag_ = Drag{int(balls_.size()), Part::Rim, Eigen::Vector2d::Zero(), true, false, state()};
  balls_.push_back({folder_, {at, 0}});
  return true;
}

void BallOutlines::carry(const Pixel& to) {
  if (!drag_) return;
  BallOutline& o = balls_[std::size_t(drag_->ball)].outline;
  if (drag_->part == Part::Middle)
    o.centre = to + drag_->off;
  else
    o.radius = std::max(drag_->isNew ? 0 : kLeastRadius, (to - o.centre).norm());
  drag_->moved = true;
  selected_ = drag_->ball;
  emit changed();
}

void BallOutlines::release() {
  if (!drag_) return;
  const Drag drag = *drag_;
  drag_.reset();
  if (drag.isNew && balls_[std::size_t(drag.ball)].outline.radius < kLeastRadius) {
    balls_.pop_back();
    selected_ = std::min(selected_, int(balls_.size()) - 1);
    emit changed();
    if (drag.moved) emit problem(tr("An outline needs a radius of at least %1 px").arg(kLeastRadius));
    return;
  }
  if (drag.isNew) drawing_ = Drawing::Nothing;
  if (drag.moved) keep(drag.before);
  emit changed();
  if (drag.moved) emit ballsChanged();
}

}  // namespace glint::gui
