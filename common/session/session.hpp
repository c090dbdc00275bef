#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "math/pose.hpp"

namespace tact {

/// Geometry of a body: a parametric shape made by the project, or a mesh file of the user's. Exactly one of the two.
struct BodySpec {
  std::string shape;                           ///< "alpha", "box", "cone", ...: see shapes.hpp; empty: a mesh
  std::map<std::string, double> shape_params;  ///< metres, degrees where the name ends in _deg
  std::filesystem::path mesh;                  ///< absolute once loaded
  std::string unit;                            ///< "m", "mm", "cm", "inch": required with mesh
  double sheet_thickness_m = 0;                ///< thickness given to zero-thickness sheets; 0: none expected
};

struct ContactSpec {
  std::string law = "potential";  ///< none global cluster adaptive-3dof adaptive-6dof potential
  /// "gradient": forces along the field's gradient, conservative. "held": the same, held by thin parts. "normal": along
  /// the point's normal, [P] eq. 1.
  std::string force_along = "gradient";
  double stiffness_n_per_m = 0;  ///< k; 0: f_max_n / x_max_m. Above 0 it holds, and F_max = k x_max
  double f_max_n = 10;           ///< F_max = k x_max (eq. 15)
  double x_max_voxels = 0.5;
  double damping_ratio = 0;  ///< contact damping, fraction of critical at the tool's mass
  double epsilon = 0.01;     ///< eq. 6
  int n0 = 10;               ///< eq. 2
  double lever_unit_m = 0;   ///< adaptive-6dof: 0: eq. 10; else eq. 13, r x N over this
  double cluster_voxels = 0.5;
  std::string cluster_law = "adaptive-6dof";  ///< weighs the clusters: any law but cluster
  double p = 16, q = 8;                       ///< potential
  double reach_deg = 60;
  int directions = 64;
  int capacity = 16384;
};

struct CouplingSpec {
  std::string kind = "dynamic";     ///< direct static dynamic
  std::string integrator = "auto";  ///< implicit semi-implicit; auto: implicit, where something is integrated
  bool saturation = true;
  bool passivity_controller = false;
  double stiffness_n_per_m = 2000, damping_ratio = 1.0;  ///< virtual coupling, translation
  double stiffness_nm_per_rad = 0;                       ///< 0: stiffness_n_per_m * gyration radius^2
  double torque_max_nm = 0;                              ///< 0: F_max * gyration radius
  double mass_kg = 0.2;                                  ///< of the tool; the handle's is equal
  bool rotation_locked = false;
};

/// A hand motion: rows of time_s,x_m,y_m,z_m,qw,qx,qy,qz; poses X_WM of the tool's mesh frame. The last is the goal.
struct HandMotion {
  std::vector<double> time_s;  ///< strictly increasing from >= 0
  std::vector<Pose> X_WM;
};

struct ScriptSpec {
  std::filesystem::path hand_csv;
  std::string description;
  double hand_force_max_n = 20;  ///< peak of the simulated hand
};

struct SceneSpec {
  std::string name, title;
  std::filesystem::path file;
  BodySpec obstacle, tool;
  int field_resolution = 256;  ///< cells along the longest side of the obstacle
  double field_error_mm = 0;   ///< > 0: as many cells as keep the field's error below this at random samples, instead
  int points = 10000;
  double spacing_voxels = 0;  ///< > 0: as many points as lie this far apart, in voxels of the field, instead
  int levels = 7;
  Pose X_WO;
  Pose start_X_WM;
  std::optional<Pose> goal_X_WM;
  double goal_distance_mm = 2, goal_angle_deg = 5;  ///< reached within
  ContactSpec contact;
  CouplingSpec coupling;
  std::map<std::string, ScriptSpec> scripts;
};

/// The `virtuose` device: how its vendor's library is found and told to behave.
struct VirtuoseSpec {
  std::string library;                      ///< path, or a name for the loader; empty: the two names it is known by
  std::string address = "127.0.0.1#53210";  ///< as virtOpen takes it: host#port
  double timeout_s = 0.02;                  ///< the library's, of one call
  double stale_after_s = 0.25;              ///< held, and not one bit changes for so long: lost
  double force_factor = 1;                  ///< hand force over simulation force
  double speed_factor = 1;                  ///< simulation motion over hand motion
  std::string indexing = "all";             ///< all translation rotation none
  /// Pseudo-admittance: the spring and damper its controller keeps between handle and set-point; 0: chosen by rule
  double spring_n_per_m = 0, spring_nm_per_rad = 0, damper_n_s_per_m = 0, damper_nm_s_per_rad = 0;
};

/// What the simulated device has beyond a perfect arm and a steady hand; 0 and empty: nothing.
struct SimulatedSpec {
  std::filesystem::path events;  ///< CSV of faults and grips
  double tremor_n = 0, tremor_hz = 10;
  int seed = 1;
  std::string grip = "normal";  ///< normal soft stiff absent
  double coulomb_n = 0;
  double force_continuous_n = 0, thermal_s = 20;
  double workspace_m = 0;
  double quantum_m = 0, quantum_rad = 0;
  int delay_ticks = 0;
};

/// What belongs to the machine, not to the scene.
struct MachineSpec {
  std::filesystem::path file;
  std::string device = "simulated";        ///< simulated playback virtuose
  std::string mode = "pseudo-admittance";  ///< or impedance
  double rate_hz = 1000;
  double workspace_scale = 1;    ///< motion of the tool over motion of the handle
  Quat q_WB = Quat::Identity();  ///< the device's base in the world
  std::optional<Vec3> p_WB;      ///< nothing: the handle is taken to be at the tool's start
  VirtuoseSpec virtuose;
  std::filesystem::path recording;  ///< playback: whose readings it gives
  SimulatedSpec simulated;
  std::string transport = "shm";                                   ///< or udp
  double force_limit_n = 30, torque_limit_nm = 3;                  ///< gate
  double force_slope_n_per_s = 5000, torque_slope_nm_per_s = 500;  ///< gate
  int cpu_coupling = -1, cpu_contact = -1;                         ///< -1: any
  bool view = true;
  int port = 8080;
  std::string bind = "127.0.0.1";
  std::string token;                ///< empty: made at start
  std::filesystem::path cache_dir;  ///< empty: $TACT_CACHE, $XDG_CACHE_HOME/tact, ~/.cache/tact
};

/// How this run of the scene goes. A scene file, a machine file and the command line may each say so: the last one
/// holds.
struct RunSpec {
  std::string script;              ///< of the scene; empty: none
  std::filesystem::path hand_csv;  ///< own motion in place of a script; empty: none. Its last pose is the goal
  double for_s = 0;                ///< ends by itself after this time in contact service; 0: it does not
  std::filesystem::path report;    ///< JSON, written at the end; empty: none
  std::filesystem::path plot;      ///< PNG, written at the end; empty: beside the report
  std::filesystem::path record;    ///< every tick of the device loop goes there; empty: none
  std::filesystem::path said_in;   ///< the file whose script or hand holds, for messages; empty: the command line
};

/// Everything a service needs to know: written by `tact run` to <run_dir>/session.toml, read by each service.
struct Session {
  std::string name;  ///< [a-z0-9-]{1,24}: topics, shared-memory prefix, run directory
  std::uint64_t id = 0;
  std::filesystem::path run_dir;
  SceneSpec scene;
  MachineSpec machine;
  RunSpec run;
};

/// All throw SetupError "<file>: <key>: found <what>, expected <what>" on unreadable files, unknown keys, wrong types,
/// impossible values. Relative paths are relative to the file that names them. Keys: README.md.
/// Scene and machine files may hold [run] keys too: they go to session.run, over what it holds, and a script is to be
/// one of session.scene. So the scene comes first.
void load_scene(const std::filesystem::path& path, Session& session);
void load_machine(const std::filesystem::path& path, Session& session);
SceneSpec load_scene(const std::filesystem::path& path);  ///< its [run] keys checked, and dropped
Session load_session(const std::filesystem::path& path);
void save_session(const Session& session, const std::filesystem::path& path);  ///< load_session reads the same back
HandMotion load_hand_motion(const std::filesystem::path& csv);

/// Sets one key as on the command line or in a Parameter message ("contact.law" = "global"); flags are on/off or
/// true/false, lists "x,y,z", relative paths are taken from the current folder. Throws SetupError "<key>: found ...,
/// expected ..." and changes nothing.
void set_key(Session& session, const std::string& key, const std::string& value);  ///< of scene, machine or run
void set_scene_key(SceneSpec& scene, const std::string& key, const std::string& value);

/// The rules between keys: one of shape and mesh, a unit with every mesh, files and scripts that exist. What is loaded
/// has been checked; whoever sets keys calls this once at the end. Throws as above.
void check_session(const Session& session);

/// The rule between device mode and coupling: an integrator is stated only where something is integrated. check_session
/// asks it; so does whoever changes one of the keys while the session runs. Throws SetupError as above.
void check_coupling(const CouplingSpec& coupling, const MachineSpec& machine);

/// What moves the simulated hand: the script run.script, or run.hand as one; nothing: the mouse only.
std::optional<ScriptSpec> scripted_hand(const Session& session);

/// Scenes that come with the program, sorted; and the file of one: "alpha" is <share>/scenes/alpha.toml, anything with
/// a slash or ending in .toml is a path. Throws SetupError naming the scenes there are.
std::vector<std::filesystem::path> scene_files();
std::filesystem::path find_scene(const std::string& name_or_path);

/// <prefix>/share/tact of the running program, build tree or installed: scenes/, dds/, roudi.toml, page/. The prefix is
/// the nearest folder above the program that holds share/tact.
std::filesystem::path share_dir();
/// <prefix>/libexec/tact
std::filesystem::path libexec_dir();
/// Where baked files are kept (see MachineSpec::cache_dir); not made here.
std::filesystem::path cache_dir(const MachineSpec& machine);

}  // namespace tact
