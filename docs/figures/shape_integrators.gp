# docs/images/shape_integrators.{svg,png} from the data of bench_shape --data. From the root of the
# source tree: gnuplot docs/figures/shape_integrators.gp
data = "docs/figures/shape_integrators.dat"
names = "'RK3 on dB/dt' 'RK4 on dB/dt' 'RK3 exponential' 'RK4 exponential' 'midpoint exponential'"
array colour[5] = ["#d95f02", "#a6420a", "#7570b3", "#1b4f9c", "#1b9e77"]
do for [terminal in "svg png"] {
  if (terminal eq "svg") { set terminal svg size 960,440 font "sans,13" background "white" }
  else { set terminal pngcairo size 960,440 font "sans,11" }
  set output "docs/images/shape_integrators." . terminal
  set multiplot layout 1,2
  set logscale xy
  set format y "10^{%T}"
  set grid lc rgb "#dddddd"
  set xlabel "time step times worst-case strain, α"
  set xrange [0.04:2]
  set xtics (0.05, 0.1, 0.2, 0.4, 0.8, 1.6)
  set key bottom right samplen 2 spacing 0.9 font ",10"
  set yrange [1e-10:1e2]
  set title "relative error of B"
  plot for [i=1:5] data index i-1 using 1:2 with linespoints pt 7 ps 0.6 lw 2 lc rgb colour[i] \
         title word(names, i), \
       0.01*x**3 dt 2 lc rgb "#999999" title "slopes 3 and 4", 0.0002*x**4 dt 2 lc rgb "#999999" notitle
  set title "error of det B (volume squared)"
  set yrange [1e-12:1e5]
  unset key
  plot for [i=1:5] data index i-1 using 1:3 with linespoints pt 7 ps 0.6 lw 2 lc rgb colour[i]
  unset multiplot
  set output
}
