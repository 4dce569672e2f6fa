// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/codecs/codecs.h"

namespace glint {

/// What libglint-codecs does, one entry for each function of codecs.h. Internal to core/codecs.
struct CodecTable {
  cv::Mat (*decode)(const std::string& bytes);
  bool (*encode)(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
                 const std::vector<int>& parameters);
  std::unique_ptr<VideoReader> (*reader)();
  std::unique_ptr<VideoWriter> (*writer)();
};

/// The one symbol that libglint-codecs shows.
inline constexpr char kCodecSymbol[] = "glint_codecs";
using CodecTableFunction = const CodecTable* (*)();

}  // namespace glint
