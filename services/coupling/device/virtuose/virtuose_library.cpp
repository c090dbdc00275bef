#include "coupling/device/virtuose/virtuose_library.hpp"

#include <dlfcn.h>

#include <array>
#include <cstring>
#include <vector>

#include "fault/fault.hpp"

namespace tact::coupling::virtuose {
namespace {

struct Loaded {
  void* handle = nullptr;
  std::string said;  // by the loader, when null
};

Loaded load(const std::string& name) {
  Loaded loaded;
  loaded.handle = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded.handle != nullptr) return loaded;
  const char* error = ::dlerror();
  loaded.said = error != nullptr ? error : "no reason given";
  // Versions built against Sun RPC leave its xdr_ calls to their host.
  if (loaded.said.find("undefined symbol") == std::string::npos) return loaded;
  if (::dlopen("libtirpc.so.3", RTLD_NOW | RTLD_GLOBAL) == nullptr) return loaded;
  loaded.handle = ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (loaded.handle == nullptr && (error = ::dlerror()) != nullptr) loaded.said = error;
  return loaded;
}

template <class Function>
bool resolve(void* handle, const char* name, Function& function) {
  void* symbol = ::dlsym(handle, name);
  static_assert(sizeof symbol == sizeof function);
  std::memcpy(&function, &symbol, sizeof function);
  return symbol != nullptr;
}

Calls resolve_all(void* handle, const std::string& name) {
  Calls calls;
  std::string missing;
#define TACT_VIRTUOSE_REQUIRE(call, result, arguments) \
  if (!resolve(handle, #call, calls.call)) missing += " " #call;
  TACT_VIRTUOSE_REQUIRED(TACT_VIRTUOSE_REQUIRE)
#undef TACT_VIRTUOSE_REQUIRE
#define TACT_VIRTUOSE_TRY(call, result, arguments) resolve(handle, #call, calls.call);
  TACT_VIRTUOSE_OPTIONAL(TACT_VIRTUOSE_TRY)
#undef TACT_VIRTUOSE_TRY
  if (!missing.empty()) {
    throw SetupError("machine: device.library: " + name + " lacks" + missing +
                     "; expected Haption's VirtuoseAPI 4.x itself (libvirtuose.a and 3.x are only stubs of it)");
  }
  return calls;
}

}  // namespace

Library load_library(const std::string& library) {
  // math functions it uses without naming libm: our programs bring it into the global scope.
  const std::vector<std::string> names =
      library.empty() ? std::vector<std::string>{"libVirtuoseAPI.so", "virtuoseAPI.so"} : std::vector{library};
  std::string said;
  for (const std::string& name : names) {
    const Loaded loaded = load(name);
    if (loaded.handle != nullptr) return {resolve_all(loaded.handle, name), name};
    said += "; the loader says: " + loaded.said;
  }
  throw SetupError("machine: device.library: " +
                   (library.empty() ? "found neither libVirtuoseAPI.so nor virtuoseAPI.so" : "cannot load " + library) +
                   said + ". Haption delivers it with the arm: state its path as device.library in the machine file, " +
                   "or have its folder in /etc/ld.so.conf.d and run ldconfig");
}

std::string describe_error(int code) {
  constexpr std::array kMeaning{"no error given",
                                "out of memory",
                                "communication with the arm failed",
                                "invalid context: not connected, or the connection was cut",
                                "file not found",
                                "wrong format",
                                "the arm did not answer in time",
                                "not implemented",
                                "this variable is not available on this arm",
                                "a value is out of range",
                                "syntax error",
                                "hardware error",
                                "the set-point jumped",
                                "the library's other part or the arm's local service was not found",
                                "no periodic function",
                                "performance counter",
                                "versions of library and controller do not fit",
                                "not allowed in this command type",
                                "this arm does not support the command type",
                                "called too late or in the wrong order",
                                "incompatible version",
                                "wrong type of virtual mechanism",
                                "called already"};
  const auto index = static_cast<std::size_t>(code);
  const char* meaning = code >= 0 && index < kMeaning.size() ? kMeaning[index] : "unknown to this program";
  return std::to_string(code) + " (" + meaning + ")";
}

}  // namespace tact::coupling::virtuose
