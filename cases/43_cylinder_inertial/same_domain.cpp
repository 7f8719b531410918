// The flow of this case by another method: lattice Boltzmann (D2Q9, two relaxation times, bounce-back half way), an isothermal
// gas past a cylinder in a periodic domain with a screen, given in diameters. Prints the Reynolds number and the drag coefficient by the
// velocity ahead of the cylinder.
//
//   c++ -O3 -march=native -std=c++20 -o same_domain same_domain.cpp
//   ./same_domain NODES_PER_DIAMETER REYNOLDS MACH LENGTH WIDTH SCREEN CENTRE FRICTION
//
// FRICTION: of the screen, per mass, in units of U/D. The force in the screen makes the velocity there U (all but what the drag takes).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 9) return 1;
  const double d = std::atof(argv[1]), re = std::atof(argv[2]), mach = std::atof(argv[3]);
  const double u0 = mach / std::sqrt(3.0), nu = u0 * d / re, friction = std::atof(argv[8]) * u0 / d;
  const int nx = int(std::lround(std::atof(argv[4]) * d)),
            ny = int(std::lround(std::atof(argv[5]) * d));
  const int screen = int(std::lround(std::atof(argv[6]) * d));
  const double cx = std::atof(argv[7]) * d, cy = 0.5 * ny - 0.25;
  constexpr int ex[9] = {0, 1, 0, -1, 0, 1, -1, -1, 1}, ey[9] = {0, 0, 1, 0, -1, 1, 1, -1, -1};
  constexpr int back[9] = {0, 3, 4, 1, 2, 7, 8, 5, 6};
  constexpr double w[9] = {4 / 9.,  1 / 9.,  1 / 9.,  1 / 9., 1 / 9.,
                           1 / 36., 1 / 36., 1 / 36., 1 / 36.};
  const double plus = 1.0 / (3.0 * nu + 0.5),
               minus = 1.0 / (3.0 / (16.0 * (1.0 / plus - 0.5)) + 0.5);
  const auto cell = [&](int x, int y) { return std::size_t(y) * nx + x; };
  std::vector<char> solid(std::size_t(nx) * ny);
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) solid[cell(x, y)] = std::hypot(x - cx, y - cy) < 0.5 * d;
  // Where each population goes: to a neighbour, or back as its opposite (< 0).
  std::vector<int> to(9 * solid.size());
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x)
      for (int k = 0; k < 9; ++k) {
        const std::size_t c = cell(x, y), next = cell((x + ex[k] + nx) % nx, (y + ey[k] + ny) % ny);
        to[9 * c + k] = solid[next] ? -1 : int(9 * next) + k;
      }
  std::vector<double> f(9 * solid.size()), g(f.size());
  for (std::size_t c = 0; c < solid.size(); ++c)
    for (int k = 0; k < 9; ++k)
      f[9 * c + k] =
          w[k] * (1.0 + 3.0 * ex[k] * u0 + 4.5 * ex[k] * u0 * ex[k] * u0 - 1.5 * u0 * u0);
  const long steps = std::lround(3.0 * nx / u0);
  double drag = 0.0, ahead = 0.0, rho_ahead = 0.0;
  long samples = 0;
  for (long step = 0; step < steps; ++step) {
    const bool measure = step > steps * 2 / 3;
    double force = 0.0;
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        const std::size_t c = cell(x, y);
        if (solid[c]) continue;
        double* p = &f[9 * c];
        double rho = 0.0, ux = 0.0, uy = 0.0;
        for (int k = 0; k < 9; ++k) rho += p[k], ux += p[k] * ex[k], uy += p[k] * ey[k];
        ux /= rho, uy /= rho;
        double ax = 0.0, ay = 0.0;
        if (x < screen) {
          // The velocity half a step later, implicitly.
          ux = (ux + 0.5 * friction * u0) / (1.0 + 0.5 * friction);
          uy = uy / (1.0 + 0.5 * friction);
          ax = friction * (u0 - ux), ay = -friction * uy;
        }
        if (measure && x == int(cx - 4.0 * d)) ahead += ux, rho_ahead += rho, ++samples;
        double eq[9], acc[9];
        for (int k = 0; k < 9; ++k) {
          const double eu = ex[k] * ux + ey[k] * uy;
          eq[k] = w[k] * rho * (1.0 + 3.0 * eu + 4.5 * eu * eu - 1.5 * (ux * ux + uy * uy));
          acc[k] = w[k] * rho *
                   ((3.0 * (ex[k] - ux) + 9.0 * eu * ex[k]) * ax +
                    (3.0 * (ey[k] - uy) + 9.0 * eu * ey[k]) * ay);
        }
        for (int k = 0; k < 9; ++k) {
          const int o = back[k];
          const double even = 0.5 * (p[k] + p[o] - eq[k] - eq[o]),
                       odd = 0.5 * (p[k] - p[o] - eq[k] + eq[o]);
          const double even_a = 0.5 * (acc[k] + acc[o]), odd_a = 0.5 * (acc[k] - acc[o]);
          const double after = p[k] - plus * even - minus * odd + (1.0 - 0.5 * plus) * even_a +
                               (1.0 - 0.5 * minus) * odd_a;
          if (const int next = to[9 * c + k]; next < 0) {
            g[9 * c + o] = after;
            force += 2.0 * after * ex[k];
          } else {
            g[next] = after;
          }
        }
      }
    std::swap(f, g);
    if (measure) drag += force;
  }
  const double u = ahead / double(samples), rho = rho_ahead / double(samples);
  drag /= double(samples) / ny;
  std::printf("Re %.3f  Mach %.3f  C_D %.4f\n", u * d / nu, u * std::sqrt(3.0),
              drag / (0.5 * rho * u * u * d));
}
