/* SPDX-License-Identifier: Apache-2.0
 *
 * Each camera is traced at about forty pixels along its picture: a coarse pixel beside no edge
 * promises as many pixels as it covers. Averaging n x n pixels into one saves rays and memory, but
 * loses a strip of two such pixels along each edge. For each n photographs are taken greedily, the
 * one first that fills most of what is still needed, and the cheapest n wins.
 *
 * What is needed of a region: pixels enough for the target by their noise, and never so few that
 * they would count as scarce; and, where lobes are looked for, a share of the places that mirror a
 * lamp toward any camera. Where all photographs together have less, most of that is asked for.
 */
#include "recover/choice.h"

#include "light/light.h"
#include "observe/visible.h"
#include "scene/camera.h"

#include <string.h>

#define COARSE_PIXELS 40  /* along the longer side of a picture */
#define NOISE 0.25        /* of a pixel, four times what is usual */
#define FEWEST_PIXELS 250 /* of a region; observing calls fewer than 200 scarce */
#define MOST_SHARE 0.8    /* of what there is, where that is less than what is wanted */
#define FEWEST_SHINE 30   /* coarse pixels that mirror a lamp */
#define NEAR_MIRROR 0.97f /* the cosine of 14 degrees: a lobe has a width, a lamp as well */
#define UNCLEAN 0.25      /* of a coarse pixel beside an edge is clean, at full resolution */
#define READING 1.0       /* costs of a pixel: decoding it, */
#define OBSERVING 4.0     /* and all that follows, for one after averaging */

/* Of one region in one photograph. */
typedef struct tally {
    float clean, beside, unclean; /* coarse pixels two off any edge, one off, and at one */
    float shine;                  /* that mirror a lamp */
} tally;

typedef struct survey {
    const igi_scene *scene;
    const igi_tracer *tracer;
    const igi_need *need;
    igi_lighting *lighting; /* NULL: highlights do not count */
    int step;               /* pixels along a coarse one */
    size_t regions;
    bool *wanted;  /* [regions] */
    tally *views;  /* [frames][regions] */
    double *needs; /* [2 regions] of pixels, of shine */
    double *have;  /* [2 regions] */
} survey;

/* A way to take the photographs. */
typedef struct plan {
    int reduce;
    size_t count;
    bool *read;
    double cost;
} plan;

static igi_camera smaller(const igi_camera *camera, int n)
{
    igi_camera c = *camera;
    c.width = camera->width / n > 0 ? camera->width / n : 1;
    c.height = camera->height / n > 0 ? camera->height / n : 1;
    double x = (double)c.width / camera->width, y = (double)c.height / camera->height;
    c.fl_x *= x;
    c.cx *= x;
    c.fl_y *= y;
    c.cy *= y;
    return c;
}

/* Does the surface mirror a lamp, or nearly, toward the eye? */
static bool shines(const survey *s, const igi_hit *hit, igi_vec eye)
{
    igi_vec normal = igi_tracer_normal(s->tracer, hit->triangle);
    igi_vec point = igi_triangle_point(&s->scene->mesh, hit->triangle, hit->u, hit->v);
    if (hit->back) normal = igi_scale(normal, -1);
    igi_vec way = igi_normalize(igi_sub(eye, point));
    igi_vec mirrored = igi_madd(igi_scale(way, -1), normal, 2 * igi_dot(way, normal));
    point = igi_madd(point, normal, igi_tracer_epsilon(s->tracer));
    for (size_t l = 0; l < s->scene->light_count; l++)
        for (int k = 0; k < 4; k++) {
            igi_light_sample sample;
            float u = .25f + .5f * (float)(k & 1), v = .25f + .5f * (float)(k >> 1);
            if (igi_light_sample_toward(s->lighting, l, point, u, v, &sample) &&
                igi_dot(sample.direction, mirrored) > NEAR_MIRROR &&
                !igi_light_hidden(s->tracer, point, &sample))
                return true;
        }
    return false;
}

