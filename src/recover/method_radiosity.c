/* SPDX-License-Identifier: Apache-2.0
 *
 * The classical way, as the first step of the 1999 paper: coarse elements, dense form factors.
 *
 *     B_i = rho_r(i) H_i,    H_i = direct_i + sum_j F_ij B_j        per band, B = pi L
 *
 * B of a seen element is the mean of what the photographs show of it. Elements that none shows, but
 * that seen ones look at, are unknowns with their region's albedo:
 *     (I - rho F_uu) b_u = rho (direct_u + F_us B_s)
 * and rho of a region is the ratio of the sums of B and H over its seen elements. The two steps
 * alternate; each is exact for what the other holds fixed. Lamps count in direct_i, where their
 * shape is integrated in closed form, and are black in B: through F, a small lamp would be met by
 * a handful of rays.
 *
 * What is wrong with it, and why it is not the default: one value an element. Light that changes
 * within an element (a shadow edge, a corner) is lost, and an element of which photographs show a
 * part is taken to be like that part.
 */
#include "recover/methods.h"

#include "base/parallel.h"
#include "recover/region_sums.h"
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
#define SETTLED 1e-7

typedef struct coarse {
    const igi_problem *problem;
    igi_elements *elements;
    size_t n, bands, lights;
    double *factors;   /* [n][n] */
    float *direct;     /* [n][lights] irradiance per unit of the light's value */
    float *radiance;   /* [n][bands] */
    float *irradiance; /* [n][bands] */
    float *weight;     /* [n] area seen, less where it is a part; 0: unseen, or a lamp */
    float *point;      /* [n][3] */
    uint32_t *region;  /* [n] */
    /* The unseen elements' system, one band at a time. */
    size_t hidden_count;
    uint32_t *hidden; /* [hidden_count] */
    double *block, *areas, *albedo, *sent, *solution;
} coarse;

static bool is_lamp(const coarse *c, size_t element)
{
    uint32_t region = c->elements->elements[element].region;
    return c->problem->scene->regions[region].emitter;
}

/* The elements that any photograph shows, those that these look at, and so on. */
static igi_status keep_what_matters(igi_context *ctx, coarse *c)
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
static void average_photographs(coarse *c)
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
    coarse *c = user;
    const igi_element *element = &c->elements->elements[e];
    igi_rng rng = igi_rng_make(igi_seed(ctx), e);
    double shift[3], x[2], point[3];
    for (int d = 0; d < 3; d++) shift[d] = (double)igi_rng_float(&rng);
    double margin = 4 * (double)igi_tracer_epsilon(c->problem->tracer);
    for (int k = 0; k < LIGHT_POINTS; k++) {
        igi_form_factor_pattern(shift, k, 2, x);
        const igi_facet *facet =
            igi_elements_facet(c->elements, (uint32_t)e, (k + shift[2]) / LIGHT_POINTS);
        igi_facet_point(facet, x[0], x[1], margin, point);
        igi_vec normal = igi_scale(igi_v_ofd(facet->normal), element->back ? -1 : 1);
        for (size_t l = 0; l < c->lights; l++)
            c->direct[e * c->lights + l] +=
                igi_light_irradiance(c->problem->lighting, c->problem->tracer, l, igi_v_ofd(point),
                                     normal, SHADOW_RAYS,
                                     (e * LIGHT_POINTS + (size_t)k) * c->lights + l) /
                LIGHT_POINTS;
    }
    igi_count_rays(ctx, LIGHT_POINTS * SHADOW_RAYS * c->lights);
    return IGI_OK;
}

static double direct_irradiance(const coarse *c, size_t e, size_t band)
{
    double sum = 0;
    for (size_t l = 0; l < c->lights; l++)
        sum += (double)c->direct[e * c->lights + l] * c->problem->lights[l].value[band];
    return sum;
}

static igi_status prepare(igi_context *ctx, coarse *c)
{
    igi_factor_options o;
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->n, &c->factors));
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->lights, &c->direct));
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->bands, &c->radiance));
    IGI_TRY(IGI_ALLOC(ctx, c->n * c->bands, &c->irradiance));
    IGI_TRY(IGI_ALLOC(ctx, c->n, &c->weight));
    IGI_TRY(IGI_ALLOC(ctx, 3 * c->n, &c->point));
    IGI_TRY(IGI_ALLOC(ctx, c->n, &c->region));
    IGI_TRY(IGI_ALLOC(ctx, c->n, &c->hidden));
    for (size_t e = 0; e < c->n; e++) {
        c->region[e] = c->elements->elements[e].region;
        for (int k = 0; k < 3; k++)
            c->point[3 * e + (size_t)k] = (float)c->elements->elements[e].centre[k];
    }
    average_photographs(c);
    igi_factor_options_init(&o, IGI_FACTOR_RAYS);
    o.seed = igi_seed(ctx);
    if (c->problem->options->rays > 0) o.rays = c->problem->options->rays;
    IGI_TRY(igi_form_factors(ctx, c->elements, c->problem->tracer, &o, c->factors));
    return igi_parallel_for(ctx, c->n, light_element, c);
}

