#include "coupling/loop/flight_recorder.hpp"

#include <cmath>
#include <sstream>

#include "fault/fault.hpp"
#include "file/whole_file.hpp"

namespace tact::coupling {
namespace {

void put(std::ostream& out, const Vec3& v) { out << ',' << v.x() << ',' << v.y() << ',' << v.z(); }
void put(std::ostream& out, const Pose& X) {
  put(out, X.p);
  out << ',' << X.q.w() << ',' << X.q.x() << ',' << X.q.y() << ',' << X.q.z();
}

std::string pose_columns(const std::string& name) {
  std::string columns;
  for (const char* c : {"x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"}) columns += "," + name + "_" + c;
  return columns;
}

std::string wrench_columns(const std::string& name) {
  std::string columns;
  for (const char* c : {"fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"}) columns += "," + name + "_" + c;
  return columns;
}

std::string twist_columns(const std::string& name) {
  std::string columns;
  for (const char* c : {"vx_m_per_s", "vy_m_per_s", "vz_m_per_s", "wx_rad_per_s", "wy_rad_per_s", "wz_rad_per_s"}) {
    columns += "," + name + "_" + c;
  }
  return columns;
}

}  // namespace

FlightRecorder::FlightRecorder(double rate_hz, double history_s, std::filesystem::path directory, int files_max)
    : history_ticks_(static_cast<std::size_t>(std::ceil(rate_hz * history_s))),
      after_ticks_(static_cast<std::size_t>(std::ceil(rate_hz))),
      directory_(std::move(directory)),
      files_left_(files_max),
      ring_(history_ticks_) {}

std::filesystem::path FlightRecorder::drain(std::uint32_t dump_on) {
  std::filesystem::path written;
  TickRecord record;
  while (ring_.pop(record)) {
    history_.push_back(record);
    if (history_.size() > history_ticks_ + after_ticks_) history_.pop_front();
    const std::uint32_t begun = record.faults & ~last_faults_ & dump_on;
    last_faults_ = record.faults;
    if (begun != 0 && dump_in_ == 0 && files_left_ > 0) {
      dump_in_ = after_ticks_;
      dump_faults_ = begun;
    } else if (dump_in_ > 0 && --dump_in_ == 0) {
      written = dump(fault_names(dump_faults_));
    }
  }
  return written;
}

std::filesystem::path FlightRecorder::finish(std::uint32_t dump_on) {
  const std::filesystem::path written = drain(dump_on);
  if (dump_in_ == 0) return written;
  dump_in_ = 0;
  return dump(fault_names(dump_faults_));
}

std::filesystem::path FlightRecorder::dump(const std::string& reason) {
  --files_left_;
  const auto path = directory_ / ("flight-" + std::to_string(++files_) + ".csv");
  std::ostringstream out;
  out.precision(9);
  out << "# tact flight record, schema 1: " << reason << '\n'
      << "tick,t_mono_ns,pose_seq,reply_seq,wrench_age_ticks,faults,contact_count" << pose_columns("X_WH")
      << pose_columns("X_WT") << wrench_columns("F_contact_W") << wrench_columns("F_sent_W") << pose_columns("X_sent")
      << ",max_depth_m,tick_ns" << twist_columns("V_sent") << '\n';  // new columns come last
  for (const TickRecord& r : history_) {
    out << r.tick << ',' << r.t_mono_ns << ',' << r.pose_seq << ',' << r.reply_seq << ',' << r.wrench_age_ticks << ','
        << r.faults << ',' << r.contact_count;
    put(out, r.X_WH);
    put(out, r.X_WT);
    put(out, r.F_contact_W.force);
    put(out, r.F_contact_W.torque);
    put(out, r.F_sent_W.force);
    put(out, r.F_sent_W.torque);
    put(out, r.X_sent);
    out << ',' << r.max_depth_m << ',' << r.tick_ns;
    put(out, r.V_sent.linear);
    put(out, r.V_sent.angular);
    out << '\n';
  }
  write_whole(path, out.view());
  return path;
}

}  // namespace tact::coupling
