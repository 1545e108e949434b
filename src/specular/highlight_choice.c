/* SPDX-License-Identifier: Apache-2.0
 *
 * Pixels are kept at random with a probability that rises with their scores for each of four
 * roughnesses, and a third of them evenly, to pin the diffuse part. Where the region is textured, the
 * chosen pixels are points, and every photograph that shows such a point joins in.
 */
#include "specular/highlights_private.h"

#include "scene/camera.h"

typedef struct choice {
    const igi_problem *problem;
    const igi_highlight_scores *scores;
    const igi_highlight_options *options;
    igi_highlights *out;
    size_t capacity; /* of the arrays of `out` that grow */
} choice;

static igi_status add_pixel(igi_context *ctx, choice *j, size_t group, size_t observation)
{
    igi_highlights *h = j->out;
    size_t capacity = j->capacity;
    uint32_t *grown = igi_grow(ctx, h->group, &capacity, h->count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    h->group = grown;
    capacity = j->capacity;
    grown = igi_grow(ctx, h->observation, &capacity, h->count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    h->observation = grown;
    j->capacity = capacity;
    h->group[h->count] = (uint32_t)group;
    h->observation[h->count++] = (uint32_t)observation;
    return IGI_OK;
}

/* Every photograph's pixel at the point that an observation shows. */
static igi_status add_point(igi_context *ctx, choice *j, size_t observation)
{
    const igi_problem *p = j->problem;
    const igi_observations *o = p->observations;
    igi_pixel_view seed = igi_pixel_view_of(p, observation);
    size_t group = j->out->groups, before = j->out->count;
    for (size_t f = 0; f < o->frame_count; f++) {
        const igi_camera *camera = &p->scene->frames[f].camera;
        double x, y;
        if (!igi_camera_project(camera, seed.point, &x, &y)) continue;
        if (x < 0 || y < 0 || x >= camera->width || y >= camera->height) continue;
        uint32_t pixel = (uint32_t)y * (uint32_t)camera->width + (uint32_t)x;
        size_t at = igi_observation_at(o, f, pixel);
        if (at == SIZE_MAX) continue;
        igi_pixel_view v = igi_pixel_view_of(p, at);
        if (igi_observation_region(p, at) != j->scores->region) continue;
        float distance = igi_length(igi_sub(v.point, igi_camera_centre(camera)));
        float pixel_m = distance / (float)camera->fl_x / fmaxf(0.1f, igi_dot(v.out, v.normal));
        if (igi_length(igi_sub(v.point, seed.point)) > 1.5f * pixel_m) continue;
        if (igi_dot(v.normal, seed.normal) < 0.99f) continue;
        IGI_TRY(add_pixel(ctx, j, group, at));
    }
    if (j->out->count < before + 2) j->out->count = before; /* one cannot part albedo from lobe */
    else j->out->groups++;
    return IGI_OK;
}

igi_status igi_highlights_choose(igi_context *ctx, const igi_problem *problem,
                                 const igi_highlight_scores *scores,
                                 const igi_highlight_options *options, igi_highlights *out)
{
    choice c = {problem, scores, options, out, 0};
    double wanted = (double)options->pixels;
    size_t frames = problem->observations->frame_count;
    if (options->per_point) /* a third of the photographs show a point, about */
        wanted /= fmin(8, fmax(1, (double)frames / 3));
    for (size_t i = 0; i < scores->count; i++) {
        double keep = wanted / 3 / (double)scores->count;
        for (int a = 0; a < 4; a++)
            if (scores->sums[a] > 0)
                keep += wanted / 6 * (double)scores->score[i][a] / scores->sums[a];
        igi_rng rng = igi_rng_make(igi_seed(ctx) + scores->region, scores->observation[i]);
        if ((double)igi_rng_float(&rng) >= keep) continue;
        if (options->per_point) IGI_TRY(add_point(ctx, &c, scores->observation[i]));
        else IGI_TRY(add_pixel(ctx, &c, 0, scores->observation[i]));
    }
    if (!options->per_point) out->groups = 1;
    return IGI_OK;
}
