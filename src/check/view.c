/* SPDX-License-Identifier: Apache-2.0 */
#include "check/view.h"

#include "base/parallel.h"
#include "observe/visible.h"
#include "scene/camera.h"

#define OUTSIDE_RAYS 8
#define OPEN 0.5 /* of what seen surfaces face: then there is no outside; */
#define CLOSED 0.02
#define MARGIN 1.04f    /* around what a parallel view shows */
#define HALF_FIELD 0.7f /* tangent: 70 degrees across */
#define MOST_CUTS 16

igi_vec igi_survey_up(const igi_survey *s)
{
    double sum[3] = {0, 0, 0};
    int best = 2;
    for (size_t f = 0; f < s->scene->frame_count; f++)
        for (int k = 0; k < 3; k++) sum[k] += s->scene->frames[f].camera.camera_to_world[k][1];
    for (int k = 0; k < 3; k++)
        if (fabs(sum[k]) > 1.1 * fabs(sum[best])) best = k;
    float sign = sum[best] < 0 ? -1.0f : 1.0f;
    return igi_v(best == 0 ? sign : 0, best == 1 ? sign : 0, best == 2 ? sign : 0);
}

/* How many of some rays from this side leave the scene. */
static int escaping(const igi_survey *s, uint32_t side, int rays, igi_rng rng)
{
    uint32_t triangle;
    float u, v;
    int escaped = 0;
    for (int k = 0; k < rays; k++) {
        igi_patch_sample(s->patches, side >> 1, &rng, &triangle, &u, &v);
        igi_vec normal = igi_tracer_normal(s->tracer, triangle);
        if (side & 1) normal = igi_scale(normal, -1);
        float x = igi_rng_float(&rng), y = igi_rng_float(&rng);
        igi_hit hit = igi_trace_off(s->tracer, igi_triangle_point(&s->scene->mesh, triangle, u, v),
                                    normal, igi_cosine_direction(normal, x, y));
        escaped += hit.triangle == IGI_NO_HIT;
    }
    return escaped;
}

/* Share of what the photographed sides face that lies outside the mesh. */
static double openness(igi_context *ctx, const igi_survey *s)
{
    double seen = 0, open = 0;
    for (uint32_t side = 0; side < 2 * s->patches->count; side++) {
        if (s->patches->triangle[side >> 1] == IGI_NO_HIT || s->views[side] == 0) continue;
        double area = (double)s->patches->area[side >> 1];
        seen += area;
        open += area * escaping(s, side, 1, igi_rng_make(igi_seed(ctx) + 0x0be, side));
    }
    return seen > 0 ? open / seen : 0;
}

/* Of a closed room, sides that see out at all lie outside it; of one with a hole, those that see
 * nothing else. */
igi_status igi_survey_outside(igi_context *ctx, const igi_survey *s, bool **cut)
{
    double open = openness(ctx, s);
    int least = open > OPEN ? OUTSIDE_RAYS + 1 : open > CLOSED ? OUTSIDE_RAYS : 2;
    size_t sides = 2 * s->patches->count;
    IGI_TRY(IGI_ALLOC(ctx, sides, cut));
    for (uint32_t side = 0; side < sides; side++) {
        if (s->patches->triangle[side >> 1] == IGI_NO_HIT || s->views[side] > 0) continue;
        igi_rng rng = igi_rng_make(igi_seed(ctx) + 0x0c7, side);
        (*cut)[side] = escaping(s, side, OUTSIDE_RAYS, rng) >= least;
    }
    igi_count_rays(ctx, sides * OUTSIDE_RAYS);
    return IGI_OK;
}

void igi_view_of_camera(const igi_survey *s, const igi_camera *camera, int width, igi_view *view)
{
    *view = (igi_view){.survey = s, .width = width, .fine = 1, .camera = camera};
    view->height = (int)fmax(1, floor((double)width * camera->height / camera->width + .5));
}

/* Right and up for a direction of view, unit. */
static void stand(igi_view *view, igi_vec up)
{
    view->right = igi_cross(view->forward, up);
    if (igi_length(view->right) < 1e-3f)
        view->right = igi_cross(view->forward,
                                fabsf(up.y) > 0.5f ? igi_v(0, 0, -1) : igi_v(0, 1, 0));
    view->right = igi_normalize(view->right);
    view->up = igi_cross(view->right, view->forward);
}

void igi_view_from(const igi_survey *s, igi_vec eye, igi_vec target, int width, igi_view *view)
{
    *view = (igi_view){.survey = s, .width = width, .height = width * 3 / 4, .fine = 2, .eye = eye};
    view->forward = igi_normalize(igi_sub(target, eye));
    stand(view, igi_survey_up(s));
    view->right = igi_scale(view->right, HALF_FIELD);
    view->up = igi_scale(view->up, HALF_FIELD * 0.75f);
}

