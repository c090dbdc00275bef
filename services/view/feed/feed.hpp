#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "session/session.hpp"
#include "view/model/requests.hpp"
#include "view/model/shared_scene.hpp"

namespace tact::view {

/// The view's ear and voice on the session's topics: messages of the wire become a ViewScene, requests of clients
/// become messages. Low-rate topics only; nobody waits for us. One thread at a time.
class Feed {
 public:
  /// Joins the session and says so (Health "view"). Throws SetupError.
  explicit Feed(const Session& session);
  ~Feed();

  /// Takes in what has arrived, sleeping up to `timeout_ns` for it. Contacts older than half a second are forgotten:
  /// their server has gone.
  void poll(SharedScene& scene, std::int64_t timeout_ns);

  /// Answers to our own requests since the last call.
  std::vector<ParameterAnswer> take_answers();

  void publish(const HandCommand& hand);
  void publish(const ParameterRequest& request);

  /// One sentence for people who ask how the view is.
  void say(const std::string& detail);

 private:
  struct Wire;
  std::unique_ptr<Wire> wire_;
};

}  // namespace tact::view
