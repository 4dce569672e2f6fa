// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/video.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <fstream>
#include <list>
#include <memory>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "core/base/limits.h"
#include "core/base/number_text.h"
#include "core/base/quiet_libraries.h"
#include "core/codecs/codecs.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

constexpr double kSameTime = 0.5e-3;  // s: half of the coarsest clock (Matroska counts milliseconds)
constexpr int kMostSide = 65536;      // px, the limit of images
constexpr double kMegaPixel = 1e6;
constexpr int kSeekAhead = 64;   // pictures: a decoder is sooner there by going on than by a seek to the key frame before
constexpr int kKeptBefore = 16;  // pictures before the one that is asked for that are kept, for threads that run ahead of others
constexpr int kOpenVideos = 2;   // decoders that stay open
constexpr double kBytesPerMegabyte = 1e6;

Failure videoUnreadable(const fs::path& file, const std::string& reason) {
  return Failure{Reason::FrameUnreadable, file.string() + ": " + reason};
}

/// The times of a video in the order of its pictures. FFmpeg has none for the last pictures of some encoders; OpenCV says 0 then.
class VideoClock {
 public:
  VideoClock(const fs::path& file, double perSecond) : file_(file), period_(perSecond > 0 ? 1 / perSecond : 0) {}

  void add(double seconds, VideoContent& content) {
    std::vector<double>& all = content.seconds;
    const std::string place = "picture " + std::to_string(all.size());
    if (!std::isfinite(seconds)) throw InputError(file_.string(), place, "its time is not finite");
    if (all.empty()) return all.push_back(seconds);
    if (seconds == 0 && period_ > 0) {
      seconds = all.back() + period_;
      ++content.withoutTime;
    }
    if (!(seconds > all.back())) throw InputError(file_.string(), place, "its time does not follow that of the picture before");
    all.push_back(seconds);
  }

 private:
  const fs::path& file_;
  double period_;  ///< s; 0 = the video does not say
};

/// A video that is being decoded.
class OpenVideo {
 public:
  OpenVideo(const fs::path& file, std::uintmax_t bytes, fs::file_time_type changed)
      : file_(file), bytes_(bytes), changed_(changed) {}
  bool is(const fs::path& file, std::uintmax_t bytes, fs::file_time_type changed) const {
    return file == file_ && bytes == bytes_ && changed == changed_;
  }

  Outcome<cv::Mat> picture(const VideoPicture& p) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const Kept& k : kept_)
      if (k.index == p.index && sameTime(k.seconds, p)) return k.pixels;
    const QuietLibraries quiet;
    try {
      return decode(p);
    } catch (const cv::Exception&) {
      video_->close();
      return videoUnreadable(file_, "picture " + std::to_string(p.index) + " is damaged");
    }
  }

 private:
  struct Kept {
    int index = 0;
    double seconds = 0;
    cv::Mat pixels;
  };

  /// Without a time (0) the count of the pictures is all there is.
  static bool sameTime(double seconds, const VideoPicture& p) {
    return seconds == 0 || std::abs(seconds - p.seconds) < kSameTime;
  }

  Outcome<cv::Mat> decode(const VideoPicture& p) {
    const auto damaged = [&] { return videoUnreadable(file_, "picture " + std::to_string(p.index) + " does not decode"); };
    bool sought = false;
    if (!video_->isOpen() || p.index < next_ || p.index - next_ > kSeekAhead) {
      if (!start()) return videoUnreadable(file_, "is no video that can be decoded");
      sought = p.index > kSeekAhead && video_->seek(p.index);
      if (sought) next_ = p.index;
    }
    cv::Mat pixels;
    // A seek counts by a constant rate, which telephones do not keep.
    const bool there = advance(p.index, pixels) && (!sought || std::abs(video_->seconds() - p.seconds) < kSameTime);
    if (!there && !(sought && start() && advance(p.index, pixels))) return damaged();
    if (!sameTime(video_->seconds(), p))
      return videoUnreadable(file_, formatted("picture %d is of %.3f s, not of %.3f s", p.index, video_->seconds(), p.seconds));
    return pixels;
  }

  bool start() {
    video_->close();
    kept_.clear();  // what a seek gave may have been another picture
    next_ = 0;
    return video_->open(file_.string());
  }

  /// Decodes up to this picture and keeps it and the last ones before it.
  bool advance(int index, cv::Mat& pixels) {
    for (; next_ <= index; ++next_) {
      if (!video_->grab()) {
        video_->close();
        return false;
      }
      if (index - next_ > kKeptBefore) continue;
      cv::Mat decoded;
      if (!video_->retrieve(decoded) || decoded.empty() || decoded.depth() != CV_8U) return false;
      cv::Mat rgb;
      if (decoded.channels() == 3) cv::cvtColor(decoded, rgb, cv::COLOR_BGR2RGB);
      if (decoded.channels() == 1) cv::cvtColor(decoded, rgb, cv::COLOR_GRAY2RGB);
      if (rgb.empty()) return false;
      keep(next_, rgb);
      pixels = rgb;
    }
    return true;
  }

  void keep(int index, const cv::Mat& pixels) {
    kept_.push_back({index, video_->seconds(), pixels});
    const double each = double(pixels.total()) * double(pixels.elemSize()) / kBytesPerMegabyte;
    const auto most = static_cast<std::size_t>(std::max(1.0, kVideoMegabytes / each));
    while (kept_.size() > most) kept_.pop_front();
  }

  fs::path file_;
  std::uintmax_t bytes_;
  fs::file_time_type changed_;
  std::mutex mutex_;
  const std::unique_ptr<VideoDecoder> video_ = newVideoDecoder();
  int next_ = 0;  ///< the picture that `grab` gives next
  std::deque<Kept> kept_;
};

