#!/usr/bin/env bash
# scripts/build: a tree is built as its preset says, whatever was built before. A project without sources stands for odpd.
source "$(dirname "$0")/lib.sh" "$@"
command -v cmake >/dev/null && command -v ninja >/dev/null || { skip 'there is no CMake, or no Ninja'; finish; }

mkdir scripts
cp "$source_root/scripts/build" "$source_root/scripts/packages.txt" scripts/
cp "$source_root/CMakePresets.json" .
cat >CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(stand_in LANGUAGES NONE)
add_custom_target(odpd_program COMMAND ${CMAKE_COMMAND} -E touch odpd BYPRODUCTS odpd)
CMAKE
build() { scripts/build "$@" odpd_program; }
unity() { sed -nE 's/^CMAKE_UNITY_BUILD(_BATCH_SIZE)?:[A-Z]+=(.*)/\2/p' "build/$1/CMakeCache.txt" | paste -sd ' '; }

# What CI builds lies beside what scripts/odpd builds.
expect_exit 0 build ci
expect test "$(unity ci)" = 'ON 8'
expect test ! -e build/release
expect_exit 0 build release
expect test -z "$(unity release)" -a "$(unity ci)" = 'ON 8'
expect test -e build/release/odpd
expect_exit 0 build asan
expect test "$(unity asan)" = 'ON 0'

# A tree that was configured as another kind of build, by hand or by an earlier script, is configured afresh; others keep what
# they were given.
expect_exit 0 cmake --preset release -DCMAKE_UNITY_BUILD=ON -DODPD_NATIVE=ON
expect test "$(unity release)" = ON
expect_exit 0 build release
expect test -z "$(unity release)"
expect_exit 0 cmake --preset release -DODPD_NATIVE=ON
expect_exit 0 build release
expect grep -q '^ODPD_NATIVE:[A-Z]*=ON' build/release/CMakeCache.txt
expect_exit 0 cmake --preset ci -DCMAKE_UNITY_BUILD=OFF
expect_exit 0 build ci
expect test "$(unity ci)" = 'ON 8'

# Nobody but the preset says so.
expect test -z "$(grep -rl ODPD_UNITY "$source_root/scripts" "$source_root/.ci")"
expect grep -q '"\$preset"' "$source_root/scripts/test"
expect grep -qw ci "$source_root/.ci/run"
finish