typedef struct extent {
    float low[3], high[3]; /* along right, up, forward */
} extent;

static void include(extent *e, const igi_view *view, igi_vec p)
{
    const float at[3] = {igi_dot(p, view->right), igi_dot(p, view->up), igi_dot(p, view->forward)};
    for (int k = 0; k < 3; k++) {
        e->low[k] = fminf(e->low[k], at[k]);
        e->high[k] = fmaxf(e->high[k], at[k]);
    }
}

void igi_view_outside(const igi_survey *s, igi_vec forward, int width, igi_view *view)
{
    const igi_mesh *mesh = &s->scene->mesh;
    extent e = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    *view = (igi_view){.survey = s, .fine = 2, .parallel = true, .forward = igi_normalize(forward)};
    stand(view, igi_survey_up(s));
    for (size_t f = 0; f < s->scene->frame_count; f++)
        include(&e, view, igi_camera_centre(&s->scene->frames[f].camera));
    for (uint32_t p = 0; p < s->patches->count; p++)
        if (s->views[2 * p] + s->views[2 * p + 1] > 0)
            for (int k = 0; k < 3; k++) {
                uint32_t corner = mesh->triangles[3 * (size_t)s->patches->triangle[p] + (size_t)k];
                include(&e, view, igi_v_of(mesh->positions + 3 * (size_t)corner));
            }
    float half[2], middle[2];
    for (int k = 0; k < 2; k++) {
        half[k] = fmaxf(1e-6f, MARGIN * (e.high[k] - e.low[k]) / 2);
        middle[k] = (e.high[k] + e.low[k]) / 2;
    }
    half[1] = fmaxf(half[1], half[0] / 3);
    half[0] = fmaxf(half[0], half[1] / 1.2f);
    view->width = width;
    view->height = (int)lrintf((float)width * half[1] / half[0]);
    float back = e.low[2] - igi_tracer_size(s->tracer, NULL, NULL);
    view->eye = igi_madd(igi_madd(igi_scale(view->right, middle[0]), view->up, middle[1]),
                         view->forward, back);
    view->right = igi_scale(view->right, half[0]);
    view->up = igi_scale(view->up, half[1]);
}

/* The ray through the image point (x,y), both 0..1 from the top left. */
static void ray_at(const igi_view *v, double x, double y, igi_vec *origin, igi_vec *direction)
{
    if (v->camera) {
        *origin = igi_camera_centre(v->camera);
        *direction = igi_camera_direction(v->camera, x * v->camera->width, y * v->camera->height);
        return;
    }
    igi_vec across = igi_add(igi_scale(v->right, (float)(2 * x - 1)),
                             igi_scale(v->up, (float)(1 - 2 * y)));
    *origin = v->parallel ? igi_add(v->eye, across) : v->eye;
    *direction = v->parallel ? v->forward : igi_normalize(igi_add(v->forward, across));
}

/* The first thing that is not cut away; its distance counts from the view's own origin. */
static igi_hit look_through(const igi_view *v, igi_vec origin, igi_vec direction, uint64_t *rays)
{
    igi_hit hit = {IGI_NO_HIT, 0, 0, 0, false};
    float walked = 0;
    for (int k = 0; k < MOST_CUTS; k++) {
        hit = igi_trace(v->survey->tracer, igi_madd(origin, direction, walked), direction);
        ++*rays;
        if (hit.triangle == IGI_NO_HIT) break;
        walked += hit.distance;
        hit.distance = walked;
        if (!v->cut ||
            !v->cut[igi_side_at(v->survey->patches, hit.triangle, hit.u, hit.v, hit.back)])
            break;
        hit.triangle = IGI_NO_HIT;
    }
    return hit;
}

