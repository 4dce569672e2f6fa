// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/context_menus.h"

#include <QAction>
#include <QMenu>
#include <QTableView>
#include <initializer_list>
#include <string>

#include "core/base/outcome.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/highlight_edits.h"
#include "gui/panels/error_table.h"
#include "gui/plots/plot_canvas.h"
#include "gui/plots/plots_panel.h"

namespace glint::gui {

void offerMenus(const Actions& actions, FramePanel& frame, PlotsPanel& plots, ErrorTable& errors) {
  const auto offer = [&actions](QWidget* view, std::initializer_list<const char*> ids) {
    for (const char* id : ids) {
      QAction* action = *id ? actions.find(QLatin1String(id)) : new QAction(view);
      require(action != nullptr, std::string("offerMenus: no action named ") + id);
      if (!*id) action->setSeparator(true);
      view->addAction(action);
    }
    view->setContextMenuPolicy(Qt::ActionsContextMenu);
  };
  for (FrameCanvas* canvas : frame.findChildren<FrameCanvas*>()) {
    offer(canvas, {"frame.highlight", "frame.fit", "frame.pixels", "frame.values", "", "frame.train", "frame.hold-out",
                   "frame.exclude", ""});
    if (canvas == frame.canvas())  // the edits are made at the place under the pointer in the selected frame
      offer(canvas, {"frame.ignore-highlight", "frame.merge-highlights", "frame.split-highlight", "frame.grow-highlight",
                     "frame.highlights-as-found", ""});
    offer(canvas, {"frame.hand", "frame.side-by-side", "", "export.frame"});
    canvas->setContextMenuPolicy(Qt::CustomContextMenu);
    QObject::connect(canvas, &QWidget::customContextMenuRequested, canvas, [canvas, edits = frame.edits()](const QPoint& at) {
      auto* menu = new QMenu(canvas);
      menu->setObjectName(QStringLiteral("frameMenu"));
      menu->setAttribute(Qt::WA_DeleteOnClose);
      menu->addActions(canvas->actions());
      edits->offerIn(menu);
      menu->popup(canvas->mapToGlobal(at));
    });
  }
  for (PlotCanvas* plot : plots.findChildren<PlotCanvas*>())
    offer(plot, {"plots.show-all", "", "plots.copy-png", "plots.copy-svg", "plots.copy-csv", "", "plots.save-svg",
                 "plots.save-png", "plots.save-csv"});
  offer(errors.view(), {"edit.copy-error-rows", "edit.copy-error-rows-csv", "", "export.csv", "export.json", "export.html"});
}

}  // namespace glint::gui
