/* SPDX-License-Identifier: Apache-2.0
 *
 * Places of one region that lie together: a coarse grid over the room.
 */
#ifndef IGI_SRC_DIFFUSE_CELLS_H
#define IGI_SRC_DIFFUSE_CELLS_H

#include "diffuse/region_sums.h"

#define IGI_NO_CELL UINT32_MAX

typedef struct igi_cells {
    size_t count;
    uint32_t *of_place;  /* [places] IGI_NO_CELL: the place has no weight */
    uint32_t *region;    /* [count] */
    uint32_t *of_region; /* [regions] how many cells each has */
} igi_cells;

/* Cells are numbered in the order in which the places meet them. */
IGI_MUST_USE igi_status igi_cells_create(igi_context *ctx, const igi_problem *problem,
                                         const igi_places *places, igi_cells *cells);
void igi_cells_clear(igi_cells *cells);

#endif
