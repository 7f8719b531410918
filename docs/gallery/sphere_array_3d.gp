# cases/16_sphere_array_3d/README.md. Run in this directory: gnuplot sphere_array_3d.gp
set terminal pngcairo size 640,430 font "sans,10"
set output "sphere_array_3d.png"
a = 0.961
phi(L) = 4.0/3.0*pi*(a/L)**3
k(p) = 1/(1 - 1.7601*p**(1.0/3) + p - 1.5593*p**2 + 3.9799*p**(8.0/3) - 3.0734*p**(10.0/3))
set xlabel "edge L of the cell"
set ylabel "drag F/(6 pi eta U) = a K"
set xrange [3.7:6.5]
set key top right
$measured << EOD
4 2.600 0.028
5 1.987 0.025
6 1.705 0.021
EOD
plot a*k(phi(x)) title "Zick and Homsy 1982, a = 0.961" lc rgb "#888888" lw 2, \
  $measured with yerrorbars pt 7 lc rgb "#1f5fa8" title "measured"
