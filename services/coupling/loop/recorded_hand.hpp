#pragma once
#include <filesystem>

#include "coupling/device/open_device.hpp"

namespace tact::coupling {

struct RecordingWanted {
  std::filesystem::path file;
  std::string mode;
  double rate_hz = 1000;
  std::uint64_t field_hash = 0, shell_hash = 0;  ///< of the scene now; 0: not asked
};

/// Reads what the device of a recorded session gave into `options`, for the playback device: 0.4 kB a tick. Returns
/// X_WT where that session began. Throws SetupError, one sentence, when the file is missing, foreign, of another
/// schema, mode, rate or scene, begins in mid-session, holds no tick, or has a gap.
Pose use_recording(const RecordingWanted& wanted, DeviceOptions& options);

}  // namespace tact::coupling
