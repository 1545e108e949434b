/* SPDX-License-Identifier: Apache-2.0
 *
 * "random": a spec that says only within what a room is drawn. The context's seed chooses one; it
 * becomes plain "materials", "shapes" and "lights", and the rest of the spec is read as ever.
 * Numbers are uniform in their range, those of materials and radiance in its logarithm.
 */
#include "base/rng.h"
#include "synth/random_ranges.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define TRIES 200   /* for a free place; what finds none is left out */
#define MARGIN 0.15 /* metres between things */

typedef struct draw {
    igi_context *ctx;
    igi_rng rng;
    random_ranges ranges;
    double size[3]; /* of the room */
    json_t *materials, *shapes, *lights, *panels;
} draw;

static double uniform(draw *d, double low, double high)
{
    return low + (high - low) * (double)igi_rng_float(&d->rng);
}

static double log_uniform(draw *d, const double range[2])
{
    return range[0] * pow(range[1] / range[0], uniform(d, 0, 1));
}

static int whole(draw *d, const double range[2])
{
    return (int)floor(uniform(d, range[0], range[1] + 1));
}

/* rho_d, rho_s, alpha; the lobe is neutral. */
static void draw_material(draw *d, double *albedo, double *specular, double *alpha)
{
    if (d->ranges.table) {
        const double *row = d->ranges.table[(size_t)uniform(d, 0, (double)d->ranges.rows)];
        memcpy(albedo, row, 3 * sizeof *albedo);
        *specular = (row[3] + row[4] + row[5]) / 3;
        *alpha = row[6];
        return;
    }
    double level = log_uniform(d, d->ranges.albedo);
    for (int b = 0; b < 3; b++) albedo[b] = level * uniform(d, 0.5, 1);
    *specular = fmin(log_uniform(d, d->ranges.specular), 1 - level);
    *alpha = log_uniform(d, d->ranges.alpha);
}

static json_t *draw_texture(draw *d, const double *albedo)
{
    static const char *const kinds[] = {"checker", "stripes", "noise"};
    double darker = uniform(d, 0.3, 0.8);
    const char *kind = kinds[(size_t)uniform(d, 0, 3)];
    int cells = 2 * (int)uniform(d, 1, 5), seed = (int)uniform(d, 0, 1e6);
    return json_pack("{ss s[[fff][fff]] si si si}", "kind", kind, "colours", albedo[0], albedo[1],
                     albedo[2], albedo[0] * darker, albedo[1] * darker, albedo[2] * darker, "cells",
                     cells, "size", 128, "seed", seed);
}

/* False: no memory. Every draw is made whatever comes of it, so that one range changes one thing. */
static bool add_material(draw *d, const char *name, bool may_have_texture)
{
    double albedo[3], specular, alpha;
    bool glossy = uniform(d, 0, 1) < d->ranges.glossy,
         textured = uniform(d, 0, 1) < d->ranges.textured;
    draw_material(d, albedo, &specular, &alpha);
    json_t *o = json_object(), *map = draw_texture(d, albedo);
    int bad = !o || !map;
    if (glossy && specular > 0) {
        bad |= json_object_set_new(o, "model", json_string("ward"));
        bad |= json_object_set_new(o, "specular", json_real(specular));
        bad |= json_object_set_new(o, "alpha", json_real(alpha));
    }
    if (textured && may_have_texture) bad |= json_object_set(o, "texture", map);
    else
        bad |= json_object_set_new(o, "albedo",
                                   json_pack("[fff]", albedo[0], albedo[1], albedo[2]));
    json_decref(map);
    bad |= json_object_set_new(d->materials, name, o);
    return !bad;
}

/* Is a disc free of the things drawn before? */
static bool is_free(double (*discs)[3], int count, const double disc[3])
{
    for (int i = 0; i < count; i++)
        if (hypot(disc[0] - discs[i][0], disc[1] - discs[i][1]) < disc[2] + discs[i][2] + MARGIN)
            return false;
    return true;
}

/* A disc of radius disc[2] somewhere in the room's plan. */
static bool find_place(draw *d, double (*discs)[3], int count, double radius)
{
    for (int i = 0; i < TRIES; i++) {
        double disc[3] = {0, 0, radius}, inset = radius + MARGIN;
        for (int k = 0; k < 2; k++) disc[k] = uniform(d, inset, d->size[k] - inset);
        if (2 * inset >= fmin(d->size[0], d->size[1]) || !is_free(discs, count, disc)) continue;
        memcpy(discs[count], disc, sizeof disc);
        return true;
    }
    return false;
}

