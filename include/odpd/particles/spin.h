#pragma once
// A particle that spins has an angular velocity w besides its velocity v. With e from j to i, the slip of a pair is
//
//   v_i - v_j + e x (l_i w_i + l_j w_j),   l_i = r R_i/(R_i + R_j),   l_j = r R_j/(R_i + R_j)
//
// and a force f on i at it is a torque -l_i e x f on i and -l_j e x f on j. As l_i + l_j = r, angular momentum is kept for any lever radii R.
namespace odpd {

/// Of a species.
struct Spin {
  /// R, which only divides the distance between the two (length); 0: it does not spin.
  double lever_radius = 0.0;
  double moment = 0.0;  ///< moment of inertia (mass length^2); 0: torques balance
};

}  // namespace odpd
