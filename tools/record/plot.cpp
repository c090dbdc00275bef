#include "record/plot.hpp"

#include <algorithm>
#include <fstream>
#include <vector>

#include "coupling/loop/recording.hpp"
#include "fault/fault.hpp"
#include "report/gnuplot.hpp"

namespace tact::record {
namespace {

using namespace coupling;

constexpr std::size_t kPoints = 4000;

struct Point {
  double time_s = 0, contact_n = 0, coupling_n = 0, sent_n = 0, torque_nm = 0, depth_mm = 0, tick_us = 0;
  std::uint32_t contacts = 0, age_ticks = 0;
  Vec3 tool_mm, handle_mm;

  void merge(const Point& p) {
    const auto raise = [](auto& a, auto b) { a = std::max(a, b); };
    raise(contact_n, p.contact_n), raise(coupling_n, p.coupling_n), raise(sent_n, p.sent_n);
    raise(torque_nm, p.torque_nm), raise(depth_mm, p.depth_mm), raise(tick_us, p.tick_us);
    raise(contacts, p.contacts), raise(age_ticks, p.age_ticks);
  }
};

Point point_of(const TickRecord& t, double time_s) {
  Point p;
  p.time_s = time_s;
  p.contact_n = t.F_contact_W.force.norm();
  p.coupling_n = t.F_coupling_W.force.norm();
  p.sent_n = t.F_sent_W.force.norm();
  p.torque_nm = t.F_contact_W.torque.norm();
  p.depth_mm = 1e3 * t.max_depth_m;
  p.tick_us = 1e-3 * static_cast<double>(t.tick_ns);
  p.contacts = t.contact_count;
  p.age_ticks = std::min(t.wrench_age_ticks, 25u);
  p.tool_mm = 1e3 * t.tool.X_W.p;
  p.handle_mm = 1e3 * t.X_WH.p;
  return p;
}

/// Halves the points whenever there are too many of them.
class Curve {
 public:
  void add(const Point& p) {
    if (points_.empty() || in_last_ == every_) {
      points_.push_back(p);
      in_last_ = 1;
    } else {
      points_.back().merge(p);
      ++in_last_;
    }
    if (points_.size() < 2 * kPoints) return;
    for (std::size_t i = 0; i < kPoints; ++i) {
      points_[i] = points_[2 * i];
      points_[i].merge(points_[2 * i + 1]);
    }
    points_.resize(kPoints);
    every_ *= 2;
    in_last_ = every_;
  }
  const std::vector<Point>& points() const { return points_; }

