/* SPDX-License-Identifier: Apache-2.0
 *
 * The reference kernel: rays in all directions from random places in a box that holds bumpy
 * ground. Incoherent rays are what recovery spends its time on.
 */
#include "chart/speed.h"

#include "base/rng.h"
#include "trace/trace.h"

#define CELLS 64 /* along the ground's side: 8,192 triangles */
#define RAYS 1000000u

static float height(int x, int y)
{
    igi_rng rng = igi_rng_make(1, (uint64_t)(y * (CELLS + 1) + x));
    return .2f * igi_rng_float(&rng);
}

static void make_ground(igi_mesh *mesh)
{
    for (int y = 0; y <= CELLS; y++)
        for (int x = 0; x <= CELLS; x++) {
            float *p = mesh->positions + 3 * (size_t)(y * (CELLS + 1) + x);
            p[0] = (float)x / CELLS;
            p[1] = (float)y / CELLS;
            p[2] = height(x, y);
        }
    uint32_t *t = mesh->triangles;
    for (uint32_t y = 0; y < CELLS; y++)
        for (uint32_t x = 0; x < CELLS; x++, t += 6) {
            uint32_t a = y * (CELLS + 1) + x, b = a + 1, c = a + CELLS + 1, d = c + 1;
            const uint32_t two[6] = {a, b, d, a, d, c};
            for (int k = 0; k < 6; k++) t[k] = two[k];
        }
}

igi_status chart_reference_seconds(igi_context *ctx, double *seconds)
{
    igi_status status = IGI_OK;
    igi_tracer *tracer = NULL;
    igi_mesh mesh = {.vertex_count = (CELLS + 1) * (CELLS + 1),
                     .triangle_count = 2 * CELLS * CELLS};
    *seconds = 0;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * mesh.vertex_count, &mesh.positions));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * mesh.triangle_count, &mesh.triangles));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh.triangle_count, &mesh.regions));
    make_ground(&mesh);
    IGI_TRY_GOTO(igi_tracer_create(ctx, &mesh, &tracer));
    double began = igi_cpu_seconds();
    igi_rng rng = igi_rng_make(2, 0);
    uint32_t met = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        float x = igi_rng_float(&rng), y = igi_rng_float(&rng), z = 1 - 2 * igi_rng_float(&rng);
        float turn = 2 * IGI_PIF * igi_rng_float(&rng), r = sqrtf(fmaxf(0, 1 - z * z));
        igi_vec from = {x, y, .5f}, toward = {r * cosf(turn), r * sinf(turn), z};
        met += igi_trace(tracer, from, toward).triangle != IGI_NO_HIT;
    }
    /* The count is used, so that no compiler leaves the rays out. */
    *seconds = met > 0 ? igi_cpu_seconds() - began : 1;
cleanup:
    igi_tracer_destroy(tracer);
    igi_free(mesh.positions);
    igi_free(mesh.triangles);
    igi_free(mesh.regions);
    return status;
}
