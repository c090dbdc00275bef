// What [P] prints that is not so, or holds less widely than it says: a number each.
#include <algorithm>
#include <cmath>

#include "contact/response/assemble.hpp"
#include "contact/stiffness/law.hpp"
#include "evidence/experiments.hpp"
#include "evidence/play.hpp"

namespace tact::evidence {
namespace {

using bench::number;
using bench::Report;

/// A made contact set, k = 1, forces along N.
class Contacts {
 public:
  void add(const Vec3& r, const Vec3& N, double depth_m) {
    r_.push_back(r), N_.push_back(N.normalized()), depth_m_.push_back(depth_m);
  }
  std::size_t size() const { return r_.size(); }

  contact::ContactBuffer weighed(const std::string& law_name, contact::Response* response = nullptr) const {
    contact::Pointshell shell;
    contact::ContactBuffer contacts(size());
    contacts.size = size();
    for (std::size_t i = 0; i < size(); ++i) {
      shell.position_T.push_back(r_[i].cast<float>());
      shell.normal_T.push_back(N_[i].cast<float>());
      shell.bounding_radius_m = std::max(shell.bounding_radius_m, r_[i].norm());
      contacts.point_id[i] = static_cast<std::uint32_t>(i);
      contacts.r[i] = r_[i];
      contacts.N[i] = contacts.g[i] = N_[i];
      contacts.depth_m[i] = depth_m_[i];
    }
    shell.radius_m.assign(size(), 0.f);
    shell.area_m2.assign(size(), 1e-6f);
    shell.child_begin.assign(size(), 0);
    shell.child_end.assign(size(), 0);
    shell.level_begin = {0, static_cast<std::uint32_t>(size())};
    const auto law = contact::make_law(law_name, {}, shell, size());
    law->weigh(contacts);
    if (response != nullptr) *response = contact::assemble(contacts, *law, 1, 0, Twist{});
    return contacts;
  }

  /// u K u over k.
  double stiffness_along(const Vec3& u, const std::string& law_name) const {
    contact::Response response;
    weighed(law_name, &response);
    return u.dot(response.K.topLeftCorner<3, 3>() * u);
  }
  double force_along(const Vec3& u, const std::string& law_name) const {
    contact::Response response;
    weighed(law_name, &response);
    return u.dot(response.F.force);
  }

