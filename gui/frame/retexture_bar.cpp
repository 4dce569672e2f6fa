// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/retexture_bar.h"

#include <QAction>
#include <QComboBox>
#include <QEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/permitted.h"
#include "gui/base/flow_layout.h"
#include "gui/base/number_box.h"
#include "gui/base/panel_scroll.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/document/allowed_folders.h"
#include "gui/frame/develop_bar.h"
#include "gui/frame/frame_canvas.h"

namespace glint::gui {

namespace {
const char* const kRetexture = "frame/retexture";
const char* const kMapping = "frame/retexture-mapping";
const char* const kRepeat = "frame/retexture-repeat";
const char* const kShading = "frame/retexture-shading";
const char* const kAlbedo = "frame/retexture-albedo";
const char* const kMargin = "frame/retexture-margin";
const char* const kLight = "frame/retexture-light";
const char* const kCompare = "frame/retexture-compare";
constexpr double kUsualCompare = 0.5, kUsualMargin = 4;
constexpr int kCompareSteps = 100;
constexpr double kMostRepeats = 1e4, kLargestMargin = 1000;  // as `glint retexture` takes them
constexpr int kMostFileChars = 28;

std::string fileOption(const QString& base) { return std::string(kRetexture) + "-" + base.toStdString(); }

template <class Names>
int indexOf(const Names& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? 0 : int(at - names.begin());
}
}  // namespace

RetextureBar::RetextureBar(Document& document, FrameCanvas& canvas, PhotoLoader& loader, QWidget* parent)
    : QWidget(parent), document_(document), canvas_(canvas), loader_(loader) {
  auto* row = new FlowLayout(4);
  row->setContentsMargins(8, 0, 4, 2);
  setLayout(row);
  buildRow();
  buildDetails();
  words_ = new QLabel;
  words_->setObjectName(QStringLiteral("retextureWords"));
  words_->setTextFormat(Qt::RichText);
  words_->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::LinksAccessibleByMouse);
  words_->setWordWrap(true);
  words_->setMargin(4);
  connect(words_, &QLabel::linkActivated, this, &RetextureBar::allow);
  scroll_ = new PanelScroll(words_, {150, 20}, PanelScroll::Height::Hugs);
  scroll_->setAccessibleName(tr("What makes the picture doubtful"));
  refresh_.setSingleShot(true);
  refresh_.setInterval(0);
  connect(&refresh_, &QTimer::timeout, this, &RetextureBar::refresh);
  lateAfter_.setSingleShot(true);
  lateAfter_.setInterval(StaleBadge::kAfterMs);
  connect(&lateAfter_, &QTimer::timeout, this, [this] {
    late_ = true;
    showPicture();
  });
  for (const auto signal : {&Document::selectionChanged, &Document::optionsChanged, &Document::inspectionChanged,
                            &Document::frameInspectionChanged, &Document::requestChanged})
    connect(&document_, signal, this, [this] { refresh_.start(); });
  connect(&document_, &Document::sceneOpened, this, [this] {
    maker_.forget();
    answer_ = {};
    photographOf_ = -1;
    refresh();
  });
  connect(&loader_, &PhotoLoader::loaded, this, [this](int frame, const FramePicture&) {
    photographOf_ = frame;
    showPicture();
  });
  connect(&loader_, &PhotoLoader::failed, this, [this](int frame, const QString&) {
    photographOf_ = frame;
    showPicture();
  });
  connect(&maker_, &RetextureMaker::made, this, [this](const RetextureAnswer& answer) {
    if (!on() || answer.frame != document_.selection().frame) return;
    answer_ = answer;
    if (!maker_.busy()) lateAfter_.stop(), late_ = false;
    showPicture();
    sayAnswer();
  });
  refresh();
}

QWidget* RetextureBar::words() const { return scroll_; }

void RetextureBar::setMostWords(int height) { scroll_->setMost(height); }

