# gnuplot -c eta_of_k.gp CSV OUT.png: relative standard error of eta(k) against processor time, a panel per wave number.
set terminal pngcairo size 1300,480 font ",11"
set output ARG2
set datafile separator ","
set logscale xy
set grid lc rgb "#dddddd"
set xlabel "processor time (s)"
set ylabel "relative standard error"
set key top right
pick(method, number) = sprintf("< grep '^%s,%d,' %s", method, number, ARG1)
array k[3] = [0.628, 1.257, 2.513]
array number[3] = [1, 2, 4]
set multiplot layout 1,3
do for [i=1:3] {
  set title sprintf("k = %.3f", k[i])
  plot pick("plain", number[i]) using 4:($6/$5) with linespoints pt 7 title "plain", \
       pick("control", number[i]) using 4:($6/$5) with linespoints pt 5 title "control", \
       pick("sine force", number[i]) using 4:($6/$5) with linespoints pt 9 title "sine force (one k a run)", \
       pick("currents", number[i]) using 4:($6/$5) with linespoints pt 11 title "currents, m = 1"
}
unset multiplot
