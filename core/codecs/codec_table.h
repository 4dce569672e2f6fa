// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/version.h"
#include "core/codecs/codecs.h"

namespace glint {

/// What libglint-codecs does, one entry for each function of codecs.h. Internal to core/codecs.
struct CodecTable {
  const char* version;  ///< GLINT_VERSION of that library: first in every version, so that another one can be told
  cv::Mat (*decode)(const std::string& bytes, std::string& reason);
  cv::Mat (*decodeDepth)(const std::string& bytes, std::string& reason);
  bool (*encode)(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
                 const std::vector<int>& parameters);
  std::unique_ptr<VideoDecoder> (*decoder)();
  std::unique_ptr<VideoEncoder> (*encoder)();
};

/// The one symbol that libglint-codecs shows.
inline constexpr char kCodecSymbol[] = "glint_codecs";
using CodecTableFunction = const CodecTable* (*)();

}  // namespace glint