 private:
  std::vector<Vec3> r_, N_;
  std::vector<double> depth_m_;
};

Contacts flat(int n, double depth_m = 1e-4) {
  Contacts contacts;
  const int side = static_cast<int>(std::ceil(std::sqrt(n)));
  for (int i = 0; i < n; ++i) {
    contacts.add(Vec3(i % side - 0.5 * (side - 1), i / side - 0.5 * (side - 1), 0) * (0.04 / side), Vec3::UnitZ(),
                 depth_m);
  }
  return contacts;
}

/// 1000 contacts on one wall, 14 on the other, as far from the middle.
Contacts two_walls(double depth_broad_m, double depth_narrow_m) {
  Contacts contacts;
  for (int i = 0; i < 1000; ++i) {
    contacts.add(Vec3(-0.04 + 1e-4 * (i % 10), 1e-3 * (i / 10) - 0.05, 0), Vec3::UnitZ(), depth_broad_m);
  }
  for (int i = 0; i < 14; ++i) {
    contacts.add(Vec3(0.04 + 1e-4 * (i % 2), 1e-3 * (i / 2) - 0.003, 0), Vec3::UnitZ(), depth_narrow_m);
  }
  return contacts;
}

Contacts round_peg() {  // 64 sides, 20 rows, all touching
  Contacts contacts;
  for (int i = 0; i < 64; ++i) {
    const Vec3 u(std::cos(2 * M_PI * i / 64), std::sin(2 * M_PI * i / 64), 0);
    for (int j = 0; j < 20; ++j) contacts.add(0.01 * u + Vec3(0, 0, 1e-3 * (j - 9.5)), -u, 1e-4);
  }
  return contacts;
}

/// How much deeper the narrow wall goes in when both bear the same load.
double depth_ratio_of_equal_loads(const std::string& law_name) {
  const auto narrow_over_broad = [&](double ratio) {
    const auto contacts = two_walls(1e-4, 1e-4 * ratio).weighed(law_name);
    double broad = 0, narrow = 0;
    for (std::size_t i = 0; i < contacts.size; ++i) {
      (contacts.r[i].x() < 0 ? broad : narrow) += contacts.weight[i] * contacts.depth_m[i];
    }
    return narrow / broad;
  };
  double low = 1, high = 1000;
  while (high / low > 1.0001) {
    const double middle = std::sqrt(low * high);
    (narrow_over_broad(middle) < 1 ? low : high) = middle;
  }
  return low;
}

/// Eq. 8 as printed, w = phi / phi_max, on n equal normals: net stiffness over k.
double eq_8_as_printed(int n) {
  const double phi = n;  // eq. 7: every hat is 1
  return n * phi / phi;
}

/// One contact sinks while others enter: the smallest change of force over change of depth, over k.
double least_slope(const std::string& law_name) {
  const auto force = [&](double z) {
    Contacts contacts;
    contacts.add(Vec3::Zero(), Vec3::UnitZ(), z);
    for (int i = 1; i <= 177; ++i) {
      const double depth = z - 1e-3 - 1e-6 * i;  // one after the other, a thousandth of a millimetre apart
      if (depth > 0) contacts.add(Vec3(1e-4 * i, 0, 0), Vec3::UnitZ(), depth);
    }
    return contacts.force_along(Vec3::UnitZ(), law_name);
  };
  double least = 1e9;
  for (double z = 5e-4; z < 4e-3; z += 5e-5) least = std::min(least, (force(z + 5e-5) - force(z)) / 5e-5);
  return least;
}

}  // namespace

void paper_errors(const bench::Effort&, Report& report) {
  std::vector<Report::Row> rows;
  int wrong = 0;
  const auto row = [&](const std::string& where, const std::string& says, bool holds, const std::string& is) {
    rows.push_back({where, says, holds ? "yes" : "no", is});
    wrong += holds ? 0 : 1;
  };
  const auto across_laws = [](const auto& value) {
    std::string all;
    for (const std::string& name : laws()) all += (all.empty() ? "" : ", ") + name + " " + number(value(name));
    return all;
  };
  row("eq. 8", "w = phi / phi_max; the text wants many equal normals to count as one", eq_8_as_printed(1000) < 10,
      "1000 equal normals keep " + number(eq_8_as_printed(1000)) + " k. We use w inverse to phi: adaptive-3dof keeps " +
          number(flat(1000).stiffness_along(Vec3::UnitZ(), "adaptive-3dof")) + " k");
  row("eq. 12, fig. 7", "1000 contacts on one wall and 14 on the other are balanced",
      depth_ratio_of_equal_loads("adaptive-6dof") < 2,
      "under equal loads the narrow wall is deeper by, times: " + across_laws(depth_ratio_of_equal_loads));
  const auto peg = [](const std::string& name) { return round_peg().stiffness_along(Vec3::UnitX(), name); };
  row("eq. 6, eps = 0.01", "nearly equal normals act as one", peg("adaptive-6dof") < 4,
      "a round peg touching along 64 sides keeps across, in k: " + across_laws(peg) +
          ". Neighbouring sides are 0.1 apart, ten times eps");
  const auto net = [](const std::string& name) { return flat(1000).stiffness_along(Vec3::UnitZ(), name); };
  row("throughout", "laws may be compared at equal k", net("global") < 2 * net("adaptive-6dof"),
      "a flat face of 1000 contacts nets, in k: " + across_laws(net));
  row("section 3", "scaled stiffness stays a stiffness", least_slope("adaptive-6dof") >= 0,
      "177 shallow contacts join one deep: dF/dz at its least, in k: " + across_laws(least_slope) +
          " (below 0: deeper is softer)");
  // By eq. 3, dF = -k N N^T dx: a stiffness that eq. 4 gives as positive would push along the displacement.
  row("eq. 4", "A = diag(2 k sin^2 a, 2 k cos^2 a), and dF = A dx", false,
      "eq. 3 has a minus: A = -diag(...); as printed the force grows along the displacement");
  const Vec3 apart(1e-3, 0, 0);  // the handle is a millimetre to the right of the tool
  row("fig. 13, text", "+F_VC acts on the handle, -F_VC on the tool, F_VC = k (x_handle - x_tool)", false,
      "at 2 kN/m and a millimetre the tool would be pushed " + number(2000 * apart.x()) +
          " N away from the handle; right is +F_VC on the tool");
  report.say("Sets of contacts made by formula, k = 1; checked by the product's own laws.");
  report.table({"where", "[P] says", "holds", "found"}, rows);
  report.claim("equations 4, 6, 8 and 12, fig. 7 and 13, section 3",
               std::to_string(wrong) + " of " + std::to_string(rows.size()) + " statements do not hold as printed",
               wrong == 0 ? bench::Holds::yes : bench::Holds::no,
               "None of them touches the idea, and eq. 4, 8 and the signs of fig. 13 are slips of the pen; that eq. 12 "
               "does not balance unequal areas, that eps leaves curved contact unscaled, and that averaging can make "
               "stiffness negative are properties of the method.");
}

}  // namespace tact::evidence
