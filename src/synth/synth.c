/* SPDX-License-Identifier: Apache-2.0
 *
 * A spec becomes a scene folder. Mesh, cameras, lights and maps are written first and read again,
 * so that what is rendered is what stands in the files, to the last digit.
 */
#include "synth/maker.h"

#include "base/file.h"
#include "scene/mesh.h"
#include "scene/scene_parts.h"

#include <igi/image.h>

#include <string.h>

static igi_status write_mesh(maker *m)
{
    char *path = NULL;
    igi_status status = maker_path(m, "scene.obj", &path);
    if (status == IGI_OK) status = shapes_save(m->ctx, &m->spec, path);
    if (status == IGI_OK) status = igi_mesh_load(m->ctx, m->scene, path);
    igi_free(path);
    return status;
}

static const igi_material *material_of(const maker *m, size_t region)
{
    const igi_materials *all = m->spec.materials;
    for (size_t i = 0; i < all->count; i++)
        if (strcmp(all->materials[i].region, m->scene->regions[region].name) == 0)
            return &all->materials[i];
    return NULL;
}

static igi_status read_lights(maker *m)
{
    for (size_t i = 0; i < m->scene->region_count; i++)
        m->scene->regions[i].emitter = material_of(m, i)->emitter;
    return igi_lights_read(m->ctx, &m->spec.lights, m->scene, &m->scene->lights,
                           &m->scene->light_count);
}

/* A camera's unit is its own: area lights are then to be read from the photographs. */
static void forget_radiance(json_t *lights)
{
    for (size_t i = 0; i < json_array_size(lights); i++) {
        json_t *light = json_array_get(lights, i);
        const char *type = json_string_value(json_object_get(light, "type"));
        if (type && strcmp(type, "area") == 0) json_object_del(light, "radiance");
    }
}

static igi_status write_manifest(const maker *m)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    json_t *regions = json_object(), *lights = NULL, *root = NULL;
    for (size_t i = 0; i < m->scene->region_count; i++) {
        const igi_material *material = material_of(m, i);
        json_t *o = json_object();
        int bad = 0;
        if (material->textured) bad |= json_object_set_new(o, "textured", json_true());
        if (material->emitter) bad |= json_object_set_new(o, "emitter", json_true());
        if (bad | json_object_set_new(regions, m->scene->regions[i].name, o))
            IGI_TRY_GOTO(igi_fail(m->ctx, IGI_E_SYSTEM, "scene.json: no memory to write it"));
    }
    IGI_TRY_GOTO(lights_keep(m->ctx, &m->spec.lights, m->folder, &lights));
    if (m->photos) forget_radiance(lights);
    root = json_pack("{si ss ss ss sO sO}", "igi", 1, "name", m->spec.name, "mesh", "scene.obj",
                     "cameras", "transforms.json", "lights", lights, "regions", regions);
    IGI_TRY_GOTO(maker_path(m, "scene.json", &path));
    IGI_TRY_GOTO(igi_file_save_json(m->ctx, path, root, 9));
cleanup:
    igi_free(path);
    json_decref(regions);
    json_decref(lights);
    json_decref(root);
    return status;
}

/* The map as its file holds it, and the mean of that. */
static igi_status make_map(maker *m, size_t i)
{
    igi_material *material = &m->spec.materials->materials[i];
    int bands = m->spec.materials->bands;
    igi_image *image = NULL;
    char *path = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(
        igi_strprintf(m->ctx, &path, "%s/truth/albedo/%s.exr", m->folder, material->region));
    IGI_TRY_GOTO(texture_make(m->ctx, &m->spec.textures[i], bands, &image));
    IGI_TRY_GOTO(igi_image_save_exr(m->ctx, image, IGI_EXR_HALF, path));
    IGI_TRY_GOTO(igi_image_load_exr(m->ctx, path, &material->map));
    material->textured = true;
    size_t texels = (size_t)image->width * (size_t)image->height;
    for (size_t t = 0; t < texels * (size_t)bands; t++)
        material->albedo[t % (size_t)bands] += (double)material->map->samples[t] / (double)texels;
cleanup:
    igi_image_destroy(image);
    igi_free(path);
    return status;
}

