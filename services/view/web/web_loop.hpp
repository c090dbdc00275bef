#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "view/web/access.hpp"
#include "view/web/page_files.hpp"
#include "view/web/web_server.hpp"

namespace tact::view {

using HttpRequest = boost::beast::http::request<boost::beast::http::empty_body>;

class WebClient;

/// The inside of the server. Everything belongs to its thread, except the atomic and what the mutex guards.
struct WebLoop {
  explicit WebLoop(const WebOptions& o);

  void accept();
  void join(const std::shared_ptr<WebClient>& client);
  void leave(ClientId id);
  void hand_out_fresh();

  WebOptions options;
  WebHandlers handlers;
  PageFiles files;
  std::size_t connections = 0;  ///< before io, whose last handlers still count down
  boost::asio::io_context io{1};
  boost::asio::ip::tcp::acceptor acceptor;
  Access access;
  std::map<ClientId, std::shared_ptr<WebClient>> clients;
  std::array<Payload, kSlots> newest;
  ClientId next_id = 1;
  std::atomic<std::size_t> client_count{0};

  std::mutex mutex;
  std::array<Payload, kSlots> fresh;  ///< guarded: to be handed out
  bool handing_out = false;           ///< guarded: hand_out_fresh is on its way

  std::thread thread;
};

/// Counts an open connection for as long as anybody holds it.
class Seat {
 public:
  explicit Seat(std::size_t& count) : count_(count) { ++count_; }
  ~Seat() { --count_; }
  Seat(const Seat&) = delete;
  Seat& operator=(const Seat&) = delete;

 private:
  std::size_t& count_;
};

/// Answers the requests of one connection; a request for /ws becomes a WebClient.
void serve_connection(WebLoop& loop, boost::asio::ip::tcp::socket socket);

}  // namespace tact::view
