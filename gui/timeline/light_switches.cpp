// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/light_switches.h"

#include <QCoreApplication>
#include <QMenu>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
struct Texts {
  Q_DECLARE_TR_FUNCTIONS(LightSwitches)
};

bool turnsOff(viz::LightState state) { return viz::isLit(state) || state == viz::LightState::NotStated; }
}  // namespace

QString lightStateText(viz::LightState state) {
  switch (state) {
    case viz::LightState::Off: return Texts::tr("off");
    case viz::LightState::On: return Texts::tr("on");
    case viz::LightState::NotStated: return Texts::tr("not stated in the scene");
    case viz::LightState::SwitchedOff: return Texts::tr("switched off by hand");
    case viz::LightState::SwitchedOn: return Texts::tr("switched on by hand");
  }
  return {};
}

QString lightClickText(const Document& document, viz::LightState state) {
  if (!canSwitch(document, state))
    return Texts::tr("off as captured; can be switched on once contours are synthesised (What-if)");
  switch (state) {
    case viz::LightState::Off: return Texts::tr("click to switch on in this frame");
    case viz::LightState::SwitchedOff:
      return Texts::tr("its highlight in this frame is used neither for training nor for evaluation; click to restore it");
    case viz::LightState::SwitchedOn: return Texts::tr("click to switch off again");
    default: return Texts::tr("click to switch off in this frame");
  }
}

bool canSwitch(const Document& document, viz::LightState state) {
  return state != viz::LightState::Off || document.request().whatIf.synthesise;
}

void switchLight(Document& document, const viz::LightRow& row, int frame) {
  const Scene* scene = document.scene();
  if (!scene || frame < 0 || frame >= int(row.captured.size()) || frame >= document.frameCount()) return;
  const WhatIf& now = document.request().whatIf;
  const viz::LightState state = viz::lightState(row, *scene, now, frame);
  if (!canSwitch(document, state)) return;
  const bool on = !turnsOff(state);
  const QString id = nameText(scene->frames[std::size_t(frame)].id);
  document.setWhatIf(
      switched(now, *scene, frame, row.light, on),
      (on ? Texts::tr("Switch %1 on in frame %2") : Texts::tr("Switch %1 off in frame %2")).arg(lightText(row.light), id));
}

void switchLightEverywhere(Document& document, const viz::LightRow& row, bool asCaptured) {
  const Scene* scene = document.scene();
  if (!scene) return;
  WhatIf w = document.request().whatIf;
  for (int frame = 0; frame < document.frameCount() && frame < int(row.captured.size()); ++frame) {
    if (asCaptured)
      w.lightsSwitched.erase({frame, row.light});
    else if (turnsOff(viz::lightState(row, *scene, w, frame)))
      w = switched(std::move(w), *scene, frame, row.light, false);
  }
  document.setWhatIf(w, (asCaptured ? Texts::tr("Restore %1 in every frame") : Texts::tr("Switch %1 off in every frame"))
                            .arg(lightText(row.light)));
}

void addLights(QMenu& menu, Document& document, const std::vector<viz::LightRow>& rows, int frame) {
  if (!document.scene() || frame < 0 || frame >= document.frameCount()) return;
  if (rows.empty()) {
    menu.addAction(Texts::tr("All frames show the same single light; exclude a frame instead"))->setEnabled(false);
    return;
  }
  for (const viz::LightRow& row : rows) {
    const viz::LightState state = viz::lightState(row, *document.scene(), document.request().whatIf, frame);
    QAction* action = menu.addAction(menuText(lightTitle(row.light)));
    action->setCheckable(true);
    action->setChecked(turnsOff(state));
    action->setEnabled(canSwitch(document, state));
    action->setToolTip(lightStateText(state) + QLatin1String("; ") + lightClickText(document, state));
    QObject::connect(action, &QAction::triggered, &document, [&document, row, frame] { switchLight(document, row, frame); });
  }
}

}  // namespace glint::gui
