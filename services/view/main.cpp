// tact-view: pictures and remote clients. Nobody waits for it; it may come, go and be slow as it likes.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <vector>

#include "fault/fault.hpp"
#include "file/whole_file.hpp"
#include "log/log.hpp"
#include "service/service_main.hpp"
#include "service/stop_signal.hpp"
#include "session/session.hpp"
#include "view/control/conversation.hpp"
#include "view/control/picture_loop.hpp"
#include "view/control/status.hpp"
#include "view/control/studio.hpp"
#include "view/feed/feed.hpp"
#include "view/web/access.hpp"
#include "view/web/web_server.hpp"

namespace tact::view {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::int64_t kPollNs = 16'000'000;  // the pace of the hand: 60 Hz
constexpr auto kStatusPeriod = std::chrono::milliseconds(100);
constexpr auto kShotPatience = std::chrono::seconds(30);

WebOptions web_options(const MachineSpec& machine) {
  WebOptions options;
  options.bind = machine.bind;
  options.port = static_cast<std::uint16_t>(machine.port);
  options.token = machine.token.empty() ? make_token() : machine.token;
  options.page = share_dir() / "page";
  return options;
}

bool up(const ViewScene& scene) { return !scene.info.name.empty() && scene.age_s >= 0; }

/// One picture of the running session into a file.
int shoot(const Session& session, const std::filesystem::path& file, const StopSignal& stop) {
  Feed feed(session);
  SharedScene shared;
  const auto start = Clock::now();
  while (!up(shared.copy())) {
    if (stop.requested()) return kExitOk;
    if (Clock::now() - start > kShotPatience) {
      throw SetupError(file.string() + ": no picture: session \"" + session.name + "\" shows no scene; is it running?");
    }
    feed.poll(shared, kPollNs);
  }
  Studio studio(shared.copy().info, 1);
  feed.poll(shared, kPollNs);
  const ViewScene scene = shared.copy();
  double radius_m = 0;
  write_png(studio.sheet(scene, studio.home(scene, radius_m)), file);
  return kExitOk;
}

int serve(const ServiceOptions& options, const std::filesystem::path& shot) {
  // Configure.
  StopSignal stop;
  const Session session = load_session(options.session_file);
  // Every thread of ours, drawing first of all, gives way to the services that move the arm.
  if (nice(10) == -1) log_debug("cannot lower the priority of the view");
  if (!shot.empty() && !options.check_only) return shoot(session, shot, stop);
  SharedScene shared;
  WebServer* web = nullptr;  // known before anybody can speak to the conversation
  Conversation conversation(shared, [&web](ClientId client, std::string json) {
    client == 0 ? web->send_event_to_all(std::move(json)) : web->send_event(client, std::move(json));
  });
  WebServer server(web_options(session.machine));
  web = &server;
  Feed feed(session);
  if (options.check_only) return kExitOk;
  const std::filesystem::path url_file = session.run_dir / "view_url";
  write_whole(url_file, server.url() + "\n", {.mode = 0600});  // with its token: for the user alone

  // Active: the server and the pictures have threads of their own, this one listens and speaks to the session.
  server.start({[&](ClientId client, bool control) { conversation.joined(client, control); },
                [&](ClientId client) { conversation.left(client); },
                [&](ClientId client, bool control, std::string_view text) {
                  conversation.message(client, control, text, Clock::now());
                }});
  log_info("pictures at port ", server.port(), "; the address with its token is in ", url_file.string());
  feed.say("pictures at port " + std::to_string(server.port()));
  PictureLoop pictures(
      {}, shared, conversation, [&] { return server.clients() > 0; },
      [&](Slot slot, std::string bytes) { server.send_newest(slot, std::move(bytes)); });
  ViewScene before;
  auto next_status = Clock::now();
  while (!stop.requested()) {
    feed.poll(shared, kPollNs);
    const auto now = Clock::now();
    conversation.tick(now);
    if (const auto hand = conversation.next_hand()) feed.publish(*hand);
    for (const ParameterRequest& request : conversation.take_requests()) feed.publish(request);
    for (const ParameterAnswer& answer : feed.take_answers()) conversation.answered(answer);
    if (now < next_status) continue;
    next_status = now + kStatusPeriod;
    ViewScene scene = shared.copy();
    for (const std::string& event : change_events(before, scene)) server.send_event_to_all(event);
    server.send_newest(Slot::status, status_json(scene, {conversation.holder(), server.clients(),
                                                         pictures.frames_per_s(), pictures.cpu_ms_per_frame()}));
    before = std::move(scene);
  }
  if (conversation.holder() != 0) feed.publish(HandCommand{shared.copy().device.X_WM, false});
  return kExitOk;
}

}  // namespace
}  // namespace tact::view

int main(int argc, char** argv) {
  // --shot FILE is ours; the rest is every service's.
  std::filesystem::path shot;
  std::vector<char*> rest;
  for (int i = 0; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--shot" && i + 1 < argc) {
      shot = argv[++i];
    } else {
      rest.push_back(argv[i]);
    }
  }
  rest.push_back(nullptr);
  return tact::service_main("tact-view", static_cast<int>(rest.size()) - 1, rest.data(),
                            [&shot](const tact::ServiceOptions& options) { return tact::view::serve(options, shot); });
}
