# docs/images/mixing.{svg,png} from docs/figures/mixing_density.dat, which docs/figures/mixing.py
# writes. From the root of the source tree: gnuplot docs/figures/mixing.gp
data = "docs/figures/mixing_density.dat"
published = "< grep '^[0-9]' configs/scenes/moist_thermal/liquid_water_histograms.csv | tr , ' '"
# Columns of runs that were made; made = "2 3" draws those alone.
if (!exists("made")) made = "2 3 4 5 6 7 8 9 10 11 12 13"
fine = "2 3 4 5 6 7"
fine_name = "'β = 0' 0.1 0.3 1 3 'growth and dilution'"
fine_colour = "#08306b #2171b5 #41ab5d #f16913 #a50f15 #d6a100"
coarse = "8 9 10 11 12 13"
coarse_name = "none 'Langevin displacement' 'coherent displacement' 'stochastic stretching' \
'growth and dilution' 'overlap exchange'"
coarse_colour = "#08306b #41ab5d #8c6bb1 #f16913 #d6a100 #a50f15"
is_made(c) = strstrt(" ".made." ", " ".c." ") > 0
value_of(c) = is_made(c) ? column(int(c)) : NaN
name_of(c, text) = is_made(c) ? text : ""
set datafile missing "?"
set style data steps
do for [format in "svg png"] {
  if (format eq "svg") {
    set terminal svg size 1080,760 font "sans,13" background "white"
  } else {
    set terminal pngcairo size 1080,760 font "sans,11"
  }
  set output sprintf("docs/images/mixing.%s", format)
  set multiplot layout 2,1 margins 0.07,0.76,0.08,0.95 spacing 0,0.11
  set xrange [0.002:0.08]
  set yrange [0:1.6]
  set key at graph 1.02, 1.0 left top Left reverse
  set ylabel "density"
  unset xlabel
  set title "Grid nudging, growth and dilution: liquid water after 600 s, 32^3 cells"
  plot for [i=1:words(fine)] data using 1:(value_of(word(fine, i))) \
         title name_of(word(fine, i), word(fine_name, i)) lw 2 lc rgb word(fine_colour, i), \
       published using (0.5*($1+$2)):3 title "EPIC 32^3" dt 2 lw 1.5 lc rgb "black", \
       published using (0.5*($1+$2)):11 title "MONC 32^3" dt 3 lw 1.5 lc rgb "black", \
       published using (0.5*($1+$2)):14 title "MONC 256^3" dt 3 lw 1.5 lc rgb "gray50"
  set xlabel "q_l / q_0"
  set title "Schemes with their defaults, 20^3 cells"
  plot for [i=1:words(coarse)] data using 1:(value_of(word(coarse, i))) \
         title name_of(word(coarse, i), word(coarse_name, i)) lw 2 lc rgb word(coarse_colour, i), \
       published using (0.5*($1+$2)):3 title "EPIC 32^3" dt 2 lw 1.5 lc rgb "black", \
       published using (0.5*($1+$2)):11 title "MONC 32^3" dt 3 lw 1.5 lc rgb "black", \
       published using (0.5*($1+$2)):14 title "MONC 256^3" dt 3 lw 1.5 lc rgb "gray50"
  unset multiplot
  unset output
}
