// SPDX-License-Identifier: BSD-3-Clause
#include "plugins/python/src/options.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <string>

namespace glint::python {
namespace {

/// "predict_directions" -> "predict.directions". What is no setting at all is left to the message that says so.
std::string dotted(std::string name) {
  if (name.find('.') != std::string::npos) return name;
  if (const std::size_t underscore = name.find('_'); underscore != std::string::npos) name[underscore] = '.';
  return name;
}

/// As `--set` would be given it: so that every message is the command line's.
std::string settingText(py::handle value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  std::string text = py::str(value).cast<std::string>();
  if (text == "True") return "true";
  if (text == "False") return "false";
  return text;
}

py::object objectOf(const SettingValue& value) {
  return std::visit([](const auto& v) -> py::object { return py::cast(v); }, value);
}

}  // namespace

void applySettings(py::handle dictionary, Settings& settings) {
  if (!dictionary || dictionary.is_none()) return;
  if (!py::isinstance<py::dict>(dictionary)) throw py::type_error("settings: expected a dictionary");
  for (const auto& [name, value] : py::reinterpret_borrow<py::dict>(dictionary)) {
    if (!py::isinstance<py::str>(name)) throw py::type_error("settings: names are texts, such as \"predict.directions\"");
    settings.setFromText(dotted(name.cast<std::string>()), settingText(value));
  }
}

Settings settingsFrom(py::handle dictionary) {
  Settings settings;
  applySettings(dictionary, settings);
  return settings;
}

py::dict dictOf(const Settings& settings) {
  py::dict out;
  for (const ParamSpec& spec : allParams()) out[py::str(spec.key)] = objectOf(settings.value(spec.key));
  return out;
}

void declareSettings(py::module_& module) {
  py::class_<ParamSpec>(module, "Setting", "One setting of the program: its name, meaning, unit, range and default.")
      .def_readonly("key", &ParamSpec::key, "Dotted name, as `--set` takes it: \"predict.directions\".")
      .def_property_readonly(
          "keyword",
          [](const ParamSpec& p) {
            std::string name = p.key;
            std::replace(name.begin(), name.end(), '.', '_');
            return name;
          },
          "The name as a keyword argument: \"predict_directions\".")
      .def_readonly("title", &ParamSpec::title, "A few words.")
      .def_readonly("unit", &ParamSpec::unit, "\"px\", \"deg\"; empty for none.")
      .def_property_readonly(
          "default", [](const ParamSpec& p) { return objectOf(p.defaultValue); }, "bool, int, float or str.")
      .def_readonly("min", &ParamSpec::min, "Least value of a number.")
      .def_readonly("max", &ParamSpec::max, "Largest value of a number.")
      .def_readonly("choices", &ParamSpec::choices, "The values of a text; empty for others.")
      .def_readonly("help", &ParamSpec::help, "One or two sentences, with the equation where there is one.")
      .def_readonly("stage", &ParamSpec::stage,
                    "First stage that depends on it: \"detect\", \"surface\", \"light\", \"fit\", "
                    "\"predict\" or \"evaluate\".")
      .def("__repr__", [](const ParamSpec& p) { return "<glint.Setting " + p.key + ">"; });
  module.def(
      "settings", [] { return allParams(); }, "Every setting, in the order of the pipeline: what `glint settings` lists.");
}

}  // namespace glint::python
