# gnuplot -c rods.gp STUDY_OUT OUT.png: resistances of rods and ellipsoids over those of a ball as wide, against theory (compare.py
# writes STUDY_OUT/rods.csv and theory.csv).
set terminal pngcairo size 1300,440 font ",12"
set output ARG2
set datafile separator ","
bodies(shape) = sprintf("< grep ',%s,' %s/rods.csv", shape, ARG1)
theory = ARG1."/theory.csv"
set grid lc rgb "#dddddd"; set key left top
set xlabel "aspect ratio, ({/:Italic L} + 2{/Symbol d})/(2{/:Italic R} + 2{/Symbol d})"
set multiplot layout 1,3
set ylabel "force over 6 {/Symbol p} {/Symbol h} (R + {/Symbol d}) V"
set xrange [1:11.5]; set yrange [0.9:6.6]
plot theory using 1:3 skip 1 with lines lc rgb "#1f77b4" dt 2 title "rod across, computed", \
     theory using 1:2 skip 1 with lines lc rgb "#1f77b4" title "along", \
     theory using 1:6 skip 1 with lines lc rgb "#d62728" dt 2 title "ellipsoid across, Perrin", \
     theory using 1:5 skip 1 with lines lc rgb "#d62728" title "along", \
     bodies("rod") using 3:6:7 with yerrorbars lc rgb "#1f77b4" pt 4 notitle, \
     bodies("rod") using 3:4:5 with yerrorbars lc rgb "#1f77b4" pt 5 notitle, \
     bodies("ellipsoid") using 3:6:7 with yerrorbars lc rgb "#d62728" pt 6 notitle, \
     bodies("ellipsoid") using 3:4:5 with yerrorbars lc rgb "#d62728" pt 7 notitle, \
     bodies("sphere") using 3:4:5 with yerrorbars lc rgb "black" pt 7 title "sphere"
set ylabel "D along over D across"
set yrange [0.95:1.5]
ratio(c) = sprintf("< awk -F, 'NR > 1 {print $1 \",\" $%d/$%d}' %s", c + 1, c, theory)
plot ratio(2) using 1:2 with lines lc rgb "#1f77b4" title "rod", \
     ratio(5) using 1:2 with lines lc rgb "#d62728" title "ellipsoid", \
     bodies("rod") using 3:10:11 with yerrorbars lc rgb "#1f77b4" pt 5 notitle, \
     bodies("ellipsoid") using 3:10:11 with yerrorbars lc rgb "#d62728" pt 7 notitle, \
     bodies("sphere") using 3:10:11 with yerrorbars lc rgb "black" pt 7 title "sphere"
set ylabel "torque across over 8 {/Symbol p} {/Symbol h} (R + {/Symbol d})^3 {/Symbol w}"
set yrange [0.8:2000]; set logscale y
plot theory using 1:4 skip 1 with lines lc rgb "#1f77b4" title "rod, computed", \
     theory using 1:7 skip 1 with lines lc rgb "#d62728" title "ellipsoid, Perrin", \
     bodies("rod") using 3:8:9 with yerrorbars lc rgb "#1f77b4" pt 5 notitle, \
     bodies("ellipsoid") using 3:8:9 with yerrorbars lc rgb "#d62728" pt 7 notitle, \
     bodies("sphere") using 3:8:9 with yerrorbars lc rgb "black" pt 7 title "sphere"
