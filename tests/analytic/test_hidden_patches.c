/* SPDX-License-Identifier: Apache-2.0
 *
 * What the methods make of a white room of which a piece is hidden. The room is a unit cube with a
 * point light; its radiances come from the radiosity system with closed-form factors, which they
 * satisfy exactly in the mean of every element; the "photographs" are points strewn over the walls.
 */
#include "test.h"

#include "base/rng.h"
#include "diffuse/methods.h"
#include "rooms.h"
#include "transport/form_factor.h"
#include "transport/radiosity.h"

#define REGIONS 6
#define BANDS 2

typedef struct world {
    igi_context *ctx;
    room *room;
    igi_scene scene;
    igi_region regions[REGIONS];
    igi_light light;
    double truth[REGIONS][BANDS];
    igi_tracer *tracer;
    igi_elements *elements;
    double *radiosity[BANDS]; /* [elements] */
    igi_observations observations;
    igi_patches *patches;
    igi_recover_options options;
    igi_problem *problem;
    igi_diffuse *diffuse;
} world;

static double *doubles(size_t n)
{
    double *p = calloc(n, sizeof *p);
    if (!p) abort();
    return p;
}

/* Mean irradiance of an element by a point light of intensity 1. */
static double light_on(const igi_facet *f, const double *at)
{
    double sum = 0;
    enum { GRID = 40 };
    for (int k = 0; k < GRID * GRID; k++) {
        double p[3], d2 = 0, cosine = 0;
        igi_facet_point(f, (k % GRID + .5) / GRID, (k / GRID + .5) / GRID, 0, p);
        for (int c = 0; c < 3; c++) {
            d2 += (at[c] - p[c]) * (at[c] - p[c]);
            cosine += (at[c] - p[c]) * f->normal[c];
        }
        sum += fmax(0, cosine) / (d2 * sqrt(d2)) / (GRID * GRID);
    }
    return sum;
}

static void solve_forward(world *w)
{
    igi_factor_options o;
    igi_factor_options_init(&o, IGI_FACTOR_CLOSED);
    CHECK_OK(w->ctx, igi_elements_create(w->ctx, &w->room->mesh, .19, 4000, false, &w->elements));
    size_t n = w->elements->count;
    double *f = doubles(n * n), *areas = doubles(n), *albedo = doubles(n), *sent = doubles(n);
    CHECK_OK(w->ctx, igi_form_factors(w->ctx, w->elements, w->tracer, &o, f));
    for (int b = 0; b < BANDS; b++) {
        for (size_t i = 0; i < n; i++) {
            areas[i] = w->elements->elements[i].area;
            albedo[i] = w->truth[w->elements->elements[i].region][b];
            sent[i] = albedo[i] * w->light.value[b] *
                      light_on(&w->elements->facets[w->elements->elements[i].first_facet],
                               w->light.position);
        }
        w->radiosity[b] = doubles(n);
        igi_radiosity_system s = {n, f, areas, albedo, sent, 0};
        CHECK_OK(w->ctx, igi_radiosity_solve(w->ctx, &s, IGI_RADIOSITY_LU, w->radiosity[b]));
    }
    free(f);
    free(areas);
    free(albedo);
    free(sent);
}

/* Is the element part of the hidden piece? On the floor, x < share. */
static bool hidden(const world *w, uint32_t e, double share)
{
    const igi_element *element = &w->elements->elements[e];
    return element->region == 0 && element->centre[0] < share;
}

static void photograph(world *w, size_t count, double hidden_share, double noise)
{
    igi_observations *o = &w->observations;
    igi_rng rng = igi_rng_make(11, 1);
    *o = (igi_observations){.bands = BANDS, .frame_count = 1};
    o->frame_begin = calloc(2, sizeof *o->frame_begin);
    o->surface = calloc(count, sizeof *o->surface);
    o->uv = calloc(2 * count, sizeof *o->uv);
    o->pixel = calloc(count, sizeof *o->pixel);
    o->radiance = calloc(BANDS * count, sizeof *o->radiance);
    for (size_t k = 0; k < count; k++) {
        uint32_t t = igi_rng_next(&rng) % (uint32_t)w->room->mesh.triangle_count;
        float u = igi_rng_float(&rng), v = igi_rng_float(&rng);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        uint32_t e = igi_elements_at(w->elements, t, u, v, false);
        if (hidden(w, e, hidden_share)) continue;
        size_t i = o->count++;
        o->surface[i] = t << 1;
        o->uv[2 * i] = u;
        o->uv[2 * i + 1] = v;
        for (size_t b = 0; b < BANDS; b++) {
            double error = 0; /* of variance 1, near enough normal */
            for (int s = 0; s < 12; s++) error += (double)igi_rng_float(&rng);
            o->radiance[i * BANDS + b] = (float)(w->radiosity[b][e] / IGI_PI *
                                                 (1 + noise * (error - 6)));
        }
    }
    o->frame_begin[1] = o->count;
}

