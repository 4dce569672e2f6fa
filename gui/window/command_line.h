// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QSize>
#include <QString>
#include <QStringList>
#include <optional>

#include "core/scene/input_choices.h"
#include "gui/base/theme.h"

namespace glint::gui {

/// The command line of `glint-inspector --help`, checked.
struct CommandLine {
  QString input;         ///< "" = empty state
  InputChoices choices;  ///< how it is read, where it is a capture of another program
  QString layout = QStringLiteral("debug");
  std::optional<Theme> theme;  ///< nothing: the one of last time
  /// Outlines of mirror balls, as `glint lights --ball` takes them: INPUT is a folder of photographs of these.
  QStringList balls;
  QString exclude;      ///< photographs of balls that are left out
  QString frame;        ///< frame id, or number where no id matches; "" = first
  QStringList run;      ///< ids of actions to run once the scene is shown
  QString screenshot;   ///< PNG to write; "" = stay open
  QSize size;           ///< empty = default
  QStringList limits;   ///< "NAME=VALUE", for setLimit()
  QStringList plugins;  ///< files to load
  bool waitIdle = false;
  bool help = false, version = false;
};

/// InputError (place "--flag") for anything that is not understood.
CommandLine parseCommandLine(const QStringList& arguments);
QString helpText();

}  // namespace glint::gui
