// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/scene: what the readers of NVM and Bundler share, whose texts hold a row per camera and per point.

#include <algorithm>
#include <map>

#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/scene/capture_parts.h"
#include "io/text_scan.h"

namespace glint::capture {

/// Rows one at a time: such a text has millions of words, and all of them at once take ten times its memory.
class RowReader {
 public:
  RowReader(std::string_view text, std::string file) : lines_(text), size_(text.size()), file_(std::move(file)) {}
  /// Nothing at the end of the text.
  std::optional<Row> next() {
    while (auto line = lines_.next()) {
      Row row{lines_.number(), {}};
      for (std::string_view word = io::takeWord(*line); !word.empty(); word = io::takeWord(*line)) row.words.push_back(word);
      if (!row.words.empty() && row.words.front().front() != '#') return row;
    }
    return std::nullopt;
  }
  /// InputError at the end of the text: "ends before point 3 of 7".
  Row need(const std::string& what) {
    if (std::optional<Row> row = next()) return std::move(*row);
    throw InputError(file_, "line " + std::to_string(lines_.number()), "the file ends before " + what);
  }
  std::size_t bytesLeft() const { return size_ - lines_.at(); }  ///< behind the row that was read last

 private:
  io::Lines lines_;
  std::size_t size_;
  std::string file_;
};

/// A count that a file states, checked before memory is reserved for it: what it counts takes at least `bytesEach` of the rest.
inline std::size_t possibleCount(long long count, std::size_t bytesEach, std::size_t bytesLeft, const std::string& what,
                                 const std::string& file, const std::string& place) {
  if (count < 0) throw InputError(file, place, "the number of " + what + " must not be negative");
  const auto n = static_cast<std::size_t>(count);
  // The last of them may end without a line break.
  if (n > (bytesLeft + 1) / bytesEach)
    throw InputError(file, place, std::to_string(n) + " " + what + " do not fit into the rest of the file");
  return n;
}

/// The first line without its line break, as far as it matters for what the file is; "" if it cannot be read.
inline std::string firstLineOf(const std::filesystem::path& file) {
  constexpr std::size_t kMost = 256;  // bytes; the headers that are looked for are shorter
  const std::string start = firstBytes(file, kMost);
  const std::string_view text = io::withoutMark(start);
  return std::string(text.substr(0, text.find_first_of("\r\n")));
}

/// The first of them as they are, the others as a count: a file of thousands of cameras is damaged in one way thousands of times.
inline void addFew(std::vector<std::string>& warnings, const std::vector<std::string>& found) {
  constexpr std::size_t kMost = 8;  // lines that a person still reads
  const std::size_t shown = std::min(found.size(), kMost);
  warnings.insert(warnings.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(shown));
  if (found.size() > shown) warnings.push_back("... and " + std::to_string(found.size() - shown) + " more like this");
}

/// "1 photograph", "7 photographs"
inline std::string counted(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// "'a.jpg', 'b.jpg', ... (12 in all)"
inline std::string someOf(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;  // names that a person still reads
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) text += (i ? ", " : "") + io::quoted(names[i]);
  return names.size() > kMost ? text + ", ... (" + std::to_string(names.size()) + " in all)" : text;
}

/// Index of the view of this name in Capture::views.
inline std::map<std::string, int> viewsByName(const Capture& capture) {
  std::map<std::string, int> indices;
  for (std::size_t i = 0; i < capture.views.size(); ++i) indices[capture.views[i].name] = static_cast<int>(i);
  return indices;
}

/// The middle of an image in our pixels, where (0, 0) is the centre of the first: the principal point where a file names none.
inline Pixel middleOf(int width, int height) { return {(width - 1) / 2.0, (height - 1) / 2.0}; }

/// A coordinate of a point or of a camera, three words from this one on.
inline Eigen::Vector3d placeAt(const Row& row, std::size_t word, const std::string& file) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i)
    v[i] = bounded(numberAt(row, word + static_cast<std::size_t>(i), file), kFarthest, file, row.place());
  return v;
}

}  // namespace glint::capture
