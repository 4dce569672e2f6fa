// SPDX-License-Identifier: BSD-3-Clause
#include "viz/plots/painting.h"

#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkPen.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>

namespace glint::viz {

void setText(vtkTextProperty* text, double size, const Colour& colour, bool bold) {
  if (!fontFile().empty()) {
    text->SetFontFamily(VTK_FONT_FILE);
    text->SetFontFile(fontFile().c_str());
  }
  text->SetFontSize(std::max(1, int(std::lround(size))));
  text->SetColor(colour[0], colour[1], colour[2]);
  text->SetBold(bold);
}

void setPainterText(vtkContext2D* painter, double size, const Colour& colour, bool bold) {
  vtkTextProperty* text = painter->GetTextProp();
  setText(text, size, colour, bold);
  text->SetOrientation(0);
  text->SetJustificationToLeft();
  text->SetVerticalJustificationToCentered();
}

int lineType(Dash dash) {
  return dash == Dash::Dashed ? vtkPen::DASH_LINE : dash == Dash::Dotted ? vtkPen::DOT_LINE : vtkPen::SOLID_LINE;
}

void setPen(vtkPen* pen, const Colour& colour, double width, double opacity) {
  pen->SetColorF(colour[0], colour[1], colour[2]);
  pen->SetOpacityF(opacity);
  pen->SetWidth(float(width));
  pen->SetLineType(width > 0 ? vtkPen::SOLID_LINE : vtkPen::NO_PEN);
}

void setBrush(vtkContext2D* painter, const Colour& colour, double opacity) {
  painter->GetBrush()->SetColorF(colour[0], colour[1], colour[2]);
  painter->GetBrush()->SetOpacityF(opacity);
}

std::string fitting(const std::string& title, const std::function<bool(const std::string&)>& fits) {
  if (fits(title)) return title;
  // Words go from the front: what is measured can be told from the plot's title, the unit of its numbers from nowhere else.
  const std::size_t unit = title.rfind(" (");
  if (unit == std::string::npos) return {};
  for (std::size_t at = title.find(' '); at != std::string::npos && at <= unit; at = title.find(' ', at + 1))
    if (const std::string part = title.substr(at + 1); fits(part)) return part;
  if (const std::size_t more = title.find(';', unit); more != std::string::npos)  // "(m; lowest = 0)"
    if (const std::string alone = title.substr(unit + 1, more - unit - 1) + ")"; fits(alone)) return alone;
  return {};
}

std::string wrapped(const std::string& sentence, int letters) {
  std::string out;
  int used = 0;
  for (std::size_t i = 0; i < sentence.size();) {
    const std::size_t end = std::min(sentence.find(' ', i), sentence.size());
    const int word = int(end - i);
    if (used > 0 && used + 1 + word > letters) out += '\n', used = 0;
    if (used > 0) out += ' ', ++used;
    out += sentence.substr(i, end - i);
    used += word;
    i = end + 1;
  }
  return out;
}

}  // namespace glint::viz
