// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/recovery.h"

#include <QDir>
#include <QLocale>
#include <QTimer>
#include <utility>

#include "gui/base/text.h"
#include "gui/document/own_files.h"
#include "gui/window/file_actions.h"
#include "gui/window/message_bar.h"

namespace glint::gui {

Recovery::Recovery(const Engine& engine, Document& document, std::function<Opened()> snapshot, FileActions& files,
                   MessageBar& bar, QObject* parent)
    : QObject(parent), autosave_(engine, document, std::move(snapshot), recoveryFolder(), this), files_(files), bar_(bar) {
  connect(&autosave_, &Autosave::problem, this, &Recovery::problem);
  connect(&document, &Document::sceneOpened, this, [this] {
    const auto found = std::exchange(opening_, {});
    emit opened(found.has_value());
    if (!found) return;
    QTimer::singleShot(0, this, [this, found] {
      autosave_.flush();  // what was recovered is in this program's own file before the other one goes
      Autosave::discard(*found);
    });
  });
}

void Recovery::offer() {
  const std::optional<Autosave::Found> found = autosave_.leftBehind();
  if (!found) return;
  const auto recover = [this, found = *found] {
    opening_ = found;
    files_.openRecovered(found.file, found.of);
  };
  const auto discard = [this, found = *found] {
    Autosave::discard(found);
    offer();  // there may be an older one
  };
  bar_.showOffer(tr("Glint inspector closed unexpectedly with unsaved changes to %1 (%2).")
                     .arg(shownText(QDir::toNativeSeparators(found->of)), QLocale().toString(found->when, QLocale::ShortFormat)),
                 {{tr("Recover"), recover}, {tr("Discard"), discard}});
}

}  // namespace glint::gui
