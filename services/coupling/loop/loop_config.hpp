#pragma once
#include "coupling/dynamics/tool_integrator.hpp"
#include "coupling/loop/loop_parameters.hpp"
#include "coupling/loop/workspace_mapping.hpp"
#include "coupling/safety/gate.hpp"

namespace tact::coupling {

struct LoopConfig {
  double rate_hz = 1000;
  ToolIntegrator::Params tool;
  LoopParameters parameters;
  GateLimits gate;  ///< springs are the device's: taken from its capabilities
  WorkspaceMapping::Params mapping;
  Pose X_WT_start, X_WO, X_TM;
  double gyration_radius_m = 0.03;
  double tool_radius_m = 0.1;  ///< farthest point from To
  double voxel_m = 1e-3;
  double force_max_n = 10;  ///< F_max = k x_max until the first reply says otherwise
  double status_period_s = 0.016;
  /// Direct coupling in impedance waits for the wrench of the tick's own pose, at most this part of a period.
  double reply_wait_share = 0.4;
};

}  // namespace tact::coupling
