#pragma once
#include <boost/asio/ip/tcp.hpp>
#include <string>

namespace tact::view {

/// Opens, binds and listens. Throws SetupError that names machine.bind or machine.port, what is wrong and what to do.
boost::asio::ip::tcp::acceptor listen_on(boost::asio::io_context& io, const std::string& bind, std::uint16_t port);

}  // namespace tact::view
