# gnuplot -c start_up.gp RUN_M0 RUN_M1 OUT.png: profiles at several times, with the diffusion of momentum at m = 1.
set terminal pngcairo size 1100,520 font ",12"
set output ARG3
set datafile separator ","
set multiplot layout 1,2
set xlabel "v_x"; set ylabel "y / r_c"; set xrange [-11:11]; set yrange [1:11]
set key bottom right; set linetype 5 lc rgb "#aa2222"; set grid lc rgb "#dddddd"
times = "t00 t02 t04 t08 t20"
label(i) = word("0-0.2 2 4 8 15-20", i)
middle(i) = real(word("0.1 2 4 8 17.5", i))
nu = 3.3/4.33; h = 5.0; U = 10.0
mode(k, s, t) = 2*(-1)**k/(k*pi)*exp(-nu*(k*pi/h)**2*t)*sin(k*pi*s/h)
diffusion(y, t) = U*((y-6)/h + sum [k=1:40] mode(k, y-6, t))
set title "m = 0: at once"
plot for [i=1:5] ARG1."/".word(times,i).".csv" skip 2 using 4:1 with linespoints lc i pt 6 title "t = ".label(i)
set title "m = 1: lines are diffusion of momentum, eta = 3.3"
set samples 200
set parametric
set trange [1:11]
plot for [i=1:5] ARG2."/".word(times,i).".csv" skip 2 using 4:1 with points lc i pt 6 title "t = ".label(i), \
     for [i=1:5] diffusion(t, middle(i)), t with lines lc i notitle
unset multiplot
