#pragma once
#include <string>

namespace tact::coupling::virtuose {

/// Haption's C interface ("VirtuoseAPI" 4.x), in declarations of our own. Calls return 0 when all is well; otherwise
/// virtGetErrorCode(context) says why (after a failed virtOpen: of a null context). One thread at a time may use a
/// context. Metres, newtons, seconds, radians; arrays of float:
///   pose[7]            x y z qx qy qz qw: the scalar part last
///   twist[6], wrench[6] linear before angular
///   virtAttachQSVO     stiffness[6], damping[6]: ROTATION first, as nothing else here
using Context = void*;

enum CommandType : int { command_impedance = 3, command_virtual_mechanism = 5 };
enum IndexingMode : int { index_all = 0, index_translation = 1, index_none = 2, index_rotation = 7 };

enum Alarm : unsigned {
  alarm_overheat = 0x4000,
  alarm_saturated = 0x8000,
  alarm_callback_overrun = 0x20000,
  alarm_position = 0x40000,
  alarm_low_battery = 0x100000
};

/// Every call we make: CALL(name, result, arguments). What is optional is left null where a library lacks it.
#define TACT_VIRTUOSE_REQUIRED(CALL)                    \
  CALL(virtOpen, Context, (const char*))                \
  CALL(virtClose, int, (Context))                       \
  CALL(virtGetErrorCode, int, (Context))                \
  CALL(virtSetIndexingMode, int, (Context, int))        \
  CALL(virtSetForceFactor, int, (Context, float))       \
  CALL(virtSetSpeedFactor, int, (Context, float))       \
  CALL(virtSetTimeStep, int, (Context, float))          \
  CALL(virtSetBaseFrame, int, (Context, float*))        \
  CALL(virtSetObservationFrame, int, (Context, float*)) \
  CALL(virtSetCommandType, int, (Context, int))         \
  CALL(virtSetPowerOn, int, (Context, int))             \
  CALL(virtGetPowerOn, int, (Context, int*))            \
  CALL(virtGetPosition, int, (Context, float*))         \
  CALL(virtGetSpeed, int, (Context, float*))            \
  CALL(virtGetForce, int, (Context, float*))            \
  CALL(virtSetForce, int, (Context, float*))            \
  CALL(virtSetPosition, int, (Context, float*))         \
  CALL(virtSetSpeed, int, (Context, float*))            \
  CALL(virtAttachQSVO, int, (Context, float*, float*))  \
  CALL(virtDetachVO, int, (Context))                    \
  CALL(virtGetDeadMan, int, (Context, int*))            \
  CALL(virtGetEmergencyStop, int, (Context, int*))      \
  CALL(virtIsInShiftPosition, int, (Context, int*))     \
  CALL(virtGetAlarm, int, (Context, unsigned*))

#define TACT_VIRTUOSE_OPTIONAL(CALL)                 \
  CALL(virtAPIVersion, int, (int*, int*))            \
  CALL(virtGetDeviceID, int, (Context, int*, int*))  \
  CALL(virtSetTimeoutValue, int, (Context, float))   \
  CALL(virtEnableForceFeedback, int, (Context, int)) \
  CALL(virtSaturateTorque, int, (Context, float, float))

struct Calls {
#define TACT_VIRTUOSE_MEMBER(name, result, arguments) result(*name) arguments = nullptr;
  TACT_VIRTUOSE_REQUIRED(TACT_VIRTUOSE_MEMBER)
  TACT_VIRTUOSE_OPTIONAL(TACT_VIRTUOSE_MEMBER)
#undef TACT_VIRTUOSE_MEMBER
};

/// The vendor's library, loaded into a namespace of its own (RTLD_LOCAL: it exports hundreds of plain names) and never
/// unloaded: it runs threads.
struct Library {
  Calls calls;
  std::string name;  ///< as it was found
};

/// Loads `library` (a path or a name for the loader), or with none libVirtuoseAPI.so, then virtuoseAPI.so. Throws
/// SetupError: where was looked, what the loader said, what to do; or the calls the library lacks, by name.
Library load_library(const std::string& library);

/// "19 (called too late or in the wrong order)".
std::string describe_error(int code);

}  // namespace tact::coupling::virtuose
