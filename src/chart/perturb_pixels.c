/* SPDX-License-Identifier: Apache-2.0
 *
 * What no photograph shows: surfaces, angles and highlights taken out of all of them, in the way in
 * which merging marks saturated pixels.
 */
#include "chart/sweep.h"

#include "scene/camera.h"

#include <string.h>

typedef struct mask_job {
    const chart_change *change;
    double severity;
    const chart_subject *subject;
    igi_tracer *tracer;
    igi_vec corner; /* "piece": the hidden points are those nearest to it */
    float reach;
    uint64_t key;
} mask_job;

/* Is the point that the pixel shows to be hidden? `toward` the camera, unit. */
typedef bool (*hidden_fn)(const mask_job *job, const igi_hit *hit, igi_vec point, igi_vec toward);

static void mask_frame(const mask_job *j, size_t frame, hidden_fn hidden)
{
    const igi_camera *camera = &j->subject->scene->frames[frame].camera;
    igi_image *photo = j->subject->photos[frame];
    igi_vec centre = igi_camera_centre(camera);
    for (int y = 0; y < photo->height; y++)
        for (int x = 0; x < photo->width; x++) {
            igi_vec d = igi_camera_direction(camera, x + .5, y + .5);
            igi_hit hit = igi_trace(j->tracer, centre, d);
            if (hit.triangle == IGI_NO_HIT) continue;
            igi_vec point = igi_madd(centre, d, hit.distance);
            size_t pixel = (size_t)(y * photo->width + x) * (size_t)photo->channels;
            if (hidden(j, &hit, point, igi_scale(d, -1)))
                photo->samples[pixel + (size_t)photo->channels - 1] = 1;
        }
}

static igi_status mask(igi_context *ctx, mask_job *j, hidden_fn hidden)
{
    IGI_TRY(igi_tracer_create(ctx, &j->subject->scene->mesh, &j->tracer));
    for (size_t f = 0; f < j->subject->scene->frame_count; f++) mask_frame(j, f, hidden);
    igi_tracer_destroy(j->tracer);
    return IGI_OK;
}

static bool is_emitter(const mask_job *j, const igi_hit *hit)
{
    const igi_scene *scene = j->subject->scene;
    return scene->regions[scene->mesh.regions[hit->triangle]].emitter;
}

/* A hash of the cell of a grid that the point lies in. */
static bool scattered(const mask_job *j, const igi_hit *hit, igi_vec p, igi_vec toward)
{
    (void)toward;
    float size = j->change->size > 0 ? (float)j->change->size : 0.3f;
    igi_vec n = igi_tracer_normal(j->tracer, hit->triangle);
    uint64_t key = j->key;
    /* A hair off the surface, or walls on the grid's planes would flicker between cells. */
    const float at[3] = {p.x + .01f * n.x, p.y + .01f * n.y, p.z + .01f * n.z};
    for (int k = 0; k < 3; k++) key = igi_hash64(key ^ (uint64_t)(int64_t)floorf(at[k] / size));
    return !is_emitter(j, hit) && (double)(key >> 11) * 0x1p-53 < j->severity;
}

static bool in_piece(const mask_job *j, const igi_hit *hit, igi_vec p, igi_vec toward)
{
    (void)toward;
    return !is_emitter(j, hit) && igi_length(igi_sub(p, j->corner)) < j->reach;
}

/* The distance from the corner within which `share` of the surface lies, to a per cent or so. */
static float reach_of(const igi_mesh *mesh, igi_vec corner, double share, float largest)
{
    enum { POINTS = 64 };
    float low = 0, high = largest;
    for (int step = 0; step < 20; step++) {
        float middle = (low + high) / 2;
        double inside = 0, all = 0;
        for (uint32_t t = 0; t < mesh->triangle_count; t++)
            for (int i = 0; i < POINTS; i++) {
                /* The plastic-number sequence over the triangle (Roberts 2018). */
                double a = fmod(.5 + 0.7548776662466927 * i, 1),
                       b = fmod(.5 + 0.5698402909980532 * i, 1);
                float root = sqrtf((float)a), v = (float)b;
                igi_vec p = igi_triangle_point(mesh, t, root * (1 - v), root * v);
                double area = (double)igi_triangle_area(mesh, t);
                all += area;
                if (igi_length(igi_sub(p, corner)) < middle) inside += area;
            }
        if (inside < share * all) low = middle;
        else high = middle;
    }
    return low;
}

