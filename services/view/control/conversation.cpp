#include "view/control/conversation.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace tact::view {
namespace {

using Json = nlohmann::json;

constexpr auto kSilence = std::chrono::seconds(1);
constexpr auto kAnswerTime = std::chrono::seconds(2);
constexpr std::size_t kMaxAsked = 64;

struct Settable {
  const char *key, *service;
};
constexpr std::array<Settable, 4> kSettable{{{"contact.law", "contact"},
                                             {"contact.stiffness_n_per_m", "contact"},
                                             {"coupling.saturation", "coupling"},
                                             {"coupling.kind", "coupling"}}};

std::string error(const std::string& message) { return Json{{"type", "error"}, {"message", message}}.dump(); }

double number(const Json& json, const char* key) { return json.value(key, 0.0); }

}  // namespace

void Conversation::joined(std::uint64_t client, bool may_control) {
  Json hello{{"type", "hello"},
             {"you", client},
             {"control", may_control},
             {"laws", {"none", "global", "cluster", "adaptive-3dof", "adaptive-6dof", "potential"}},
             {"holder", holder()}};
  send_(client, hello.dump());
}

void Conversation::left(std::uint64_t client) {
  Events events;
  {
    const std::lock_guard lock(mutex_);
    if (holder_ == client) let_go(events);
  }
  deliver(events);
}

void Conversation::message(std::uint64_t client, bool may_control, std::string_view text, Clock::time_point now) {
  Events events;
  if (!may_control) {
    events.push_back({client, error("Only watching: open the address with the token to take hold.")});
  } else {
    try {
      const std::lock_guard lock(mutex_);
      act(client, text, now, events);
    } catch (const Json::exception&) {
      events.push_back({client, error("A message that is not understood was ignored.")});
    }
  }
  deliver(events);
}

void Conversation::act(std::uint64_t client, std::string_view text, Clock::time_point now, Events& events) {
  const Json json = Json::parse(text);
  const std::string type = json.at("type");
  if (type == "take") {
    take(client, now, events);
  } else if (type == "move" || type == "keep") {
    if (holder_ != client) return;  // let go meanwhile: late movements mean nothing
    heard_ = now;
    if (type == "move") {
      hand_.move({number(json, "dx"), number(json, "dy"), number(json, "dz"), number(json, "rx"), number(json, "ry"),
                  number(json, "rz")},
                 camera_);
    }
  } else if (type == "drop") {
    if (holder_ == client) let_go(events);
  } else if (type == "orbit") {
    const double yaw = number(json, "yaw"), pitch = number(json, "pitch"), zoom = json.value("zoom", 1.0);
    if (!std::isfinite(yaw) || !std::isfinite(pitch) || !(zoom > 0)) return;
    Camera next = camera_;
    next.orbit(yaw, pitch, zoom);
    next.distance_m = std::clamp(next.distance_m, 0.02 * home_.distance_m, 10 * home_.distance_m);
    camera_ = next;
  } else if (type == "home") {
    camera_ = home_;
  } else if (type == "set") {
    const std::string key = json.at("key"), value = json.at("value");
    const auto settable =
        std::find_if(kSettable.begin(), kSettable.end(), [&](const Settable& s) { return key == s.key; });
    if (settable == kSettable.end() || value.size() > 64) {
      events.push_back({client, error("This cannot be changed from here.")});
    } else if (asked_.size() >= kMaxAsked) {
      events.push_back({client, error("Too many changes wait for an answer.")});
    } else {
      requests_.push_back({next_request_, settable->service, key, value});
      asked_[next_request_++] = {client, key, now};
    }
  } else {
    events.push_back({client, error("A message of an unknown type was ignored.")});
  }
}

void Conversation::take(std::uint64_t client, Clock::time_point now, Events& events) {
  if (holder_ != 0 && holder_ != client) {
    events.push_back({client, error("Another viewer holds the part.")});
    return;
  }
  heard_ = now;
  if (holder_ == client) return;
  const ViewScene scene = scene_.copy();
  if (scene.age_s < 0) {
    events.push_back({client, error("No device yet: there is nothing to hold.")});
    return;
  }
  holder_ = client;
  released_ = false;
  hand_.take(scene.device.X_WH, scene.info.X_TM, home_.target_W, reach_m_);
  events.push_back({0, Json{{"type", "hand"}, {"holder", holder_}}.dump()});
}

void Conversation::let_go(Events& events) {
  holder_ = 0;
  released_ = true;
  events.push_back({0, Json{{"type", "hand"}, {"holder", 0}}.dump()});
}

void Conversation::tick(Clock::time_point now) {
  Events events;
  {
    const std::lock_guard lock(mutex_);
    if (holder_ != 0 && now - heard_ > kSilence) let_go(events);
    for (auto it = asked_.begin(); it != asked_.end();) {
      if (now - it->second.when < kAnswerTime) {
        ++it;
        continue;
      }
      events.push_back({it->second.client, Json{{"type", "answer"},
                                                {"key", it->second.key},
                                                {"accepted", false},
                                                {"message", "No answer: the service that owns it does not run."}}
                                               .dump()});
      it = asked_.erase(it);
    }
  }
  deliver(events);
}

std::optional<HandCommand> Conversation::next_hand() {
  const std::lock_guard lock(mutex_);
  if (holder_ != 0) return HandCommand{hand_.X_WM(), true};
  if (!std::exchange(released_, false)) return std::nullopt;
  return HandCommand{hand_.X_WM(), false};
}

std::vector<ParameterRequest> Conversation::take_requests() {
  const std::lock_guard lock(mutex_);
  return std::exchange(requests_, {});
}

void Conversation::answered(const ParameterAnswer& answer) {
  Events events;
  {
    const std::lock_guard lock(mutex_);
    const auto asked = asked_.find(answer.request_id);
    if (asked == asked_.end()) return;
    // Everybody sees a change; only who asked hears why there is none.
    events.push_back({answer.accepted ? 0 : asked->second.client, Json{{"type", "answer"},
                                                                       {"key", answer.key},
                                                                       {"value", answer.value},
                                                                       {"accepted", answer.accepted},
                                                                       {"message", answer.message}}
                                                                      .dump()});
    asked_.erase(asked);
  }
  deliver(events);
}

std::uint64_t Conversation::holder() const {
  const std::lock_guard lock(mutex_);
  return holder_;
}

Camera Conversation::camera() const {
  const std::lock_guard lock(mutex_);
  return camera_;
}

void Conversation::set_home(const Camera& home, double reach_m) {
  const std::lock_guard lock(mutex_);
  home_ = home;
  reach_m_ = reach_m;
  if (!std::exchange(has_home_, true)) camera_ = home;
}

void Conversation::deliver(const Events& events) const {
  for (const Event& event : events) send_(event.client, event.json);
}

}  // namespace tact::view
