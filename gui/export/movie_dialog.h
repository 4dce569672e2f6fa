// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>

#include "viz/movie.h"

class QComboBox;
class QLabel;

namespace glint::gui {

class NumberBox;

enum class MovieOf { FrameView, LookThrough, Turntable };

struct MovieLook {
  MovieOf of = MovieOf::FrameView;
  viz::MovieFormat format;
  int frames = 1;  ///< pictures of the movie
  bool dark = true;
};

/// Asks what a movie shows, how large and how fast. Remembers the last answer.
class MovieDialog : public QDialog {
  Q_OBJECT
 public:
  /// @param frames  of the scene.
  MovieDialog(MovieOf of, int frames, bool dark, QWidget* parent);
  MovieLook look() const;
  void accept() override;

 private:
  void showKind();
  void showLength();

  int sceneFrames_;
  QComboBox *of_, *size_, *colours_;
  NumberBox *width_, *height_;
  NumberBox *rate_, *seconds_;
  QLabel* length_;
};

}  // namespace glint::gui
