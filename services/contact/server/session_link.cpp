#include "contact/server/session_link.hpp"

#include <chrono>
#include <cstring>

#include "contact/server/messages.hpp"
#include "fault/fault.hpp"
#include "log/log.hpp"

namespace tact::contact {
namespace {

constexpr std::chrono::milliseconds kPeriod{16};
constexpr std::uint32_t kOwnFaults = tact::bit(Fault::contacts_full) | tact::bit(Fault::sign_doubtful) |
                                     tact::bit(Fault::past_mid_surface) | tact::bit(Fault::beyond_band) |
                                     tact::bit(Fault::not_finite);
constexpr int kFaultTicks = 30;  // faults stay up for half a second, so that nobody misses a short one

}  // namespace

SessionLink::SessionLink(const Session& session, const Participant& low, HealthReporter& health,
                         const LoadedScene& loaded, ContactPipeline& pipeline, PoseServer& server,
                         const PipelineParams& params)
    : health_(health),
      loaded_(loaded),
      pipeline_(pipeline),
      server_(server),
      scene_(session.scene),
      params_(params),
      sets_(low),
      scenes_(low),
      acks_(low),
      requests_(low),
      snapshot_(std::make_unique<ContactSnapshot>()),
      items_(ContactSnapshot::kMax) {
  publish_scene();
}

void SessionLink::start() {
  thread_ = std::thread([this] { run(); });
}

void SessionLink::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void SessionLink::run() {
  auto next = std::chrono::steady_clock::now();
  std::uint32_t status = 0;
  for (int tick = 1; !stop_; ++tick) {
    take_parameters();
    publish_contacts();
    status |= server_.take_status();
    if (tick % kFaultTicks == 0) {
      health_.set_faults(kOwnFaults, faults_of(status));
      status = 0;
    }
    std::this_thread::sleep_until(next += kPeriod);
  }
}

void SessionLink::publish_contacts() {
  if (!server_.snapshots().read(*snapshot_)) return;
  wire::ContactSet set;
  to_wire(*snapshot_, process_epoch(), params_.law, items_, set);
  sets_.write(set);
}

void SessionLink::publish_scene() {
  wire::SceneInfo info;
  to_wire(loaded_, scene_, params_, process_epoch(), parts_, info);
  scenes_.write(info);
}

void SessionLink::take_parameters() {
  for (wire::Parameter request; requests_.take(request);) {
    if (std::strcmp(request.service, "contact") != 0) continue;
    wire::ParameterAck ack{};
    ack.schema = wire::kSchema;
    ack.writer_id = request.writer_id;
    ack.request_id = request.request_id;
    wire::set_text(ack.service, "contact");
    wire::set_text(ack.key, request.key);
    wire::set_text(ack.value, request.value);
    try {
      change(request.key, request.value);
      ack.accepted = true;
      log_info(request.key, " = ", request.value, ", parameters ", params_.version);
    } catch (const SetupError& e) {
      wire::set_text(ack.message, e.what());
    }
    ack.params_version = params_.version;
    acks_.write(ack);
  }
}

/// All or nothing.
void SessionLink::change(const std::string& key, const std::string& value) {
  if (key.rfind("contact.", 0) != 0 || key == "contact.capacity") {
    throw SetupError(key + ": cannot be changed while the contact server runs; change the scene file");
  }
  SceneSpec next = scene_;
  set_scene_key(next, key, value);
  const PipelineParams params =
      pipeline_params(next.contact, loaded_.field.voxel_m(), next.coupling.mass_kg, params_.version + 1);
  pipeline_.set_params(params);
  scene_ = next;
  params_ = params;
  publish_scene();
}

}  // namespace tact::contact
