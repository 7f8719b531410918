# gnuplot -c fractions.gp STUDY_OUT OUT.png: viscosity and short-time diffusion of spheres against their fraction, and theory.
set terminal pngcairo size 1200,420 font ",11"
set output ARG2
set datafile separator ","
rows(what) = sprintf("< grep ',%s,' %s/study.csv", what, ARG1)
a = 2.135; eta0 = 0.988; pi = 3.14159265
N(p) = p < .03 ? 3 : p < .06 ? 4 : p < .12 ? 6 : p < .17 ? 9 : p < .25 ? 12 : p < .35 ? 18 : 17
S(p) = p*(1 + .95*p - 2.15*p**2)
eta(p) = 1 + 2.5*p*(1 + S(p))/(1 - p*(1 + S(p)))
box(p) = (1.7601*(p/N(p))**(1./3) - p/N(p))/eta(p)
set grid lc rgb "#dddddd"; set key top left; set xrange [0:0.42]; set xlabel "hydrodynamic fraction"
set multiplot layout 1,3
set ylabel "high-frequency viscosity over the fluid's"
plot rows("high-frequency-viscosity.eta") using 1:($5/eta0):($6/eta0) with yerrorbars pt 7 title "measured", \
     eta(x) title "Stokes flow, fit", 1 + 2.5*x + 5*x**2 dt 2 title "1 + 2.5 phi + 5 phi^2"
set key top right; set ylabel "short-time diffusion over D_0"
D0 = 1/(6*pi*eta0*a)
plot rows("mobility.sphere.translation") using 1:($5/D0 + box($1)):($6/D0) with yerrorbars pt 7 title "translation", \
     1 - 1.8315*x*(1 + .12*x - .70*x**2) title "Stokes flow, fit", (1 - 1.56*x)*(1 - .27*x) dt 2 title "(1 - 1.56 phi)(1 - .27 phi)"
R0 = 1/(8*pi*eta0*a**3)
set key bottom left
plot rows("all.sphere.rotation") using 1:($5/R0 + $1/N($1)/eta($1)):($6/R0) with yerrorbars pt 7 title "rotation", \
     1 - .631*x - .726*x**2 title "1 - .631 phi - .726 phi^2"
