// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QString>
#include <QWidget>
#include <functional>
#include <optional>
#include <utility>

class QHBoxLayout;
class QLabel;
class QToolButton;

namespace glint::gui {

/// One line across the window about an error or a possible action; it stays until it is closed, answered or overtaken,
/// and blocks nothing.
class MessageBar : public QWidget {
  Q_OBJECT
 public:
  using Answers = QList<std::pair<QString, std::function<void()>>>;  ///< title of a button, what it does

  explicit MessageBar(QWidget* parent = nullptr);
  void showError(const QString& oneLine, const Answers& answers = {});
  /// Not an error, but a decision. What replaces it gives its place back when closed or answered.
  void showOffer(const QString& oneLine, const Answers& answers);
  /// The same, after an error that is on screen.
  void queueOffer(const QString& oneLine, const Answers& answers);
  /// Worth knowing, asks for nothing: any other message may replace it.
  void showNotice(const QString& oneLine);
  /// Something has worked since: removes an error that asks for nothing.
  void overtakeError();
  /// An error or an offer waits for an answer.
  bool waits() const { return !isHidden() && !notice_; }
  /// An error is on screen; an offer may give way to another one.
  bool failed() const { return waits() && !offerShown_; }
  /// Withdraws an offer whose subject is closed.
  void withdraw(const QString& oneLine);
  QString text() const;

 private:
  void showLine(const QString& oneLine, const QColor& background, const Answers& answers);
  void closeLine();  ///< by the user, or with an answer

  QHBoxLayout* row_;
  QLabel* label_;
  QList<QWidget*> buttons_;
  bool notice_ = false;
  std::optional<std::pair<QString, Answers>> offer_;  ///< not yet answered or closed
  bool offerShown_ = false;
};

}  // namespace glint::gui
