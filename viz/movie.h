// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/progress.h"
#include "viz/scene_view.h"

namespace glint::viz {

struct MovieFormat {
  int width = 1280, height = 720;  ///< px, 16 .. 8192; even in a video file, whose colours are stored at half the size
  double framesPerSecond = 25;     ///< 0.1 .. 240
};

/// Writes a movie as its file's ending says: .mp4 (H.264, else MPEG-4), .webm (VP8), .avi (Motion JPEG), .mkv (FFV1, lossless),
/// or .png for a numbered series ("turn.png" -> turn_0000.png, turn_0001.png, ...). Whole or not at all: what was written is read
/// back and counted, and removed if it stops or fails.
/// @param picture  gives each frame in turn: 3 channels 0..1, of the format's size.
/// @throw InputError for an unknown ending, an odd size of a video, a file that cannot be written or encoded; Stopped.
///        std::invalid_argument for a format out of range or a picture of another size.
void writeMovie(const std::string& file, const MovieFormat& format, int frames, const std::function<Image(int)>& picture,
                const ProgressFn& progress = {});
/// The files that `writeMovie` writes: one, or the pictures of a series.
std::vector<std::string> filesOfMovie(const std::string& file, int frames);
/// InputError as `writeMovie` for what is wrong before the first frame.
void checkMovie(const std::string& file, const MovieFormat& format);

/// Views of one turn about an axis through the focal point: the i-th is turned by 360 deg * i / frames, so that the last one
/// leads on to the first. Distance, height and field of view stay. std::invalid_argument for a zero axis or no frames.
std::vector<ViewPoint> turntable(const ViewPoint& start, const Eigen::Vector3d& axis, int frames);
/// The same from what a view shows, about its world's upward axis. The view stays as it is.
std::vector<ViewPoint> turntable(SceneView& view, int frames);

}  // namespace glint::viz