static igi_status look(igi_context *ctx, const survey *s, size_t frame)
{
    igi_visible v;
    igi_camera camera = smaller(&s->scene->frames[frame].camera, s->step);
    igi_vec eye = igi_camera_centre(&camera);
    IGI_TRY(igi_visible_create(ctx, s->scene, s->tracer, &camera, &v));
    for (size_t i = 0; i < (size_t)v.width * (size_t)v.height; i++) {
        if (v.hits[i].triangle == IGI_NO_HIT) continue;
        uint32_t r = s->scene->mesh.regions[v.hits[i].triangle];
        tally *t = &s->views[frame * s->regions + r];
        if (!s->wanted[r]) continue;
        if (v.near_edge[i] == 0) t->clean++;
        else if (v.near_edge[i] == 1) t->beside++;
        else t->unclean++;
        if (s->lighting && v.near_edge[i] <= 1) t->shine += shines(s, &v.hits[i], eye);
    }
    igi_visible_clear(&v);
    return IGI_OK;
}

/* Pixels of a region in a photograph that was reduced n times. */
static double pixels_of(const survey *s, const tally *t, int n)
{
    double cells = (double)t->clean;
    if (4 * n <= s->step || n == 1) cells += (double)t->beside;
    if (n == 1) cells += UNCLEAN * (double)t->unclean;
    return cells * s->step * s->step / (n * n);
}

static double amount(const survey *s, size_t frame, size_t what, int n)
{
    const tally *t = &s->views[frame * s->regions + what / 2];
    return what & 1 ? (double)t->shine : pixels_of(s, t, n);
}

/* false: such coarse pixels lose a region. */
static bool set_needs(survey *s, int n)
{
    double noise = NOISE / s->need->target_error / n;
    double wanted = s->need->sharpness * fmax(FEWEST_PIXELS, noise * noise);
    for (size_t k = 0; k < 2 * s->regions; k++) {
        double all = 0;
        for (size_t f = 0; f < s->scene->frame_count; f++) all += amount(s, f, k, n);
        s->have[k] = s->needs[k] = 0;
        if (!s->wanted[k / 2]) continue;
        s->needs[k] = fmin(k & 1 ? FEWEST_SHINE * s->need->sharpness : wanted, MOST_SHARE * all);
        if (n > 1 && !(k & 1) && all < wanted) return false;
    }
    return true;
}

static double gain_of(const survey *s, size_t frame, int n)
{
    double gain = 0;
    for (size_t k = 0; k < 2 * s->regions; k++) {
        double lacks = s->needs[k] - s->have[k];
        if (lacks > 0) gain += fmin(lacks, amount(s, frame, k, n)) / s->needs[k];
    }
    return gain;
}

static void choose(const survey *s, plan *p)
{
    const igi_scene *scene = s->scene;
    p->count = 0;
    p->cost = 0;
    memset(p->read, 0, scene->frame_count * sizeof *p->read);
    for (;;) {
        size_t best = scene->frame_count;
        double most = 1e-9;
        for (size_t f = 0; f < scene->frame_count; f++) {
            double gain = p->read[f] ? 0 : gain_of(s, f, p->reduce);
            if (!(gain > most)) continue;
            most = gain;
            best = f;
        }
        if (best == scene->frame_count) return;
        const igi_camera *c = &scene->frames[best].camera;
        for (size_t k = 0; k < 2 * s->regions; k++) s->have[k] += amount(s, best, k, p->reduce);
        p->read[best] = true;
        p->count++;
        p->cost += (double)c->width * c->height * (READING + OBSERVING / (p->reduce * p->reduce));
    }
}

/* Emitters are seen for nothing but the value of lamps that nobody gave. */
static void find_wanted(survey *s)
{
    const igi_scene *scene = s->scene;
    for (size_t r = 0; r < s->regions; r++) s->wanted[r] = !scene->regions[r].emitter;
    for (size_t l = 0; l < scene->light_count; l++)
        if (scene->lights[l].region >= 0 && !scene->lights[l].known)
            s->wanted[scene->lights[l].region] = true;
    for (size_t r = 0; r < s->regions; r++) { /* what no camera sees is nothing to ask for */
        double seen = 0;
        for (size_t f = 0; f < scene->frame_count; f++) {
            const tally *t = &s->views[f * s->regions + r];
            seen += (double)(t->clean + t->beside + t->unclean);
        }
        s->wanted[r] &= seen > 0;
    }
}

