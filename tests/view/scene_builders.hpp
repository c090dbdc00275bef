#pragma once
#include <cmath>
#include <string>

#include "mesh/mesh.hpp"
#include "view/model/view_scene.hpp"

/// Scenes made by hand for the tests of the view: no contact server, no files.
namespace tact::view::testing {

inline Mesh box(const Eigen::Vector3f& half, const Eigen::Vector3f& centre = Eigen::Vector3f::Zero()) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f sign((corner & 1) != 0 ? 1.0f : -1.0f, (corner & 2) != 0 ? 1.0f : -1.0f,
                               (corner & 4) != 0 ? 1.0f : -1.0f);
    mesh.vertices.push_back(centre + half.cwiseProduct(sign));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline Mesh sphere(float radius, unsigned rings = 48) {
  Mesh mesh;
  const unsigned around = 2 * rings;
  for (unsigned i = 0; i <= rings; ++i) {
    for (unsigned j = 0; j < around; ++j) {
      const float a = static_cast<float>(M_PI) * static_cast<float>(i) / static_cast<float>(rings);
      const float b = 2 * static_cast<float>(M_PI) * static_cast<float>(j) / static_cast<float>(around);
      mesh.vertices.emplace_back(radius * std::sin(a) * std::cos(b), radius * std::sin(a) * std::sin(b),
                                 radius * std::cos(a));
    }
  }
  for (unsigned i = 0; i < rings; ++i) {
    for (unsigned j = 0; j < around; ++j) {
      const unsigned a = i * around + j, b = i * around + (j + 1) % around;
      mesh.triangles.push_back({a, b, a + around});
      mesh.triangles.push_back({b, b + around, a + around});
    }
  }
  return mesh;
}

inline Mesh torus(float major, float minor, unsigned n = 64, unsigned m = 24) {
  Mesh mesh;
  for (unsigned i = 0; i < n; ++i) {
    for (unsigned j = 0; j < m; ++j) {
      const float a = 2 * static_cast<float>(M_PI) * static_cast<float>(i) / static_cast<float>(n);
      const float b = 2 * static_cast<float>(M_PI) * static_cast<float>(j) / static_cast<float>(m);
      const float r = major + minor * std::cos(b);
      mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), minor * std::sin(b));
    }
  }
  for (unsigned i = 0; i < n; ++i) {
    for (unsigned j = 0; j < m; ++j) {
      const unsigned a = i * m + j, b = ((i + 1) % n) * m + j, c = ((i + 1) % n) * m + (j + 1) % m,
                     d = i * m + (j + 1) % m;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  return mesh;
}

inline Mesh merged(Mesh a, const Mesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

inline Contact contact(const Vec3& p_W, const Vec3& N_W, double force_n, double depth_m) {
  return {p_W, N_W.normalized(), force_n * N_W.normalized(), depth_m, 1.0};
}

/// A ring (torus, obstacle) round a square peg (tool) that presses on it at t seconds; 1 mm voxels.
inline ViewScene ring_and_peg(double t_s) {
  ViewScene scene;
  scene.info.name = "ring and peg";
  scene.info.server_epoch = 1;
  scene.info.voxel_m = 1e-3;
  scene.info.stiffness_n_per_m = 20000;
  scene.info.x_max_m = 0.5e-3;
  scene.info.law = "potential";
  scene.info.tool_radius_m = 0.09;
  scene.device.X_WT = {Vec3(0.004 * std::cos(t_s), 0.004 * std::sin(t_s), 0.01),
                       Quat(Eigen::AngleAxisd(0.2 * std::sin(t_s), Vec3::UnitY()))};
  scene.device.X_WM = scene.device.X_WT;
  scene.device.X_WH = {scene.device.X_WT.p + Vec3(0.02, 0.0, 0.03), scene.device.X_WT.q};
  scene.contact_set.X_WT = scene.device.X_WT;
  for (int i = 0; i < 14; ++i) {
    const double a = t_s - 0.5 + 0.07 * i;
    const Vec3 out(std::cos(a), std::sin(a), 0);
    scene.contact_set.contacts.push_back(contact(0.035 * out + Vec3(0, 0, 0.002 * (i % 3)),
                                                 -out + Vec3(0, 0, 0.1 * (i % 3)), 0.5 + 0.2 * i, 2e-5 * (1 + i)));
  }
  scene.contact_set.total_count = 14;
  for (int i = 0; i < 1200; ++i) {
    const double t = t_s + i / 60.0;
    const auto wave = [&](double f, double a) {
      return static_cast<float>(a * std::max(0.0, std::sin(f * t) + 0.3 * std::sin(3.1 * f * t)));
    };
    scene.history.add({t, wave(0.9, 8), wave(0.9, 0.21), std::floor(wave(0.9, 40)), wave(0.9, 0.4), 90 + wave(7, 40)});
  }
  scene.age_s = 0;
  return scene;
}

inline double torus_field(const Vec3& p, double major, double minor) {
  return std::hypot(std::hypot(p.x(), p.y()) - major, p.z()) - minor;
}

}  // namespace tact::view::testing
