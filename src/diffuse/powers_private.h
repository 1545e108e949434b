/* SPDX-License-Identifier: Apache-2.0
 *
 * The fields of igi_powers, for src/diffuse/powers*.c alone.
 */
#ifndef IGI_SRC_DIFFUSE_POWERS_PRIVATE_H
#define IGI_SRC_DIFFUSE_POWERS_PRIVATE_H

#include "diffuse/cells.h"
#include "diffuse/powers.h"

#define IGI_ALL_BANDS (-1)
/* Standard deviation of a guess, in the value's unit, which is the guess. */
#define IGI_GUESS_STD 3.0
#define IGI_FIRST_SCATTER 1e-4 /* of a region of which nothing is known yet */

/* An unknown number: a light's value in a band, or, of lights whose bands stand in a given ratio
 * (a profile, a sky), in all of them. */
typedef struct igi_power_variable {
    size_t light, column; /* column: of `gain` */
    int band;             /* IGI_ALL_BANDS, or the one */
    double unit;          /* a guess of the value; 0: the light reaches nothing that is seen */
    double value;         /* in units */
    double guess_std;     /* of the guess, in units: IGI_GUESS_STD, or that of what was read */
} igi_power_variable;

struct igi_powers {
    const igi_problem *problem;
    const igi_rows *rows;
    size_t bands, regions, columns, count, steps, adapted;
    double boldness, change;       /* share of a step that is taken; the last step */
    igi_power_variable *variables; /* [count] */
    igi_cells cells;
    double *size;      /* [cells] patches in it */
    double *reflected; /* [cells][bands] pi L, mean */
    double *received;  /* [cells][bands] irradiance without that of the unknown lights, mean */
    double *gain;      /* [cells][columns][bands] irradiance per unit of the light's value, mean */
    double *trust;     /* [cells][bands] 0..1: less, where it does not fit */
    double *scatter;   /* [regions][bands] relative variance of one patch about the equation */
    double *inverse;   /* [regions][bands] t = 1 / albedo */
    double *weight;    /* [regions][bands] sum over the cells of 1 / variance */
    double *mean_gain; /* [regions][bands][count] d ln(irradiance) / d value */
    double *matrix, *factor, *right; /* [count][count], the same, [count]: the small system */
    double *own;                     /* [count] work space */
    double *misfits, *next;          /* [regions][bands], [count] */
    bool *is_held;                   /* [count] at an end of its range */
};

static inline bool igi_power_in_band(const igi_power_variable *v, size_t band)
{
    return v->unit > 0 && (v->band == IGI_ALL_BANDS || (size_t)v->band == band);
}

static inline double igi_guess_precision(const igi_power_variable *v)
{
    return 1 / (v->guess_std * v->guess_std);
}

/* Irradiance of a cell by a variable of value 1, in units. */
static inline double igi_power_gain(const igi_powers *p, size_t cell, size_t variable, size_t band)
{
    const igi_power_variable *v = &p->variables[variable];
    if (!igi_power_in_band(v, band)) return 0;
    return v->unit * p->gain[(cell * p->columns + v->column) * p->bands + band];
}

/* Regions' scatter and cells' trust, from how the present values fit. */
void igi_powers_weigh(igi_powers *p);

/* Irradiance of a cell with the present values. */
double igi_power_irradiance(const igi_powers *p, size_t cell, size_t band);
/* 1 / variance of what a cell says. */
double igi_power_weight(const igi_powers *p, size_t cell, size_t band);
/* How far a cell lies from its region's equation, relative to its irradiance. */
double igi_power_misfit(const igi_powers *p, size_t cell, size_t band);
/* By how much that falls with each variable. */
void igi_power_gains(const igi_powers *p, size_t cell, size_t band, double *gains);

typedef struct igi_power_outcome {
    const igi_powers *p;
    double *covariance; /* [count][count], in units */
} igi_power_outcome;

static inline double igi_power_std(const igi_power_outcome *o, size_t variable)
{
    return sqrt(fmax(0, o->covariance[variable * (o->p->count + 1)]));
}

/* Warns of the light whose first variable this is, unless its value is known well. */
IGI_MUST_USE igi_status igi_power_explain(igi_context *ctx, const igi_power_outcome *o,
                                          size_t first, igi_diffuse *diffuse);

#endif
