// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/app/trial_search.h"
#include "core/base/outcome.h"

namespace glint {

/// What an interrupted measurement has found so far, in a file that is written whole after every trial. It belongs to one
/// key (inputs, request, knobs, program): with another key it starts empty. A file that does not parse counts as none.
class WorkFile {
 public:
  /// @param file  empty = keep nothing.
  WorkFile(std::filesystem::path file, std::string key);

  std::optional<Outcome<TrialResult>> coarse(const std::string& id) const;
  std::optional<Outcome<TradeoffPoint>> full(const std::string& id) const;
  /// Both write the file. InputError if it cannot be written.
  void add(const std::string& id, const Outcome<TrialResult>& result);
  void add(const std::string& id, const Outcome<TradeoffPoint>& result);
  int size() const { return static_cast<int>(coarse_.size() + full_.size()); }

 private:
  void write() const;
  std::filesystem::path file_;
  std::string key_;
  std::map<std::string, Outcome<TrialResult>> coarse_;
  std::map<std::string, Outcome<TradeoffPoint>> full_;
};

}  // namespace glint
