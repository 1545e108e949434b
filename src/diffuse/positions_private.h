/* SPDX-License-Identifier: Apache-2.0
 *
 * The fields of igi_positions, for src/diffuse/positions*.c alone.
 */
#ifndef IGI_SRC_DIFFUSE_POSITIONS_PRIVATE_H
#define IGI_SRC_DIFFUSE_POSITIONS_PRIVATE_H

#include "diffuse/cells.h"
#include "diffuse/positions.h"

#define IGI_PLACE_STEPS 7 /* a place, and one step either way along each axis */

/* An unknown power: of a light in a band; relative. */
typedef struct igi_place_power {
    size_t light;
    int band; /* or -1: all bands together */
} igi_place_power;

struct igi_positions {
    const igi_problem *problem;
    size_t bands, regions, count, power_count, columns; /* columns: 3 count + power_count */
    size_t *light;           /* [count] numbers of the problem's lights */
    igi_place_power *powers; /* [power_count] */
    double (*prior)[3];      /* [count] where the manifest puts it */
    double *prior_std;       /* [count] metres */

    igi_cells cells;
    double *size;      /* [cells] area, m^2 */
    double *reflected; /* [cells][bands] pi L, mean */
    double *received;  /* [cells][bands] irradiance but for the lights, mean */
    double *noise;     /* [cells][bands] variance of that, as the rays scatter */
    double *direct;    /* [cells][lights of the problem] by them, per unit of value, mean */
    double *moved;     /* [cells][count][IGI_PLACE_STEPS] the same from each of a light's places */
    double *trust;     /* [cells][bands] 0..1 */
    double *scatter;   /* [regions] relative variance of a cell about the equation, per 1/m^2 */
    double *inverse;   /* [regions][bands] 1 / albedo */
    double *share;     /* [regions][bands][columns] mean of d ln E / d column */
    double *matrix, *factor, *covariance; /* [columns][columns] */
    double *right, *gains;                /* [columns] */
    double *sums;                         /* [regions][bands] work space */
};

/* What of the cells does not change while the lights are moved, from a solved diffuse->rows. */
IGI_MUST_USE igi_status igi_positions_fill_cells(igi_context *ctx, igi_positions *p,
                                                 const igi_diffuse *diffuse,
                                                 const igi_places *places);
void igi_positions_clear_cells(igi_positions *p);
/* `moved` and `direct` of where the lights stand now; wanted[2 patches]: the places' sides. */
IGI_MUST_USE igi_status igi_positions_gather(igi_context *ctx, igi_positions *p,
                                             const igi_places *places, const uint8_t *wanted);
void igi_place_shift(igi_light *light, int axis, double metres);
/* One step of Gauss and Newton from `moved`: steps[columns]; adapts: cells are weighed by how
 * their region fits. false: the system is singular. */
bool igi_positions_step(igi_positions *p, bool adapts, double *steps);
/* Fills `covariance` (a sandwich over cells) after the last step. */
bool igi_positions_covariance(igi_positions *p);

#endif
