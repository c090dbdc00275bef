#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "math/pose.hpp"
#include "view/model/history.hpp"

namespace tact::view {

/// What is loaded, as the contact server says. Empty name: no server heard yet.
struct SceneInfo {
  std::string name;
  std::uint64_t server_epoch = 0;  ///< changes when the server restarts: bodies must be loaded again
  std::string field_path, obstacle_mesh_path, tool_mesh_path;
  std::uint64_t field_hash = 0;
  double voxel_m = 0;
  std::uint32_t points = 0;
  Pose X_TM, X_WO;
  double tool_radius_m = 0;  ///< farthest shell point from To
  std::string law;
  double stiffness_n_per_m = 0, x_max_m = 0;
  bool saturation = true;
  std::string coupling;  ///< kind: direct, static, dynamic
};

struct Contact {
  Vec3 p_W, N_W;  ///< N: unit inward normal of the tool
  Vec3 force_W;   ///< N, of the field body on the tool
  double depth_m = 0, weight = 0;
};

/// The newest contact set, at the poses it was computed at.
struct ContactSet {
  std::uint64_t pose_seq = 0;
  Pose X_WT, X_WO;
  Wrench F_W;                     ///< on the tool about To
  std::uint32_t total_count = 0;  ///< before truncation
  std::vector<Contact> contacts;
};

struct DeviceState {
  std::uint64_t epoch = 0, tick = 0;
  Pose X_WH, X_WT, X_WM;
  Wrench F_contact_W, F_hand_W;
  std::uint32_t contact_count = 0;
  double max_depth_m = 0, net_stiffness_n_per_m = 0, tick_us_max = 0, round_trip_us = 0;
  double script_time_s = -1;
  bool script_done = false, engaged = false, capped = false;
  std::uint32_t faults = 0, faults_ever = 0;
  std::string device, mode;
};

/// One service as it speaks of itself.
struct ServiceHealth {
  std::string service, phase, detail;
  double progress = -1;
  std::uint32_t faults = 0;
};

/// Everything there is to look at: plain data, the newest of each kind. Made by the feed, read by the pictures.
struct ViewScene {
  SceneInfo info;
  ContactSet contact_set;
  DeviceState device;
  History history;
  std::vector<ServiceHealth> health;  ///< at most one entry a service
  double age_s = -1;                  ///< since the newest DeviceState; < 0: none yet
};

}  // namespace tact::view
