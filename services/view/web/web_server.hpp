#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "view/web/outbox.hpp"

namespace tact::view {

using ClientId = std::uint64_t;

struct WebOptions {
  std::string bind = "127.0.0.1";  ///< an address of this machine; anything but loopback needs the token for everything
  std::uint16_t port = 8080;       ///< 0: any free one
  std::string token;               ///< never empty
  std::filesystem::path page;      ///< folder of the page's files
  std::size_t max_connections = 64;  ///< of any kind; more are closed at once
  std::size_t max_clients = 24;      ///< WebSockets
  std::size_t max_events = 256;      ///< waiting for one client, which is dropped beyond
  std::size_t max_message_bytes = 4096;
  std::chrono::milliseconds max_silence{12000};  ///< a client that takes nothing for so long is gone
  double messages_per_s = 200;                   ///< of one client; beyond, its next message is simply read later
};

/// Who came, who went, what they said: called on the server's thread, must not wait. `may_control`: the client showed
/// the token.
struct WebHandlers {
  std::function<void(ClientId, bool may_control)> joined;
  std::function<void(ClientId)> left;
  std::function<void(ClientId, bool may_control, std::string_view text)> message;
};

struct WebLoop;

/// HTTP for the page and one WebSocket a client at /ws, in a thread of its own. No client can slow another or the
/// callers down: every buffer is bounded (see Outbox), every call here returns at once.
class WebServer {
 public:
  /// Reads the page and takes the address. Throws SetupError, naming machine.bind or machine.port, when it cannot be
  /// had.
  explicit WebServer(const WebOptions& options);
  /// Tells the clients goodbye and ends the thread.
  ~WebServer();

  /// Lets clients in. Once.
  void start(WebHandlers handlers);

  std::uint16_t port() const;
  /// Address for a browser on this machine (or on the network, when bound to one address); the token in it allows
  /// control.
  std::string url() const;
  std::size_t clients() const;

  /// Never dropped, in order. To one client, or to all.
  void send_event(ClientId client, std::string text);
  void send_event_to_all(std::string text);
  /// Newest wins. The newest of each slot is also what a client gets first when it joins. Status goes as text, the
  /// others as binary messages: a letter (p, g, s, t: picture, Gauss map, slice, strips), then the bytes.
  void send_newest(Slot slot, std::string bytes);

 private:
  std::unique_ptr<WebLoop> loop_;
};

}  // namespace tact::view
