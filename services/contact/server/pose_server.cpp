#include "contact/server/pose_server.hpp"

#include <chrono>

#include "contact/server/messages.hpp"
#include "fault/fault.hpp"
#include "link/transport_proof.hpp"
#include "log/log.hpp"

namespace tact::contact {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kWaitNs = 20'000'000;
constexpr std::int64_t kSnapshotPeriodNs = 16'000'000;
constexpr std::int64_t kSilenceNs = 500'000'000;  // coupling is active and named us, but no pose comes: rebuild
constexpr milliseconds kSurelyAlive{300};

std::int64_t now_ns() noexcept {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds{1};
}

}  // namespace

PoseServer::PoseServer(const Session& session, const Participant& low, HealthReporter& health,
                       ContactPipeline& pipeline, const Params& params)
    : transport_(session.machine.transport),
      session_id_(session.id),
      epoch_(process_epoch()),
      params_(params),
      health_(health),
      pipeline_(pipeline),
      haptic_(wire::Channel::haptic, session,
              {.priority = params.priority > 0 ? kTransportPriority : 0, .cpu = params.cpu}),
      monitor_(low),
      connector_(haptic_, transport_, health_, monitor_),
      taker_(params.capacity),
      snapshot_(std::make_unique<ContactSnapshot>()),
      snapshots_(std::make_unique<rt::LatestValue<ContactSnapshot>>()) {}

void PoseServer::start() {
  supervisor_ = std::thread([this] { supervise(); });
}

void PoseServer::stop() {
  stop_ = true;
  if (supervisor_.joinable()) supervisor_.join();
}

std::optional<std::string> PoseServer::refused() const {
  const std::scoped_lock lock(mutex_);
  return refused_;
}

void PoseServer::say(wire::Phase phase, const std::string& text) {
  if (text == said_) return;
  said_ = text;
  log_info(text);
  health_.phase(phase, text);
}

void PoseServer::supervise() {
  while (!stop_) {
    if (!thread_) {
      try {
        if (auto ends = connector_.poll()) {
          pose_ns_ = now_ns();
          thread_ = std::make_unique<HapticThread>(
              rt::ThreadOptions{.name = "tact-serve", .priority = params_.priority, .cpu = params_.cpu},
              [this, ends = std::move(ends), epoch = connector_.peer_epoch()](HapticThread::Control& control) {
                serve(ends, epoch, control);
              });
          for (const std::string& missing : thread_->missing()) log_warn(missing);
          say(wire::kActive, "serving coupling " + std::to_string(connector_.peer_epoch()));
        } else {
          say(wire::kConnecting, connector_.state());
        }
      } catch (const SetupError& e) {
        log_error(e.what());
        health_.phase(wire::kDegraded, e.what());
        const std::scoped_lock lock(mutex_);
        refused_ = e.what();
        return;
      }
      continue;
    }
    monitor_.poll(kWaitNs);
    const auto coupling = monitor_.alive("coupling");
    if (coupling && coupling->shared_memory_proven != health_.now().shared_memory_proven) {
      health_.update([&](wire::Health& h) { h.shared_memory_proven = coupling->shared_memory_proven; });
    }
    const bool expects_replies = coupling && coupling->phase == wire::kActive && coupling->peer_epoch == epoch_;
    if (thread_->hung()) {
      lose("a write to it hangs");
    } else if (!connector_.peer_alive()) {
      lose("it is gone");
    } else if (expects_replies && now_ns() - pose_ns_.load(std::memory_order_relaxed) > kSilenceNs &&
               connector_.peer_alive(kSurelyAlive)) {
      lose("it is matched but silent");
    }
  }
  if (thread_) lose("stopping");
}

void PoseServer::lose(const std::string& why) {
  const bool left_behind = !thread_->finish();
  thread_.reset();
  connector_.drop(left_behind);
  if (left_behind) log_warn("the serve thread hangs in DDS and was left behind");
  if (!stop_) say(wire::kConnecting, "coupling lost: " + why);
}

void PoseServer::serve(const std::shared_ptr<ContactEnds>& ends, std::uint64_t coupling_epoch,
                       HapticThread::Control& control) noexcept {
  wire::ToolPose pose;
  wire::ContactWrench reply{};
  reply.session_id = session_id_;
  reply.server_epoch = epoch_;
  reply.field_hash = params_.field_hash;
  reply.shell_hash = params_.shell_hash;
  std::uint64_t last_seq = 0;
  std::int64_t snapshot_due_ns = 0;
  while (!control.stop.load(std::memory_order_relaxed)) {
    control.guard.enter_read();
    const bool any = ends->in.wait(kWaitNs) && ends->in.take_newest(pose);
    if (!control.guard.leave()) return;  // replaced: nothing of `this` is ours any more
    if (!any) continue;
    const std::int64_t begin_ns = now_ns();
    if (pose.session_id != session_id_ || pose.epoch != coupling_epoch) continue;
    pose_ns_.store(begin_ns, std::memory_order_relaxed);

    const ContactResult& result = pipeline_.step(from_wire(pose));

    to_wire(result, reply);
    reply.pose_epoch = pose.epoch;
    reply.pose_seq = pose.seq;
    reply.pose_t_mono_ns = pose.t_mono_ns;
    const bool proof = (pose.seq & kProofSeq) != 0;
    reply.skipped_poses =
        proof || last_seq == 0 || pose.seq <= last_seq ? 0 : static_cast<std::uint32_t>(pose.seq - last_seq - 1);
    if (!proof) last_seq = pose.seq;
    const std::int64_t end_ns = now_ns();
    reply.compute_ns = end_ns - begin_ns;
    control.guard.enter_write();
    ends->out.write(reply);
    if (!control.guard.leave()) return;  // as above

    status_.fetch_or(result.status, std::memory_order_relaxed);
    if (end_ns >= snapshot_due_ns && (pose.flags & tact_haptic_TOOL_POSE_QUERY_ONLY) == 0) {
      snapshot_due_ns = end_ns + kSnapshotPeriodNs;
      taker_.take(pipeline_.contacts(), result, *snapshot_);
      snapshot_->pose_epoch = pose.epoch;
      snapshot_->pose_seq = pose.seq;
      snapshot_->pose_t_mono_ns = pose.t_mono_ns;
      snapshot_->compute_ns = reply.compute_ns;
      snapshots_->write(*snapshot_);
    }
  }
}

}  // namespace tact::contact
