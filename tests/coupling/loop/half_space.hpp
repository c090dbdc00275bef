#pragma once
#include <deque>

#include "coupling/loop/mailboxes.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling {

/// A contact server in closed form: the corners of a flat square foot against the half-space z < 0, penalty k each
/// ([P] eq. 1 with w = 1), exact G and K. Answers the newest pose, `delay` ticks later than it could.
struct HalfSpace {
  double k = 10000, b = 0;  ///< N/m, N s/m of each corner; damping never pulls
  double side = 0.04;       ///< m
  double x_max = 5e-4;
  int delay = 0;
  bool silent = false;
  std::uint64_t epoch = 1;
  std::deque<ContactReply> late;
  ToolSample sample;

  ContactReply answer(const ToolSample& pose) const {
    ContactReply reply;
    reply.server_epoch = epoch;
    reply.pose_seq = pose.seq;
    reply.pose_t_mono_ns = pose.t_mono_ns;
    reply.received_mono_ns = pose.t_mono_ns + 50'000;
    reply.compute_ns = 20'000;
    reply.X_WT = pose.X_WT;
    reply.X_WO = pose.X_WO;
    reply.stiffness_n_per_m = k * 4;
    reply.x_max_m = x_max;
    reply.clearance_m = 1e9;
    const Vec3 N = Vec3::UnitZ();
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Vec3 r = pose.X_WT.q * (side * Vec3(x, y, 0));
        const double z = pose.X_WT.p.z() + r.z();
        reply.clearance_m = std::min(reply.clearance_m, std::max(0.0, z));
        if (z >= 0) continue;
        const double v = pose.V_WT.linear.z() + pose.V_WT.angular.cross(r).z();
        const double damping = std::max(-b * v, k * z);
        const Vec3 f = (damping - k * z) * N;
        reply.F_W.force += f;
        reply.F_W.torque += r.cross(f);
        Vec6 s;
        s << N, r.cross(N);
        reply.K += k * s * s.transpose();
        if (damping > k * z) reply.B += b * s * s.transpose();
        reply.max_depth_m = std::max(reply.max_depth_m, -z);
        ++reply.contact_count;
      }
    }
    // The field's gradient and the force's direction are the same here: the first part of G is -K. The levers turn
    // with the tool, the forces do not: tau = sum r x f, dr = dtheta x r.
    reply.G = -reply.K;
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Vec3 r = pose.X_WT.q * (side * Vec3(x, y, 0));
        const double z = pose.X_WT.p.z() + r.z();
        if (z < 0) reply.G.bottomRightCorner<3, 3>() += skew(-k * z * N) * skew(r);
      }
    }
    return reply;
  }

  /// Once a tick, after the loop's step.
  void serve(Mailboxes& mail) {
    if (!mail.tool.read(sample) || silent) return;
    late.push_back(answer(sample));
    if (static_cast<int>(late.size()) <= delay) return;
    mail.reply.write(late.front());
    late.pop_front();
  }
};

}  // namespace tact::coupling
