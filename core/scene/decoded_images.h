// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/scene: what keepDecodedImages() of scene.h keeps.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace cv {
class Mat;
}

namespace glint {

struct VideoPicture;

/// An image as its file has it.
struct DecodedImage {
  std::shared_ptr<const cv::Mat> pixels;  ///< 1 or 3 channels, RGB order, the file's own depth
  bool saysLinear = false;                ///< the file says that its codes are linear
  int orientation = 1;                    ///< of EXIF, by which the pixels were turned
  bool hasOthers = false;                 ///< an EXR with more channels than one
};

/// Which content a file has, as far as the system tells without reading it.
struct FileVersion {
  std::uint64_t device = 0, inode = 0, bytes = 0;
  std::int64_t changedNs = 0;  ///< when content or name last changed, by the system's clock; no program can set it
  friend bool operator==(const FileVersion&, const FileVersion&) = default;
};
std::optional<FileVersion> versionOf(const std::filesystem::path& file);  ///< nothing where it cannot be looked at

/// Decoded images by file. Where there is no room, a random one goes: passes over more frames than there is room for find some
/// of them again, where the rule "the one that was not used for longest" would find none. Files that somebody holds stay, and
/// take no one else's room: all that is kept is within the larger of the two bounds. Thread-safe.
class DecodedImages {
 public:
  explicit DecodedImages(std::size_t mostBytes, std::size_t mostHeldBytes = 0)
      : mostBytes_(mostBytes), mostHeldBytes_(mostHeldBytes) {}
  void setMostBytes(std::size_t bytes);
  /// An image of this file would be kept, were there room.
  bool keeps(const std::filesystem::path& file) const;
  std::optional<DecodedImage> find(const std::filesystem::path& file, const FileVersion& now);
  /// @param read  the file's version from before it was read. One that changed within the last second is not kept: a change
  ///              after it might bear the same time
  void keep(const std::filesystem::path& file, const FileVersion& read, const DecodedImage& image);
  /// From now on images of these files are kept first, even such that changed within the last second: until as many release().
  void hold(const std::vector<std::filesystem::path>& files);
  void release(const std::vector<std::filesystem::path>& files);
  std::size_t bytes() const;

 private:
  struct Kept {
    std::string file;
    FileVersion version;
    DecodedImage image;
    bool young = false;  ///< changed within the second before it was read
  };
  void remove(std::size_t index);
  bool makeRoom(std::size_t bytes, std::size_t most);
  bool isHeld(const std::string& file) const { return held_.count(file) > 0; }

  mutable std::mutex mutex_;
  std::size_t mostBytes_, mostHeldBytes_, bytes_ = 0;
  std::vector<Kept> kept_;
  std::unordered_map<std::string, std::size_t> indexOf_;
  std::unordered_map<std::string, int> held_;  ///< how often
  std::uint64_t random_ = 1;
};

/// The images of this process; none is kept before keepDecodedImages().
DecodedImages& decodedImages();

/// By which a picture of a video, and the alpha of a photograph, are kept.
std::filesystem::path pictureName(const std::filesystem::path& video, const VideoPicture& picture);
std::filesystem::path alphaName(const std::filesystem::path& photograph);

/// How often this process has decoded a file of pixels, or its alpha, so far: what is kept is not decoded again. Tests read it.
int timesDecoded();
void countDecoded();

}  // namespace glint
