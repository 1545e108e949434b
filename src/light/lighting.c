/* SPDX-License-Identifier: Apache-2.0
 *
 * Preparing the lights: the triangles of area lights with their running area, angles in radians.
 */
#include "light/lighting.h"

static igi_status count_emitters(igi_context *ctx, igi_lighting *l, const igi_light *lights)
{
    const igi_scene *scene = l->scene;
    for (size_t r = 0; r < scene->region_count; r++) l->light_of_region[r] = -1;
    for (size_t i = 0; i < l->count; i++) {
        int region = lights[i].region;
        if (lights[i].type != IGI_LIGHT_AREA) continue;
        if (region < 0 || (size_t)region >= scene->region_count)
            return igi_fail(ctx, IGI_E_DATA, "lights: area light %zu names no region of the mesh",
                            i);
        if (l->light_of_region[region] >= 0)
            return igi_fail(ctx, IGI_E_DATA,
                            "lights: two area lights name the region '%s'; keep one of them",
                            scene->regions[region].name);
        l->light_of_region[region] = (int)i;
    }
    for (size_t t = 0; t < scene->mesh.triangle_count; t++)
        l->emitter_count += l->light_of_region[scene->mesh.regions[t]] >= 0;
    return IGI_OK;
}

static void add_emitter(igi_lighting *l, source *s, uint32_t triangle)
{
    const igi_mesh *mesh = &l->scene->mesh;
    float area = igi_triangle_area(mesh, triangle);
    if (!(area > 0)) return;
    igi_vec corner = igi_triangle_point(mesh, triangle, 0, 0);
    s->area += area;
    l->areas[s->first + s->count] = s->area;
    l->emitters[s->first + s->count++] = (emitter){
        .corner = corner,
        .edge1 = igi_sub(igi_triangle_point(mesh, triangle, 1, 0), corner),
        .edge2 = igi_sub(igi_triangle_point(mesh, triangle, 0, 1), corner),
        .normal = igi_triangle_normal(mesh, triangle),
        .centre = igi_triangle_point(mesh, triangle, 1 / 3.0f, 1 / 3.0f),
        .area = area};
}

/* The cut-point method (Chen and Asau 1974): where to begin to look for a share of the area. */
static void find_cuts(igi_lighting *l, const source *s)
{
    uint32_t found = 0;
    for (size_t k = 0; k < s->count; k++) {
        float area = (float)k / (float)s->count * s->area;
        while (found + 1 < s->count && l->areas[s->first + found] <= area) found++;
        l->cuts[s->first + k] = found;
    }
}

static void find_ball(const igi_lighting *l, source *s)
{
    const emitter *e = l->emitters + s->first;
    float squared = 0;
    for (size_t i = 0; i < s->count; i++)
        s->middle = igi_madd(s->middle, e[i].centre, 1 / (float)s->count);
    for (size_t i = 0; i < s->count; i++) {
        const igi_vec corners[3] = {e[i].corner, igi_add(e[i].corner, e[i].edge1),
                                    igi_add(e[i].corner, e[i].edge2)};
        for (int k = 0; k < 3; k++) {
            igi_vec d = igi_sub(corners[k], s->middle);
            squared = fmaxf(squared, igi_dot(d, d));
        }
    }
    s->radius = sqrtf(squared);
}

static void gather_emitters(igi_lighting *l)
{
    size_t next = 0;
    for (size_t i = 0; i < l->count; i++) {
        source *s = &l->sources[i];
        s->first = next;
        if (s->light->type != IGI_LIGHT_AREA) continue;
        for (size_t t = 0; t < l->scene->mesh.triangle_count; t++)
            if (l->light_of_region[l->scene->mesh.regions[t]] == (int)i)
                add_emitter(l, s, (uint32_t)t);
        find_cuts(l, s);
        find_ball(l, s);
        next += s->count;
    }
    igi_emitters_arrange(l);
}

static igi_status prepare(igi_context *ctx, source *s, int bands)
{
    const igi_light *light = s->light;
    s->position = igi_v_ofd(light->position);
    s->axis = igi_normalize(igi_v_ofd(light->direction));
    switch (light->type) {
    case IGI_LIGHT_LINE:
        s->axis = igi_sub(igi_v_ofd(light->end), s->position);
        s->length = igi_length(s->axis);
        break;
    case IGI_LIGHT_SPOT:
        s->cutoff = (float)(light->cutoff_deg * IGI_PI / 180);
        s->beam = fminf(s->cutoff, (float)(light->beam_deg * IGI_PI / 180));
        s->cos_cutoff = cosf(s->cutoff);
        break;
    case IGI_LIGHT_GONIOMETRIC:
        if (!light->file) return igi_fail(ctx, IGI_E_DATA, "lights: one has no \"profile\"");
        return profile_load(ctx, light->file, &s->profile);
    case IGI_LIGHT_ENV: return sky_of_light(ctx, light, bands, &s->sky);
    default: break;
    }
    return IGI_OK;
}

igi_status igi_lighting_create(igi_context *ctx, const igi_scene *scene, const igi_light *lights,
                               size_t light_count, igi_lighting **lighting)
{
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, 1, lighting));
    igi_lighting *l = *lighting;
    l->scene = scene;
    l->bands = scene->bands;
    l->count = light_count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, light_count, &l->sources));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->region_count, &l->light_of_region));
    IGI_TRY_GOTO(count_emitters(ctx, l, lights));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, l->emitter_count, &l->emitters));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, l->emitter_count * IGI_PIECE_VALUES, &l->pieces));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, l->emitter_count, &l->areas));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, l->emitter_count, &l->cuts));
    for (size_t i = 0; i < light_count; i++) {
        l->sources[i].light = &lights[i];
        IGI_TRY_GOTO(prepare(ctx, &l->sources[i], l->bands));
    }
    gather_emitters(l);
cleanup:
    if (status != IGI_OK) {
        igi_lighting_destroy(l);
        *lighting = NULL;
    }
    return status;
}

void igi_lighting_destroy(igi_lighting *lighting)
{
    if (!lighting) return;
    for (size_t i = 0; lighting->sources && i < lighting->count; i++) {
        sky_destroy(lighting->sources[i].sky);
        profile_destroy(lighting->sources[i].profile);
    }
    igi_free(lighting->sources);
    igi_free(lighting->emitters);
    igi_free(lighting->pieces);
    igi_free(lighting->areas);
    igi_free(lighting->cuts);
    igi_free(lighting->light_of_region);
    igi_free(lighting);
}

float igi_light_ball(const igi_lighting *lighting, size_t light, igi_vec *middle)
{
    const source *s = &lighting->sources[light];
    *middle = s->middle;
    return s->radius;
}

size_t igi_lighting_count(const igi_lighting *lighting)
{
    return lighting->count;
}

int igi_lighting_of_triangle(const igi_lighting *lighting, uint32_t triangle)
{
    return lighting->light_of_region[lighting->scene->mesh.regions[triangle]];
}
