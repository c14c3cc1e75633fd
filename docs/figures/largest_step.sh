#!/bin/bash
# The largest time-step factor alpha with which a scene keeps its pass marks, for both Runge-Kutta
# orders with both shape integrators. Run from the root of the source tree:
#
#   docs/figures/largest_step.sh PROGRAM DATA [SCENE.yaml...]
#
# PROGRAM is the pileus binary. One line per run is appended to DATA (scene, order, integrator,
# alpha, exit code: 0 all marks kept, 4 a mark missed or the run failed); runs it holds already are
# not repeated. At the end the table is printed.
set -u
program=$1 data=$2
shift 2
if [ $# -eq 0 ]; then
  set -- configs/scenes/{taylor_green/taylor_green_small,rayleigh_taylor/rayleigh_taylor_small,beltrami/beltrami_small,internal_wave/internal_wave_48}.yaml
fi
touch "$data"
for file in "$@"; do
  name=$(basename "$file" .yaml)
  for alpha in ${ALPHAS:-0.8 0.6 0.4 0.3 0.2 0.1}; do
    for scheme in rk4 rk3; do
      for shape in exponential runge_kutta; do
        grep -q "^$name $scheme $shape $alpha " "$data" && continue
        results=$(mktemp -d)
        "$program" check "$file" --quiet --threads "${THREADS:-1}" --out "$results/run" \
          --set time.step.alpha="$alpha" --set time.step.strain_alpha="$alpha" \
          --set time.step.courant=10 --set output.fields.every=0 \
          --set time.scheme=$scheme --set numerics.shape_integrator=$shape >"$results/log" 2>&1
        code=$?
        rm -rf "$results"
        case $code in
          0 | 4) echo "$name $scheme $shape $alpha $code" >>"$data" ;;
          *) echo "$name: exit code $code" >&2; exit $code ;;
        esac
      done
    done
  done
done
# The largest alpha below which every smaller one was kept as well.
sort -k1,1 -k2,3 -k4,4n "$data" | awk '
  { key = $1 " " $2 " " $3; if (key != last) { held = 1; order[++n] = key; last = key }
    if ($5 != 0) { held = 0; missed[key] = missed[key] " " $4 }
    if (held) best[key] = $4 }
  END { printf "%-24s %-4s %-12s %8s  %s\n", "scene", "RK", "shape", "largest", "missed at"
        for (i = 1; i <= n; ++i) { split(order[i], k, " ")
          printf "%-24s %-4s %-12s %8s  %s\n", k[1], k[2], k[3],
                 (order[i] in best) ? best[order[i]] : "none", missed[order[i]] } }'