static igi_status make_maps(maker *m)
{
    bool any = false;
    for (size_t i = 0; i < m->spec.materials->count; i++) {
        if (m->spec.textures[i].kind == TEXTURE_NONE) continue;
        if (!any) IGI_TRY(maker_folder(m, "truth/albedo"));
        any = true;
        IGI_TRY(make_map(m, i));
    }
    return IGI_OK;
}

static igi_status make_relit(maker *m, size_t number)
{
    const relit_set *set = &m->spec.relit[number];
    igi_status status = IGI_OK;
    igi_light *lights = NULL;
    size_t count = 0;
    char *name = NULL, *folder = NULL, *path = NULL;
    json_t *kept = NULL, *root = NULL;
    IGI_TRY_GOTO(number ? igi_strprintf(m->ctx, &name, "relit%zu/", number + 1)
                        : igi_strdup(m->ctx, "relit/", &name));
    IGI_TRY_GOTO(igi_lights_read(m->ctx, &set->lights, m->scene, &lights, &count));
    lit_by by = {"relit views", lights, count};
    IGI_TRY_GOTO(maker_views(m, name, &set->views, &by, NULL, NULL));
    IGI_TRY_GOTO(maker_path(m, name, &folder));
    IGI_TRY_GOTO(lights_keep(m->ctx, &set->lights, folder, &kept));
    root = json_pack("{sO}", "lights", kept);
    IGI_TRY_GOTO(igi_strprintf(m->ctx, &path, "%slights.json", folder));
    IGI_TRY_GOTO(igi_file_save_json(m->ctx, path, root, 9));
cleanup:
    json_decref(kept);
    json_decref(root);
    igi_lights_destroy(lights, count);
    igi_free(name);
    igi_free(folder);
    igi_free(path);
    return status;
}

static igi_status make_scene(maker *m)
{
    igi_scene *scene = m->scene;
    igi_camera *cameras = NULL;
    size_t count = 0;
    char *path = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(maker_folder(m, ""));
    IGI_TRY_GOTO(maker_folder(m, "truth"));
    IGI_TRY_GOTO(write_mesh(m));
    scene->bands = m->spec.materials->bands;
    IGI_TRY_GOTO(read_lights(m));
    IGI_TRY_GOTO(write_manifest(m));
    IGI_TRY_GOTO(make_maps(m));
    IGI_TRY_GOTO(igi_tracer_create(m->ctx, &scene->mesh, &m->tracer));
    if (m->spec.highlights) IGI_TRY_GOTO(IGI_ALLOC(m->ctx, scene->region_count, &m->highlight));
    lit_by by = {"photographs", scene->lights, scene->light_count};
    IGI_TRY_GOTO(maker_views(m, "", &m->spec.views, &by, &cameras, &count));
    IGI_TRY_GOTO(maker_path(m, "truth/truth.json", &path));
    shown views = {cameras, count, m->highlight};
    IGI_TRY_GOTO(truth_save(m->ctx, &m->spec, scene, m->tracer, &views, path));
    by.stage = "held-out views";
    if (m->spec.has_heldout)
        IGI_TRY_GOTO(maker_views(m, "heldout/", &m->spec.heldout, &by, NULL, NULL));
    for (size_t i = 0; i < m->spec.relit_count; i++) IGI_TRY_GOTO(make_relit(m, i));
cleanup:
    igi_free(cameras);
    igi_free(path);
    return status;
}

static igi_status synth(igi_context *ctx, const char *spec_path, const char *folder, bool photos,
                        const char *basis)
{
    igi_status status = IGI_OK;
    maker m = {.ctx = ctx, .folder = folder, .photos = photos, .basis = basis};
    IGI_TRY_GOTO(spec_load(ctx, spec_path, &m.spec));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &m.scene));
    IGI_TRY_GOTO(make_scene(&m));
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_tracer_destroy(m.tracer);
    igi_scene_destroy(m.scene);
    igi_free(m.highlight);
    spec_clear(&m.spec);
    return status;
}

igi_status igi_synth(igi_context *ctx, const char *spec_path, const char *folder)
{
    return synth(ctx, spec_path, folder, false, NULL);
}

igi_status igi_synth_photos(igi_context *ctx, const char *spec_path, const char *folder,
                            const char *basis_path)
{
    return synth(ctx, spec_path, folder, true, basis_path);
}
