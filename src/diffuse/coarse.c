/* SPDX-License-Identifier: Apache-2.0
 *
 * Elements, their form factors, what the photographs show of them, and the solve.
 *
 * Elements that no photograph shows, but that seen ones look at, are unknowns with their region's
 * albedo:      (I - rho F_uu) b_u = rho (direct_u + F_us B_s)
 * Their solution and the albedos alternate; each is exact for what the other holds fixed.
 */
#include "diffuse/coarse.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "diffuse/region_sums.h"
#include "transport/form_factor.h"
#include "transport/radiosity.h"

#include <string.h>

#define ELEMENT_PATCHES 3 /* side of an element, in patches */
#define MAX_ELEMENTS 3000 /* both sides; those that no light reaches are dropped afterwards */
#define PROBE_RAYS 64     /* an element, to find what it looks at */
#define LIGHT_POINTS 16   /* an element, from which the lights are looked for */
#define SHADOW_RAYS 2
/* What is seen of an element in part differs from what the whole of it receives (the rest may lie
 * under a cupboard): its weight falls with this power of the share that is seen. */
#define PARTLY_SEEN 8
#define MAX_ROUNDS 100
#define SETTLED 1e-6

/* The unseen elements' system, one band at a time. */
typedef struct unseen {
    size_t count;
    uint32_t *element; /* [count] */
    double *factors, *areas, *albedo, *sent, *solution;
    double *received; /* [count][bands] from all but the unseen */
} unseen;

static bool is_lamp(const igi_coarse *c, size_t element)
{
    return c->problem->scene->regions[c->region[element]].emitter;
}

/* The elements that any photograph shows, those that these look at, and so on. */
static igi_status keep_what_matters(igi_context *ctx, igi_coarse *c)
{
    igi_status status = IGI_OK;
    const igi_observations *o = c->problem->observations;
    size_t n = c->elements->count, todo = 0;
    bool *keep = NULL;
    uint32_t *queue = NULL;
    double *row = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &keep));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &queue));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &row));
    for (size_t i = 0; i < o->count; i++) {
        uint32_t e = igi_elements_at(c->elements, igi_surface_triangle(o->surface[i]), o->uv[2 * i],
                                     o->uv[2 * i + 1], igi_surface_is_back(o->surface[i]));
        if (e == IGI_NO_ELEMENT || keep[e]) continue;
        keep[e] = true;
        queue[todo++] = e;
    }
    for (size_t done = 0; done < todo; done++) {
        memset(row, 0, n * sizeof *row);
        igi_form_factor_row_by_rays(c->elements, c->problem->tracer, queue[done], PROBE_RAYS,
                                    igi_seed(ctx), row);
        for (uint32_t e = 0; e < n; e++) {
            if (row[e] == 0 || keep[e]) continue;
            keep[e] = true;
            queue[todo++] = e;
        }
    }
    igi_count_rays(ctx, todo * PROBE_RAYS);
    if (todo == 0) {
        status = igi_fail(ctx, IGI_E_NO_ANSWER,
                          "photographs: no photograph shows any surface; check the cameras");
        goto cleanup;
    }
    IGI_TRY_GOTO(igi_elements_keep(ctx, c->elements, keep));
    c->n = c->elements->count;
cleanup:
    igi_free(keep);
    igi_free(queue);
    igi_free(row);
    return status;
}

/* Means of what was seen, each patch by its area however many pixels show it. */
static void average_photographs(igi_coarse *c)
{
    const igi_problem *p = c->problem;
    const igi_observations *o = p->observations;
    for (uint32_t side = 0; side < 2 * p->patches->count; side++) {
        size_t seen = igi_problem_seen_count(p, side);
        if (seen == 0) continue;
        float share = p->patches->area[side >> 1] / (float)seen;
        for (size_t k = p->site_begin[side]; k < p->site_begin[side + 1]; k++) {
            size_t i = p->order[k];
            uint32_t e = igi_elements_at(c->elements, igi_surface_triangle(o->surface[i]),
                                         o->uv[2 * i], o->uv[2 * i + 1], side & 1);
            if (e == IGI_NO_ELEMENT || is_lamp(c, e)) continue;
            c->weight[e] += share;
            for (size_t b = 0; b < c->bands; b++)
                c->radiance[e * c->bands + b] += share * p->seen[side * c->bands + b];
        }
    }
    for (size_t e = 0; e < c->n; e++) {
        for (size_t b = 0; b < c->bands && c->weight[e] > 0; b++)
            c->radiance[e * c->bands + b] /= c->weight[e];
        float share = c->weight[e] / (float)c->elements->elements[e].area;
        c->weight[e] *= powf(fminf(share, 1), PARTLY_SEEN);
    }
}

