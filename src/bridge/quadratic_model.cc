// SPDX-License-Identifier: Apache-2.0
//
// The box: a primal active-set method (Nocedal and Wright, Numerical Optimization, 16.5). Walk to
// the least on the present face; a bound in the way joins the face; at the least, the bound that
// hinders most leaves it. Exact for correlated parameters, where cutting a free step off at the
// box is not even a descent.
//
// The rank: eigenvalues of the information scaled to a diagonal of ones: units do not matter.
#include "bridge/quadratic_model.hh"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace igi
{
namespace
{

constexpr double kUndetermined = 1e-12;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Indices = std::vector<Eigen::Index>;

// Do the residuals tell anything of the parameter, after the loss? Zero but for rounding is zero.
bool tells(const QuadraticModel &model, Eigen::Index i)
{
    return model.information(i, i) > kUndetermined * model.squares(i);
}

Indices indices_not(const Active &active)
{
    Indices free;
    for (size_t i = 0; i < active.size(); i++)
        if (!active[i]) free.push_back(static_cast<Eigen::Index>(i));
    return free;
}

// The curvature among `chosen`, with a diagonal of ones, and the scale: S_ij = s_i C_ij s_j.
Matrix scaled_to_ones(const Matrix &curvature, const Indices &chosen, Vector *scale)
{
    const Eigen::Index m = static_cast<Eigen::Index>(chosen.size());
    Matrix scaled(m, m);
    scale->resize(m);
    for (Eigen::Index i = 0; i < m; i++)
        (*scale)(i) = 1 / std::sqrt(curvature(chosen[i], chosen[i]));
    for (Eigen::Index i = 0; i < m; i++)
        for (Eigen::Index j = 0; j < m; j++)
            scaled(i, j) = curvature(chosen[i], chosen[j]) * (*scale)(i) * (*scale)(j);
    return scaled;
}

// The step from d to the least on the face; a ridge keeps undetermined directions finite.
Vector step_on_face(const QuadraticModel &model, const Vector &slope, const Active &active)
{
    const Indices free = indices_not(active);
    Vector scale, step = Vector::Zero(slope.size());
    if (free.empty()) return step;
    Matrix scaled = scaled_to_ones(model.hessian, free, &scale);
    scaled.diagonal().array() += kUndetermined;
    Vector right(scale.size());
    for (Eigen::Index i = 0; i < right.size(); i++) right(i) = -slope(free[i]) * scale(i);
    const Vector solved = Eigen::LDLT<Matrix>(scaled).solve(right);
    for (Eigen::Index i = 0; i < right.size(); i++) step(free[i]) = solved(i) * scale(i);
    return step;
}

// Goes along the step up to the first bound, which becomes active; false: none was in the way.
bool walk(const Vector &step, const Vector &low, const Vector &high, Vector *d, Active *active)
{
    double most = 1;
    Eigen::Index blocking = -1;
    for (Eigen::Index i = 0; i < d->size(); i++) {
        if ((*active)[static_cast<size_t>(i)] || step(i) == 0) continue;
        const double room = ((step(i) < 0 ? low(i) : high(i)) - (*d)(i)) / step(i);
        if (room < most) {
            most = std::max(room, 0.0);
            blocking = i;
        }
    }
    *d += most * step;
    if (blocking < 0) return false;
    (*d)(blocking) = step(blocking) < 0 ? low(blocking) : high(blocking);
    (*active)[static_cast<size_t>(blocking)] = true;
    return true;
}

// Frees the bound that hinders the descent most; false: none does.
bool release(const QuadraticModel &model, const Vector &slope, const Vector &d, const Vector &low,
             const Active &kept, Active *active)
{
    double worst = 0;
    size_t hindering = active->size();
    for (size_t k = 0; k < active->size(); k++) {
        const Eigen::Index i = static_cast<Eigen::Index>(k);
        if (!(*active)[k] || kept[k]) continue;
        const double inward = d(i) == low(i) ? -slope(i) : slope(i);
        const double hindrance = inward / std::sqrt(model.hessian(i, i));
        if (hindrance > worst) {
            worst = hindrance;
            hindering = k;
        }
    }
    if (hindering == active->size() || worst <= 1e-14 * std::sqrt(2 * model.cost)) return false;
    (*active)[hindering] = false;
    return true;
}

} // namespace

Vector least_in_box(const QuadraticModel &model, const Vector &low, const Vector &high,
                    const Active &held, Active *active)
{
    const Eigen::Index n = model.gradient.size();
    Active kept = held;
    for (Eigen::Index i = 0; i < n; i++)
        if (!(model.hessian(i, i) > 0)) kept[static_cast<size_t>(i)] = true;
    *active = kept;
    Vector d = Vector::Zero(n);
    for (Eigen::Index round = 0; round < 20 * n; round++) {
        const Vector slope = model.gradient + model.hessian * d;
        if (walk(step_on_face(model, slope, *active), low, high, &d, active)) continue;
        const Vector slope_here = model.gradient + model.hessian * d;
        if (!release(model, slope_here, d, low, kept, active)) break;
    }
    return d;
}

double promised_gain(const QuadraticModel &model, const Vector &step)
{
    return -(model.gradient.dot(step) + 0.5 * step.dot(model.hessian * step));
}

int invert(const QuadraticModel &model, const Active &held, Matrix *inverse)
{
    const Eigen::Index n = model.information.rows();
    *inverse = Matrix::Zero(n, n);
    Indices seen;
    for (Eigen::Index i : indices_not(held)) {
        if (tells(model, i)) seen.push_back(i);
        else (*inverse)(i, i) = kInfinity;
    }
    if (seen.empty()) return 0;
    Vector scale;
    const Matrix scaled = scaled_to_ones(model.information, seen, &scale);
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
    const Eigen::Index m = scale.size();
    const double least = kUndetermined * eigen.eigenvalues()(m - 1);
    Matrix part = Matrix::Zero(m, m);
    Vector lost = Vector::Zero(m); // how much of each parameter lies in undetermined directions
    int rank = 0;
    for (Eigen::Index k = 0; k < m; k++) {
        const Vector v = eigen.eigenvectors().col(k);
        if (eigen.eigenvalues()(k) > least) {
            part += v * v.transpose() / eigen.eigenvalues()(k);
            rank++;
        } else {
            lost += v.cwiseAbs2();
        }
    }
    for (Eigen::Index i = 0; i < m; i++)
        for (Eigen::Index j = 0; j < m; j++) {
            double &entry = (*inverse)(seen[i], seen[j]);
            if (lost(i) > kUndetermined || lost(j) > kUndetermined) entry = i == j ? kInfinity : 0;
            else entry = part(i, j) * scale(i) * scale(j);
        }
    return rank;
}

} // namespace igi