static igi_status look_along_row(igi_context *ctx, void *user, size_t row, int worker)
{
    (void)worker;
    igi_view *v = user;
    int columns = v->width * v->fine, rows = v->height * v->fine;
    uint64_t rays = 0;
    for (int x = 0; x < columns; x++) {
        igi_vec origin, direction;
        ray_at(v, (x + .5) / columns, ((double)row + .5) / rows, &origin, &direction);
        v->hits[row * (size_t)columns + (size_t)x] = look_through(v, origin, direction, &rays);
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

static void draw_lines(igi_view *v)
{
    size_t columns = (size_t)(v->width * v->fine), rows = (size_t)(v->height * v->fine);
    igi_vec o[2], d[2];
    ray_at(v, .5, .5, &o[0], &d[0]);
    ray_at(v, .5 + 1.0 / (double)columns, .5, &o[1], &d[1]);
    float angle = igi_length(igi_sub(d[1], d[0])), step = igi_length(igi_sub(o[1], o[0]));
    for (size_t i = 0; i < columns * rows; i++) {
        const igi_hit *a = &v->hits[i];
        float spread = v->parallel ? step / fmaxf(a->distance, 1e-6f) : angle;
        for (int k = 0; k < 2; k++) {
            size_t other = i + (k ? columns : 1);
            bool last = k ? i + columns >= columns * rows : (i + 1) % columns == 0;
            if (!last && igi_visible_is_edge(v->survey->scene, v->survey->tracer, a,
                                             &v->hits[other], spread))
                v->lines[i] = true;
        }
    }
}

igi_status igi_view_look(igi_context *ctx, igi_view *v)
{
    size_t columns = (size_t)(v->width * v->fine), rows = (size_t)(v->height * v->fine);
    IGI_TRY(IGI_ALLOC(ctx, columns * rows, &v->hits));
    IGI_TRY(IGI_ALLOC(ctx, columns * rows, &v->lines));
    IGI_TRY(igi_parallel_for(ctx, rows, look_along_row, v));
    draw_lines(v);
    return IGI_OK;
}

void igi_view_clear(igi_view *v)
{
    igi_free(v->hits);
    igi_free(v->lines);
    v->hits = NULL;
    v->lines = NULL;
}

igi_vec igi_view_eye(const igi_view *v)
{
    return v->camera ? igi_camera_centre(v->camera) : v->eye;
}

const igi_hit *igi_view_hit(const igi_view *v, int x, int y)
{
    size_t fine = (size_t)v->fine;
    return &v->hits[((size_t)y * fine * (size_t)v->width + (size_t)x) * fine];
}

bool igi_view_project(const igi_view *v, igi_vec point, double *x, double *y)
{
    if (v->camera) {
        bool ahead = igi_camera_project(v->camera, point, x, y);
        *x *= (double)v->width / v->camera->width;
        *y *= (double)v->height / v->camera->height;
        return ahead;
    }
    igi_vec d = igi_sub(point, v->eye);
    float depth = v->parallel ? 1 : igi_dot(d, v->forward);
    float a = igi_dot(d, v->right) / igi_dot(v->right, v->right);
    float b = igi_dot(d, v->up) / igi_dot(v->up, v->up);
    *x = v->width * (double)(1 + a / depth) / 2;
    *y = v->height * (double)(1 - b / depth) / 2;
    return depth > 0;
}

/* Shaded by the angle of view, with edges: shapes are told from nothing else. */
static void colour_of(const igi_view *v, size_t i, igi_vec direction, const uint8_t *colours,
                      float rgb[3])
{
    static const float lamp[3] = {255, 238, 150};
    const igi_survey *s = v->survey;
    const igi_hit *hit = &v->hits[i];
    uint32_t side = igi_side_at(s->patches, hit->triangle, hit->u, hit->v, hit->back);
    bool shines = s->scene->regions[s->scene->mesh.regions[hit->triangle]].emitter;
    float facing = fabsf(igi_dot(direction, igi_tracer_normal(s->tracer, hit->triangle)));
    float shade = v->lines[i] ? 0.55f : shines ? 1 : 0.6f + 0.4f * facing;
    for (int c = 0; c < 3; c++)
        rgb[c] = shade * (shines ? lamp[c] : (float)colours[3 * side + (size_t)c]);
}

igi_status igi_view_paint(igi_context *ctx, const igi_view *v, const uint8_t *colours,
                          uint8_t **pixels)
{
    size_t fine = (size_t)v->fine, columns = (size_t)v->width * fine, n = fine * fine;
    IGI_TRY(IGI_ALLOC(ctx, 4 * (size_t)v->width * (size_t)v->height, pixels));
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            igi_vec origin, direction;
            float sum[4] = {0, 0, 0, 0}, rgb[3];
            uint8_t *out = *pixels + 4 * ((size_t)y * (size_t)v->width + (size_t)x);
            ray_at(v, (x + .5) / v->width, (y + .5) / v->height, &origin, &direction);
            for (size_t k = 0; k < n; k++) {
                size_t i = ((size_t)y * fine + k / fine) * columns + (size_t)x * fine + k % fine;
                if (v->hits[i].triangle == IGI_NO_HIT) continue;
                colour_of(v, i, direction, colours, rgb);
                for (int c = 0; c < 3; c++) sum[c] += rgb[c];
                sum[3]++;
            }
            for (int c = 0; c < 3 && sum[3] > 0; c++) out[c] = (uint8_t)(sum[c] / sum[3] + .5f);
            out[3] = (uint8_t)(255 * sum[3] / (float)n + .5f);
        }
    return IGI_OK;
}
