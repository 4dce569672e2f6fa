// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>
#include <QMap>
#include <QString>

class QComboBox;
class QLineEdit;
class QTextBrowser;
class QUrl;

namespace glint::gui {

/// A separate window for reading: the manual, the method, the notation, and the glossary. It needs no network:
/// the pages are part of the program.
class Reader : public QDialog {
  Q_OBJECT
 public:
  explicit Reader(QWidget* parent = nullptr);
  /// Shows a page, and brings the window to the front.
  /// @param page   "manual", "method", "notation" or "glossary"; another one leaves the page as it is.
  /// @param place  of the method: a section's number ("8a"); of the glossary: a word; of the others: how a heading begins. "" or
  ///               a missing one = the beginning.
  void openPage(const QString& page, const QString& place = {});

 private:
  void show(const QString& page, const QString& place);
  void find(bool next);
  void follow(const QUrl& link);
  void goTo(const QString& page, const QString& place);

  QComboBox* pages_;
  QLineEdit* search_;
  QTextBrowser* text_;
  QString shown_;  ///< page
};

/// The glossary as HTML, with an anchor at each word.
QString glossaryHtml();

}  // namespace glint::gui