QComboBox* RetextureBar::choice(const char* option, const QString& tip) {
  auto* box = new QComboBox;
  box->setObjectName(QLatin1String(option));
  box->setToolTip(tip);
  box->setFocusPolicy(Qt::NoFocus);  // arrow keys step through the frames
  box->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  layout()->addWidget(box);
  connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box, option](int i) {
    document_.setOption(option, box->itemData(i).toString().toStdString(), tr("Retexture: %1").arg(box->itemText(i)));
  });
  return box;
}

NumberBox* RetextureBar::number(const char* option, const QString& title, const QString& tip, const ParamSpec& range,
                                double usual) {
  auto* label = new QLabel(title);
  label->setProperty("role", "faded");
  layout()->addWidget(label);
  auto* box = new NumberBox(range);
  box->setObjectName(QLatin1String(option));
  box->setAccessibleName(title);
  box->setToolTip(tip);
  box->setValue(usual);
  layout()->addWidget(box);
  connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
          [this, option, title](double v) { document_.setOption(option, v, tr("Retexture: %1 %2").arg(title).arg(v)); });
  (option == kMargin ? ofMargin_ : ofTexture_) << label << box;
  return box;
}

void RetextureBar::buildRow() {
  base_ =
      choice(kRetexture, tr("What the predicted highlight of the selected model is put over; left of the line stands what was "
                            "captured. `glint retexture` does the same"));
  base_->addItem(tr("Texture"), QStringLiteral("texture"));
  base_->addItem(tr("Background"), QStringLiteral("background"));
  base_->addItem(tr("Highlight removed"), QStringLiteral("removed"));
  file_ = new QToolButton;
  file_->setAccessibleName(tr("Picture file"));
  file_->setToolTip(tr("Choose the picture"));
  file_->setObjectName(QStringLiteral("retextureFile"));
  file_->setIcon(icon(QStringLiteral("open")));
  file_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  file_->setAutoRaise(true);
  layout()->addWidget(file_);
  connect(file_, &QToolButton::clicked, this, [this] { chooseFile(chosen()); });
  auto* label = new QLabel(tr("Compare"));
  label->setProperty("role", "faded");
  layout()->addWidget(label);
  compare_ = new QSlider(Qt::Horizontal);
  compare_->setObjectName(QLatin1String(kCompare));
  compare_->setRange(0, kCompareSteps);
  compare_->setValue(int(kUsualCompare * kCompareSteps));
  compare_->setFixedWidth(90);
  compare_->setFocusPolicy(Qt::NoFocus);
  compare_->setAccessibleName(tr("Compare with the photograph"));
  compare_->setToolTip(tr(
      "How much of the photograph stays, from the left; the line in the picture can be dragged, too. Double-click for one half"));
  compare_->installEventFilter(this);
  layout()->addWidget(compare_);
  connect(compare_, &QSlider::sliderPressed, this, [this] { gesture_ = document_.newGesture(); });
  connect(compare_, &QSlider::sliderReleased, this, [this] { gesture_ = 0; });
  connect(compare_, &QSlider::valueChanged, this,
          [this](int v) { document_.setOption(kCompare, double(v) / kCompareSteps, tr("Compare: %1 %").arg(v), gesture_); });
  connect(&canvas_, &FrameCanvas::dividerMoved, this, [this](double share, bool begins) {
    if (begins) gesture_ = document_.newGesture();
    document_.setOption(kCompare, share, tr("Compare: %1 %").arg(std::lround(100 * share)), gesture_);
  });
  save_ = new QToolButton;
  save_->setObjectName(QStringLiteral("retextureSave"));
  save_->setIcon(icon(QStringLiteral("save")));
  save_->setAutoRaise(true);
  save_->setToolTip(tr("Write the whole retextured frame as PNG, as `glint retexture` does"));
  layout()->addWidget(save_);
  connect(save_, &QToolButton::clicked, this, &RetextureBar::saveRequested);
  more_ = new QToolButton;
  more_->setObjectName(QStringLiteral("retextureMore"));
  more_->setText(tr("Options"));
  more_->setCheckable(true);
  more_->setAutoRaise(true);
  more_->setToolTip(tr("How the texture lies and is shaded, and how much around the highlight is filled"));
  layout()->addWidget(more_);
  connect(more_, &QToolButton::toggled, this, &RetextureBar::showControls);
}

