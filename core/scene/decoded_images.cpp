// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/decoded_images.h"

#include <sys/stat.h>

#include <ctime>
#include <opencv2/core/mat.hpp>
#include <utility>

#include "core/scene/scene.h"

namespace glint {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // ns; file systems count time in steps of up to a second

std::int64_t nanoseconds(const timespec& t) { return std::int64_t{t.tv_sec} * kSecond + t.tv_nsec; }

std::size_t sizeOf(const DecodedImage& image) { return image.pixels->total() * image.pixels->elemSize(); }

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
  makeRoom(0);
}

bool DecodedImages::keepsAny() const {
  const std::lock_guard lock(mutex_);
  return mostBytes_ > 0;
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
  if (size > mostBytes_ || nanoseconds(now) - read.changedNs < kSecond) return;
  if (const auto at = indexOf_.find(file.native()); at != indexOf_.end()) remove(at->second);
  makeRoom(size);
  indexOf_.emplace(file.native(), kept_.size());
  kept_.push_back({file.native(), read, image});
  bytes_ += size;
}

void DecodedImages::makeRoom(std::size_t bytes) {
  while (bytes_ + bytes > mostBytes_ && !kept_.empty()) {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;  // Knuth's constants
    remove(static_cast<std::size_t>((random_ >> 33) % kept_.size()));
  }
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
  static DecodedImages images(0);
  return images;
}

void keepDecodedImages(std::size_t mostBytes) { decodedImages().setMostBytes(mostBytes); }

}  // namespace glint
