# cases/15_suspension_2d/README.md, its two tables. Run in this directory: gnuplot suspension_2d.gp
set terminal pngcairo size 1100,430 font "sans,10"
set output "suspension_2d.png"
set multiplot layout 1,2
set key top left
set xlabel "number fraction 3 N_c/(144 + 3 N_c)"
set ylabel "relative viscosity at rate 2"
set xrange [0:0.16]
set yrange [0.98:1.5]
$number << EOD
0.0204 1.047 0.006
0.0400 1.092 0.006
0.0588 1.141 0.005
0.0769 1.192 0.007
0.1111 1.298 0.007
0.1429 1.434 0.007
EOD
$pure << EOD
0.0588 1.134 0.007
0.1429 1.398 0.007
EOD
plot 1 + 2*x title "1 + 2 phi (Brady 1984)" lc rgb "#888888", \
  $number with yerrorbars pt 7 lc rgb "#1f5fa8" title "colloids of three particles", \
  $pure with yerrorbars pt 4 ps 1.6 lc rgb "#c0392b" title "pure fluid of as many particles"
set key top right
set xlabel "Pe = rate a^2/D"
set ylabel "viscosity"
set logscale x
set xrange [0.1:40]
set yrange [2.3:3.3]
$colloids << EOD
0.170 3.040 0.072
0.340 3.137 0.046
0.680 3.073 0.023
1.361 3.023 0.013
2.721 3.010 0.014
5.442 2.972 0.009
10.884 2.901 0.008
22.449 2.802 0.008
EOD
$solvent << EOD
0.170 2.513 0.072
0.340 2.683 0.045
0.680 2.626 0.027
1.361 2.649 0.015
2.721 2.623 0.009
5.442 2.605 0.008
10.884 2.548 0.008
22.449 2.472 0.010
EOD
plot $colloids with yerrorbars pt 7 lc rgb "#1f5fa8" title "3 colloids", \
  $solvent with yerrorbars pt 5 lc rgb "#888888" title "solvent"
unset multiplot
