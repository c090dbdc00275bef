#include "rt/thread.hpp"

#include <pthread.h>
#include <sched.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <future>

#include "fault/fault.hpp"

namespace tact::rt {
namespace {

struct Start {
  ThreadOptions options;
  std::function<void()> body;
  std::promise<std::vector<std::string>> ready;
};

std::vector<std::string> apply(const ThreadOptions& options) {
  std::vector<std::string> missing;
  pthread_setname_np(pthread_self(), options.name.substr(0, 15).c_str());
  if (options.cpu >= 0) {
    cpu_set_t cpus;
    CPU_ZERO(&cpus);
    CPU_SET(static_cast<std::size_t>(options.cpu), &cpus);
    if (const int e = pthread_setaffinity_np(pthread_self(), sizeof cpus, &cpus)) {
      missing.push_back("thread " + options.name + ": cannot be pinned to CPU " + std::to_string(options.cpu) + " (" +
                        std::strerror(e) + "): it runs on any CPU; name a CPU that exists and is allowed (nproc)");
    }
  }
  // Explicitly normal when 0: a child of a real-time thread would inherit its priority.
  const sched_param param{options.priority};
  if (const int e = pthread_setschedparam(pthread_self(), options.priority > 0 ? SCHED_FIFO : SCHED_OTHER, &param)) {
    missing.push_back("thread " + options.name + ": SCHED_FIFO priority " + std::to_string(options.priority) +
                      " refused (" + std::strerror(e) +
                      "): it runs at normal priority and misses ticks under load; allow `rtprio 95` for this user in "
                      "/etc/security/limits.d, or run as root");
  }
  return missing;
}

/// Touches the stack below this frame so that the body takes no page fault there.
[[gnu::noinline]] [[maybe_unused]] int prefault_stack(std::size_t bytes) {
  constexpr std::size_t kStep = 16384;
  volatile std::uint8_t page[kStep];
  for (std::size_t i = 0; i < kStep; i += 1024) page[i] = 0;
  const int below = bytes > kStep ? prefault_stack(bytes - kStep) : 0;
  return below + page[0];  // read after the call: no tail call, the frames stay on top of one another
}

extern "C" void* tact_thread_main(void* argument) {
  auto* start = static_cast<Start*>(argument);
  std::vector<std::string> missing = apply(start->options);
#ifndef TACT_SANITIZED
  prefault_stack(start->options.stack_bytes / 2);
#endif
  const std::function<void()> body = std::move(start->body);
  start->ready.set_value(std::move(missing));  // `start` lives in the constructor: gone from here on
  body();
  return nullptr;
}

}  // namespace

Thread::Thread(const ThreadOptions& options, std::function<void()> body) {
  Start start{options, std::move(body), {}};
  auto ready = start.ready.get_future();
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
#ifndef TACT_SANITIZED  // which keep megabytes of their own on each stack
  pthread_attr_setstacksize(&attributes, options.stack_bytes);
#endif
  pthread_t handle{};
  const int e = pthread_create(&handle, &attributes, tact_thread_main, &start);
  pthread_attr_destroy(&attributes);
  if (e != 0) {
    throw SetupError("thread " + options.name + ": cannot be started: " + std::strerror(e) +
                     "; raise the limit on processes (ulimit -u) or free memory");
  }
  handle_ = handle;
  missing_ = ready.get();
}

void Thread::join() {
  if (handle_ == 0) return;
  pthread_join(handle_, nullptr);
  handle_ = 0;
}

void Thread::detach() {
  if (handle_ == 0) return;
  pthread_detach(handle_);
  handle_ = 0;
}

}  // namespace tact::rt
