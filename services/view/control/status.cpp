#include "view/control/status.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "fault/fault.hpp"

namespace tact::view {
namespace {

using Json = nlohmann::json;

struct Words {
  Fault fault;
  const char* text;
};
constexpr std::array<Words, 17> kWords{{
    {Fault::wrench_late, "Contact force late: extrapolating"},
    {Fault::wrench_stale, "No contact force: the arm is calm"},
    {Fault::contacts_full, "More contacts than capacity: the deepest count"},
    {Fault::not_finite, "A value that is not a number was stopped"},
    {Fault::deadline_missed, "The device loop missed a tick"},
    {Fault::motion_capped, "Motion cut: too fast for one tick"},
    {Fault::gate_limited, "Output limited by the gate"},
    {Fault::transport_degraded, "Transport degraded"},
    {Fault::device_lost, "Device lost"},
    {Fault::device_alarm, "Device alarm"},
    {Fault::device_data, "Device data refused"},
    {Fault::watchdog, "The watchdog cut power"},
    {Fault::sign_doubtful, "Inside or outside is doubtful here"},
    {Fault::past_mid_surface, "Past the middle of a thin part"},
    {Fault::beyond_band, "Deeper than the stored field"},
    {Fault::peer_restarted, "A service was restarted"},
    {Fault::scene_changed, "The scene changed: restart the session"},
}};

const ServiceHealth* find(const ViewScene& scene, const std::string& service) {
  const auto found = std::find_if(scene.health.begin(), scene.health.end(),
                                  [&](const ServiceHealth& h) { return h.service == service; });
  return found == scene.health.end() ? nullptr : &*found;
}

std::string service_event(const std::string& service, const std::string& phase, const std::string& detail) {
  return Json{{"type", "service"}, {"service", service}, {"phase", phase}, {"detail", detail}}.dump(
      -1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::vector<std::string> fault_words(std::uint32_t faults) {
  std::vector<std::string> words;
  for (const Words& word : kWords) {
    if ((faults & bit(word.fault)) != 0) words.emplace_back(word.text);
  }
  return words;
}

std::string status_json(const ViewScene& scene, const ViewerNumbers& numbers) {
  const DeviceState& d = scene.device;
  Json services = Json::array();
  for (const ServiceHealth& h : scene.health) {
    services.push_back({{"service", h.service}, {"phase", h.phase}, {"detail", h.detail}, {"progress", h.progress}});
  }
  const double penetration_mm = 1e3 * d.max_depth_m;
  const Json json{
      {"type", "status"},
      {"scene", scene.info.name},
      {"law", scene.info.law},
      {"k_n_per_m", scene.info.stiffness_n_per_m},
      {"saturation", scene.info.saturation},
      {"coupling", scene.info.coupling},
      {"points", scene.info.points},
      {"voxel_mm", 1e3 * scene.info.voxel_m},
      {"contacts", d.contact_count},
      {"penetration_mm", penetration_mm},
      {"penetration_voxels", scene.info.voxel_m > 0 ? d.max_depth_m / scene.info.voxel_m : 0},
      {"force_n", d.F_contact_W.force.norm()},
      {"torque_nm", d.F_contact_W.torque.norm()},
      {"hand_force_n", d.F_hand_W.force.norm()},
      {"net_stiffness_n_per_m", d.net_stiffness_n_per_m},
      {"tick_us", d.tick_us_max},
      {"round_trip_us", d.round_trip_us},
      {"script_s", d.script_time_s},
      {"script_done", d.script_done},
      {"engaged", d.engaged},
      {"capped", d.capped},
      {"device", d.device},
      {"mode", d.mode},
      {"age_s", scene.age_s},
      {"faults", fault_words(d.faults)},
      {"faults_ever", fault_words(d.faults_ever)},
      {"services", services},
      {"holder", numbers.holder},
      {"viewers", numbers.viewers},
      {"frames_per_s", numbers.frames_per_s},
      {"cpu_ms_per_frame", numbers.cpu_ms_per_frame},
  };
  return json.dump(-1, ' ', false,
                   Json::error_handler_t::replace);  // names come over the wire: never throw on bad UTF-8
}

std::vector<std::string> change_events(const ViewScene& before, const ViewScene& now) {
  std::vector<std::string> events;
  for (const ServiceHealth& h : now.health) {
    const ServiceHealth* old = find(before, h.service);
    if (old == nullptr || old->phase != h.phase) events.push_back(service_event(h.service, h.phase, h.detail));
  }
  for (const ServiceHealth& h : before.health) {
    if (find(now, h.service) == nullptr) events.push_back(service_event(h.service, "gone", ""));
  }
  const std::uint32_t began = now.device.faults & ~before.device.faults,
                      ended = before.device.faults & ~now.device.faults;
  for (const std::string& words : fault_words(began))
    events.push_back(Json{{"type", "fault"}, {"on", true}, {"words", words}}.dump());
  for (const std::string& words : fault_words(ended))
    events.push_back(Json{{"type", "fault"}, {"on", false}, {"words", words}}.dump());
  return events;
}

}  // namespace tact::view
