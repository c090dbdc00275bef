#include "record/replay.hpp"

#include <cmath>
#include <memory>
#include <sstream>

#include "coupling/loop/coupling_loop.hpp"
#include "coupling/loop/recording.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::record {
namespace {

using namespace coupling;

/// Gives what was recorded, takes whatever is written.
class RecordedDevice final : public HapticDevice {
 public:
  explicit RecordedDevice(const RecordingInfo& info)
      : reading(info.first_reading), capabilities_(info.device), set_point_(info.first_set_point) {}
  const DeviceCapabilities& capabilities() const noexcept override { return capabilities_; }
  rt::Tick wait_tick() noexcept override { return {}; }
  DeviceReading read() noexcept override { return reading; }
  void write(const Wrench&) noexcept override {}
  void write(const SetPoint&) noexcept override {}
  SetPoint last_set_point() const noexcept override { return set_point_; }
  void power_off() noexcept override {}

  DeviceReading reading;

 private:
  DeviceCapabilities capabilities_;
  SetPoint set_point_;
};

/// A coupling that lives on what was recorded.
class Player {
 public:
  explicit Player(const RecordingInfo& info)
      : device_(info), queue_(info.config.rate_hz, 0.1), loop_(info.config, device_, *mail_, &queue_) {}

  bool restore(const LoopSnapshot& snapshot) { return loop_.restore(snapshot); }

  const TickRecord& step(const TickRecord& in) {
    device_.reading = in.reading;
    if (in.has_parameters) mail_->parameters.write(in.parameters);
    if (in.has_reply) mail_->reply.write(in.reply);
    if (in.resting) loop_.rest();
    loop_.step(in.tick);
    queue_.ticks.pop(out_);
    while (queue_.snapshots.pop(snapshot_)) {
    }
    return out_;
  }

 private:
  std::unique_ptr<Mailboxes> mail_ = std::make_unique<Mailboxes>();
  RecordedDevice device_;
  TickQueue queue_;
  CouplingLoop loop_;
  TickRecord out_;
  LoopSnapshot snapshot_;
};

class Comparison {
 public:
  Comparison(ReplayResult& result, const Tolerance& t) : result_(result) {
    result.quantities = {{{"contact force", "N", t.force_n},
                          {"contact torque", "Nm", t.torque_nm},
                          {"coupling force", "N", t.force_n},
                          {"coupling torque", "Nm", t.torque_nm},
                          {"force sent", "N", t.force_n},
                          {"torque sent", "Nm", t.torque_nm},
                          {"set-point position", "m", t.position_m},
                          {"set-point rotation", "rad", t.rotation_rad},
                          {"tool position", "m", t.position_m},
                          {"tool rotation", "rad", t.rotation_rad}}};
  }

  void tick(const TickRecord& recorded, const TickRecord& replayed) {
    tick_ = recorded.tick.index;
    std::size_t q = 0;
    for (const auto member : {&TickRecord::F_contact_W, &TickRecord::F_coupling_W, &TickRecord::F_sent_W}) {
      compare(q++, (recorded.*member).force, (replayed.*member).force);
      compare(q++, (recorded.*member).torque, (replayed.*member).torque);
    }
    compare(q++, recorded.sent.X_W.p, replayed.sent.X_W.p);
    compare(q++, Vec3::Zero(), log_so3(replayed.sent.X_W.q * recorded.sent.X_W.q.conjugate()));
    compare(q++, recorded.tool.X_W.p, replayed.tool.X_W.p);
    compare(q++, Vec3::Zero(), log_so3(replayed.tool.X_W.q * recorded.tool.X_W.q.conjugate()));
    if (recorded.faults != replayed.faults && !result_.first) {
      result_.first = {
          tick_, "faults: recorded " + fault_names(recorded.faults) + ", replayed " + fault_names(replayed.faults)};
    }
    if (recorded.pose_seq != replayed.pose_seq && !result_.first) {
      result_.first = {tick_, "pose sequence: recorded " + std::to_string(recorded.pose_seq) + ", replayed " +
                                  std::to_string(replayed.pose_seq)};
    }
  }

 private:
  void compare(std::size_t q, const Vec3& recorded, const Vec3& replayed) {
    ReplayResult::Quantity& quantity = result_.quantities[q];
    const double apart = (recorded - replayed).norm();
    if (apart > quantity.largest) {
      quantity.largest = apart;
      quantity.at_tick = tick_;
    }
    if (apart <= quantity.tolerance || result_.first) return;  // not a number is beyond every tolerance
    std::ostringstream text;
    text.precision(9);
    text << quantity.name << ": " << apart << ' ' << quantity.unit << " apart: recorded (" << recorded.transpose()
         << "), replayed (" << replayed.transpose() << ')';
    result_.first = {tick_, text.str()};
  }

  ReplayResult& result_;
  std::uint64_t tick_ = 0;
};

}  // namespace

ReplayResult replay(const std::filesystem::path& file, const Tolerance& tolerance) {
  RecordingReader reader(file);
  const RecordingInfo& info = reader.info();
  ReplayResult result;
  result.session = info.session;
  result.scene = info.scene;
  result.reason = info.reason;
  Comparison comparison(result, tolerance);
  std::unique_ptr<Player> player;
  std::optional<std::uint64_t> last;  // tick
  const bool same_build = info.layout == state_layout();
  for (auto entry = reader.next(); entry != RecordingReader::Entry::end; entry = reader.next()) {
    if (entry == RecordingReader::Entry::snapshot) {
      if (player || !same_build || last != reader.snapshot().tick) continue;
      player = std::make_unique<Player>(info);
      if (!player->restore(reader.snapshot())) player.reset();
      continue;
    }
    const TickRecord& tick = reader.tick();
    if (!last && tick.tick.index == 0) {
      player = std::make_unique<Player>(info);
      result.from_start = true;
    } else if (last && tick.tick.index != *last + 1) {
      ++result.gaps;
      player.reset();
    }
    last = tick.tick.index;
    if (!player) {
      ++result.unreplayed;
      continue;
    }
    comparison.tick(tick, player->step(tick));
    ++result.ticks;
  }
  result.ended_early = reader.ended_early();
  if (result.ticks == 0) {
    throw SetupError(file.string() + ": found nothing to replay: " +
                     (!last        ? "it holds no tick"
                      : same_build ? "it holds no snapshot of the loop's state"
                                   : "its snapshots are of another build; replay it with the tact that recorded it"));
  }
  return result;
}

}  // namespace tact::record
