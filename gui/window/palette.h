// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QFrame>
#include <QList>
#include <QString>
#include <compare>
#include <functional>
#include <optional>

class QAction;
class QLineEdit;
class QTreeWidget;

namespace glint::gui {

/// One thing that the palette finds.
struct PaletteItem {
  QString title;   ///< "Contour level"
  QString place;   ///< "Settings › detect.level", where else it is
  QString detail;  ///< a shortcut or a value
  bool enabled = true;
  std::function<void()> run;
  QString words = {};  ///< other words for it, not shown: its tool tip, its values, synonyms
};

/// How well an item matches the typed text. The way of the match counts before the score.
struct PaletteMatch {
  enum class Way {
    Scattered,  ///< letters in order with anything between them
    Letters,    ///< letters in order, at the starts of words or with one left out: "cnlv" of "Contour level"
    Text        ///< every word as it was typed
  };
  Way way = Way::Text;
  int score = 0;
  friend auto operator<=>(const PaletteMatch&, const PaletteMatch&) = default;
};
/// Every word that was typed must occur in the item. A whole word counts more than the start of one, that more than the inside;
/// the title counts most, then the place, then the starts of its other words; American spelling is understood. Nothing if a
/// word does not occur.
std::optional<PaletteMatch> matchOf(const QString& typed, const PaletteItem& item);

/// The command palette: type a few letters, Return runs the item. It covers the top of its window until it is left.
class Palette : public QFrame {
  Q_OBJECT
 public:
  /// @param items  called whenever the typed text changes; for an empty line, the best come first.
  Palette(std::function<QList<PaletteItem>(const QString& typed)> items, QWidget* window);
  void popUp();
  /// The action that opens it: its keys, pressed again, select what was typed.
  void setOpener(const QAction* opener) { opener_ = opener; }
  QLineEdit* line() const { return line_; }
  QTreeWidget* list() const { return list_; }

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void search();
  /// Title, place and key share the width.
  void fitColumns();
  void runCurrent();

  std::function<QList<PaletteItem>(const QString&)> source_;
  QList<PaletteItem> shown_;
  const QAction* opener_ = nullptr;
  QLineEdit* line_;
  QTreeWidget* list_;
};

}  // namespace glint::gui
