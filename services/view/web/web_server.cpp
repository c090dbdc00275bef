#include "view/web/web_server.hpp"

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include "fault/fault.hpp"
#include "view/web/listen.hpp"
#include "view/web/web_client.hpp"
#include "view/web/web_loop.hpp"

namespace tact::view {

using boost::asio::ip::tcp;

WebLoop::WebLoop(const WebOptions& o) : options(o), files(o.page), acceptor(listen_on(io, o.bind, o.port)) {
  TACT_CHECK(!options.token.empty());
  access.token = options.token;
  access.loopback = acceptor.local_endpoint().address().is_loopback();
  access.cookie_name = "tact_token_" + std::to_string(acceptor.local_endpoint().port());
}

void WebLoop::accept() {
  acceptor.async_accept([this](boost::system::error_code error, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (!error && connections < options.max_connections) serve_connection(*this, std::move(socket));
    if (!error) return accept();
    // Out of file descriptors, most likely: others may leave.
    auto pause = std::make_shared<boost::asio::steady_timer>(io, std::chrono::milliseconds(200));
    pause->async_wait([this, pause](boost::system::error_code) { accept(); });
  });
}

void WebLoop::join(const std::shared_ptr<WebClient>& client) {
  client->id = next_id++;
  clients[client->id] = client;
  client_count = clients.size();
  handlers.joined(client->id, client->may_control);
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    if (newest[slot]) client->put(static_cast<Slot>(slot), newest[slot]);
  }
}

void WebLoop::leave(ClientId id) {
  clients.erase(id);
  client_count = clients.size();
  if (clients.empty()) newest = {};  // a picture of long ago is not the current scene
  handlers.left(id);
}

void WebLoop::hand_out_fresh() {
  std::array<Payload, kSlots> parts;
  {
    const std::lock_guard lock(mutex);
    parts.swap(fresh);
    handing_out = false;
  }
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    if (!parts[slot]) continue;
    if (!clients.empty()) newest[slot] = parts[slot];
    for (const auto& [id, client] : clients) client->put(static_cast<Slot>(slot), parts[slot]);
  }
}

WebServer::WebServer(const WebOptions& options) : loop_(std::make_unique<WebLoop>(options)) {}

void WebServer::start(WebHandlers handlers) {
  loop_->handlers = std::move(handlers);
  loop_->accept();
  loop_->thread = std::thread([loop = loop_.get()] { loop->io.run(); });
}

WebServer::~WebServer() {
  if (!loop_->thread.joinable()) return;
  boost::asio::post(loop_->io, [loop = loop_.get()] {
    loop->acceptor.close();
    const auto leaving = loop->clients;
    for (const auto& [id, client] : leaving)
      client->close(boost::beast::websocket::close_code::going_away, "the viewer ends");
    // Long enough for the goodbyes to go out; nobody is waited for.
    auto grace =
        std::make_shared<boost::asio::steady_timer>(loop->io, std::chrono::milliseconds(leaving.empty() ? 0 : 200));
    grace->async_wait([loop, grace](boost::system::error_code) { loop->io.stop(); });
  });
  loop_->thread.join();
}

std::uint16_t WebServer::port() const { return loop_->acceptor.local_endpoint().port(); }

std::string WebServer::url() const {
  const auto address = loop_->acceptor.local_endpoint().address();
  const std::string name = address.is_unspecified() ? "127.0.0.1"
                           : address.is_v6()        ? "[" + address.to_string() + "]"
                                                    : address.to_string();
  return "http://" + name + ":" + std::to_string(port()) + "/?token=" + loop_->options.token;
}

std::size_t WebServer::clients() const { return loop_->client_count; }

void WebServer::send_event(ClientId client, std::string text) {
  auto event = std::make_shared<const std::string>(std::move(text));
  boost::asio::post(loop_->io, [loop = loop_.get(), client, event] {
    const auto found = loop->clients.find(client);
    if (found == loop->clients.end()) return;
    const auto kept = found->second;
    kept->send_event(event);
  });
}

void WebServer::send_event_to_all(std::string text) {
  auto event = std::make_shared<const std::string>(std::move(text));
  boost::asio::post(loop_->io, [loop = loop_.get(), event] {
    const auto members = loop->clients;  // one that is too slow leaves the map
    for (const auto& [id, client] : members) client->send_event(event);
  });
}

void WebServer::send_newest(Slot slot, std::string bytes) {
  constexpr char kLetters[] = {0, 'p', 'g', 's', 't'};
  if (slot != Slot::status) bytes.insert(bytes.begin(), kLetters[static_cast<std::size_t>(slot)]);
  auto payload = std::make_shared<const std::string>(std::move(bytes));
  {
    const std::lock_guard lock(loop_->mutex);
    loop_->fresh[static_cast<std::size_t>(slot)] = std::move(payload);
    if (std::exchange(loop_->handing_out, true)) return;
  }
  boost::asio::post(loop_->io, [loop = loop_.get()] { loop->hand_out_fresh(); });
}

}  // namespace tact::view
