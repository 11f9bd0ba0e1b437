// What the feature `test-hooks` adds to the library: for tests alone, never in a library that ships.

#pragma once

#include "magcomp.h"

/// Panics inside the object of a handle.
int32_t magcomp_test_panic(int64_t handle);

/// Keeps an event for `magcomp_test_bare_ns`: 0 magnetic, 1 rotation rate, 2 up; any other forgets all.
void magcomp_test_bare_add(int32_t kind, int64_t time_ns, double x, double y, double z);

/// Nanoseconds the core itself takes for these events: with the default method (0), the paper's (1) or a constant
/// calibration (2).
int64_t magcomp_test_bare_ns(int32_t method);
