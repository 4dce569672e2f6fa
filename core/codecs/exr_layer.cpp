// SPDX-License-Identifier: BSD-3-Clause
// Part of libglint-codecs: EXR files whose channels belong to layers.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <vector>

#include "core/codecs/codec_table.h"

namespace glint {
namespace {

class ExrBytes : public Imf::IStream {
 public:
  explicit ExrBytes(const std::string& bytes) : Imf::IStream(""), bytes_(bytes) {}
  bool read(char to[], int count) override {
    if (count < 0 || at_ > bytes_.size() || bytes_.size() - at_ < static_cast<std::size_t>(count))
      throw std::runtime_error("the EXR is truncated");
    std::memcpy(to, bytes_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t to) override { at_ = to; }

 private:
  const std::string& bytes_;
  std::uint64_t at_ = 0;
};

bool endsOnChannel(const std::string& name, const char* channel) {
  const std::size_t dot = name.rfind('.');
  return dot != std::string::npos ? name.substr(dot + 1) == channel : name == channel;
}

/// Names of the channels to read, blue first; empty = none, or several.
std::vector<std::string> chosenChannels(const std::vector<std::string>& names) {
  const auto has = [&](const std::string& name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  std::vector<std::string> layers, combined;
  for (const std::string& name : names) {
    if (!endsOnChannel(name, "R")) continue;
    const std::string layer = name.substr(0, name.size() - 1);
    if (!has(layer + "G") || !has(layer + "B")) continue;
    layers.push_back(layer);
    if (layer == "Combined." || layer.ends_with(".Combined.")) combined.push_back(layer);
  }
  if (layers.size() > 1) layers = combined;
  if (layers.size() == 1) return {layers[0] + "B", layers[0] + "G", layers[0] + "R"};
  if (!layers.empty()) return {};
  std::vector<std::string> single;
  for (const std::string& name : names)
    for (const char* last : {"Z", "V", "Y"})
      if (endsOnChannel(name, last)) single.push_back(name);
  return single.size() == 1 ? single : std::vector<std::string>();
}

/// The channel of depth; empty = none, or several.
std::string depthChannel(const std::vector<std::string>& names) {
  std::vector<std::string> found, ofDepth;
  for (const char* last : {"Z", "V"}) {
    for (const std::string& name : names) {
      if (name == last) return name;
      if (!endsOnChannel(name, last)) continue;
      found.push_back(name);
      const std::string layer = name.substr(0, name.size() - 2);
      if (layer == "Depth" || layer.ends_with(".Depth")) ofDepth.push_back(name);
    }
  }
  if (found.size() > 1) found = ofDepth;
  return found.size() == 1 ? found.front() : "";
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 12, kLongest = 60;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    if (i > 0) text += ", ";
    for (const char c : names[i].substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  }
  return names.size() > kMost ? text + " and " + std::to_string(names.size() - kMost) + " more" : text;
}

std::vector<std::string> namesOf(const Imf::InputFile& file) {
  std::vector<std::string> names;
  const Imf::ChannelList& channels = file.header().channels();
  for (auto c = channels.begin(); c != channels.end(); ++c) names.emplace_back(c.name());
  return names;
}

/// Whether each pixel has a value of its own.
bool isWhole(const Imf::InputFile& file, const std::string& name) {
  const Imf::Channel* c = file.header().channels().findChannel(name.c_str());
  return c && c->xSampling == 1 && c->ySampling == 1;
}

cv::Mat pixelsOf(Imf::InputFile& file, const std::vector<std::string>& chosen) {
  const Imath::Box2i window = file.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  cv::Mat pixels(height, width, CV_MAKETYPE(CV_32F, int(chosen.size())), cv::Scalar::all(0));
  Imf::FrameBuffer frame;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    frame.insert(chosen[i],
                 Imf::Slice::Make(Imf::FLOAT, pixels.data + i * sizeof(float), window, pixels.elemSize(), pixels.step));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return pixels;
}

}  // namespace

std::optional<cv::Mat> decodeExrLayer(const std::string& bytes, std::string& reason) {
  if (!bytes.starts_with("\x76\x2f\x31\x01")) return std::nullopt;
  ExrBytes stream(bytes);
  Imf::InputFile file(stream, 0);
  const std::vector<std::string> names = namesOf(file);
  for (const char* plain : {"R", "G", "B", "Y"})
    if (std::find(names.begin(), names.end(), plain) != names.end()) return std::nullopt;
  const bool whole = std::all_of(names.begin(), names.end(), [&](const std::string& n) { return isWhole(file, n); });
  const std::vector<std::string> chosen = whole ? chosenChannels(names) : std::vector<std::string>();
  if (chosen.empty()) {
    reason = "the EXR has the channels " + listed(names) +
             "; needed are R, G and B, alone or in one layer (or in one named Combined), or one channel of depth Z or V";
    return cv::Mat();
  }
  return pixelsOf(file, chosen);
}

cv::Mat depthOfExr(const std::string& bytes, std::string& reason) {
  ExrBytes stream(bytes);
  Imf::InputFile file(stream, 0);
  const std::vector<std::string> names = namesOf(file);
  const std::string channel = depthChannel(names);
  if (!channel.empty() && isWhole(file, channel)) return pixelsOf(file, {channel});
  reason = "the EXR has the channels " + listed(names) +
           "; needed is one of depth, Z or V, alone or in one layer (or in one named Depth)";
  return cv::Mat();
}

}  // namespace glint