static igi_status set_up_hidden(igi_context *ctx, coarse *c)
{
    for (uint32_t e = 0; e < c->n; e++)
        if (!(c->weight[e] > 0) && !is_lamp(c, e)) c->hidden[c->hidden_count++] = e;
    size_t m = c->hidden_count;
    IGI_TRY(IGI_ALLOC(ctx, m * m, &c->block));
    IGI_TRY(IGI_ALLOC(ctx, m, &c->areas));
    IGI_TRY(IGI_ALLOC(ctx, m, &c->albedo));
    IGI_TRY(IGI_ALLOC(ctx, m, &c->sent));
    IGI_TRY(IGI_ALLOC(ctx, m, &c->solution));
    for (size_t i = 0; i < m; i++) {
        c->areas[i] = c->elements->elements[c->hidden[i]].area;
        for (size_t j = 0; j < m; j++)
            c->block[i * m + j] = c->factors[c->hidden[i] * c->n + c->hidden[j]];
    }
    return IGI_OK;
}

/* The irradiance of element e, given all radiances. */
static double gather(const coarse *c, size_t e, size_t band)
{
    double sum = 0;
    for (size_t j = 0; j < c->n; j++)
        sum += c->factors[e * c->n + j] * (double)c->radiance[j * c->bands + band];
    return direct_irradiance(c, e, band) + IGI_PI * sum;
}

/* Radiances of the unseen elements for the present albedos. */
static igi_status solve_hidden(igi_context *ctx, coarse *c, double (*albedo)[IGI_MAX_BANDS])
{
    igi_radiosity_system system = {c->hidden_count, c->block, c->areas, c->albedo, c->sent, 0};
    for (size_t b = 0; b < c->bands; b++) {
        for (size_t i = 0; i < c->hidden_count; i++) c->radiance[c->hidden[i] * c->bands + b] = 0;
        for (size_t i = 0; i < c->hidden_count; i++) {
            c->albedo[i] = albedo[c->region[c->hidden[i]]][b];
            c->sent[i] = c->albedo[i] * gather(c, c->hidden[i], b);
        }
        IGI_TRY(igi_radiosity_solve(ctx, &system, IGI_RADIOSITY_GAUSS_SEIDEL, c->solution));
        for (size_t i = 0; i < c->hidden_count; i++)
            c->radiance[c->hidden[i] * c->bands + b] = (float)(c->solution[i] / IGI_PI);
    }
    return IGI_OK;
}

static igi_status alternate(igi_context *ctx, coarse *c, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_region_sums *sums = NULL;
    igi_places places = {c->n, c->region, c->weight, c->radiance, c->irradiance, c->point};
    IGI_TRY_GOTO(igi_region_sums_create(ctx, c->problem, &sums));
    for (int round = 0; round < MAX_ROUNDS; round++) {
        for (size_t i = 0; i < c->n * c->bands; i++)
            c->irradiance[i] = (float)gather(c, i / c->bands, i % c->bands);
        double change = igi_region_sums_albedo(sums, &places, diffuse->albedo);
        if (change < SETTLED) break;
        IGI_TRY_GOTO(solve_hidden(ctx, c, diffuse->albedo));
    }
    IGI_TRY_GOTO(igi_region_sums_std(ctx, sums, &places, diffuse));
cleanup:
    igi_region_sums_destroy(sums);
    return status;
}

/* Sides of patches that no photograph shows get what their element has. */
static void hand_on_radiance(const coarse *c, igi_diffuse *diffuse)
{
    const igi_problem *p = c->problem;
    igi_rng rng = igi_rng_make(1, 1);
    for (uint32_t side = 0; side < 2 * p->patches->count; side++) {
        uint32_t triangle, patch = side >> 1;
        float u, v;
        if (igi_problem_seen_count(p, side) > 0 || !(p->patches->area[patch] > 0)) continue;
        igi_patch_sample(p->patches, patch, &rng, &triangle, &u, &v);
        uint32_t e = igi_elements_at(c->elements, triangle, u, v, side & 1);
        if (e == IGI_NO_ELEMENT) continue;
        memcpy(diffuse->radiance + side * c->bands, c->radiance + e * c->bands,
               c->bands * sizeof *diffuse->radiance);
    }
}

igi_status igi_method_radiosity(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    coarse c = {.problem = problem,
                .bands = (size_t)problem->bands,
                .lights = igi_lighting_count(problem->lighting)};
    double size = ELEMENT_PATCHES * (double)problem->patches->size_m;
    igi_stage_begin(ctx, "form factors");
    IGI_TRY_GOTO(
        igi_elements_create(ctx, &problem->scene->mesh, size, MAX_ELEMENTS, true, &c.elements));
    IGI_TRY_GOTO(keep_what_matters(ctx, &c));
    IGI_TRY_GOTO(prepare(ctx, &c));
    igi_stage_begin(ctx, "solve");
    IGI_TRY_GOTO(set_up_hidden(ctx, &c));
    IGI_TRY_GOTO(alternate(ctx, &c, diffuse));
    hand_on_radiance(&c, diffuse);
cleanup:
    igi_elements_destroy(c.elements);
    igi_free(c.factors);
    igi_free(c.direct);
    igi_free(c.radiance);
    igi_free(c.irradiance);
    igi_free(c.weight);
    igi_free(c.point);
    igi_free(c.region);
    igi_free(c.hidden);
    igi_free(c.block);
    igi_free(c.areas);
    igi_free(c.albedo);
    igi_free(c.sent);
    igi_free(c.solution);
    return status;
}
