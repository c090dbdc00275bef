#include "coupling/link/contact_link.hpp"

#include <utility>

#include "coupling/link/messages.hpp"
#include "fault/fault.hpp"
#include "log/log.hpp"

namespace tact::coupling {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr std::int64_t kWaitNs = 20'000'000;  // how often the threads look at `stop`
constexpr milliseconds kSilence{500};         // matched, poses sent, no reply: rebuild
constexpr milliseconds kSurelyAlive{300};     // Health heard more recently: not killed when silence began
constexpr seconds kReconnectLimit{2};         // to a server that is ready: then something is stuck
constexpr seconds kConnectLimit{10};          // the first time: discovery on a busy machine

std::int64_t now_ns() noexcept { return steady_clock::now().time_since_epoch() / std::chrono::nanoseconds{1}; }

}  // namespace

ContactLink::ContactLink(const Session& session, const Participant& low, HealthReporter& health, Mailboxes& mail,
                         const Params& params)
    : transport_(session.machine.transport),
      session_id_(session.id),
      epoch_(process_epoch()),
      params_(params),
      health_(health),
      mail_(mail),
      haptic_(wire::Channel::haptic, session,
              {.priority = params.priority > 0 ? kTransportPriority : 0, .cpu = params.cpu}),
      monitor_(low),
      connector_(haptic_, transport_, health_, monitor_) {}

void ContactLink::start() {
  waiting_since_ = transport_checked_ = steady_clock::now();
  supervisor_ = std::thread([this] { supervise(); });
}

void ContactLink::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  if (supervisor_.joinable()) supervisor_.join();
}

bool ContactLink::stopping() {
  const std::scoped_lock lock(mutex_);
  return stop_;
}

bool ContactLink::wait_active(milliseconds limit) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, limit, [this] { return status_.active || status_.refused; });
  if (status_.refused) throw SetupError(*status_.refused);
  return status_.active;
}

ContactLink::Status ContactLink::status() const {
  const std::scoped_lock lock(mutex_);
  return status_;
}

void ContactLink::supervise() {
  while (!stopping()) {
    check_transport();
    if (!connection_) {
      try {
        if (auto ends = connector_.poll()) {
          connect(std::move(ends));
        } else {
          report_waiting();
        }
      } catch (const SetupError& e) {
        refuse(e.what());
        break;
      }
      continue;
    }
    monitor_.poll(kWaitNs);
    const bool active = connection_->proven.load(std::memory_order_acquire);
    const std::int64_t silent_ns = now_ns() - connection_->reply_ns.load(std::memory_order_relaxed);
    if (sender_->hung()) {
      lose("a write to the contact server hangs");
    } else if (!connector_.peer_alive()) {
      lose("the contact server is gone");
    } else if (connection_->refused) {
      continue;
    } else if (active && !status().active && !check_proof()) {
      continue;
    } else if (active && connection_->sent.load(std::memory_order_relaxed) > 20 &&
               silent_ns > std::chrono::nanoseconds{kSilence}.count() && connector_.peer_alive(kSurelyAlive)) {
      lose("the contact server is matched but silent");
    }
  }
  if (connection_) lose("stopping");
}

void ContactLink::connect(std::shared_ptr<CouplingEnds> ends) {
  connection_ = std::make_shared<Connection>();
  connection_->ends = std::move(ends);
  connection_->server_epoch = connector_.peer_epoch();
  connection_->reply_ns = now_ns();
  sender_ = std::make_unique<HapticThread>(
      rt::ThreadOptions{.name = "tact-send", .priority = params_.priority, .cpu = params_.cpu},
      [this, connection = connection_](HapticThread::Control& control) { send(connection, control); });
  for (const std::string& missing : sender_->missing()) log_warn(missing);
  const std::scoped_lock lock(mutex_);
  status_.server_epoch = connection_->server_epoch;
  ++status_.connections;
}

/// The send thread has proven the transport, or not. False when the connection is of no use.
bool ContactLink::check_proof() {
  const TransportProof proof = connection_->proof;
  const bool shm = transport_ == "shm";
  if (!proof.answered) {
    lose("the contact server does not answer");
    return false;
  }
  if (shm && !proof.no_datagrams) {
    const std::string text = proof.text();
    lose("shared memory is not used");
    refuse("transport: shared memory was asked for but the network carried the samples (" + text +
           "); stop other network load on this machine and try again, or choose transport = \"udp\"");
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    return false;
  }
  if (const SceneIdentity found{proof.field_hash, proof.shell_hash}; found != params_.scene) {
    connection_->refused = true;  // stays connected, so that the next server is noticed; none of its replies counts
    refuse_scene(health_, found, params_.scene);
    return false;
  }
  connection_->reply_ns = now_ns();
  receiver_ = std::make_unique<HapticThread>(
      rt::ThreadOptions{.name = "tact-receive", .priority = params_.priority, .cpu = params_.cpu},
      [this, connection = connection_](HapticThread::Control& control) { receive(connection, control); });
  for (const std::string& missing : receiver_->missing()) log_warn(missing);
  health_.set_faults(kFaults, 0);
  const std::string detail = "connected, " + std::string(shm ? "shared memory proven: " : "UDP: ") + proof.text();
  health_.update([&](wire::Health& h) {
    h.phase = wire::kActive;
    h.progress = -1;
    h.shared_memory_proven = shm;
    wire::set_text(h.detail, detail);
  });
  log_info(detail);
  {
    const std::scoped_lock lock(mutex_);
    status_.active = true;
    status_.proof = proof;
  }
  changed_.notify_all();
  return true;
}

