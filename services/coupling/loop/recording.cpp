#include "coupling/loop/recording.hpp"

#include <cstring>
#include <type_traits>

#include "fault/fault.hpp"

namespace tact::coupling {
namespace {

/// Writes fields one after the other.
class Out {
 public:
  template <class... T>
  void operator()(T&... values) {
    (add(values), ...);
  }
  std::vector<std::byte> bytes;

  void raw(const void* from, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), begin, begin + size);
  }

 private:
  void add(std::string& text) {
    auto size = static_cast<std::uint32_t>(text.size());
    raw(&size, sizeof size);
    raw(text.data(), text.size());
  }
  template <class Scalar, int R, int C>
  void add(Eigen::Matrix<Scalar, R, C>& m) {
    raw(m.data(), sizeof(Scalar) * static_cast<std::size_t>(m.size()));
  }
  void add(Quat& q) { raw(q.coeffs().data(), 4 * sizeof(double)); }
  /// Free space: all zero.
  void add(Mat6& m) {
    const Mat6 zero = Mat6::Zero();
    const bool any = std::memcmp(m.data(), zero.data(), 36 * sizeof(double)) != 0;
    raw(&any, 1);
    if (any) raw(m.data(), 36 * sizeof(double));
  }
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void add(T& value) { raw(&value, sizeof value); }
  template <class T>
  void add(T& value) {
    fields(*this, value);
  }
};

/// Reads them back.
class In {
 public:
  explicit In(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (take(values), ...);
  }
  void raw(void* to, std::size_t size) {
    if (size > rest_.size()) {
      good_ = false;
      return;
    }
    std::memcpy(to, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }
  bool whole() const { return good_ && rest_.empty(); }

 private:
  void take(std::string& text) {
    std::uint32_t size = 0;
    raw(&size, sizeof size);
    if (size > rest_.size()) {
      good_ = false;
      return;
    }
    text.resize(size);
    raw(text.data(), size);
  }
  template <class Scalar, int R, int C>
  void take(Eigen::Matrix<Scalar, R, C>& m) {
    raw(m.data(), sizeof(Scalar) * static_cast<std::size_t>(m.size()));
  }
  void take(Quat& q) { raw(q.coeffs().data(), 4 * sizeof(double)); }
  void take(Mat6& m) {
    bool any = false;
    take(any);
    if (any) {
      raw(m.data(), 36 * sizeof(double));
    } else {
      m.setZero();
    }
  }
  void take(bool& value) {
    std::uint8_t byte = 0;
    raw(&byte, 1);
    value = byte != 0;
  }
  template <class T>
  requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) void take(T& value) { raw(&value, sizeof value); }
  template <class T>
  void take(T& value) {
    fields(*this, value);
  }

  std::span<const std::byte> rest_;
  bool good_ = true;
};

// Each struct is taken apart by a structured binding: a member added later does not compile until it is listed here,
// and then wants a new schema (kRecordingKind).

template <class A>
void fields(A& a, Pose& v) {
  auto& [p, q] = v;
  a(p, q);
}
template <class A>
void fields(A& a, Twist& v) {
  auto& [linear, angular] = v;
  a(linear, angular);
}
template <class A>
void fields(A& a, Wrench& v) {
  auto& [force, torque] = v;
  a(force, torque);
}
template <class A>
void fields(A& a, BodyState& v) {
  auto& [X, V] = v;
  a(X, V);
}
template <class A>
void fields(A& a, SetPoint& v) {
  auto& [X, V] = v;
  a(X, V);
}
template <class A>
void fields(A& a, rt::Tick& v) {
  auto& [index, due_ns, woke_ns, period_ns, skipped] = v;
  a(index, due_ns, woke_ns, period_ns, skipped);
}
template <class A>
void fields(A& a, DeviceReading& v) {
  auto& [X_WH, V_WH, F_hand, engaged, trusted, faults, script_time, script_done] = v;
  a(X_WH, V_WH, F_hand, engaged, trusted, faults, script_time, script_done);
}
template <class A>
void fields(A& a, DeviceCapabilities& v) {
  auto& [name, mode, force, torque, spring, angular_spring, damper, angular_damper, real] = v;
  a(name, mode, force, torque, spring, angular_spring, damper, angular_damper, real);
}
template <class A>
void fields(A& a, LoopParameters& v) {
  auto& [version, kind, integrator, saturation, passivity, k, z, k_r, torque_max] = v;
  a(version, kind, integrator, saturation, passivity, k, z, k_r, torque_max);
}
template <class A>
void fields(A& a, ContactReply& v) {
  auto& [epoch, seq, sent_ns, received_ns, compute_ns, X_WT, X_WO, F, G, K, B, count, dropped, status, depth, clearance,
         k, x_max, version] = v;
  a(epoch, seq, sent_ns, received_ns, compute_ns, X_WT, X_WO, F, G, K, B, count, dropped, status, depth, clearance, k,
    x_max, version);
}
template <class A>
void fields(A& a, ToolIntegrator::Params& v) {
  auto& [mass, inertia, locked] = v;
  a(mass, inertia, locked);
}
template <class A>
void fields(A& a, GateLimits& v) {
  auto& [force, torque, force_slope, torque_slope, speed, angular_speed, spring, angular_spring, damper, angular_damper,
         ramp] = v;
  a(force, torque, force_slope, torque_slope, speed, angular_speed, spring, angular_spring, damper, angular_damper,
    ramp);
}
template <class A>
void fields(A& a, WorkspaceMapping::Params& v) {
  auto& [X_WB, scale, placed] = v;
  a(X_WB, scale, placed);
}
template <class A>
void fields(A& a, LoopConfig& v) {
  auto& [rate, tool, parameters, gate, mapping, X_WT, X_WO, X_TM, gyration, radius, voxel, force_max, status_period,
         reply_wait] = v;
  a(rate, tool, parameters, gate, mapping, X_WT, X_WO, X_TM, gyration, radius, voxel, force_max, status_period,
    reply_wait);
}
template <class A>
void fields(A& a, RecordingInfo& v) {
  auto& [session, scene, id, field, shell, reason, config, device, reading, set_point, layout] = v;
  a(session, scene, id, field, shell, reason, config, device, reading, set_point, layout);
}
template <class A>
void fields(A& a, TickRecord& v) {
  auto& [tick, reading, resting, has_parameters, has_reply, parameters, reply, pose_seq, reply_seq, age, faults, count,
         live, X_WH, tool, F_contact, F_coupling, F_sent, sent, depth, tick_ns] = v;
  a(tick, reading, resting, has_parameters, has_reply);
  if (has_parameters) a(parameters);
  if (has_reply) a(reply);
  a(pose_seq, reply_seq, age, faults, count, live, X_WH, tool, F_contact, F_coupling, F_sent, sent, depth, tick_ns);
}

