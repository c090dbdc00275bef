#pragma once
#include <boost/asio/connect.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include <nlohmann/json.hpp>
#include <string>

namespace tact::test {

/// A watcher of few words, over a socket that is a tcp::socket or behaves like one.
template <class Socket>
class BasicWatcher {
 public:
  BasicWatcher(const std::string& host, unsigned short port, const std::string& token) : socket_(io_) {
    socket_.next_layer().connect({boost::asio::ip::make_address(host), port});
    socket_.handshake(host + ":" + std::to_string(port), token.empty() ? "/ws" : "/ws?token=" + token);
  }
  std::string receive() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    return boost::beast::buffers_to_string(buffer.data());
  }
  /// The next message of that type.
  nlohmann::json event(const std::string& type) {
    for (;;) {
      const std::string text = receive();
      if (!socket_.got_text()) continue;
      const nlohmann::json json = nlohmann::json::parse(text);
      if (json["type"] == type) return json;
    }
  }
  /// The next JPEG of that letter.
  std::string frame(char letter) {
    for (;;) {
      const std::string bytes = receive();
      if (socket_.got_binary() && bytes[0] == letter) return bytes.substr(1);
    }
  }
  /// Takes hold, once there is a device to hold.
  void take() {
    while (event("status")["age_s"] < 0) {
    }
    say(R"({"type":"take"})");
  }
  void say(const std::string& text) { socket_.write(boost::asio::buffer(text)); }
  bool got_text() const { return socket_.got_text(); }
  Socket& socket() { return socket_.next_layer(); }

 private:
  boost::asio::io_context io_;
  boost::beast::websocket::stream<Socket> socket_;
};

using Watcher = BasicWatcher<boost::asio::ip::tcp::socket>;

}  // namespace tact::test