/* `severity` of the surface in no photograph: "piece", about a lower corner of the room; else
 * scattered in cells of `size` metres. */
static igi_status hide(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    mask_job j = {.change = c, .severity = severity, .subject = s};
    igi_rng rng = chart_stream(s, "hide");
    j.key = (uint64_t)igi_rng_next(&rng) << 32 | igi_rng_next(&rng);
    if (severity <= 0) return IGI_OK;
    if (strcmp(c->way, "piece") != 0) return mask(ctx, &j, scattered);
    igi_vec low, high;
    IGI_TRY(igi_tracer_create(ctx, &s->scene->mesh, &j.tracer));
    float size = igi_tracer_size(j.tracer, &low, &high);
    igi_tracer_destroy(j.tracer);
    uint32_t which = igi_rng_next(&rng);
    j.corner = igi_v(which & 1 ? high.x : low.x, which & 2 ? high.y : low.y, low.z);
    j.reach = reach_of(&s->scene->mesh, j.corner, severity, size);
    return mask(ctx, &j, in_piece);
}

static bool seen_steeply(const mask_job *j, const igi_hit *hit, igi_vec p, igi_vec toward)
{
    (void)p;
    float cosine = fabsf(igi_dot(toward, igi_tracer_normal(j->tracer, hit->triangle)));
    return !is_emitter(j, hit) && (double)acosf(fminf(1, cosine)) * 180 / IGI_PI < j->severity;
}

/* Only what is seen under more than `severity` degrees from its normal. */
static igi_status graze(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    mask_job j = {.change = c, .severity = severity, .subject = s};
    return mask(ctx, &j, seen_steeply);
}

/* Does the mirror image of the way to the camera pass a lamp within `severity` degrees? */
static bool shows_lamp(const mask_job *j, const igi_hit *hit, igi_vec p, igi_vec toward)
{
    const igi_scene *scene = j->subject->scene;
    igi_vec n = igi_tracer_normal(j->tracer, hit->triangle);
    igi_vec mirror = igi_sub(igi_scale(n, 2 * igi_dot(n, toward)), toward);
    double least = cos(j->severity * IGI_PI / 180);
    if (is_emitter(j, hit)) return false;
    for (uint32_t t = 0; t < scene->mesh.triangle_count; t++) {
        if (!scene->regions[scene->mesh.regions[t]].emitter) continue;
        static const float corners[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1 / 3.0f, 1 / 3.0f}};
        for (int k = 0; k < 4; k++) {
            igi_vec at = igi_triangle_point(&scene->mesh, t, corners[k][0], corners[k][1]);
            igi_vec d = igi_normalize(igi_sub(at, p));
            if ((double)igi_dot(d, mirror) > least) return true;
        }
    }
    for (size_t l = 0; l < scene->light_count; l++) {
        if (scene->lights[l].type != IGI_LIGHT_POINT) continue;
        igi_vec d = igi_normalize(igi_sub(igi_v_ofd(scene->lights[l].position), p));
        if ((double)igi_dot(d, mirror) > least) return true;
    }
    return false;
}

static igi_status no_highlight(igi_context *ctx, const chart_change *c, double severity,
                               chart_subject *s)
{
    mask_job j = {.change = c, .severity = severity, .subject = s};
    return severity > 0 ? mask(ctx, &j, shows_lamp) : IGI_OK;
}

const chart_perturbation chart_perturb_pixels[] = {{"hide", true, hide},
                                                   {"graze", true, graze},
                                                   {"no-highlight", true, no_highlight},
                                                   {NULL, false, NULL}};
