#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "session/session.hpp"

namespace tact::cli {

/// One setting of the command line, as typed: "--law" "contact.law" "global".
struct Setting {
  std::string option, key, value;
};

/// What `tact run` was told. Empty: not said.
struct RunOptions {
  std::string scene, session, unit;
  std::filesystem::path machine_file, obstacle, tool;
  std::vector<Setting> settings;        ///< in the order typed
  std::filesystem::path write_session;  ///< write the session file here and do not run
};

/// The session these options describe: scene and machine files, then the settings on top. run_dir and a port of 0 are
/// left to whoever runs it. Throws SetupError naming the option or the key.
Session resolve(const RunOptions& options);

/// The machine file stated, or this machine's, /etc/tact/machine.toml, or none. Throws SetupError.
void load_machine_file(const std::filesystem::path& stated, Session& session);

/// Sets the key; error texts begin with the option.
void apply(const Setting& setting, Session& session);

/// KEY=VALUE of --set. Throws SetupError.
Setting parse_set(const std::string& text);

}  // namespace tact::cli
