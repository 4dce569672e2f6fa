// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/outcome.h"

namespace cv {
class Mat;
}

namespace glint {

/// Which picture of a video is meant.
struct VideoPicture {
  int index = 0;       ///< from 0, in the order in which a player shows them
  double seconds = 0;  ///< on the video's own clock, which begins with 0; detects a failed seek
  friend bool operator==(const VideoPicture&, const VideoPicture&) = default;
};

/// What a video holds, from a pass over all of its pictures: what its header counts is an estimate.
struct VideoContent {
  int width = 0, height = 0;    ///< px, of all pictures, as shown (a telephone's rotation is applied)
  int rotation = 0;             ///< degrees clockwise of the file's tag, by which stored pictures are turned; 0 = no tag
  std::vector<double> seconds;  ///< of every picture, on the video's own clock; rising
  int withoutTime = 0;          ///< pictures for which the video has no time: taken one period after the one before
};

/// Whether the first bytes are those of a container that is read here: MP4 and MOV, Matroska and WebM, AVI. Playlists do not
/// count, because they name other files. False if the file cannot be read.
bool looksLikeVideo(const std::filesystem::path& file);

/// Visits all pictures without converting them. InputError: no video (looksLikeVideo), nothing decodes, more than kMostPictures,
/// a picture of more than the limit of pixels, pictures of several sizes, times that do not rise. CodecsMissing, as videoPicture.
VideoContent readVideoContent(const std::filesystem::path& file);
inline constexpr int kMostPictures = 200'000;  // two hours at 25 per second

/// One picture: 3 channels, 8 bits, red green blue. Decoders stay open, and the last pictures that were decoded are kept
/// (kVideoMegabytes): threads that ask for neighbours cost one pass over the video. Thread-safe.
/// @return FrameUnreadable: the file is missing or no video, the picture does not decode or is not the one of that time.
Outcome<cv::Mat> videoPicture(const std::filesystem::path& file, const VideoPicture& picture);
inline constexpr double kVideoMegabytes = 200;  // of pictures that are kept: 32 of 1920 x 1080

}  // namespace glint
