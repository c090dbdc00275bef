#pragma once
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>

#include "view/web/web_loop.hpp"

namespace tact::view {

/// One WebSocket: reads messages no faster than allowed, writes what its outbox holds, one at a time.
class WebClient : public std::enable_shared_from_this<WebClient> {
 public:
  WebClient(WebLoop& loop, boost::beast::tcp_stream stream, std::shared_ptr<Seat> seat, bool may_control);

  void accept(HttpRequest request);
  void send_event(Payload event);
  void put(Slot slot, Payload newest);
  void close(boost::beast::websocket::close_code code, const char* reason);

  ClientId id = 0;
  const bool may_control;

 private:
  void read();
  void heard(std::size_t bytes);
  void write();
  void watch();
  void leave();  ///< gets and says nothing more; until the end, watch() runs on
  void cut();    ///< the end: nothing is left to wait for

  WebLoop& loop_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  std::shared_ptr<Seat> seat_;
  boost::beast::flat_buffer incoming_;
  boost::asio::steady_timer breath_, pulse_;
  double allowance_;
  std::chrono::steady_clock::time_point last_read_{};
  std::uint64_t taken_bytes_ = 0;
  int still_ = 0;  ///< looks since it last took something
  Outbox outbox_;
  Payload in_flight_;
  bool joined_ = false, closing_ = false;
};

}  // namespace tact::view
