# Largest time-step factor alpha with which scenes stay accurate and with which they survive, from the
# table that docs/figures/stability_map.py writes. Run from the root of the source tree:
#   gnuplot docs/figures/stability_map.gp
set encoding utf8
data = 'docs/figures/stability_map.csv'
set datafile separator ','
set style data points
set key outside top center horizontal maxrows 2
set logscale y
set yrange [0.04:14]
set ytics (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 10)
set grid ytics lc rgb '#dddddd'
set ylabel 'time-step factor α'
set xtics rotate by -25 nomirror noenhanced font ',10'
set bmargin 7
set rmargin 6
names = system("awk -F, '$3 == \"rk4\" {sub(/ small/, \"\", $1); gsub(/ /, \"_\", $1); print $1}' ".data)
scenes = words(names)
set xtics ()
do for [i=1:scenes] { set xtics add (word(names, i) i - 1) }
set xrange [-0.6:scenes - 0.4]
set arrow from graph 0, first 0.25 to graph 1, first 0.25 nohead dt 3 lc rgb '#888888'
set label 'default' at graph 1.005, first 0.25 font ',9' tc rgb '#666666'
plot_all = "\
  data using ($2-0.14):(strcol(3) eq 'rk4' ? $5 : NaN) pt 7 ps 1.3 lc rgb '#1b6ca8' title 'RK4, shapes by the exponential: accurate', \
  data using ($2-0.14):(strcol(3) eq 'rk4' ? $6 : NaN) pt 6 ps 1.9 lw 1.5 lc rgb '#1b6ca8' title 'survives', \
  data using ($2+0.14):(strcol(3) eq 'rk3' ? $5 : NaN) pt 5 ps 1.2 lc rgb '#d1762d' title 'RK3, shapes too: accurate', \
  data using ($2+0.14):(strcol(3) eq 'rk3' ? $6 : NaN) pt 4 ps 1.8 lw 1.5 lc rgb '#d1762d' title 'survives'"
set terminal svg size 1000,560 font 'Helvetica,12'
set output 'docs/images/stability_map.svg'
eval 'plot '.plot_all
set terminal pngcairo size 1000,560 font 'Helvetica,11'
set output 'docs/images/stability_map.png'
eval 'plot '.plot_all
