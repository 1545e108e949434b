/* SPDX-License-Identifier: Apache-2.0
 *
 * Whole matrices of form factors, by any of the three ways; rows by closed form and by rays.
 *
 * Rays: point and direction of ray k are the four coordinates of point k of Roberts' R sequence,
 * x_d = frac(s_d + k g^-d), g the root of g^5 = g + 1 (2018; a Kronecker sequence), shifted by s
 * for each element; the facet comes from k itself, so merged facets get rays by area. Each hit adds
 * 1/N. The error falls as about N^-0.6, against N^-0.5 of random numbers: what is integrated is an
 * indicator in four dimensions.
 */
#include "transport/form_factor.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "transport/hemicube.h"

void igi_factor_options_init(igi_factor_options *options, igi_factor_way way)
{
    *options = (igi_factor_options){
        .way = way, .rays = 1024, .points = 4, .resolution = 64, .seed = 1};
}

void igi_form_factor_row_by_rays(const igi_elements *elements, const igi_tracer *tracer, uint32_t e,
                                 int rays, uint64_t key, double *row)
{
    igi_rng rng = igi_rng_make(key, e);
    double shift[5], x[4], epsilon = (double)igi_tracer_epsilon(tracer);
    for (int d = 0; d < 5; d++) shift[d] = (double)igi_rng_float(&rng);
    const igi_element *element = &elements->elements[e];
    for (int k = 0; k < rays; k++) {
        igi_kronecker(shift, k, 4, x);
        const igi_facet *facet = igi_elements_facet(elements, e, (k + shift[4]) / rays);
        double point[3];
        igi_facet_point(facet, x[0], x[1], 4 * epsilon, point);
        igi_vec normal = igi_v_ofd(facet->normal);
        if (element->back) normal = igi_scale(normal, -1);
        igi_vec origin = igi_madd(igi_v_ofd(point), normal, (float)epsilon);
        igi_vec direction = igi_cosine_direction(normal, (float)x[2], (float)x[3]);
        igi_hit hit = igi_trace(tracer, origin, direction);
        if (hit.triangle == IGI_NO_HIT) continue;
        uint32_t j = igi_elements_at(elements, hit.triangle, hit.u, hit.v, hit.back);
        if (j != IGI_NO_ELEMENT) row[j] += 1.0 / rays;
    }
}

typedef struct job {
    const igi_elements *elements;
    const igi_tracer *tracer;
    const igi_factor_options *options;
    const igi_hemicube *hemicube;
    igi_hemicube_buffer **buffers; /* [threads] */
    double *factors;
} job;

/* Corners of a facet on one side of it: counter-clockwise as seen from there. */
static void corners_on_side(const igi_facet *facet, bool back, double corner[3][3])
{
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) corner[c][k] = facet->corner[back ? 2 - c : c][k];
}

/* A_i F_ij for two elements, each the union of its facets. */
static double exchange(const igi_elements *elements, const igi_element *a, const igi_element *b)
{
    double sum = 0;
    for (size_t i = 0; i < a->facet_count; i++) {
        const igi_facet *from = &elements->facets[a->first_facet + i];
        double p[3][3], area = igi_facet_area(from);
        corners_on_side(from, a->back, p);
        for (size_t j = 0; j < b->facet_count; j++) {
            double q[3][3];
            corners_on_side(&elements->facets[b->first_facet + j], b->back, q);
            sum += area *
                   igi_form_factor_between((const double(*)[3])p, 3, (const double(*)[3])q, 3);
        }
    }
    return sum;
}

/* The upper triangle of the matrix; reciprocity gives the lower one. */
static igi_status closed_row(igi_context *ctx, void *user, size_t i, int worker)
{
    (void)ctx, (void)worker;
    job *w = user;
    size_t n = w->elements->count;
    const igi_element *e = w->elements->elements;
    for (size_t j = i; j < n; j++) {
        double af = exchange(w->elements, &e[i], &e[j]);
        w->factors[i * n + j] = af / e[i].area;
        w->factors[j * n + i] = af / e[j].area;
    }
    return IGI_OK;
}

static igi_status rays_row(igi_context *ctx, void *user, size_t i, int worker)
{
    (void)worker;
    job *w = user;
    igi_form_factor_row_by_rays(w->elements, w->tracer, (uint32_t)i, w->options->rays,
                                w->options->seed, w->factors + i * w->elements->count);
    igi_count_rays(ctx, (uint64_t)w->options->rays);
    return IGI_OK;
}

static igi_status hemicube_row(igi_context *ctx, void *user, size_t i, int worker)
{
    (void)ctx;
    job *w = user;
    igi_form_factor_row_by_hemicube(w->elements, w->hemicube, w->buffers[worker], (uint32_t)i,
                                    w->options->points, w->options->seed,
                                    w->factors + i * w->elements->count);
    return IGI_OK;
}

static igi_status by_hemicubes(igi_context *ctx, job *w)
{
    igi_status status = IGI_OK;
    igi_hemicube *hemicube = NULL;
    size_t threads = (size_t)igi_threads(ctx);
    IGI_TRY_GOTO(igi_hemicube_create(ctx, w->options->resolution, &hemicube));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, threads, &w->buffers));
    for (size_t i = 0; i < threads; i++)
        IGI_TRY_GOTO(igi_hemicube_buffer_create(ctx, hemicube, &w->buffers[i]));
    w->hemicube = hemicube;
    IGI_TRY_GOTO(igi_parallel_for(ctx, w->elements->count, hemicube_row, w));
cleanup:
    for (size_t i = 0; w->buffers && i < threads; i++) igi_hemicube_buffer_destroy(w->buffers[i]);
    igi_free(w->buffers);
    igi_hemicube_destroy(hemicube);
    return status;
}

igi_status igi_form_factors(igi_context *ctx, const igi_elements *elements,
                            const igi_tracer *tracer, const igi_factor_options *options,
                            double *factors)
{
    job w = {.elements = elements, .tracer = tracer, .options = options, .factors = factors};
    for (size_t i = 0; i < elements->count * elements->count; i++) factors[i] = 0;
    switch (options->way) {
    case IGI_FACTOR_CLOSED: return igi_parallel_for(ctx, elements->count, closed_row, &w);
    case IGI_FACTOR_RAYS: return igi_parallel_for(ctx, elements->count, rays_row, &w);
    case IGI_FACTOR_HEMICUBE: return by_hemicubes(ctx, &w);
    }
    return igi_fail(ctx, IGI_E_USAGE, "form factors: there is no way number %d", (int)options->way);
}
