/* SPDX-License-Identifier: Apache-2.0 */
#include "diffuse/cells.h"

/* Side of a cell in patches. */
#define CELL_PATCHES 6

typedef struct slot {
    uint32_t cell; /* IGI_NO_CELL: empty */
    uint32_t region;
    int32_t at[3];
} slot;

/* The slot of the key in the open table: filled, or where it belongs. */
static slot *find_slot(slot *table, size_t slots, uint32_t region, const int32_t at[3])
{
    uint64_t h = igi_hash64(((uint64_t)(uint32_t)at[0] << 32 | (uint32_t)at[1]) ^
                            igi_hash64((uint64_t)(uint32_t)at[2] << 32 | region));
    for (size_t i = h & (slots - 1);; i = (i + 1) & (slots - 1)) {
        slot *s = &table[i];
        if (s->cell == IGI_NO_CELL) return s;
        if (s->region == region && s->at[0] == at[0] && s->at[1] == at[1] && s->at[2] == at[2])
            return s;
    }
}

igi_status igi_cells_create(igi_context *ctx, const igi_problem *problem, const igi_places *places,
                            igi_cells *cells)
{
    igi_status status = IGI_OK;
    slot *table = NULL;
    size_t slots = 64;
    float side = CELL_PATCHES * problem->patches->size_m;
    *cells = (igi_cells){0};
    while (slots < 2 * places->count) slots *= 2;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, slots, &table));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, places->count, &cells->of_place));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, places->count, &cells->region));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &cells->of_region));
    for (size_t i = 0; i < slots; i++) table[i].cell = IGI_NO_CELL;
    for (size_t i = 0; i < places->count; i++) {
        cells->of_place[i] = IGI_NO_CELL;
        if (places->weight[i] <= 0) continue;
        int32_t at[3];
        for (int k = 0; k < 3; k++)
            at[k] = (int32_t)floorf(places->point[3 * i + (size_t)k] / side);
        slot *s = find_slot(table, slots, places->region[i], at);
        if (s->cell == IGI_NO_CELL) {
            *s = (slot){(uint32_t)cells->count, places->region[i], {at[0], at[1], at[2]}};
            cells->region[cells->count++] = places->region[i];
            cells->of_region[places->region[i]]++;
        }
        cells->of_place[i] = s->cell;
    }
cleanup:
    igi_free(table);
    if (status != IGI_OK) igi_cells_clear(cells);
    return status;
}

void igi_cells_clear(igi_cells *cells)
{
    igi_free(cells->of_place);
    igi_free(cells->region);
    igi_free(cells->of_region);
    *cells = (igi_cells){0};
}
