#!/usr/bin/env bash
# What one push costs on the host JVM, with the library as phones get it: bare Rust, JNI, uniffi with JNA, in one run.
# Prints, asserts nothing.
set -euo pipefail
PROFILE=ship exec "$(dirname "$0")/kotlin.sh" test -Dtest=Benchmark -Dtests.jvm= -Dsurefire.failIfNoSpecifiedTests=false
