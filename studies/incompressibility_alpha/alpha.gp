# gnuplot -c alpha.gp STUDY_OUT OUT.png: density residual against alpha at three masses, and against alpha m.
set terminal pngcairo size 1100,480 font ",12"
set output ARG2
set datafile separator ","
csv = ARG1."/study.csv"
rows(m) = sprintf("< grep '^m = %s,[0-9.]*,density-residual.excess,' %s", m, csv)
set multiplot layout 1,2
set grid lc rgb "#dddddd"; set logscale x; set yrange [0:*]
set ylabel "density residual, sampling removed"
set title "Figure 3.13 of the thesis"; set xlabel "alpha"
plot for [i=0:2] rows(word("1 0.1 0.01", i + 1)) using ($2*10**i):6:7 with yerrorlines lc i+1 pt 6+i title "m = ".word("1 0.1 0.01", i + 1)
set title "One curve"; set xlabel "alpha m"
plot for [i=0:2] rows(word("1 0.1 0.01", i + 1)) using 2:6:7 with yerrorlines lc i+1 pt 6+i title "m = ".word("1 0.1 0.01", i + 1), \
     rows("0") using 2:6:7 with yerrorlines lc rgb "black" pt 3 title "m = 0"
unset multiplot