static igi_status light_element(igi_context *ctx, void *user, size_t e, int worker)
{
    (void)worker;
    igi_coarse *c = user;
    const igi_element *element = &c->elements->elements[e];
    igi_rng rng = igi_rng_make(igi_seed(ctx), e);
    double shift[3], x[2], point[3];
    for (int d = 0; d < 3; d++) shift[d] = (double)igi_rng_float(&rng);
    double margin = 4 * (double)igi_tracer_epsilon(c->problem->tracer);
    for (int k = 0; k < LIGHT_POINTS; k++) {
        igi_kronecker(shift, k, 2, x);
        const igi_facet *facet = igi_elements_facet(c->elements, (uint32_t)e,
                                                    (k + shift[2]) / LIGHT_POINTS);
        igi_facet_point(facet, x[0], x[1], margin, point);
        igi_vec normal = igi_scale(igi_v_ofd(facet->normal), element->back ? -1 : 1);
        for (size_t l = 0; l < c->lights; l++)
            c->direct[e * c->lights + l] += igi_light_irradiance(
                                                c->problem->lighting, c->problem->tracer, l,
                                                igi_v_ofd(point), normal, SHADOW_RAYS,
                                                (e * LIGHT_POINTS + (size_t)k) * c->lights + l) /
                                            LIGHT_POINTS;
    }
    igi_count_rays(ctx, LIGHT_POINTS * SHADOW_RAYS * c->lights);
    return IGI_OK;
}

static double direct_irradiance(const igi_coarse *c, size_t e, size_t band)
{
    double sum = 0;
    for (size_t l = 0; l < c->lights; l++)
        sum += (double)c->direct[e * c->lights + l] * c->problem->lights[l].value[band];
    return sum;
}

static igi_factor_way factor_way(igi_form_factor_way way)
{
    switch (way) {
    case IGI_FORM_FACTORS_BY_RAYS: return IGI_FACTOR_RAYS;
    case IGI_FORM_FACTORS_BY_HEMICUBE: return IGI_FACTOR_HEMICUBE;
    case IGI_FORM_FACTORS_CLOSED: return IGI_FACTOR_CLOSED;
    }
    return IGI_FACTOR_RAYS;
}

static igi_status prepare(igi_context *ctx, igi_coarse *c)
{
    igi_factor_options o;
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->n, &c->factors));
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->lights, &c->direct));
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->bands, &c->radiance));
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->bands, &c->irradiance));
    IGI_TRY(IGI_ALLOC(ctx, c->n, &c->weight));
    IGI_TRY(IGI_ALLOC(ctx, 3 * c->n, &c->point));
    IGI_TRY(IGI_ALLOC(ctx, c->n, &c->region));
    for (size_t e = 0; e < c->n; e++) {
        c->region[e] = c->elements->elements[e].region;
        for (int k = 0; k < 3; k++)
            c->point[3 * e + (size_t)k] = (float)c->elements->elements[e].centre[k];
    }
    average_photographs(c);
    igi_factor_options_init(&o, factor_way(c->problem->options->form_factors));
    o.seed = igi_seed(ctx);
    if (c->problem->options->rays > 0) o.rays = c->problem->options->rays;
    IGI_TRY(igi_form_factors(ctx, c->elements, c->problem->tracer, &o, c->factors));
    return igi_parallel_for(ctx, c->n, light_element, c);
}

igi_status igi_coarse_create(igi_context *ctx, const igi_problem *problem, igi_coarse **coarse)
{
    igi_status status = IGI_OK;
    igi_coarse *c = NULL;
    *coarse = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &c));
    c->problem = problem;
    c->bands = (size_t)problem->bands;
    c->lights = igi_lighting_count(problem->lighting);
    double size = ELEMENT_PATCHES * (double)problem->patches->size_m;
    IGI_TRY_GOTO(
        igi_elements_create(ctx, &problem->scene->mesh, size, MAX_ELEMENTS, true, &c->elements));
    IGI_TRY_GOTO(keep_what_matters(ctx, c));
    IGI_TRY_GOTO(prepare(ctx, c));
    *coarse = c;
    c = NULL;
cleanup:
    igi_coarse_destroy(c);
    return status;
}

void igi_coarse_destroy(igi_coarse *coarse)
{
    if (!coarse) return;
    igi_elements_destroy(coarse->elements);
    igi_free(coarse->factors);
    igi_free(coarse->direct);
    igi_free(coarse->radiance);
    igi_free(coarse->irradiance);
    igi_free(coarse->weight);
    igi_free(coarse->point);
    igi_free(coarse->region);
    igi_free(coarse);
}

/* The irradiance of element e per band, given all radiances. */
static void gather(const igi_coarse *c, const float *extra, size_t e, double *irradiance)
{
    const double *row = c->factors + e * c->n;
    double sum[IGI_MAX_BANDS] = {0};
    for (size_t j = 0; j < c->n; j++) {
        if (row[j] == 0) continue;
        for (size_t b = 0; b < c->bands; b++)
            sum[b] += row[j] * (double)c->radiance[j * c->bands + b];
    }
    for (size_t b = 0; b < c->bands; b++) {
        double more = extra ? (double)extra[e * c->bands + b] : 0;
        irradiance[b] = fmax(0, direct_irradiance(c, e, b) + IGI_PI * sum[b] + more);
    }
}

