#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "view/model/camera.hpp"
#include "view/model/hand.hpp"
#include "view/model/requests.hpp"
#include "view/model/shared_scene.hpp"

namespace tact::view {

/// What clients say, and what comes of it. The messages (JSON; README.md has the table) move the hand, the camera and
/// the parameters; all of them need control. One client at a time holds the hand: the one that took it first, until it
/// lets go, leaves, or falls silent for a second. All clients share one camera: one picture serves them all.
///
/// No threads, no clock, no sockets of its own: time is passed in. Safe from any thread.
class Conversation {
 public:
  using Clock = std::chrono::steady_clock;
  /// Delivers an event; client 0: to all. Called with no lock held.
  using Send = std::function<void(std::uint64_t client, std::string json)>;

  Conversation(const SharedScene& scene, Send send) : scene_(scene), send_(std::move(send)) {}

  void joined(std::uint64_t client, bool may_control);
  void left(std::uint64_t client);
  void message(std::uint64_t client, bool may_control, std::string_view text, Clock::time_point now);

  /// Lets go for a holder that fell silent; says so for requests that nobody answered.
  void tick(Clock::time_point now);

  /// To publish, at the pace of the caller: while held always, once after letting go.
  std::optional<HandCommand> next_hand();
  std::vector<ParameterRequest> take_requests();
  void answered(const ParameterAnswer& answer);

  std::uint64_t holder() const;  ///< 0: nobody

  Camera camera() const;
  /// Where a reset of the camera goes; the first call also goes there.
  void set_home(const Camera& home, double reach_m);

 private:
  struct Asked {
    std::uint64_t client;
    std::string key;
    Clock::time_point when;
  };
  struct Event {
    std::uint64_t client;
    std::string json;
  };
  using Events = std::vector<Event>;

  void act(std::uint64_t client, std::string_view text, Clock::time_point now, Events& events);
  void take(std::uint64_t client, Clock::time_point now, Events& events);
  void let_go(Events& events);
  void deliver(const Events& events) const;

  const SharedScene& scene_;
  Send send_;

  mutable std::mutex mutex_;
  std::uint64_t holder_ = 0;
  Clock::time_point heard_{};
  bool released_ = false;  // a hold = false is still to be published
  MouseHand hand_;
  Camera camera_, home_;
  bool has_home_ = false;
  double reach_m_ = 1;
  std::uint64_t next_request_ = 1;
  std::vector<ParameterRequest> requests_;
  std::map<std::uint64_t, Asked> asked_;
};

}  // namespace tact::view
