#include "contact/bake/baked_scene.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>

#include "contact/bake/bake_report.hpp"
#include "contact/bake/content_key.hpp"
#include "contact/model/pointshell.hpp"
#include "fault/fault.hpp"
#include "field/distance_field.hpp"
#include "mesh/mesh.hpp"

namespace tact::contact {
namespace {

/// Holds a file lock; waits for it if need be.
class FileLock {
 public:
  FileLock(const std::filesystem::path& path, const std::string& part, const BakeProgress& progress)
      : fd_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (fd_ < 0) {
      throw SetupError(path.string() + ": cannot write to the cache: " + std::strerror(errno) +
                       ": free space, fix its permissions or set cache.dir");
    }
    while (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      if (errno != EINTR && errno != EWOULDBLOCK) {
        const int error = errno;
        ::close(fd_);
        throw SetupError(path.string() + ": cannot lock: " + std::strerror(error));
      }
      if (progress && !progress({part, "waiting", 0})) {
        ::close(fd_);
        throw SetupError("bake: cancelled");
      }
      ::usleep(50'000);
    }
  }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock() { ::close(fd_); }

 private:
  int fd_;
};

/// A file of our own for the child to read; removed afterwards.
struct TemporaryFile {
  std::filesystem::path path;
  explicit TemporaryFile(const std::filesystem::path& folder) {
    std::string name = (folder / "bake-session-XXXXXX").string();
    const int fd = ::mkostemp(name.data(), O_CLOEXEC);
    if (fd < 0) {
      throw SetupError(folder.string() + ": cannot write to the cache: " + std::strerror(errno) +
                       ": free space, fix its permissions or set cache.dir");
    }
    ::close(fd);
    path = name;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

struct Part {
  BakedPart part;
  const char* name;  ///< "obstacle", "tool"
  const BodySpec& body;
  std::uint64_t key;
  BakedFiles files;
  void (*check)(const BakedFiles&, std::uint64_t key);  ///< throws SetupError
};

/// The body if all its files are there and sound; `refused` says why files that are there are not.
std::optional<BakedBody> look_up(const Part& part, BakeReport& report, std::string& refused) {
  std::error_code error;
  for (const auto& path : {part.files.data, part.files.mesh, part.files.report}) {
    if (!std::filesystem::exists(path, error)) return std::nullopt;
  }
  BakedBody body{part.files.data, part.files.mesh, part.files.report, part.key, true, 0, 0, 0, {}};
  try {
    part.check(part.files, part.key);
    load_mesh(part.files.mesh);
    report = read_bake_report(part.files.report, part.part);
    body.bake_seconds = report.seconds;
    body.bake_peak_bytes = report.peak_memory_bytes;
    body.warnings = report.warnings;
    body.bytes = std::filesystem::file_size(part.files.data);
  } catch (const std::exception& reason) {  // damaged, foreign or of an old schema: made anew
    refused = reason.what();
    return std::nullopt;
  }
  return body;
}

/// Removes the files of one bake and what a killed child left half-written beside them: all but the lock, which the
/// caller holds.
void remove(const BakedFiles& files) {
  std::error_code ignored;
  const std::string stem = files.lock.stem().string() + ".", lock = files.lock.filename().string();
  for (std::filesystem::directory_iterator it(files.lock.parent_path(), ignored), end; !ignored && it != end;
       it.increment(ignored)) {
    const std::string name = it->path().filename().string();
    std::error_code unlucky;
    if (name.rfind(stem, 0) == 0 && name != lock) std::filesystem::remove(it->path(), unlucky);
  }
}

/// Leaves nothing of a bake that did not end well.
class Cleaner {
 public:
  explicit Cleaner(const BakedFiles& files) : files_(&files) { remove(files); }
  Cleaner(const Cleaner&) = delete;
  Cleaner& operator=(const Cleaner&) = delete;
  ~Cleaner() {
    if (files_ != nullptr) remove(*files_);
  }
  void keep() { files_ = nullptr; }

 private:
  const BakedFiles* files_;
};

/// From the cache, or baked by the child.
BakedBody ensure_part(const SceneSpec& scene, const Part& part, const std::filesystem::path& cache,
                      const BakeProgress& progress, const std::filesystem::path& program, BakeReport& report) {
  std::string refused;
  if (auto found = look_up(part, report, refused)) return *found;
  const FileLock lock(part.files.lock, part.name, progress);
  if (auto found = look_up(part, report, refused)) return *found;  // another process was faster
  Cleaner cleaner(part.files);
  const TemporaryFile session_file(cache);
  Session session;
  session.name = "bake";
  session.run_dir = cache;
  session.scene = scene;
  save_session(session, session_file.path);
  const ChildEnd end = run_bake_child({program.string(), "--session", session_file.path.string(), "--cache",
                                       cache.string(), "--part", part.name, "--progress"},
                                      progress);
  if (!end.good) {
    throw SetupError(!end.error.empty() ? end.error
                                        : body_name(part.body) + ": the bake of this mesh " + end.how +
                                              ": repair or simplify the mesh, or lower the resolution");
  }
  std::string unsound;
  auto baked = look_up(part, report, unsound);
  if (!baked)
    throw SetupError(part.files.data.string() + ": the bake ended well but its files do not read back: " + unsound);
  cleaner.keep();
  baked->from_cache = false;
  if (!refused.empty()) baked->warnings.push_back(refused + "; baked anew");
  return *baked;
}

/// Whether a thin part of the obstacle may pass between the points: a hole between them is twice as wide as its middle
/// is far from the nearest.
void check_coverage(const SceneSpec& scene, BakedScene& baked) {
  const double gap_m = baked.largest_gap_voxels * baked.voxel_m;
  if (!baked.thinnest_wall_m || *baked.thinnest_wall_m >= 2 * gap_m) return;
  char text[256];
  std::snprintf(text, sizeof(text),
                ": the widest hole between its points is %.3g mm (%.3g voxels), and the thinnest wall of the obstacle "
                "is %.3g mm: it may slip through; more tool.points or a smaller tool.spacing_voxels closes holes",
                2e3 * gap_m, 2 * baked.largest_gap_voxels, 1e3 * *baked.thinnest_wall_m);
  baked.tool.warnings.push_back(body_name(scene.tool) + text);
}

}  // namespace

BakedScene ensure_baked(const SceneSpec& scene, const std::filesystem::path& cache, const BakeProgress& progress,
                        const std::filesystem::path& program) {
  std::error_code error;
  std::filesystem::create_directories(cache, error);
  if (error) {
    throw SetupError(cache.string() + ": cannot make the cache folder: " + error.message() +
                     ": set cache.dir or TACT_CACHE");
  }
  const std::uint64_t field_key = obstacle_key(scene);
  const BakedFiles field_files = obstacle_files(cache, field_key);
  const auto check_field = [](const BakedFiles& f, std::uint64_t key) { DistanceField::open(f.data, key); };
  const auto check_shell = [](const BakedFiles& f, std::uint64_t key) { load_pointshell(f.data, key); };
  BakedScene baked;
  BakeReport report;
  baked.obstacle =
      ensure_part(scene, {BakedPart::obstacle, "obstacle", scene.obstacle, field_key, field_files, check_field}, cache,
                  progress, program, report);
  baked.voxel_m = report.voxel_m;
  baked.field_error_max_m = report.error_max_m;
  baked.field_error_rms_m = report.error_rms_m;
  baked.thinnest_wall_m = report.thinnest_wall_m;
  baked.narrowest_gap_m = report.narrowest_gap_m;

  const std::uint64_t shell_key = tool_key(scene, tool_spacing_m(scene, field_files));
  baked.tool =
      ensure_part(scene, {BakedPart::tool, "tool", scene.tool, shell_key, tool_files(cache, shell_key), check_shell},
                  cache, progress, program, report);
  baked.points = report.points;
  baked.largest_gap_voxels = report.largest_gap_m / baked.voxel_m;
  check_coverage(scene, baked);
  return baked;
}

}  // namespace tact::contact