static igi_status unseen_create(igi_context *ctx, igi_coarse *c, const float *extra, unseen *u)
{
    IGI_TRY(IGI_ALLOC(ctx, c->n, &u->element));
    for (uint32_t e = 0; e < c->n; e++)
        if (!(c->weight[e] > 0) && !is_lamp(c, e)) u->element[u->count++] = e;
    IGI_TRY(IGI_ALLOC(ctx, u->count * u->count, &u->factors));
    IGI_TRY(IGI_ALLOC(ctx, u->count, &u->areas));
    IGI_TRY(IGI_ALLOC(ctx, u->count, &u->albedo));
    IGI_TRY(IGI_ALLOC(ctx, u->count, &u->sent));
    IGI_TRY(IGI_ALLOC(ctx, u->count, &u->solution));
    IGI_TRY(IGI_ALLOC(ctx, u->count * c->bands, &u->received));
    for (size_t i = 0; i < u->count; i++) {
        u->areas[i] = c->elements->elements[u->element[i]].area;
        for (size_t j = 0; j < u->count; j++)
            u->factors[i * u->count + j] = c->factors[u->element[i] * c->n + u->element[j]];
    }
    for (size_t i = 0; i < u->count * c->bands; i++)
        c->radiance[u->element[i / c->bands] * c->bands + i % c->bands] = 0;
    for (size_t i = 0; i < u->count; i++)
        gather(c, extra, u->element[i], u->received + i * c->bands);
    return IGI_OK;
}

static void unseen_clear(unseen *u)
{
    igi_free(u->element);
    igi_free(u->factors);
    igi_free(u->areas);
    igi_free(u->albedo);
    igi_free(u->sent);
    igi_free(u->solution);
    igi_free(u->received);
}

/* Radiances of the unseen elements for the present albedos. */
static igi_status solve_unseen(igi_context *ctx, igi_coarse *c, const unseen *u,
                               double (*albedo)[IGI_MAX_BANDS])
{
    igi_radiosity_system system = {u->count, u->factors, u->areas, u->albedo, u->sent, SETTLED};
    for (size_t b = 0; b < c->bands; b++) {
        for (size_t i = 0; i < u->count; i++) {
            u->albedo[i] = albedo[c->region[u->element[i]]][b];
            u->sent[i] = u->albedo[i] * u->received[i * c->bands + b];
        }
        IGI_TRY(igi_radiosity_solve(ctx, &system, IGI_RADIOSITY_GAUSS_SEIDEL, u->solution));
        for (size_t i = 0; i < u->count; i++)
            c->radiance[u->element[i] * c->bands + b] = (float)(u->solution[i] / IGI_PI);
    }
    return IGI_OK;
}

igi_status igi_coarse_solve(igi_context *ctx, igi_coarse *coarse, const float *gloss,
                            const float *extra, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_coarse *c = coarse;
    igi_region_sums *sums = NULL;
    unseen u = {0};
    float *diffuse_part = NULL;
    size_t values = c->n * c->bands;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, values, &diffuse_part));
    for (size_t i = 0; i < values; i++) diffuse_part[i] = c->radiance[i] - (gloss ? gloss[i] : 0);
    igi_places places = {c->n, c->region, c->weight, diffuse_part, c->irradiance, c->point};
    IGI_TRY_GOTO(igi_region_sums_create(ctx, c->problem, &sums));
    IGI_TRY_GOTO(unseen_create(ctx, c, extra, &u));
    for (int round = 0; round < MAX_ROUNDS; round++) {
        for (size_t e = 0; e < c->n; e++) {
            double irradiance[IGI_MAX_BANDS];
            gather(c, extra, e, irradiance);
            for (size_t b = 0; b < c->bands; b++)
                c->irradiance[e * c->bands + b] = (float)irradiance[b];
        }
        if (igi_region_sums_albedo(sums, &places, diffuse->albedo) < SETTLED) break;
        IGI_TRY_GOTO(solve_unseen(ctx, c, &u, diffuse->albedo));
    }
    IGI_TRY_GOTO(igi_region_sums_std(ctx, sums, &places, diffuse));
    igi_region_sums_share(c->problem, diffuse);
cleanup:
    igi_region_sums_destroy(sums);
    unseen_clear(&u);
    igi_free(diffuse_part);
    return status;
}

void igi_coarse_hand_on(const igi_coarse *coarse, igi_diffuse *diffuse)
{
    const igi_problem *p = coarse->problem;
    igi_rng rng = igi_rng_make(1, 1);
    for (uint32_t side = 0; side < 2 * p->patches->count; side++) {
        uint32_t triangle, patch = side >> 1;
        float u, v;
        if (igi_problem_seen_count(p, side) > 0 || !(p->patches->area[patch] > 0)) continue;
        igi_patch_sample(p->patches, patch, &rng, &triangle, &u, &v);
        uint32_t e = igi_elements_at(coarse->elements, triangle, u, v, side & 1);
        if (e == IGI_NO_ELEMENT) continue;
        memcpy(diffuse->radiance + side * coarse->bands, coarse->radiance + e * coarse->bands,
               coarse->bands * sizeof *diffuse->radiance);
    }
}
