# docs/images/wave_work_precision.{svg,png} from the data of bench_wave --data. From the root of the
# source tree: gnuplot docs/figures/wave.gp
# EPIC's points: measured with its version 0.14.3, see docs/accuracy.md.
$epic_rk4 << EOD
263 0.264 2.28e-4
124 0.269 3.38e-4
609.7 0.155 0.90e-4
EOD
$epic_rk3 << EOD
163 0.264 6.61e-4
87 0.266 5.31e-3
EOD
data = "docs/figures/wave.dat"
pick(name) = sprintf("< awk '$1 == \"%s\" {key = $2; if (!(key in c) || $5 < c[key]) {c[key] = $5; l[key] = $0}} END {for (k in l) print l[k]}' %s | sort -k2n", name, data)
cases = "rk4_0.2 rk4_0.4 rk3_0.2 rk3_0.4"
names = "'RK4, α = 0.2' 'RK4, α = 0.4' 'RK3, α = 0.2' 'RK3, α = 0.4'"
array colour[4] = ["#1b4f9c", "#6fa8dc", "#1b9e77", "#8fd3a5"]
do for [terminal in "svg png"] {
  if (terminal eq "svg") { set terminal svg size 960,440 font "sans,13" background "white" }
  else { set terminal pngcairo size 960,440 font "sans,11" }
  set output "docs/images/wave_work_precision." . terminal
  set multiplot layout 1,2
  set logscale xy
  set format y "10^{%T}"
  set grid lc rgb "#dddddd"
  set xlabel "processor time, s"
  set xrange [2:2000]
  set key bottom left samplen 2 spacing 0.9 font ",10"
  set title "r.m.s. error of the vorticity after two periods"
  set yrange [1e-4:1]
  plot for [i=1:4] pick(word(cases, i)) using 5:7 with linespoints pt 7 ps 0.7 lw 2 \
         lc rgb colour[i] title word(names, i), \
       $epic_rk4 using 1:2 with points pt 9 ps 1.2 lc rgb "#a6420a" title "EPIC, RK4", \
       $epic_rk3 using 1:2 with points pt 11 ps 1.2 lc rgb "#d95f02" title "EPIC, RK3"
  set title "mean deviation of the energy"
  set yrange [1e-6:1e-1]
  plot for [i=1:4] pick(word(cases, i)) using 5:9 with linespoints pt 7 ps 0.7 lw 2 \
         lc rgb colour[i] title word(names, i), \
       $epic_rk4 using 1:3 with points pt 9 ps 1.2 lc rgb "#a6420a" title "EPIC, RK4", \
       $epic_rk3 using 1:3 with points pt 11 ps 1.2 lc rgb "#d95f02" title "EPIC, RK3"
  unset multiplot
  set output
}
