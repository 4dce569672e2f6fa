// SPDX-License-Identifier: BSD-3-Clause
#include "core/codecs/codecs.h"

#include <dlfcn.h>

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "core/base/outcome.h"
#include "core/codecs/codec_table.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

/// Beside the library, or the program, that this code is part of; a program in bin finds it in lib, beside bin. Nowhere else: a file of
/// that name elsewhere may be of another version.
fs::path codecLibrary() {
  std::error_code ignored;  // what cannot be asked about does not exist
  Dl_info here{};
  if (::dladdr(reinterpret_cast<const void*>(&loadCodecs), &here) != 0 && here.dli_fname) {
    const fs::path beside = fs::absolute(here.dli_fname).parent_path() / GLINT_CODECS_FILE;
    if (fs::exists(beside, ignored)) return beside;
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  return program.parent_path().parent_path() / "lib" / GLINT_CODECS_FILE;
}

const CodecTable& load() {
  const fs::path file = codecLibrary();
  // Never closed: libraries that it brings keep threads and handlers for the end of the program.
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const function = library ? ::dlsym(library, kCodecSymbol) : nullptr;
  if (!function) {
    const char* const words = ::dlerror();
    throw InputError(file.string(), "",
                     std::string("cannot be loaded, and without it Glint writes no images and reads only PNG and JPEG: ") +
                         (words ? words : "unknown reason"));
  }
  return *reinterpret_cast<CodecTableFunction>(function)();
}

const CodecTable& codecs() {
  static const CodecTable& table = load();
  return table;
}

}  // namespace

void loadCodecs() { codecs(); }

cv::Mat decodeWithOpenCv(const std::string& bytes) { return codecs().decode(bytes); }

bool encodeWithOpenCv(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
                      const std::vector<int>& parameters) {
  return codecs().encode(ending, pixels, bytes, parameters);
}

std::unique_ptr<VideoReader> newVideoReader() { return codecs().reader(); }

std::unique_ptr<VideoWriter> newVideoWriter() { return codecs().writer(); }

}  // namespace glint
