// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/palette_items.h"

#include <QAction>
#include <QMap>
#include <QRegularExpression>
#include <optional>
#include <variant>

#include "gui/base/text.h"
#include "gui/scene/scene_options.h"
#include "gui/timeline/light_switches.h"
#include "gui/whatif/what_if_panel.h"

namespace glint::gui {

namespace {
/// What an action is called elsewhere, where neither its title nor its tool tip says it.
QString synonymsOf(const QString& id) {
  static const QMap<QString, QString> all{
      {QStringLiteral("edit.copy-numbers"), QStringLiteral("clipboard values")},
      {QStringLiteral("edit.shortcuts"), QStringLiteral("keys hotkeys bindings")},
      {QStringLiteral("edit.stop"), QStringLiteral("cancel abort")},
      {QStringLiteral("explain.start"), QStringLiteral("help tutorial guide")},
      {QStringLiteral("export.coco"), QStringLiteral("annotations dataset polygons")},
      {QStringLiteral("export.csv"), QStringLiteral("spreadsheet table")},
      {QStringLiteral("export.html"), QStringLiteral("document")},
      {QStringLiteral("export.masks"), QStringLiteral("annotations dataset segmentation")},
      {QStringLiteral("export.repro"), QStringLiteral("bug reproduce reduce smallest")},
      {QStringLiteral("file.open"), QStringLiteral("load")},
      {QStringLiteral("frame.brighter"), QStringLiteral("exposure stops")},
      {QStringLiteral("frame.darker"), QStringLiteral("exposure stops")},
      {QStringLiteral("frame.clipped"), QStringLiteral("saturated overexposed")},
      {QStringLiteral("frame.exclude"), QStringLiteral("remove ignore delete")},
      {QStringLiteral("frame.false-colour"), QStringLiteral("heat map pseudo colour log radiance")},
      {QStringLiteral("frame.radiance"), QStringLiteral("hdr float linear")},
      {QStringLiteral("plots.show-dial"), QStringLiteral("polar residuals")},
      {QStringLiteral("plots.show-lobe"), QStringLiteral("log radiance specular profile")},
      {QStringLiteral("plots.show-lobes"), QStringLiteral("phong blinn beckmann torrance sparrow ggx brdf profile")},
      {QStringLiteral("view.colour-influence"), QStringLiteral("leave one out influence")},
      {QStringLiteral("view.frame-all"), QStringLiteral("zoom fit reset view")},
      {QStringLiteral("view.look-through"), QStringLiteral("first person")},
      {QStringLiteral("view.theme"), QStringLiteral("mode appearance")}};
  return all.value(id);
}

QString wordsOf(const QAction* action) {
  QString id = Actions::id(action);
  return action->toolTip() + QLatin1Char(' ') + id.replace('.', ' ').replace('-', ' ') + QLatin1Char(' ') +
         synonymsOf(Actions::id(action));
}

QString wordsOf(const ParamSpec& spec) {
  return toQString(spec.help) + QLatin1Char(' ') + toQString(spec.symbol) + QLatin1Char(' ') + joined(spec.choices);
}

void addActions(QList<PaletteItem>& items, const Actions& actions) {
  for (QAction* action : actions.all()) {
    const QString path = Actions::path(action), title = Actions::title(action);
    QString detail = QKeySequence::listToString(action->shortcuts(), QKeySequence::NativeText);
    if (action->isCheckable())
      detail +=
          (detail.isEmpty() ? QString() : QStringLiteral("   ")) + (action->isChecked() ? QObject::tr("on") : QObject::tr("off"));
    items.append({title, path.left(path.size() - title.size()).remove(QRegularExpression(QStringLiteral(" › $"))), detail,
                  action->isEnabled(), [action] { action->trigger(); }, wordsOf(action)});
  }
}

void addParameters(QList<PaletteItem>& items, Document& document, const std::function<void(const std::string&)>& show) {
  for (const ParamSpec& spec : allParams())
    items.append({toQString(spec.title), QObject::tr("Settings › %1").arg(toQString(spec.key)),
                  valueText(document.request().settings.value(spec.key), spec), true, [show, key = spec.key] { show(key); },
                  wordsOf(spec)});
}

/// A number as the settings read it; they know no decimal comma.
QString settingText(const QString& typed, const ParamSpec& spec) {
  const bool isNumber = std::holds_alternative<double>(spec.defaultValue) || std::holds_alternative<int>(spec.defaultValue);
  const std::optional<double> number = isNumber && typed.contains(QLatin1Char(',')) ? numberFromText(typed) : std::nullopt;
  return number ? QString::number(*number, 'g', 17) : typed;
}

/// "name = value": the value is checked by the settings themselves.
void addAssignments(QList<PaletteItem>& items, const QString& value, Document& document) {
  for (const ParamSpec& spec : allParams()) {
    Settings tried;
    QString problem;
    try {
      tried.setFromText(spec.key, settingText(value, spec).toStdString());
    } catch (const InputError& e) {
      problem = toQString(e.what()).mid(int(e.place().size()) + 2);  // the place is what the row shows already
    }
    const QString place = QObject::tr("Settings › %1").arg(toQString(spec.key));
    if (!problem.isEmpty()) {
      items.append({toQString(spec.title), place, problem, false, {}});
      continue;
    }
    const SettingValue wanted = tried.value(spec.key);
    items.append({toQString(spec.title), place, QObject::tr("set to %1").arg(valueText(wanted, spec)), true,
                  [&document, key = spec.key, wanted] { document.setSetting(key, wanted); }});
  }
}

std::vector<WhatIfKnob> knobsOf(const Document& document) {
  if (document.frameCount() == 0) return {};
  return whatIfKnobs(*document.scene(), document.selection().frame, int(highlightsToMove(document).size()));
}

PaletteItem itemOf(const WhatIfKnob& knob, const QString& detail, bool enabled, std::function<void()> run) {
  return {toQString(knob.spec.title),
          QObject::tr("What-if › %1").arg(toQString(knob.group)),
          detail,
          enabled,
          std::move(run),
          QObject::tr("slider change move") + QLatin1Char(' ') + toQString(knob.spec.help)};
}

void addKnobs(QList<PaletteItem>& items, Document& document, const std::function<void(const std::string&)>& show) {
  if (document.frameCount() == 0) return;
  const WhatIf& now = document.request().whatIf;
  items.append({QObject::tr("Synthesise contours"), QObject::tr("What-if"),
                now.synthesise ? QObject::tr("on") : QObject::tr("off"), true, [show] { show("synthesise"); },
                QObject::tr("synthetic simulate")});
  items.append({QObject::tr("Lobe of synthesised contours"),
                QObject::tr("What-if"),
                QLatin1String(nameOf(now.lobe)),
                true,
                [show] { show("lobe"); },
                {}});
  for (const WhatIfKnob& knob : knobsOf(document))
    items.append(itemOf(knob, valueText(knob.get(now), knob.spec), true, [show, key = knob.spec.key] { show(key); }));
}

void addLightSwitches(QList<PaletteItem>& items, Document& document) {
  if (document.frameCount() == 0) return;
  const int frame = document.selection().frame;
  const QString id = nameText(document.scene()->frames[std::size_t(frame)].id);
  for (const viz::LightRow& row : viz::lightRows(*document.scene(), document.inspection().get())) {
    const viz::LightState state = viz::lightState(row, *document.scene(), document.request().whatIf, frame);
    items.append({QObject::tr("%1 in frame %2").arg(lightTitle(row.light), id), QObject::tr("What-if"),
                  canSwitch(document, state) ? lightStateText(state) : lightClickText(document, state),
                  canSwitch(document, state), [&document, row, frame] { switchLight(document, row, frame); },
                  QObject::tr("lamp switch on off")});
  }
}

/// Layers of the 3D view; those of the photograph are actions.
void addLayers(QList<PaletteItem>& items, Document& document, int view) {
  if (!document.scene()) return;
  for (const viz::Layer& layer : viz::sceneLayers()) {
    const bool visible = layerVisibleIn(document, view, layer.name);
    items.append({toQString(layer.title), QObject::tr("Layers of the 3D view"), visible ? QObject::tr("on") : QObject::tr("off"),
                  true,
                  [&document, view, layer, visible] { setLayerVisibleIn(document, view, layer.name, layer.title, !visible); },
                  QObject::tr("layer show hide %1").arg(toQString(layer.name))});
  }
}

void addKnobAssignments(QList<PaletteItem>& items, const QString& value, Document& document) {
  for (const WhatIfKnob& knob : knobsOf(document)) {
    const ParamSpec& spec = knob.spec;
    QString problem;
    const std::optional<double> number = numberFromText(value, &problem);
    const double wanted = number.value_or(0);
    if (number && !(wanted >= spec.min && wanted <= spec.max))
      problem = QObject::tr("%1 is outside %2 … %3").arg(value, numberText(spec.min), valueText(spec.max, spec));
    else if (number && knob.synthetic && !document.request().whatIf.synthesise)
      problem = QObject::tr("requires synthesised contours");
    items.append(itemOf(knob, problem.isEmpty() ? QObject::tr("set to %1").arg(valueText(wanted, spec)) : problem,
                        problem.isEmpty(), [&document, knob, wanted] { turnKnob(document, knob, wanted); }));
  }
}

void addFrames(QList<PaletteItem>& items, Document& document) {
  for (int i = 0; i < document.frameCount(); ++i)
    items.append({QObject::tr("Frame %1").arg(nameText(document.scene()->frames[std::size_t(i)].id)),
                  QObject::tr("Select it: %1 of %2").arg(i + 1).arg(document.frameCount()),
                  {},
                  true,
                  [&document, i] { document.selectFrame(i); }});
}
}  // namespace

QList<PaletteItem> paletteItems(const QString& typed, const Actions& actions, Document& document, const PaletteTargets& targets) {
  QList<PaletteItem> items;
  if (const int equals = typed.indexOf(QLatin1Char('=')); equals >= 0) {
    if (const QString value = typed.mid(equals + 1).trimmed(); !value.isEmpty()) {
      addAssignments(items, value, document);
      addKnobAssignments(items, value, document);
      return items;
    }
    addParameters(items, document, targets.parameter);
    addKnobs(items, document, targets.whatIf);
    return items;
  }
  // Not before a number is typed: a thousand frames would bury the rest. Then before what else names a frame, as undo may.
  if (document.scene() && typed.contains(QRegularExpression(QStringLiteral("\\d")))) addFrames(items, document);
  addActions(items, actions);
  addParameters(items, document, targets.parameter);
  addKnobs(items, document, targets.whatIf);
  addLightSwitches(items, document);
  addLayers(items, document, targets.activeView());
  return items;
}

}  // namespace glint::gui