void RetextureBar::buildDetails() {
  mapping_ =
      choice(kMapping,
             tr("How the texture lies: by the surface's own coordinates, or as seen from the world's axes, a middle or a box"));
  for (const std::string& name : kTextureMappings) mapping_->addItem(tr("Mapping: %1").arg(toQString(name)), toQString(name));
  shading_ = choice(kShading,
                    tr("Under the texture: a matt surface under the estimated lights, or the frame without its highlight; auto: "
                       "the first where the model knows a light"));
  for (const std::string& name : kShadingSources) shading_->addItem(tr("Shading: %1").arg(toQString(name)), toQString(name));
  ofTexture_ << mapping_ << shading_;
  repeat_ =
      number(kRepeat, tr("Repeat"), tr("Textures in place of one, in both directions"), numberRange(0.01, kMostRepeats, 1), 1);
  albedo_ =
      number(kAlbedo, tr("Albedo"),
             tr("Albedo of the surface as it was; the texture's values are then albedos. 0: the texture's mean takes its place"),
             numberRange(0, 1, 0.05), 0);
  margin_ = number(kMargin, tr("Margin px"), tr("How far beyond its visible part a highlight is removed"),
                   numberRange(0, kLargestMargin, 1), kUsualMargin);
  light_ = choice(kLight, tr("Whose highlight: that of one light, or of all"));
}

bool RetextureBar::eventFilter(QObject* watched, QEvent* event) {
  if (watched != compare_ || event->type() != QEvent::MouseButtonDblClick) return QWidget::eventFilter(watched, event);
  compare_->setValue(int(kUsualCompare * kCompareSteps));
  return true;
}

QString RetextureBar::chosen() const {
  const QString name = toQString(document_.option(kRetexture, std::string("off")));
  return base_->findData(name) < 0 ? QStringLiteral("off") : name;
}

bool RetextureBar::on() const { return document_.scene() && chosen() != QLatin1String("off"); }

void RetextureBar::setOn(bool on) {
  document_.setOption(kRetexture, on ? "texture" : "off", on ? tr("Retexture") : tr("Retexture: off"));
}

RetextureRequest RetextureBar::request() const {
  RetextureRequest r;
  r.model = document_.plottedModel();
  r.light = light_->currentData().toString().toStdString();  // "" even if the option names one that this model has no fit of
  r.base = chosen() == QLatin1String("texture")      ? RetextureBase::Texture
           : chosen() == QLatin1String("background") ? RetextureBase::Background
                                                     : RetextureBase::Removed;
  r.mapping = TextureMapping(indexOf(kTextureMappings, document_.option(kMapping, kTextureMappings.front())));
  r.shading = ShadingSource(indexOf(kShadingSources, document_.option(kShading, kShadingSources.front())));
  r.repeat = std::clamp(document_.option(kRepeat, 1.0), 0.01, kMostRepeats);
  if (const double albedo = document_.option(kAlbedo, 0.0); albedo > 0 && albedo <= 1) r.albedo = albedo;
  r.marginPx = std::clamp(document_.option(kMargin, kUsualMargin), 0.0, kLargestMargin);
  return r;
}

void RetextureBar::chooseFile(const QString& base) {
  if (!document_.scene()) return;
  const QString title = base == QLatin1String("texture") ? tr("Texture") : tr("The frame without its highlight");
  const QString file =
      QFileDialog::getOpenFileName(this, title, toQString(document_.scene()->folder.string()),
                                   tr("Pictures (*.png *.jpg *.jpeg *.tif *.tiff *.bmp *.exr *.hdr);;All files (*)"));
  if (file.isEmpty()) return;
  const std::filesystem::path path = realPath(file.toStdString()), folder = realPath(document_.scene()->folder);
  picked_.insert(path.string());
  const std::string kept = liesIn({folder}, path) ? path.lexically_relative(folder).string() : path.string();
  document_.setOption(fileOption(base), kept, tr("Retexture with %1").arg(shownText(QFileInfo(file).fileName())));
  refresh_.start();  // the same file again may hold something else
}

