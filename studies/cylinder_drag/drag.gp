# gnuplot -c drag.gp STUDY_OUT OUT.png: force on the cylinder against mean velocity, and density residual against P.
set terminal pngcairo size 1100,520 font ",12"
set output ARG2
csv = ARG1."/study.csv"
set datafile separator ","
rows(mass, observable) = sprintf("< grep '^\"\\?m = %d\"\\?,[0-9.]*,%s,' %s", mass, observable, csv)
N = 140; h = 6.0; eta = 2.62; n = 3.99
k(a) = 4*pi/(log(h/(sqrt(pi)*a)) - 0.738 + pi*a*a/h**2)
set multiplot layout 1,2
set grid lc rgb "#dddddd"; set key top left
set title "Drag"; set xlabel "mean velocity U of the fluid"; set ylabel "force on the cylinder"
set xrange [0:11]; set yrange [0:160]
hasimoto(u, a) = 4*pi*eta*u/(log(h/a) - 1.3105)
plot for [m=0:1] rows(m, "bodies.fluid_velocity.x") using 4:(N*$2):5 with xerrorbars lc m+1 pt 6+m title sprintf("m = %d", m), \
     k(0.215)*eta*x with lines lc rgb "black" title "Sangani-Acrivos, a = 0.215", \
     hasimoto(x, 0.25) with lines dt 2 lc rgb "black" title "Hasimoto, a = 0.25 (paper, eq. 47)"
set title "Density residual, without a circle of radius 1"; set xlabel "force P on each particle"; set ylabel "(49), sampling noise removed"
set xrange [0:1.1]; set yrange [0:*]
plot for [m=0:1] rows(m, "residual.excess") using 2:($4/sqrt(132)):($5/sqrt(132)) with yerrorlines lc m+1 pt 6+m title sprintf("m = %d", m)
unset multiplot
