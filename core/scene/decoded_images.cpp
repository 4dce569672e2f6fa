// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/decoded_images.h"

#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <opencv2/core/mat.hpp>
#include <utility>

#include "core/scene/scene.h"

namespace glint {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // ns; file systems count time in steps of up to a second

std::int64_t nanoseconds(const timespec& t) { return std::int64_t{t.tv_sec} * kSecond + t.tv_nsec; }

std::size_t sizeOf(const DecodedImage& image) { return image.pixels->total() * image.pixels->elemSize(); }

constexpr std::size_t kMostHeldBytes = 256'000'000;  // 40 colour photographs of 1920 x 1080
std::atomic<int> decoded{0};

}  // namespace

std::optional<FileVersion> versionOf(const std::filesystem::path& file) {
  struct stat info {};
  if (::stat(file.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FileVersion{static_cast<std::uint64_t>(info.st_dev), static_cast<std::uint64_t>(info.st_ino),
                     static_cast<std::uint64_t>(info.st_size), nanoseconds(info.st_ctim)};
}

void DecodedImages::setMostBytes(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  mostBytes_ = bytes;
  makeRoom(0, mostBytes_);
}

bool DecodedImages::keeps(const std::filesystem::path& file) const {
  const std::lock_guard lock(mutex_);
  return mostBytes_ > 0 || isHeld(file.native());
}

void DecodedImages::hold(const std::vector<std::filesystem::path>& files) {
  const std::lock_guard lock(mutex_);
  for (const std::filesystem::path& f : files) ++held_[f.native()];
}

void DecodedImages::release(const std::vector<std::filesystem::path>& files) {
  const std::lock_guard lock(mutex_);
  for (const std::filesystem::path& f : files) {
    if (--held_.at(f.native()) > 0) continue;
    held_.erase(f.native());
    if (const auto at = indexOf_.find(f.native()); at != indexOf_.end() && kept_[at->second].young) remove(at->second);
  }
  makeRoom(0, mostBytes_);
}

std::size_t DecodedImages::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

std::optional<DecodedImage> DecodedImages::find(const std::filesystem::path& file, const FileVersion& now) {
  const std::lock_guard lock(mutex_);
  const auto at = indexOf_.find(file.native());
  if (at == indexOf_.end()) return std::nullopt;
  const Kept& kept = kept_[at->second];
  if (kept.version == now) return kept.image;
  remove(at->second);
  return std::nullopt;
}

void DecodedImages::keep(const std::filesystem::path& file, const FileVersion& read, const DecodedImage& image) {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  const std::size_t size = sizeOf(image);
  const std::lock_guard lock(mutex_);
  const bool held = isHeld(file.native()), young = nanoseconds(now) - read.changedNs < kSecond;
  if (young && !held) return;
  if (const auto at = indexOf_.find(file.native()); at != indexOf_.end()) remove(at->second);
  if (!makeRoom(size, held ? std::max(mostBytes_, mostHeldBytes_) : mostBytes_)) return;
  indexOf_.emplace(file.native(), kept_.size());
  kept_.push_back({file.native(), read, image, young});
  bytes_ += size;
}

/// False where what is held leaves none.
bool DecodedImages::makeRoom(std::size_t bytes, std::size_t most) {
  if (bytes > most) return false;
  while (bytes_ + bytes > most) {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;  // Knuth's constants
    const std::size_t n = kept_.size(), first = static_cast<std::size_t>((random_ >> 33) % n);
    std::size_t passed = 0;
    while (passed < n && isHeld(kept_[(first + passed) % n].file)) ++passed;
    if (passed == n) return false;
    remove((first + passed) % n);
  }
  return true;
}

void DecodedImages::remove(std::size_t index) {
  bytes_ -= sizeOf(kept_[index].image);
  indexOf_.erase(kept_[index].file);
  if (index + 1 < kept_.size()) {
    kept_[index] = std::move(kept_.back());
    indexOf_[kept_[index].file] = index;
  }
  kept_.pop_back();
}

DecodedImages& decodedImages() {
  static DecodedImages images(0, kMostHeldBytes);
  return images;
}

std::filesystem::path pictureName(const std::filesystem::path& video, const VideoPicture& picture) {
  return video.native() + "#" + std::to_string(picture.index);
}

std::filesystem::path alphaName(const std::filesystem::path& photograph) { return photograph.native() + "#alpha"; }

int timesDecoded() { return decoded; }
void countDecoded() { ++decoded; }

void keepDecodedImages(std::size_t mostBytes) { decodedImages().setMostBytes(mostBytes); }

PhotographsHeld::PhotographsHeld(const Scene& scene, const std::vector<int>& frames) {
  for (const int i : frames) {
    const Frame& f = scene.frames.at(static_cast<std::size_t>(i));
    for (const std::filesystem::path& file : {f.image, f.radiance, f.mask})
      if (!file.empty()) files_.push_back(file == f.image && f.ofVideo ? pictureName(file, *f.ofVideo) : file);
    if (!f.image.empty()) files_.push_back(alphaName(f.image));
  }
  decodedImages().hold(files_);
}
PhotographsHeld::~PhotographsHeld() { decodedImages().release(files_); }

}  // namespace glint