/* Of the cube's 12 triangles, the first ones stand: with 12 it is closed. */
static world *begin_open(size_t triangles, double albedo, size_t observations, double hidden_share,
                         double noise, int threads)
{
    static char names[REGIONS][8] = {"floor", "ceiling", "west", "east", "south", "north"};
    world *w = calloc(1, sizeof *w);
    if (!w) abort();
    w->ctx = test_context(threads);
    w->room = room_new();
    room_cube(w->room, 1, 1);
    w->room->mesh.triangle_count = triangles;
    for (int r = 0; r < REGIONS; r++) {
        w->regions[r] = (igi_region){.name = names[r], .textured = IGI_AUTO};
        w->truth[r][0] = albedo;
        w->truth[r][1] = albedo * (.8 + .04 * r);
    }
    w->light = (igi_light){.type = IGI_LIGHT_POINT,
                           .region = -1,
                           .position = {.4, .55, .7},
                           .known = true,
                           .value = {1, 2}};
    w->scene = (igi_scene){.name = names[0],
                           .bands = BANDS,
                           .mesh = w->room->mesh,
                           .region_count = REGIONS,
                           .regions = w->regions,
                           .light_count = 1,
                           .lights = &w->light};
    CHECK_OK(w->ctx, igi_tracer_create(w->ctx, &w->scene.mesh, &w->tracer));
    solve_forward(w);
    photograph(w, observations, hidden_share, noise);
    CHECK_OK(w->ctx, igi_patches_create(w->ctx, &w->scene.mesh, .03f, &w->patches));
    igi_recover_options_init(&w->options);
    CHECK_OK(w->ctx, igi_problem_create(w->ctx, &w->scene, w->tracer, &w->observations, w->patches,
                                        &w->options, &w->problem));
    return w;
}

static world *begin(double albedo, size_t observations, double hidden_share, double noise,
                    int threads)
{
    return begin_open(12, albedo, observations, hidden_share, noise, threads);
}

static void end(world *w)
{
    igi_diffuse_destroy(w->diffuse);
    igi_problem_destroy(w->problem);
    igi_patches_destroy(w->patches);
    free(w->observations.frame_begin);
    free(w->observations.surface);
    free(w->observations.uv);
    free(w->observations.pixel);
    free(w->observations.radiance);
    for (int b = 0; b < BANDS; b++) free(w->radiosity[b]);
    igi_elements_destroy(w->elements);
    igi_tracer_destroy(w->tracer);
    igi_context_destroy(w->ctx);
    free(w->room);
    free(w);
}

static void run(world *w, igi_method_fn method)
{
    igi_diffuse_destroy(w->diffuse);
    CHECK_OK(w->ctx, igi_diffuse_create(w->ctx, w->problem, &w->diffuse));
    CHECK_OK(w->ctx, method(w->ctx, w->problem, w->diffuse));
}

static double mean_error(const world *w)
{
    double sum = 0;
    for (int r = 0; r < REGIONS; r++)
        for (int b = 0; b < BANDS; b++)
            sum += fabs(w->diffuse->albedo[r][b] / w->truth[r][b] - 1) / (REGIONS * BANDS);
    return sum;
}

/* Albedo .95, 10 % of all surface hidden in one piece: at most 1 % on what is seen. */
static void white_room_with_a_hidden_piece(void)
{
    world *w = begin(.95, 100000, .6, .03, 2);
    double hidden_area = 0;
    for (uint32_t e = 0; e < w->elements->count; e++)
        if (hidden(w, e, .6)) hidden_area += w->elements->elements[e].area / 6;
    CHECK_NEAR(hidden_area, .1, .02);
    run(w, igi_method_radiosity);
    printf("   radiosity: %.4f %%\n", 100 * mean_error(w));
    CHECK(mean_error(w) < .005);
    for (int r = 0; r < REGIONS; r++) CHECK(w->diffuse->determined[r]);
    run(w, igi_method_patches);
    printf("   patches: %.4f %%\n", 100 * mean_error(w));
    CHECK(mean_error(w) < .002);
    end(w);
}

