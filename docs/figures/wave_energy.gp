# docs/images/wave_energy.{svg,png}: the wave's energy change against resolution, from the data of
# bench_wave --data. From the root of the source tree: gnuplot docs/figures/wave_energy.gp
# Published: |E(t)/E(0) - 1| in per mille after two periods, Frey et al. 2023,
# doi:10.1016/j.jcpx.2023.100136: cells, EPIC, PS3D.
$published << EOD
48 0.310 0.514
64 0.124 0.217
96 0.040 0.065
128 0.017 0.029
256 0.002 0.005
EOD
runs = "< awk '$1 == \"rk4_0.2\"' docs/figures/wave.dat | sort -k2n"
do for [terminal in "svg png"] {
  if (terminal eq "svg") { set terminal svg size 620,440 font "sans,13" background "white" }
  else { set terminal pngcairo size 620,440 font "sans,11" }
  set output "docs/images/wave_energy." . terminal
  set logscale xy
  set grid lc rgb "#dddddd"
  set xrange [40:300]
  set yrange [1e-3:1]
  set xtics (48, 64, 96, 128, 256)
  set xlabel "cells in x and y (a quarter of that in z)"
  set ylabel "|energy change| after two periods, per mille"
  set key bottom left
  plot $published using 1:3 with linespoints pt 11 lc rgb "#8fd3a5" title "PS3D, published", \
       $published using 1:2 with linespoints pt 9 lc rgb "#d95f02" title "EPIC, published", \
       runs using 2:(abs($11)) with linespoints pt 6 lc rgb "#6fa8dc" title "Pileus, published definition", \
       runs using 2:(abs($12)) with linespoints pt 7 lw 2 lc rgb "#1b4f9c" title "Pileus, energy of the mesh"
  set output
}
