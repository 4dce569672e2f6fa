// SPDX-License-Identifier: BSD-3-Clause
#include "io/cloud_reader.h"

#include "core/base/atomic_file.h"
#include "io/mesh_builder.h"
#include "io/text_scan.h"

namespace glint {
namespace {

bool isPly(std::string_view bytes) {
  bytes = io::withoutMark(bytes);
  return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

/// The first line that is no comment is VERSION or FIELDS (the version may be missing in old files).
bool isPcd(std::string_view bytes) {
  for (io::Lines lines(bytes); auto line = lines.next();) {
    const std::string_view word = io::takeWord(*line);
    if (word.empty() || word.front() == '#') continue;
    return word == "VERSION" || word == "FIELDS";
  }
  return false;
}

}  // namespace

bool looksLikeCloud(std::string_view start) {
  if (!isPly(start)) return isPcd(start.substr(0, kCloudHeader));
  const std::size_t end = start.substr(0, kCloudHeader).find("end_header");
  return end != std::string_view::npos && start.substr(0, end).find("element face") == std::string_view::npos &&
         start.substr(0, end).find("element tristrips") == std::string_view::npos;
}

CloudContent readCloudContent(const std::filesystem::path& file) {
  return parseCloud(readFile(file, Limit::MeshMegabytes), file);
}

CloudContent parseCloud(std::string_view bytes, const std::filesystem::path& file) {
  if (bytes.empty()) io::fail(file.string(), "", "the file is empty (0 bytes)");
  if (isPly(bytes)) return parsePlyCloud(io::withoutMark(bytes), file.string());
  if (isPcd(bytes)) return parsePcd(bytes, file.string());
  io::fail(file.string(), "", "is no cloud of points; supported: PLY without faces, PCD");
}

}  // namespace glint
