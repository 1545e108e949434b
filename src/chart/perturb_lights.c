/* SPDX-License-Identifier: Apache-2.0
 *
 * Lights that are not as scene.json says.
 */
#include "chart/sweep.h"

#include <string.h>

/* Photographs and lights in another unit: nothing should change. */
static igi_status other_unit(igi_context *ctx, const chart_change *c, double severity,
                             chart_subject *s)
{
    (void)ctx;
    (void)c;
    size_t bands = (size_t)s->scene->bands;
    for (size_t l = 0; l < s->scene->light_count; l++)
        for (size_t b = 0; b < bands; b++) s->scene->lights[l].value[b] *= severity;
    for (size_t f = 0; f < s->scene->frame_count; f++) {
        igi_image *photo = s->photos[f];
        size_t pixels = (size_t)photo->width * (size_t)photo->height;
        for (size_t i = 0; i < pixels; i++)
            for (size_t b = 0; b < bands; b++)
                photo->samples[i * (bands + 1) + b] *= (float)severity;
    }
    return IGI_OK;
}

/* The stated power of every light of the type `way` is wrong by the factor `severity`. */
static igi_status power(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    bool lamps = strcmp(c->way, "area") == 0;
    size_t changed = 0;
    for (size_t l = 0; l < s->scene->light_count; l++) {
        igi_light *light = &s->scene->lights[l];
        if (!light->known || lamps != (light->type == IGI_LIGHT_AREA)) continue;
        for (int b = 0; b < s->scene->bands; b++) light->value[b] *= severity;
        changed++;
    }
    return changed ? IGI_OK : IGI_E_NO_ANSWER;
}

/* Light number `size` is not in the list; a lamp's region is then taken for a surface. */
static igi_status drop(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    (void)severity; /* it lies in the spec */
    igi_scene *scene = s->scene;
    size_t which = (size_t)c->size;
    if (which >= scene->light_count) return IGI_E_NO_ANSWER;
    igi_light *light = &scene->lights[which];
    if (light->region >= 0) scene->regions[light->region].emitter = false;
    igi_free(light->file);
    memmove(light, light + 1, (scene->light_count - which - 1) * sizeof *light);
    scene->light_count--;
    return IGI_OK;
}

/* Lights that have a place stand `severity` metres beside it. */
static igi_status move_light(igi_context *ctx, const chart_change *c, double severity,
                             chart_subject *s)
{
    (void)ctx;
    igi_rng rng = chart_stream(s, c->kind->name);
    size_t moved = 0;
    for (size_t l = 0; l < s->scene->light_count; l++) {
        igi_light *light = &s->scene->lights[l];
        if (light->type != IGI_LIGHT_POINT && light->type != IGI_LIGHT_SPOT) continue;
        double turn = 2 * IGI_PI * (double)igi_rng_float(&rng);
        light->position[0] += severity * cos(turn);
        light->position[1] += severity * sin(turn);
        moved++;
    }
    return moved ? IGI_OK : IGI_E_NO_ANSWER;
}

static double lamp_area(const igi_mesh *mesh, int region, double centre[3])
{
    double area = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if ((int)mesh->regions[t] != region) continue;
        igi_vec p = igi_triangle_point(mesh, t, 1 / 3.0f, 1 / 3.0f);
        double a = (double)igi_triangle_area(mesh, t);
        centre[0] += a * (double)p.x;
        centre[1] += a * (double)p.y;
        centre[2] += a * (double)p.z;
        area += a;
    }
    for (int k = 0; k < 3 && area > 0; k++) centre[k] /= area;
    return area;
}

/* `severity` of the first lamp's power is said to come from a point below its middle: a lamp of the
 * wrong kind. pi A L of a lamp into a half space is as bright straight ahead as a point of A L. */
static igi_status wrong_kind(igi_context *ctx, const chart_change *c, double severity,
                             chart_subject *s)
{
    igi_scene *scene = s->scene;
    size_t which = 0, count = scene->light_count;
    (void)c;
    while (which < count && scene->lights[which].type != IGI_LIGHT_AREA) which++;
    if (which == count) return IGI_E_NO_ANSWER;
    igi_light *grown = igi_grow(ctx, scene->lights, &count, count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    scene->lights = grown;
    igi_light *lamp = &grown[which], *point = &grown[scene->light_count];
    *point = (igi_light){.type = IGI_LIGHT_POINT, .region = -1, .known = true};
    double area = lamp_area(&scene->mesh, lamp->region, point->position);
    point->position[2] -= 0.05;
    for (int b = 0; b < scene->bands; b++) {
        point->value[b] = severity * area * lamp->value[b];
        lamp->value[b] *= 1 - severity;
    }
    scene->light_count++;
    return IGI_OK;
}

const chart_perturbation chart_perturb_lights[] = {
    {"other-unit", true, other_unit},  {"light-power", false, power},
    {"drop-light", false, drop},       {"move-light", false, move_light},
    {"light-kind", false, wrong_kind}, {NULL, false, NULL}};
