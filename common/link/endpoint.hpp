#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "link/participant.hpp"

namespace tact {

namespace detail {

/// One DDS writer or reader with its topic. Untyped: Publisher and Subscriber give the types.
class Endpoint {
 public:
  enum class Role { writer, reader };
  Endpoint(const Participant& participant, const wire::TopicInfo& info, Role role, const std::string& incarnation);
  ~Endpoint();
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  bool write(const void* sample) noexcept;
  bool take(void* sample) noexcept;
  bool wait(std::int64_t timeout_ns) noexcept;
  int matched() const noexcept;
  bool shared_memory_capable() const noexcept;
  void abandon() noexcept;

 private:
  std::int32_t topic_ = 0, entity_ = 0, waitset_ = 0;
  Role role_;
  const wire::TopicInfo& info_;
  std::vector<std::byte>
      scratch_;  // reader: one sample. What says only that a writer ended must not touch the caller's
};

}  // namespace detail

/// Writes one topic. Session topics are named by their type; haptic ones also by `incarnation` (both epochs).
/// Throws SetupError when the endpoint cannot be made.
template <class T>
class Publisher {
 public:
  explicit Publisher(const Participant& participant, const std::string& incarnation = {})
      : endpoint_(participant, wire::topic_info<T>(), detail::Endpoint::Role::writer, incarnation) {}

  /// False when DDS refused. Haptic: does not allocate, but over shared memory it may block 10 ms (pool exhausted) and
  /// for ever after a reader was killed inside an iceoryx lock: call it from a thread somebody can replace
  /// (CallGuard).
  bool write(const T& message) noexcept { return endpoint_.write(&message); }
  int matched() const noexcept { return endpoint_.matched(); }  ///< readers now known
  bool shared_memory_capable() const noexcept { return endpoint_.shared_memory_capable(); }
  void abandon() noexcept { endpoint_.abandon(); }  ///< never destroyed: that may hang after a peer's crash

 private:
  detail::Endpoint endpoint_;
};

/// Reads one topic. One thread at a time.
template <class T>
class Subscriber {
 public:
  explicit Subscriber(const Participant& participant, const std::string& incarnation = {})
      : endpoint_(participant, wire::topic_info<T>(), detail::Endpoint::Role::reader, incarnation) {}

  /// The oldest message not yet taken; false when there is none, and `out` is untouched then. Sequences' memory is used
  /// again by later calls: for types with sequences pass a Message<T>. Haptic: frees memory of Cyclone's, allocates
  /// none.
  bool take(T& out) noexcept { return endpoint_.take(&out); }
  /// The newest, dropping older ones; false when there is none.
  bool take_newest(T& out) noexcept {
    bool any = false;
    while (take(out)) any = true;
    return any;
  }
  /// Sleeps until a message is there (true) or the time is over.
  bool wait(std::int64_t timeout_ns) noexcept { return endpoint_.wait(timeout_ns); }
  int matched() const noexcept { return endpoint_.matched(); }  ///< writers now known
  bool shared_memory_capable() const noexcept { return endpoint_.shared_memory_capable(); }
  void abandon() noexcept { endpoint_.abandon(); }

 private:
  detail::Endpoint endpoint_;
};

}  // namespace tact