void ContactLink::lose(const std::string& why) {
  {
    const std::scoped_lock lock(mutex_);
    status_.active = false;
    status_.server_epoch = 0;
  }
  const bool sender_left = !sender_->finish(), receiver_left = receiver_ && !receiver_->finish();
  if (sender_left) log_warn("the send thread hangs in DDS and was left behind");
  if (receiver_left) log_warn("the receive thread hangs in DDS and was left behind");
  sender_.reset();
  receiver_.reset();
  connection_.reset();
  connector_.drop(sender_left || receiver_left);
  waiting_since_ = steady_clock::now();
  if (stopping()) return;
  log_warn("haptic connection lost: ", why);
  health_.set_faults(bit(Fault::peer_restarted), bit(Fault::peer_restarted));
  health_.phase(wire::kConnecting, "haptic connection lost: " + why);
}

void ContactLink::report_waiting() {
  const auto waited = steady_clock::now() - waiting_since_;
  if (!connector_.peer_ready()) waiting_since_ = steady_clock::now();
  const bool stuck = waited > (status().connections > 0 ? seconds{kReconnectLimit} : seconds{kConnectLimit});
  std::string text = connector_.state();
  if (stuck) text += "; not connected in time: RouDi and all shared-memory processes must be restarted together";
  if (text == said_) return;
  said_ = text;
  if (stuck) health_.set_faults(bit(Fault::transport_degraded), bit(Fault::transport_degraded));
  health_.phase(stuck ? wire::kDegraded : wire::kConnecting, text);
  stuck ? log_error(text) : log_info(text);
}

/// RouDi alone gone: the connection goes on, a new one could not be made. One that only was stopped comes back.
void ContactLink::check_transport() {
  if (steady_clock::now() - transport_checked_ < milliseconds{500}) return;
  transport_checked_ = steady_clock::now();
  const bool degraded = (health_.now().faults & bit(Fault::transport_degraded)) != 0;
  if (haptic_.transport_intact()) {
    if (!std::exchange(roudi_lost_, false) || !degraded) return;
    health_.set_faults(bit(Fault::transport_degraded), 0);
    const std::string text = "RouDi answers again";
    log_warn(text);
    if (status().active) health_.phase(wire::kActive, text);
    return;
  }
  if (degraded) return;
  roudi_lost_ = true;
  health_.set_faults(bit(Fault::transport_degraded), bit(Fault::transport_degraded));
  const std::string text = "RouDi is gone or was replaced: restart it and all shared-memory processes together";
  log_error(text);
  health_.phase(wire::kDegraded, text);
}

void ContactLink::refuse(const std::string& why) {
  health_.phase(wire::kDegraded, why);
  log_error(why);
  {
    const std::scoped_lock lock(mutex_);
    status_.refused = why;
  }
  changed_.notify_all();
}

void ContactLink::send(const std::shared_ptr<Connection>& connection, HapticThread::Control& control) noexcept {
  wire::ToolPose pose;
  to_wire(params_.probe, session_id_, epoch_, pose);
  connection->proof = prove_transport(*connection->ends, pose, control.guard);
  const bool answered = connection->proof.answered;
  connection->proven.store(true, std::memory_order_release);
  if (!answered) return;  // perhaps given up while writing: touch nothing of `this`
  ToolSample sample;
  while (!control.stop.load(std::memory_order_relaxed)) {
    if (!mail_.tool_ready.wait(kWaitNs) || !mail_.tool.read(sample)) continue;
    to_wire(sample, session_id_, epoch_, pose);
    control.guard.enter_write();
    connection->ends->out.write(pose);
    if (!control.guard.leave()) return;  // replaced: `this` is no longer ours to touch
    connection->sent.fetch_add(1, std::memory_order_relaxed);
  }
}

void ContactLink::receive(const std::shared_ptr<Connection>& connection, HapticThread::Control& control) noexcept {
  ContactReply reply;
  wire::ContactWrench wrench;
  while (!control.stop.load(std::memory_order_relaxed)) {
    control.guard.enter_read();
    const bool any = connection->ends->in.wait(kWaitNs) && connection->ends->in.take_newest(wrench);
    if (!control.guard.leave()) return;  // replaced: the mailbox is its successor's
    if (!any) continue;
    const std::int64_t now = now_ns();
    const bool ours = wrench.pose_epoch == epoch_ && wrench.session_id == session_id_ &&
                      wrench.server_epoch == connection->server_epoch && (wrench.pose_seq & kProofSeq) == 0 &&
                      SceneIdentity{wrench.field_hash, wrench.shell_hash} == params_.scene;
    if (!ours || !finite(wrench)) continue;
    from_wire(wrench, reply);
    reply.received_mono_ns = now;
    mail_.reply.write(reply);
    mail_.reply_ready.ring();
    connection->reply_ns.store(now, std::memory_order_relaxed);
    connection->sent.store(0, std::memory_order_relaxed);
  }
}

}  // namespace tact::coupling
