# gnuplot -c levels.gp STUDY_OUT OUT.png: drag on the cylinder against the mean velocity, at three levels of coarse graining.
set terminal pngcairo size 720,520 font ",12"
set output ARG2
set datafile separator ","
csv = ARG1."/study.csv"
rows(n) = sprintf("< grep '^n = %d,[0-9.]*,bodies.fluid_velocity.x,' %s", n, csv)
# F = n P h^2, U = N <v_x>/(n h^2); line: F = k eta U (Sangani and Acrivos 1982) at the radius of exclusion of the thesis.
h = 10.0
k(a) = 4*pi/(log(h/(sqrt(pi)*a)) - 0.738 + pi*a*a/h**2)
set grid lc rgb "#dddddd"; set key bottom right
set xlabel "mean velocity U"; set ylabel "drag F = n P h^2"
set xrange [-0.02:0.6]; set yrange [0:320]
plot for [i=0:2] rows(6 + 2*i) using 6:((6 + 2*i)*$2*h*h):7 with xerrorbars lc i+1 pt 6+i title sprintf("n = %d", 6 + 2*i), \
     k(0.47)*100*x with lines lc rgb "black" title "eta = 100, a = 0.47"
