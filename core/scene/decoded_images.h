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

/// Decoded images by file. Where there is no room, a random one is dropped. Passes over more frames than there is room for then
/// find some of them again; the rule "the one unused for longest" would find none. Thread-safe.
class DecodedImages {
 public:
  explicit DecodedImages(std::size_t mostBytes) : mostBytes_(mostBytes) {}
  void setMostBytes(std::size_t bytes);
  bool keepsAny() const;
  std::optional<DecodedImage> find(const std::filesystem::path& file, const FileVersion& now);
  /// @param read  the file's version from before it was read. One that changed within the last second is not kept: a change
  ///              after it might bear the same time
  void keep(const std::filesystem::path& file, const FileVersion& read, const DecodedImage& image);
  std::size_t bytes() const;

 private:
  struct Kept {
    std::string file;
    FileVersion version;
    DecodedImage image;
  };
  void remove(std::size_t index);
  void makeRoom(std::size_t bytes);

  mutable std::mutex mutex_;
  std::size_t mostBytes_, bytes_ = 0;
  std::vector<Kept> kept_;
  std::unordered_map<std::string, std::size_t> indexOf_;
  std::uint64_t random_ = 1;
};

/// The images of this process; none is kept before keepDecodedImages().
DecodedImages& decodedImages();

}  // namespace glint
