// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/frame_roles.h"

#include <QAction>
#include <QMenu>
#include <utility>

namespace glint::gui {

QString roleName(FrameRole role) {
  switch (role) {
    case FrameRole::Training: return QObject::tr("training");
    case FrameRole::HeldOut: return QObject::tr("held out");
    case FrameRole::Excluded: return QObject::tr("excluded");
  }
  return {};
}

const std::vector<int>& shownExcluded(const Document& document) {
  return document.pinnedShown() ? document.pinned()->request.excluded : document.request().excluded;
}

void addRoles(QMenu& menu, Document& document, int frame) {
  for (const auto& [role, title] : {std::pair(FrameRole::Training, QObject::tr("&Train on this frame")),
                                    std::pair(FrameRole::HeldOut, QObject::tr("Hol&d out this frame")),
                                    std::pair(FrameRole::Excluded, QObject::tr("E&xclude this frame"))}) {
    QAction* action = menu.addAction(title, &document, [&document, frame, role = role] { document.setRole(frame, role); });
    action->setCheckable(true);
    action->setChecked(document.role(frame) == role);
  }
}

}  // namespace glint::gui
