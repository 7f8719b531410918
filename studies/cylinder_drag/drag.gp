# gnuplot -c drag.gp STUDY_OUT OUT.png: force on the cylinder against mean velocity, and density residual against P.
set terminal pngcairo size 1100,520 font ",12"
set output ARG2
csv = ARG1."/study.csv"
set datafile separator ","
rows(mass, observable) = sprintf("< grep '^m = %d,[0-9.]*,%s,' %s", mass, observable, csv)
# The whole cell counts: F = n P h^2 and U = flux/(n h), with n of the fluid clear of the cylinder (README of 10_cylinder_array).
N = 140; h = 6.0; eta = 2.58; n = 3.97; flux = N/(n*h*h)
k(a) = 4*pi/(log(h/(sqrt(pi)*a)) - 0.738 + pi*a*a/h**2)
set multiplot layout 1,2
set grid lc rgb "#dddddd"; set key bottom right
set title "Drag"; set xlabel "mean velocity U"; set ylabel "drag F = n P h^2"
set xrange [0:12]; set yrange [0:160]
hasimoto(u, a) = 4*pi*eta*u/(log(h/a) - 1.3105)
plot for [m=0:1] rows(m, "bodies.fluid_velocity.x") using (flux*$6):(n*$2*h*h):(flux*$7) with xerrorbars lc m+1 pt 6+m title sprintf("m = %d", m), \
     k(0.215)*eta*x with lines lc rgb "black" title "Sangani-Acrivos, a = 0.215", \
     hasimoto(x, 0.25) with lines dt 2 lc rgb "black" title "Hasimoto, a = 0.25 (paper, eq. 47)"
set title "Density residual, without a circle of radius 1"; set xlabel "force P on each particle"; set ylabel "(49), sampling noise removed"
set key top left; set xrange [0:1.1]; set yrange [0:*]
plot for [m=0:1] rows(m, "residual.excess") using 2:($6/sqrt(132)):($7/sqrt(132)) with yerrorlines lc m+1 pt 6+m title sprintf("m = %d", m)
unset multiplot