std::string RetextureBar::fileOf(const QString& base) const {
  const std::string named = document_.option(fileOption(base), std::string());
  if (named.empty() || base == QLatin1String("removed")) return {};
  if (picked_.count(realPath(named).string())) return named;
  PathRights rights;
  for (const QString& folder : allowedFolders(document_.inputFile())) rights.folders.emplace_back(folder.toStdString());
  return resolveInside(document_.scene()->folder, named, rights, document_.inputFile().toStdString(), fileOption(base)).string();
}

void RetextureBar::allow() {
  try {
    fileOf(chosen());
  } catch (const OutsidePath& e) {
    allowFolder(document_.inputFile(), toQString(e.folder().string()));
  } catch (const InputError&) {
  }
  refresh();
}

void RetextureBar::refresh() {
  refresh_.stop();
  showControls();
  if (on() && document_.selection().frame == answer_.frame) return ask();
  answer_ = {};
  canvas_.setCompared({}, 0, {}, {});
  if (on()) return ask();
  lateAfter_.stop();
  late_ = false;
  maker_.forget();
}

void RetextureBar::showControls() {
  const bool on = this->on();
  setVisible(on);
  scroll_->setVisible(on);
  if (toggle_) toggle_->setChecked(on);
  if (!on) return;
  const QString base = chosen();
  const bool texture = base == QLatin1String("texture");
  const QSignalBlocker a(repeat_), b(albedo_), c(margin_), d(compare_);
  base_->setCurrentIndex(base_->findData(base));
  showLights(document_.plottedModel());
  const RetextureRequest r = request();
  mapping_->setCurrentIndex(int(r.mapping));
  shading_->setCurrentIndex(int(r.shading));
  repeat_->setValue(r.repeat);
  albedo_->setValue(r.albedo.value_or(0));
  margin_->setValue(r.marginPx);
  compare_->setValue(int(std::lround(kCompareSteps * document_.option(kCompare, kUsualCompare))));
  for (QWidget* w : std::as_const(ofTexture_)) w->setVisible(texture && more_->isChecked());
  const bool removes = base == QLatin1String("removed") || (texture && r.shading == ShadingSource::Frame);
  for (QWidget* w : std::as_const(ofMargin_)) w->setVisible(removes && more_->isChecked());
  more_->setVisible(base != QLatin1String("background") || light_->count() > 2);
  file_->setVisible(base != QLatin1String("removed"));
  const std::string named = document_.option(fileOption(base), std::string());
  const QString name = nameText(std::filesystem::path(named).filename().string());
  file_->setText(named.empty()
                     ? tr("Choose a picture…")
                     : menuText(name.size() > kMostFileChars ? name.left(kMostFileChars - 1) + QStringLiteral("…") : name));
  file_->setToolTip(named.empty() ? tr("Choose the picture") : tr("%1. Click for another picture").arg(nameText(named)));
}

void RetextureBar::showLights(const std::string& model) {
  std::set<std::string> lights;
  const std::shared_ptr<const Inspection> results = document_.results();
  if (results)
    if (const auto found = results->models.find(model); found != results->models.end())
      for (const ModelResult::Fit& fit : found->second.fits) lights.insert(fit.light);
  light_->clear();
  light_->addItem(tr("All lights"), QString());
  for (const std::string& id : lights) light_->addItem(nameText(id), exactQString(id));
  light_->setCurrentIndex(std::max(0, light_->findData(exactQString(document_.option(kLight, std::string())))));
  light_->setVisible(lights.size() > 1 && more_->isChecked());
}

