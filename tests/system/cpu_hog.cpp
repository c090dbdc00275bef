// Takes every CPU of the machine, at a priority above all others when it may: 60 of every 100 ms, all CPUs at once, so
// that nothing real-time runs meanwhile and the kernel's throttle (95 %) never steps in. Until it is killed.
//   cpu_hog fifo|normal THREADS_PER_CPU      says "fifo" or "normal", as it could have it
#include <pthread.h>
#include <sched.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr long kPeriod_ms = 100, kBusy_ms = 60;

long now_ms() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * 1000 + t.tv_nsec / 1'000'000;
}

void burn(bool in_bursts) {
  for (;;) {
    const long phase = now_ms() % kPeriod_ms;
    if (in_bursts && phase >= kBusy_ms) usleep(static_cast<useconds_t>(1000 * (kPeriod_ms - phase)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  bool fifo = std::string(argv[1]) == "fifo";
  std::vector<std::thread> threads;
  cpu_set_t allowed;
  sched_getaffinity(0, sizeof allowed, &allowed);
  const sched_param highest{sched_get_priority_max(SCHED_FIFO)};
  if (fifo && sched_setscheduler(0, SCHED_FIFO, &highest) != 0) fifo = false;  // threads inherit it
  std::printf("%s\n", fifo ? "fifo" : "normal");
  std::fflush(stdout);
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET(cpu, &allowed)) continue;
    for (int i = 0; i < std::atoi(argv[2]); ++i) {
      threads.emplace_back([cpu, fifo] {
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(cpu, &one);
        pthread_setaffinity_np(pthread_self(), sizeof one, &one);
        burn(fifo);
      });
    }
  }
  for (auto& thread : threads) thread.join();
}
