/* SPDX-License-Identifier: Apache-2.0
 *
 * truth.json: what the scene is made of, and how much of each region the photographs see.
 */
#include "synth/synth.h"
#include "base/file.h"
#include "material/material.h"

#include <math.h>
#include <string.h>

/* The share of a region's area that one camera or more sees, from some thousand points. */
static double seen_share(const igi_scene *scene, const igi_tracer *tracer, size_t region,
                         const shown *by)
{
    enum { POINTS = 2000 };
    const igi_mesh *mesh = &scene->mesh;
    double area = 0, below = 0;
    size_t seen = 0, next = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        if (mesh->regions[t] == region) area += (double)igi_triangle_area(mesh, t);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (mesh->regions[t] != region) continue;
        below += (double)igi_triangle_area(mesh, t);
        for (; next < POINTS && ((double)next + .5) / POINTS * area < below; next++) {
            /* The plastic-number sequence over the triangle (Roberts 2018). */
            double a = fmod(.5 + 0.7548776662466927 * (double)next, 1),
                   b = fmod(.5 + 0.5698402909980532 * (double)next, 1);
            float root = sqrtf((float)a), v = (float)b;
            igi_vec p = igi_triangle_point(mesh, t, root * (1 - v), root * v);
            bool is_seen = false;
            for (size_t i = 0; i < by->camera_count && !is_seen; i++)
                is_seen = view_sees(&by->cameras[i], tracer, p);
            seen += is_seen;
        }
    }
    return next ? (double)seen / (double)next : 0;
}

static json_t *bands_json(const double *x, int bands)
{
    json_t *array = json_array();
    for (int b = 0; b < bands; b++)
        if (json_array_append_new(array, json_real(x[b]))) break;
    return array;
}

static const igi_material *material_named(const igi_materials *materials, const char *name)
{
    for (size_t i = 0; i < materials->count; i++)
        if (strcmp(materials->materials[i].region, name) == 0) return &materials->materials[i];
    return NULL;
}

/* "roughness" is glTF's, the square root of alpha, for ggx; elsewhere alpha itself. */
static int add_region(json_t *regions, const igi_region *region, const igi_material *m, int bands,
                      double seen, const size_t *highlight)
{
    bool glossy = m->model != IGI_LAMBERT;
    json_t *o = json_object();
    int bad = json_object_set_new(o, "albedo", bands_json(m->albedo, bands));
    bad |= json_object_set_new(o, "texture",
                               m->map ? json_sprintf("albedo/%s.exr", region->name) : json_null());
    bad |= json_object_set_new(o, "specular", json_real(glossy ? m->specular : 0));
    if (glossy && m->specular_is_rgb)
        bad |= json_object_set_new(o, "specular_rgb", bands_json(m->specular_rgb, bands));
    bad |= json_object_set_new(o, "roughness",
                               json_real(m->model == IGI_GGX ? sqrt(m->alpha)
                                         : glossy            ? m->alpha
                                                             : 0));
    bad |= json_object_set_new(o, "model", json_string(igi_model_name(m->model)));
    if (glossy) {
        bad |= json_object_set_new(o, "alpha", json_real(m->alpha));
        if (highlight)
            bad |= json_object_set_new(o, "highlight_pixels", json_integer((json_int_t)*highlight));
    }
    if (m->map && region->uvs_wrap) bad |= json_object_set_new(o, "uv_wrap", json_true());
    if (m->emitter) bad |= json_object_set_new(o, "emitter", json_true());
    bad |= json_object_set_new(o, "seen1", json_real(floor(seen * 1000 + .5) / 1000));
    return bad | json_object_set_new(regions, region->name, o);
}

igi_status truth_save(igi_context *ctx, const spec *s, const igi_scene *scene,
                      const igi_tracer *tracer, const shown *by, const char *path)
{
    json_t *root = json_object(), *regions = json_object();
    int bad = json_object_set_new(root, "regions", regions);
    for (size_t i = 0; i < scene->region_count && !bad; i++) {
        const igi_region *region = &scene->regions[i];
        const igi_material *m = material_named(s->materials, region->name);
        double seen = seen_share(scene, tracer, i, by);
        bad = !m || add_region(regions, region, m, scene->bands, seen,
                               by->highlight ? &by->highlight[i] : NULL);
    }
    json_t *lights = json_array();
    for (size_t i = 0; i < scene->light_count; i++)
        bad |= json_array_append_new(lights,
                                     igi_light_json(&scene->lights[i], NULL, scene->bands, scene));
    bad |= json_object_set_new(root, "lights", lights);
    igi_status status = bad ? igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to write it", path)
                            : igi_file_save_json(ctx, path, root, 9);
    json_decref(root);
    return status;
}
