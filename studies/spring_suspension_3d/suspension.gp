# gnuplot -c suspension.gp STUDY_OUT OUT.png [RADIUS]: relative viscosity against number fraction; what the springs alone add, beside what the
# thesis' effective wavelengths need; the same against the volume fraction of spheres of RADIUS (0.2, that of the octahedra).
set terminal pngcairo size 1500,520 font ",12"
set output ARG2
csv = ARG1."/study.csv"
radius = ARGC > 2 ? real(ARG3) : 0.2
# phi, eta over the solvent's, its error
rows(method, route) = sprintf("< awk -F, '$2 == \"%s\" && $3 == \"%s\" && $1 > 0 { print $1, $7/$9, $7/$9*sqrt(($8/$7)^2 + ($10/$9)^2) }' %s", method, route, csv)
# phi, constrained over free, its error
springs(route) = sprintf("< awk -F, '$3 == \"%s\" { e[$2,$1] = $7; d[$2,$1] = $8; p[$1] = 1 } END { for (x in p) if (e[\"constrained\",x] > 0) { r = e[\"constrained\",x]/e[\"free\",x]; print x, r, r*sqrt((d[\"constrained\",x]/e[\"constrained\",x])^2 + (d[\"free\",x]/e[\"free\",x])^2) } }' %s | sort -g", route, csv)
$thesis << TABLE_5_2
0.0119 28.9109
0.0277 28.7144
0.0526 27.2179
0.0876 26.5560
0.1323 25.2043
0.1854 23.8032
0.2447 22.3348
0.3077 20.7466
0.3717 18.9952
0.4344 17.4017
0.4940 15.5091
TABLE_5_2
eta_0 = 29.0214
quemada(x, m) = (1 - x/m)**-2
set fit quiet nolog
m = 0.9
fit quemada(x, m) rows("constrained", "sine") using 1:2:3 yerrors via m
print sprintf("Quemada's phi_m for number fractions: %.3f +- %.3f", m, m_err)
set multiplot layout 1,3
set grid lc rgb "#dddddd"; set key top left
set xlabel "number fraction of colloids' particles"
set title "Viscosity over the solvent's"
set xrange [0:0.52]; set yrange [0.9:5]; set samples 300
plot 1 + 2.5*x with lines dt 3 lc rgb "black" title "1 + 2.5 {/Symbol f}", \
     quemada(x, 0.63) with lines dt 2 lc rgb "black" title "Quemada, {/Symbol f}_m = 0.63", \
     quemada(x, 1.0) with lines lc rgb "#888888" title "(n/4)^2 = (1 - {/Symbol f})^{-2}", \
     quemada(x, m) with lines lc 1 title sprintf("Quemada, fitted {/Symbol f}_m = %.2f", m), \
     rows("constrained", "sine") with yerrorbars lc 1 pt 7 title "octahedra, sine force", \
     rows("constrained", "shear") with yerrorbars lc 3 pt 2 ps 1.5 title "octahedra, shear", \
     rows("free", "sine") with yerrorbars lc 2 pt 6 title "as many free particles"
set title "What the springs add: constrained over free"
set yrange [0.45:1.4]; set key top left
plot 1 with lines lc rgb "black" notitle, \
     springs("sine") with yerrorbars lc 1 pt 7 title "sine force", \
     springs("shear") with yerrorbars lc 3 pt 2 ps 1.5 title "shear", \
     $thesis using 1:($2/eta_0) with points lc 4 pt 4 title "thesis, Table 5.2: {/Symbol h}_s(k_{eff})/{/Symbol h}_s(0)", \
     (1 - x)**0.93 with lines dt 2 lc 4 title "(1 - {/Symbol f})^{0.93}", \
     $thesis using 1:($2/eta_0/(1 - $1)) with points lc 4 pt 5 title "Table 5.2 over (1 - {/Symbol f})"
set title sprintf("The same, volume fraction of spheres of %g", radius)
set xlabel "volume fraction {/Symbol f}_h"
sphere(phi) = 4*pi/3*radius**3*4*phi/(6*(1 - phi))
set xrange [0:sphere(0.52)]; set yrange [0.97:1.12]
plot 1 + 2.5*x with lines dt 3 lc rgb "black" title "1 + 2.5 {/Symbol f}_h", \
     quemada(x, 0.63) with lines dt 2 lc rgb "black" title "Quemada, {/Symbol f}_m = 0.63", \
     springs("sine") using (sphere($1)):2:3 with yerrorbars lc 1 pt 7 title "sine force", \
     springs("shear") using (sphere($1)):2:3 with yerrorbars lc 3 pt 2 ps 1.5 title "shear"
unset multiplot
