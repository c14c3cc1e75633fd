#!/bin/bash
# Times a step by phase on one and two threads, for every instruction set and with parts of the
# method switched off: the data of docs/images/step_time.svg and docs/performance.md. Wants a quiet
# machine. Run from the root of the source tree:
#
#   docs/figures/step_time.sh build/release/bin/bench_step docs/figures/step_time.dat
set -eu
bench=$1 data=$2
wave=configs/scenes/internal_wave/internal_wave_48.yaml
thermal=configs/scenes/moist_thermal/moist_thermal.yaml
rm -f "$data"

# time LABEL THREADS SCENE [options of bench_step]
time_step() {
  local label=$1 threads=$2 scene=$3
  shift 3
  "$bench" "$scene" --threads "$threads" --repeats 4 --steps 5 --data "$data" --label "$label" "$@" >/dev/null
}
for threads in 1 2; do
  time_step wave $threads $wave
  time_step thermal $threads $thermal --warm-up 25
done
for instructions in avx2 baseline; do
  PILEUS_INSTRUCTION_SET=$instructions time_step wave 1 $wave
done
time_step wave_uncompensated 1 $wave --set numerics.window_compensation=0
time_step wave_direct_shapes 1 $wave --set numerics.shape_integrator=runge_kutta
time_step wave_uncorrected 1 $wave --set parcels.correction_iterations=0
time_step wave_rk3 1 $wave --set time.scheme=rk3
cat "$data"