enum class Kind : std::uint8_t { tick = 1, snapshot = 2 };

}  // namespace

std::uint64_t state_layout() { return hash_text(TACT_STATE_LAYOUT); }

std::vector<std::byte> encode(const RecordingInfo& info) {
  Out out;
  RecordingInfo copy = info;  // fields() is for reading too
  fields(out, copy);
  return std::move(out.bytes);
}

std::vector<std::byte> encode(const TickRecord& tick) {
  Out out;
  out.bytes.reserve(2048);
  Kind kind = Kind::tick;
  out(kind);
  fields(out, const_cast<TickRecord&>(tick));  // Out changes nothing
  return std::move(out.bytes);
}

std::vector<std::byte> encode(const LoopSnapshot& snapshot) {
  Out out;
  Kind kind = Kind::snapshot;
  std::uint64_t tick = snapshot.tick;
  out(kind, tick);
  out.raw(snapshot.bytes.data(), snapshot.size);
  return std::move(out.bytes);
}

std::filesystem::path free_recording_name(const std::filesystem::path& wanted, std::uint64_t session_id) {
  const auto of_this_session = [session_id](const std::filesystem::path& path) {
    try {
      return RecordingReader(path).info().session_id == session_id;
    } catch (const SetupError&) {  // none, or of no use
      return false;
    }
  };
  auto path = wanted;
  for (int n = 2; !path.empty() && of_this_session(path); ++n) {
    path = wanted;
    path.replace_filename(wanted.stem().string() + "-" + std::to_string(n) + wanted.extension().string());
  }
  return path;
}

RecordingReader::RecordingReader(const std::filesystem::path& path)
    : path_(path),
      file_(path, kRecordingKind),
      tick_(std::make_unique<TickRecord>()),
      snapshot_(std::make_unique<LoopSnapshot>()) {
  In in(file_.header());
  fields(in, info_);
  if (!in.whole()) throw SetupError(path.string() + ": the recording's header makes no sense: it is damaged");
}

RecordingReader::Entry RecordingReader::next() {
  if (!file_.next(record_)) return Entry::end;
  if (!record_.empty() && record_[0] == std::byte{static_cast<std::uint8_t>(Kind::tick)}) {
    *tick_ = {};
    In in{std::span<const std::byte>(record_).subspan(1)};
    fields(in, *tick_);
    if (in.whole()) return Entry::tick;
  } else if (record_.size() > 9 && record_.size() <= 9 + LoopSnapshot::kCapacity &&
             record_[0] == std::byte{static_cast<std::uint8_t>(Kind::snapshot)}) {
    std::memcpy(&snapshot_->tick, &record_[1], 8);
    snapshot_->size = static_cast<std::uint32_t>(record_.size() - 9);
    std::memcpy(snapshot_->bytes.data(), &record_[9], snapshot_->size);
    return Entry::snapshot;
  }
  throw SetupError(path_.string() + ": a record of the recording makes no sense: it is damaged");
}

}  // namespace tact::coupling
