// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/command_line.h"

#include <QRegularExpression>

#include "core/base/limits.h"
#include "core/base/outcome.h"
#include "core/base/words.h"
#include "gui/window/layouts.h"

namespace glint::gui {

namespace {
QSize parseSize(const QString& text) {
  const QRegularExpressionMatch m = QRegularExpression(QStringLiteral("^(\\d{1,5})[xX](\\d{1,5})$")).match(text);
  const QSize size(m.captured(1).toInt(), m.captured(2).toInt());
  if (!m.hasMatch() || size.width() < 320 || size.height() < 240 || size.width() > 16384 || size.height() > 16384)
    throw InputError("", "--size", "'" + text.toStdString() + "' is not WIDTHxHEIGHT between 320x240 and 16384x16384");
  return size;
}
Theme themeOf(const QString& name) {
  if (name != QStringLiteral("light") && name != QStringLiteral("dark"))
    throw InputError("", "--theme", "'" + name.toStdString() + "' is not one of: light, dark");
  return name == QStringLiteral("dark") ? Theme::Dark : Theme::Light;
}
/// Null for an unknown name.
const ChoiceOption* choiceOption(const QString& name) {
  for (const ChoiceOption& option : choiceOptions())
    if (name == QLatin1String(option.flag)) return &option;
  return nullptr;
}

/// All options: what one that is not known was meant to be.
std::vector<std::string> optionNames() {
  std::vector<std::string> names{"--help", "--version", "--layout", "--theme",  "--frame",     "--ball",      "--exclude",
                                 "--run",  "--size",    "--limit",  "--plugin", "--wait-idle", "--screenshot"};
  for (const ChoiceOption& option : choiceOptions()) names.emplace_back(option.flag);
  return names;
}

/// The options for captures, two lines each.
QString choicesHelp() {
  QString text;
  for (const ChoiceOption& option : choiceOptions())
    text += QStringLiteral("  %1 %2\n                        %3\n")
                .arg(QLatin1String(option.flag), QLatin1String(option.value), QLatin1String(option.help));
  return text;
}
}  // namespace

CommandLine parseCommandLine(const QStringList& arguments) {
  CommandLine c;
  for (int i = 0; i < arguments.size(); ++i) {
    QString name = arguments[i], inlineValue;
    const int equals = name.startsWith(QStringLiteral("--")) ? int(name.indexOf('=')) : -1;
    if (equals > 0) {
      inlineValue = name.mid(equals + 1);
      name.truncate(equals);
    }
    const auto value = [&]() -> QString {
      if (equals > 0) return inlineValue;
      if (i + 1 >= arguments.size()) throw InputError("", name.toStdString(), "needs a value");
      return arguments[++i];
    };
    if (name == QStringLiteral("-h") || name == QStringLiteral("--help"))
      c.help = true;
    else if (name == QStringLiteral("--version"))
      c.version = true;
    else if (name == QStringLiteral("--layout")) {
      c.layout = value();
      if (!layoutNames().contains(c.layout))
        throw InputError(
            "", "--layout",
            "'" + c.layout.toStdString() + "' is not one of: " + layoutNames().join(QStringLiteral(", ")).toStdString());
    } else if (name == QStringLiteral("--theme")) {
      c.theme = themeOf(value());
    } else if (name == QStringLiteral("--frame"))
      c.frame = value();
    else if (name == QStringLiteral("--ball"))
      c.balls << value();
    else if (name == QStringLiteral("--exclude"))
      c.exclude = value();
    else if (name == QStringLiteral("--run"))
      c.run += value().split(',', Qt::SkipEmptyParts);
    else if (name == QStringLiteral("--screenshot"))
      c.screenshot = value();
    else if (name == QStringLiteral("--size"))
      c.size = parseSize(value());
    else if (name == QStringLiteral("--limit"))
      c.limits << value();
    else if (name == QStringLiteral("--plugin"))
      c.plugins << value();
    else if (name == QStringLiteral("--wait-idle"))
      c.waitIdle = true;
    else if (const ChoiceOption* option = choiceOption(name))
      option->set(c.choices, value().toStdString());
    else if (name.startsWith('-') && name.size() > 1)
      throw InputError("", name.toStdString(), "unknown option" + didYouMean(name.toStdString(), optionNames()) + "; see --help");
    else if (c.input.isEmpty())
      c.input = name;
    else
      throw InputError("", "command line",
                       "more than one INPUT: '" + c.input.toStdString() + "' and '" + name.toStdString() + "'");
  }
  if (!c.balls.isEmpty() && c.input.isEmpty()) throw InputError("", "--ball", "needs INPUT, a folder of photographs");
  if (c.balls.isEmpty() && !c.exclude.isEmpty())
    throw InputError("", "--exclude", "is for photographs of balls: give --ball, too");
  return c;
}

QString helpText() {
  QStringList limits;
  for (const LimitInfo& limit : limitInfos()) limits << QString::fromStdString(limit.name);
  return QStringLiteral(
             "Usage: glint-inspector [INPUT] [options]\n\n"
             "Shows a specular highlight reconstruction step by step: surface, cameras, light and models in 3D, and the\n"
             "predicted and observed highlights in every frame.\n\n"
             "  INPUT                 a scene file (scene.json), a session (*.glint), a capture of another program (COLMAP,\n"
             "                        nerfstudio ...) or a folder containing one; default: start empty\n\n"
             "  --layout NAME         arrangement of the panels: %1\n"
             "  --theme light|dark    colours (default: those of the last time; dark at first and for --screenshot)\n"
             "  --frame ID            frame to select: id, or number in the input (from 0)\n"
             "  --ball [DIR:]CX,CY,R[@X0,Y0]\n"
             "                        INPUT is a folder of photographs of mirror balls: measure their lamps in a window of its\n"
             "                        own, as `glint lights`; may be repeated. --camera and --exclude SPEC as there\n"
             "  --run ID[,ID...]      run actions by id once the scene is shown (explain.step-contour, view.panel-plots ...);\n"
             "                        `--run list` prints all ids\n"
             "  --screenshot FILE     write the window as PNG and quit\n"
             "  --size WxH            window size in pixels (default: 1600x1000)\n"
             "  --wait-idle           take the screenshot once everything is computed and drawn\n"
             "  --limit NAME=VALUE    raise a limit on the size of inputs, in its own unit; may be repeated:\n"
             "                        %2\n"
             "  --plugin FILE         load a plugin: models, lobes, surfaces, readers or layers; may be repeated\n"
             "%3"
             "  --version, -h, --help\n\n"
             "Exit codes: 0 done, 2 invalid input or request (one line on standard error says where).\n"
             "Needs a display. Without one, use a virtual display:\n"
             "  QT_QPA_PLATFORM=xcb xvfb-run -a -s \"-screen 0 1600x1000x24\" glint-inspector INPUT --screenshot out.png "
             "--wait-idle\n")
      .arg(layoutNames().join(QStringLiteral(", ")), limits.join(QStringLiteral(", ")), choicesHelp());
}

}  // namespace glint::gui
