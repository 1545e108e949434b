// SPDX-License-Identifier: Apache-2.0
//
// A sum of squares near one point, cost + g d + 1/2 d H d: where it is least inside of a box, and
// which directions it determines. For src/bridge/least_squares.cc.
#ifndef IGI_SRC_BRIDGE_QUADRATIC_MODEL_HH
#define IGI_SRC_BRIDGE_QUADRATIC_MODEL_HH

#include "bridge/least_squares.h"

#include <Eigen/Core>

#include <vector>

namespace igi {

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, IGI_LEAST_SQUARES_MAX_PARAMETERS, 1>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                             IGI_LEAST_SQUARES_MAX_PARAMETERS, IGI_LEAST_SQUARES_MAX_PARAMETERS>;

struct QuadraticModel {
    double cost = 0;
    Vector gradient;
    Matrix hessian;         // sum of rho' J^T J, to step by: never flatter than the cost's loss
    Matrix information;     // H of least_squares.h, to judge by
    Vector squares;         // the diagonal of J^T J without the loss
    double psi_squared = 0; // sum of |rho' r|^2
    double slope = 0;       // sum of the diagonals of rho' 1 + 2 rho'' r r^T
};

// A parameter is active where it is to stay: held for good, without influence, or at its bound.
using Active = std::vector<bool>;

// The least of the model over low <= d <= high, where low <= 0 <= high. `active` receives who lies
// at a bound there, `held` included.
Vector least_in_box(const QuadraticModel &model, const Vector &low, const Vector &high,
                    const Active &held, Active *active);

// What the model promises to gain by the step, >= 0 but for rounding.
double promised_gain(const QuadraticModel &model, const Vector &step);

// The inverse of the information's determined part; see least_squares.h. Returns the rank.
int invert(const QuadraticModel &model, const Active &held, Matrix *inverse);

} // namespace igi

#endif
