/* SPDX-License-Identifier: Apache-2.0
 *
 * A light that nobody lists leaves its pattern in the albedos of sides: to a bulb at x of intensity s
 * falls the share d_i(x) = cos(theta) / (r^2 E_i), and
 *     a_i = rho (1 + sum s_l d_il + s d_i(x)).
 * For each x of a grid s follows by least squares beside the scales of the lights that are known, the
 * regions' means and those scales being eliminated. The best of many places is better than it should
 * be by chance, and what is alike over a region passes for light: both are asked for more than that.
 */
#include "recover/doubt.h"

#include "base/box.h"
#include "base/solve.h"

#include <string.h>

enum { LIGHTS = IGI_SHARES_LIGHTS, STEPS = 5, ROUNDS = 4, FIRST = 4, BEST = 6 };
#define MARGIN 0.1        /* of the room's size, that the grid stays away from its ends */
#define NEAREST 0.03      /* of its size: a bulb shines no brighter than from so far */
#define BY_CHANCE 3.5     /* standard deviations of the best of the grid where nothing is missing */
#define SURE 6.0          /* standard deviations that deserve a word, */
#define SURE_REGIONS 4.0  /* and when regions are left out in turn, */
#define WORTH_A_WORD .015 /* and a share of the light */

/* Of a region, for one place: sums of weights, with d, d^2, and d with what is off and the shares. */
typedef struct terms {
    double w, d, dd, off, share[LIGHTS], sides, plain; /* plain: of d, all alike */
} terms;

typedef struct search {
    const igi_light_shares *s;
    double nearest2;
    terms *regions; /* [regions] of the last place, */
    terms all;      /* centred and added up */
    double matrix[LIGHTS * LIGHTS], right[LIGHTS];
    uint64_t rays;
} search;

typedef struct bulb {
    igi_vec at;
    double intensity, error; /* mean over bands */
    double sigmas;           /* one over the other */
} bulb;

/* Irradiance from a bulb of intensity 1. */
static double received_from(const igi_look *l, igi_vec at, double nearest2)
{
    igi_vec to = igi_sub(at, l->point);
    double r2 = (double)igi_dot(to, to), along = (double)igi_dot(to, l->normal);
    return along > 0 ? along / (sqrt(r2) * fmax(r2, nearest2)) : 0;
}

static void add_look(const search *q, const igi_look *l, igi_vec at, bool shadows, terms *t)
{
    const igi_light_shares *s = q->s;
    double d = received_from(l, at, q->nearest2) / l->received;
    if (d > 0 && shadows && igi_occluded(s->p->tracer, l->point, at)) d = 0;
    t->sides++;
    t->plain += d;
    t->w += l->weight;
    t->d += l->weight * d;
    t->dd += l->weight * d * d;
    t->off += l->weight * d * l->off;
    for (size_t k = 0; k < s->light_count; k++) t->share[k] += l->weight * d * l->share[k];
}

static void add_terms(terms *all, const terms *t, double sign, size_t lights)
{
    if (!(t->w > 0)) return;
    all->dd += sign * (t->dd - t->d * t->d / t->w);
    all->off += sign * t->off;
    for (size_t k = 0; k < lights; k++) all->share[k] += sign * t->share[k];
}

/* The intensity and its error, what the known lights explain being taken out; false: nothing tells. */
static bool solve(const search *q, const terms *all, const double *matrix, const double *right,
                  double *intensity, double *error)
{
    size_t n = q->s->light_count;
    double m[LIGHTS * LIGHTS], x[2 * LIGHTS], information = all->dd, sum = all->off;
    memcpy(m, matrix, sizeof m);
    for (size_t k = 0; k < n; k++) {
        m[k * n + k] += 1; /* as in the survey */
        x[k] = all->share[k];
        x[n + k] = right[k];
    }
    if (n > 0 && !igi_solve_cholesky(m, n, x, 2)) return false;
    for (size_t k = 0; k < n; k++) {
        information -= all->share[k] * x[k];
        sum -= all->share[k] * x[n + k];
    }
    if (!(information > 1e-9 * all->dd)) return false;
    *intensity = sum / information;
    *error = 1 / sqrt(information);
    return true;
}

/* How many standard deviations of light there are from `at`, by every so many sides, which stand for
 * the others. */
static double try_place(search *q, igi_vec at, size_t stride, bool shadows, bulb *found)
{
    const igi_light_shares *s = q->s;
    memset(q->regions, 0, s->regions * sizeof *q->regions);
    for (size_t i = 0; i < s->count; i += stride)
        if (s->looks[i].weight > 0 || shadows)
            add_look(q, &s->looks[i], at, shadows, &q->regions[s->looks[i].region]);
    if (shadows) q->rays += s->count;
    q->all = (terms){.w = 0};
    for (size_t r = 0; r < s->regions; r++) add_terms(&q->all, &q->regions[r], 1, s->light_count);
    found->at = at;
    found->sigmas = 0;
    if (solve(q, &q->all, q->matrix, q->right, &found->intensity, &found->error))
        found->sigmas = found->intensity / found->error;
    return found->sigmas;
}

