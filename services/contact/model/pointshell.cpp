#include "contact/model/pointshell.hpp"

#include <cmath>
#include <cstring>

#include "fault/fault.hpp"
#include "file/sealed_file.hpp"

namespace tact::contact {
namespace {

constexpr SealedKind kKind{{'S', 'H', 'E', 'L'}, 1, "pointshell"};

struct Info {
  std::uint64_t points, levels;
  double p_TM[3], q_TM_wxyz[4];
  double inertia_shape_m2[9];
  double gyration_radius_m, bounding_radius_m, spacing_m;
};
static_assert(sizeof(Info) == 168 && sizeof(Eigen::Vector3f) == 12);

/// Takes arrays one after the other from the payload.
struct Reader {
  std::span<const std::byte> left;

  template <class T>
  void take(std::vector<T>& to, std::size_t count) {
    to.resize(count);
    if (count > 0) std::memcpy(static_cast<void*>(to.data()), left.data(), count * sizeof(T));
    left = left.subspan(count * sizeof(T));
  }
};

/// A hostile file with a good checksum must not lead a traversal astray, nor make forces that are no numbers.
const char* inconsistency(const Pointshell& s) {
  const std::size_t n = s.size();
  if (n == 0) return "no points";
  const auto size = [](double x) { return x >= 0 && std::isfinite(x); };
  if (!s.X_TM.finite() || std::fabs(s.X_TM.q.norm() - 1) > 1e-3) return "its mesh frame";
  if (!s.inertia_shape_m2.allFinite()) return "its inertia";
  if (!size(s.gyration_radius_m) || !size(s.bounding_radius_m) || !size(s.spacing_m)) return "its radii or spacing";
  for (std::size_t i = 0; i < n; ++i) {
    if (!s.position_T[i].allFinite() || !size(s.radius_m[i]) || !size(s.area_m2[i])) return "a point that is nowhere";
    if (!(std::fabs(s.normal_T[i].norm() - 1) < 1e-3f)) return "a normal that is none";
  }
  if (s.level_begin.front() != 0 || s.level_begin.back() != n) return "levels";
  for (std::size_t l = 0; l + 1 < s.level_begin.size(); ++l) {
    const std::uint32_t begin = s.level_begin[l], end = s.level_begin[l + 1];
    if (begin > end) return "levels";
    const std::uint32_t last = l + 2 < s.level_begin.size() ? s.level_begin[l + 2] : end;
    std::uint32_t next = end;  // children of a level tile the next one, in order
    for (std::uint32_t i = begin; i < end; ++i) {
      if (s.child_begin[i] != next || s.child_end[i] < next || s.child_end[i] > last) return "children";
      next = s.child_end[i];
    }
    if (next != last) return "points without a parent";
  }
  return nullptr;
}

}  // namespace

void save_pointshell(const Pointshell& s, const std::filesystem::path& path) {
  Info info{};
  info.points = s.size();
  info.levels = s.level_begin.size() - 1;
  for (int i = 0; i < 3; ++i) info.p_TM[i] = s.X_TM.p[i];
  const double wxyz[4] = {s.X_TM.q.w(), s.X_TM.q.x(), s.X_TM.q.y(), s.X_TM.q.z()};
  std::memcpy(info.q_TM_wxyz, wxyz, sizeof(wxyz));
  for (int i = 0; i < 9; ++i) info.inertia_shape_m2[i] = s.inertia_shape_m2(i / 3, i % 3);
  info.gyration_radius_m = s.gyration_radius_m;
  info.bounding_radius_m = s.bounding_radius_m;
  info.spacing_m = s.spacing_m;
  const std::span<const std::byte> parts[] = {
      std::as_bytes(std::span(&info, 1)),      std::as_bytes(std::span(s.position_T)),
      std::as_bytes(std::span(s.normal_T)),    std::as_bytes(std::span(s.radius_m)),
      std::as_bytes(std::span(s.child_begin)), std::as_bytes(std::span(s.child_end)),
      std::as_bytes(std::span(s.area_m2)),     std::as_bytes(std::span(s.level_begin))};
  write_sealed(path, kKind, s.content_hash, parts);
}

Pointshell load_pointshell(const std::filesystem::path& path, std::uint64_t expected_hash) {
  const SealedFile file = SealedFile::open(path, kKind, expected_hash);
  const auto bad = [&](const char* what) {
    return SetupError(path.string() + ": the pointshell is inconsistent: " + what + ": delete it and bake again");
  };
  const auto payload = file.payload();
  Info info{};
  if (payload.size() < sizeof(info)) throw bad("no counts");
  std::memcpy(&info, payload.data(), sizeof(info));
  constexpr std::uint64_t kMost = 1ull << 31;
  if (info.points >= kMost || info.levels < 1 || info.levels > 64 ||
      payload.size() != sizeof(info) + 40 * info.points + 4 * (info.levels + 1)) {
    throw bad("counts do not fit the size");
  }
  Pointshell s;
  Reader reader{payload.subspan(sizeof(info))};
  reader.take(s.position_T, info.points);
  reader.take(s.normal_T, info.points);
  reader.take(s.radius_m, info.points);
  reader.take(s.child_begin, info.points);
  reader.take(s.child_end, info.points);
  reader.take(s.area_m2, info.points);
  reader.take(s.level_begin, info.levels + 1);
  s.X_TM.p = Vec3(info.p_TM[0], info.p_TM[1], info.p_TM[2]);
  s.X_TM.q = Quat(info.q_TM_wxyz[0], info.q_TM_wxyz[1], info.q_TM_wxyz[2], info.q_TM_wxyz[3]);
  for (int i = 0; i < 9; ++i) s.inertia_shape_m2(i / 3, i % 3) = info.inertia_shape_m2[i];
  s.gyration_radius_m = info.gyration_radius_m;
  s.bounding_radius_m = info.bounding_radius_m;
  s.spacing_m = info.spacing_m;
  s.content_hash = file.content_hash();
  if (const char* what = inconsistency(s)) throw bad(what);
  return s;
}

}  // namespace tact::contact
