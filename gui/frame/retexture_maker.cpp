// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/retexture_maker.h"

#include <filesystem>
#include <tuple>
#include <utility>

#include "core/retexture/wish.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
/// But for the look: of what the numbers are made.
bool sameNumbers(const RetextureWish& a, const RetextureWish& b) {
  const auto parts = [](const RetextureWish& w) {
    const RetextureRequest& r = w.request;
    return std::tie(w.inspection, w.frame, w.file, r.model, r.light, r.base, r.mapping, r.repeat, r.albedo, r.shading,
                    r.marginPx);
  };
  return parts(a) == parts(b);
}

/// Changes when a file is written anew.
std::pair<std::filesystem::file_time_type, std::uintmax_t> stateOf(const std::string& file) {
  std::error_code ignored;  // a file that is missing is told when it is read
  return {std::filesystem::last_write_time(file, ignored), std::filesystem::file_size(file, ignored)};
}
}  // namespace

struct RetextureMaker::Known {
  LearnedAppearances appearances;
  RetextureWish wish;
  std::pair<std::filesystem::file_time_type, std::uintmax_t> state;
  std::shared_ptr<const Retextured> result;  ///< of `wish`; null = none
};

RetextureMaker::RetextureMaker(QObject* parent) : QObject(parent), known_(std::make_shared<Known>()) {}

RetextureMaker::~RetextureMaker() = default;

void RetextureMaker::forget() {
  waiting_.reset();
  stop();
  known_ = std::make_shared<Known>();  // it holds results of core
}

void RetextureMaker::want(const RetextureWish& wish) {
  if (!running_) return start(wish);
  if (!stopping_ && sameNumbers(wish, *running_) && wish.look == running_->look) return waiting_.reset();
  waiting_ = wish;
  if (wish.frame != running_->frame || wish.inspection->given != running_->inspection->given) stop();
}

void RetextureMaker::stop() {
  if (!running_) return;
  stopping_ = true;
  jobs_.stop();
}

void RetextureMaker::start(const RetextureWish& wish) {
  running_ = wish;
  jobs_.start([wish, known = known_](const JobToken& token) { return answer(token, wish, *known); },
              [this, frame = wish.frame](const JobResult<RetextureAnswer>& result) {
                running_.reset();
                stopping_ = false;
                if (waiting_) start(*std::exchange(waiting_, std::nullopt));
                if (result.stopped) return;
                if (result.value) return void(emit made(*result.value));
                RetextureAnswer failed;
                failed.frame = frame;
                failed.failure = result.failure();
                emit made(failed);
              });
}

RetextureAnswer RetextureMaker::answer(const JobToken& token, const RetextureWish& wish, Known& known) {  // in a job
  RetextureAnswer a;
  a.frame = wish.frame;
  a.model = wish.request.model;
  const auto state = stateOf(wish.file);
  if (!known.result || !sameNumbers(wish, known.wish) || state != known.state) {
    known.result.reset();
    RetextureRequest request = wish.request;
    if (request.base == RetextureBase::Texture) request.picture = readTexture(wish.file, "");
    if (request.base == RetextureBase::Background)
      request.picture = readBackground(wish.file, wish.inspection->scene->frames[std::size_t(wish.frame)].camera, "");
    const ProgressFn going = [&](const StageEvent&) { return !token.stopped(); };
    Outcome<Retextured> made = retexture(*wish.inspection, wish.frame, request, going, &known.appearances);
    if (!made) {
      a.failure = toQString(made.failure().message());
      return a;
    }
    known.result = std::make_shared<const Retextured>(*std::move(made));
    known.wish = wish;
    known.state = state;
  }
  a.result = known.result;
  a.picture.values = std::shared_ptr<const Image>(known.result, &known.result->picture);
  a.picture.kind = viz::Values::Srgb;
  a.picture.developed = std::make_shared<const viz::Picture8>(viz::develop(*a.picture.values, a.picture.kind, wish.look));
  a.picture.shown = imageOf(a.picture.developed);
  return a;
}

}  // namespace glint::gui
