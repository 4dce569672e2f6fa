// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/reader.h"

#include <QAbstractTextDocumentLayout>
#include <QComboBox>
#include <QDesktopServices>
#include <QFile>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QRegularExpression>
#include <QScrollBar>
#include <QTextBlock>
#include <QTextBrowser>
#include <QTextDocument>
#include <QUrl>
#include <QVBoxLayout>
#include <utility>

#include "gui/explain/glossary.h"

namespace glint::gui {

namespace {
constexpr QSize kReaderSize(820, 700);  // px: some 110 characters a line

const QMap<QString, QString>& files() {
  static const QMap<QString, QString> all{{QStringLiteral("manual"), QStringLiteral("inspector.md")},
                                          {QStringLiteral("method"), QStringLiteral("method.md")},
                                          {QStringLiteral("notation"), QStringLiteral("NOTATION.md")}};
  return all;
}

/// Without what a window cannot show: pictures that lie beside the page, and comments for the programs that write tables.
QString readable(const QString& page) {
  QFile file(QStringLiteral(":/docs/") + files().value(page));
  if (!file.open(QIODevice::ReadOnly)) return {};
  QString text = QString::fromUtf8(file.readAll());
  text.remove(QRegularExpression(QStringLiteral("<!--.*?-->"), QRegularExpression::DotMatchesEverythingOption));
  text.remove(QRegularExpression(QStringLiteral("!\\[[^\\]]*\\]\\([^)]*\\)")));
  return text;
}

/// The first heading that begins like this, as a place in the document; none = invalid.
QTextBlock headingAt(const QTextDocument& document, const QString& begins) {
  for (QTextBlock block = document.begin(); block.isValid(); block = block.next())
    if (block.blockFormat().headingLevel() > 0 && block.text().startsWith(begins)) return block;
  return {};
}
}  // namespace

QString glossaryHtml() {
  QString html = QStringLiteral("<h2>%1</h2>").arg(QObject::tr("Glossary"));
  for (const GlossaryWord& w : glossary())
    html += QStringLiteral("<p><a name='%1'></a><b>%1</b><br>%2</p>").arg(w.word.toHtmlEscaped(), w.text.toHtmlEscaped());
  return html;
}

Reader::Reader(QWidget* parent) : QDialog(parent), pages_(new QComboBox), search_(new QLineEdit), text_(new QTextBrowser) {
  setObjectName(QStringLiteral("reader"));
  setWindowTitle(tr("Glint help"));
  setModal(false);
  resize(kReaderSize);
  auto* column = new QVBoxLayout(this);
  auto* row = new QHBoxLayout;
  pages_->setObjectName(QStringLiteral("reader.page"));
  pages_->setAccessibleName(tr("Page"));
  for (const auto& [id, title] : {std::pair("manual", tr("Manual of the inspector")), std::pair("method", tr("Method")),
                                  std::pair("notation", tr("Notation")), std::pair("glossary", tr("Glossary"))})
    pages_->addItem(title, QLatin1String(id));
  search_->setObjectName(QStringLiteral("reader.search"));
  search_->setPlaceholderText(tr("Find on this page"));
  search_->setAccessibleName(tr("Find on this page"));
  search_->setClearButtonEnabled(true);
  auto* close = new QPushButton(tr("Close"));
  close->setAutoDefault(false);  // Enter finds the next place
  row->addWidget(pages_);
  row->addWidget(search_, 1);
  row->addWidget(close);
  column->addLayout(row);
  text_->setObjectName(QStringLiteral("reader.text"));
  text_->setAccessibleName(tr("Text of the page"));
  text_->setOpenLinks(false);
  column->addWidget(text_, 1);
  connect(close, &QPushButton::clicked, this, &QDialog::close);
  connect(pages_, qOverload<int>(&QComboBox::activated), this, [this] { show(pages_->currentData().toString(), {}); });
  connect(search_, &QLineEdit::textEdited, this, [this] { find(false); });
  connect(search_, &QLineEdit::returnPressed, this, [this] { find(true); });
  connect(text_, &QTextBrowser::anchorClicked, this, &Reader::follow);
}

void Reader::openPage(const QString& page, const QString& place) {
  show(page, place);
  QDialog::show();
  raise();
  activateWindow();
  goTo(page, place);  // again: only what is shown knows where its lines are
}

void Reader::show(const QString& page, const QString& place) {
  const int index = pages_->findData(page);
  if (index < 0) return;
  pages_->setCurrentIndex(index);
  if (page != std::exchange(shown_, page)) {
    if (page == QLatin1String("glossary"))
      text_->setHtml(glossaryHtml());
    else
      text_->document()->setMarkdown(readable(page));
  }
  goTo(page, place);
}

void Reader::goTo(const QString& page, const QString& place) {
  text_->moveCursor(QTextCursor::Start);
  text_->verticalScrollBar()->setValue(0);
  if (place.isEmpty()) return;
  if (page == QLatin1String("glossary")) return text_->scrollToAnchor(place);
  const QTextBlock block = headingAt(*text_->document(), page == QLatin1String("method") ? place + '.' : place);
  if (!block.isValid()) return;
  text_->setTextCursor(QTextCursor(block));
  const QRectF box = text_->document()->documentLayout()->blockBoundingRect(block);
  text_->verticalScrollBar()->setValue(int(box.top()));
}

/// @param next  else from the place of the search, so that a word that is being typed stays where it was found.
void Reader::find(bool next) {
  QTextCursor at = text_->textCursor();
  if (!next) at.setPosition(at.selectionStart());
  text_->setTextCursor(at);
  if (search_->text().isEmpty() || text_->find(search_->text())) return;
  text_->moveCursor(QTextCursor::Start);  // round again
  text_->find(search_->text());
}

void Reader::follow(const QUrl& link) {
  const QString name = QFileInfo(link.path()).fileName();
  if (const QString page = files().key(name); !page.isEmpty()) return show(page, {});
  if (link.scheme() == QLatin1String("https")) QDesktopServices::openUrl(link);
}

}  // namespace glint::gui
