// SPDX-License-Identifier: Apache-2.0
//
// Ceres walks, and the quadratic model at the point where it stops judges: is this the minimum
// inside of the bounds, and what do the data determine here? Ceres' own covariance aborts or
// returns nonsense on problems that lack rank (ceres-solver issues 112, 777).
#include "bridge/least_squares.h"
#include "bridge/quadratic_model.hh"

extern "C" {
#include "base/context.h"
}

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <vector>

namespace
{

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using igi::Active;
using igi::Matrix;
using igi::QuadraticModel;
using igi::Vector;

int block_size(const igi_least_squares &problem, size_t block)
{
    return problem.block_sizes ? problem.block_sizes[block] : 1;
}

double lower_of(const igi_least_squares &problem, size_t i)
{
    return problem.lower ? problem.lower[i] : -kInfinity;
}

double upper_of(const igi_least_squares &problem, size_t i)
{
    return problem.upper ? problem.upper[i] : kInfinity;
}

Active held_parameters(const igi_least_squares &problem)
{
    Active held(problem.parameter_count);
    for (size_t i = 0; i < held.size(); i++) held[i] = lower_of(problem, i) == upper_of(problem, i);
    return held;
}

// -1 lower, +1 upper, 0 between. A bound reached but for rounding counts as reached.
signed char at_bound(const igi_least_squares &problem, size_t i, double x)
{
    const double low = lower_of(problem, i), high = upper_of(problem, i);
    const double range = std::isfinite(high - low) ? high - low : std::max(1.0, std::fabs(x));
    const double near = 1e-12 * range;
    return x - low <= near ? -1 : high - x <= near ? 1 : 0;
}

// Also false for what Ceres marks as not written (1e302) and for what cannot be squared.
bool usable(const double *values, size_t count)
{
    return std::all_of(values, values + count, [](double v) { return std::fabs(v) <= 1e100; });
}

bool evaluate(const igi_least_squares &problem, size_t block, const double *parameters,
              double *residuals, double *jacobian)
{
    size_t size = static_cast<size_t>(block_size(problem, block));
    return problem.residuals(problem.user, block, parameters, residuals, jacobian) &&
           usable(residuals, size) &&
           (!jacobian || usable(jacobian, size * problem.parameter_count));
}

class Block final : public ceres::CostFunction
{
  public:
    Block(const igi_least_squares &problem, size_t block) : problem_(problem), block_(block)
    {
        set_num_residuals(block_size(problem, block));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.parameter_count));
    }
    bool Evaluate(double const *const *parameters, double *residuals,
                  double **jacobians) const override
    {
        return evaluate(problem_, block_, parameters[0], residuals,
                        jacobians ? jacobians[0] : nullptr);
    }

  private:
    const igi_least_squares &problem_;
    size_t block_;
};

igi_status check(igi_context *ctx, const igi_least_squares &p, const double *start, size_t *count)
{
    if (p.parameter_count < 1 || p.parameter_count > IGI_LEAST_SQUARES_MAX_PARAMETERS)
        return igi_fail(ctx, IGI_E_USAGE, "least squares: %zu parameters; 1 to %d are possible",
                        p.parameter_count, IGI_LEAST_SQUARES_MAX_PARAMETERS);
    if (!(p.loss_scale >= 0) || !(p.residual_variance >= 0) || !(p.tolerance >= 0) ||
        p.max_iterations < 0 || std::isinf(p.residual_variance) || std::isinf(p.tolerance))
        return igi_fail(ctx, IGI_E_USAGE,
                        "least squares: loss_scale, residual_variance, "
                        "max_iterations and tolerance must be 0 or more");
    for (size_t i = 0; i < p.parameter_count; i++)
        if (!usable(start + i, 1) || !(lower_of(p, i) <= upper_of(p, i)) ||
            lower_of(p, i) == kInfinity || upper_of(p, i) == -kInfinity)
            return igi_fail(ctx, IGI_E_USAGE,
                            "least squares: parameter %zu starts at %g between the bounds %g and "
                            "%g; give finite starts and lower <= upper",
                            i, start[i], lower_of(p, i), upper_of(p, i));
    const size_t most = std::numeric_limits<int>::max() / p.parameter_count;
    *count = 0;
    for (size_t b = 0; b < p.block_count; b++) {
        if (block_size(p, b) < 1 || (*count += static_cast<size_t>(block_size(p, b))) > most)
            return igi_fail(ctx, IGI_E_USAGE,
                            "least squares: block %zu of %d residuals; give 1 or more, at most "
                            "%zu in all",
                            b, block_size(p, b), most);
    }
    return IGI_OK;
}

