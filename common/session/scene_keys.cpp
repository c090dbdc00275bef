#include "session/scene_keys.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tact::session {
namespace {

constexpr double kFar_m = 1e4;  // scenes from a millimetre to a kilometre pass, a forgotten unit mostly does not
constexpr const char* kNameRule = "1 to 24 of the characters a-z, 0-9 and -";

bool is_name(const std::string& s) {
  return !s.empty() && s.size() <= 24 && s.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == s.npos;
}

bool is_line(const std::string& s) {
  return s.size() <= 1000 && std::none_of(s.begin(), s.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

bool is_word(const std::string& s) {
  return !s.empty() && s.size() <= 64 && s.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == s.npos;
}

bool is_token(const std::string& s) {
  constexpr const char* kAllowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
  return s.size() >= 8 && s.size() <= 128 && s.find_first_not_of(kAllowed) == s.npos;
}

bool is_address(const std::string& s) {
  in6_addr a{};
  return ::inet_pton(AF_INET, s.c_str(), &a) == 1 || ::inet_pton(AF_INET6, s.c_str(), &a) == 1;
}

Key line(std::string name, std::string& member) {
  return text(std::move(name), member, "one line of text, 1000 bytes at most", is_line);
}

/// `access` gives the position to write to, `peek` one to read, or none.
Key position_key(std::string name, const std::function<Vec3&()>& access, const std::function<const Vec3*()>& peek) {
  return {std::move(name), Kind::numbers, "three numbers [x, y, z] within 10 km (m)",
          [access](const Value& v) {
            const auto* list = std::get_if<std::vector<double>>(&v);
            if (!list || list->size() != 3) return false;
            for (const double x : *list) {
              if (!(std::abs(x) <= kFar_m)) return false;
            }
            access() = {(*list)[0], (*list)[1], (*list)[2]};
            return true;
          },
          [peek]() -> std::optional<Value> {
            const Vec3* p = peek();
            if (!p) return std::nullopt;
            return std::vector<double>{p->x(), p->y(), p->z()};
          }};
}

Key rotation_key(std::string name, const std::function<Quat&()>& access, const std::function<const Quat*()>& peek) {
  return {std::move(name), Kind::numbers, "four numbers [w, x, y, z] of norm 1 within 0.001",
          [access](const Value& v) {
            const auto* list = std::get_if<std::vector<double>>(&v);
            if (!list || list->size() != 4) return false;
            Quat q((*list)[0], (*list)[1], (*list)[2], (*list)[3]);
            const double norm = q.norm();
            if (!(std::abs(norm - 1) <= 1e-3)) return false;
            if (std::abs(norm - 1) > 1e-12) q.normalize();  // what we saved reads back bit for bit
            access() = q;
            return true;
          },
          [peek]() -> std::optional<Value> {
            const Quat* q = peek();
            if (!q) return std::nullopt;
            return std::vector<double>{q->w(), q->x(), q->y(), q->z()};
          }};
}

/// The two keys of a pose. `access` gives the pose to write to (making it if need be); `peek` one to read, or none.
Keys pose_keys(const std::string& prefix, const std::function<Pose&()>& access,
               const std::function<const Pose*()>& peek) {
  return {position_key(
              prefix + "position_m", [access]() -> Vec3& { return access().p; },
              [peek]() -> const Vec3* { return peek() ? &peek()->p : nullptr; }),
          rotation_key(
              prefix + "rotation_wxyz", [access]() -> Quat& { return access().q; },
              [peek]() -> const Quat* { return peek() ? &peek()->q : nullptr; })};
}

Keys pose_keys(const std::string& prefix, Pose& pose) {
  return pose_keys(
      prefix, [&pose]() -> Pose& { return pose; }, [&pose] { return &pose; });
}

Keys body_keys(BodySpec& body, const std::filesystem::path& base) {
  Keys keys{text("shape", body.shape, "the name of a shape (common/shapes/README.md)", is_word),
            path("mesh", body.mesh, base, "a path to a mesh file"),
            choice("unit", body.unit, {"m", "mm", "cm", "inch"}),
            number("sheet_thickness_m", body.sheet_thickness_m, 0, 1, "m")};
  for (auto& [name, value] : body.shape_params) {
    keys.push_back(number("params." + name, value, -kFar_m, kFar_m, "m, or degrees where the name ends in _deg"));
  }
  return keys;
}

Keys contact_keys(ContactSpec& c) {
  return {choice("law", c.law, {"none", "global", "cluster", "adaptive-3dof", "adaptive-6dof", "potential"}),
          choice("force_along", c.force_along, {"gradient", "held", "normal"}),
          number("stiffness_n_per_m", c.stiffness_n_per_m, 0, 1e6, "N/m; 0: f_max_n over x_max"),
          number("f_max_n", c.f_max_n, 0.01, 200, "N"),
          number("x_max_voxels", c.x_max_voxels, 0.05, 4, "voxels"),
          number("damping_ratio", c.damping_ratio, 0, 2, "of critical"),
          number("epsilon", c.epsilon, 1e-6, 0.5, ""),
          integer("n0", c.n0, 1, 1000000),
          number("lever_unit_m", c.lever_unit_m, 0, kFar_m, "m; 0: unit torque directions"),
          number("cluster_voxels", c.cluster_voxels, 0.01, 4, "voxels"),
          choice("cluster_law", c.cluster_law, {"none", "global", "adaptive-3dof", "adaptive-6dof", "potential"}),
          number("p", c.p, 2, 64, ""),
          number("q", c.q, 1, 64, ""),
          number("reach_deg", c.reach_deg, 5, 180, "degrees"),
          integer("directions", c.directions, 32, 4096),
          integer("capacity", c.capacity, 16, 1 << 20)};
}

Keys coupling_keys(CouplingSpec& c) {
  Keys keys{choice("kind", c.kind, {"direct", "static", "dynamic"}),
            choice("integrator", c.integrator, {"auto", "implicit", "semi-implicit"}),
            flag("saturation", c.saturation),
            flag("passivity_controller", c.passivity_controller),
            number("stiffness_n_per_m", c.stiffness_n_per_m, 1, 1e5, "N/m"),
            number("damping_ratio", c.damping_ratio, 0, 5, "of critical"),
            number("stiffness_nm_per_rad", c.stiffness_nm_per_rad, 0, 1e4, "Nm/rad; 0: from the radius of gyration"),
            number("torque_max_nm", c.torque_max_nm, 0, 20, "Nm; 0: f_max_n times the radius of gyration"),
            number("mass_kg", c.mass_kg, 0.001, 20, "kg")};
  keys.push_back({"rotation", Kind::text, "one of free locked",
                  [&c](const Value& v) {
                    const auto* s = std::get_if<std::string>(&v);
                    if (!s || (*s != "free" && *s != "locked")) return false;
                    c.rotation_locked = *s == "locked";
                    return true;
                  },
                  [&c] { return std::optional<Value>{std::string{c.rotation_locked ? "locked" : "free"}}; }});
  return keys;
}

Keys virtuose_keys(VirtuoseSpec& v, const std::filesystem::path& base) {
  // A bare name is the loader's to find; anything else is a path.
  Key library = text("library", v.library, "a path to the vendor's library, or its file name",
                     [](const std::string& s) { return is_line(s); });
  library.set = [set = std::move(library.set), base](const Value& value) {
    const auto* s = std::get_if<std::string>(&value);
    if (!s || s->find('/') == s->npos) return set(value);
    return set(Value{(base / *s).lexically_normal().string()});
  };
  return prefixed("device.", {std::move(library),
                              text("address", v.address, "host#port of the arm's controller or its local service",
                                   [](const std::string& s) { return !s.empty() && is_line(s); }),
                              number("timeout_s", v.timeout_s, 0.001, 0.05, "s"),
                              number("stale_after_s", v.stale_after_s, 0, 10, "s; 0: never"),
                              number("force_factor", v.force_factor, 0.01, 1, ""),
                              number("speed_factor", v.speed_factor, 0.1, 10, ""),
                              choice("indexing", v.indexing, {"all", "translation", "rotation", "none"}),
                              number("spring_n_per_m", v.spring_n_per_m, 0, 1e4, "N/m; 0: chosen by rule"),
                              number("spring_nm_per_rad", v.spring_nm_per_rad, 0, 100, "Nm/rad; 0: chosen by rule"),
                              number("damper_n_s_per_m", v.damper_n_s_per_m, 0, 500, "N s/m; 0: chosen by rule"),
                              number("damper_nm_s_per_rad", v.damper_nm_s_per_rad, 0, 10, "Nm s/rad; 0: by rule")});
}

}  // namespace

void make_room(SceneSpec& scene, const std::string& key) {
  const auto rest_after = [&key](const std::string& prefix) {
    return key.rfind(prefix, 0) == 0 ? key.substr(prefix.size()) : std::string{};
  };
  if (const auto name = rest_after("obstacle.params."); is_word(name)) scene.obstacle.shape_params.try_emplace(name);
  if (const auto name = rest_after("tool.params."); is_word(name)) scene.tool.shape_params.try_emplace(name);
  if (const auto rest = rest_after("scripts."); !rest.empty()) {
    const auto name = rest.substr(0, rest.find('.'));
    if (is_name(name) && name.size() < rest.size()) scene.scripts.try_emplace(name);
  }
}

Keys scene_keys(SceneSpec& scene, const std::filesystem::path& base) {
  Keys keys{text("name", scene.name, kNameRule, is_name), line("title", scene.title)};
  append(keys, prefixed("obstacle.", body_keys(scene.obstacle, base)));
  append(keys, {integer("obstacle.field_cells", scene.field_resolution, 16, 4096),
                number("obstacle.field_error_mm", scene.field_error_mm, 0, 1000, "mm; 0: field_cells counts")});
  append(keys, pose_keys("obstacle.", scene.X_WO));
  append(keys, prefixed("tool.", body_keys(scene.tool, base)));
  append(keys, {integer("tool.points", scene.points, 100, 1000000),
                number("tool.spacing_voxels", scene.spacing_voxels, 0, 1000, "voxels of the field; 0: points counts"),
                integer("tool.levels", scene.levels, 1, 16)});
  append(keys, pose_keys("start.", scene.start_X_WM));
  append(keys,
         pose_keys(
             "goal.", [&scene]() -> Pose& { return scene.goal_X_WM ? *scene.goal_X_WM : scene.goal_X_WM.emplace(); },
             [&scene]() -> const Pose* { return scene.goal_X_WM ? &*scene.goal_X_WM : nullptr; }));
  append(keys, {number("goal.distance_mm", scene.goal_distance_mm, 0.001, 1000, "mm"),
                number("goal.angle_deg", scene.goal_angle_deg, 0.01, 180, "degrees")});
  append(keys, prefixed("contact.", contact_keys(scene.contact)));
  append(keys, prefixed("coupling.", coupling_keys(scene.coupling)));
  for (auto& [name, script] : scene.scripts) {
    append(keys,
           prefixed("scripts." + name + ".", {path("hand", script.hand_csv, base, "a path to a CSV file of poses"),
                                              line("description", script.description),
                                              number("hand_force_max_n", script.hand_force_max_n, 0.1, 200, "N")}));
  }
  return keys;
}

static Keys keys_of_every_machine(MachineSpec& m, const std::filesystem::path& base) {
  return {choice("device.driver", m.device, {"simulated", "playback", "virtuose"}),
          choice("device.mode", m.mode, {"pseudo-admittance", "impedance"}),
          number("device.rate_hz", m.rate_hz, 100, 5000, "Hz"),
          path("device.recording", m.recording, base, "a path to a recording (tact run --record)"),
          path("device.events", m.simulated.events, base, "a path to a CSV file of faults and grips"),
          number("device.hand.tremor_n", m.simulated.tremor_n, 0, 10, "N"),
          number("device.hand.tremor_hz", m.simulated.tremor_hz, 8, 12, "Hz"),
          integer("device.hand.seed", m.simulated.seed, 0, 1000000),
          choice("device.hand.grip", m.simulated.grip, {"normal", "soft", "stiff", "absent"}),
          number("device.arm.coulomb_n", m.simulated.coulomb_n, 0, 10, "N"),
          number("device.arm.force_continuous_n", m.simulated.force_continuous_n, 0, 200, "N; 0: as its peak"),
          number("device.arm.thermal_s", m.simulated.thermal_s, 0.1, 3600, "s"),
          number("device.arm.workspace_m", m.simulated.workspace_m, 0, 10, "m; 0: none"),
          number("device.arm.quantum_m", m.simulated.quantum_m, 0, 0.01, "m"),
          number("device.arm.quantum_rad", m.simulated.quantum_rad, 0, 0.1, "rad"),
          integer("device.arm.delay_ticks", m.simulated.delay_ticks, 0, 20),
          number("device.workspace_scale", m.workspace_scale, 0.01, 100, "tool motion over handle motion"),
          position_key(
              "device.base_position_m", [&m]() -> Vec3& { return m.p_WB ? *m.p_WB : m.p_WB.emplace(); },
              [&m]() -> const Vec3* { return m.p_WB ? &*m.p_WB : nullptr; }),
          rotation_key(
              "device.base_rotation_wxyz", [&m]() -> Quat& { return m.q_WB; }, [&m] { return &m.q_WB; }),
          choice("transport", m.transport, {"shm", "udp"}),
          number("gate.force_limit_n", m.force_limit_n, 0.1, 200, "N"),
          number("gate.torque_limit_nm", m.torque_limit_nm, 0.01, 20, "Nm"),
          number("gate.force_slope_n_per_s", m.force_slope_n_per_s, 1, 1e6, "N/s"),
          number("gate.torque_slope_nm_per_s", m.torque_slope_nm_per_s, 0.1, 1e5, "Nm/s"),
          integer("cpu.coupling", m.cpu_coupling, -1, 1023),
          integer("cpu.contact", m.cpu_contact, -1, 1023),
          flag("view.enabled", m.view),
          integer("view.port", m.port, 0, 65535),
          text("view.bind", m.bind, "an IPv4 or IPv6 address such as 127.0.0.1", is_address),
          text("view.token", m.token, "8 to 128 letters, digits, - or _", is_token),
          path("cache.dir", m.cache_dir, base, "a path to a folder")};
}

Keys machine_keys(MachineSpec& m, const std::filesystem::path& base) {
  Keys keys = keys_of_every_machine(m, base);
  append(keys, virtuose_keys(m.virtuose, base));
  return keys;
}

Keys run_keys(RunSpec& run, const std::filesystem::path& base) {
  // Script and hand move the same hand: the last one said holds.
  const auto instead_of = [](auto& other, Key key) {
    key.set = [set = std::move(key.set), &other](const Value& v) {
      const bool good = set(v);
      if (good) other.clear();
      return good;
    };
    return key;
  };
  return {instead_of(run.hand_csv, text("run.script", run.script, "the name of a script of the scene, or \"\" for none",
                                        [](const std::string& s) { return s.empty() || is_name(s); })),
          instead_of(run.script, path("run.hand", run.hand_csv, base, "a path to a CSV file of poses")),
          duration("run.for_s", run.for_s, 1e6, "0: no end of its own"),
          path("run.report", run.report, base, "a path to a JSON file"),
          path("run.plot", run.plot, base, "a path to a PNG file"),
          path("run.record", run.record, base, "a path to a file")};
}

Keys session_keys(Session& s, const std::filesystem::path& base) {
  Keys keys{text("name", s.name, kNameRule, is_name)};
  // Text, not a number: TOML integers stop at 2^63 - 1.
  keys.push_back({"id", Kind::text, "a whole number as text",
                  [&s](const Value& v) {
                    const auto* t = std::get_if<std::string>(&v);
                    if (!t || t->empty()) return false;
                    std::uint64_t id = 0;
                    const auto [end, error] = std::from_chars(t->data(), t->data() + t->size(), id);
                    if (error != std::errc{} || end != t->data() + t->size()) return false;
                    s.id = id;
                    return true;
                  },
                  [&s] { return std::optional<Value>{std::to_string(s.id)}; }});
  append(keys, {path("run_dir", s.run_dir, base, "a path to a folder"),
                path("scene_file", s.scene.file, base, "a path to a scene file"),
                path("machine_file", s.machine.file, base, "a path to a machine file")});
  append(keys, prefixed("scene.", scene_keys(s.scene, base)));
  append(keys, prefixed("machine.", machine_keys(s.machine, base)));
  append(keys, run_keys(s.run, base));
  return keys;
}

}  // namespace tact::session
