/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/highlight_scores.h"

#include "base/parallel.h"
#include "brdf/lobe_pairs.h"

#define LAMP_POINTS 4     /* places on each lamp that a score looks at */
#define SCORE_ALPHA 0.03f /* lobes are scored as broad at least: the lamp's points lie apart */
#define DARKEST 1e-6f     /* what a surface shows at least, of what it receives */
#define CANDIDATES_A_TASK 512

typedef struct job {
    const igi_highlight_source *source;
    const float *alphas;
    igi_highlight_scores *out;
} job;

/* Pairs of directions, and whose score each of them adds to. */
typedef struct batch {
    igi_lobe_pairs pairs;
    uint32_t owner[CANDIDATES_A_TASK * LAMP_POINTS];
    float weight[CANDIDATES_A_TASK * LAMP_POINTS];
} batch;

static float brightness(const double *value, int bands)
{
    double sum = 0;
    for (int b = 0; b < bands; b++) sum += value[b];
    return (float)(sum / bands);
}

/* The points of one lamp as a candidate sees them. */
static void add_lamp(const job *j, size_t light, size_t candidate, batch *to)
{
    const igi_radiance_field *f = j->source->field;
    const igi_problem *p = f->problem;
    const igi_rows *rows = j->source->rows;
    size_t observation = j->out->observation[candidate], bands = (size_t)p->bands;
    uint32_t side = igi_problem_side_of(p, observation), row = rows->row_of[side];
    if (row == IGI_NO_ROW) return;
    float received = rows->direct[row * rows->lights + light] *
                     brightness(p->lights[light].value, p->bands);
    if (received <= 0) return;
    igi_pixel_view v = igi_pixel_view_of(p, observation);
    igi_vec out = igi_to_local(v.out, v.normal);
    if (out.z <= 0.05f) return;
    float diffuse = DARKEST * received;
    for (size_t b = 0; b < bands; b++) diffuse += f->total[side * bands + b] / (float)p->bands;
    igi_light_sample samples[LAMP_POINTS];
    const float start[2] = {0.5f, 0.5f};
    size_t n = igi_light_sample_set(p->lighting, light, v.point, LAMP_POINTS, start, samples);
    for (size_t k = 0; k < n; k++) {
        igi_vec in = igi_to_local(samples[k].direction, v.normal);
        if (!(in.z > 0)) continue;
        to->owner[to->pairs.count] = (uint32_t)candidate;
        to->weight[to->pairs.count] = received / diffuse / (float)n;
        igi_lobe_pairs_add(&to->pairs, in, out);
    }
}

static igi_status score(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    igi_highlight_scores *o = j->out;
    igi_status status = IGI_OK;
    size_t first = task * CANDIDATES_A_TASK, end = first + CANDIDATES_A_TASK;
    if (end > o->count) end = o->count;
    batch *b;
    IGI_TRY(IGI_ALLOC(ctx, 1, &b));
    IGI_TRY_GOTO(igi_lobe_pairs_create(ctx, IGI_WARD, CANDIDATES_A_TASK * LAMP_POINTS, &b->pairs));
    for (size_t l = 0; l < j->source->rows->lights; l++) {
        b->pairs.count = 0;
        for (size_t i = first; i < end; i++) add_lamp(j, l, i, b);
        size_t count = b->pairs.count;
        igi_lobe_pairs_pad(&b->pairs);
        igi_lobe_pairs_prepare(&b->pairs);
        for (int a = 0; a < 4; a++) {
            igi_lobe_pairs_evaluate(&b->pairs, fmaxf(SCORE_ALPHA, j->alphas[a]), 0, b->pairs.count);
            for (size_t k = 0; k < count; k++)
                o->score[b->owner[k]][a] += b->pairs.values[k] * b->weight[k];
        }
    }
cleanup:
    igi_lobe_pairs_clear(&b->pairs);
    igi_free(b);
    return status;
}

igi_status igi_highlight_scores_create(igi_context *ctx, const igi_highlight_source *source,
                                       size_t region, size_t at_most, const float alphas[4],
                                       igi_highlight_scores *scores)
{
    const igi_candidates *c = source->candidates;
    size_t first = c->begin[region], total = c->begin[region + 1] - first;
    size_t stride = total / at_most + 1;
    igi_status status = IGI_OK;
    *scores = (igi_highlight_scores){.region = region};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, total / stride + 1, &scores->observation));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, total / stride + 1, &scores->score));
    for (size_t i = 0; i < total; i += stride)
        scores->observation[scores->count++] = c->observation[first + i];
    job j = {source, alphas, scores};
    size_t tasks = (scores->count + CANDIDATES_A_TASK - 1) / CANDIDATES_A_TASK;
    IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, score, &j));
    for (size_t i = 0; i < scores->count; i++)
        for (int a = 0; a < 4; a++) scores->sums[a] += (double)scores->score[i][a];
cleanup:
    if (status != IGI_OK) igi_highlight_scores_clear(scores);
    return status;
}

void igi_highlight_scores_clear(igi_highlight_scores *scores)
{
    igi_free(scores->observation);
    igi_free(scores->score);
    *scores = (igi_highlight_scores){.region = 0};
}