static igi_status take_part(igi_context *ctx, const igi_scene *whole, const plan *p,
                            igi_choice *choice)
{
    choice->scene = *whole;
    choice->scene.frames = NULL;
    choice->scene.frame_count = p->count;
    choice->reduce = p->reduce;
    choice->left_out = whole->frame_count - p->count;
    IGI_TRY(IGI_ALLOC(ctx, p->count, &choice->scene.frames));
    for (size_t f = 0, k = 0; f < whole->frame_count; f++) {
        if (!p->read[f]) continue;
        igi_frame *frame = &choice->scene.frames[k++];
        *frame = whole->frames[f];
        if (p->reduce == 1) continue;
        frame->taken = &whole->frames[f].camera;
        frame->camera = smaller(frame->taken, p->reduce);
    }
    return IGI_OK;
}

static igi_status survey_all(igi_context *ctx, survey *s)
{
    const igi_scene *scene = s->scene;
    int widest = 1;
    for (size_t f = 0; f < scene->frame_count; f++) {
        const igi_camera *c = &scene->frames[f].camera;
        int side = c->width > c->height ? c->width : c->height;
        widest = side > widest ? side : widest;
    }
    s->step = widest > COARSE_PIXELS ? widest / COARSE_PIXELS : 1;
    for (size_t r = 0; r < s->regions; r++) s->wanted[r] = true;
    if (s->need->highlights)
        IGI_TRY(igi_lighting_create(ctx, scene, scene->lights, scene->light_count, &s->lighting));
    for (size_t f = 0; f < scene->frame_count; f++) IGI_TRY(look(ctx, s, f));
    find_wanted(s);
    return IGI_OK;
}

igi_status igi_choice_make(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                           const igi_need *need, igi_choice **choice)
{
    igi_status status = IGI_OK;
    igi_choice *c = NULL;
    survey s = {.scene = scene, .tracer = tracer, .need = need, .regions = scene->region_count};
    plan now = {.reduce = 1}, best = {.reduce = 0};
    *choice = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &c));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.regions, &s.wanted));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.regions * scene->frame_count, &s.views));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * s.regions, &s.needs));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * s.regions, &s.have));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &now.read));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &c->read));
    best.read = c->read;
    IGI_TRY_GOTO(survey_all(ctx, &s));
    for (now.reduce = 1; 2 * now.reduce <= s.step || now.reduce == 1; now.reduce *= 2) {
        if (!set_needs(&s, now.reduce)) break;
        choose(&s, &now);
        if (best.reduce && now.cost >= best.cost) continue;
        memcpy(best.read, now.read, scene->frame_count * sizeof *now.read);
        best.reduce = now.reduce;
        best.count = now.count;
        best.cost = now.cost;
    }
    IGI_TRY_GOTO(take_part(ctx, scene, &best, c));
    *choice = c;
    c = NULL;
cleanup:
    igi_free(s.wanted);
    igi_free(s.views);
    igi_free(s.needs);
    igi_free(s.have);
    igi_free(now.read);
    igi_lighting_destroy(s.lighting);
    igi_choice_destroy(c);
    return status;
}

void igi_choice_destroy(igi_choice *choice)
{
    if (!choice) return;
    igi_free(choice->scene.frames);
    igi_free(choice->read);
    igi_free(choice);
}

igi_status igi_choice_sentence(igi_context *ctx, const igi_choice *choice, const igi_scene *whole,
                               char **sentence)
{
    igi_status status = IGI_OK;
    char *names = NULL, *pixels = NULL, *longer;
    for (size_t f = 0; f < choice->scene.frame_count; f++) {
        IGI_TRY_GOTO(igi_strprintf(ctx, &longer, "%s%s%s", names ? names : "", names ? ", " : "",
                                   choice->scene.frames[f].name));
        igi_free(names);
        names = longer;
    }
    if (choice->reduce > 1)
        IGI_TRY_GOTO(igi_strprintf(ctx, &pixels, ", %d x %d pixels averaged into one",
                                   choice->reduce, choice->reduce));
    IGI_TRY_GOTO(igi_strprintf(
        ctx, sentence,
        "%zu of %zu photographs were read (%s)%s: by rays from the cameras they show every region "
        "well enough for the error that was asked for; without --target-error all are",
        choice->scene.frame_count, whole->frame_count, names ? names : "", pixels ? pixels : ""));
cleanup:
    igi_free(names);
    igi_free(pixels);
    return status;
}
