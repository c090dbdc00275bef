#include "view/control/picture_loop.hpp"

#include <ctime>

#include "fault/fault.hpp"
#include "log/log.hpp"
#include "view/control/studio.hpp"
#include "view/render/gauss_map.hpp"
#include "view/render/strips.hpp"

namespace tact::view {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr auto kIdle = std::chrono::milliseconds(30);  // between two looks whether somebody watches
constexpr int kPictureQuality = 82, kPlotQuality = 90, kPlotSize = 480;

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

PictureLoop::PictureLoop(const PictureOptions& options, const SharedScene& scene, Conversation& conversation,
                         std::function<bool()> watched, Publish publish)
    : options_(options),
      scene_(scene),
      conversation_(conversation),
      watched_(std::move(watched)),
      publish_(std::move(publish)),
      thread_([this] { run(); }) {}

PictureLoop::~PictureLoop() {
  stop_ = true;
  thread_.join();
}

void PictureLoop::run() {
  std::unique_ptr<Studio> studio;
  std::optional<SceneInfo> refused;  // could not be loaded: not tried again
  int frame = 0;
  Clock::time_point last{};
  while (!stop_) {
    const ViewScene scene = watched_() ? scene_.copy() : ViewScene{};
    const bool known_bad = refused && refused->server_epoch == scene.info.server_epoch;
    if (scene.info.name.empty() || known_bad) {
      frames_per_s_ = 0;
      std::this_thread::sleep_for(kIdle);
      continue;
    }
    const auto start = Clock::now();
    const double cpu_start = cpu_ms();
    if (!studio || !studio->shows(scene.info)) {
      try {
        studio.reset();
        studio = std::make_unique<Studio>(scene.info, 1);
        log_info("first viewer: bodies loaded and trees built in ", studio->seconds(), " s");
      } catch (const SetupError& error) {
        log_error(error.what());
        refused = scene.info;
        continue;
      }
      double radius_m = 0;
      const Camera home = studio->home(scene, radius_m);
      conversation_.set_home(home, 3 * radius_m);
      frame = 0;
      last = {};
    }
    const Camera camera = conversation_.camera();
    publish_(Slot::picture,
             encode_jpeg(studio->picture(scene, camera, options_.width, options_.height), kPictureQuality));
    if (frame++ % options_.plot_every == 0) {
      publish_(Slot::gauss_map, encode_jpeg(draw_gauss_map(scene, camera, kPlotSize), kPlotQuality));
      const Image slice = studio->slice(scene, camera, kPlotSize);
      if (slice.width > 0) publish_(Slot::slice, encode_jpeg(slice, kPlotQuality));
      publish_(Slot::strips, encode_jpeg(draw_strips(scene, 1280, 360), kPlotQuality));
    }
    const double smooth = frame == 1 ? 1.0 : 0.1;
    cpu_ms_per_frame_ = cpu_ms_per_frame_ + smooth * (cpu_ms() - cpu_start - cpu_ms_per_frame_);
    if (last != Clock::time_point{}) {
      const double now_per_s = 1 / Seconds(start - last).count();
      frames_per_s_ = frames_per_s_ == 0 ? now_per_s : frames_per_s_ + smooth * (now_per_s - frames_per_s_);
    }
    last = start;
    const double period_s = std::max(1 / options_.max_frames_per_s, 1e-3 * cpu_ms_per_frame_ / options_.max_load);
    std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(Seconds(period_s)));
  }
}

}  // namespace tact::view
