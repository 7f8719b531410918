# gnuplot -c resolution.gp STUDY_OUT OUT.png: viscosity over the one asked for, against cost, by kernel, form and support.
set terminal pngcairo size 900,520 font ",12"
set output ARG2
set datafile separator ","
csv = ARG1."/study.csv"
rows(method, space) = sprintf("< grep '^%s,[0-9.]*,%s,viscosity,' %s | grep -v ',nan,nan,'", method, space, csv)
set grid lc rgb "#dddddd"; set key outside right
set logscale x; set xrange [0.003:0.06]
set xlabel "processor seconds per unit of time (400 particles in 2D, 512 in 3D)"; set ylabel "viscosity over the one asked for"
set yrange [0.8:1.2]
methods = "'C2' 'C2 classical' 'C2 p_b = 0' 'Lucy' 'C4' 'quintic'"
plot for [i=1:6] rows(word(methods, i), "2D") using 15:7:8 with yerrorlines lc i pt 7 title word(methods, i), \
     for [i=1:6] rows(word(methods, i), "2D") using 15:7:2 with labels offset 1.2,0.6 font ",9" notitle, \
     rows("C2", "3D") using 15:7:8 with yerrorlines lc rgb "black" pt 5 title "C2, 3D", \
     rows("C2", "3D") using 15:7:2 with labels offset 1.2,0.6 font ",9" notitle, \
     1.0 with lines lc rgb "black" dt 2 notitle
