// SPDX-License-Identifier: BSD-3-Clause
#include <QAction>
#include <QApplication>
#include <QLocale>
#include <algorithm>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/app/load_plugins.h"
#include "core/base/limits.h"
#include "core/base/outcome.h"
#include "core/base/version.h"
#include "core/scene/outputs.h"
#include "gui/base/error_line.h"
#include "gui/base/input_rules.h"
#include "gui/base/memory_rules.h"
#include "gui/lamps/lamps_in_window.h"
#include "gui/scene/camera_glide.h"
#include "gui/window/command_line.h"
#include "gui/window/fit_on_screen.h"
#include "gui/window/main_window.h"
#include "gui/window/screenshot.h"
#include "viz/added_layer.h"
#include "viz/display_connection.h"

namespace {
/// The offscreen and minimal platforms have no OpenGL: the program would run and show an empty 3D view.
bool platformDraws(int argc, char** argv) {
  std::string platform = qEnvironmentVariable("QT_QPA_PLATFORM").toStdString();
  for (int i = 1; i + 1 < argc; ++i)
    if (std::string(argv[i]) == "-platform") platform = argv[i + 1];
  return platform.rfind("offscreen", 0) != 0 && platform.rfind("minimal", 0) != 0;
}

/// Whether Qt can only take X11: what was chosen, or else what the session is.
bool onlyX11() {
  const QString chosen = qEnvironmentVariable("QT_QPA_PLATFORM");
  if (chosen.isEmpty())
    return !qEnvironmentVariableIsSet("WAYLAND_DISPLAY") && !qEnvironmentVariableIsSet("WAYLAND_SOCKET") &&
           qEnvironmentVariable("XDG_SESSION_TYPE") != QLatin1String("wayland");
  const QStringList platforms = chosen.split(';', Qt::SkipEmptyParts);  // each "NAME:OPTIONS", tried in this order
  return std::all_of(platforms.begin(), platforms.end(),
                     [](const QString& platform) { return platform.section(':', 0, 0) == QLatin1String("xcb"); });
}

/// Qt ends the program where it finds no display. InputError before that; null if it may find something else than X11.
std::unique_ptr<glint::viz::DisplayConnection> openDisplay() {
  if (!onlyX11()) return nullptr;
  glint::Outcome<std::unique_ptr<glint::viz::DisplayConnection>> display = glint::viz::DisplayConnection::open();
  if (!display)
    throw glint::InputError("", "",
                            display.failure().detail + ", so no window can be shown; use a display, or xvfb-run (see --help)");
  return std::move(*display);
}

void openInput(glint::gui::MainWindow& window, const glint::gui::CommandLine& command) {
  if (command.balls.isEmpty()) return window.open(command.input, command.frame, command.choices);
  glint::BallQuestion question;
  question.input = command.input.toStdString();
  for (const QString& ball : command.balls) question.balls.push_back(glint::namedBall(ball.toStdString()));
  question.exclude = command.exclude.toStdString();
  if (!command.choices.camera.empty()) question.camera = glint::cameraOfNumbers(command.choices.camera);
  window.lamps()->openBalls(question, command.frame);
}

/// Prints a line for each that is refused.
void loadPluginsOf(const glint::gui::CommandLine& command) {
  std::vector<std::filesystem::path> files;
  for (const QString& file : command.plugins) files.emplace_back(file.toStdString());
  for (const std::string& line : glint::loadPlugins(files)) glint::gui::printErrorLine(line);
  for (const std::string& line : glint::viz::addPluginLayers()) glint::gui::printErrorLine(line);
}

/// The ids that `--run` takes, one a line. @return the exit code
int printActions(glint::gui::MainWindow& window) {
  for (const QAction* action : window.actions().all()) std::puts(qPrintable(glint::gui::Actions::id(action)));
  return 0;
}

void printProblems(const glint::gui::MainWindow& window) {
  QObject::connect(&window, &glint::gui::MainWindow::problem,
                   [](const QString& line) { glint::gui::printErrorLine(line.toStdString()); });
}

/// A picture looks the same for everybody, a window as its user left it.
glint::gui::Theme themeOfStart(const glint::gui::CommandLine& command) {
  return command.theme.value_or(command.screenshot.isEmpty() ? glint::gui::keptTheme() : glint::gui::Theme::Dark);
}

bool starting = true;  ///< What Qt cannot do until its first window is the user's business, and no fault of the program.

int run(int argc, char** argv) {
  using namespace glint::gui;
  QStringList arguments;
  for (int i = 1; i < argc; ++i) arguments << QString::fromLocal8Bit(argv[i]);
  const CommandLine command = parseCommandLine(arguments);
  if (command.help) return std::fputs(helpText().toUtf8().constData(), stdout) < 0;
  loadPluginsOf(command);
  if (command.version) return std::puts(("glint-inspector " GLINT_VERSION + glint::pluginLines()).c_str()) < 0;
  for (const QString& limit : command.limits) glint::setLimit(limit.toStdString());
  if (!platformDraws(argc, argv))
    throw glint::InputError("", "QT_QPA_PLATFORM",
                            "this Qt platform cannot draw 3D; use a display, or xvfb-run with QT_QPA_PLATFORM=xcb (see --help)");

  // Messages that do not need the input come before there is a window; Screenshot has the rest.
  const std::vector<std::filesystem::path> input{command.input.toStdString()};
  glint::Outputs(input).file(command.screenshot.toStdString(), "--screenshot", glint::OutputKind::png());

#if QT_VERSION < QT_VERSION_CHECK(6, 0, 0)
  QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
#endif
  // Qt's notes for programmers (a folder that the system lacks, a style without a font) are not for the user; a fatal one is.
  qInstallMessageHandler([](QtMsgType type, const QMessageLogContext&, const QString& text) {
    if (type != QtFatalMsg) return;
    printErrorLine(text.toStdString());
    if (starting) std::_Exit(2);  // Qt would abort
  });
  std::unique_ptr<glint::viz::DisplayConnection> display = openDisplay();
  int qtArgc = 1;  // Qt's own options come from the environment; the rest of the command line is ours
  QApplication app(qtArgc, argv);
  starting = false;
  display.reset();  // Qt has its own
  // Qt has taken over the user's locale for the whole process; also what libraries read and write has a point in numbers.
  std::setlocale(LC_NUMERIC, "C");
  QApplication::setOrganizationName(QStringLiteral("Glint"));
  QApplication::setApplicationName(QStringLiteral("glint-inspector"));
  QApplication::setApplicationVersion(QStringLiteral(GLINT_VERSION));
  QLocale::setDefault(QLocale::c());  // numbers have a point everywhere
  installInputRules(app);
  const Theme theme = themeOfStart(command);
  applyTheme(app, theme);
  MainWindow window(coreEngine());
  if (command.run == QStringList{QStringLiteral("list")}) return printActions(window);
  if (!command.run.isEmpty() && command.screenshot.isEmpty()) printProblems(window);  // a script may be waiting for it
  window.setTheme(theme);
  if (!command.size.isEmpty())
    window.resize(command.size);
  else
    new FitOnScreen(&window);  // a size that was asked for is kept
  window.applyLayout(command.layout);
  window.show();
  window.applyLayout(command.layout);                        // dock sizes are known only now
  if (!command.size.isEmpty()) window.resize(command.size);  // a large window's docks may have kept it larger
  if (!command.input.isEmpty()) openInput(window, command);
  setAnimationsWanted(command.run.isEmpty() && command.screenshot.isEmpty());  // a script waits for no movement
  if (!command.run.isEmpty()) window.runActions(command.run);
  if (!command.screenshot.isEmpty()) new Screenshot(window, command.screenshot, command.waitIdle);
  return QApplication::exec();
}
}  // namespace

int main(int argc, char** argv) {
  try {
    glint::gui::applyMemoryRules();
    return run(argc, argv);
  } catch (const std::exception& e) {
    glint::gui::printErrorLine(e.what());
    return 2;
  }
}
