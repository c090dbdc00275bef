#include "view/web/web_client.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/websocket.hpp>

#include <algorithm>
#include <chrono>

#include "view/web/progress.hpp"

namespace tact::view {

namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

constexpr int kLooks = 4;  // in max_silence

}  // namespace

WebClient::WebClient(WebLoop& loop, beast::tcp_stream stream, std::shared_ptr<Seat> seat, bool control)
    : may_control(control),
      loop_(loop),
      socket_(std::move(stream)),
      seat_(std::move(seat)),
      breath_(loop.io),
      pulse_(loop.io),
      allowance_(loop.options.messages_per_s),
      outbox_(loop.options.max_events) {}

void WebClient::accept(HttpRequest request) {
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket's own time limits take over
  socket_.set_option(websocket::stream_base::timeout{std::chrono::seconds(10), websocket::stream_base::none(), false});
  socket_.read_message_max(loop_.options.max_message_bytes);
  socket_.auto_fragment(false);
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (error) return;
    self->last_read_ = std::chrono::steady_clock::now();
    self->loop_.join(self);
    self->joined_ = true;
    self->read();
    self->watch();
  });
}

// A client that takes nothing for a while is stopped, or its link is cut. Pings would not tell: on a slow link their
// answer waits behind pictures, and a client that takes a little at a time is not gone.
void WebClient::watch() {
  pulse_.expires_after(loop_.options.max_silence / kLooks);
  pulse_.async_wait([self = shared_from_this()](beast::error_code error) {
    if (error) return;
    const Progress now = progress_of(beast::get_lowest_layer(self->socket_).socket().native_handle());
    const bool took = now.nothing_waits || now.taken_bytes != self->taken_bytes_;
    self->taken_bytes_ = now.taken_bytes;
    self->still_ = took ? 0 : self->still_ + 1;
    if (!self->closing_ && self->still_ < kLooks) return self->watch();
    self->cut();
  });
}

void WebClient::read() {
  socket_.async_read(incoming_, [self = shared_from_this()](beast::error_code error, std::size_t bytes) {
    if (error) return self->cut();  // gone, or a message too big: Beast has told it why
    self->heard(bytes);
  });
}

void WebClient::heard(std::size_t bytes) {
  if (!socket_.got_text()) return close(websocket::close_code::unknown_data, "text only");
  const auto now = std::chrono::steady_clock::now();
  const double rate = loop_.options.messages_per_s;
  allowance_ = std::min(rate, allowance_ + rate * std::chrono::duration<double>(now - last_read_).count()) - 1;
  last_read_ = now;
  const auto data = incoming_.cdata();
  loop_.handlers.message(id, may_control, {static_cast<const char*>(data.data()), bytes});
  incoming_.consume(bytes);
  if (closing_) return;
  if (allowance_ >= 0) return read();
  // Too fast: what it sends meanwhile fills its own socket, not our memory.
  breath_.expires_after(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(-allowance_ / rate)));
  breath_.async_wait([self = shared_from_this()](beast::error_code error) {
    if (!error && !self->closing_) self->read();
  });
}

void WebClient::send_event(Payload event) {
  if (closing_) return;
  if (!outbox_.push_event(std::move(event)))
    return close(websocket::close_code::try_again_later, "too slow: events pile up");
  write();
}

void WebClient::put(Slot slot, Payload newest) {
  if (closing_) return;
  outbox_.put(slot, std::move(newest));
  write();
}

void WebClient::write() {
  if (in_flight_ || closing_) return;
  auto item = outbox_.next();
  if (!item) return;
  in_flight_ = std::move(item->payload);
  socket_.binary(item->binary);
  socket_.async_write(boost::asio::buffer(*in_flight_),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->in_flight_.reset();
                        if (error) return self->cut();
                        self->write();
                      });
}

void WebClient::close(websocket::close_code code, const char* reason) {
  if (closing_) return;
  leave();
  watch();  // a client that does not even take the goodbye is cut off
  socket_.async_close({code, reason}, [self = shared_from_this()](beast::error_code) { self->cut(); });
}

void WebClient::leave() {
  closing_ = true;
  breath_.cancel();
  if (joined_) loop_.leave(id);
  joined_ = false;
}

// Whatever still waits on the socket ends with it: a client that said goodbye but takes nothing would hold a write, and
// with it this object and its seat, for as long as it likes.
void WebClient::cut() {
  leave();
  pulse_.cancel();
  beast::get_lowest_layer(socket_).close();
}

}  // namespace tact::view
