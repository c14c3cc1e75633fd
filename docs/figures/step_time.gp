# docs/images/step_time.{svg,png} from the data of docs/figures/step_time.sh. From the root of the
# source tree: gnuplot docs/figures/step_time.gp
data = "docs/figures/step_time.dat"
# One line of the table: label, threads, instructions.
pick(label, threads, set) = sprintf("< awk '$1 == \"%s\" && $2 == %d && $3 == \"%s\"' %s", label, threads, set, data)
deposit = 13; compensation = 14; inversion = 15; tendency = 16; interpolate = 17; update = 18
closure = 19; sort = 21; merge = 22; split = 23; correction = 24
runs = "wave,1,avx512 wave,2,avx512 thermal,1,avx512 thermal,2,avx512 wave,1,avx2"
names = "'wave, 1 thread' 'wave, 2 threads' 'thermal, 1 thread' 'thermal, 2 threads' 'wave, 1 thread, AVX2'"
field(run, n) = word(system(sprintf("echo %s | tr , ' '", run)), n)
table(run) = pick(field(run, 1), int(field(run, 2)), field(run, 3))
entry(run, column) = real(system(sprintf("awk '$1 == \"%s\" && $2 == %s && $3 == \"%s\" {print $%d}' %s", field(run, 1), field(run, 2), field(run, 3), column, data)))
speedup(label, column) = entry(label . ",1,avx512", column) / entry(label . ",2,avx512", column)
array colour[7] = ["#1b4f9c", "#6fa8dc", "#1b9e77", "#8fd3a5", "#d95f02", "#f4b183", "#999999"]
parts = "'stage: interpolate, update' 'deposit' 'volume correction' 'transforms' 'compensation' 'sort, split, merge' 'closure'"
part(run, n) = n == 1 ? entry(run, interpolate) + entry(run, update) : \
               n == 2 ? entry(run, deposit) : n == 3 ? entry(run, correction) : \
               n == 4 ? entry(run, inversion) + entry(run, tendency) : \
               n == 5 ? entry(run, compensation) : \
               n == 6 ? entry(run, sort) + entry(run, split) + entry(run, merge) : entry(run, closure)
set print $bars
do for [r=1:words(runs)] {
  line = ""
  do for [n=1:7] { line = line . sprintf(" %.1f", part(word(runs, r), n)) }
  print sprintf("\"%s\"%s", word(names, r), line)
}
unset print
set print $scaling
phases = "deposit interpolate correction inversion tendency compensation sort"
columns = "13 17 24 15 16 14 21"
do for [p=1:words(phases)] {
  c = int(word(columns, p))
  print sprintf("%s %.2f %.2f %.1f", word(phases, p), speedup("wave", c), speedup("thermal", c), 100 * entry("wave,1,avx512", c) / entry("wave,1,avx512", 12))
}
unset print
set print $points
do for [t=1:2] { do for [label in "wave thermal"] {
  run = sprintf("%s,%d,avx512", label, t)
  print sprintf("%g %g %g %g %d", entry(run, 8), entry(run, 9), entry(run, 10), entry(run, 11), t)
} }
unset print
triad1 = entry("wave,1,avx512", 6); triad2 = entry("wave,2,avx512", 6)
peak1 = entry("wave,1,avx512", 7); peak2 = entry("wave,2,avx512", 7)
bound(x, b, a) = b * x < a ? b * x : a
do for [terminal in "svg png"] {
  if (terminal eq "svg") { set terminal svg size 1100,460 font "sans,13" background "white" }
  else { set terminal pngcairo size 1100,460 font "sans,10" }
  set output "docs/images/step_time." . terminal
  set multiplot layout 1,3
  set grid y lc rgb "#dddddd"
  set title "nanoseconds per parcel and step"
  set style data histograms
  set style histogram rowstacked
  set boxwidth 0.7
  set style fill solid 1 noborder
  set xtics rotate by -40 font ",9"
  set yrange [0:1600]
  set key top left samplen 1 spacing 0.9 font ",9" invert
  plot for [n=1:7] $bars using (column(n + 1)):xtic(1) lc rgb colour[n] title word(parts, n)
  set title "speed-up of two threads over one"
  set style histogram clustered gap 1
  set yrange [0:2.4]
  set key top right
  plot $scaling using 2:xtic(1) lc rgb colour[1] title "wave", "" using 3 lc rgb colour[3] title "thermal", \
       2 with lines dt 2 lc rgb "#555555" notitle
  set title "roofline of the two passes over the parcels"
  set xtics norotate
  set logscale xy
  set xrange [0.5:20]
  set yrange [1:200]
  set xlabel "operations per byte"
  set ylabel "Gflop/s"
  set key bottom right
  plot bound(x, triad1, peak1) with lines lw 2 lc rgb "#888888" title "machine, 1 thread", \
       bound(x, triad2, peak2) with lines lw 2 dt 2 lc rgb "#888888" title "machine, 2 threads", \
       $points using ($5 == 1 ? $1 : NaN):2 with points pt 7 ps 1 lc rgb colour[2] title "deposit, 1", \
       $points using ($5 == 2 ? $1 : NaN):2 with points pt 6 ps 1 lc rgb colour[2] title "deposit, 2", \
       $points using ($5 == 1 ? $3 : NaN):4 with points pt 5 ps 1 lc rgb colour[1] title "stage, 1", \
       $points using ($5 == 2 ? $3 : NaN):4 with points pt 4 ps 1 lc rgb colour[1] title "stage, 2"
  unset multiplot
  unset logscale; unset xrange; unset xlabel; unset ylabel
  set xrange [*:*]
  set output
}
