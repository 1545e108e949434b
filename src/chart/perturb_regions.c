/* SPDX-License-Identifier: Apache-2.0
 *
 * Regions that are missing, joined to others, or fallen apart.
 */
#include "chart/sweep.h"

#include <string.h>

/* Drops a region that no triangle names any more. */
static void forget(igi_scene *scene, size_t region)
{
    igi_free(scene->regions[region].name);
    memmove(scene->regions + region, scene->regions + region + 1,
            (scene->region_count - region - 1) * sizeof *scene->regions);
    scene->region_count--;
    for (size_t t = 0; t < scene->mesh.triangle_count; t++)
        if (scene->mesh.regions[t] > region) scene->mesh.regions[t]--;
    for (size_t l = 0; l < scene->light_count; l++)
        if (scene->lights[l].region > (int)region) scene->lights[l].region--;
}

static void remove_triangles(igi_mesh *mesh, size_t region)
{
    size_t to = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (mesh->regions[t] == region) continue;
        memmove(mesh->triangles + 3 * to, mesh->triangles + 3 * t, 3 * sizeof *mesh->triangles);
        if (mesh->uvs) memmove(mesh->uvs + 6 * to, mesh->uvs + 6 * t, 6 * sizeof *mesh->uvs);
        mesh->regions[to++] = mesh->regions[t];
    }
    mesh->triangle_count = to;
}

/* The first `severity` of the named regions are not in the mesh. */
static igi_status missing(igi_context *ctx, const chart_change *c, double severity,
                          chart_subject *s)
{
    (void)ctx;
    size_t removed = 0;
    for (size_t k = 0; k < c->region_count && k < (size_t)(severity + .5); k++) {
        size_t region = chart_region(s->scene, c->regions[k]);
        if (region == s->scene->region_count) continue;
        chart_unjudge(s->truth, c->regions[k]);
        remove_triangles(&s->scene->mesh, region);
        forget(s->scene, region);
        removed++;
    }
    return removed || severity < 1 ? IGI_OK : IGI_E_NO_ANSWER;
}

/* Of the named regions, `severity` pairs of neighbours in the list are taken for one. Neither is
 * judged: what they do to the others is. */
static igi_status merge(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    size_t merged = 0;
    for (size_t k = 0; 2 * k + 1 < c->region_count && k < (size_t)(severity + .5); k++) {
        size_t into = chart_region(s->scene, c->regions[2 * k]),
               from = chart_region(s->scene, c->regions[2 * k + 1]);
        if (into == s->scene->region_count || from == s->scene->region_count) continue;
        for (size_t t = 0; t < s->scene->mesh.triangle_count; t++)
            if (s->scene->mesh.regions[t] == from) s->scene->mesh.regions[t] = (uint32_t)into;
        forget(s->scene, from);
        chart_unjudge(s->truth, c->regions[2 * k]);
        chart_unjudge(s->truth, c->regions[2 * k + 1]);
        merged++;
    }
    return merged || severity < 1 ? IGI_OK : IGI_E_NO_ANSWER;
}

/* A region of the scene, and its truth, of another name but otherwise as the given one. */
static igi_status add_part(igi_context *ctx, chart_subject *s, size_t region, size_t number)
{
    igi_scene *scene = s->scene;
    igi_materials *truth = s->truth;
    size_t capacity = scene->region_count, room = truth->count;
    igi_region *regions = igi_grow(ctx, scene->regions, &capacity, capacity + 1, sizeof *regions);
    if (!regions) return IGI_E_SYSTEM;
    scene->regions = regions;
    igi_material *all = igi_grow(ctx, truth->materials, &room, room + 1, sizeof *all);
    if (!all) return IGI_E_SYSTEM;
    truth->materials = all;
    igi_region *part = &regions[scene->region_count];
    *part = regions[region];
    IGI_TRY(igi_strprintf(ctx, &part->name, "%s#%zu", regions[region].name, number));
    scene->region_count++;
    for (size_t i = 0; i < truth->count; i++) {
        if (strcmp(all[i].region, regions[region].name) != 0) continue;
        all[truth->count] = all[i];
        all[truth->count].map = all[truth->count].map_std = NULL;
        all[truth->count].warnings = NULL;
        all[truth->count].warning_count = 0;
        IGI_TRY(igi_strdup(ctx, part->name, &all[truth->count].region));
        truth->count++;
        break;
    }
    return IGI_OK;
}

static igi_status fall_apart(igi_context *ctx, chart_subject *s, size_t region)
{
    size_t parts = 0;
    for (size_t t = 0; t < s->scene->mesh.triangle_count; t++) {
        if (s->scene->mesh.regions[t] != region || parts++ == 0) continue;
        IGI_TRY(add_part(ctx, s, region, parts));
        s->scene->mesh.regions[t] = (uint32_t)s->scene->region_count - 1;
    }
    return IGI_OK;
}

/* The first `severity` of the named regions fall apart into their triangles. */
static igi_status split(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    size_t done = 0;
    for (size_t k = 0; k < c->region_count && k < (size_t)(severity + .5); k++) {
        size_t region = chart_region(s->scene, c->regions[k]);
        if (region == s->scene->region_count) continue;
        IGI_TRY(fall_apart(ctx, s, region));
        done++;
    }
    return done || severity < 1 ? IGI_OK : IGI_E_NO_ANSWER;
}

const chart_perturbation chart_perturb_regions[] = {{"missing", false, missing},
                                                    {"merge", false, merge},
                                                    {"split", false, split},
                                                    {NULL, false, NULL}};
