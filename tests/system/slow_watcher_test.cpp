// Two browsers, one of them on a very slow link: the fast one sees everything, the slow one what is newest when it can
// take it, and neither the view's memory nor the hand notices.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <future>
#include <thread>

#include "fault/fault.hpp"
#include "support/pressing.hpp"
#include "support/watcher.hpp"

namespace tact::test {
namespace {
using boost::asio::ip::tcp;
using std::chrono::seconds;

/// A link of 320 bytes a second with next to no memory, until it is told to hurry.
class SlowSocket : public tcp::socket {
 public:
  using tcp::socket::socket;

  void connect(const tcp::endpoint& to) {
    open(to.protocol());
    set_option(boost::asio::socket_base::receive_buffer_size(1));  // as little as the kernel grants
    tcp::socket::connect(to);
  }
  template <class Buffers>
  std::size_t read_some(const Buffers& into, boost::system::error_code& error) {
    if (hurry) return tcp::socket::read_some(into, error);
    std::this_thread::sleep_for(std::chrono::milliseconds{200});
    const boost::asio::mutable_buffer first = *boost::asio::buffer_sequence_begin(into);
    return tcp::socket::read_some(boost::asio::buffer(first, 64), error);
  }

  template <class Buffers>
  std::size_t read_some(const Buffers& into) {
    boost::system::error_code error;
    const std::size_t bytes = read_some(into, error);
    if (error) throw boost::system::system_error(error);
    return bytes;
  }

  std::atomic<bool> hurry{false};
};

/// Beast asks this of a socket it does not know.
void teardown(boost::beast::role_type role, SlowSocket& socket, boost::system::error_code& error) {
  boost::beast::websocket::teardown(role, static_cast<tcp::socket&>(socket), error);
}

/// What a watcher saw, in order.
struct Seen {
  std::vector<std::size_t> pictures;  ///< their hashes: the camera moves between any two
  std::vector<std::string> events;    ///< of those sent to all, from the first answer to the last
  std::string last_value;             ///< in the last answer
  std::size_t pictures_since_last = 0;
  bool last_heard = false;
  nlohmann::json status = nlohmann::json::object();

