// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/app/session.h"
#include "core/base/progress.h"

namespace glint {

/// How an input is read, and where the files of a scene are that are not where it says; the same for every program that reads
/// one. Failures name the options of the command line.
struct ScenePlaces {
  bool allowOutside = false;
  std::vector<std::string> photographs;  ///< folders
  std::vector<std::string> files;        ///< KIND=DIR
  std::vector<std::string> mesh;         ///< NAME=FILE
  std::vector<std::string> meshFolders;
  std::map<std::string, std::string> reading;  ///< how a capture of another program is read: texts of choiceOptions(), by flag

  /// What `reading` says. InputError.
  InputChoices choices() const;
  /// A scene, or that of a session. InputError, also for a flag that the scene has no use for.
  Scene read(const std::string& input) const;
  OpenedSession openSession(const std::string& file) const;
  Replay replay(Session session, const ProgressFn& progress) const;
  /// A session whose request is used without its scene. OutsidePath as `openSession` if the request names a truth folder.
  Session readRequestOf(const std::string& file, bool withItsTruth) const;

 private:
  Relinked relinked() const;
  void lookIn(Scene& scene, FrameFile kind, const std::string& folder, const std::string& given) const;
  void check(Scene& scene) const;
};

/// OutsidePath if the truth folder that the session's request names lies in no folder that the session may name, and the
/// session has no right to others (`allowOutsidePaths`).
void requirePermittedTruth(const Session& session, const Relinked& instead);

}  // namespace glint
