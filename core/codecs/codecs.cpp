// SPDX-License-Identifier: BSD-3-Clause
#include "core/codecs/codecs.h"

#include <dlfcn.h>
#include <link.h>

#include <array>
#include <climits>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string_view>

#include "core/codecs/codec_table.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

/// The folder that a library was loaded from, even if its path was relative and the program has changed its folder since.
fs::path folderOf(const link_map& library) {
  if (library.l_name[0] == '/') return fs::path(library.l_name).parent_path();
  void* const handle = ::dlopen(library.l_name, RTLD_LAZY | RTLD_NOLOAD);
  std::array<char, PATH_MAX> folder{};
  const bool known = handle && ::dlinfo(handle, RTLD_DI_ORIGIN, folder.data()) == 0;
  if (handle) ::dlclose(handle);
  return known ? folder.data() : "";
}

/// Beside the library that this code is part of. A test program that holds the code itself has it in lib, beside its own folder.
/// Nowhere else: a file of that name may be of another version.
fs::path codecLibrary() {
  Dl_info here{};
  link_map* library = nullptr;
  if (::dladdr1(reinterpret_cast<const void*>(&loadCodecs), &here, reinterpret_cast<void**>(&library), RTLD_DL_LINKMAP) != 0 &&
      library && library->l_name && library->l_name[0] != '\0')
    return folderOf(*library) / GLINT_CODECS_FILE;
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  return program.parent_path().parent_path() / "lib" / GLINT_CODECS_FILE;
}

const CodecTable& load() {
  const std::string file = codecLibrary().string();
  const auto refuse = [&](const std::string& reason) {
    throw CodecsMissing(file + ": " + reason + "; without it Glint writes no images or videos, and reads only PNG and JPEG");
  };
  if (file.front() != '/') refuse("is not looked for by a relative path");
  // Never closed: libraries that it brings keep threads and handlers for the end of the program.
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const function = library ? ::dlsym(library, kCodecSymbol) : nullptr;
  if (!function) {
    const char* const words = ::dlerror();
    std::string reason = words ? words : "unknown reason";
    if (reason.starts_with(file + ": ")) reason.erase(0, file.size() + 2);  // the line begins with it
    refuse("cannot be loaded: " + reason);
  }
  const CodecTable& table = *reinterpret_cast<CodecTableFunction>(function)();
  if (std::string_view(table.version) != GLINT_VERSION)
    refuse(std::string("is of Glint ") + table.version + ", not of " GLINT_VERSION);
  return table;
}

const CodecTable& codecs() {
  static const CodecTable& table = load();
  return table;
}

}  // namespace

void loadCodecs() { codecs(); }

cv::Mat decodeOtherFormat(const std::string& bytes, std::string& reason) { return codecs().decode(bytes, reason); }

cv::Mat decodeExrDepth(const std::string& bytes, std::string& reason) { return codecs().decodeDepth(bytes, reason); }

bool encodeWithOpenCv(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
                      const std::vector<int>& parameters) {
  return codecs().encode(ending, pixels, bytes, parameters);
}

std::unique_ptr<VideoDecoder> newVideoDecoder() { return codecs().decoder(); }

std::unique_ptr<VideoEncoder> newVideoEncoder() { return codecs().encoder(); }

}  // namespace glint
