// Preloaded into every process of a session under test: the wall clock reads as much beside the true one as a file
// says, and the file may change at any time. As on a machine whose clock is set, all waits until a time of day follow;
// nothing else does. The machine's own clock stays as it is.
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000, kSlice_ns = 20'000'000;

/// The function that this library stands before. Condition variables of glibc have an old version that is another
/// thing.
template <class F>
F* next(const char* name, const char* version = nullptr) {
  return reinterpret_cast<F*>(version != nullptr ? dlvsym(RTLD_NEXT, name, version) : dlsym(RTLD_NEXT, name));
}

const std::atomic<std::int64_t>* shared_offset() {
  static const std::atomic<std::int64_t> none{0};
  static const auto* offset = [] {
    const char* path = getenv("TACT_TEST_CLOCK");
    const int file = path == nullptr ? -1 : open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return &none;
    void* at = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
    close(file);
    return at == MAP_FAILED ? &none : static_cast<const std::atomic<std::int64_t>*>(at);
  }();
  return offset;
}

bool of_the_wall(clockid_t clock) { return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE; }

std::int64_t ns_of(const timespec& t) { return t.tv_sec * kSecond_ns + t.tv_nsec; }
timespec timespec_of(std::int64_t ns) { return {ns / kSecond_ns, ns % kSecond_ns}; }

int true_clock(clockid_t clock, timespec* t) {
  static auto* real = next<int(clockid_t, timespec*)>("clock_gettime");
  return real(clock, t);
}
std::int64_t true_ns() {
  timespec t{};
  true_clock(CLOCK_REALTIME, &t);
  return ns_of(t);
}
std::int64_t wall_ns() { return true_ns() + shared_offset()->load(std::memory_order_relaxed); }

/// A time of day is far from zero; a time since the machine's start is not (a condition variable may be told either).
bool is_time_of_day(const timespec& t) { return t.tv_sec > 1'000'000'000; }

/// `wait` until a true time, again and again until it is the wanted time by the wall clock as it then is.
template <class Wait>
int wait_by_the_wall(const timespec& until, Wait wait) {
  for (;;) {
    const std::int64_t left = ns_of(until) - wall_ns();
    if (left <= 0) {
      const timespec past = timespec_of(true_ns() - 1);
      return wait(past);
    }
    const timespec slice = timespec_of(true_ns() + (left < kSlice_ns ? left : kSlice_ns));
    const int result = wait(slice);
    if (result != ETIMEDOUT) return result;
    if (ns_of(until) <= wall_ns()) return result;
  }
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* t) noexcept {
  const int result = true_clock(clock, t);
  if (result == 0 && of_the_wall(clock)) {
    *t = timespec_of(ns_of(*t) + shared_offset()->load(std::memory_order_relaxed));
  }
  return result;
}

int gettimeofday(timeval* __restrict t, void* __restrict) noexcept {
  const std::int64_t now = wall_ns();
  t->tv_sec = now / kSecond_ns;
  t->tv_usec = now % kSecond_ns / 1000;
  return 0;
}

time_t time(time_t* t) noexcept {
  const time_t now = wall_ns() / kSecond_ns;
  if (t != nullptr) *t = now;
  return now;
}

int pthread_cond_timedwait(pthread_cond_t* __restrict c, pthread_mutex_t* __restrict m,
                           const timespec* __restrict until) {
  static auto* real =
      next<int(pthread_cond_t*, pthread_mutex_t*, const timespec*)>("pthread_cond_timedwait", "GLIBC_2.3.2");
  if (!is_time_of_day(*until)) return real(c, m, until);
  return wait_by_the_wall(*until, [&](const timespec& t) { return real(c, m, &t); });
}

int pthread_cond_clockwait(pthread_cond_t* __restrict c, pthread_mutex_t* __restrict m, clockid_t clock,
                           const timespec* __restrict until) {
  static auto* real =
      next<int(pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*)>("pthread_cond_clockwait");
  if (clock != CLOCK_REALTIME) return real(c, m, clock, until);
  return wait_by_the_wall(*until, [&](const timespec& t) { return real(c, m, clock, &t); });
}

int pthread_mutex_timedlock(pthread_mutex_t* __restrict m, const timespec* __restrict until) noexcept {
  static auto* real = next<int(pthread_mutex_t*, const timespec*)>("pthread_mutex_timedlock");
  return wait_by_the_wall(*until, [&](const timespec& t) { return real(m, &t); });
}

int sem_timedwait(sem_t* __restrict s, const timespec* __restrict until) {
  static auto* real = next<int(sem_t*, const timespec*)>("sem_timedwait");
  const int result = wait_by_the_wall(*until, [&](const timespec& t) { return real(s, &t) == 0 ? 0 : errno; });
  errno = result;
  return result == 0 ? 0 : -1;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* want, timespec* left) {
  static auto* real = next<int(clockid_t, int, const timespec*, timespec*)>("clock_nanosleep");
  if (!of_the_wall(clock) || (flags & TIMER_ABSTIME) == 0) return real(clock, flags, want, left);
  const int result = wait_by_the_wall(*want, [&](const timespec& t) {
    const int slept = real(clock, flags, &t, nullptr);
    return slept == 0 ? ETIMEDOUT : slept;
  });
  return result == ETIMEDOUT ? 0 : result;
}

}  // extern "C"
