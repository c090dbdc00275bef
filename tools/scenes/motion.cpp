#include "scenes/motion.hpp"

#include <cmath>
#include <cstdio>

namespace tact::scenes {

HandMotion minimum_jerk(const std::vector<KeyPose>& keys, double rate_hz) {
  HandMotion motion;
  const auto add = [&](const KeyPose& key) {
    motion.time_s.push_back(key.time_s);
    motion.X_WM.push_back(key.X_WM());
  };
  add(keys.front());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const KeyPose &a = keys[i - 1], &b = keys[i];
    const double duration = b.time_s - a.time_s;
    const int n = static_cast<int>(std::lround(duration * rate_hz));
    for (int k = 1; k <= n; ++k) {
      const double u = static_cast<double>(k) / n;
      const double s = u * u * u * (10 + u * (-15 + 6 * u));
      add({a.time_s + u * duration, a.p_W + s * (b.p_W - a.p_W), a.p_M + s * (b.p_M - a.p_M), a.q_WM.slerp(s, b.q_WM)});
    }
  }
  return motion;
}

std::string to_csv(const HandMotion& motion) {
  std::string out = "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  for (std::size_t i = 0; i < motion.time_s.size(); ++i) {
    const Pose& X = motion.X_WM[i];
    const double numbers[] = {X.p.x(), X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z()};
    char text[32];
    std::snprintf(text, sizeof text, "%.3f", motion.time_s[i]);
    out += text;
    for (std::size_t k = 0; k < 7; ++k) {
      // Adding 0 after rounding makes no "-0.000000" of a rounding error.
      const double unit = k < 3 ? 1e6 : 1e7;
      std::snprintf(text, sizeof text, k < 3 ? ",%.6f" : ",%.7f", std::round(numbers[k] * unit) / unit + 0.0);
      out += text;
    }
    out += '\n';
  }
  return out;
}

}  // namespace tact::scenes