// glog writes to stderr unless a host program has set it up.
void silence()
{
    static const bool done = [] {
        if (!google::IsGoogleLoggingInitialized()) FLAGS_minloglevel = google::GLOG_FATAL;
        return true;
    }();
    (void)done;
}

// Ends the walk where a parameter that is free comes to its bound.
class StopAtBound final : public ceres::IterationCallback
{
  public:
    StopAtBound(const igi_least_squares &problem, const Active &active, const double *x)
        : problem_(problem), active_(active), x_(x)
    {
    }
    ceres::CallbackReturnType operator()(const ceres::IterationSummary &summary) override
    {
        if (summary.iteration > 0)
            for (size_t i = 0; i < active_.size(); i++)
                if (!active_[i] && at_bound(problem_, i, x_[i]) != 0)
                    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
        return ceres::SOLVER_CONTINUE;
    }

  private:
    const igi_least_squares &problem_;
    const Active &active_;
    const double *x_;
};

// Ceres' tests of convergence: that on the gradient is absolute, so it would end a fit of dim
// radiances before it began; it is off. That on the cost is quadratic in the parameters' error.
void minimise(const igi_least_squares &p, ceres::LossFunction *loss, const Active &active,
              int max_iterations, double tolerance, double *x, igi_least_squares_result *result)
{
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.disable_all_safety_checks = true; // they cost; check() has looked
    ceres::Problem problem(ownership);
    const int n = static_cast<int>(p.parameter_count);
    problem.AddParameterBlock(x, n);
    std::vector<int> constant;
    for (int i = 0; i < n; i++) {
        const size_t k = static_cast<size_t>(i);
        if (active[k]) {
            constant.push_back(i);
            continue;
        }
        if (std::isfinite(lower_of(p, k))) problem.SetParameterLowerBound(x, i, lower_of(p, k));
        if (std::isfinite(upper_of(p, k))) problem.SetParameterUpperBound(x, i, upper_of(p, k));
    }
    if (static_cast<int>(constant.size()) == n) return;
    if (!constant.empty()) problem.SetManifold(x, new ceres::SubsetManifold(n, constant));
    for (size_t b = 0; b < p.block_count; b++) problem.AddResidualBlock(new Block(p, b), loss, x);

    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = max_iterations;
    options.max_num_consecutive_invalid_steps = 30;
    options.gradient_tolerance = 0;
    options.parameter_tolerance = tolerance;
    options.function_tolerance = std::max(1e-16, tolerance * tolerance);
    options.update_state_every_iteration = true; // the best point stays if it fails later
    StopAtBound stop(p, active, x);
    options.callbacks.push_back(&stop);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    const int steps = summary.num_successful_steps + summary.num_unsuccessful_steps;
    result->iterations += std::min(std::max(1, steps), max_iterations);
}

