// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace glint {

using SettingValue = std::variant<bool, int, double, std::string>;
/// As people read it, without its unit: "0.5", "refined", "on".
std::string settingText(const SettingValue& value);

/// Describes one setting: enough to build a panel row, a `--set` parser and a table of settings from it.
struct ParamSpec {
  std::string key{};     ///< dotted name, "predict.directions"
  std::string title{};   ///< "Directions"
  std::string symbol{};  ///< symbol in method.md, "n"; may be empty
  std::string unit{};    ///< "px", "deg", "" for none
  SettingValue defaultValue{};
  double min = 0, max = 0, step = 0;   ///< numeric settings only; closed range
  std::vector<std::string> choices{};  ///< string settings only; the legal values
  std::string help{};                  ///< one or two sentences, with the equation where there is one
  std::string stage{};  ///< first pipeline stage that depends on it: "detect", "surface", "light", "fit", "predict", "evaluate"
};

/// Every setting of the program, in the order of the pipeline. The one place that defines them.
const std::vector<ParamSpec>& allParams();

/// Values that differ from the defaults, by dotted name. Invariant: every key exists and every value
/// has the type of its default and lies in its range.
class Settings {
 public:
  /// Typed look-up: the value set, else the default. std::invalid_argument for a key or type that does not exist.
  bool flag(const std::string& key) const;
  int integer(const std::string& key) const;
  double number(const std::string& key) const;  ///< also converts an integer setting
  const std::string& text(const std::string& key) const;
  const SettingValue& value(const std::string& key) const;

  /// InputError (place "--set KEY") if the key is unknown, the text does not parse, or the range is left.
  void setFromText(const std::string& key, const std::string& valueText);
  /// The same checks on a typed value.
  void set(const std::string& key, const SettingValue& value);
  void reset(const std::string& key) { values_.erase(key); }
  const std::map<std::string, SettingValue>& values() const { return values_; }
  bool operator==(const Settings& other) const { return values_ == other.values_; }

 private:
  std::map<std::string, SettingValue> values_;
};

/// The description of one key; InputError if it is unknown.
const ParamSpec& paramSpec(const std::string& key);

/// One more legal value of a setting that names one of several. Not thread-safe: before anything reads
/// settings. std::invalid_argument for a setting that does not exist or has no list of values.
void addChoice(const std::string& key, const std::string& choice);

/// `others` with the settings `surface.depth_...` after those of other surfaces, for `allParams`.
std::vector<ParamSpec> withDepthParams(std::vector<ParamSpec> others);

/// `others` with the settings `predict.filter_...` after those of other predictions, for `allParams`.
std::vector<ParamSpec> withFilterParams(std::vector<ParamSpec> others);

}  // namespace glint