/// The one that reads this file, as it is now; the last kOpenVideos stay.
std::shared_ptr<OpenVideo> openVideo(const fs::path& file) {
  static std::mutex mutex;
  static std::list<std::shared_ptr<OpenVideo>> open;
  std::error_code failed;
  const std::uintmax_t bytes = fs::file_size(file, failed);
  if (failed) return nullptr;
  const fs::file_time_type changed = fs::last_write_time(file, failed);
  if (failed) return nullptr;
  const std::lock_guard<std::mutex> lock(mutex);
  const auto found = std::find_if(open.begin(), open.end(), [&](const auto& v) { return v->is(file, bytes, changed); });
  if (found != open.end()) {
    open.splice(open.begin(), open, found);
  } else {
    open.push_front(std::make_shared<OpenVideo>(file, bytes, changed));
    if (open.size() > kOpenVideos) open.pop_back();
  }
  return open.front();
}

void requireVideoSize(double width, double height, const std::string& file) {
  if (!(width >= 1 && height >= 1 && width <= kMostSide && height <= kMostSide))
    throw InputError(file, "", "the size of its pictures is not supported: 1 .. 65536 pixels are");
  requireWithin(Limit::ImageMegapixels, width * height / kMegaPixel, file);
}

}  // namespace

bool looksLikeVideo(const fs::path& file) {
  std::error_code ignored;  // no video if its kind is unknown; a pipe would make the program wait
  if (!fs::is_regular_file(file, ignored)) return false;
  constexpr std::size_t kStart = 12;  // bytes: RIFF, length, kind
  std::string start(kStart, '\0');
  std::ifstream in(file, std::ios::binary);
  if (!in.read(start.data(), kStart)) return false;
  const std::string_view begins = start, atom = begins.substr(4, 4);
  const bool isQuickTime = atom == "ftyp" || atom == "moov" || atom == "mdat" || atom == "wide";
  return isQuickTime || begins.substr(0, 4) == "\x1a\x45\xdf\xa3" ||
         (begins.substr(0, 4) == "RIFF" && begins.substr(8, 4) == "AVI ");
}

VideoContent readVideoContent(const fs::path& file) {
  const std::string name = file.string();
  if (!looksLikeVideo(file)) throw InputError(name, "", "is no video (MP4, MOV, Matroska, WebM and AVI are read)");
  VideoContent content;
  try {
    const QuietLibraries quiet;
    const std::unique_ptr<VideoDecoder> video = newVideoDecoder();
    if (!video->open(name)) throw InputError(name, "", "is no video that can be decoded: damaged, or of an unknown codec");
    requireVideoSize(video->width(), video->height(), name);
    content.rotation = video->rotation();
    VideoClock clock(file, video->picturesPerSecond());
    while (video->grab()) {
      const int width = static_cast<int>(video->width());
      const int height = static_cast<int>(video->height());
      if (content.seconds.empty()) {
        cv::Mat first;
        if (!video->retrieve(first) || first.empty()) throw InputError(name, "picture 0", "does not decode");
        content.width = first.cols;
        content.height = first.rows;
      } else if (width != content.width || height != content.height) {
        throw InputError(name, "picture " + std::to_string(content.seconds.size()), "has another size than the first");
      }
      if (content.seconds.size() >= static_cast<std::size_t>(kMostPictures))
        throw InputError(name, "", formatted("has more than %d pictures; cut out the part that is needed", kMostPictures));
      clock.add(video->seconds(), content);
    }
  } catch (const cv::Exception&) {
    throw InputError(name, "picture " + std::to_string(content.seconds.size()), "is damaged");
  }
  if (content.seconds.empty()) throw InputError(name, "", "has no picture that decodes");
  return content;
}

Outcome<cv::Mat> videoPicture(const fs::path& file, const VideoPicture& picture) {
  require(picture.index >= 0, "videoPicture: a negative index");
  if (!looksLikeVideo(file)) return videoUnreadable(file, "is missing or no video");
  const std::shared_ptr<OpenVideo> video = openVideo(file);
  if (!video) return videoUnreadable(file, "cannot be read");
  return video->picture(picture);
}

}  // namespace glint