// Cost, gradient, Hessian; false where the residuals are not usable.
bool sum_up(const igi_least_squares &p, const ceres::LossFunction *loss, const double *x,
            QuadraticModel *model)
{
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::Index n = static_cast<Eigen::Index>(p.parameter_count);
    *model = QuadraticModel();
    model->gradient = model->squares = Vector::Zero(n);
    model->hessian = model->information = Matrix::Zero(n, n);
    Eigen::VectorXd r;
    RowMajor jacobian;
    for (size_t b = 0; b < p.block_count; b++) {
        const int size = block_size(p, b);
        r.setConstant(size, kInfinity);
        jacobian.setConstant(size, n, kInfinity);
        if (!evaluate(p, b, x, r.data(), jacobian.data())) return false;
        const double s = r.squaredNorm();
        double rho[3] = {s, 1, 0};
        if (loss) loss->Evaluate(s, rho);
        const Vector gradient = jacobian.transpose() * r;
        model->cost += 0.5 * rho[0];
        model->gradient += rho[1] * gradient;
        model->hessian += rho[1] * (jacobian.transpose() * jacobian);
        model->information += 2 * rho[2] * gradient * gradient.transpose();
        model->squares += jacobian.colwise().squaredNorm().transpose();
        model->psi_squared += rho[1] * rho[1] * s;
        model->slope += rho[1] * size + 2 * rho[2] * s;
    }
    model->information += model->hessian;
    return true;
}

double cost_at(const igi_least_squares &p, const ceres::LossFunction *loss, const double *x)
{
    Eigen::VectorXd r;
    double cost = 0;
    for (size_t b = 0; b < p.block_count; b++) {
        r.setConstant(block_size(p, b), kInfinity);
        if (!evaluate(p, b, x, r.data(), nullptr)) return kInfinity;
        double rho[3] = {r.squaredNorm(), 1, 0};
        if (loss) loss->Evaluate(rho[0], rho);
        cost += 0.5 * rho[0];
    }
    return cost;
}

// Shortens the step until the cost falls by a part of what the gradient promises; false: it never
// does, and x is as it was.
bool descend(const igi_least_squares &p, const ceres::LossFunction *loss,
             const QuadraticModel &model, const Vector &step, std::vector<double> *x)
{
    const double promised = -model.gradient.dot(step);
    std::vector<double> trial(x->size());
    for (double t = 1; t > 1e-6; t /= 2) {
        for (size_t i = 0; i < trial.size(); i++)
            trial[i] = std::min(
                std::max((*x)[i] + t * step(static_cast<Eigen::Index>(i)), lower_of(p, i)),
                upper_of(p, i));
        if (!(cost_at(p, loss, trial.data()) < model.cost - 1e-4 * t * promised)) continue;
        *x = trial;
        return true;
    }
    return false;
}

// Would the step change nothing that matters: each parameter by less than the tolerance, or the
// cost by less than its square (an error of tolerance x sqrt(residuals) standard deviations)?
bool small(const QuadraticModel &model, const Vector &step, const std::vector<double> &x,
           double tolerance)
{
    if (igi::promised_gain(model, step) <= std::max(1e-16, tolerance * tolerance) * model.cost)
        return true;
    for (size_t i = 0; i < x.size(); i++)
        if (!(std::fabs(step(static_cast<Eigen::Index>(i))) <=
              tolerance * (std::fabs(x[i]) + tolerance)))
            return false;
    return true;
}

// Ceres does the curved part, the model's least in the box the bounds: Ceres cuts a step off at a
// bound, which with correlated parameters creeps or ends at no minimum (ceres-solver issue 187; one
// in three of small random problems). So: Ceres until it ends or meets a bound, then the model's
// step; where that still gains, take it, hold what it leaves at a bound, and go on.
bool search(const igi_least_squares &p, ceres::LossFunction *loss, std::vector<double> *x,
            QuadraticModel *model, igi_least_squares_result *result)
{
    const double tolerance = p.tolerance > 0 ? p.tolerance : 1e-8;
    const int most = p.max_iterations ? p.max_iterations : 100;
    const Active held = held_parameters(p);
    Active active = held;
    Vector low(x->size()), high(x->size());
    for (int round = 0;; round++) {
        minimise(p, loss, active, most - result->iterations, 0.1 * tolerance, x->data(), result);
        if (!sum_up(p, loss, x->data(), model)) return false;
        for (size_t i = 0; i < x->size(); i++) {
            low(static_cast<Eigen::Index>(i)) = lower_of(p, i) - (*x)[i];
            high(static_cast<Eigen::Index>(i)) = upper_of(p, i) - (*x)[i];
        }
        const Vector step = least_in_box(*model, low, high, held, &active);
        result->converged = small(*model, step, *x, tolerance);
        if (result->converged || result->iterations >= most || round == most) return true;
        if (!descend(p, loss, *model, step, x)) { // at the rounding of the cost, or out of luck
            result->converged = igi::promised_gain(*model, step) <= 1e-12 * model->cost;
            return true;
        }
        for (size_t i = 0; i < x->size(); i++)
            active[i] = held[i] || (active[i] && at_bound(p, i, (*x)[i]) != 0);
    }
}

