// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/axis_views.h"

#include "gui/base/actions.h"
#include "gui/scene/scene_options.h"
#include "gui/scene/scene_views.h"

namespace glint::gui {

void addAxisViews(Actions& actions, QMenu* menu, Document& document, SceneViews& views) {
  actions.add("view.views-axes", menu, QObject::tr("&Top, front, side and perspective"),
              [&document, &views] {
                const viz::ViewPoint free = views.active().viewPoint();
                document.setView(
                    {}, {{"scene/views", toText(Arrangement::Grid)}, {"scene/linked", "0"}, {"scene/parallel", kAxisViews}},
                    QObject::tr("3D views: top, front, side and perspective"));
                const viz::AxisView axes[] = {viz::AxisView::Top, viz::AxisView::Front, viz::AxisView::Right};
                for (int i = 0; i < 3; ++i) views.view(i).lookAlong(axes[i]);
                views.view(3).setViewPoint(free);
                views.view(3).setParallel(false);
                views.scheduleRender();
              },
              {{}, {}, QObject::tr("Four views with cameras of their own; those along the axes without perspective")});
}

}  // namespace glint::gui
