// SPDX-License-Identifier: BSD-3-Clause
#include "viz/movie.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <opencv2/core.hpp>

#include "core/base/atomic_file.h"
#include "core/base/number_text.h"
#include "core/base/outcome.h"
#include "core/base/quiet_libraries.h"
#include "core/codecs/codecs.h"
#include "viz/canvas.h"

namespace glint::viz {
namespace {

namespace fs = std::filesystem;

/// Codes of codecs to try in turn.
struct Container {
  const char* ending;
  std::vector<const char*> codecs;
};
const Container kContainers[] = {{".mp4", {"avc1", "mp4v"}}, {".webm", {"VP80"}}, {".avi", {"MJPG"}}, {".mkv", {"FFV1"}}};

std::string endingOf(const std::string& file) {
  std::string ending = fs::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return ending;
}

const Container* containerOf(const std::string& file) {
  const std::string ending = endingOf(file);
  for (const Container& c : kContainers)
    if (ending == c.ending) return &c;
  return nullptr;
}

Image checked(Image picture, const MovieFormat& format) {
  require(picture.width == format.width && picture.height == format.height && picture.channels == 3,
          "writeMovie: a picture has another size than the movie");
  return picture;
}

cv::Mat toBgr(const Image& picture) {
  cv::Mat pixels(picture.height, picture.width, CV_8UC3);
  for (int y = 0; y < picture.height; ++y) {
    unsigned char* row = pixels.ptr<unsigned char>(y);
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < 3; ++c)
        row[3 * x + c] = static_cast<unsigned char>(std::lround(255 * std::clamp(picture.at(x, y, 2 - c), 0.f, 1.f)));
  }
  return pixels;
}

void writeSeries(const std::string& file, const MovieFormat& format, int frames, const std::function<Image(int)>& picture,
                 const ProgressFn& progress) {
  const std::vector<std::string> files = filesOfMovie(file, frames);
  const fs::path folder = fs::path(file).parent_path();
  std::error_code ignored;  // what cannot be asked about does not exist
  if (!fs::is_directory(folder.empty() ? "." : folder, ignored))
    throw InputError(file, "", "cannot be written: the folder " + folder.string() + " does not exist");
  atomicFiles(folder.empty() ? "." : folder, "", [&](const fs::path& out) {
    for (int i = 0; i < frames; ++i) {
      if (!report(progress, {"frame", i, frames})) throw Stopped{};
      writePng(checked(picture(i), format), (out / fs::path(files[static_cast<std::size_t>(i)]).filename()).string());
    }
  });
}

/// A library's call, without what the library prints.
template <class Call>
auto quietly(const Call& call) {
  const QuietLibraries guard;
  return call();
}

/// A writer that ends in silence too, even when a picture could not be drawn.
struct Writer {
  const std::unique_ptr<VideoEncoder> video = newVideoEncoder();
  ~Writer() {
    quietly([&] { video->close(); });
  }
};

void encode(const std::string& file, const fs::path& temporary, const MovieFormat& format, int frames,
            const std::function<Image(int)>& picture, const ProgressFn& progress) {
  const Writer writer;
  for (const char* codec : containerOf(file)->codecs)
    if (quietly(
            [&] { return writer.video->open(temporary.string(), codec, format.framesPerSecond, format.width, format.height); }))
      break;
  if (!writer.video->isOpen())
    throw InputError(file, "", "cannot be written: no access, or no encoder on this computer for " + endingOf(file));
  for (int i = 0; i < frames; ++i) {
    if (!report(progress, {"frame", i, frames})) throw Stopped{};
    const cv::Mat pixels = toBgr(checked(picture(i), format));
    quietly([&] { writer.video->write(pixels); });
  }
  quietly([&] { writer.video->close(); });
  // The writer tells of no failure: a full disk shows only here.
  const std::unique_ptr<VideoDecoder> back = newVideoDecoder();
  int found = 0;
  const bool opened = quietly([&] { return back->open(temporary.string()); });
  while (opened && quietly([&] { return back->grab(); })) {
    if (!report(progress, {"reading back", found, frames})) throw Stopped{};
    ++found;
  }
  quietly([&] { back->close(); });
  if (found != frames)
    throw InputError(
        file, "",
        "only " + std::to_string(found) + " of " + std::to_string(frames) + " frames could be read back; the disk may be full");
}

}  // namespace

std::vector<std::string> filesOfMovie(const std::string& file, int frames) {
  if (endingOf(file) != ".png") return {file};
  std::vector<std::string> files;
  for (int i = 0; i < frames; ++i) {
    const std::string number = formatted("_%04d.png", i);
    files.push_back((fs::path(file).parent_path() / (fs::path(file).stem().string() + number)).string());
  }
  return files;
}

void checkMovie(const std::string& file, const MovieFormat& f) {
  require(f.width >= 16 && f.height >= 16 && f.width <= 8192 && f.height <= 8192,
          "writeMovie: size must be between 16 and 8192 pixels");
  require(f.framesPerSecond >= 0.1 && f.framesPerSecond <= 240, "writeMovie: frames per second must be between 0.1 and 240");
  if (endingOf(file) == ".png") return;
  if (!containerOf(file))
    throw InputError(file, "", "the name of a movie must end in .mp4, .webm, .avi, .mkv, or in .png for an image sequence");
  if (f.width % 2 || f.height % 2) throw InputError(file, "", "width and height of a video must be even");
}

void writeMovie(const std::string& file, const MovieFormat& format, int frames, const std::function<Image(int)>& picture,
                const ProgressFn& progress) {
  require(frames > 0, "writeMovie: no frames");
  checkMovie(file, format);
  if (endingOf(file) == ".png") return writeSeries(file, format, frames, picture, progress);
  atomicWrite(fs::path(file), [&](const fs::path& temporary) { encode(file, temporary, format, frames, picture, progress); });
}

std::vector<ViewPoint> turntable(const ViewPoint& start, const Eigen::Vector3d& axis, int frames) {
  require(frames > 0 && axis.norm() > 0, "turntable: needs an axis and frames");
  std::vector<ViewPoint> views;
  for (int i = 0; i < frames; ++i) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2 * std::numbers::pi * i / frames, axis.normalized()).toRotationMatrix();
    ViewPoint v = start;
    v.position = start.focalPoint + turn * (start.position - start.focalPoint);
    v.up = turn * start.up;
    views.push_back(v);
  }
  return views;
}

std::vector<ViewPoint> turntable(SceneView& view, int frames) {
  const ViewPoint start = view.viewPoint();
  view.lookAlong(AxisView::Front);
  const Eigen::Vector3d up = view.viewPoint().up;
  view.setViewPoint(start);
  return turntable(start, up, frames);
}

}  // namespace glint::viz
