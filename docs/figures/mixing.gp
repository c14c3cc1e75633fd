# docs/images/mixing.{svg,png} from docs/figures/mixing_density.dat, which docs/figures/mixing.py
# writes. From the root of the source tree: gnuplot docs/figures/mixing.gp
# With schemes = 0 only grid nudging is drawn.
data = "docs/figures/mixing_density.dat"
published = "< grep '^[0-9]' configs/scenes/moist_thermal/liquid_water_histograms.csv | tr , ' '"
if (!exists("schemes")) schemes = 1
height = schemes ? 760 : 420
set datafile missing "?"
set style data steps
do for [format in "svg png"] {
  if (format eq "svg") {
    set terminal svg size 900,height font "sans,13" background "white"
  } else {
    set terminal pngcairo size 900,height font "sans,11"
  }
  set output sprintf("docs/images/mixing.%s", format)
  if (schemes) {
    set multiplot layout 2,1 margins 0.09,0.98,0.08,0.95 spacing 0,0.11
  } else {
    set multiplot layout 1,1 margins 0.09,0.98,0.14,0.91
  }
  set xrange [0.002:0.08]
  set yrange [0:1.6]
  set key at graph 0.5, 0.97 right top
  set ylabel "density"
  set xlabel "q_l / q_0"
  set title "Grid nudging: liquid water after 600 s, 32^3 cells"
  plot data using 1:2 title "β = 0" lw 2 lc rgb "#08306b", \
       data using 1:3 title "0.1" lw 2 lc rgb "#2171b5", \
       data using 1:4 title "0.3" lw 2 lc rgb "#41ab5d", \
       data using 1:5 title "1" lw 2 lc rgb "#f16913", \
       data using 1:6 title "3" lw 2 lc rgb "#a50f15", \
       published using (0.5*($1+$2)):3 title "EPIC 32^3" dt 2 lw 1.5 lc rgb "black", \
       published using (0.5*($1+$2)):11 title "MONC 32^3" dt 3 lw 1.5 lc rgb "black", \
       published using (0.5*($1+$2)):14 title "MONC 256^3" dt 3 lw 1.5 lc rgb "gray50"
  if (schemes) {
    set title "Other schemes with their defaults"
    plot data using 1:2 title "none" lw 2 lc rgb "#08306b", \
         data using 1:7 title "Langevin displacement" lw 2 lc rgb "#41ab5d", \
         data using 1:8 title "stochastic stretching" lw 2 lc rgb "#f16913", \
         data using 1:9 title "overlap exchange" lw 2 lc rgb "#a50f15", \
         published using (0.5*($1+$2)):3 title "EPIC 32^3" dt 2 lw 1.5 lc rgb "black", \
         published using (0.5*($1+$2)):11 title "MONC 32^3" dt 3 lw 1.5 lc rgb "black"
  }
  unset multiplot
  unset output
}