double variance_of(const igi_least_squares &p, const QuadraticModel &model, size_t residuals,
                   int rank)
{
    if (p.residual_variance > 0) return p.residual_variance;
    const double freedom = static_cast<double>(residuals) - rank;
    if (freedom < 1 || !(model.slope > 0)) return kInfinity;
    return model.psi_squared / freedom / (model.slope / static_cast<double>(residuals));
}

void write_covariance(const Matrix &inverse, double variance, double *covariance)
{
    const Eigen::Index n = inverse.rows();
    for (Eigen::Index i = 0; i < n; i++)
        for (Eigen::Index j = 0; j < n; j++) {
            const double v = inverse(i, j);
            if (std::isfinite(variance)) covariance[i * n + j] = std::isinf(v) ? v : v * variance;
            else covariance[i * n + j] = i == j && v > 0 ? kInfinity : 0;
        }
}

igi_status solve(igi_context *ctx, const igi_least_squares &p, double *parameters,
                 double *covariance, igi_least_squares_result *result)
{
    *result = igi_least_squares_result();
    size_t residuals = 0;
    IGI_TRY(check(ctx, p, parameters, &residuals));
    silence();
    std::vector<double> x(parameters, parameters + p.parameter_count);
    for (size_t i = 0; i < x.size(); i++)
        x[i] = std::min(std::max(x[i], lower_of(p, i)), upper_of(p, i));
    std::unique_ptr<ceres::LossFunction> loss;
    if (p.loss_scale > 0 && std::isfinite(p.loss_scale))
        loss.reset(new ceres::HuberLoss(p.loss_scale));

    QuadraticModel model;
    if (!search(p, loss.get(), &x, &model, result))
        return igi_fail(ctx, IGI_E_NO_ANSWER,
                        "least squares: the residuals are not finite, or "
                        "out of their domain, at the start; start elsewhere");
    Matrix inverse;
    result->cost = model.cost;
    result->rank = igi::invert(model, held_parameters(p), &inverse);
    result->residual_variance = variance_of(p, model, residuals, result->rank);
    for (size_t i = 0; i < x.size(); i++) result->at_bound[i] = at_bound(p, i, x[i]);
    std::copy(x.begin(), x.end(), parameters);
    if (covariance) write_covariance(inverse, result->residual_variance, covariance);
    return IGI_OK;
}

} // namespace

extern "C" igi_status igi_least_squares_solve(igi_context *ctx, const igi_least_squares *problem,
                                              double *parameters, double *covariance,
                                              igi_least_squares_result *result)
{
    try {
        return solve(ctx, *problem, parameters, covariance, result);
    } catch (const std::bad_alloc &) {
        return igi_fail(ctx, IGI_E_SYSTEM, "least squares: no memory for %zu blocks",
                        problem->block_count);
    } catch (const std::exception &e) {
        return igi_fail(ctx, IGI_E_INTERNAL, "least squares: %s", e.what());
    } catch (...) {
        return igi_fail(ctx, IGI_E_INTERNAL, "least squares: an unknown exception");
    }
}
