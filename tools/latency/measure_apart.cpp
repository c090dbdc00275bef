#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <exception>

#include "fault/fault.hpp"
#include "latency/latency.hpp"

namespace tact::latency {
namespace {

/// A Figure as it goes through a pipe.
struct Parcel {
  Spread spread;
  Conditions conditions;
  std::uint64_t missed;
  char error[256];
};

}  // namespace

std::string Conditions::text() const {
  return (fifo ? "FIFO " + std::to_string(priority) : std::string("normal priority")) +
         (locked ? ", memory locked" : ", memory not locked") + (awake ? ", CPUs awake" : ", CPUs may sleep");
}

Figure measure_apart(const std::function<Figure()>& measure) {
  int ends[2];
  if (::pipe(ends) != 0) throw SetupError("pipe: the system refuses one");
  const pid_t child = ::fork();
  if (child < 0) throw SetupError("fork: the system refuses a process");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    Parcel parcel{};
    try {
      const Figure figure = measure();
      parcel.spread = figure.spread;
      parcel.conditions = figure.conditions;
      parcel.missed = figure.missed;
      std::strncpy(parcel.error, figure.error.c_str(), sizeof parcel.error - 1);
    } catch (const std::exception& e) {
      std::strncpy(parcel.error, e.what(), sizeof parcel.error - 1);
    }
    const bool told = ::write(ends[1], &parcel, sizeof parcel) == sizeof parcel;
    ::_exit(told ? 0 : 1);
  }
  ::close(ends[1]);
  Parcel parcel{};
  const bool heard = ::read(ends[0], &parcel, sizeof parcel) == sizeof parcel;
  ::close(ends[0]);
  ::waitpid(child, nullptr, 0);
  Figure figure{parcel.spread, parcel.conditions, parcel.missed, parcel.error};
  if (!heard) figure.error = "the measuring process died";
  return figure;
}

}  // namespace tact::latency
