#pragma once
// Pairwise splitting for m > 0 (Shardlow 2003, scheme S1): friction and noise pair by pair, exactly and with the other
// pairs held, between the kicks of velocity-Verlet for the conservative and driving forces. For the pair of edge k with
// slip u along e, reduced mass mu (m/2 between free particles, m next to a known velocity) and a standard normal w,
//
//   u' = u e^{-zeta dt/mu} + sqrt(kT/mu (1 - e^{-2 zeta dt/mu})) w         (the same for each direction across e)
//
// Where particles spin (particles/spin.h) an impulse across e turns both, so that across e
//
//   1/mu_perp = 1/m_i + 1/m_j + l_i^2/I_i + l_j^2/I_j        (terms of what moves freely)
//
// and w_i changes by -l_i e x impulse/I_i, which needs moments of inertia I > 0. Angular momentum is conserved to rounding.
//
// then the uniform drag zeta_0 the same way per particle. One evaluation per step. Edges are taken colour by colour,
// where the edges of a colour share no particle: the same bits on any thread count.
// Drift: with mass the equations have none to miss; equilibrium is sampled exactly as far as the splitting goes. Order
// without noise: 1. Momentum is conserved to rounding. Stable for any friction, breaks by the conservative force, at dt
// beyond some 0.5 gamma/a; the viscosity falls (-15 %) once dt exceeds m/zeta.
#include "odpd/dynamics/integrator.h"

namespace odpd {

/// Edges of a network in colours: those of one colour share no free particle. Greedy in the order of the edges.
class EdgeColours {
 public:
  /// i, j: ends of each edge; ends of known velocity (free[p] = 0) never collide.
  void assign(std::span<const std::int32_t> i, std::span<const std::int32_t> j,
              std::span<const char> free);
  std::size_t count() const { return start_.size() - 1; }
  /// Edges of a colour, ascending.
  std::span<const std::int32_t> edges(std::size_t colour) const {
    return std::span<const std::int32_t>(edge_).subspan(start_[colour],
                                                        start_[colour + 1] - start_[colour]);
  }

 private:
  std::vector<std::size_t> start_{0};
  std::vector<std::int32_t> edge_;
};

template <int D>
class Shardlow : public Integrator<D> {
 public:
  std::string name() const override { return "shardlow"; }
  int solves() const override { return 0; }
  const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) override;
  void save(StateWriter& out) const override {
    out.write("begun", std::vector<std::int64_t>{begun_ ? 1 : 0});
  }
  void load(const StateReader& in) override { begun_ = in.read_integers("begun").at(0) != 0; }

 private:
  void kick(Dynamics<D>& dynamics, double dt, std::vector<Vec<D>>& velocity) const;
  void exchange(Dynamics<D>& dynamics, const Clock& clock, std::vector<Vec<D>>& velocity,
                std::vector<Vec<D>>& spin);
  void drag(Dynamics<D>& dynamics, const Clock& clock, std::vector<Vec<D>>& velocity) const;

  bool begun_ = false;  // the end velocity waits for the second half of its kick
  EdgeColours colours_;
};

}  // namespace odpd