  template <class AnyWatcher>
  void next(AnyWatcher& watcher) {
    const std::string message = watcher.receive();
    if (!watcher.got_text()) return message[0] == 'p' ? add_picture(message) : void();
    const auto json = nlohmann::json::parse(message);
    const std::string type = json["type"];
    if (type == "status") status = json;
    if (type == "status" || type == "hello" || last_heard || (events.empty() && type != "answer")) return;
    events.push_back(message);
    last_heard = type == "answer" && json.value("value", "") == last_value;
  }
  void add_picture(const std::string& message) {
    pictures.push_back(std::hash<std::string>{}(message));
    if (last_heard) ++pictures_since_last;
  }
};

/// Something broke; the other faults are what a busy machine does to a tick.
constexpr std::uint32_t kBroken = bit(Fault::not_finite) | bit(Fault::transport_degraded) | bit(Fault::device_lost) |
                                  bit(Fault::device_alarm) | bit(Fault::watchdog) | bit(Fault::peer_restarted) |
                                  bit(Fault::scene_changed);

std::size_t resident_bytes(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/statm");
  std::size_t all = 0, resident = 0;
  in >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(SlowWatcher, GetsTheNewestWhileTheFastOneTheViewAndTheHandDoNotNotice) {
  Pressing session({"--view", "on", "--port", "0", "--set", "view.token=secret-token"});
  ASSERT_TRUE(session.settled()) << session.run.output();
  const auto port = session.view_port();
  ASSERT_GT(port, 0) << session.run.output();

  Watcher fast("127.0.0.1", port, "secret-token");
  BasicWatcher<SlowSocket> slow("127.0.0.1", port, "");
  Seen fast_saw, slow_saw;
  while (fast_saw.status.value("viewers", 0) < 2 || fast_saw.status.value("age_s", -1.0) < 0) fast_saw.next(fast);
  const auto see_pictures = [&](std::size_t count) {
    for (const std::size_t end = fast_saw.pictures.size() + count; fast_saw.pictures.size() < end;) {
      const std::size_t before = fast_saw.pictures.size();
      fast_saw.next(fast);
      if (fast_saw.pictures.size() > before) fast.say(R"({"type":"orbit","yaw":0.01})");
    }
  };

  // Changes of stiffness are events for both; the answer to the last one tells the slow one that it has heard all.
  constexpr int kChanges = 10;
  const double k_n_per_m = fast_saw.status["k_n_per_m"];
  const auto stiffness = [&](int change) { return std::to_string(k_n_per_m + change); };
  const auto change_stiffness = [&](int change) {
    fast.say(R"({"type":"set","key":"contact.stiffness_n_per_m","value":")" + stiffness(change) + "\"}");
  };
  fast_saw.last_value = slow_saw.last_value = stiffness(kChanges);
  auto reading = std::async(std::launch::async, [&] {
    while (slow_saw.pictures_since_last < 3) slow_saw.next(slow);
  });
  // However this test ends, the slow one must not be waited for.
  const std::shared_ptr<void> at_the_end(nullptr, [&](void*) {
    boost::system::error_code ignored;
    slow.socket().shutdown(tcp::socket::shutdown_both, ignored);
  });

  // Fifteen seconds and more: longer than a client may take nothing at all.
  see_pictures(20);
  const auto before = session.observer.stats();
  const auto memory = resident_bytes(session.pid("view"));
  for (int change = 1; change < kChanges; ++change) {
    change_stiffness(change);
    const auto tick = session.observer.device().tick;
    while (session.observer.device().tick < tick + 1700) see_pictures(1);
  }
  const auto after = session.observer.stats();
  EXPECT_LT(resident_bytes(session.pid("view")), memory + 4'000'000) << "about a megabyte a second was not taken";
  // The hand goes on as before. How many ticks were missed or late tells of the load of this machine, not of the view.
  EXPECT_EQ(after.epoch, before.epoch);
  EXPECT_GT(after.ticks, before.ticks);
  EXPECT_GT(after.wrench_fresh, before.wrench_fresh);
  const std::uint32_t new_faults = after.faults_ever & ~before.faults_ever & kBroken;
  EXPECT_EQ(new_faults, 0u) << fault_names(new_faults);

  // The link gets fast: what comes next is of now, with nothing of the time between but the events.
  const std::size_t seen_while_slow = fast_saw.pictures.size();
  slow.socket().hurry = true;
  change_stiffness(kChanges);
  const auto arrived = [&] { return reading.wait_for(seconds{0}) == std::future_status::ready; };
  for (int i = 0; i < 1000 && !arrived(); ++i) see_pictures(1);
  ASSERT_TRUE(arrived()) << "the slow one never caught up";
  ASSERT_NO_THROW(reading.get()) << "the slow one was dropped";
  see_pictures(1);

  EXPECT_EQ(slow_saw.events, fast_saw.events);
  EXPECT_GE(fast_saw.events.size(), static_cast<std::size_t>(kChanges));
  std::vector<std::size_t> seen;  // which of the fast one's pictures the slow one saw too
  for (const auto picture : slow_saw.pictures) {
    const auto found = std::find(fast_saw.pictures.begin(), fast_saw.pictures.end(), picture);
    if (found != fast_saw.pictures.end()) seen.push_back(static_cast<std::size_t>(found - fast_saw.pictures.begin()));
  }
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end())) << ::testing::PrintToString(seen);
  EXPECT_GE(seen.back(), seen_while_slow) << ::testing::PrintToString(seen);
  EXPECT_LT(slow_saw.pictures.size(), seen_while_slow / 2) << "old pictures were not skipped";
  EXPECT_TRUE(session.settled()) << session.run.output();
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
}

}  // namespace
}  // namespace tact::test