 private:
  std::vector<Point> points_;
  std::size_t every_ = 1, in_last_ = 0;
};

std::string columns(const std::string& name, std::initializer_list<const char*> of) {
  std::string text;
  for (const char* c : of) text += "," + name + "_" + c;
  return text;
}
std::string pose_columns(const std::string& name) {
  return columns(name, {"x_m", "y_m", "z_m", "qw", "qx", "qy", "qz"});
}
std::string wrench_columns(const std::string& name) {
  return columns(name, {"fx_n", "fy_n", "fz_n", "tx_nm", "ty_nm", "tz_nm"});
}
std::string twist_columns(const std::string& name) {
  return columns(name, {"vx_m_per_s", "vy_m_per_s", "vz_m_per_s", "wx_rad_per_s", "wy_rad_per_s", "wz_rad_per_s"});
}

void put(std::ostream& out, const Vec3& v) { out << ',' << v.x() << ',' << v.y() << ',' << v.z(); }
void put(std::ostream& out, const Wrench& F) {
  put(out, F.force);
  put(out, F.torque);
}
void put(std::ostream& out, const Twist& V) {
  put(out, V.linear);
  put(out, V.angular);
}
void put(std::ostream& out, const Pose& X) {
  put(out, X.p);
  out << ',' << X.q.w() << ',' << X.q.x() << ',' << X.q.y() << ',' << X.q.z();
}

}  // namespace

void plot(const std::filesystem::path& recording, const std::filesystem::path& png) {
  RecordingReader reader(recording);
  Curve curve;
  std::int64_t start_ns = 0;
  for (auto entry = reader.next(); entry != RecordingReader::Entry::end; entry = reader.next()) {
    if (entry != RecordingReader::Entry::tick) continue;
    const TickRecord& t = reader.tick();
    if (curve.points().empty()) start_ns = t.tick.woke_ns;
    curve.add(point_of(t, 1e-9 * static_cast<double>(t.tick.woke_ns - start_ns)));
  }
  if (curve.points().empty()) throw SetupError(recording.string() + ": found no tick to plot");
  const RecordingInfo& info = reader.info();
  const std::string title = info.session + ": " + info.scene + (info.reason.empty() ? "" : ", flight: " + info.reason);

  report::Gnuplot gnuplot(png, 1200, 1300);
  FILE* out = gnuplot.in();
  std::fprintf(out, "$ticks << EOD\n");
  for (const Point& p : curve.points()) {
    std::fprintf(out, "%.4f %.5g %.5g %.5g %.5g %.5g %u %.5g %u %.5g %.5g %.5g %.5g %.5g %.5g\n", p.time_s, p.contact_n,
                 p.coupling_n, p.sent_n, p.torque_nm, p.depth_mm, p.contacts, p.tick_us, p.age_ticks, p.tool_mm.x(),
                 p.tool_mm.y(), p.tool_mm.z(), p.handle_mm.x(), p.handle_mm.y(), p.handle_mm.z());
  }
  std::fprintf(
      out,
      "EOD\nset multiplot layout 5,1 title %s noenhanced\n"
      "set grid\nset autoscale xfix\nset offsets 0, 0, graph 0.05, 0\nset lmargin 10\nset rmargin 10\nset key above\n"
      "set yrange [0:*]\nset ylabel 'force [N]'\n"
      "plot $ticks u 1:2 w l lc rgb '#c03020' t 'contact', '' u 1:3 w l lc rgb '#2060c0' t 'coupling', '' u 1:4 w l dt "
      "2 "
      "lc rgb '#606060' t 'sent'\n"
      "set ylabel 'torque [Nm]'\nplot $ticks u 1:5 w l lc rgb '#c03020' t 'contact'\n"
      "set yrange [*:*]\nset ylabel 'position [mm]'\n"
      "plot for [i=0:2] $ticks u 1:(column(10+i)) w l lc i+1 t 'tool '.word('x y z', i+1), for [i=0:2] '' u "
      "1:(column(13+i)) w l dt 2 lc i+1 t 'handle '.word('x y z', i+1)\n"
      "set yrange [0:*]\nset y2range [0:*]\nset y2tics\nset ytics nomirror\nset ylabel 'depth [mm]'\nset y2label "
      "'contacts'\n"
      "plot $ticks u 1:6 w l lc rgb '#2060c0' t 'depth', '' u 1:7 axes x1y2 w l lc rgb '#208040' t 'contacts'\n"
      "set yrange [*:*]\nset ylabel 'tick [us]'\nset y2label 'age [ticks]'\nset xlabel 'time [s]'\n"
      "plot $ticks u 1:8 w l lc rgb '#805090' t 'tick time', '' u 1:9 axes x1y2 w steps lc rgb '#909090' t 'age of the "
      "wrench'\nunset multiplot\n",
      report::Gnuplot::quoted(title).c_str());
  gnuplot.finish();
}

void write_csv(const std::filesystem::path& recording, const std::filesystem::path& csv) {
  RecordingReader reader(recording);
  std::ofstream out(csv);
  out.precision(12);
  out << "tick,due_ns,woke_ns,skipped,pose_seq,reply_seq,wrench_age_ticks,faults,contact_count,engaged,live"
      << pose_columns("X_WH") << twist_columns("V_WH") << wrench_columns("F_hand_W") << pose_columns("X_WT")
      << twist_columns("V_WT") << wrench_columns("F_contact_W") << wrench_columns("F_coupling_W")
      << wrench_columns("F_sent_W") << pose_columns("X_sent_B") << twist_columns("V_sent_B")
      << ",max_depth_m,tick_ns\n";
  for (auto entry = reader.next(); entry != RecordingReader::Entry::end; entry = reader.next()) {
    if (entry != RecordingReader::Entry::tick) continue;
    const TickRecord& t = reader.tick();
    out << t.tick.index << ',' << t.tick.due_ns << ',' << t.tick.woke_ns << ',' << t.tick.skipped << ',' << t.pose_seq
        << ',' << t.reply_seq << ',' << t.wrench_age_ticks << ',' << t.faults << ',' << t.contact_count << ','
        << t.reading.engaged << ',' << t.live;
    put(out, t.X_WH);
    put(out, t.reading.V_WH);
    put(out, t.reading.F_hand_W);
    put(out, t.tool.X_W);
    put(out, t.tool.V_W);
    put(out, t.F_contact_W);
    put(out, t.F_coupling_W);
    put(out, t.F_sent_W);
    put(out, t.sent.X_W);
    put(out, t.sent.V_W);
    out << ',' << t.max_depth_m << ',' << t.tick_ns << '\n';
  }
  out.flush();
  if (!out) throw SetupError(csv.string() + ": cannot write the CSV file here");
}

}  // namespace tact::record
