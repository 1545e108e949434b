/* SPDX-License-Identifier: Apache-2.0
 *
 * A highlight is where a surface mirrors a lamp toward a camera: rays say where, whatever the
 * photographs show there. What a photograph shows there counts only where its pixel can be used.
 */
#include "check/survey.h"

#include "scene/camera.h"

#include <math.h>

#define POINTS 250       /* of a region, about */
#define NEAR_COS 0.9976f /* 4 degrees from a lamp without size, */
#define CONE 0.1f        /* or six about the mirror's direction: a lobe has a width */
#define CONE_RAYS 7

igi_status igi_survey_coverage(igi_context *ctx, igi_survey *s)
{
    const igi_observations *o = s->observations;
    size_t sides = 2 * s->patches->count;
    uint32_t *last; /* the photograph that showed a side last, and one */
    IGI_TRY(IGI_ALLOC(ctx, sides, &s->views));
    IGI_TRY(IGI_ALLOC(ctx, sides, &s->cosine));
    IGI_TRY(IGI_ALLOC(ctx, sides, &last));
    for (size_t f = 0; f < o->frame_count; f++) {
        igi_vec eye = igi_camera_centre(&s->scene->frames[f].camera);
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++) {
            uint32_t t = igi_surface_triangle(o->surface[i]);
            float u = o->uv[2 * i], v = o->uv[2 * i + 1];
            uint32_t side = igi_side_at(s->patches, t, u, v, igi_surface_is_back(o->surface[i]));
            if (last[side] == f + 1) continue;
            last[side] = (uint32_t)f + 1;
            if (s->views[side] < UINT8_MAX) s->views[side]++;
            igi_vec way = igi_normalize(igi_sub(eye, igi_triangle_point(&s->scene->mesh, t, u, v)));
            float cosine = fabsf(igi_dot(way, igi_tracer_normal(s->tracer, t)));
            s->cosine[side] = fmaxf(s->cosine[side], cosine);
        }
    }
    igi_free(last);
    return IGI_OK;
}

static bool near_small_lamp(const igi_survey *s, size_t light, igi_vec point, igi_vec direction)
{
    igi_light_sample sample;
    switch (s->lights[light].type) {
    case IGI_LIGHT_AREA:
    case IGI_LIGHT_ENV:
    case IGI_LIGHT_AMBIENT: return false;
    default: break;
    }
    return igi_light_sample_toward(s->lighting, light, point, 0.5f, 0.5f, &sample) &&
           igi_dot(sample.direction, direction) > NEAR_COS &&
           !igi_light_hidden(s->tracer, point, &sample);
}

/* Does this direction, from this point, meet a lamp, or pass within a few degrees of one without
 * size? */
static bool meets_lamp(const igi_survey *s, igi_vec point, igi_vec direction)
{
    igi_vec x, y;
    igi_frame_of(direction, &x, &y);
    for (int k = 0; k < CONE_RAYS; k++) {
        float turn = 2.4f * (float)k, r = CONE * sqrtf((float)k / CONE_RAYS);
        igi_vec ray = igi_madd(igi_madd(direction, x, r * cosf(turn)), y, r * sinf(turn));
        igi_hit hit = igi_trace(s->tracer, point, igi_normalize(ray));
        if (hit.triangle != IGI_NO_HIT && !hit.back &&
            igi_lighting_of_triangle(s->lighting, hit.triangle) >= 0)
            return true;
    }
    for (size_t l = 0; l < s->scene->light_count; l++)
        if (near_small_lamp(s, l, point, direction)) return true;
    return false;
}

bool igi_survey_mirrors_lamp(const igi_survey *s, igi_vec eye, igi_vec point, igi_vec normal)
{
    igi_vec way = igi_normalize(igi_sub(eye, point));
    igi_vec start = igi_madd(point, normal, 2 * igi_tracer_epsilon(s->tracer));
    igi_vec out = igi_sub(igi_scale(normal, 2 * igi_dot(way, normal)), way);
    return meets_lamp(s, start, out);
}

/* One place before one camera. */
static void look_from(const igi_survey *s, size_t frame, igi_vec point, igi_vec normal,
                      igi_region_check *out)
{
    const igi_camera *camera = &s->scene->frames[frame].camera;
    igi_vec eye = igi_camera_centre(camera), way = igi_sub(eye, point);
    double x, y;
    float cosine = igi_dot(way, normal) / igi_length(way);
    if (cosine < 0) normal = igi_scale(normal, -1);
    igi_vec start = igi_madd(point, normal, 2 * igi_tracer_epsilon(s->tracer));
    if (!igi_camera_project(camera, point, &x, &y) || x < 0 || y < 0 || x >= camera->width ||
        y >= camera->height || igi_occluded(s->tracer, start, eye))
        return;
    double angle = acos(fmin(1, fabs((double)cosine))) * 180 / IGI_PI;
    out->angle_low_deg = isnan(out->angle_low_deg) ? angle : fmin(out->angle_low_deg, angle);
    out->angle_high_deg = isnan(out->angle_high_deg) ? angle : fmax(out->angle_high_deg, angle);
    if (!igi_survey_mirrors_lamp(s, eye, point, normal)) return;
    out->highlights_predicted++;
    uint32_t pixel = (uint32_t)y * (uint32_t)camera->width + (uint32_t)x;
    out->highlights_seen += igi_observation_at(s->observations, frame, pixel) != SIZE_MAX;
}

igi_status igi_survey_views(igi_context *ctx, const igi_survey *s, igi_check *check)
{
    size_t *patches;
    IGI_TRY(IGI_ALLOC(ctx, check->region_count, &patches));
    for (size_t r = 0; r < check->region_count; r++)
        check->regions[r].angle_low_deg = check->regions[r].angle_high_deg = (double)NAN;
    for (uint32_t p = 0; p < s->patches->count; p++)
        if (s->patches->triangle[p] != IGI_NO_HIT) patches[igi_patch_region(s->patches, p)]++;
    for (uint32_t p = 0; p < s->patches->count; p++) {
        if (s->patches->triangle[p] == IGI_NO_HIT) continue;
        uint32_t r = igi_patch_region(s->patches, p), triangle;
        igi_rng rng = igi_rng_make(igi_seed(ctx) + 0x71e5, p);
        if (check->regions[r].emitter || igi_rng_float(&rng) * (float)patches[r] > POINTS) continue;
        float u, v;
        igi_patch_sample(s->patches, p, &rng, &triangle, &u, &v);
        igi_vec point = igi_triangle_point(&s->scene->mesh, triangle, u, v);
        igi_vec normal = igi_tracer_normal(s->tracer, triangle);
        for (size_t f = 0; f < s->scene->frame_count; f++)
            look_from(s, f, point, normal, &check->regions[r]);
        igi_count_rays(ctx, s->scene->frame_count);
    }
    igi_free(patches);
    return IGI_OK;
}
