# gnuplot -c cylinder.gp RUN OUT.png: density of the fluid around the cylinder, and velocity across the cell.
set terminal pngcairo size 1100,520 font ",12"
set output ARG2
set datafile separator ","
set multiplot layout 1,2
set grid lc rgb "#dddddd"; set key bottom right
set title "Fluid around the cylinder"; set xlabel "distance from its centre"; set ylabel "g"
set arrow from 0.47, graph 0 to 0.47, graph 1 nohead dt 2
set xrange [0:4]
plot ARG1."/bodies.csv" skip 1 using 1:2 with lines lc 1 title "g(q)", NaN dt 2 lc rgb "black" title "0.47, the thesis"
unset arrow
set title "Flow across the cell"; set xlabel "y"; set ylabel "v_x, mean over x"
set xrange [0:10]; set yrange [0:*]
plot ARG1."/profile.csv" skip 2 using 1:4:5 with yerrorlines lc 1 pt 6 title "measured"
unset multiplot
