// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "core/base/outcome.h"

namespace glint {

/// Nothing in a folder is recognised, but a folder inside it is: a person who is one level too high can be led there.
class FolderBelow : public InputError {
 public:
  /// @param folder  inside `input`. @param what  "COLMAP model"
  FolderBelow(const std::string& input, const std::string& reason, std::filesystem::path folder, std::string what)
      : InputError(input, "", reason), folder_(std::move(folder)), what_(std::move(what)) {}
  const std::filesystem::path& folder() const { return folder_; }
  const std::string& holds() const { return what_; }

 private:
  std::filesystem::path folder_;
  std::string what_;
};

}  // namespace glint