/* What regions left out in turn change. */
static double jackknife(const search *q, const bulb *found)
{
    const igi_light_shares *s = q->s;
    size_t n = s->light_count;
    double squares = 0, voices = 0;
    for (size_t r = 0; r < s->regions; r++) {
        double matrix[LIGHTS * LIGHTS], right[LIGHTS], intensity, error;
        terms all = q->all;
        if (!(q->regions[r].w > 0)) continue;
        add_terms(&all, &q->regions[r], -1, n);
        for (size_t k = 0; k < n * n; k++) matrix[k] = q->matrix[k] - s->matrix[r][k];
        for (size_t k = 0; k < n; k++) right[k] = q->right[k] - s->right[r][k];
        if (!solve(q, &all, matrix, right, &intensity, &error)) return HUGE_VAL;
        squares += (intensity - found->intensity) * (intensity - found->intensity);
        voices++;
    }
    return sqrt(squares * (voices - 1) / fmax(1, voices));
}

static igi_vec place(igi_vec low, igi_vec size, const int at[3])
{
    const float step = (float)(1 - 2 * MARGIN) / (STEPS - 1), first = (float)MARGIN;
    return (igi_vec){low.x + size.x * (first + step * (float)at[0]),
                     low.y + size.y * (first + step * (float)at[1]),
                     low.z + size.z * (first + step * (float)at[2])};
}

/* The best places of a grid by some of the sides, then the best of them by all, without shadows. */
static void look_roughly(search *q, igi_vec low, igi_vec size, bulb *best)
{
    bulb places[BEST + 1] = {{.sigmas = 0}};
    for (int i = 0; i < STEPS * STEPS * STEPS; i++) {
        const int at[3] = {i % STEPS, i / STEPS % STEPS, i / STEPS / STEPS};
        int k = BEST;
        (void)try_place(q, place(low, size, at), FIRST, false, &places[k]);
        for (; k > 0 && places[k].sigmas > places[k - 1].sigmas; k--) {
            bulb better = places[k];
            places[k] = places[k - 1];
            places[k - 1] = better;
        }
    }
    *best = (bulb){.sigmas = 0};
    for (int k = 0; k < BEST; k++)
        if (places[k].sigmas > 0 && try_place(q, places[k].at, 1, false, &places[k]) > best->sigmas)
            *best = places[k];
}

/* About the best of a grid with shadows, ever nearer. */
static void look_everywhere(search *q, bulb *best)
{
    bulb found;
    igi_box room = igi_box_empty();
    for (size_t i = 0; i < q->s->count; i++) igi_box_add(&room, q->s->looks[i].point);
    igi_vec low = room.low, size = igi_box_sides(&room);
    double side = NEAREST * (double)igi_length(size);
    q->nearest2 = side * side;
    look_roughly(q, low, size, best);
    if (best->sigmas < BY_CHANCE) return;
    float step = (float)(1 - 2 * MARGIN) / (STEPS - 1);
    (void)try_place(q, best->at, 1, true, best);
    for (int round = 0; round < ROUNDS; round++, step /= 2) {
        igi_vec middle = best->at;
        for (int i = 0; i < 6; i++) {
            float by = i & 1 ? step : -step;
            igi_vec at = middle;
            if (i / 2 == 0) at.x += by * size.x;
            if (i / 2 == 1) at.y += by * size.y;
            if (i / 2 == 2) at.z += by * size.z;
            if (try_place(q, at, 1, true, &found) > best->sigmas) *best = found;
        }
    }
    (void)try_place(q, best->at, 1, true, best); /* the sums that go with it */
}

static igi_status say(igi_context *ctx, const bulb *b, double error, double share, igi_materials *m)
{
    char *sentence;
    IGI_TRY(igi_strprintf(
        ctx, &sentence,
        "the surfaces are as bright as if a light that is not listed hung near (%.1f, %.1f, %.1f), "
        "with some %.2g +- %.1g of intensity (%.1f %% of the light): list it, without its power to "
        "have it solved; or a light's place or kind is wrong, or the mesh is, or something shines "
        "there",
        (double)b->at.x, (double)b->at.y, (double)b->at.z, b->intensity, error, 100 * share));
    return igi_doubt_say(ctx, m, sentence);
}

static void widen(const search *q, double sure, double usual, double *off)
{
    for (size_t r = 0; r < q->s->regions; r++) {
        const terms *t = &q->regions[r];
        double share = t->sides > 0 ? t->plain / t->sides : usual;
        off[r] = hypot(off[r], sure * share);
    }
}

igi_status igi_doubt_missing(igi_context *ctx, const igi_light_shares *s, igi_materials *m,
                             double *off)
{
    search q = {.s = s};
    bulb found;
    double plain = 0, sides = 0;
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &q.regions));
    for (size_t r = 0; r < s->regions; r++) {
        for (size_t k = 0; k < LIGHTS * LIGHTS; k++) q.matrix[k] += s->matrix[r][k];
        for (size_t k = 0; k < LIGHTS; k++) q.right[k] += s->right[r][k];
    }
    igi_status status = IGI_OK;
    look_everywhere(&q, &found);
    igi_count_rays(ctx, q.rays);
    if (found.sigmas < BY_CHANCE) goto cleanup;
    double error = jackknife(&q, &found), chance = BY_CHANCE * found.error;
    for (size_t r = 0; r < s->regions; r++) {
        plain += q.regions[r].plain;
        sides += q.regions[r].sides;
    }
    double share = plain / fmax(1, sides);
    if (found.sigmas > SURE && found.intensity > SURE_REGIONS * error &&
        found.intensity * share > WORTH_A_WORD)
        IGI_TRY_GOTO(say(ctx, &found, hypot(error, found.error), found.intensity * share, m));
    double sure = igi_doubt_sure(found.intensity, error);
    widen(&q, sqrt(fmax(0, sure * sure - chance * chance)), share, off);
cleanup:
    igi_free(q.regions);
    return status;
}
