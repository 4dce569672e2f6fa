// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <functional>
#include <memory>

#include "core/scene/convention_report.h"

class QLabel;
class QPlainTextEdit;
class QVBoxLayout;

namespace glint::gui {

using ReportPtr = std::shared_ptr<const ConventionReport>;

/// The convention report of the open input, as `glint info` prints it: first what looks wrong, each with a button for the
/// correction where there is one.
class ReportPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ReportPanel(QWidget* parent = nullptr);
  /// @param report  null = no report yet, because `why`
  void show(const ReportPtr& report, const QString& why);
  QString text() const;

 signals:
  void fixRequested(const glint::Correction& correction);

 private:
  void addFinding(const QString& words, const Correction* correction);
  QLabel* summary_;
  QVBoxLayout* findings_;
  QPlainTextEdit* text_;
};

}  // namespace glint::gui
