// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <QtCore>
#include <QtGui>
#include <QtWidgets>

#include "core/app/session.h"
#include "core/draw/frame_overlay.h"
#include "core/report/measured_lamps.h"
#include "gui/base/actions.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/document/document.h"
#include "resources/setup/headers/inspected.h"
