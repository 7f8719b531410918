#!/usr/bin/env bash
# The shipped studies in their quick form: they run, and they find what is known of the methods.
source "$(dirname "$0")/lib.sh" "$@"

study() { expect_exit 0 "$odpd" study "$source_root/studies/$1" --quick --out "$1"; }
# verdict STUDY START OBSERVABLE: of the line of study.csv that begins with START.
verdict() { grep -F "$2,$3," "$1/study.csv" | head -n 1 | sed "s/.*,$3,\([a-z ]*\),.*/\1/"; }
# expect_verdict STUDY START OBSERVABLE VERDICT
expect_verdict() {
  local found
  found=$(verdict "$1" "$2" "$3")
  checks=$((checks + 1))
  [ "$found" = "$4" ] || fail "$1: $2: $3 is '$found', not '$4'"
}

study integrators_2d
expect_verdict integrators_2d 'euler,0.005' pressure biased
expect_verdict integrators_2d 'euler,0.005' config_temperature biased
expect_verdict integrators_2d 'velocity-verlet, m = 0.1",0.02' energy_per_particle 'blew up'
study small_mass
expect_verdict small_mass 'setd,0.0005' kinetic_temperature biased
expect_verdict small_mass 'velocity-verlet 0.65,0.0001' kinetic_temperature biased
expect_verdict small_mass 'velocity-verlet 0.65,0.0005' kinetic_temperature 'blew up'
study tolerance
expect test "$(grep -c 'blew up' tolerance/study.csv)" -eq 0
study stability_dt_a
expect_verdict stability_dt_a 'extrapolated,0.1,100.0' energy_per_particle 'blew up'
study stability_low_density
expect_verdict stability_low_density 'trapezoidal,0.05,1.0' energy_per_particle 'singular'
study cylinder_drag
expect test "$(grep -c 'blew up' cylinder_drag/study.csv)" -eq 0
study incompressibility
expect_verdict incompressibility 'm = 0,2' divergence.relative biased
study incompressibility_repulsion
expect test "$(grep -c 'blew up' incompressibility_repulsion/study.csv)" -eq 0
study incompressibility_alpha
study colloid_kinds
study cylinder_levels
for name in incompressibility_alpha colloid_kinds cylinder_levels; do
  expect test "$(grep -c 'blew up' $name/study.csv)" -eq 0
done
study sdpd_resolution
expect test "$(grep -c 'blew up' sdpd_resolution/study.csv)" -eq 0
study rods
expect test "$(grep -c 'blew up' rods/study.csv)" -eq 0
study sphere_resolution
expect test "$(grep -c 'blew up' sphere_resolution/study.csv)" -eq 0
study sphere_fractions
expect test "$(grep -c 'blew up' sphere_fractions/study.csv)" -eq 0
study spring_suspension_3d
expect_verdict spring_suspension_3d '0.1837,constrained,shear' viscosity biased
for name in integrators_2d small_mass tolerance stability_dt_a stability_low_density cylinder_drag \
  incompressibility incompressibility_repulsion incompressibility_alpha colloid_kinds cylinder_levels \
  sdpd_resolution rods sphere_resolution sphere_fractions spring_suspension_3d; do
  expect test -s "$name/study.html"
  expect test -z "$(grep ',missing,' "$name/study.csv")"
done
finish
