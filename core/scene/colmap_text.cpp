// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "core/scene/colmap_parts.h"
#include "io/text_scan.h"

// cameras.txt, images.txt and points3D.txt. An element of cameras and points is a line, an image two lines.

namespace glint::capture::colmap {
namespace {

bool isCommentOrEmpty(std::string_view line) {
  const std::string_view word = io::takeWord(line);
  return word.empty() || word.front() == '#';
}

std::string_view withoutBlanksAround(std::string_view text) {
  while (!text.empty() && io::isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && io::isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// Without a branch, for lines of hundreds of kilobytes: what is no printable character separates words.
std::size_t wordsIn(std::string_view line) {
  std::size_t words = 0;
  unsigned char before = ' ';
  for (const char c : line) {
    const auto now = static_cast<unsigned char>(c);
    words += (now > ' ') & (before <= ' ');
    before = now;
  }
  return words;
}

/// The next word as a finite number.
double takeNumber(std::string_view& line, const std::string& file, std::size_t number) {
  const std::string_view word = io::takeWord(line);
  const std::optional<double> value = io::numberOf(word);
  if (!value || !std::isfinite(*value)) throw InputError(file, lineNo(number), io::quoted(word) + " is not a number");
  return *value;
}
std::uint32_t takeNumber32(std::string_view& line, const std::string& file, std::size_t number) {
  const std::string_view word = io::takeWord(line);
  const std::optional<std::uint32_t> value = number32(word);
  if (!value) throw InputError(file, lineNo(number), io::quoted(word) + " is not a whole number of 0 .. 4294967295");
  return *value;
}

/// The first line of an image.
ModelImage imageOf(std::string_view line, std::size_t number, const std::string& file, std::vector<std::string>& warnings) {
  constexpr std::size_t kWords = 10;
  ModelImage image;
  image.place = lineNo(number);
  if (const std::size_t words = wordsIn(line); words < kWords)
    throw InputError(file, image.place,
                     "should begin an image (IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME), but has " +
                         counted(words, "entry", "entries"));
  image.id = takeNumber32(line, file, number);
  std::array<double, 7> pose{};
  for (double& v : pose) {
    std::string_view ahead = line;
    const std::optional<double> value = io::numberOf(io::takeWord(ahead));
    const bool finite = !value || std::isfinite(*value);
    v = finite ? takeNumber(line, file, number) : *value;
    if (!finite) line = ahead;
  }
  image.lost = anyNotFinite(pose);
  if (!image.lost) image.camFromWorld = poseOf(pose, file, image.place, warnings);
  image.camera = takeNumber32(line, file, number);
  image.name = checkedName(withoutBlanksAround(line), file, image.place);  // the rest, for a name may contain blanks
  return image;
}

/// Calls `each` with x, y of every 2D point of a line.
template <class Each>
void readPixels(std::string_view line, std::size_t pixels, const std::string& file, const std::string& place, const Each& each) {
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::optional<double> x = io::numberOf(io::takeWord(line)), y = io::numberOf(io::takeWord(line));
    const std::optional<std::int64_t> point = io::integerOf(io::takeWord(line));  // -1: none
    if (!x || !y || !point) throw InputError(file, place, "its 2D point " + std::to_string(i) + " is not X, Y, POINT3D_ID");
    each(*x, *y);
  }
}

/// The second line of an image: how many 2D points it has. A file that lacks these lines would lose every second image, so a line
/// that could be the first one of an image is read; long ones are counted.
void countPixels(std::string_view line, std::size_t number, const std::string& file, ModelImage& image) {
  const std::size_t words = wordsIn(line);
  constexpr std::size_t kFirstLine = 8192;  // bytes; ten entries, one of them a path, are shorter
  if (words % 3 != 0)
    throw InputError(file, lineNo(number),
                     "should hold the 2D points (X, Y, POINT3D_ID) of image " + io::quoted(image.name) + ", but has " +
                         counted(words, "entry", "entries") + " (a line for them must be there even if it is empty)");
  image.pixels = words / 3;
  if (line.size() < kFirstLine) readPixels(line, image.pixels, file, lineNo(number), [](double, double) {});
}

/// Whether a line could be the first one of an image.
bool beginsImage(std::string_view line) {
  std::vector<std::string> ignored;
  return BadLines().passes([&] { imageOf(line, 0, "", ignored); });
}

ModelCamera cameraOfLine(std::string_view line, std::size_t number, const std::string& file) {
  const std::size_t words = wordsIn(line);
  constexpr std::size_t kBefore = 4;  // CAMERA_ID, MODEL, WIDTH, HEIGHT
  if (words < kBefore) throw InputError(file, lineNo(number), "is not CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS");
  const std::uint32_t id = takeNumber32(line, file, number);
  const CameraModel& model = cameraModelOf(io::takeWord(line), file, lineNo(number));
  const std::uint32_t width = takeNumber32(line, file, number), height = takeNumber32(line, file, number);
  std::vector<double> parameters(std::size_t(model.parameters()));
  if (words - kBefore != parameters.size())
    throw InputError(file, lineNo(number),
                     std::string(model.name) + " has " + counted(parameters.size(), "parameter") + ", the line has " +
                         std::to_string(words - kBefore));
  for (double& p : parameters) p = takeNumber(line, file, number);
  return cameraOf(id, model, width, height, parameters, file, lineNo(number));
}

}  // namespace

std::vector<ModelCamera> readCamerasText(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings) {
  std::vector<ModelCamera> cameras;
  BadLines bad;
  io::Lines lines(bytes);
  while (const auto line = lines.next())
    if (!isCommentOrEmpty(*line)) bad.passes([&] { cameras.push_back(cameraOfLine(*line, lines.number(), file)); });
  if (cameras.empty()) bad.refuse();
  bad.tell(warnings);
  return cameras;
}

std::vector<ModelImage> readImagesText(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings) {
  std::vector<ModelImage> images;
  BadLines bad, withoutPixels;
  io::Lines lines(bytes);
  while (const auto first = lines.next()) {
    if (isCommentOrEmpty(*first)) continue;
    ModelImage image;
    const bool isImage = bad.passes([&] { image = imageOf(*first, lines.number(), file, warnings); });
    image.from = lines.at();
    const io::Lines here = lines;
    const auto second = lines.next();  // the last line may lack where it is empty
    if (second) image.size = second->size();
    if (!isImage) {
      if (second && beginsImage(*second)) lines = here;  // the bad line was not one of two
      continue;
    }
    try {
      if (second) countPixels(*second, lines.number(), file, image);
    } catch (const InputError& e) {
      if (beginsImage(*second)) throw;  // the file lacks these lines: every second image would be lost
      withoutPixels.add(e);
      image.pixels = 0;
    }
    images.push_back(std::move(image));
  }
  if (images.empty()) bad.refuse();
  bad.tell(warnings);
  withoutPixels.tell(warnings);
  return images;
}

std::vector<Pixel> pixelsOfText(std::string_view bytes, const ModelImage& image, const std::string& file) {
  std::vector<Pixel> pixels;
  pixels.reserve(image.pixels);
  const auto place = [&] { return "image " + io::quoted(image.name); };
  readPixels(bytes.substr(image.from, image.size), image.pixels, file, place(),
             [&](double x, double y) { pixels.push_back(pixelAt(x, y, file, place)); });
  return pixels;
}

namespace {
Eigen::Vector3d pointOfLine(std::string_view line, std::size_t number, const std::string& file, std::vector<TrackEntry>& track) {
  constexpr std::size_t kBeforeTrack = 8;  // POINT3D_ID, X, Y, Z, R, G, B, ERROR
  const std::size_t words = wordsIn(line);
  if (words < kBeforeTrack || words % 2 != 0)
    throw InputError(file, lineNo(number),
                     "is not POINT3D_ID, X, Y, Z, R, G, B, ERROR and a track of IMAGE_ID, POINT2D_IDX: it has " +
                         counted(words, "entry", "entries"));
  io::takeWord(line);
  const double x = takeNumber(line, file, number), y = takeNumber(line, file, number), z = takeNumber(line, file, number);
  const Eigen::Vector3d point = pointAt(x, y, z, file, [&] { return lineNo(number); });
  for (int i = 0; i < 4; ++i) io::takeWord(line);  // colour and error
  track.resize((words - kBeforeTrack) / 2);
  for (TrackEntry& entry : track) {
    entry.image = takeNumber32(line, file, number);
    entry.pixel = takeNumber32(line, file, number);
  }
  return point;
}
}  // namespace

void readPointsText(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings, const EachPoint& each) {
  BadLines bad;
  io::Lines lines(bytes);
  std::vector<TrackEntry> track;
  while (const auto line = lines.next()) {
    if (isCommentOrEmpty(*line)) continue;
    Eigen::Vector3d point;
    if (bad.passes([&] { point = pointOfLine(*line, lines.number(), file, track); })) each(point, track);
  }
  bad.tell(warnings);
}

}  // namespace glint::capture::colmap