void RetextureBar::ask() {
  const std::shared_ptr<const Inspection> results = document_.results();
  RetextureWish wish;
  wish.request = request();
  const auto problem = [this](const QString& html) {
    maker_.forget();
    answer_ = {};
    canvas_.setCompared({}, 0, {}, {});
    say(html);
  };
  const auto coloured = [](const QString& text) {
    return QStringLiteral("<span style='color:%1'>%2</span>").arg(warningColour().name(), text.toHtmlEscaped());
  };
  try {
    wish.file = fileOf(chosen());
  } catch (const OutsidePath& e) {
    return problem(coloured(toQString(withoutFlags(e))) + QStringLiteral(" <a href='allow'>%1</a>").arg(tr("Allow and read")));
  } catch (const InputError& e) {
    return problem(coloured(toQString(e.what())));
  }
  if (wish.file.empty() && wish.request.base != RetextureBase::Removed)
    return problem(wish.request.base == RetextureBase::Texture
                       ? tr("Choose a picture to put on the surface.")
                       : tr("Choose a picture of this frame without its highlight, of the same size."));
  if (!results || !results->models.count(wish.request.model)) {
    if (answer_.frame < 0) say(tr("There are no results of a model yet."));
    return;
  }
  wish.inspection = results;
  wish.frame = document_.selection().frame;
  wish.look = DevelopBar::development(document_);
  if (!lateAfter_.isActive() && !late_) lateAfter_.start();
  maker_.want(wish);
  showPicture();
}

void RetextureBar::showPicture() {
  const bool right = answer_.result && answer_.frame == document_.selection().frame && photographOf_ == answer_.frame && on();
  if (!right) return canvas_.setCompared({}, 0, {}, {});
  const int width = answer_.picture.shown.width();
  const double share = std::clamp(document_.option(kCompare, kUsualCompare), 0.0, 1.0);
  QString name =
      chosen() == QLatin1String("removed") ? tr("highlight removed") : tr("%1's highlight").arg(toQString(answer_.model));
  if (late_) name += tr(", updating…");
  canvas_.setCompared(answer_.picture, int(std::lround(share * width)), tr("captured"), name);
}

void RetextureBar::say(const QString& html) {
  if (words_->text() != html) words_->setText(html);
}

void RetextureBar::sayAnswer() {
  const auto line = [](const QColor& colour, const QString& text) {
    return QStringLiteral("<div style='color:%1'>%2</div>").arg(colour.name(), text.toHtmlEscaped());
  };
  const QColor faded = palette().color(QPalette::PlaceholderText);
  if (!answer_.result) return say(line(errorColour(), answer_.failure));
  QString html;
  for (const std::string& remark : answer_.result->remarks)
    html += line(remark.rfind("assumed", 0) == 0 ? faded : warningColour(), toQString(remark));
  for (const PredictedRadiance::OfLight& l : answer_.result->lights)
    html += line(faded, tr("%1, %2: %3, strength %4 %5 %6 of the largest code, from %7 views that differ by %8 %")
                            .arg(toQString(answer_.model), lightText(l.light), QLatin1String(nameOf(l.appearance.kind)))
                            .arg(l.appearance.strength(0), 0, 'f', 3)
                            .arg(l.appearance.strength(1), 0, 'f', 3)
                            .arg(l.appearance.strength(2), 0, 'f', 3)
                            .arg(l.appearance.views)
                            .arg(100 * l.appearance.spread, 0, 'f', 1));
  say(html);
}

void RetextureBar::addActions(Actions& actions, QMenu* menu) {
  toggle_ = actions.addToggle(
      "frame.retexture", menu, tr("&Retexture"), [this](bool on) { setOn(on); },
      {{Qt::Key_R}, "retexture", tr("The predicted highlight over another texture or background, or the frame without it")});
  for (int i = 0; i < base_->count(); ++i) {
    const QString base = base_->itemData(i).toString(), title = base_->itemText(i);
    actions.add(QStringLiteral("frame.retexture-") + base, menu, tr("Retexture: %1").arg(title),
                [this, base, title] { document_.setOption(kRetexture, base.toStdString(), tr("Retexture: %1").arg(title)); });
  }
  for (const char* const base : {"texture", "background"})
    actions.add(QStringLiteral("frame.retexture-choose-") + QLatin1String(base), menu,
                qstrcmp(base, "texture") == 0 ? tr("Choose te&xture…") : tr("Choose &background…"),
                [this, base] { chooseFile(QLatin1String(base)); });
  showControls();
}

}  // namespace glint::gui
