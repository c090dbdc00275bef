#include "view/web/listen.hpp"

#include <boost/asio/io_context.hpp>

#include "fault/fault.hpp"

namespace tact::view {

using boost::asio::ip::tcp;

tcp::acceptor listen_on(boost::asio::io_context& io, const std::string& bind, std::uint16_t port) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(bind, error);
  if (error) {
    throw SetupError(
        "machine.bind: found \"" + bind +
        "\", expected an IP address of this machine: 127.0.0.1 for this machine only, 0.0.0.0 for all networks");
  }
  const tcp::endpoint endpoint(address, port);
  tcp::acceptor acceptor(io);
  acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(64, error);
  if (!error) return acceptor;

  const std::string found = "machine.port: found " + std::to_string(port) + ", ";
  if (error == boost::asio::error::address_in_use) {
    throw SetupError(found + "already in use by another program; choose another (--port N), or 0 for any free port");
  }
  if (error == boost::asio::error::access_denied) {
    throw SetupError(
        found + "this user has no permission for ports below 1024; choose another (--port N), or 0 for any free port");
  }
  if (error == boost::system::errc::address_not_available) {
    throw SetupError("machine.bind: found \"" + bind +
                     "\", not an address of this machine; see `ip address`, or use 127.0.0.1");
  }
  throw SetupError("machine.bind: cannot listen on " + bind + " port " + std::to_string(port) + ": " + error.message());
}

}  // namespace tact::view