/* The hidden piece has the radiance that it has in truth, not black. */
static void hidden_radiance_is_solved(void)
{
    world *w = begin(.8, 60000, .6, 0, 2);
    run(w, igi_method_radiosity);
    double got = 0, want = 0;
    for (uint32_t patch = 0; patch < w->patches->count; patch++) {
        if (!(w->patches->area[patch] > 0) || igi_problem_seen_count(w->problem, 2 * patch) > 0)
            continue;
        igi_rng rng = igi_rng_make(1, patch);
        uint32_t t;
        float u, v;
        igi_patch_sample(w->patches, patch, &rng, &t, &u, &v);
        double area = (double)w->patches->area[patch];
        got += area * (double)w->diffuse->radiance[2 * patch * BANDS];
        want += area * w->radiosity[0][igi_elements_at(w->elements, t, u, v, false)] / IGI_PI;
    }
    CHECK(want > 0);
    CHECK_NEAR(got / want, 1, .01);
    end(w);
}

/* Nobody sees the floor at all: it is guessed, and said to be; the others hold. */
static void a_region_nobody_sees(void)
{
    world *w = begin(.5, 60000, 2, 0, 2);
    run(w, igi_method_radiosity);
    CHECK(!w->diffuse->determined[0]);
    CHECK(w->diffuse->albedo_std[0][0] > .1);
    CHECK(w->diffuse->albedo[0][0] > .2 && w->diffuse->albedo[0][0] < .8);
    for (int r = 1; r < REGIONS; r++) CHECK_NEAR(w->diffuse->albedo[r][0], .5, .02);
    end(w);
}

/* One triangle in the void, and a room without walls: what there is, is found. */
static void open_rooms(void)
{
    for (size_t triangles = 1; triangles <= 4; triangles += 3) {
        world *w = begin_open(triangles, .5, 20000, 0, .01, 2);
        run(w, igi_method_radiosity);
        CHECK_NEAR(w->diffuse->albedo[0][0], .5, .005);
        CHECK(w->diffuse->determined[0] && !w->diffuse->determined[2]);
        CHECK(w->diffuse->determined[1] == (triangles == 4));
        if (triangles == 4) CHECK_NEAR(w->diffuse->albedo[1][0], .5, .005);
        end(w);
    }
}

static void nothing_seen(void)
{
    world *w = begin(.5, 0, 0, 0, 1);
    CHECK_OK(w->ctx, igi_diffuse_create(w->ctx, w->problem, &w->diffuse));
    CHECK(igi_method_radiosity(w->ctx, w->problem, w->diffuse) == IGI_E_NO_ANSWER);
    CHECK_CONTAINS(igi_context_message(w->ctx), "no photograph");
    end(w);
}

static void same_for_any_threads(void)
{
    world *one = begin(.6, 20000, .3, .03, 1), *seven = begin(.6, 20000, .3, .03, 7);
    run(one, igi_method_radiosity);
    run(seven, igi_method_radiosity);
    size_t bytes = REGIONS * sizeof *one->diffuse->albedo;
    CHECK(memcmp(one->diffuse->albedo, seven->diffuse->albedo, bytes) == 0);
    CHECK(memcmp(one->diffuse->albedo_std, seven->diffuse->albedo_std, bytes) == 0);
    bytes = 2 * one->patches->count * BANDS * sizeof(float);
    CHECK(memcmp(one->diffuse->radiance, seven->diffuse->radiance, bytes) == 0);
    end(one);
    end(seven);
}

/* Out of memory, wherever it strikes, is an answer and no crash. */
static void out_of_memory(void)
{
    world *w = begin(.5, 2000, .3, 0, 1);
    igi_status status = IGI_E_SYSTEM;
    long n = 0;
    for (; n < 200 && status == IGI_E_SYSTEM; n++) {
        igi_diffuse_destroy(w->diffuse);
        CHECK_OK(w->ctx, igi_diffuse_create(w->ctx, w->problem, &w->diffuse));
        igi_fail_allocation_after(w->ctx, n);
        status = igi_method_radiosity(w->ctx, w->problem, w->diffuse);
        igi_fail_allocation_after(w->ctx, -1);
    }
    CHECK(status == IGI_OK && n > 20);
    end(w);
}

TEST_MAIN({"white_room_with_a_hidden_piece", white_room_with_a_hidden_piece},
          {"hidden_radiance_is_solved", hidden_radiance_is_solved},
          {"a_region_nobody_sees", a_region_nobody_sees}, {"open_rooms", open_rooms},
          {"nothing_seen", nothing_seen}, {"same_for_any_threads", same_for_any_threads},
          {"out_of_memory", out_of_memory})