static bool add_lamps(draw *d)
{
    double discs[RANDOM_MOST][3];
    int wanted = whole(d, d->ranges.lamps), count = 0, bad = 0;
    for (int i = 0; i < wanted; i++) {
        double x = uniform(d, d->ranges.lamp_size[0], d->ranges.lamp_size[1]) / 2,
               y = uniform(d, d->ranges.lamp_size[0], d->ranges.lamp_size[1]) / 2;
        double power = log_uniform(d, d->ranges.radiance), warm = uniform(d, 0.7, 1);
        if (!find_place(d, discs, count, hypot(x, y))) continue;
        const double *c = discs[count++];
        char name[24];
        snprintf(name, sizeof name, "lamp_%d", count);
        bad |= json_object_set_new(d->materials, name, json_pack("{sb}", "emitter", 1));
        bad |= json_array_append_new(d->panels,
                                     json_pack("{s[ff] s[ff] ss}", "from", c[0] - x, c[1] - y, "to",
                                               c[0] + x, c[1] + y, "material", name));
        bad |= json_array_append_new(d->lights, json_pack("{ss ss s[fff]}", "type", "area",
                                                          "region", name, "radiance", power,
                                                          power * (1 + warm) / 2, power * warm));
    }
    return !bad;
}

/* Boxes and, one time in four, spheres that stand on the floor. */
static bool add_furniture(draw *d)
{
    double discs[RANDOM_MOST][3];
    int wanted = whole(d, d->ranges.furniture), count = 0, bad = 0;
    for (int i = 0; i < wanted; i++) {
        bool round = uniform(d, 0, 1) < 0.25;
        double radius = uniform(d, 0.2, 0.45), x = uniform(d, 0.4, 1.1), y = uniform(d, 0.4, 1.1);
        double height = uniform(d, 0.3, 0.55 * d->size[2]), turn = uniform(d, 0, 90);
        if (!find_place(d, discs, count, round ? radius : hypot(x, y) / 2)) continue;
        const double *c = discs[count++];
        char name[24];
        snprintf(name, sizeof name, "%s_%d", round ? "ball" : "block", count);
        bad |= !add_material(d, name, !round);
        bad |= json_array_append_new(
            d->shapes,
            round ? json_pack("{ss s[fff] sf ss}", "type", "sphere", "centre", c[0], c[1], radius,
                              "radius", radius, "material", name)
                  : json_pack("{ss s[fff] s[fff] sf ss}", "type", "box", "at", c[0], c[1], 0.0,
                              "size", x, y, height, "turn_deg", turn, "material", name));
    }
    return !bad;
}

static bool add_room(draw *d)
{
    static const char *const sides[] = {"floor", "ceiling", "south", "north", "west", "east"};
    bool good = true;
    for (size_t i = 0; i < COUNT(sides); i++) good = good && add_material(d, sides[i], i != 1);
    if (!good || !add_lamps(d)) return false;
    json_t *room = json_pack("{ss s[fff] ss ss s[ssss] sO}", "type", "room", "size", d->size[0],
                             d->size[1], d->size[2], "floor", sides[0], "ceiling", sides[1],
                             "walls", sides[2], sides[3], sides[4], sides[5], "panels", d->panels);
    return json_array_append_new(d->shapes, room) == 0 && add_furniture(d);
}

static igi_status draw_room(draw *d, const igi_json *root)
{
    for (int k = 0; k < 3; k++) d->size[k] = uniform(d, d->ranges.low[k], d->ranges.high[k]);
    d->materials = json_object();
    d->shapes = json_array();
    d->lights = json_array();
    d->panels = json_array();
    bool good = d->materials && d->shapes && d->lights && d->panels && add_room(d) &&
                json_object_set(root->value, "materials", d->materials) == 0 &&
                json_object_set(root->value, "shapes", d->shapes) == 0 &&
                json_object_set(root->value, "lights", d->lights) == 0;
    json_decref(d->materials);
    json_decref(d->shapes);
    json_decref(d->lights);
    json_decref(d->panels);
    return good ? IGI_OK : igi_fail(d->ctx, IGI_E_SYSTEM, "random: no memory for a room");
}

igi_status random_expand(igi_context *ctx, const igi_json *root)
{
    static const char *const made[] = {"materials", "shapes", "lights", "bands"};
    igi_json at = igi_json_member(root, "random");
    if (!at.value) return IGI_OK;
    for (size_t i = 0; i < COUNT(made); i++) {
        igi_json other = igi_json_member(root, made[i]);
        if (other.value)
            return igi_json_fail(ctx, &other, "and \"random\" exclude each other; keep one");
    }
    draw d = {.ctx = ctx, .rng = igi_rng_make(igi_seed(ctx), 0x2a4d)};
    igi_status status = random_ranges_read(ctx, &at, &d.ranges);
    if (status == IGI_OK) status = draw_room(&d, root);
    igi_free(d.ranges.table);
    return status;
}
