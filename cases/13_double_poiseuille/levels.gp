# gnuplot -c levels.gp RUN_8 RUN_6 RUN_4 OUT.png: velocity and shear stress of the three levels with theory at eta = 30.
set terminal pngcairo size 1100,520 font ",12"
set output ARG4
set datafile separator ","
set multiplot layout 1,2
set xlabel "y"; set xrange [0:20]; set grid lc rgb "#dddddd"
run(i) = i == 1 ? ARG1 : i == 2 ? ARG2 : ARG3
n(i) = 10 - 2*i
rho = 8.0; eta = 30.0; h = 10.0
flow(y) = rho*y*(h - y)/(2*eta)
u(y) = y < h ? flow(y) : -flow(y - h)
tau(y) = y < h ? rho*(h - 2*y)/2 : -rho*(h - 2*(y - h))/2
set title "Velocity"; set ylabel "v_x"
plot for [i=1:3] run(i)."/profile.csv" skip 2 using 1:4 with points lc i pt 4+i title sprintf("n = %d", n(i)), \
     u(x) with lines lc rgb "black" title "theory, eta = 30"
set title "Shear stress"; set ylabel "S_{xy}"
plot for [i=1:3] run(i)."/stress.csv" skip 2 using 1:4 with points lc i pt 4+i title sprintf("n = %d", n(i)), \
     tau(x) with lines lc rgb "black" title "theory"
unset multiplot
