# gnuplot -c kinds.gp STUDY_OUT OUT.png: diffusion at rest, viscosity under shear and cost of each kind of colloid.
set terminal pngcairo size 1200,420 font ",12"
set output ARG2
set datafile separator ","
csv = ARG1."/study.csv"
rows(scene, observable) = sprintf("< grep ',%s,%s,' %s", scene, observable, csv)
set multiplot layout 1,3
set style fill solid 0.4; set boxwidth 0.6; set grid ytics lc rgb "#dddddd"; set xtics rotate by -30
set xrange [-0.6:4.6]; set yrange [0:*]
set title "Diffusion of a colloid at rest"; set ylabel "D"
plot rows("at rest", "colloids.colloid.diffusion") using 0:6:7:xtic(1) with boxerrorbars lc 1 notitle
set title "Viscosity, sheared at rate 1"; set ylabel "stress over rate"
plot rows("sheared", "viscosity") using 0:6:7:xtic(1) with boxerrorbars lc 2 notitle
set title "Cost, at rest"; set ylabel "processor seconds per unit of time"
plot rows("at rest", "colloids.colloid.diffusion") using 0:14:xtic(1) with boxes lc 3 notitle
unset multiplot
