# gnuplot -c resolution.gp STUDY_OUT OUT.png: errors of viscosity and short-time diffusion against theory by the size of spheres, and cost.
set terminal pngcairo size 900,420 font ",11"
set output ARG2
set datafile separator ","
rows(what) = sprintf("< grep ',%s,' %s/study.csv", what, ARG1)
eta0 = 0.988; pi = 3.14159265
a(r) = r < 2 ? 1.255 : r < 3 ? 2.135 : 3.15
N(r) = r < 2 ? 13 : r < 3 ? 9 : 5
L(r) = r < 2 ? 9.0 : r < 3 ? 13.5 : 16.5
p(r) = N(r)*4./3.*pi*a(r)**3/L(r)**3
S(r) = p(r)*(1 + .95*p(r) - 2.15*p(r)**2)
eta(r) = 1 + 2.5*p(r)*(1 + S(r))/(1 - p(r)*(1 + S(r)))
Dt(r) = 1 - 1.8315*p(r)*(1 + .12*p(r) - .70*p(r)**2)
Dr(r) = 1 - .631*p(r) - .726*p(r)**2
D0(r) = 1/(6*pi*eta0*a(r)); R0(r) = 1/(8*pi*eta0*a(r)**3)
box(r) = (1.7601*(p(r)/N(r))**(1./3) - p(r)/N(r))/eta(r)
error_of(x, theory) = 100*(x/theory - 1)
set grid lc rgb "#dddddd"; set key top right; set xrange [0.8:3.6]; set xlabel "hydrodynamic radius / r_c"
set multiplot layout 1,2
set ylabel "above theory (%)"; set yrange [-5:16]
plot rows("high-frequency-viscosity.eta") using ($1-.03):(error_of($5/eta0, eta($1))):(100*$6/eta0/eta($1)) with yerrorbars pt 7 title "viscosity", \
     rows("mobility.sphere.translation") using 1:(error_of($5/D0($1) + box($1), Dt($1))):(100*$6/D0($1)/Dt($1)) with yerrorbars pt 5 title "translation", \
     rows("all.sphere.rotation") using ($1+.03):(error_of($5/R0($1) + p($1)/N($1)/eta($1), Dr($1))):(100*$6/R0($1)/Dr($1)) with yerrorbars pt 9 title "rotation", \
     0 with lines lc rgb "black" dt 2 notitle
set ylabel "processor seconds"; set logscale y; set yrange [0.5:10000]; set key bottom right
plot rows("high-frequency-viscosity.eta") using 1:13 with linespoints pt 7 title "a unit of time", \
     rows("high-frequency-viscosity.eta") using 1:($13*6*pi*eta0*a($1)**3) with linespoints pt 5 title "diffusion over a radius"
